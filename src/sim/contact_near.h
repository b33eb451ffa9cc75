/* Which particles of sheets and solids may touch: the bookkeeping of contact.c. Nothing here depends on the number of threads. */
#ifndef SUNDER_SIM_CONTACT_NEAR_H
#define SUNDER_SIM_CONTACT_NEAR_H

#include "sim/internal.h"

enum { CONTACT_COLOURS = 8, CONTACT_SURROUNDINGS = 27 };

/* Space is cut into cubes a little over twice the reach wide; cells are those that sheets' particles lie in or reach into. */
typedef struct contact_cell {
    int64_t slot; /* in the table */
    int32_t place[3];
    int32_t group;        /* −1: sheets only reach into it */
    int32_t first, count; /* its solid particles, chained by solid_next */
} contact_cell;

/* The sheets' particles of one cell. Two groups whose cells' places are equal modulo 2 share no solid particle: their cells lie a cell apart. */
typedef struct contact_group {
    int32_t first, last;    /* chained by sheet_next */
    double low[3], high[3]; /* what they reach */
    int32_t cell, near_count, near[CONTACT_SURROUNDINGS]; /* cells, its own among them, that this box meets */
} contact_group;

typedef struct contact_near {
    double reach; /* H: what is farther apart does not touch */
    int threads;

    int32_t pack_capacity, pack_count, near_pack_count;
    int32_t *near_packs;        // [pack_count], whose particles may touch
    uint8_t *pack_is_near;      // [pack_count]
    int32_t *pack_population;   // [pack_count]
    double (*sheet_place)[3], (*sheet_velocity)[3]; // [pack_count · SHEET_PACK], of near packs
    int32_t *sheet_id, *sheet_next; // likewise
    bool *sheet_held;               // likewise

    int32_t block_capacity, block_count;
    _Atomic uint8_t *marks; // [block_capacity], of the solid's blocks
    int32_t *blocks;        // [block_capacity], those that are marked: [block_count] of them
    int32_t *block_start;   // [block_capacity], where their particles begin below, and the last ones end

    int32_t solid_capacity;
    double (*solid_place)[3];   // [solid_capacity]
    double (*solid_motion)[12]; // likewise, of those in cells: velocity, affine velocity
    int32_t *solid_at, *solid_id, *solid_cell, *solid_next; // likewise; cell −1: in none
    uint8_t *solid_moved;       // likewise

    int32_t group_capacity, group_count;
    contact_group *groups; // [group_capacity]
    int32_t *order;        // [group_capacity], by colour
    int32_t colour_start[CONTACT_COLOURS + 1];
    int32_t cell_capacity, cell_count;
    contact_cell *cells;   // [cell_capacity]
    int64_t table_size;    /* a power of two, at least twice the cells */
    int32_t *table;        // [table_size], −1: empty
    int32_t most;          /* of solid particles around any group */
} contact_near;

/* false without memory. */
bool contact_near_create(contact_near *n, const simulation *s, double reach, int threads);
void contact_near_free(contact_near *n);

/* Finds all anew. Errors: out of memory. */
status contact_near_find(contact_near *n, const simulation *s, report *r);

#endif
