#include "store/table.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

enum { DEFAULT_WIDTH = 80, LEAST_WIDTH = 20 };

typedef struct table_row {
    struct table_row *next;
    const char *cells[]; /* [count] */
} table_row;

struct table {
    arena *memory;
    int count;
    table_column *columns; /* [count] */
    int *widths;           /* [count] widest cell */
    int *fitted;           /* [count] what table_print makes of it */
    const char **titles;   /* [count] */
    bool *used;            /* [count] whether any row has content */
    table_row *first, *last;
    int rows;
};

table *table_create(const table_column *columns, int count) {
    arena *memory = arena_create("table");
    if (!memory) return NULL;
    size_t n = (size_t)count;
    table *t = arena_allocate(memory, sizeof *t);
    table_column *copy = arena_allocate(memory, n * sizeof *copy);
    int *widths = arena_allocate(memory, 2 * n * sizeof *widths);
    const char **titles = arena_allocate(memory, n * sizeof *titles);
    bool *used = arena_allocate(memory, n * sizeof *used);
    if (!t || !copy || !widths || !titles || !used) {
        arena_destroy(memory);
        return NULL;
    }
    memcpy(copy, columns, n * sizeof *copy);
    for (size_t i = 0; i < n; i++) {
        used[i] = columns[i].keep;
        titles[i] = arena_copy_string(memory, columns[i].title);
        if (titles[i]) continue;
        arena_destroy(memory);
        return NULL;
    }
    *t = (table){.memory = memory,
                 .count = count,
                 .columns = copy,
                 .widths = widths,
                 .fitted = widths + n,
                 .titles = titles,
                 .used = used};
    return t;
}

void table_destroy(table *t) {
    if (t) arena_destroy(t->memory);
}

/* ---- widths of UTF-8 text ---------------------------------------------------------------------------------------- */

/* Bytes of the character at s; a byte that starts none counts as one. */
static int character_bytes(const char *s) {
    unsigned char c = (unsigned char)*s;
    int bytes = c >= 0xf0 ? 4 : c >= 0xe0 ? 3 : c >= 0xc0 ? 2 : 1;
    for (int i = 1; i < bytes; i++)
        if ((s[i] & 0xc0) != 0x80) return i;
    return bytes;
}

/* Columns of the character at s, near enough: none for combining accents, two for East Asian wide ones. */
static int character_columns(const char *s, int bytes) {
    unsigned c = (unsigned char)*s;
    if (bytes == 2) c = (c & 0x1fu) << 6 | ((unsigned)s[1] & 0x3fu);
    if (bytes == 3) c = (c & 0x0fu) << 12 | ((unsigned)s[1] & 0x3fu) << 6 | ((unsigned)s[2] & 0x3fu);
    if (bytes == 4) return 2;
    if (c >= 0x300 && c <= 0x36f) return 0;
    return (c >= 0x1100 && c <= 0x115f) || (c >= 0x2e80 && c <= 0xd7a3) || (c >= 0xf900 && c <= 0xfaff) ||
                   (c >= 0xff00 && c <= 0xff60)
               ? 2
               : 1;
}

static int text_columns(const char *text) {
    int columns = 0;
    for (const char *s = text; *s; s += character_bytes(s)) columns += character_columns(s, character_bytes(s));
    return columns;
}

status table_add(table *t, const char *const *cells, report *r) {
    table_row *row = arena_allocate(t->memory, sizeof *row + (size_t)t->count * sizeof row->cells[0]);
    bool good = row != NULL;
    for (int i = 0; i < t->count && good; i++) {
        char *copy = arena_copy_string(t->memory, cells[i] ? cells[i] : "");
        good = copy != NULL;
        if (!good) break;
        for (char *s = copy; *s; s++)
            if ((unsigned char)*s < 0x20 || *s == 0x7f) *s = ' ';
        int columns = text_columns(copy);
        if (columns > t->widths[i]) t->widths[i] = columns;
        if (copy[0]) t->used[i] = true;
        row->cells[i] = copy;
    }
    if (!good) return report_set(r, STATUS_SYSTEM, "out of memory for a table");
    if (t->last)
        t->last->next = row;
    else
        t->first = row;
    t->last = row;
    t->rows++;
    return STATUS_OK;
}

int table_rows(const table *t) {
    return t->rows;
}

/* ---- printing ---------------------------------------------------------------------------------------------------- */

static void print_spaces(FILE *out, int count) {
    if (count > 0) fprintf(out, "%*s", count, "");
}

/* Prints `text` in `width` columns, cut with an ellipsis when it is longer. `last` cells are not padded. */
static void print_cell(FILE *out, const char *text, int width, bool right, bool last) {
    int columns = text_columns(text);
    if (columns <= width) {
        if (right) print_spaces(out, width - columns);
        fputs(text, out);
        if (!right && !last) print_spaces(out, width - columns);
        return;
    }
    int done = 0;
    for (const char *s = text; *s; s += character_bytes(s)) {
        int next = character_columns(s, character_bytes(s));
        if (done + next > width - 1) break;
        fwrite(s, 1, (size_t)character_bytes(s), out);
        done += next;
    }
    fputs("…", out);
    if (!last) print_spaces(out, width - 1 - done);
}

static void print_row(const table *t, FILE *out, const char *const *cells, const char *indent, int gap) {
    int last = t->count - 1;
    while (last > 0 && (!t->used[last] || (!cells[last][0] && !t->columns[last].right))) last--;
    fputs(indent, out);
    bool begun = false;
    for (int i = 0; i <= last; i++) {
        if (!t->used[i]) continue;
        if (begun) print_spaces(out, gap);
        print_cell(out, cells[i], t->fitted[i], t->columns[i].right, i == last);
        begun = true;
    }
    fputc('\n', out);
}

/* Takes columns away, one at a time from the widest that may be cut, until the table fits or nothing may be cut. */
static void shrink(const table *t, int *widths, int excess) {
    while (excess > 0) {
        int widest = -1;
        for (int i = 0; i < t->count; i++)
            if (t->used[i] && t->columns[i].least > 0 && widths[i] > t->columns[i].least &&
                (widest < 0 || widths[i] > widths[widest]))
                widest = i;
        if (widest < 0) return;
        widths[widest]--;
        excess--;
    }
}

void table_print(const table *t, FILE *out, int width, const char *indent) {
    int total = (int)strlen(indent), shown = 0;
    bool titled = false;
    for (int i = 0; i < t->count; i++) {
        int title = text_columns(t->titles[i]);
        t->fitted[i] = t->widths[i] > title ? t->widths[i] : title;
        if (!t->used[i]) continue;
        titled = titled || t->titles[i][0];
        total += t->fitted[i];
        shown++;
    }
    int gap = total + 2 * (shown - 1) <= width ? 2 : 1;
    shrink(t, t->fitted, total + gap * (shown - 1) - width);
    if (shown > 0 && titled) print_row(t, out, t->titles, indent, gap);
    for (const table_row *row = t->first; row; row = row->next) print_row(t, out, row->cells, indent, gap);
}

int table_terminal_width(FILE *out) {
    const char *columns = getenv("COLUMNS");
    int width = columns ? atoi(columns) : 0;
    struct winsize size;
    if (width <= 0 && fileno(out) >= 0 && ioctl(fileno(out), TIOCGWINSZ, &size) == 0) width = size.ws_col;
    if (width <= 0) return DEFAULT_WIDTH;
    return width < LEAST_WIDTH ? LEAST_WIDTH : width;
}
