#include "store/run_table.h"

#include "base/memory.h"
#include "base/names.h"
#include "store/ledger_internal.h"
#include "store/ledger_names.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { TABLE_COLUMNS = 512, TERM = 160, TERMS = 24 };

/* The run's own columns, in the order of run_rows_sql after its first. */
static const char *const own_names[] = {"id",       "status", "title",   "variant", "scene", "frames", "frames_wanted", "steps",
                                        "time",     "particles", "threads", "precision", "simd",  "version", "seed", "started",
                                        "wall_s",   "tags",   "notes",   "message", "parent", "parent_frame", "effects", "command", "output", "hash"};
enum { OWN = sizeof own_names / sizeof *own_names, OWN_ID = 0 };

static const char run_rows_sql[] =
    "SELECT r.run, r.id, r.status, r.scene_title, r.variant, r.scene_path, coalesce(r.frames, f.frame, 0), r.frames_wanted, "
    "coalesce(r.steps, f.steps, 0), f.time, r.particles, r.threads, r.precision, r.simd, r.version, r.seed, r.started, "
    "coalesce(r.wall_seconds, f.wall_seconds, 0), (SELECT group_concat(tag) FROM tags WHERE tags.run = r.run), "
    "(SELECT group_concat(text, '; ') FROM notes WHERE notes.run = r.run), r.message, r.parent, r.parent_frame, r.effects, r.command, "
    "r.output, r.scene_hash "
    "FROM runs AS r LEFT JOIN frames AS f ON f.run = r.run AND f.frame = (SELECT max(frame) FROM frames AS g WHERE g.run = r.run) "
    "ORDER BY r.run";
static const char parameter_sql[] = "SELECT run, coalesce(text, number) FROM run_parameters WHERE name = ?1 ORDER BY run";
/* Run by run: the key of run_measures begins with (run, frame). */
static const char measure_sql[] =
    "SELECT r.run, x.value FROM runs AS r JOIN run_measures AS x ON x.run = r.run AND x.frame = (SELECT max(frame) FROM frames WHERE "
    "frames.run = r.run) AND x.measure = (SELECT measure FROM measures WHERE name = ?1) ORDER BY r.run";

struct run_table {
    ledger *l;
    arena *memory;
    int rows, capacity, column_count, name_count;
    int64_t *keys; /* [rows] ascending */
    run_column columns[TABLE_COLUMNS];
    struct {
        const char *name;
        run_column_kind kind;
    } names[TABLE_COLUMNS];
    bool out_of_memory;
    int64_t data_version, changes;
};

/* ---- reading ----------------------------------------------------------------------------------------------------- */

/* data_version moves with what other connections commit, total_changes with what this one writes. */
static int64_t data_version(ledger *l) {
    sqlite3_stmt *statement;
    report ignored;
    bool row = false;
    if (ledger_statement(l, "PRAGMA data_version", &statement, &ignored)) return -1;
    status s = ledger_next(l, statement, &row, "ask for its version", &ignored);
    int64_t version = !s && row ? sqlite3_column_int64(statement, 0) : -1;
    sqlite3_reset(statement);
    return version;
}

bool run_table_is_old(const run_table *t) {
    return data_version(t->l) != t->data_version || sqlite3_total_changes(t->l->database) != t->changes;
}

static status no_memory(report *r) {
    return report_set(r, STATUS_SYSTEM, "out of memory for the table of runs");
}

/* A new column without values; NULL when memory or room is out. */
static run_column *add_column(run_table *t, const char *name, run_column_kind kind) {
    if (t->column_count == TABLE_COLUMNS) return NULL;
    size_t n = (size_t)t->capacity;
    run_column c = {.name = arena_copy_string(t->memory, name), .kind = kind, .numeric = true, .number = arena_allocate(t->memory, n * sizeof(double)),
                    .text = arena_allocate(t->memory, n * sizeof(char *))};
    if (!c.name || !c.number || !c.text) return NULL;
    for (size_t i = 0; i < n; i++) c.number[i] = NAN;
    t->columns[t->column_count] = c;
    return &t->columns[t->column_count++];
}

/* Texts repeat (titles, versions): one like the row's before is not copied. */
static bool set_cell(run_table *t, run_column *c, int row, sqlite3_stmt *statement, int column) {
    int type = sqlite3_column_type(statement, column);
    if (type == SQLITE_NULL) return true;
    if (type != SQLITE_TEXT) {
        c->number[row] = sqlite3_column_double(statement, column);
        return true;
    }
    const char *text = (const char *)sqlite3_column_text(statement, column), *before = row > 0 ? c->text[row - 1] : NULL;
    c->numeric = false;
    c->text[row] = before && strcmp(before, text) == 0 ? before : arena_copy_string(t->memory, text);
    return c->text[row] != NULL;
}

static int row_of(const run_table *t, int64_t key) {
    int low = 0, high = t->rows;
    while (low < high) {
        int middle = low + (high - low) / 2;
        if (t->keys[middle] < key) low = middle + 1;
        else high = middle;
    }
    return low < t->rows && t->keys[low] == key ? low : -1;
}

static status read_rows(run_table *t, report *r) {
    sqlite3_stmt *statement;
    bool row = true;
    status s = ledger_statement(t->l, run_rows_sql, &statement, r);
    if (s) return s;
    while (!s && !(s = ledger_next(t->l, statement, &row, "list the runs", r)) && row) {
        if (t->rows == t->capacity) break; /* a run that began meanwhile: next time */
        t->keys[t->rows] = sqlite3_column_int64(statement, 0);
        for (int c = 0; c < OWN && !s; c++)
            if (!set_cell(t, &t->columns[c], t->rows, statement, c + 1)) s = no_memory(r);
        t->rows++;
    }
    sqlite3_reset(statement);
    return s;
}

static status count_runs(run_table *t, report *r) {
    sqlite3_stmt *statement;
    bool row = false;
    status s = ledger_statement(t->l, "SELECT count(*) FROM runs", &statement, r);
    if (!s) s = ledger_next(t->l, statement, &row, "count the runs", r);
    if (!s && row) t->capacity = sqlite3_column_int(statement, 0);
    if (!s) sqlite3_reset(statement);
    return s;
}

static void add_name(run_table *t, const char *name, run_column_kind kind) {
    if (t->name_count == TABLE_COLUMNS) return;
    t->names[t->name_count].name = arena_copy_string(t->memory, name);
    t->names[t->name_count].kind = kind;
    if (t->names[t->name_count].name) t->name_count++;
    else t->out_of_memory = true;
}

static void add_parameter_name(void *context, const char *name) {
    add_name(context, name, RUN_COLUMN_PARAMETER);
}

static void add_measure_name(void *context, const char *name) {
    add_name(context, name, RUN_COLUMN_MEASURE);
}

static status read_table(run_table *t, report *r) {
    t->changes = sqlite3_total_changes(t->l->database);
    t->data_version = data_version(t->l);
    status s = count_runs(t, r);
    if (s) return s;
    t->keys = arena_allocate(t->memory, ((size_t)t->capacity + 1) * sizeof *t->keys);
    bool good = t->keys != NULL;
    for (int c = 0; c < OWN && good; c++) {
        good = add_column(t, own_names[c], RUN_COLUMN_OWN) != NULL;
        add_name(t, own_names[c], RUN_COLUMN_OWN);
    }
    if (!good) return no_memory(r);
    s = read_rows(t, r);
    if (!s) s = ledger_each_parameter(t->l, add_parameter_name, t, r);
    if (!s) s = ledger_each_measure(t->l, add_measure_name, t, r);
    return !s && t->out_of_memory ? no_memory(r) : s;
}

status run_table_read(ledger *l, run_table **out, report *r) {
    *out = NULL;
    status s = ledger_bury(l, r);
    if (s) return s;
    run_table *t = memory_allocate(sizeof *t);
    if (!t) return no_memory(r);
    t->l = l;
    t->memory = arena_create("run table");
    s = t->memory ? read_table(t, r) : no_memory(r);
    if (s) run_table_free(t);
    else *out = t;
    return s;
}

void run_table_free(run_table *t) {
    if (!t) return;
    if (t->memory) arena_destroy(t->memory);
    memory_free(t, sizeof *t);
}

/* ---- asking ------------------------------------------------------------------------------------------------------ */

int run_table_rows(const run_table *t) {
    return t->rows;
}

const char *run_table_id(const run_table *t, int row) {
    return t->columns[OWN_ID].text[row];
}

int run_table_find(const run_table *t, const char *id) {
    for (int row = t->rows - 1; row >= 0; row--)
        if (strcmp(run_table_id(t, row), id) == 0) return row;
    return -1;
}

const char *run_table_name(const run_table *t, int index, run_column_kind *kind) {
    if (index < 0 || index >= t->name_count) return NULL;
    if (kind) *kind = t->names[index].kind;
    return t->names[index].name;
}

static status fill_column(run_table *t, run_column *c, report *r) {
    sqlite3_stmt *statement;
    bool row = true;
    status s = ledger_statement(t->l, c->kind == RUN_COLUMN_PARAMETER ? parameter_sql : measure_sql, &statement, r);
    if (s) return s;
    bind_text(statement, 1, c->name);
    while (!s && !(s = ledger_next(t->l, statement, &row, "read a column", r)) && row) {
        int at = row_of(t, sqlite3_column_int64(statement, 0));
        if (at >= 0 && !set_cell(t, c, at, statement, 1)) s = no_memory(r);
    }
    sqlite3_reset(statement);
    return s;
}

/* Whether `word` is the end of a dotted name: "eta" of "tube.damage.eta". */
static bool is_short_for(const char *name, const char *word) {
    size_t length = strlen(name), back = strlen(word);
    return back > 0 && length > back && name[length - back - 1] == '.' && strcmp(name + length - back, word) == 0;
}

/* The name that is meant: the whole one, or the only one that ends so. */
static status find_name(const run_table *t, const char *word, int *index, report *r) {
    const char *names[2 * TABLE_COLUMNS];
    int count = 0, fits = 0;
    for (int i = 0; i < t->name_count; i++) {
        const char *dot = strrchr(t->names[i].name, '.');
        names[count++] = t->names[i].name;
        if (dot) names[count++] = dot + 1;
        if (strcmp(t->names[i].name, word) == 0) {
            *index = i;
            return STATUS_OK;
        }
    }
    for (int i = t->name_count - 1; i >= 0; i--) {
        if (!is_short_for(t->names[i].name, word)) continue;
        *index = i;
        fits++;
    }
    if (fits == 1) return STATUS_OK;
    if (fits > 1) return report_input(r, NULL, 0, word, "the name of one column", "the end of several names", t->names[*index].name);
    return report_input(r, NULL, 0, word, "a column, a parameter or a measure", "none of that name", name_nearest(word, names, count));
}

status run_table_column(run_table *t, const char *name, const run_column **out, report *r) {
    int index;
    status s = find_name(t, name, &index, r);
    if (s) return s;
    for (int i = 0; i < t->column_count; i++) {
        *out = &t->columns[i];
        if (strcmp(t->columns[i].name, t->names[index].name) == 0) return STATUS_OK;
    }
    run_column *c = add_column(t, t->names[index].name, t->names[index].kind);
    if (!c) return no_memory(r);
    s = fill_column(t, c, r);
    if (s) t->column_count--;
    *out = c;
    return s;
}

/* ---- filtering --------------------------------------------------------------------------------------------------- */

typedef enum term_kind { TERM_WORD, TERM_LESS, TERM_LESS_EQUAL, TERM_MORE, TERM_MORE_EQUAL, TERM_EQUAL, TERM_UNEQUAL, TERM_CONTAINS } term_kind;

typedef struct term {
    term_kind kind;
    bool negated, is_number;
    char value[TERM];
    double number;
    const run_column *column;
} term;

static const struct {
    const char *sign;
    term_kind kind;
} signs[] = {{"<=", TERM_LESS_EQUAL}, {">=", TERM_MORE_EQUAL}, {"!=", TERM_UNEQUAL}, {"<", TERM_LESS}, {">", TERM_MORE}, {"=", TERM_EQUAL}, {"~", TERM_CONTAINS}};

/* One word of a filter: NAME SIGN VALUE, or what to look for. */
static status read_term(run_table *t, const char *text, term *out, report *r) {
    *out = (term){.negated = text[0] == '!' && text[1] != '='};
    text += out->negated;
    size_t front = strcspn(text, "<>=!~");
    if (!text[front] || front == 0) {
        snprintf(out->value, TERM, "%s", text);
        return STATUS_OK;
    }
    char name[TERM];
    snprintf(name, sizeof name, "%.*s", (int)front, text);
    for (size_t i = 0; i < sizeof signs / sizeof *signs; i++) {
        size_t length = strlen(signs[i].sign);
        if (strncmp(text + front, signs[i].sign, length) != 0) continue;
        out->kind = signs[i].kind;
        snprintf(out->value, TERM, "%s", text + front + length);
        break;
    }
    if (out->kind == TERM_WORD) return report_input(r, NULL, 0, text, "NAME<VALUE, <=, >, >=, =, != or ~", "another sign", NULL);
    char *end;
    out->number = strtod(out->value, &end);
    out->is_number = out->value[0] && !*end;
    if (!out->is_number && (out->kind == TERM_LESS || out->kind == TERM_MORE || out->kind == TERM_LESS_EQUAL || out->kind == TERM_MORE_EQUAL))
        return report_input(r, NULL, 0, text, "a number after the sign", out->value[0] ? out->value : "nothing", NULL);
    return run_table_column(t, name, &out->column, r);
}

static status read_terms(run_table *t, const char *filter, term terms[TERMS], int *count, report *r) {
    *count = 0;
    for (const char *at = filter; *at;) {
        while (isspace((unsigned char)*at)) at++;
        size_t length = 0;
        while (at[length] && !isspace((unsigned char)at[length])) length++;
        if (length == 0) break;
        char text[TERM];
        if (*count == TERMS || length >= TERM) return report_input(r, NULL, 0, "filter", "at most 24 words of under 160 bytes", "more", NULL);
        snprintf(text, sizeof text, "%.*s", (int)length, at);
        status s = read_term(t, text, &terms[(*count)++], r);
        if (s) return s;
        at += length;
    }
    return STATUS_OK;
}

static bool word_holds(const run_table *t, const term *x, int row) {
    static const char *const looked[] = {"id", "status", "title", "variant", "scene", "tags", "notes", "message"};
    for (int c = 0; c < OWN; c++)
        for (size_t k = 0; k < sizeof looked / sizeof *looked; k++) {
            const char *text = t->columns[c].text[row];
            if (text && strcmp(own_names[c], looked[k]) == 0 && strcasestr(text, x->value)) return true;
        }
    return false;
}

static bool condition_holds(const term *x, int row) {
    const char *text = x->column->text[row];
    double number = x->column->number[row];
    char digits[32];
    if (!text && isnan(number)) return x->kind == TERM_UNEQUAL;
    if (!text && x->kind == TERM_CONTAINS) snprintf(digits, sizeof digits, "%.10g", number);
    switch (x->kind) {
    case TERM_LESS: return number < x->number;
    case TERM_LESS_EQUAL: return number <= x->number;
    case TERM_MORE: return number > x->number;
    case TERM_MORE_EQUAL: return number >= x->number;
    case TERM_EQUAL: return text ? strcasecmp(text, x->value) == 0 : x->is_number && number == x->number;
    case TERM_UNEQUAL: return text ? strcasecmp(text, x->value) != 0 : !(x->is_number && number == x->number);
    case TERM_CONTAINS: return strcasestr(text ? text : digits, x->value) != NULL;
    case TERM_WORD: break;
    }
    return false;
}

status run_table_filter(run_table *t, const char *filter, int *rows, int *count, report *r) {
    term terms[TERMS];
    int term_count;
    *count = 0;
    status s = read_terms(t, filter ? filter : "", terms, &term_count, r);
    if (s) return s;
    for (int row = t->rows - 1; row >= 0; row--) {
        bool fits = true;
        for (int i = 0; i < term_count && fits; i++)
            fits = (terms[i].kind == TERM_WORD ? word_holds(t, &terms[i], row) : condition_holds(&terms[i], row)) != terms[i].negated;
        if (fits) rows[(*count)++] = row;
    }
    return STATUS_OK;
}

/* ---- sorting ----------------------------------------------------------------------------------------------------- */

typedef struct ordering {
    const run_column *column;
    bool descending;
} ordering;

static bool is_missing(const run_column *c, int row) {
    return !c->text[row] && isnan(c->number[row]);
}

/* Numbers before texts; the newer run first among equals, as the filter gives them. */
static int compare_rows(const void *a, const void *b, void *context) {
    const ordering *o = context;
    const run_column *c = o->column;
    int x = *(const int *)a, y = *(const int *)b, sign = 0;
    bool x_missing = is_missing(c, x), y_missing = is_missing(c, y);
    if (x_missing != y_missing) return x_missing ? 1 : -1;
    if (!x_missing) {
        if (!c->text[x] != !c->text[y]) sign = c->text[x] ? 1 : -1;
        else if (c->text[x]) sign = strcasecmp(c->text[x], c->text[y]);
        else sign = (c->number[x] > c->number[y]) - (c->number[x] < c->number[y]);
    }
    if (sign != 0) return o->descending ? -sign : sign;
    return (y > x) - (y < x);
}

status run_table_sort(run_table *t, const char *name, bool descending, int *rows, int count, report *r) {
    ordering o = {.descending = descending};
    status s = run_table_column(t, name, &o.column, r);
    if (s) return s;
    qsort_r(rows, (size_t)count, sizeof *rows, compare_rows, &o);
    return STATUS_OK;
}
