/* Poisson-disk sampling by rounds of dart throwing over the lattice's cells.
 *
 * The points are those of one random set that fills all space, cut by the shape: so a body's density does not rise at
 * its surface. In each round every cell proposes one dart, drawn by the counter-based generator from (seed, round,
 * cell). A dart is dropped if a point accepted in an earlier round is too near. Of the rest, a dart is accepted if no
 * dart of this round that is too near has a higher rank, the rank being a random number as well (Matérn's second
 * thinning, once a round). No decision depends on the order in which cells are visited.
 *
 * Coordinates are whole numbers, 2^21 to a cell, so that distances are compared exactly. */
#include "base/random.h"
#include "geom/sampling_cells.h"

#include <math.h>
#include <string.h>

/* With these rounds and SAMPLING_POISSON_DISTANCE there is one point a cell on average (tests/unit/test_sampling.c). No
 * cell of side 1 was seen to hold 5 points that far apart; if one could, its further darts are dropped. */
enum { STREAM_DART = 0x5b00, STREAM_RANK = 0x5c00, ROUNDS = 24, POINTS_PER_CELL = 4 };
enum { UNITS_BITS = 21, UNITS = 1 << UNITS_BITS };
enum { NEIGHBOURS = 27 };

/* Cells are thrown darts at if their centre is within this many spacings of the shape: half a diagonal, so that no
 * point of the shape is missed, and a cell of rivals outside it. Without these the outermost half spacing holds 8 % too
 * few points; a second cell of them changes nothing that can be measured. */
static const double MARGIN = 1.9;

typedef enum dart_state { DART_DROPPED, DART_STANDING, DART_ACCEPTED } dart_state;

typedef struct dart_cell {
    int64_t site; /* place in dart_board.slot */
    uint64_t key, rank;
    int32_t dart[3];
    int32_t count; /* accepted points */
    int32_t point[POINTS_PER_CELL][3];
    dart_state state;
} dart_cell;

typedef struct dart_board {
    int64_t low[3], side[3]; /* the padded block of sites, in cells */
    int64_t sites, active;
    int32_t *slot;   /* [sites] 1 + place in `cell`, 0 where no darts are thrown */
    dart_cell *cell; /* [active], by site: x slowest */
    int64_t shift[NEIGHBOURS];
    int32_t offset[NEIGHBOURS][3];
    int64_t least_squared; /* the squared minimum distance, in units */
} dart_board;

static void site_index(const dart_board *board, int64_t site, int64_t index[3]) {
    index[0] = board->low[0] + site / (board->side[1] * board->side[2]);
    index[1] = board->low[1] + site / board->side[2] % board->side[1];
    index[2] = board->low[2] + site % board->side[2];
}

/* The cell itself first, then the neighbours across faces, edges and corners: the likeliest conflicts are met first. */
static void list_neighbours(dart_board *board) {
    int count = 0;
    for (int corner = 0; corner <= 3; corner++)
        for (int code = 0; code < NEIGHBOURS; code++) {
            int offset[3] = {code / 9 - 1, code / 3 % 3 - 1, code % 3 - 1};
            if (offset[0] * offset[0] + offset[1] * offset[1] + offset[2] * offset[2] != corner) continue;
            for (int i = 0; i < 3; i++) board->offset[count][i] = offset[i] * UNITS;
            board->shift[count++] = (offset[0] * board->side[1] + offset[1]) * board->side[2] + offset[2];
        }
}

/* Numbers the cells near the shape in slot[]; returns how many there are. The outermost layer stays empty, so that
 * neighbours need no bounds check. */
static int64_t mark_cells(dart_board *board, const cell_range *cells) {
    double margin = MARGIN * cells->spacing;
    int64_t active = 0;
    for (int64_t i = 1; i < board->side[0] - 1; i++)
        for (int64_t j = 1; j < board->side[1] - 1; j++) {
            int64_t row = (i * board->side[1] + j) * board->side[2];
            for (int64_t k = 1; k < board->side[2] - 1;) {
                double distance =
                    cell_distance(cells, (int64_t[3]){board->low[0] + i, board->low[1] + j, board->low[2] + k});
                int64_t run = cells_within(fabs(distance - margin), cells->spacing, board->side[2] - 1 - k);
                for (; run > 0; run--, k++)
                    if (distance < margin) board->slot[row + k] = (int32_t)++active;
            }
        }
    return active;
}

static void board_destroy(dart_board *board) {
    memory_free(board->slot, (size_t)board->sites * sizeof *board->slot);
    memory_free(board->cell, (size_t)board->active * sizeof *board->cell);
}

static status board_create(dart_board *board, const cell_range *cells, report *r) {
    int64_t padding = (int64_t)ceil(MARGIN) + 1;
    *board = (dart_board){.sites = 1};
    for (int i = 0; i < 3; i++) {
        board->low[i] = cells->low[i] - padding;
        board->side[i] = cells->count[i] + 2 * padding;
        board->sites *= board->side[i];
    }
    board->least_squared = (int64_t)ceil(SAMPLING_POISSON_DISTANCE * SAMPLING_POISSON_DISTANCE * UNITS * UNITS);
    list_neighbours(board);
    board->slot = memory_allocate_array((size_t)board->sites, sizeof *board->slot);
    if (!board->slot) return report_set(r, STATUS_SYSTEM, "out of memory for the cells of a Poisson-disk sample");
    board->active = mark_cells(board, cells);
    board->cell = memory_allocate_array((size_t)board->active, sizeof *board->cell);
    if (!board->cell) {
        memory_free(board->slot, (size_t)board->sites * sizeof *board->slot);
        return report_set(r, STATUS_SYSTEM, "out of memory for the darts of a Poisson-disk sample");
    }
    for (int64_t site = 0; site < board->sites; site++) {
        if (!board->slot[site]) continue;
        dart_cell *cell = &board->cell[board->slot[site] - 1];
        int64_t index[3];
        site_index(board, site, index);
        cell->site = site;
        cell->key = cell_key(index);
    }
    return STATUS_OK;
}

/* The neighbour number n of a cell, or NULL. */
static dart_cell *neighbour(const dart_board *board, const dart_cell *cell, int n) {
    int32_t slot = board->slot[cell->site + board->shift[n]];
    return slot ? &board->cell[slot - 1] : NULL;
}

/* Whether `theirs`, in the neighbour cell at `offset`, is nearer to `ours` than the minimum distance. */
static bool too_near(const dart_board *board, const int32_t ours[3], const int32_t theirs[3], const int32_t offset[3]) {
    int64_t x = offset[0] + theirs[0] - ours[0], y = offset[1] + theirs[1] - ours[1],
            z = offset[2] + theirs[2] - ours[2];
    return x * x + y * y + z * z < board->least_squared;
}

static bool hits_a_point(const dart_board *board, const dart_cell *cell) {
    for (int n = 0; n < NEIGHBOURS; n++) {
        const dart_cell *other = neighbour(board, cell, n);
        for (int i = 0; other && i < other->count; i++)
            if (too_near(board, cell->dart, other->point[i], board->offset[n])) return true;
    }
    return false;
}

static bool is_outranked(const dart_board *board, const dart_cell *cell) {
    for (int n = 1; n < NEIGHBOURS; n++) {
        const dart_cell *other = neighbour(board, cell, n);
        if (!other || other->state == DART_DROPPED || other->rank > cell->rank) continue;
        if (too_near(board, cell->dart, other->dart, board->offset[n])) return true;
    }
    return false;
}

static void throw_darts(dart_board *board, uint64_t seed, uint64_t round) {
    for (int64_t c = 0; c < board->active; c++) {
        dart_cell *cell = &board->cell[c];
        uint64_t bits = random_bits(seed, STREAM_DART + round, cell->key);
        for (int i = 0; i < 3; i++) cell->dart[i] = (int32_t)(bits >> (UNITS_BITS * i) & (UNITS - 1));
        bool dropped = cell->count == POINTS_PER_CELL || hits_a_point(board, cell);
        cell->state = dropped ? DART_DROPPED : DART_STANDING;
        if (!dropped) cell->rank = random_bits(seed, STREAM_RANK + round, cell->key);
    }
    for (int64_t c = 0; c < board->active; c++) {
        dart_cell *cell = &board->cell[c];
        if (cell->state == DART_STANDING && !is_outranked(board, cell)) cell->state = DART_ACCEPTED;
    }
    for (int64_t c = 0; c < board->active; c++) {
        dart_cell *cell = &board->cell[c];
        if (cell->state == DART_ACCEPTED) memcpy(cell->point[cell->count++], cell->dart, sizeof cell->dart);
    }
}

static status collect_points(const dart_board *board, const cell_range *cells, point_set *points, report *r) {
    for (int64_t c = 0; c < board->active; c++) {
        const dart_cell *cell = &board->cell[c];
        int64_t index[3];
        site_index(board, cell->site, index);
        for (int p = 0; p < cell->count; p++) {
            double x[3];
            for (int i = 0; i < 3; i++)
                x[i] = ((double)index[i] + ((double)cell->point[p][i] + 0.5) / UNITS) * cells->spacing;
            if (!(shape_distance(cells->body, x) < 0.0)) continue;
            status code = point_set_add(points, x, r);
            if (code) return code;
        }
    }
    return STATUS_OK;
}

status poisson_sample(const cell_range *cells, uint64_t seed, point_set *points, report *r) {
    dart_board board;
    status code = board_create(&board, cells, r);
    if (code) return code;
    for (uint64_t round = 0; round < ROUNDS; round++) throw_darts(&board, seed, round);
    code = collect_points(&board, cells, points, r);
    board_destroy(&board);
    return code;
}
