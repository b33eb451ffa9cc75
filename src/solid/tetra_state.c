/* What leaves the engine of tetrahedra: measures, fields at the vertices, the state for a checkpoint. */
#include "base/eigen.h"
#include "base/memory.h"
#include "solid/tensor.h"
#include "solid/tetra.h"

#include <math.h>
#include <stdio.h>

static const tetra *whole(const solid *s) {
    return (const tetra *)(const void *)s; /* base comes first */
}

/* ---- measures ---------------------------------------------------------------------------------------------------- */

static void add_vertex(const tetra *m, int64_t v, solid_measures *out) {
    const double *x = m->place + 3 * v, *g = m->base.definition.gravity;
    double mass = (double)m->nodes[NODE * v + 3], u[3], square = 0;
    for (int c = 0; c < 3; c++) {
        u[c] = (double)m->nodes[NODE * v + c];
        square += u[c] * u[c];
        out->momentum[c] += mass * u[c];
        out->gravitational -= mass * g[c] * x[c];
    }
    for (int c = 0; c < 3; c++) {
        int a = (c + 1) % 3, b = (c + 2) % 3;
        out->angular_momentum[c] += mass * (x[a] * u[b] - x[b] * u[a]);
    }
    out->mass += mass;
    out->kinetic += 0.5 * mass * square;
    out->speed_max = fmax(out->speed_max, sqrt(square));
}

static double determinant_of(const solid *s, int32_t pack, int lane) {
    double F[9];
    for (int c = 0; c < 9; c++) F[c] = (double)field_at(&s->fields[FIELD_DEFORMATION], pack, c, 0)[lane];
    return matrix_determinant(F);
}

static void add_tile(const solid *s, const solid_tile *tile, tile_scratch *scratch, solid_measures *out) {
    tile_work w = {.state = s, .tile = tile, .scratch = scratch};
    for (int i = 0; i < TILE_PARTICLES; i++) scratch->degradation[i] = 1;
    for (int e = 0; e < s->effect_count; e++) {
        w.constants = s->constants[tile->material][e];
        if ((s->material_mask[tile->material] >> e & 1) && s->effects[e]->stages->energy) s->effects[e]->stages->energy(&w);
    }
    out->elastic += w.energy[0];
    out->fibre += w.energy[1];
    for (int p = 0; p < tile->count; p++) {
        double J = determinant_of(s, tile->first_pack + p / PACK, p % PACK);
        out->determinant_min = fmin(out->determinant_min, J);
        out->determinant_max = fmax(out->determinant_max, J);
    }
}

status tetra_measure(const solid *s, solid_measures *out, report *r) {
    (void)r;
    const tetra *m = whole(s);
    *out = (solid_measures){.determinant_min = HUGE_VAL, .determinant_max = -HUGE_VAL, .histogram = {1}, .grip_work = s->grip_work};
    memcpy(out->grip_impulse, s->grip_impulse, sizeof s->grip_impulse);
    for (int64_t v = 0; v < m->vertex_count; v++) add_vertex(m, v, out);
    for (int32_t t = 0; t < s->tile_count; t++) add_tile(s, &s->tiles[t], &s->workers[0].tile, out);
    return STATUS_OK;
}

/* ---- fields at the vertices -------------------------------------------------------------------------------------- */

static const solid_field *element_field(const solid *s, const char *name) {
    for (int f = FIELD_DEFORMATION; f < s->field_count; f++)
        if (strcmp(s->fields[f].name, name) == 0) return &s->fields[f];
    return NULL;
}

int tetra_components(const solid *s, const char *field) {
    if (strcmp(field, "position") == 0 || strcmp(field, "velocity") == 0) return 3;
    const solid_field *f = element_field(s, field);
    return f ? f->components : 0;
}

/* The elements' mean by volume; a vertex' own volume is a quarter of its elements'. */
static void read_elements(const tetra *m, const solid_field *f, double *out) {
    const solid *s = &m->base;
    bool own = f == &s->fields[FIELD_VOLUME];
    for (int64_t v = 0; v < m->vertex_count; v++) {
        double *row = out + v * f->components, total = 0;
        for (int c = 0; c < f->components; c++) row[c] = 0;
        for (int32_t i = m->row[v]; i < m->row[v + 1]; i++) {
            int32_t slot = m->entry[i] / 4;
            double volume = (double)field_at(&s->fields[FIELD_VOLUME], slot / PACK, 0, 0)[slot % PACK];
            for (int c = 0; c < f->components; c++) row[c] += (own ? 0.25 : volume) * (double)field_at(f, slot / PACK, c, 0)[slot % PACK];
            total += volume;
        }
        for (int c = 0; c < f->components && !own; c++) row[c] /= total;
    }
}

int tetra_read(const solid *s, const char *field, double *out) {
    const tetra *m = whole(s);
    if (strcmp(field, "position") == 0) {
        memcpy(out, m->place, (size_t)m->vertex_count * 3 * sizeof *out);
        return 3;
    }
    if (strcmp(field, "velocity") == 0) {
        for (int64_t v = 0; v < m->vertex_count; v++)
            for (int c = 0; c < 3; c++) out[3 * v + c] = (double)m->nodes[NODE * v + c];
        return 3;
    }
    const solid_field *f = element_field(s, field);
    if (f) read_elements(m, f, out);
    return f ? f->components : 0;
}

/* ---- checkpoints ------------------------------------------------------------------------------------------------- */

/* F and the limits follow from the vertices, bit for bit. */
status tetra_save(const solid *s, record_list *list, report *r) {
    const tetra *m = whole(s);
    void *place = NULL, *nodes = NULL, *scalars = NULL;
    status code = record_add(list, "solid/place", RECORD_F64, m->vertex_count, 3, "length", &place, r);
    if (code == STATUS_OK)
        code = record_add(list, "solid/nodes", SUNDER_PRECISION == 32 ? RECORD_F32 : RECORD_F64, m->vertex_count, NODE, NULL, &nodes, r);
    if (code == STATUS_OK) code = record_add(list, "solid/scalars", RECORD_F64, 4, 1, NULL, &scalars, r);
    if (code != STATUS_OK) return code;
    memcpy(place, m->place, (size_t)m->vertex_count * 3 * sizeof *m->place);
    memcpy(nodes, m->nodes, (size_t)m->vertex_count * NODE * sizeof *m->nodes);
    memcpy(scalars, &s->grip_work, sizeof s->grip_work);
    memcpy((double *)scalars + 1, s->grip_impulse, sizeof s->grip_impulse);
    return STATUS_OK;
}

status tetra_restore(solid *s, const record_list *list, report *r) {
    tetra *m = (tetra *)(void *)s;
    void *place, *nodes, *scalars;
    status code = record_require(list, "solid/place", RECORD_F64, m->vertex_count, 3, &place, r);
    if (code == STATUS_OK)
        code = record_require(list, "solid/nodes", SUNDER_PRECISION == 32 ? RECORD_F32 : RECORD_F64, m->vertex_count, NODE, &nodes, r);
    if (code == STATUS_OK) code = record_require(list, "solid/scalars", RECORD_F64, 4, 1, &scalars, r);
    if (code != STATUS_OK) return code;
    memcpy(m->place, place, (size_t)m->vertex_count * 3 * sizeof *m->place);
    memcpy(m->nodes, nodes, (size_t)m->vertex_count * NODE * sizeof *m->nodes);
    memcpy(&s->grip_work, scalars, sizeof s->grip_work);
    memcpy(s->grip_impulse, (double *)scalars + 1, sizeof s->grip_impulse);
    tetra_deform(m);
    return STATUS_OK;
}
