/* One number a particle, for pictures. */
#include "base/eigen.h"
#include "base/memory.h"
#include "base/names.h"
#include "geom/vector.h"
#include "sim/derived.h"
#include "sim/internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SCALAR_LIMIT = 48 };

/* ---- derived ----------------------------------------------------------------------------------------------------- */

typedef void derive(const simulation *s, const double *first, const double *second, int64_t count, double *out);

typedef struct derived {
    const char *name, *unit, *doc;
    const char *first, *second; /* fields that it is made from; NULL: none */
    int components[2];          /* that they must have */
    bool solid;                 /* of solids only */
    derive *from;
} derived;

static void derive_speed(const simulation *s, const double *v, const double *none, int64_t count, double *out) {
    (void)s, (void)none;
    for (int64_t i = 0; i < count; i++) out[i] = vector_length(v + 3 * i);
}

static void derive_displacement(const simulation *s, const double *x, const double *none, int64_t count, double *out) {
    (void)none;
    int64_t solids = engine_count(s, ENGINE_SOLID);
    for (int64_t i = 0; i < count; i++) {
        const double *rest = i < solids ? s->particles.position + 3 * i : s->sheet_points.rest + 3 * (i - solids);
        out[i] = vector_length((double[3]){x[3 * i] - rest[0], x[3 * i + 1] - rest[1], x[3 * i + 2] - rest[2]});
    }
}

static void derive_body(const simulation *s, const double *none, const double *neither, int64_t count, double *out) {
    (void)none, (void)neither;
    const uint8_t *body = simulation_bodies(s);
    for (int64_t i = 0; i < count; i++) out[i] = body[i];
}

double derived_stretch(const double F[9]) {
    double b[9], value[3], vector[3][3];
    matrix_gram(F, b);
    eigen_symmetric(b, value, vector);
    return sqrt(fmax(value[0], 0));
}

static void derive_stretch(const simulation *s, const double *F, const double *none, int64_t count, double *out) {
    (void)s, (void)none;
    for (int64_t i = 0; i < count; i++) out[i] = derived_stretch(F + 9 * i);
}

static void derive_determinant(const simulation *s, const double *F, const double *none, int64_t count, double *out) {
    (void)s, (void)none;
    for (int64_t i = 0; i < count; i++) out[i] = matrix_determinant(F + 9 * i);
}

/* The largest principal value of the Cauchy stress τ/J. */
static void derive_stress(const simulation *s, const double *tau, const double *F, int64_t count, double *out) {
    (void)s;
    for (int64_t i = 0; i < count; i++) {
        const double *t = tau + 6 * i;
        double a[9] = {t[0], t[3], t[5], t[3], t[1], t[4], t[5], t[4], t[2]}, value[3], vector[3][3], J = matrix_determinant(F + 9 * i);
        eigen_symmetric(a, value, vector);
        out[i] = J > 1e-6 ? value[0] / J : 0;
    }
}

double derived_fibre_stretch(const double F[9], const double a[3]) {
    double along[3];
    for (int r = 0; r < 3; r++) along[r] = vector_dot(F + 3 * r, a);
    return vector_dot(a, a) > 0 ? vector_length(along) : 1;
}

static void derive_fibre_stretch(const simulation *s, const double *F, const double *fibre, int64_t count, double *out) {
    (void)s;
    for (int64_t i = 0; i < count; i++) out[i] = derived_fibre_stretch(F + 9 * i, fibre + 3 * i);
}

static const derived derivations[] = {
    {"stress", "mass/(length time^2)", "largest principal stress of matrix and fibres", "kirchhoff_stress", "deformation_gradient", {6, 9}, true, derive_stress},
    {"stretch", "1", "largest principal stretch", "deformation_gradient", NULL, {9, 0}, true, derive_stretch},
    {"fibre_stretch", "1", "length of the first fibres over that at rest", "deformation_gradient", "fibre", {9, 3}, true, derive_fibre_stretch},
    {"determinant", "1", "volume over that at rest", "deformation_gradient", NULL, {9, 0}, true, derive_determinant},
    {"speed", "length/time", "", "velocity", NULL, {3, 0}, false, derive_speed},
    {"displacement", "length", "distance from the place at rest", "position", NULL, {3, 0}, false, derive_displacement},
    {"body", "1", "number of the body", NULL, NULL, {0, 0}, false, derive_body},
};
enum { DERIVATIONS = sizeof derivations / sizeof *derivations };

static bool can_derive(const simulation *s, const derived *d) {
    if (d->solid && s->sheet) return false;
    if (d->first && simulation_read(s, d->first, NULL) != d->components[0]) return false;
    return !d->second || simulation_read(s, d->second, NULL) == d->components[1];
}

/* ---- the list ---------------------------------------------------------------------------------------------------- */

static void add_scalar(simulation_scalar *out, int *count, const char *name, const char *unit, const char *doc, bool share) {
    for (int i = 0; i < *count; i++)
        if (strcmp(out[i].name, name) == 0) return;
    if (*count == SCALAR_LIMIT) return;
    simulation_scalar *to = &out[(*count)++];
    *to = (simulation_scalar){.share = share};
    snprintf(to->name, sizeof to->name, "%s", name);
    snprintf(to->unit, sizeof to->unit, "%s", unit);
    snprintf(to->doc, sizeof to->doc, "%s", doc);
}

static bool is_share(const char *name) {
    return strcmp(name, "damage") == 0 || strcmp(name, "broken") == 0;
}

static void add_fields(const simulation *s, const char *only, simulation_scalar *out, int *count) {
    for (int e = 0; e < s->plan.effect_count; e++)
        for (int i = 0; (s->plan.mask >> e & 1) && i < s->plan.effects[e]->field_count; i++) {
            const effect_field *f = &s->plan.effects[e]->fields[i];
            if (only && strcmp(f->key, only) != 0) continue;
            if (f->components == 1 && simulation_read(s, f->key, NULL) == 1) add_scalar(out, count, f->key, f->unit, f->doc, is_share(f->key));
        }
}

int simulation_scalars(const simulation *s, simulation_scalar *out, int limit) {
    simulation_scalar all[SCALAR_LIMIT];
    int count = 0;
    add_fields(s, simulation_picture_field(s), all, &count);
    add_fields(s, NULL, all, &count);
    for (int d = 0; d < DERIVATIONS; d++)
        if (can_derive(s, &derivations[d])) add_scalar(all, &count, derivations[d].name, derivations[d].unit, derivations[d].doc, false);
    for (int i = 0; i < count && i < limit; i++) out[i] = all[i];
    return count;
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

static status no_scalar(const simulation *s, const char *name, report *r) {
    simulation_scalar all[SCALAR_LIMIT];
    const char *names[SCALAR_LIMIT];
    int count = simulation_scalars(s, all, SCALAR_LIMIT);
    for (int i = 0; i < count; i++) names[i] = all[i].name;
    return report_input(r, NULL, 0, "colour", "a field with one number a particle that this run has", name, name_nearest(name, names, count));
}

static status read_derived(const simulation *s, const derived *d, double *out, report *r) {
    size_t n = (size_t)s->count, bytes[2];
    double *fields[2] = {NULL, NULL};
    const char *names[2] = {d->first, d->second};
    bool full = true;
    for (int i = 0; i < 2; i++) {
        bytes[i] = n * (size_t)d->components[i] * sizeof(double);
        if (!names[i]) continue;
        fields[i] = memory_allocate(bytes[i]);
        full = full && fields[i];
        if (fields[i]) simulation_read(s, names[i], fields[i]);
    }
    if (full) d->from(s, fields[0], fields[1], s->count, out);
    for (int i = 0; i < 2; i++) memory_free(fields[i], bytes[i]);
    return full ? STATUS_OK : report_set(r, STATUS_SYSTEM, "out of memory for the picture's colours");
}

status simulation_read_scalar(const simulation *s, const char *name, double *out, report *r) {
    for (int d = 0; d < DERIVATIONS; d++)
        if (strcmp(derivations[d].name, name) == 0 && can_derive(s, &derivations[d])) return read_derived(s, &derivations[d], out, r);
    simulation_scalar all[SCALAR_LIMIT];
    int count = simulation_scalars(s, all, SCALAR_LIMIT);
    for (int i = 0; i < count; i++)
        if (strcmp(all[i].name, name) == 0) return simulation_read(s, name, out) == 1 ? STATUS_OK : no_scalar(s, name, r);
    return no_scalar(s, name, r);
}
