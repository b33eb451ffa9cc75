/* The engine of bodies of tetrahedra: a step of symplectic Euler.
 *
 *     elements   P of F = Ds Dm⁻¹;  forces on corners  f_k = −V P ∇N_k
 *     vertices   v ← v + Δt f/m;  the effects' grid stages;  x ← x + Δt v
 *     elements   F from x, and the step limit of the new state
 *
 * Step limit: with K = Σ V Bᵀ (∂²Ψ/∂F²) B and lumped masses, ω² ≤ the largest over elements of 4 h s/ρ0, h a bound of the largest eigenvalue of
 * ∂²Ψ/∂F² (effects' stage `stiffness`) and s that of Σ ∇N ∇Nᵀ (Rayleigh's quotient is no more than the largest of its parts); symplectic Euler is
 * stable to Δt = 2/ω. Beside it F may change in a step by no more than half of max(1, |F|): what h was computed from must hold for the step. */
#include "base/clock.h"
#include "solid/tetra.h"
#include "base/memory.h"
#include "base/threads.h"
#include "solid/tensor.h"

#include <math.h>
#include <stddef.h>

enum { PHASE_ELEMENTS = 1, PHASE_VERTICES, PHASE_LIMITS };
#define LARGEST_CHANGE ((real)0.5) /* of F in a step, over max(1, |F|) */

static tetra *whole(const solid *s) {
    return (tetra *)(uintptr_t)s; /* base comes first */
}

/* Calls a stage of the effects of the tile's material, in their order. */
static void call_stage(tile_work *w, size_t offset) {
    const solid *s = w->state;
    for (int e = 0; e < s->effect_count; e++) {
        void (*stage)(tile_work *);
        memcpy(&stage, (const char *)s->effects[e]->stages + offset, sizeof stage);
        if (!stage || !(s->material_mask[w->tile->material] >> e & 1)) continue;
        w->effect = e;
        w->constants = s->constants[w->tile->material][e];
        stage(w);
    }
}

static tile_work begin_tile(tetra *m, int64_t tile, int worker) {
    solid *s = &m->base;
    tile_work w = {.state = s, .tile = &s->tiles[tile], .scratch = &s->workers[worker].tile, .result = &s->tile_results[tile],
                   .piola = m->piola + (int64_t)worker * TILE_PACKS * 9 * PACK};
    for (int i = 0; i < w.tile->pack_count * PACK; i++) w.scratch->degradation[i] = 1;
    return w;
}

/* ---- elements ---------------------------------------------------------------------------------------------------- */

SIMD_INLINE mat3v load_nine(const real *base, int32_t pack, int part) {
    vec c[9];
    for (int i = 0; i < 9; i++) c[i] = vec_load(base + ((int64_t)pack * 9 + i) * PACK + part * VEC_LANES);
    return (mat3v){c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7], c[8]};
}

/* A Bᵀ */
SIMD_INLINE mat3v times_transposed(mat3v a, mat3v b) {
#define ROWS(x, y, z) vec_fma(a.x, b.xx, vec_fma(a.y, b.xy, a.z * b.xz)), vec_fma(a.x, b.yx, vec_fma(a.y, b.yy, a.z * b.yz)), \
        vec_fma(a.x, b.zx, vec_fma(a.y, b.zy, a.z * b.zz))
    return (mat3v){ROWS(xx, xy, xz), ROWS(yx, yy, yz), ROWS(zx, zy, zz)};
#undef ROWS
}

/* A B */
SIMD_INLINE mat3v times(mat3v a, mat3v b) {
    return times_transposed(a, (mat3v){b.xx, b.yx, b.zx, b.xy, b.yy, b.zy, b.xz, b.yz, b.zz});
}

static void tile_forces(void *context, int64_t tile, int worker) {
    tetra *m = context;
    tile_work w = begin_tile(m, tile, worker);
    memset(w.piola, 0, (size_t)w.tile->pack_count * 9 * PACK * sizeof *w.piola);
    call_stage(&w, offsetof(solid_stages, piola));
    for (int k = 0; k < w.tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            int32_t pack = w.tile->first_pack + k;
            vec volume = vec_load(field_at(&m->base.fields[FIELD_VOLUME], pack, 0, part));
            mat3v H = times_transposed(load_nine(w.piola, k, part), load_nine(m->inverse, pack, part));
            const vec f[9] = {H.xx, H.yx, H.zx, H.xy, H.yy, H.zy, H.xz, H.yz, H.zz}; /* corner by corner */
            for (int c = 0; c < 9; c++) vec_store(m->force + ((int64_t)pack * 9 + c) * PACK + part * VEC_LANES, -(volume * f[c]));
        }
}

/* Ds of a pack, of places or of velocities: row-major, column k − 1 is the edge from corner 0 to corner k. */
static void gather_edges(const tetra *m, int32_t pack, real edge[9 * PACK], real rate[9 * PACK]) {
    for (int lane = 0; lane < PACK; lane++) {
        const int32_t *corner = m->corner + (int64_t)pack * 4 * PACK + lane;
        const double *x0 = m->place + 3 * (int64_t)corner[0];
        const real *v0 = m->nodes + NODE * (int64_t)corner[0];
        for (int k = 0; k < 3; k++) {
            const double *x = m->place + 3 * (int64_t)corner[(k + 1) * PACK];
            const real *v = m->nodes + NODE * (int64_t)corner[(k + 1) * PACK];
            for (int c = 0; c < 3; c++) {
                edge[(3 * c + k) * PACK + lane] = (real)(x[c] - x0[c]);
                rate[(3 * c + k) * PACK + lane] = v[c] - v0[c];
            }
        }
    }
}

static void tile_deform(void *context, int64_t tile, int worker) {
    tetra *m = context;
    solid *s = &m->base;
    tile_work w = begin_tile(m, tile, worker);
    real edge[9 * PACK], *rate = w.piola; /* [pack_count][9][PACK]; free between forces */
    memset(w.result, 0, sizeof *w.result);
    for (int k = 0; k < w.tile->pack_count; k++) {
        int32_t pack = w.tile->first_pack + k;
        gather_edges(m, pack, edge, rate + k * 9 * PACK);
        for (int part = 0; part < PACK_PARTS; part++) {
            mat3v F = times(load_nine(edge, 0, part), load_nine(m->inverse, pack, part));
            mat3v_store(&s->fields[FIELD_DEFORMATION], pack, part, F);
            vec size = mat3v_square_sum(F);
            for (int lane = 0; lane < VEC_LANES; lane++) {
                int p = k * PACK + part * VEC_LANES + lane;
                if (!(size[lane] * 0 == 0) && !w.result->fault && p < w.tile->count) w.result->fault = p + 1;
            }
        }
    }
    memset(w.scratch->wave_modulus, 0, (size_t)w.tile->pack_count * PACK * sizeof(real));
    call_stage(&w, offsetof(solid_stages, stiffness));
    real inverse_density = (real)(1 / s->definition.materials[w.tile->material].density);
    vec limit = vec_all(0);
    for (int k = 0; k < w.tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            int32_t pack = w.tile->first_pack + k;
            mat3v F = mat3v_load(&s->fields[FIELD_DEFORMATION], pack, part);
            mat3v change = times(load_nine(rate, k, part), load_nine(m->inverse, pack, part));
            vec spread = vec_load(m->spread + pack * PACK + part * VEC_LANES);
            vec waves = vec_sqrt(vec_load(scratch_at(w.scratch->wave_modulus, 1, k, 0, part)) * spread * inverse_density);
            vec size = vec_max(vec_sqrt(mat3v_square_sum(F)), vec_all(1));
            vec speed = vec_sqrt(mat3v_square_sum(change)) / (LARGEST_CHANGE * size);
            limit = vec_max(vec_max(waves, speed), limit);
        }
    w.result->limit[EFFECT_elastic] = vec_largest(limit);
}

void tetra_deform(tetra *m) {
    solid *s = &m->base;
    parallel_for(s->threads, s->tile_count, 4, tile_deform, m);
    memset(s->limits, 0, sizeof s->limits);
    for (int32_t t = 0; t < s->tile_count; t++)
        s->limits[EFFECT_elastic] = fmax(s->limits[EFFECT_elastic], (double)s->tile_results[t].limit[EFFECT_elastic]);
}

/* ---- vertices ---------------------------------------------------------------------------------------------------- */

typedef struct vertex_context {
    tetra *mesh;
    real dt;
} vertex_context;

static void add_corner(const tetra *m, int32_t entry, real f[3]) {
    const real *force = m->force + (int64_t)(entry / 4 / PACK) * 9 * PACK + entry / 4 % PACK;
    int corner = entry % 4;
    for (int c = 0; c < 3; c++)
        f[c] += corner ? force[(3 * (corner - 1) + c) * PACK] : -(force[c * PACK] + force[(3 + c) * PACK] + force[(6 + c) * PACK]);
}

static void move_block(void *context, int64_t block, int worker) {
    (void)worker;
    vertex_context *u = context;
    tetra *m = u->mesh;
    solid *s = &m->base;
    real *nodes = m->nodes + block * BLOCK_NODES * NODE;
    double *places = m->place + block * BLOCK_NODES * 3;
    for (int64_t v = 0; v < BLOCK_NODES && block * BLOCK_NODES + v < m->vertex_count; v++) {
        real f[3] = {0, 0, 0}, inverse = u->dt / nodes[v * NODE + 3];
        const int32_t *row = m->row + block * BLOCK_NODES + v;
        for (int32_t i = row[0]; i < row[1]; i++) add_corner(m, m->entry[i], f);
        for (int c = 0; c < 3; c++) nodes[v * NODE + c] += inverse * f[c];
    }
    grid_work w = {.state = s, .slot = (int32_t)block, .nodes = nodes, .places = places, .dt = u->dt, .result = &s->slot_results[block]};
    memset(w.result, 0, sizeof *w.result);
    for (int e = 0; e < s->effect_count; e++)
        if ((s->mask >> e & 1) && s->effects[e]->stages->grid) s->effects[e]->stages->grid(&w);
    for (int v = 0; v < BLOCK_NODES; v++)
        for (int c = 0; c < 3; c++) places[3 * v + c] += (double)u->dt * (double)nodes[v * NODE + c];
}

static void move_vertices(tetra *m, real dt) {
    solid *s = &m->base;
    vertex_context u = {m, dt};
    parallel_for(s->threads, m->vertex_blocks, 4, move_block, &u);
    for (int32_t b = 0; b < m->vertex_blocks; b++) {
        s->grip_work += s->slot_results[b].grip_work;
        for (int c = 0; c < 3; c++) s->grip_impulse[c] += s->slot_results[b].grip_impulse[c];
    }
}

/* ---- the table --------------------------------------------------------------------------------------------------- */

static void destroy(solid *s) {
    if (!s) return;
    tetra *m = whole(s);
    memory_free(m->piola, (size_t)s->threads * TILE_PACKS * 9 * PACK * sizeof *m->piola);
    memory_free(s->workers, (size_t)s->threads * sizeof *s->workers);
    tetra_free(m);
    memory_free(m, sizeof *m);
}

static solid *create(const solid_definition *definition, report *r) {
    tetra *m = memory_allocate(sizeof *m);
    if (!m) {
        report_set(r, STATUS_SYSTEM, "out of memory for the engine of tetrahedra");
        return NULL;
    }
    solid *s = &m->base;
    solid_define(s, definition);
    solid_constants_refresh(s);
    s->workers = memory_allocate_array((size_t)s->threads, sizeof *s->workers);
    m->piola = memory_allocate_array((size_t)s->threads * TILE_PACKS * 9 * PACK, sizeof *m->piola);
    status code = s->workers && m->piola ? STATUS_OK : report_set(r, STATUS_SYSTEM, "out of memory for the threads' work space");
    if (code == STATUS_OK) code = tetra_load(m, r);
    if (code != STATUS_OK) {
        destroy(s);
        return NULL;
    }
    tetra_deform(m);
    return s;
}

static status sort(solid *s, report *r) {
    (void)s, (void)r;
    return STATUS_OK;
}

static status step(solid *s, double dt, solid_fault *fault, report *r) {
    tetra *m = whole(s);
    double t0 = clock_seconds();
    parallel_for(s->threads, s->tile_count, 4, tile_forces, m);
    double t1 = clock_seconds();
    move_vertices(m, (real)dt);
    double t2 = clock_seconds();
    tetra_deform(m);
    double t3 = clock_seconds();
    s->seconds[PHASE_ELEMENTS] += t1 - t0;
    s->seconds[PHASE_VERTICES] += t2 - t1;
    s->seconds[PHASE_LIMITS] += t3 - t2;
    for (int32_t t = 0; t < s->tile_count; t++) {
        if (!s->tile_results[t].fault) continue;
        int lane = s->tile_results[t].fault - 1;
        int32_t pack = s->tiles[t].first_pack + lane / PACK;
        *fault = (solid_fault){.particle = m->corner[(int64_t)pack * 4 * PACK + lane % PACK], .effect = "elastic",
                               .quantity = "deformation gradient", .value = NAN};
        return report_set(r, STATUS_DIVERGED, "tetrahedron %d, at vertex %lld, has a deformation gradient that is not finite (effect elastic)",
                          s->id[pack * PACK + lane % PACK], (long long)fault->particle);
    }
    return STATUS_OK;
}

static int stage_names(uint32_t mask, char (*text)[48], int limit) {
    static const stage_place places[] = {
        {"elements", "piola", offsetof(solid_stages, piola)},
        {"vertices", "grid", offsetof(solid_stages, grid)},
        {"elements", "stiffness", offsetof(solid_stages, stiffness)},
    };
    return solid_stage_names(places, sizeof places / sizeof *places, mask, text, limit);
}

/* What runs before forces, follows a history or solves on the grid has no place here; nor has stress that is known as τ only. */
static bool knows(const effect *e) {
    const solid_stages *s = e->stages;
    return !s->before && !s->feel && !s->degrade && !s->update && !s->solve && !s->constrain && !s->stress == !s->piola;
}

static void refresh(solid *s) {
    solid_constants_refresh(s);
    tetra_deform(whole(s));
}

static double bytes_per_particle(const solid *s) {
    const tetra *m = whole(s);
    double element = (double)(9 + 1 + 9 + 1 + 9) * sizeof(real) + 4 * sizeof *m->corner + 4 * sizeof *m->entry + sizeof *s->id;
    for (int f = FIELD_BUILT_IN; f < s->field_count; f++) element += s->fields[f].components * (double)sizeof(real);
    double vertex = 3 * sizeof *m->place + NODE * sizeof *m->nodes + sizeof *m->row;
    return vertex + element * s->pack_count * PACK / (double)s->count;
}

#define TEXT_(x) #x
#define TEXT(x) TEXT_(x)

const solid_engine solid_tetra_table = {
    .simd = TEXT(SOLID_SIMD_NAME), .precision = SUNDER_PRECISION, .effects = solid_effects, .effect_count = SOLID_EFFECTS,
    .create = create, .destroy = destroy, .boundaries = solid_boundaries, .limits = solid_limits, .sort = sort, .step = step,
    .measure = tetra_measure, .read = tetra_read, .components = tetra_components, .save = tetra_save, .restore = tetra_restore,
    .stages = stage_names, .knows = knows, .surround = solid_surround, .refresh = refresh, .bytes_per_particle = bytes_per_particle, .phases = solid_phases,
    .phase_names = {[PHASE_ELEMENTS] = "elements", [PHASE_VERTICES] = "vertices", [PHASE_LIMITS] = "limits"},
};
