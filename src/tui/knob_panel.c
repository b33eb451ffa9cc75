#include "tui/knob_panel.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

status knob_panel_open(knob_panel *panel, report *r) {
    *panel = (knob_panel){.list = memory_allocate_array(KNOB_LIMIT, sizeof *panel->list),
                          .rows = memory_allocate_array(2 * KNOB_LIMIT, sizeof *panel->rows)};
    if (panel->list && panel->rows) return STATUS_OK;
    knob_panel_close(panel);
    return report_set(r, STATUS_SYSTEM, "out of memory for the knobs");
}

void knob_panel_close(knob_panel *panel) {
    if (panel->list) memory_free(panel->list, KNOB_LIMIT * sizeof *panel->list);
    if (panel->rows) memory_free(panel->rows, 2 * KNOB_LIMIT * sizeof *panel->rows);
    *panel = (knob_panel){0};
}

void knob_panel_forget(knob_panel *panel) {
    panel->undo_count = panel->undo_at = 0;
}

/* ---- rows -------------------------------------------------------------------------------------------------------- */

static bool same_group(const knob *a, const knob *b) {
    return strcmp(a->owner, b->owner) == 0 && strcmp(a->effect, b->effect) == 0;
}

static int current_index(const knob_panel *panel) {
    if (panel->cursor < 0 || panel->cursor >= panel->row_count || panel->rows[panel->cursor].heading) return -1;
    const knob_row *row = &panel->rows[panel->cursor];
    return panel->on_twin && row->twin >= 0 ? row->twin : row->knob;
}

const knob *knob_panel_current(const knob_panel *panel) {
    int index = current_index(panel);
    return index < 0 ? NULL : &panel->list[index];
}

void knob_panel_go(knob_panel *panel, int index) {
    for (int i = 0; i < panel->row_count; i++) {
        const knob_row *row = &panel->rows[i];
        if (row->heading || (row->knob != index && row->twin != index)) continue;
        panel->cursor = i;
        panel->on_twin = row->twin == index;
        panel->component = 0;
        return;
    }
}

void knob_panel_arrange(knob_panel *panel, int count) {
    int kept = current_index(panel), component = panel->component;
    panel->count = count < KNOB_LIMIT ? count : KNOB_LIMIT;
    panel->row_count = 0;
    for (int i = 0; i < panel->count; i++) {
        const knob *k = &panel->list[i];
        if (k->twin >= 0 && k->twin < i) continue; /* on its twin's row */
        if (i == 0 || !same_group(k, &panel->list[i - 1])) panel->rows[panel->row_count++] = (knob_row){i, -1, true};
        panel->rows[panel->row_count++] = (knob_row){i, k->twin, false};
    }
    if (panel->cursor >= panel->row_count) panel->cursor = panel->row_count - 1;
    if (panel->cursor < 0) panel->cursor = 0;
    int first = 0; /* one that can be turned */
    while (first < panel->count && !panel->list[first].live) first++;
    if (kept < 0) knob_panel_go(panel, first < panel->count ? first : 0);
    else knob_panel_go(panel, kept < panel->count ? kept : 0);
    const knob *now = knob_panel_current(panel);
    panel->component = now && component < now->components ? component : 0;
}

void knob_panel_move(knob_panel *panel, int by) {
    int direction = by < 0 ? -1 : 1, left = by < 0 ? -by : by, at = panel->cursor;
    if (at < panel->row_count && panel->rows[at].heading && left == 0) left = 1;
    while (left > 0) {
        int next = at + direction;
        while (next >= 0 && next < panel->row_count && panel->rows[next].heading) next += direction;
        if (next < 0 || next >= panel->row_count) break;
        at = next;
        left--;
    }
    if (at != panel->cursor) panel->component = 0;
    panel->cursor = at;
    if (panel->cursor < panel->row_count && panel->rows[panel->cursor].twin < 0) panel->on_twin = false;
}

bool knob_panel_other(knob_panel *panel) {
    const knob *k = knob_panel_current(panel);
    if (!k) return false;
    if (k->components > 1) {
        panel->component = (panel->component + 1) % k->components;
        return true;
    }
    if (panel->rows[panel->cursor].twin < 0) return false;
    panel->on_twin = !panel->on_twin;
    return true;
}

/* ---- values ------------------------------------------------------------------------------------------------------ */

static double round_digits(double value) {
    char text[32];
    double rounded = value;
    snprintf(text, sizeof text, "%.4g", value);
    sscanf(text, "%lf", &rounded);
    return rounded;
}

static bool bounded(const knob *k) {
    return isfinite(k->minimum) && isfinite(k->maximum) && k->maximum > k->minimum;
}

/* A size to step a knob by that has no range: what it began with (a vector: its largest component), so that steps back lead to where one
 * came from; its own where it has left that far behind. */
static double size_of(const knob *k, int component) {
    double size = 0;
    for (int i = 0; i < k->components; i++) size = fmax(size, fmax(fabs(k->start[i]), fabs(k->fallback[i])));
    if (size == 0 || !isfinite(size)) size = 1;
    double own = fabs(k->value[component]);
    return own > 10 * size ? own : size;
}

static int choice_count(const knob *k) {
    int count = 0;
    while (k->choices && k->choices[count]) count++;
    return count;
}

static bool step_number(const knob *k, int component, int direction, bool fine, double *value) {
    double now = k->value[component], next;
    bool factors = k->logarithmic && now > 0 && (direction > 0 || now > k->minimum);
    /* The range of what goes by factors spans decades, and that of many others is only what is not absurd: steps go by the value then. */
    double span = bounded(k) && k->maximum - k->minimum <= 100 * size_of(k, component) ? k->maximum - k->minimum
                                                                                        : 4 * size_of(k, component);
    if (factors) {
        double factor = fine ? 1.02 : 1.25;
        next = direction > 0 ? now * factor : now / factor;
    } else {
        next = now + direction * span / (fine ? 400 : 40);
        if (fabs(next) < 1e-9 * span) next = 0;
    }
    next = round_digits(next);
    next = fmin(fmax(next, k->minimum), k->maximum);
    *value = next;
    return next != now;
}

bool knob_step(const knob *k, int component, int direction, bool fine, double value[3]) {
    memcpy(value, k->value, 3 * sizeof *value);
    if (k->kind == PARAMETER_BOOLEAN) {
        value[0] = k->value[0] == 0;
        return true;
    }
    if (k->kind == PARAMETER_CHOICE) {
        int count = choice_count(k);
        if (count < 2) return false;
        value[0] = (double)(((int)k->value[0] + direction + count) % count);
        return true;
    }
    return step_number(k, component, direction, fine, &value[component]);
}

double knob_place(const knob *k, double value) {
    double low = k->minimum, high = k->maximum, start = fabs(k->start[0]);
    if (start == 0) start = fabs(k->fallback[0]);
    if (start == 0) start = 1;
    bool wide = !bounded(k) || high - low > 100 * start;
    if (k->logarithmic) {
        /* Two decades to either side of what the run began with. */
        low = fmax(low, start / 100);
        high = fmin(high, start * 100);
        if (!(value > low)) return 0;
        return high > low ? fmin(log(value / low) / log(high / low), 1) : 0;
    }
    if (wide) {
        low = fmax(low, -2 * start);
        high = fmin(high, 2 * start);
    }
    return high > low ? fmin(fmax((value - low) / (high - low), 0), 1) : 0;
}

void knob_show(const knob *k, const double value[3], char *text) {
    if (k->kind == PARAMETER_BOOLEAN) {
        snprintf(text, KNOB_TEXT, "%s", value[0] != 0 ? "on" : "off");
    } else if (k->kind == PARAMETER_CHOICE) {
        int count = choice_count(k), index = (int)value[0];
        snprintf(text, KNOB_TEXT, "%s", index >= 0 && index < count ? k->choices[index] : "?");
    } else if (k->components == 3) {
        snprintf(text, KNOB_TEXT, "(%.4g, %.4g, %.4g)", value[0], value[1], value[2]);
    } else {
        snprintf(text, KNOB_TEXT, "%.4g", value[0]);
    }
}

/* ---- undo -------------------------------------------------------------------------------------------------------- */

void knob_panel_note(knob_panel *panel, const knob *before, int index, const char *to) {
    const knob *k = &before[index];
    const knob *said = k->derived && k->twin >= 0 ? &before[k->twin] : k;
    if (panel->undo_at == KNOB_UNDO) {
        memmove(panel->undo, panel->undo + 1, (KNOB_UNDO - 1) * sizeof *panel->undo);
        panel->undo_at--;
    }
    knob_change *change = &panel->undo[panel->undo_at++];
    panel->undo_count = panel->undo_at;
    snprintf(change->from_path, sizeof change->from_path, "%s", said->path);
    knob_print(said, said->value, change->from);
    snprintf(change->to_path, sizeof change->to_path, "%s", k->path);
    snprintf(change->to, sizeof change->to, "%.*s", KNOB_TEXT - 1, to);
}

const knob_change *knob_panel_undo(const knob_panel *panel) {
    return panel->undo_at > 0 ? &panel->undo[panel->undo_at - 1] : NULL;
}

const knob_change *knob_panel_redo(const knob_panel *panel) {
    return panel->undo_at < panel->undo_count ? &panel->undo[panel->undo_at] : NULL;
}

void knob_panel_undone(knob_panel *panel, int by) {
    panel->undo_at += by;
}
