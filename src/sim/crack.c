#include "sim/crack.h"

#include "base/eigen.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

typedef struct cell_grid {
    double low[3], spacing;
    int64_t size[3], cells;
    double *sum, *weight; // [cells]; after averaging sum holds d, weight 0 marks an empty cell
} cell_grid;

static void bounds(const double *rest, int64_t count, cell_grid *g) {
    double high[3];
    for (int c = 0; c < 3; c++) g->low[c] = HUGE_VAL, high[c] = -HUGE_VAL;
    for (int64_t i = 0; i < count; i++)
        for (int c = 0; c < 3; c++) {
            g->low[c] = fmin(g->low[c], rest[3 * i + c]);
            high[c] = fmax(high[c], rest[3 * i + c]);
        }
    g->cells = 1;
    for (int c = 0; c < 3; c++) {
        g->size[c] = (int64_t)((high[c] - g->low[c]) / g->spacing) + 1;
        g->cells *= g->size[c];
    }
}

static void average(cell_grid *g, const double *rest, const double *damage, const double *notched, int64_t count) {
    for (int64_t i = 0; i < count; i++) {
        if (notched && notched[i] > 0) continue;
        int64_t cell = 0;
        for (int c = 0; c < 3; c++) cell = cell * g->size[c] + (int64_t)((rest[3 * i + c] - g->low[c]) / g->spacing);
        g->sum[cell] += damage[i];
        g->weight[cell] += 1;
    }
    for (int64_t i = 0; i < g->cells; i++)
        if (g->weight[i] > 0) g->sum[i] /= g->weight[i];
}

/* Central differences where both neighbours hold particles; a cell without all six says nothing, unless `thin`: then an axis that
 * lacks a neighbour counts as flat, for plates under three cells thick. */
static bool gradient(const cell_grid *g, const int64_t at[3], bool thin, double out[3]) {
    const int64_t stride[3] = {g->size[1] * g->size[2], g->size[2], 1};
    int64_t cell = at[0] * stride[0] + at[1] * stride[1] + at[2];
    if (g->weight[cell] == 0) return false;
    for (int c = 0; c < 3; c++) {
        bool inside = at[c] > 0 && at[c] < g->size[c] - 1 && g->weight[cell - stride[c]] > 0 && g->weight[cell + stride[c]] > 0;
        if (!inside && !thin) return false;
        out[c] = !inside ? 0 : (g->sum[cell + stride[c]] - g->sum[cell - stride[c]]) / (2 * g->spacing);
    }
    return true;
}

/* False when no gradient is seen. */
static bool principal(const cell_grid *g, bool thin, double normal[3]) {
    double tensor[9] = {0}, value[3], vector[3][3], d[3];
    int64_t at[3];
    for (at[0] = 0; at[0] < g->size[0]; at[0]++)
        for (at[1] = 0; at[1] < g->size[1]; at[1]++)
            for (at[2] = 0; at[2] < g->size[2]; at[2]++)
                if (gradient(g, at, thin, d))
                    for (int i = 0; i < 9; i++) tensor[i] += d[i / 3] * d[i % 3];
    eigen_symmetric(tensor, value, vector);
    if (!(value[0] > 0)) return false;
    int largest = 0;
    for (int c = 1; c < 3; c++)
        if (fabs(vector[0][c]) > fabs(vector[0][largest])) largest = c;
    double sign = vector[0][largest] < 0 ? -1 : 1;
    for (int c = 0; c < 3; c++) normal[c] = sign * vector[0][c];
    return true;
}

status crack_normal(const double *rest, const double *damage, const double *notched, int64_t count, double spacing, double normal[3],
                    bool *found, report *r) {
    memset(normal, 0, 3 * sizeof *normal);
    *found = false;
    for (int64_t i = 0; i < count && !*found; i++) *found = damage[i] > 0.5 && !(notched && notched[i] > 0);
    if (!*found) return STATUS_OK;
    cell_grid g = {.spacing = spacing};
    bounds(rest, count, &g);
    size_t bytes = (size_t)g.cells * sizeof(double);
    g.sum = memory_allocate(bytes);
    g.weight = memory_allocate(bytes);
    status code = STATUS_OK;
    if (g.sum && g.weight) {
        average(&g, rest, damage, notched, count);
        *found = principal(&g, false, normal) || principal(&g, true, normal);
    } else {
        code = report_set(r, STATUS_SYSTEM, "out of memory for the crack measure");
    }
    memory_free(g.sum, g.sum ? bytes : 0);
    memory_free(g.weight, g.weight ? bytes : 0);
    return code;
}
