/* How much a lattice holds a crack back, worked out (METHOD.md §6, 6): the table of src/sheet/trapping.c.
 *
 * A strip of a lattice, clamped above and below, drawn apart by a small strain, with a crack over its first third; linear bonds, small displacements.
 * The bond that is stretched most is broken, the strip comes to rest, and so on. Each break needs a load, as energy of the strip ahead over the energy
 * of the bonds that a unit of crack cuts; the crack runs at the largest of a few periods. With SUNDER_TRAPPING set the whole table is printed. */
#include "check.h"

#include "sheet/network.h"

enum { BONDS = LATTICE_LIMIT };

typedef struct strip {
    sheet_lattice lattice;
    int across, rows, count, bonds;
    double rise, height, middle;
    double bond[BONDS][2], weight[BONDS], length[BONDS];
    double sum, crossing; /* Σ W A, and Σ A W y⁺: bonds that a unit of crack cuts */
    int (*neighbour)[BONDS]; // [count], −1: none
    bool (*cut)[BONDS];      // [count]
    double (*place)[2];      // [count]
    bool *fixed;             // [count]
    double *u, *r, *p, *q;   // [count][2]
} strip;

static void find_weights(strip *s, double radius) {
    double all[BONDS][2], weight[BONDS];
    report r;
    int count = lattice_neighbours(s->lattice, radius, all);
    CHECK(lattice_weights(WEIGHT_ISOTROPIC, radius, (const double(*)[2])all, count, weight, &r) == STATUS_OK);
    for (int k = 0; k < count; k++) {
        if (!(weight[k] > 0)) continue;
        memcpy(s->bond[s->bonds], all[k], sizeof all[k]);
        s->length[s->bonds] = hypot(all[k][0], all[k][1]);
        s->weight[s->bonds++] = weight[k];
        s->sum += weight[k] * s->rise;
        s->crossing += weight[k] * s->rise * fmax(0, all[k][1]);
    }
}

static double shift(const strip *s, int row) {
    return s->lattice == SHEET_HEXAGONAL && row % 2 ? 0.5 : 0;
}

static int find_neighbour(const strip *s, int i, int k) {
    double x = s->place[i][0] + s->bond[k][0], y = s->place[i][1] + s->bond[k][1];
    int row = (int)lround(y / s->rise);
    if (row < 0 || row >= s->count / s->across) return -1;
    int column = (int)lround(x - shift(s, row));
    return column < 0 || column >= s->across ? -1 : row * s->across + column;
}

static bool is_cut(const strip *s, int i, int j) {
    double a = s->place[i][1] - s->middle, b = s->place[j][1] - s->middle;
    return (a >= 0) != (b >= 0) && s->place[i][0] + (s->place[j][0] - s->place[i][0]) * a / (a - b) < s->across / 3.0;
}

static strip *make_strip(sheet_lattice lattice, double radius, int rows) {
    strip *s = calloc(1, sizeof *s);
    s->lattice = lattice, s->rows = rows, s->across = 3 * rows, s->rise = lattice == SHEET_HEXAGONAL ? sqrt(0.75) : 1;
    find_weights(s, radius);
    int clamp = (int)ceil(radius / s->rise);
    s->count = s->across * (rows + 2 * clamp - 1);
    size_t n = (size_t)s->count;
    s->neighbour = malloc(n * sizeof *s->neighbour), s->cut = calloc(n, sizeof *s->cut), s->place = malloc(n * sizeof *s->place), s->fixed = calloc(n, sizeof *s->fixed);
    s->u = calloc(2 * n, sizeof(double)), s->r = calloc(2 * n, sizeof(double)), s->p = calloc(2 * n, sizeof(double)), s->q = calloc(2 * n, sizeof(double));
    double low = s->rise * (clamp - 1);
    s->height = rows * s->rise;
    s->middle = low + 0.5 * s->height + (rows % 2 ? 0 : 0.5 * s->rise);
    for (int i = 0; i < s->count; i++) {
        int row = i / s->across;
        double y = s->rise * row;
        s->place[i][0] = i % s->across + shift(s, row), s->place[i][1] = y;
        s->fixed[i] = y < low + 1e-9 || y > low + s->height - 1e-9;
        s->u[2 * i + 1] = fmin(fmax(y - low, 0), s->height);
    }
    for (int i = 0; i < s->count; i++)
        for (int k = 0; k < s->bonds; k++) {
            int j = s->neighbour[i][k] = find_neighbour(s, i, k);
            s->cut[i][k] = j >= 0 && is_cut(s, i, j);
        }
    return s;
}

static void free_strip(strip *s) {
    free(s->neighbour), free(s->cut), free(s->place), free(s->fixed), free(s->u), free(s->r), free(s->p), free(s->q);
    free(s);
}

/* Of a bond, times its length squared. */
static double lengthening(const strip *s, const double *u, int i, int k) {
    int j = s->neighbour[i][k];
    return s->bond[k][0] * (u[2 * j] - u[2 * i]) + s->bond[k][1] * (u[2 * j + 1] - u[2 * i + 1]);
}

static void apply(const strip *s, const double *u, double *f) {
    for (int i = 0; i < s->count; i++) {
        f[2 * i] = f[2 * i + 1] = 0;
        for (int k = 0; k < s->bonds && !s->fixed[i]; k++) {
            if (s->neighbour[i][k] < 0 || s->cut[i][k]) continue;
            double square = s->length[k] * s->length[k], pull = s->weight[k] / (square * square) * lengthening(s, u, i, k);
            f[2 * i] -= pull * s->bond[k][0], f[2 * i + 1] -= pull * s->bond[k][1];
        }
    }
}

static void come_to_rest(strip *s) {
    int n = 2 * s->count;
    double square = 0;
    apply(s, s->u, s->q);
    for (int i = 0; i < n; i++) {
        s->p[i] = s->r[i] = s->fixed[i / 2] ? 0 : -s->q[i];
        square += s->r[i] * s->r[i];
    }
    for (int k = 0; k < 20000 && sqrt(square) > 1e-10 * s->across; k++) {
        double along = 0, next = 0;
        apply(s, s->p, s->q);
        for (int i = 0; i < n; i++) along += s->p[i] * s->q[i];
        for (int i = 0; i < n; i++) {
            s->u[i] += square / along * s->p[i];
            s->r[i] -= square / along * s->q[i];
            next += s->r[i] * s->r[i];
        }
        for (int i = 0; i < n; i++) s->p[i] = s->r[i] + next / square * s->p[i];
        square = next;
    }
}

/* Breaks the bond that is stretched most, away from clamps and ends; its stretch. */
static double break_one(strip *s) {
    double most = -1;
    int at = 0, bond = 0;
    for (int i = 0; i < s->count; i++) {
        double x = s->place[i][0], y = s->place[i][1];
        if (x < 0.25 * s->rows || x > s->across - 0.5 * s->rows || fabs(y - s->middle) > 0.25 * s->height) continue;
        for (int k = 0; k < s->bonds; k++) {
            if (s->neighbour[i][k] < i || s->cut[i][k]) continue;
            double stretch = lengthening(s, s->u, i, k) / (s->length[k] * s->length[k]);
            if (stretch > most * (1 + 1e-7)) most = stretch, at = i, bond = k;
        }
    }
    int other = s->neighbour[at][bond];
    s->cut[at][bond] = true;
    for (int k = 0; k < s->bonds; k++)
        if (s->neighbour[other][k] == at) s->cut[other][k] = true;
    return most;
}

/* With c = 6 E h/Σ W A a unit of crack takes c η² Σ A W y⁺/2 h, and the strip ahead gives (9/8) E ε² H/2, here at ε = 1. */
static double trapping(sheet_lattice lattice, double radius, int rows, double periods) {
    strip *s = make_strip(lattice, radius, rows);
    double bonds = 0, most = 0;
    for (int k = 0; k < s->bonds; k++) bonds += fmax(0, s->bond[k][1]) / s->rise;
    int breaks = (int)(periods * bonds);
    for (int k = 0; k < breaks; k++) {
        come_to_rest(s);
        double stretch = break_one(s), load = 9.0 / 8 * s->height / (stretch * stretch * 6 * s->crossing / s->sum);
        if (k >= (int)(0.3 * breaks)) most = fmax(most, load); /* the first have a straight crack behind them that no load has made */
    }
    free_strip(s);
    return most;
}

static void the_table_is_what_comes_out(void) {
    static const struct {
        sheet_lattice lattice;
        double radius;
        const char *name;
    } cases[] = {{SHEET_SQUARE, 1.5, "square, R = 1.5"}, {SHEET_SQUARE, 2.3, "square, R = 2.3"}, {SHEET_HEXAGONAL, 1.75, "hexagonal, R = 1.75"}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char text[128];
        double expected = trapping(cases[k].lattice, cases[k].radius, 30, 2);
        snprintf(text, sizeof text, "strip at rest, %s: trapping of the table", cases[k].name);
        CHECK_ROW("METHOD 6", text, expected, trapping_at_rest(cases[k].lattice, cases[k].radius), 0.01 * expected);
    }
}

int main(void) {
    if (getenv("SUNDER_TRAPPING"))
        for (int lattice = SHEET_SQUARE; lattice <= SHEET_HEXAGONAL; lattice++)
            for (double radius = 1.5; radius < 6.01; radius += radius < 3.19 ? 0.1 : 0.5)
                printf("  %d R = %.2f: %.3f\n", lattice, radius, trapping((sheet_lattice)lattice, radius, 30, radius < 4.6 ? 2 : 1.2));
    RUN(the_table_is_what_comes_out);
    return check_finish();
}
