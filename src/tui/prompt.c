/* The prompt: an action typed by name with its argument, completed from the action tables. */
#include "tui/shell.h"

#include "tui/actions.h"

#include <stdio.h>
#include <string.h>

void prompt_open(tui_app *app, const char *text) {
    tui_prompt *p = &app->shell->prompt;
    snprintf(p->text, sizeof p->text, "%s", text);
    p->cursor = strlen(p->text);
    p->history_at = p->history_count;
    p->candidate = -1;
    p->open = true;
    app->dirty = true;
}

/* ---- completion -------------------------------------------------------------------------------------------------- */

static bool name_candidate(tui_app *app, const char *typed, int index, char *out, size_t size) {
    action_place place;
    size_t length = strlen(typed);
    /* Names that begin with what is typed, then those that have it behind their screen's name. */
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; actions_at(i, &place); i++) {
            char full[SHELL_NAME];
            action_name(&place, full, sizeof full);
            bool begins = strncmp(full, typed, length) == 0;
            bool inner = place.screen && strncmp(place.action->name, typed, length) == 0;
            if (pass == 0 ? !begins : begins || !inner) continue;
            if (index-- > 0) continue;
            snprintf(out, size, "%s%s", full, place.action->argument != ARGUMENT_NONE ? " " : "");
            return true;
        }
    }
    (void)app;
    return false;
}

bool prompt_candidate(tui_app *app, const char *typed, int index, char *out, size_t size) {
    const char *space = strchr(typed, ' ');
    if (!space) return name_candidate(app, typed, index, out, size);
    char name[SHELL_NAME], argument[ACTION_ARGUMENT];
    snprintf(name, sizeof name, "%.*s", (int)(space - typed), typed);
    action_place place;
    if (!actions_find(app, name, &place) || !place.action->complete) return false;
    if (!place.action->complete(app, space + 1, index, argument)) return false;
    snprintf(out, size, "%s %s", name, argument);
    return true;
}

static void complete(tui_app *app, int step) {
    tui_prompt *p = &app->shell->prompt;
    if (p->candidate < 0) {
        snprintf(p->stem, sizeof p->stem, "%s", p->text);
        if (step < 0) return;
    }
    int wanted = p->candidate + step;
    char text[sizeof p->text];
    if (wanted < 0 || !prompt_candidate(app, p->stem, wanted, text, sizeof text)) {
        wanted = 0;
        if (!prompt_candidate(app, p->stem, 0, text, sizeof text)) return;
    }
    p->candidate = wanted;
    snprintf(p->text, sizeof p->text, "%s", text);
    p->cursor = strlen(p->text);
    /* The only one there is: Tab goes on to what follows. */
    if (wanted == 0 && !prompt_candidate(app, p->stem, 1, text, sizeof text)) p->candidate = -1;
}

/* ---- typing ------------------------------------------------------------------------------------------------------ */

static void remember(tui_prompt *p) {
    if (p->history_count > 0 && strcmp(p->history[p->history_count - 1], p->text) == 0) return;
    if (p->history_count == PROMPT_HISTORY) {
        memmove(p->history[0], p->history[1], sizeof p->history - sizeof p->history[0]);
        p->history_count--;
    }
    snprintf(p->history[p->history_count++], sizeof p->history[0], "%s", p->text);
}

static void enter(tui_app *app) {
    tui_prompt *p = &app->shell->prompt;
    p->open = false;
    char line[sizeof p->text];
    snprintf(line, sizeof line, "%s", p->text + strspn(p->text, " "));
    if (!line[0]) return;
    remember(p);
    size_t length = strcspn(line, " ");
    char *argument = line + length + strspn(line + length, " ");
    size_t end = strlen(argument);
    while (end > 0 && argument[end - 1] == ' ') argument[--end] = '\0';
    line[length] = '\0';
    report unused;
    (void)app_do(app, line, argument, &unused);
}

static void recall(tui_prompt *p, int step) {
    int at = p->history_at + step;
    if (at < 0 || at > p->history_count) return;
    p->history_at = at;
    snprintf(p->text, sizeof p->text, "%s", at == p->history_count ? "" : p->history[at]);
    p->cursor = strlen(p->text);
}

/* A continuation byte of UTF-8. */
static bool inner_byte(char c) {
    return ((unsigned char)c & 0xc0) == 0x80;
}

static void step_cursor(tui_prompt *p, int step) {
    if (step < 0 && p->cursor > 0) {
        do p->cursor--;
        while (p->cursor > 0 && inner_byte(p->text[p->cursor]));
    } else if (step > 0 && p->text[p->cursor]) {
        do p->cursor++;
        while (inner_byte(p->text[p->cursor]));
    }
}

static void erase_before(tui_prompt *p) {
    size_t end = p->cursor;
    step_cursor(p, -1);
    memmove(p->text + p->cursor, p->text + end, strlen(p->text + end) + 1);
}

static void insert(tui_prompt *p, int key) {
    size_t length = strlen(p->text);
    if (key < ' ' || key > 255 || key == 127 || length + 1 >= sizeof p->text) return;
    memmove(p->text + p->cursor + 1, p->text + p->cursor, length - p->cursor + 1);
    p->text[p->cursor++] = (char)key;
}

void prompt_key(tui_app *app, int key) {
    tui_prompt *p = &app->shell->prompt;
    if (key != '\t' && key != KEY_BTAB) p->candidate = -1;
    switch (key) {
    case 27:
    case 'G' - '@': p->open = false; break;
    case '\n':
    case '\r':
    case KEY_ENTER: enter(app); break;
    case '\t': complete(app, 1); break;
    case KEY_BTAB: complete(app, -1); break;
    case KEY_UP: recall(p, -1); break;
    case KEY_DOWN: recall(p, 1); break;
    case KEY_LEFT: step_cursor(p, -1); break;
    case KEY_RIGHT: step_cursor(p, 1); break;
    case KEY_HOME:
    case 'A' - '@': p->cursor = 0; break;
    case KEY_END:
    case 'E' - '@': p->cursor = strlen(p->text); break;
    case 'U' - '@': p->text[p->cursor = 0] = '\0'; break;
    case KEY_BACKSPACE:
    case 127:
    case 8:
        if (!p->text[0]) p->open = false;
        else erase_before(p);
        break;
    case KEY_DC:
        if (p->text[p->cursor]) {
            step_cursor(p, 1);
            erase_before(p);
        }
        break;
    default: insert(p, key); break;
    }
}

/* ---- drawing ----------------------------------------------------------------------------------------------------- */

void widget_prompt(tui_app *app, tui_area area) {
    const tui_prompt *p = &app->shell->prompt;
    char before[sizeof p->text], at[8] = " ";
    snprintf(before, sizeof before, "%.*s", (int)p->cursor, p->text);
    const char *shown = before;
    /* What does not fit goes off to the left. */
    while (draw_width(shown) > area.width - 3 && *shown)
        do shown++;
        while (inner_byte(*shown));
    int column = draw_text(&app->theme, area, 0, 0, STYLE_HEAD, ":");
    column = draw_text(&app->theme, area, 0, column, STYLE_STRONG, shown);
    const char *rest = p->text + p->cursor;
    size_t length = *rest != '\0';
    while (length && inner_byte(rest[length])) length++;
    if (length) snprintf(at, sizeof at, "%.*s", (int)length, rest);
    tui_ink ink = app->theme.styles[STYLE_STRONG];
    ink.attributes |= A_REVERSE;
    column = draw_ink(&app->theme, area, 0, column, ink, at);
    draw_text(&app->theme, area, 0, column, STYLE_STRONG, rest + length);
}

void widget_candidates(tui_app *app, tui_area area) {
    const tui_prompt *p = &app->shell->prompt;
    const char *typed = p->candidate >= 0 ? p->stem : p->text;
    char text[sizeof p->text];
    draw_blank(&app->theme, area, 0, STYLE_BAR);
    const char *space = strchr(typed, ' ');
    size_t skip = space ? (size_t)(space - typed) + 1 : 0;
    int column = 1, first = p->candidate > 3 ? p->candidate - 3 : 0;
    for (int i = first; column < area.width && prompt_candidate(app, typed, i, text, sizeof text); i++) {
        const char *shown = strlen(text) > skip ? text + skip : text;
        column = draw_text(&app->theme, area, 0, column, i == p->candidate ? STYLE_BAR_STRONG : STYLE_BAR, shown) + 2;
    }
    if (column > 1) return;
    action_place place;
    char name[SHELL_NAME];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(typed, " "), typed);
    if (!actions_find(app, name, &place)) {
        draw_text(&app->theme, area, 0, 1, STYLE_BAR, "no such action; ? lists them");
        return;
    }
    column = draw_text(&app->theme, area, 0, 1, STYLE_BAR_STRONG, place.action->asks ? place.action->asks : name);
    draw_text(&app->theme, area, 0, column + 2, STYLE_BAR, place.action->help);
}
