/* What a frame reports: sums in f64, tile by tile, added in the tiles' order. */
#include "base/eigen.h"
#include "base/memory.h"
#include "base/threads.h"
#include "solid/tensor.h"

#include <math.h>

/* What minima and maxima start from. */
static solid_measures empty_measures(void) {
    return (solid_measures){.determinant_min = HUGE_VAL, .determinant_max = -HUGE_VAL, .stretch_min = HUGE_VAL};
}

/* ρ0 V |C|² D/2: the kinetic energy of the affine part, and its angular momentum m D ε:C. */
static void add_particle(const solid *s, const solid_tile *tile, int p, double inertia, double capacity, solid_measures *m) {
    int32_t pack = tile->first_pack + p / PACK;
    int lane = p % PACK;
    const int32_t *block = s->blocks[tile->block].coordinate;
    double mass = (double)field_at(&s->fields[FIELD_VOLUME], pack, 0, 0)[lane] * s->definition.materials[tile->material].density *
                  scale_of(s, s->density_scale, pack, lane);
    double x[3], v[3], C[9], F[9], speed2 = 0, affine2 = 0;
    for (int c = 0; c < 3; c++) {
        x[c] = s->definition.dx * ((double)field_at(&s->fields[FIELD_POSITION], pack, c, 0)[lane] + (double)block[c] * BLOCK);
        v[c] = (double)field_at(&s->fields[FIELD_VELOCITY], pack, c, 0)[lane];
        speed2 += v[c] * v[c];
        m->momentum[c] += mass * v[c];
        m->gravitational -= mass * s->definition.gravity[c] * x[c];
    }
    for (int c = 0; c < 9; c++) {
        C[c] = (double)field_at(&s->fields[FIELD_AFFINE], pack, c, 0)[lane];
        F[c] = (double)field_at(&s->fields[FIELD_DEFORMATION], pack, c, 0)[lane];
        affine2 += C[c] * C[c];
    }
    double J = matrix_determinant(F);
    m->mass += mass;
    if (capacity > 0) m->diffused_total += capacity * mass * (double)field_at(&s->fields[s->diffusion.field], pack, 0, 0)[lane];
    m->kinetic += 0.5 * mass * (speed2 + inertia * affine2);
    m->angular_momentum[0] += mass * (x[1] * v[2] - x[2] * v[1] + inertia * (C[7] - C[5]));
    m->angular_momentum[1] += mass * (x[2] * v[0] - x[0] * v[2] + inertia * (C[2] - C[6]));
    m->angular_momentum[2] += mass * (x[0] * v[1] - x[1] * v[0] + inertia * (C[3] - C[1]));
    m->determinant_min = fmin(m->determinant_min, J);
    m->determinant_max = fmax(m->determinant_max, J);
    m->speed_max = fmax(m->speed_max, sqrt(speed2));
}

static void add_stretch(const solid *s, const solid_tile *tile, int p, solid_measures *m) {
    int32_t pack = tile->first_pack + p / PACK;
    double square = 0;
    for (int row = 0; row < 3; row++) {
        double along = 0;
        for (int c = 0; c < 3; c++)
            along += (double)field_at(&s->fields[FIELD_DEFORMATION], pack, 3 * row + c, 0)[p % PACK] *
                     (double)field_at(&s->fields[s->fibre_field], pack, c, 0)[p % PACK];
        square += along * along;
    }
    if (square == 0) return; /* a body without fibres in a scene that has some */
    m->stretch_min = fmin(m->stretch_min, sqrt(square));
    m->stretch_max = fmax(m->stretch_max, sqrt(square));
}

static void add_damage(const solid *s, const solid_tile *tile, int p, solid_measures *m) {
    double d = (double)field_at(&s->fields[s->damage_field], tile->first_pack + p / PACK, 0, 0)[p % PACK];
    int bin = (int)(d * SOLID_BINS);
    m->damage_mean += d;
    m->damage_max = fmax(m->damage_max, d);
    m->broken_fraction += d > 0.9;
    m->histogram[bin < 0 ? 0 : bin >= SOLID_BINS ? SOLID_BINS - 1 : bin] += 1;
}

typedef struct measure_context {
    const solid *state;
    solid_measures *parts; // [tile_count]
} measure_context;

static void measure_tile(void *context, int64_t i, int worker) {
    measure_context *c = context;
    const solid *s = c->state;
    solid_measures *m = &c->parts[i];
    *m = empty_measures();
    tile_work w = {.state = s, .tile = &s->tiles[i], .scratch = &s->workers[worker].tile};
    for (int p = 0; p < TILE_PARTICLES; p++) w.scratch->degradation[p] = 1;
    for (int pass = 0; pass < 2; pass++)
        for (int e = 0; e < s->effect_count; e++) {
            if (!(s->material_mask[w.tile->material] >> e & 1)) continue;
            void (*stage)(tile_work *) = pass ? s->effects[e]->stages->energy : s->effects[e]->stages->degrade;
            w.constants = s->constants[w.tile->material][e];
            if (stage) stage(&w);
        }
    m->elastic = w.energy[0];
    m->fibre = w.energy[1];
    double inertia = s->definition.dx * s->definition.dx / (s->definition.kernel == KERNEL_QUADRATIC ? 4 : 3);
    double capacity = diffusion_capacity(s, w.tile);
    bool damaged = s->material_damaged[w.tile->material];
    for (int p = 0; p < w.tile->count; p++) {
        add_particle(s, w.tile, p, inertia, capacity, m);
        if (s->fibre_field >= 0) add_stretch(s, w.tile, p, m);
        if (damaged) add_damage(s, w.tile, p, m);
        else m->histogram[0] += 1;
    }
}

static void add_part(solid_measures *m, const solid_measures *part) {
    m->mass += part->mass;
    for (int c = 0; c < 3; c++) {
        m->momentum[c] += part->momentum[c];
        m->angular_momentum[c] += part->angular_momentum[c];
    }
    m->kinetic += part->kinetic;
    m->elastic += part->elastic;
    m->fibre += part->fibre;
    m->gravitational += part->gravitational;
    m->diffused_total += part->diffused_total;
    m->damage_mean += part->damage_mean;
    m->damage_max = fmax(m->damage_max, part->damage_max);
    m->broken_fraction += part->broken_fraction;
    for (int b = 0; b < SOLID_BINS; b++) m->histogram[b] += part->histogram[b];
    m->determinant_min = fmin(m->determinant_min, part->determinant_min);
    m->determinant_max = fmax(m->determinant_max, part->determinant_max);
    m->speed_max = fmax(m->speed_max, part->speed_max);
    m->stretch_min = fmin(m->stretch_min, part->stretch_min);
    m->stretch_max = fmax(m->stretch_max, part->stretch_max);
}

status solid_measure(const solid *s, solid_measures *m, report *r) {
    measure_context c = {s, memory_allocate_array((size_t)s->tile_count, sizeof *c.parts)};
    if (!c.parts) return report_set(r, STATUS_SYSTEM, "out of memory for the measures of %d tiles", s->tile_count);
    parallel_for(s->threads, s->tile_count, 8, measure_tile, &c);
    *m = empty_measures();
    for (int32_t t = 0; t < s->tile_count; t++) add_part(m, &c.parts[t]);
    memory_free(c.parts, (size_t)s->tile_count * sizeof *c.parts);
    double count = (double)s->count;
    m->damage_mean /= count;
    m->broken_fraction /= count;
    for (int b = 0; b < SOLID_BINS; b++) m->histogram[b] /= count;
    if (m->stretch_max == 0) m->stretch_min = m->stretch_max = 1;
    m->constraint_solves = s->constraint.solves;
    m->constraint_iterations = s->constraint.iterations;
    m->constraint_factorisations = s->constraint.factorisations;
    m->constraint_seconds = s->solving[EFFECT_inextensible];
    m->grip_work = s->grip_work;
    memcpy(m->grip_impulse, s->grip_impulse, sizeof m->grip_impulse);
    return STATUS_OK;
}

/* ---- stress ------------------------------------------------------------------------------------------------------ */

static void read_tile_stress(const solid *s, const solid_tile *tile, double *out) {
    tile_work w = {.state = s, .tile = tile, .scratch = &s->workers[0].tile};
    for (int p = 0; p < TILE_PARTICLES; p++) w.scratch->degradation[p] = 1;
    for (int pass = 0; pass < 2; pass++)
        for (int e = 0; e < s->effect_count; e++) {
            if (!(s->material_mask[tile->material] >> e & 1)) continue;
            void (*stage)(tile_work *) = pass ? s->effects[e]->stages->stress : s->effects[e]->stages->degrade;
            w.constants = s->constants[tile->material][e];
            w.effect = e;
            if (stage) stage(&w);
        }
    for (int p = 0; p < tile->count; p++) {
        int64_t id = s->id[(tile->first_pack + p / PACK) * PACK + p % PACK];
        for (int c = 0; c < 6; c++) out[6 * id + c] = (double)scratch_at(w.scratch->kirchhoff, 6, p / PACK, c, 0)[p % PACK];
    }
}

int solid_read(const solid *s, const char *field, double *out) {
    if (strcmp(field, "kirchhoff_stress") != 0) return particles_read(s, field, out);
    for (int32_t t = 0; out && t < s->tile_count; t++) read_tile_stress(s, &s->tiles[t], out);
    return 6;
}
