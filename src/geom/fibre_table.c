/* Directions from a file's rows: a balanced tree over their places, and the nearest of them. */
#include "geom/fibre_fields.h"

#include "geom/box.h"
#include "geom/text.h"
#include "geom/vector.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum { ROW = 9, LEAST_ROW = 6, NEAREST = 9 /* rows of a blend, and the one that ends it */, FIRST_CAPACITY = 256 };

static const double COORDINATE_LIMIT = 1e30;
static const int64_t ROW_LIMIT = 1 << 26;

/* The row in the middle of a range divides the others by their coordinate along `axis`; the halves are divided alike. */
typedef struct table_row {
    double value[ROW]; /* place, directions */
    int axis;
} table_row;

struct fibre_table {
    int families;
    int64_t count;
    table_row *row; // [count]
};

/* ---- reading ----------------------------------------------------------------------------------------------------- */

/* Rows while they are read. */
typedef struct row_list {
    table_row *row;
    int64_t count, capacity;
    int columns; /* of the first row; 0 before it */
} row_list;

static status out_of_memory(report *r) {
    return report_set(r, STATUS_SYSTEM, "out of memory for a table of fibre directions");
}

static status add_row(row_list *list, const table_row *made, report *r) {
    if (list->count == list->capacity) {
        int64_t wanted = list->capacity ? 2 * list->capacity : FIRST_CAPACITY;
        if (wanted > ROW_LIMIT) return report_set(r, STATUS_INPUT, "a table of fibre directions may have at most 67108864 rows");
        size_t size = sizeof *list->row;
        table_row *grown = memory_resize(list->row, (size_t)list->capacity * size, (size_t)wanted * size);
        if (!grown) return out_of_memory(r);
        list->row = grown, list->capacity = wanted;
    }
    list->row[list->count++] = *made;
    return STATUS_OK;
}

/* Whether a direction of the row has some length. */
static bool has_length(const double direction[3]) {
    return vector_length(direction) > 0.0;
}

static status wrong_count(const text_reader *t, const row_list *list, int found, report *r) {
    char expected[80], count[40];
    if (list->columns) snprintf(expected, sizeof expected, "%d numbers, as in the rows before", list->columns);
    else snprintf(expected, sizeof expected, "x, y, z, dx, dy, dz, or three numbers more");
    snprintf(count, sizeof count, found > ROW ? "more than %d numbers" : "%d numbers", found > ROW ? ROW : found);
    return report_input(r, t->file, t->line, NULL, expected, count, NULL);
}

/* Reads the line's row; `found` stays 0 for a line without words, and for names where `names` allows them. */
static status read_row(text_reader *t, const row_list *list, bool names, table_row *row, int *found, report *r) {
    text_word word;
    *row = (table_row){0};
    for (*found = 0; text_word_on_line(t, &word) && word.text[0] != '#'; (*found)++) {
        double value;
        bool number = text_number(&word, &value) && fabs(value) <= COORDINATE_LIMIT;
        if (!number && *found == 0 && names) return STATUS_OK;
        if (!number) return text_wrong(t, NULL, "a number", &word, r);
        if (*found < ROW) row->value[*found] = value;
    }
    bool fits = list->columns ? *found == list->columns : *found == LEAST_ROW || *found == ROW;
    if (*found == 0 || fits) return STATUS_OK;
    return wrong_count(t, list, *found, r);
}

static status read_rows(const char *file, const void *data, size_t size, row_list *list, report *r) {
    text_reader t = text_open(file, data, size);
    t.commas = true;
    bool first = true;
    if (size >= 3 && memcmp(data, "\xef\xbb\xbf", 3) == 0) t.at += 3;
    do {
        table_row row;
        int found;
        const char *begin = t.at;
        status code = read_row(&t, list, first, &row, &found, r);
        if (code != STATUS_OK) return code;
        if (t.at > begin) first = first && found == 0 && *begin == '#';
        if (found == 0) continue;
        list->columns = found;
        if (!has_length(row.value + 3) || (found == ROW && !has_length(row.value + 6)))
            return report_input(r, file, t.line, NULL, "directions of some length", "0 0 0", NULL);
        code = add_row(list, &row, r);
        if (code != STATUS_OK) return code;
    } while (text_next_line(&t));
    if (list->count > 0) return STATUS_OK;
    return report_input(r, file, 0, NULL, "rows of x, y, z, dx, dy, dz", "none", NULL);
}

/* ---- the tree ---------------------------------------------------------------------------------------------------- */

static int widest_axis(const table_row *row, int64_t begin, int64_t end) {
    box3 box = box_empty();
    for (int64_t i = begin; i < end; i++) box_add(&box, row[i].value);
    return box_widest(&box);
}

/* Hoare's selection: row[begin … at) is not beyond row[at] along the axis, row(at … end) not before it. */
static void divide(table_row *row, int64_t begin, int64_t at, int64_t end, int axis) {
    for (int64_t low = begin, high = end - 1; low < high;) {
        double pivot = row[low + (high - low) / 2].value[axis];
        int64_t i = low, j = high;
        while (i <= j) {
            while (row[i].value[axis] < pivot) i++;
            while (pivot < row[j].value[axis]) j--;
            if (i > j) break;
            table_row kept = row[i];
            row[i++] = row[j], row[j--] = kept;
        }
        if (at <= j) high = j;
        else if (at >= i) low = i;
        else return;
    }
}

static void build(table_row *row, int64_t begin, int64_t end) {
    if (end - begin < 1) return;
    int64_t middle = begin + (end - begin) / 2;
    int axis = widest_axis(row, begin, end);
    divide(row, begin, middle, end, axis);
    row[middle].axis = axis;
    build(row, begin, middle);
    build(row, middle + 1, end);
}

status fibre_table_read(arena *a, const char *file, const void *data, size_t size, const fibre_table **out, report *r) {
    row_list list = {0};
    *out = NULL;
    status code = read_rows(file, data, size, &list, r);
    fibre_table *t = code == STATUS_OK ? arena_allocate(a, sizeof *t) : NULL;
    if (t) t->row = arena_allocate(a, (size_t)list.count * sizeof *t->row);
    if (t && t->row) {
        t->families = list.columns == ROW ? 2 : 1;
        t->count = list.count;
        memcpy(t->row, list.row, (size_t)list.count * sizeof *t->row);
        build(t->row, 0, t->count);
        *out = t;
    } else if (code == STATUS_OK) {
        code = out_of_memory(r);
    }
    memory_free(list.row, (size_t)list.capacity * sizeof *list.row);
    return code;
}

int fibre_table_families(const fibre_table *t) {
    return t->families;
}

/* ---- asking ------------------------------------------------------------------------------------------------------ */

/* The rows nearest so far, by distance. */
typedef struct near_rows {
    int wanted, count;
    const table_row *row[NEAREST];
    double squared[NEAREST];
} near_rows;

static double furthest(const near_rows *n) {
    return n->count < n->wanted ? HUGE_VAL : n->squared[n->count - 1];
}

static void offer(near_rows *n, const table_row *row, const double x[3]) {
    double d[3];
    vector_subtract(x, row->value, d);
    double squared = vector_dot(d, d);
    if (squared >= furthest(n)) return;
    int at = n->count < n->wanted ? n->count++ : n->count - 1;
    for (; at > 0 && n->squared[at - 1] > squared; at--) n->row[at] = n->row[at - 1], n->squared[at] = n->squared[at - 1];
    n->row[at] = row, n->squared[at] = squared;
}

static void search(const fibre_table *t, int64_t begin, int64_t end, const double x[3], near_rows *n) {
    if (begin >= end) return;
    int64_t middle = begin + (end - begin) / 2;
    const table_row *row = &t->row[middle];
    double beyond = x[row->axis] - row->value[row->axis];
    offer(n, row, x);
    if (beyond < 0) search(t, begin, middle, x, n);
    else search(t, middle + 1, end, x, n);
    if (beyond * beyond >= furthest(n)) return;
    if (beyond < 0) search(t, middle + 1, end, x, n);
    else search(t, begin, middle, x, n);
}

void fibre_table_nearest(const fibre_table *t, const double x[3], double *direction) {
    near_rows n = {.wanted = 1};
    search(t, 0, t->count, x, &n);
    memcpy(direction, n.row[0]->value + 3, 3 * (size_t)t->families * sizeof *direction);
}

/* A row's weight falls to zero where the first row that is left out lies: rows come in and go without a jump (Franke and
 * Nielson's form of Shepard's weights). */
static double blend_weight(const near_rows *n, int k) {
    double distance = sqrt(n->squared[k]);
    if (n->count < NEAREST) return 1.0 / (distance * distance);
    double reach = sqrt(n->squared[NEAREST - 1]), weight = (reach - distance) / (reach * distance);
    return weight * weight;
}

void fibre_table_blend(const fibre_table *t, const double x[3], double *direction) {
    near_rows n = {.wanted = NEAREST};
    search(t, 0, t->count, x, &n);
    int used = n.count < NEAREST ? n.count : NEAREST - 1;
    for (int f = 0; f < t->families; f++) {
        const double *nearest = n.row[0]->value + 3 + 3 * f;
        double sum[3] = {0, 0, 0};
        for (int k = 0; k < used; k++) {
            double unit[3], weight = blend_weight(&n, k);
            memcpy(unit, n.row[k]->value + 3 + 3 * f, sizeof unit);
            vector_normalise(unit);
            if (vector_dot(unit, nearest) < 0) weight = -weight;
            for (int c = 0; c < 3; c++) sum[c] += weight * unit[c];
        }
        /* On a row itself its weight is not finite; where rows cancel, the nearest stands. */
        memcpy(direction + 3 * f, isfinite(vector_length(sum)) && vector_length(sum) > 0 ? sum : nearest, sizeof sum);
    }
}
