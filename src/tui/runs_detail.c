/* Runs beside each other: all that is known of one, or what differs between several. */
#include "tui/runs.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* What a detail is made from: queries of (name, value), and the heading that they stand under. */
static const struct {
    const char *title, *sql;
} parts[] = {
    {"Parameters", "SELECT p.name, coalesce(p.text, p.number) FROM run_parameters AS p JOIN runs USING (run) WHERE runs.id = :id ORDER BY p.name"},
    {"Run", "SELECT j.key, j.value FROM (SELECT json_object('status', status, 'title', title, 'variant', variant, 'scene', scene, 'hash', scene_hash, "
            "'effects', effects, 'particles', particles, 'seed', seed, 'precision', precision, 'simd', simd, 'threads', threads, 'version', version, "
            "'frames', frames, 'frames_wanted', frames_wanted, 'steps', steps, 'time', time, 'wall_s', wall_seconds, 'message', message, 'parent', parent, "
            "'parent_frame', parent_frame, 'tags', tags, 'started', started, 'command', command, 'folder', output) AS o FROM runs_view WHERE id = :id), json_each(o) AS j"},
    {"Measures of the last frame", "SELECT name, value FROM final_measures WHERE id = :id ORDER BY name"},
    {"Turns of knobs", "SELECT 'frame ' || k.frame || ' ' || k.path, k.value FROM knob_turns AS k JOIN runs USING (run) WHERE runs.id = :id ORDER BY k.turn"},
    {"Events", "SELECT 'frame ' || e.frame || ' ' || e.kind, e.text FROM events AS e JOIN runs USING (run) WHERE runs.id = :id ORDER BY e.event LIMIT 100"},
    {"Notes", "SELECT datetime(written, 'unixepoch', 'localtime'), text FROM notes JOIN runs USING (run) WHERE runs.id = :id ORDER BY note"},
};
enum { PARTS = sizeof parts / sizeof *parts, COMPARED = 3 /* parts that a comparison looks at */ };

typedef struct reading {
    runs_state *s;
    int from, run; /* first line of the part; whose cells are filled */
} reading;

static runs_line *find_line(reading *read, const char *name) {
    runs_state *s = read->s;
    for (int i = read->from; i < s->line_count && read->run > 0; i++)
        if (strcmp(s->lines[i].name, name) == 0) return &s->lines[i];
    if (s->line_count == RUNS_LINES) return NULL;
    runs_line *line = &s->lines[s->line_count++];
    memset(line, 0, sizeof *line);
    snprintf(line->name, sizeof line->name, "%s", name);
    return line;
}

static status take_value(void *context, const ledger_cell *cells, int count, report *r) {
    reading *read = context;
    (void)count, (void)r;
    runs_line *line = find_line(read, cells[0].text ? cells[0].text : "");
    if (!line) return STATUS_OK;
    char *text = line->cells[read->run];
    double number = cells[1].number;
    if (!isnan(number) && number == rint(number) && fabs(number) < 1e15) snprintf(text, RUNS_CELL, "%.0f", number); /* without SQLite's ".0" */
    else if (!isnan(number)) snprintf(text, RUNS_CELL, "%.9g", number);
    else snprintf(text, RUNS_CELL, "%s", cells[1].text ? cells[1].text : "");
    return STATUS_OK;
}

/* Keeps the lines whose cells are not all the same. */
static void keep_differences(runs_state *s, int from) {
    int kept = from;
    for (int i = from; i < s->line_count; i++) {
        bool differs = false;
        for (int run = 1; run < s->shown_count; run++) differs |= strcmp(s->lines[i].cells[run], s->lines[i].cells[0]) != 0;
        if (differs) s->lines[kept++] = s->lines[i];
    }
    s->line_count = kept;
}

static status read_part(runs_state *s, int part, bool only_differences, report *r) {
    status code = STATUS_OK;
    int heading = s->line_count;
    if (heading + 1 >= RUNS_LINES) return STATUS_OK;
    memset(&s->lines[heading], 0, sizeof s->lines[0]);
    snprintf(s->lines[heading].name, RUNS_NAME, "%s", parts[part].title);
    s->lines[heading].heading = true;
    s->line_count++;
    for (int run = 0; run < s->shown_count && code == STATUS_OK; run++) {
        char argument[LEDGER_ID + 4];
        const char *const arguments[] = {argument};
        reading read = {s, heading + 1, run};
        snprintf(argument, sizeof argument, "id=%s", s->shown[run]);
        code = ledger_each_row(s->l, parts[part].sql, arguments, 1, take_value, &read, r);
    }
    if (only_differences) keep_differences(s, heading + 1);
    if (s->line_count == heading + 1) s->line_count = heading; /* nothing under it */
    return code;
}

static status read_detail(runs_state *s, bool only_differences, report *r) {
    status code = STATUS_OK;
    if (!s->lines) s->lines = memory_allocate_array(RUNS_LINES, sizeof *s->lines);
    if (!s->lines) return report_set(r, STATUS_SYSTEM, "out of memory for a comparison");
    s->line_count = s->line_top = 0;
    for (int part = 0; part < (only_differences ? COMPARED : PARTS) && code == STATUS_OK; part++) code = read_part(s, part, only_differences, r);
    return code;
}

status runs_diff(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    (void)argument;
    status code = runs_choose_shown(s, 2, r);
    if (code == STATUS_OK) code = read_detail(s, true, r);
    if (code == STATUS_OK) s->page = RUNS_DETAIL;
    app->dirty = true;
    return code;
}

status runs_detail(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    char id[LEDGER_ID], folder[1024];
    status code = runs_named(app, s, argument, id, folder, r);
    if (code != STATUS_OK) return code;
    snprintf(s->shown[0], LEDGER_ID, "%s", id);
    s->shown_count = 1;
    code = read_detail(s, false, r);
    if (code == STATUS_OK) s->page = RUNS_DETAIL;
    app_log_argument(app, "%s", id);
    app->dirty = true;
    return code;
}

/* ---- drawing ----------------------------------------------------------------------------------------------------- */

/* Columns: as wide as their cells need, at most; names first. */
static void measure_columns(const runs_state *s, int width, int *name_width, int *cell_width) {
    int widest = 0, cell = 8;
    for (int i = 0; i < s->line_count; i++) {
        if (s->lines[i].heading) continue;
        int here = draw_width(s->lines[i].name);
        if (here > widest) widest = here;
        for (int run = 0; run < s->shown_count; run++) {
            here = draw_width(s->lines[i].cells[run]);
            if (here > cell) cell = here;
        }
    }
    *name_width = widest < width / 2 ? widest : width / 2;
    int room = (width - *name_width - 4) / (s->shown_count > 0 ? s->shown_count : 1) - 2;
    *cell_width = s->shown_count == 1 || room < 6 ? room : cell < room ? cell : room;
    if (*cell_width < 6) *cell_width = 6;
}

static void draw_line(tui_app *app, const runs_state *s, tui_area area, int row, const runs_line *line, int name_width, int cell_width) {
    tui_area name = {area.y + row, area.x + 2, 1, name_width};
    if (line->heading) {
        draw_heading(&app->theme, area, row, line->name, NULL);
        return;
    }
    draw_text(&app->theme, name, 0, 0, STYLE_DIM, line->name);
    for (int run = 0; run < s->shown_count; run++) {
        int at = 4 + name_width + run * (cell_width + 2);
        if (at >= area.width) break;
        tui_area cell = {area.y + row, area.x + at, 1, at + cell_width < area.width ? cell_width : area.width - at};
        bool odd = run > 0 && strcmp(line->cells[run], line->cells[0]) != 0;
        draw_text(&app->theme, cell, 0, 0, odd ? STYLE_STRONG : STYLE_TEXT, line->cells[run][0] ? line->cells[run] : "-");
    }
}

void runs_draw_detail(tui_app *app, runs_state *s, tui_area area) {
    int name_width, cell_width, rows = area.height - 2;
    measure_columns(s, area.width, &name_width, &cell_width);
    s->page_rows = rows;
    if (s->line_top > s->line_count - rows) s->line_top = s->line_count > rows ? s->line_count - rows : 0;
    if (s->shown_count == 1) draw_format(&app->theme, area, 0, 0, STYLE_STRONG, "%s", s->shown[0]);
    else draw_format(&app->theme, area, 0, 0, STYLE_STRONG, "What differs between %d runs", s->shown_count);
    for (int run = 0; run < s->shown_count && s->shown_count > 1; run++) {
        int at = 4 + name_width + run * (cell_width + 2), length = (int)strlen(s->shown[run]);
        if (at >= area.width) break;
        tui_area cell = {area.y + 1, area.x + at, 1, at + cell_width < area.width ? cell_width : area.width - at};
        /* The end of an id tells runs of a day apart. */
        draw_text(&app->theme, cell, 0, 0, STYLE_HEAD, length > cell.width ? s->shown[run] + length - cell.width : s->shown[run]);
    }
    if (s->line_count == 0) draw_text(&app->theme, area, 3, 2, STYLE_DIM, "Nothing differs: settings, results and measures are the same.");
    for (int i = 0; i < rows && s->line_top + i < s->line_count; i++)
        draw_line(app, s, area, 2 + i, &s->lines[s->line_top + i], name_width, cell_width);
}
