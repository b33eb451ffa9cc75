/* The two runs of the Compare screen: which they are, what differs, what is read of them. */
#include "tui/compare.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- what differs ------------------------------------------------------------------------------------------------ */

/* Appends "name left → right" for parameters, "@frame path = value" for turns that only one of the two has. */
static status take_difference(void *context, const ledger_cell *cells, int count, report *r) {
    compare_state *state = context;
    (void)count, (void)r;
    char item[192];
    const char *left = cells[1].text ? cells[1].text : "–", *right = cells[2].text ? cells[2].text : "–";
    if (cells[3].text) snprintf(item, sizeof item, "%s @%s %s = %s", left[0] ? left : right, cells[3].text, cells[0].text, cells[4].text);
    else snprintf(item, sizeof item, "%s %s → %s", cells[0].text, left, right);
    size_t used = strlen(state->differs);
    snprintf(state->differs + used, sizeof state->differs - used, "%s%s", used ? "   " : "", item);
    return STATUS_OK;
}

static status find_differences(ledger *l, compare_state *state, report *r) {
    static const char sql[] =
        "SELECT p.name, CAST(coalesce(p.text, p.number) AS TEXT), CAST(coalesce(q.text, q.number) AS TEXT), NULL, NULL"
        " FROM run_parameters AS p JOIN runs AS a USING (run), run_parameters AS q JOIN runs AS b ON b.run = q.run"
        " WHERE a.id = :left AND b.id = :right AND p.name = q.name AND coalesce(p.text, p.number) IS NOT coalesce(q.text, q.number)"
        " UNION ALL SELECT t.path, iif(runs.id = :left, 'left', ''), iif(runs.id = :right, 'right', ''), CAST(t.frame AS TEXT), t.value"
        " FROM knob_turns AS t JOIN runs USING (run) WHERE runs.id IN (:left, :right) AND :left <> :right AND NOT EXISTS"
        " (SELECT 1 FROM knob_turns AS u JOIN runs AS o USING (run) WHERE o.id IN (:left, :right) AND o.id <> runs.id"
        " AND u.frame = t.frame AND u.path = t.path AND u.value = t.value)";
    char left[LEDGER_ID + 8], right[LEDGER_ID + 8];
    const char *arguments[] = {left, right};
    snprintf(left, sizeof left, "left=%s", state->sides[0].id);
    snprintf(right, sizeof right, "right=%s", state->sides[1].id);
    state->differs[0] = '\0';
    return ledger_each_row(l, sql, arguments, 2, take_difference, state, r);
}

/* ---- choosing ---------------------------------------------------------------------------------------------------- */

static status take_title(void *context, const ledger_cell *cells, int count, report *r) {
    (void)count, (void)r;
    char *title = context;
    snprintf(title, 192, "%s%s%s", cells[0].text ? cells[0].text : "", cells[1].text ? " · " : "", cells[1].text ? cells[1].text : "");
    return STATUS_OK;
}

static void open_side(compare_state *state, compare_side *side) {
    side->problem[0] = '\0';
    side->has_frame = side->grown = false;
    state->scale = (view_scale){0, 0};
    state->stale = true;
    particle_view_forget(&state->sides[0].view);
}

status compare_choose(tui_app *app, compare_state *state, int which, const char *run, report *r) {
    compare_side *side = &state->sides[which];
    char id[LEDGER_ID], folder[TUI_PATH], argument[LEDGER_ID + 8];
    const char *const arguments[] = {argument};
    ledger *l;
    status s = app_open_ledger(app, &l, r);
    if (s == STATUS_OK) s = ledger_resolve(l, run, id, folder, sizeof folder, r);
    if (s == STATUS_OK) {
        memcpy(side->id, id, sizeof id);
        memcpy(side->folder, folder, sizeof folder);
        snprintf(argument, sizeof argument, "id=%s", id);
        s = ledger_each_row(l, "SELECT scene_title, variant FROM runs WHERE id = :id", arguments, 1, take_title, side->title, r);
        if (s == STATUS_OK) s = find_differences(l, state, r);
        open_side(state, side);
    }
    if (l) ledger_close(l);
    return s;
}

/* ---- frames ------------------------------------------------------------------------------------------------------ */

const frame_page *compare_page(const compare_side *side) {
    const frame_page *page = frame_reader_page(side->reader);
    return side->id[0] && strcmp(page->folder, side->folder) == 0 ? page : NULL;
}

bool compare_range(const compare_state *state, int64_t *first, int64_t *last) {
    bool any = false;
    *first = *last = 0;
    for (int i = 0; i < COMPARE_SIDES; i++) {
        const frame_page *page = compare_page(&state->sides[i]);
        if (!page || page->frame_count == 0) continue;
        int64_t low = page->frames[0], high = page->frames[page->frame_count - 1];
        *first = any && *first > low ? *first : low;
        *last = any && *last < high ? *last : high;
        any = true;
    }
    return any && *last >= *first;
}

static void count_histogram(const view_scale scale, compare_side *side) {
    memset(side->histogram, 0, sizeof side->histogram);
    if (!side->has_frame || !side->shown.value) return;
    int64_t counted = 0, bins[COMPARE_BINS] = {0};
    for (int64_t i = 0; i < side->shown.count; i++) {
        float place = view_scale_place(scale, (double)side->shown.value[i]);
        if (isnan(place)) continue;
        int bin = (int)(place * COMPARE_BINS);
        bins[bin < COMPARE_BINS ? bin : COMPARE_BINS - 1]++;
        counted++;
    }
    for (int i = 0; i < COMPARE_BINS && counted > 0; i++) side->histogram[i] = (double)bins[i] / (double)counted;
}

static particle_points points_of(const compare_state *state, const compare_side *side) {
    return (particle_points){.position = side->shown.position, .scalar = side->shown.value, .count = side->shown.count,
                             .name = state->colour, .natural = state->scale};
}

/* One camera for both: its box holds both bodies, its colours mean the same. */
static void follow(compare_state *state) {
    particle_view *first = &state->sides[0].view;
    for (int i = 0; i < COMPARE_SIDES; i++) {
        compare_side *side = &state->sides[i];
        const frame_page *page = compare_page(side);
        if (!side->has_frame || !page) continue;
        particle_points points = points_of(state, side);
        particle_view_follow(first, &points, page->low, page->high);
    }
    particle_view_match(&state->sides[1].view, first);
    for (int i = 0; i < COMPARE_SIDES; i++) count_histogram(first->scale, &state->sides[i]);
}

/* The frame to be shown, where the runs' frames are known: one that both have. */
static bool settle_frame(compare_state *state) {
    int64_t first, last, before = state->frame;
    if (!compare_range(state, &first, &last)) return false;
    if (state->follows || state->frame > last) state->frame = last;
    if (state->frame < first) state->frame = first;
    return state->frame != before;
}

void compare_ask(compare_state *state) {
    if (!state->stale) return;
    state->stale = false;
    (void)settle_frame(state);
    for (int i = 0; i < COMPARE_SIDES; i++) {
        compare_side *side = &state->sides[i];
        if (side->id[0]) frame_reader_ask(side->reader, side->folder, state->frame, state->colour, side->grown);
        side->grown = false;
    }
}

static void take_page(compare_state *state, compare_side *side, const frame_page *page) {
    side->has_frame = page->has_frame;
    side->shown = page->view;
    snprintf(side->problem, sizeof side->problem, "%.255s", page->problem);
    if (!page->has_frame) return;
    if (!state->colour[0] && page->field[0]) { /* the first run's own, of both */
        memcpy(state->colour, page->field, sizeof state->colour);
        state->stale = true;
    }
    if (strcmp(page->field, state->colour) != 0) side->shown.value = NULL;
    if (side->shown.value) state->scale = view_scale_join(state->scale, (view_scale){(double)side->shown.low, (double)side->shown.high});
}

bool compare_take(compare_state *state) {
    bool any = false;
    for (int i = 0; i < COMPARE_SIDES; i++) {
        compare_side *side = &state->sides[i];
        if (!frame_reader_poll(side->reader)) continue;
        any = true;
        const frame_page *page = compare_page(side);
        side->has_frame = false;
        if (page) take_page(state, side, page);
    }
    if (any && settle_frame(state)) state->stale = true;
    if (any) follow(state);
    return any;
}
