/* What the Scenes screen shows: the list, the settings, the preview. */
#include "tui/scenes.h"

#include "tui/format.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { LIST_WIDEST = 38, LIST_NARROWEST = 22, SIDE_BY_SIDE = 64 };

int scenes_rows(const scenes_state *s) {
    return 1 + s->facts.parameter_count;
}

/* ---- the list ---------------------------------------------------------------------------------------------------- */

static void draw_filter(const tui_app *app, const scenes_state *s, tui_area area) {
    char note[32];
    snprintf(note, sizeof note, "%d of %d", s->shown_count, s->count);
    draw_heading(&app->theme, area, 0, "scenes", s->filter[0] ? note : NULL);
    if (!s->typing && !s->filter[0]) return;
    int column = draw_text(&app->theme, area, 1, 1, STYLE_HEAD, "/");
    column = draw_text(&app->theme, area, 1, column, STYLE_STRONG, s->filter);
    tui_ink ink = app->theme.styles[STYLE_STRONG];
    ink.attributes |= A_REVERSE;
    if (s->typing) draw_ink(&app->theme, area, 1, column, ink, " ");
}

/* A row that the cursor is on: reversed all along, whatever the colours. */
static void draw_cursor_row(const tui_app *app, tui_area area, int row, const char *text, bool active) {
    tui_ink ink = app->theme.styles[active ? STYLE_BAR_STRONG : STYLE_BAR];
    if (active) ink.attributes |= A_REVERSE;
    for (int i = 0; i < area.width; i++) draw_ink(&app->theme, area, row, i, ink, " ");
    draw_ink(&app->theme, area, row, 1, ink, text);
}

static void draw_list(const tui_app *app, scenes_state *s, tui_area area) {
    draw_filter(app, s, area);
    int first = 1 + (s->typing || s->filter[0]), rows = area.height - first;
    if (s->cursor < s->top) s->top = s->cursor;
    if (s->cursor >= s->top + rows) s->top = s->cursor - rows + 1;
    if (s->top > s->shown_count - rows) s->top = s->shown_count > rows ? s->shown_count - rows : 0;
    if (s->shown_count == 0) draw_text(&app->theme, area, first, 1, STYLE_DIM, "No scene has that in its name.");
    for (int i = 0; i < rows && s->top + i < s->shown_count; i++) {
        const library_scene *item = &s->list[s->shown[s->top + i]];
        char text[160];
        snprintf(text, sizeof text, "%s%s%s", item->group, item->group[0] ? "/" : "", item->name);
        if (s->top + i == s->cursor) {
            draw_cursor_row(app, area, first + i, text, !s->on_settings);
        } else {
            int column = draw_format(&app->theme, area, first + i, 1, STYLE_DIM, "%s%s", item->group, item->group[0] ? "/" : "");
            draw_text(&app->theme, area, first + i, column, STYLE_TEXT, item->name);
        }
    }
}

/* ---- the preview, a line at a time -------------------------------------------------------------------------------- */

typedef struct page {
    const tui_app *app;
    tui_area area;
    int row;
} page;

static void line(page *p, tui_style style, const char *text) {
    if (p->row < p->area.height) draw_text(&p->app->theme, p->area, p->row, 0, style, text);
    p->row++;
}

/* Text broken at spaces over at most `rows` rows. */
static void wrapped(page *p, tui_style style, const char *text, int rows) {
    while (*text && rows-- > 0) {
        size_t fits = 0, length = strlen(text);
        char part[512];
        for (size_t i = 0; i <= length && i < sizeof part; i++) {
            if (text[i] != ' ' && text[i] != '\0') continue;
            snprintf(part, sizeof part, "%.*s", (int)i, text);
            if (draw_width(part) > p->area.width) break;
            fits = i;
        }
        if (fits == 0) fits = length < sizeof part ? length : sizeof part - 1;
        snprintf(part, sizeof part, "%.*s", (int)fits, text);
        line(p, style, part);
        text += fits + (text[fits] == ' ');
    }
}

static void heading(page *p, const char *name, const char *note) {
    if (p->row < p->area.height) draw_heading(&p->app->theme, p->area, p->row, name, note);
    p->row++;
}

static const char *setting_of(const scenes_state *s, const char *key) {
    size_t length = strlen(key);
    for (int i = 0; i < s->setting_count; i++)
        if (strncmp(s->settings[i], key, length) == 0 && s->settings[i][length] == '=') return s->settings[i] + length + 1;
    return NULL;
}

static void setting_row(page *p, const scenes_state *s, int index, const char *name, const char *value, bool mine, const char *remark) {
    enum { NAME = 14, VALUE = 14 };
    tui_area a = p->area;
    char text[256];
    if (p->row < a.height) {
        if (s->on_settings && s->parameter == index) {
            snprintf(text, sizeof text, "%-*s %s", NAME - 1, name, value);
            draw_cursor_row(p->app, a, p->row, text, true);
        } else {
            draw_text(&p->app->theme, a, p->row, 1, STYLE_DIM, name);
            draw_text(&p->app->theme, a, p->row, 1 + NAME, mine ? STYLE_WARN : STYLE_STRONG, value);
            int column = 1 + NAME + (draw_width(value) >= VALUE ? draw_width(value) + 1 : VALUE);
            draw_cut(&p->app->theme, a, p->row, column, STYLE_DIM, remark);
        }
    }
    p->row++;
}

static void settings_rows(page *p, const scenes_state *s) {
    const preview_facts *f = &s->facts;
    heading(p, "settings", s->on_settings ? "Enter changes" : NULL);
    setting_row(p, s, 0, "recipe", s->recipe[0] ? s->recipe : "the scene's own", s->recipe[0] != '\0', "");
    for (int i = 0; i < f->parameter_count; i++) {
        const preview_parameter *q = &f->parameters[i];
        const char *mine = setting_of(s, q->name);
        char remark[256];
        size_t used = (size_t)snprintf(remark, sizeof remark, "%s%s%s", q->unit, q->unit[0] && q->doc[0] ? ", " : "", q->doc);
        for (int c = 0; c < q->choice_count && used < sizeof remark; c++)
            used += (size_t)snprintf(remark + used, sizeof remark - used, "%s%s", c ? " | " : "", q->choices[c]);
        setting_row(p, s, i + 1, q->name, mine ? mine : q->value, mine != NULL, remark);
    }
    for (int i = 0; i < s->setting_count; i++) {
        bool shown = false;
        for (int k = 0; k < f->parameter_count; k++) {
            size_t length = strlen(f->parameters[k].name);
            shown = shown || (strncmp(s->settings[i], f->parameters[k].name, length) == 0 && s->settings[i][length] == '=');
        }
        if (!shown) line(p, STYLE_WARN, s->settings[i]);
    }
}

static void names(page *p, const preview_facts *f) {
    char text[PREVIEW_EFFECTS * 34] = "";
    size_t used = 0;
    for (int i = 0; i < f->effect_count; i++)
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%s", i ? "  " : "", f->effects[i]);
    wrapped(p, STYLE_TEXT, text, 4);
}

static void duration_text(double seconds, char text[FORMAT_BYTES]) {
    if (seconds < 120) snprintf(text, FORMAT_BYTES, "%.0f s", seconds);
    else if (seconds < 7200) snprintf(text, FORMAT_BYTES, "%.0f min", seconds / 60);
    else snprintf(text, FORMAT_BYTES, "%.1f h", seconds / 3600);
}

static void cost_rows(page *p, const scenes_state *s) {
    const preview_facts *f = &s->facts;
    char text[256], count[FORMAT_BYTES], left[FORMAT_BYTES];
    heading(p, "cost", f->planned ? NULL : s->busy ? "finding out ~" : "p finds out");
    format_count(f->particles, 12, count);
    if (!f->planned) {
        snprintf(text, sizeof text, "%lld frames, %.4g of time, %s particles", (long long)f->frames, f->duration, count);
        wrapped(p, STYLE_TEXT, text, 2);
        return;
    }
    duration_text(f->seconds, left);
    snprintf(text, sizeof text, "about %s for %lld frames of %s particles", left, (long long)f->frames, count);
    wrapped(p, STYLE_STRONG, text, 2);
    snprintf(text, sizeof text, "%.0f steps of %.2f ms on %d thread%s", f->steps, 1e3 * f->seconds_per_step, f->threads, f->threads == 1 ? "" : "s");
    line(p, STYLE_TEXT, text);
    snprintf(text, sizeof text, "dt %.4g%s  dx %.4g  spacing %.4g", f->dt, f->fixed_dt ? " (fixed)" : "", f->dx, f->spacing);
    line(p, STYLE_TEXT, text);
    snprintf(text, sizeof text, "%.0f bytes a particle, %.0f MiB", f->bytes_per_particle, f->bytes_per_particle * (double)f->particles / 1048576);
    line(p, STYLE_TEXT, text);
}

static void draw_preview(const tui_app *app, scenes_state *s, tui_area area) {
    const preview_facts *f = &s->facts;
    const library_scene *item = scenes_chosen(s);
    page p = {app, area, 0};
    if (!item) return;
    bool current = strncmp(f->words, item->path, strlen(item->path)) == 0 || (f->words[0] == '\'' && strncmp(f->words + 1, item->path, strlen(item->path)) == 0);
    line(&p, STYLE_STRONG, current && f->loaded && f->title[0] ? f->title : item->name);
    line(&p, STYLE_DIM, item->path);
    wrapped(&p, STYLE_TEXT, item->remark, 3);
    if (!current || (!f->loaded && !f->failed)) {
        line(&p, STYLE_DIM, "reading it ~");
        return;
    }
    if (f->failed) wrapped(&p, STYLE_BAD, f->message, 6);
    if (!f->loaded) return;
    settings_rows(&p, s);
    heading(&p, "contains", NULL);
    for (int i = 0; i < f->part_count; i++) wrapped(&p, STYLE_TEXT, f->parts[i], 2);
    heading(&p, "effects", NULL);
    names(&p, f);
    cost_rows(&p, s);
    if (s->precision == 64) line(&p, STYLE_WARN, "double precision");
}

void scenes_draw(tui_app *app, void *state, tui_area area) {
    scenes_state *s = state;
    if (area.width >= SIDE_BY_SIDE) {
        int width = area.width * 3 / 10;
        width = width < LIST_NARROWEST ? LIST_NARROWEST : width > LIST_WIDEST ? LIST_WIDEST : width;
        tui_area list = {area.y, area.x, area.height, width};
        tui_area side = {area.y, area.x + width + 2, area.height, area.width - width - 3};
        for (int row = 0; row < area.height; row++) draw_text(&app->theme, area, row, width, STYLE_DIM, "│");
        draw_list(app, s, list);
        draw_preview(app, s, side);
    } else if (s->on_settings) {
        draw_preview(app, s, area);
    } else {
        draw_list(app, s, area);
    }
}
