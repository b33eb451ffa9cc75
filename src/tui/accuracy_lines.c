/* What `sunder accuracy --csv -` says: a line a run while they are made, then the table of levels, then notes. */
#include "tui/accuracy_view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char first_column[] = "axis,key,value,";

/* Cuts a line at its commas, in place; texts of the table have none. */
static int cut(char *line, char *fields[VIEW_COLUMNS + VIEW_MEASURES]) {
    int count = 0;
    for (char *at = line; at && count < VIEW_COLUMNS + VIEW_MEASURES; count++) {
        char *comma = strchr(at, ',');
        fields[count] = at;
        if (comma) *comma = '\0';
        at = comma ? comma + 1 : NULL;
    }
    return count;
}

static void begin_table(accuracy_view *s, const char *line) {
    char copy[CHILD_LINE], *fields[VIEW_COLUMNS + VIEW_MEASURES];
    snprintf(copy, sizeof copy, "%s", line);
    int count = cut(copy, fields);
    int kept = 0;
    for (int i = 0; i < s->level_count && s->going; i++)
        if (!s->axes[s->level[i].axis].on) s->level[kept++] = s->level[i];
    s->level_count = kept;
    s->measure_count = s->note_count = 0;
    for (int i = VIEW_COLUMNS; i < count; i++) snprintf(s->measures[s->measure_count++], VIEW_WORD, "%.63s", fields[i]);
    if (s->shown >= s->measure_count) s->shown = -1;
    s->table = true;
}

/* An axis keeps whether it is wanted through a look that is made anew. */
static int axis_of(accuracy_view *s, const char *name, bool usual) {
    for (int a = 0; a < s->axis_count; a++)
        if (strcmp(s->axes[a].name, name) == 0) return a;
    if (s->axis_count == VIEW_AXES) return VIEW_AXES - 1;
    view_axis *axis = &s->axes[s->axis_count];
    snprintf(axis->name, sizeof axis->name, "%.63s", name);
    axis->on = usual;
    return s->axis_count++;
}

static void take_level(accuracy_view *s, const char *line) {
    char copy[CHILD_LINE], *fields[VIEW_COLUMNS + VIEW_MEASURES];
    snprintf(copy, sizeof copy, "%s", line);
    int count = cut(copy, fields);
    if (count < VIEW_COLUMNS || s->level_count == VIEW_ROWS) return;
    view_level *l = &s->level[s->level_count++];
    *l = (view_level){.axis = axis_of(s, fields[COLUMN_AXIS], strcmp(fields[COLUMN_USUAL], "1") == 0)};
    snprintf(l->key, sizeof l->key, "%.63s", fields[COLUMN_KEY]);
    snprintf(l->value, sizeof l->value, "%.63s", fields[COLUMN_VALUE]);
    snprintf(l->state, sizeof l->state, "%.15s", fields[COLUMN_STATUS]);
    snprintf(l->run, sizeof l->run, "%.39s", fields[COLUMN_RUN]);
    snprintf(l->dominated, sizeof l->dominated, "%.95s", fields[COLUMN_DOMINATED]);
    snprintf(l->settings, sizeof l->settings, "%.511s", fields[COLUMN_SETTINGS]);
    l->own = strstr(fields[COLUMN_ROLE], "own") != NULL;
    l->reference = strstr(fields[COLUMN_ROLE], "reference") != NULL;
    l->frontier = strcmp(fields[COLUMN_FRONTIER], "1") == 0;
    for (int i = 0; i < VIEW_COLUMNS; i++) l->number[i] = fields[i][0] ? strtod(fields[i], NULL) : NAN;
    for (int m = 0; m < VIEW_MEASURES; m++) l->measure[m] = VIEW_COLUMNS + m < count && fields[VIEW_COLUMNS + m][0] ? strtod(fields[VIEW_COLUMNS + m], NULL) : NAN;
}

void accuracy_view_order(accuracy_view *s) {
    for (int i = 1; i < s->level_count; i++)
        for (int k = i; k > 0 && s->level[k].axis < s->level[k - 1].axis; k--) {
            view_level swap = s->level[k];
            s->level[k] = s->level[k - 1], s->level[k - 1] = swap;
        }
}

static bool is_level(const view_level *l, const char *name) {
    char own[2 * VIEW_WORD];
    snprintf(own, sizeof own, "%s %s", l->key, l->value);
    size_t length = l->own ? strlen("the scene's own") : strlen(own);
    return strncmp(name, l->own ? "the scene's own" : own, length) == 0 && (name[length] == '\0' || name[length] == ' ');
}

/* "3/9  done         20261122-…  cfl 1  0.04 s of steps …" */
static bool take_progress(accuracy_view *s, const char *line) {
    int number, of, after = 0;
    char word[24], id[LEDGER_ID];
    if (sscanf(line, "%d/%d  %11[a-z ]  %39s  %n", &number, &of, word, id, &after) < 4 || after == 0) return false;
    word[strcspn(word, " ")] = '\0';
    for (int i = 0; i < s->level_count; i++) {
        view_level *l = &s->level[i];
        if (!is_level(l, line + after)) continue;
        snprintf(l->state, sizeof l->state, "%.15s", word);
        if (strcmp(id, "-") != 0) snprintf(l->run, sizeof l->run, "%s", id);
        const char *figures = strstr(line + after, "  ");
        if (strcmp(word, "failed") == 0) snprintf(l->message, sizeof l->message, "%.159s", figures ? figures + 2 : "");
        if (strcmp(word, "done") == 0 && figures) l->number[COLUMN_STEP_SECONDS] = strtod(figures, NULL);
    }
    return true;
}

void accuracy_view_take(accuracy_view *s, const char *line) {
    if (strncmp(line, first_column, sizeof first_column - 1) == 0) begin_table(s, line);
    else if (s->table && line[0] == '#' && s->note_count < VIEW_NOTES) snprintf(s->notes[s->note_count++], VIEW_NOTE, "%.319s", line + 2);
    else if (take_progress(s, line)) return;
    else if (s->table && strchr(line, ',') && strncmp(line, "sunder:", 7) != 0) take_level(s, line);
    else if (strstr(line, " threads") && !s->table) snprintf(s->title, sizeof s->title, "%.159s", line);
    else if (strstr(line, " runs, about ") && !s->table) snprintf(s->tag, sizeof s->tag, "%.159s", line);
    else snprintf(s->said, sizeof s->said, "%s", line);
}

double accuracy_view_error(const accuracy_view *s, const view_level *l, bool *about) {
    *about = false;
    if (s->shown >= 0) return l->measure[s->shown];
    if (s->shown == -2) return l->number[COLUMN_EARLY];
    *about = l->reference;
    return l->reference ? l->number[COLUMN_LEFT] : l->number[COLUMN_ERROR];
}
