/* The prompt: an action typed by name with its argument, completed from the action tables. */
#include "tui/shell.h"

#include "tui/actions.h"
#include "tui/typing.h"

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

/* The index-th completion of what is typed, as a whole new text; false when there is none. */
static bool prompt_candidate(tui_app *app, const char *typed, int index, char *out, size_t size) {
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

static void insert(tui_prompt *p, int key) {
    if (key < ' ' || key > 255 || key == 127) return;
    typing_insert(p->text, sizeof p->text, &p->cursor, (char[2]){(char)key, '\0'});
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
    case KEY_LEFT: typing_step(p->text, &p->cursor, -1); break;
    case KEY_RIGHT: typing_step(p->text, &p->cursor, 1); break;
    case KEY_HOME:
    case 'A' - '@': p->cursor = 0; break;
    case KEY_END:
    case 'E' - '@': p->cursor = strlen(p->text); break;
    case 'U' - '@': p->text[p->cursor = 0] = '\0'; break;
    case KEY_BACKSPACE:
    case 127:
    case 8:
        if (!p->text[0]) p->open = false;
        else typing_erase_before(p->text, &p->cursor);
        break;
    case KEY_DC:
        if (p->text[p->cursor]) {
            typing_step(p->text, &p->cursor, 1);
            typing_erase_before(p->text, &p->cursor);
        }
        break;
    default: insert(p, key); break;
    }
}

/* ---- drawing ----------------------------------------------------------------------------------------------------- */

void widget_prompt(tui_app *app, tui_area area) {
    const tui_prompt *p = &app->shell->prompt;
    typing_draw(&app->theme, area, 0, ":", p->text, p->cursor);
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
