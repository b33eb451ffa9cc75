/* From a mesh at rest to packs of elements and blocks of vertices. */
#include "base/eigen.h"
#include "base/memory.h"
#include "solid/tetra.h"

#include <math.h>

static void add_field(solid *s, int field, const char *name, int components) {
    s->fields[field] = (solid_field){.name = name, .components = components};
    s->field_count = field + 1;
}

/* Of the fields that the particle engine keeps, elements have two. */
static void plan_fields(solid *s) {
    for (int f = 0; f < FIELD_BUILT_IN; f++) add_field(s, f, "", 0);
    add_field(s, FIELD_DEFORMATION, "deformation_gradient", 9);
    add_field(s, FIELD_VOLUME, "volume", 1);
    s->field_count = FIELD_BUILT_IN;
    s->diffusion.field = s->damage_field = s->history_field = s->fibre_field = s->fibre2_field = -1;
    memset(s->own_field, -1, sizeof s->own_field); /* an effect with a history is none of theirs */
    if (s->definition.fibre1) add_field(s, s->fibre_field = s->field_count, "fibre", 3);
    if (s->definition.fibre2) add_field(s, s->fibre2_field = s->field_count, "fibre2", 3);
}

/* Where the tile that begins with element i ends: elements of one material that follow each other, as many as a tile takes. */
static int64_t tile_end(const solid_definition *d, int64_t i) {
    int64_t end = i + 1;
    while (end < d->element_count && end < i + TILE_PARTICLES && d->material[end] == d->material[i]) end++;
    return end;
}

static status allocate(tetra *m, report *r) {
    solid *s = &m->base;
    const solid_definition *d = &s->definition;
    for (int64_t i = 0; i < d->element_count; i = tile_end(d, i)) {
        s->tile_count++;
        s->pack_count += (int32_t)((tile_end(d, i) - i + PACK - 1) / PACK);
    }
    m->vertex_count = d->count;
    m->vertex_blocks = (int32_t)((d->count + BLOCK_NODES - 1) / BLOCK_NODES);
    size_t packs = (size_t)s->pack_count, nodes = (size_t)m->vertex_blocks * BLOCK_NODES, tiles = (size_t)s->tile_count;
    s->tile_capacity = s->result_capacity = s->tile_count;
    s->pack_capacity = s->pack_count;
    s->tiles = memory_allocate_array(tiles, sizeof *s->tiles);
    s->tile_results = memory_allocate_array(tiles, sizeof *s->tile_results);
    s->id = memory_allocate_array(packs * PACK, sizeof *s->id);
    s->slot_capacity = m->vertex_blocks;
    s->slot_results = memory_allocate_array((size_t)m->vertex_blocks, sizeof *s->slot_results);
    m->place = memory_allocate_array(3 * nodes, sizeof *m->place);
    m->nodes = memory_allocate_array(NODE * nodes, sizeof *m->nodes);
    m->corner = memory_allocate_array(4 * packs * PACK, sizeof *m->corner);
    m->row = memory_allocate_array((size_t)m->vertex_count + 1, sizeof *m->row);
    m->entry = memory_allocate_array(4 * (size_t)d->element_count, sizeof *m->entry);
    m->inverse = memory_allocate_array(9 * packs * PACK, sizeof *m->inverse);
    m->spread = memory_allocate_array(packs * PACK, sizeof *m->spread);
    m->force = memory_allocate_array(9 * packs * PACK, sizeof *m->force);
    bool whole = s->tiles && s->tile_results && s->id && s->slot_results && m->place && m->nodes && m->corner && m->row && m->entry &&
                 m->inverse && m->spread && m->force;
    for (int f = 0; f < s->field_count; f++) {
        if (s->fields[f].components == 0) continue;
        s->fields[f].data = memory_allocate_array(packs * (size_t)s->fields[f].components * PACK, sizeof(real));
        whole = whole && s->fields[f].data;
    }
    return whole ? STATUS_OK : report_set(r, STATUS_SYSTEM, "out of memory for %lld tetrahedra", (long long)d->element_count);
}

void tetra_free(tetra *m) {
    solid *s = &m->base;
    size_t packs = (size_t)s->pack_capacity, nodes = (size_t)m->vertex_blocks * BLOCK_NODES;
    memory_free(s->slot_results, (size_t)m->vertex_blocks * sizeof *s->slot_results);
    memory_free(m->place, 3 * nodes * sizeof *m->place);
    memory_free(m->nodes, NODE * nodes * sizeof *m->nodes);
    memory_free(m->corner, 4 * packs * PACK * sizeof *m->corner);
    memory_free(m->row, ((size_t)m->vertex_count + 1) * sizeof *m->row);
    memory_free(m->entry, 4 * (size_t)s->definition.element_count * sizeof *m->entry);
    memory_free(m->inverse, 9 * packs * PACK * sizeof *m->inverse);
    memory_free(m->spread, packs * PACK * sizeof *m->spread);
    memory_free(m->force, 9 * packs * PACK * sizeof *m->force);
    particles_free(s);
}

/* Dm⁻¹ by rows, which are the gradients of corners 1, 2 and 3; returns det Dm, six times the volume. */
static double invert_edges(const double *const x[4], double inverse[9]) {
    double e[3][3];
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++) e[k][c] = x[k + 1][c] - x[0][c];
    for (int k = 0; k < 3; k++) {
        const double *a = e[(k + 1) % 3], *b = e[(k + 2) % 3];
        for (int c = 0; c < 3; c++) inverse[3 * k + c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
    }
    double determinant = e[0][0] * inverse[0] + e[0][1] * inverse[1] + e[0][2] * inverse[2];
    for (int i = 0; i < 9; i++) inverse[i] /= determinant;
    return determinant;
}

/* The largest eigenvalue of Σ ∇N ∇Nᵀ over the four corners. */
static double gradient_spread(const double inverse[9]) {
    double sum[9] = {0}, value[3], axis[3][3], last[3];
    for (int c = 0; c < 3; c++) last[c] = -(inverse[c] + inverse[3 + c] + inverse[6 + c]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            sum[3 * i + j] = last[i] * last[j];
            for (int k = 0; k < 3; k++) sum[3 * i + j] += inverse[3 * k + i] * inverse[3 * k + j];
        }
    eigen_symmetric(sum, value, axis);
    return value[0];
}

static status load_element(tetra *m, int64_t element, int32_t pack, int lane, report *r) {
    solid *s = &m->base;
    const solid_definition *d = &s->definition;
    const double *x[4];
    double inverse[9];
    for (int k = 0; k < 4; k++) {
        int32_t vertex = d->corner[4 * element + k];
        m->corner[(pack * 4 + k) * PACK + lane] = vertex;
        x[k] = d->position + 3 * (int64_t)vertex;
    }
    double volume = invert_edges(x, inverse) / 6;
    if (!(volume > 0) || !isfinite(volume))
        return report_set(r, STATUS_INPUT, "tetrahedron %lld has the volume %g at rest", (long long)element, volume);
    s->id[pack * PACK + lane] = (int32_t)element;
    field_at(&s->fields[FIELD_VOLUME], pack, 0, 0)[lane] = (real)volume;
    m->spread[pack * PACK + lane] = (real)gradient_spread(inverse);
    for (int c = 0; c < 9; c++) m->inverse[(pack * 9 + c) * PACK + lane] = (real)inverse[c];
    for (int c = 0; c < 3; c++) {
        if (s->fibre_field >= 0) field_at(&s->fields[s->fibre_field], pack, c, 0)[lane] = (real)d->fibre1[3 * element + c];
        if (s->fibre2_field >= 0) field_at(&s->fields[s->fibre2_field], pack, c, 0)[lane] = (real)d->fibre2[3 * element + c];
    }
    double share = 0.25 * volume * d->materials[d->material[element]].density;
    for (int k = 0; k < 4; k++) m->nodes[(int64_t)d->corner[4 * element + k] * NODE + 3] += (real)share;
    return STATUS_OK;
}

static status load_elements(tetra *m, report *r) {
    solid *s = &m->base;
    const solid_definition *d = &s->definition;
    for (int32_t i = 0; i < s->pack_count * PACK; i++) s->id[i] = -1;
    int32_t tile = 0, pack = 0;
    for (int64_t i = 0, end; i < d->element_count; i = end) {
        end = tile_end(d, i);
        int32_t packs = (int32_t)((end - i + PACK - 1) / PACK);
        s->tiles[tile++] = (solid_tile){.material = d->material[i], .first_pack = pack, .pack_count = packs, .count = (int32_t)(end - i)};
        for (int64_t k = i; k < end; k++) {
            status code = load_element(m, k, pack + (int32_t)((k - i) / PACK), (int)((k - i) % PACK), r);
            if (code != STATUS_OK) return code;
        }
        pack += packs;
    }
    return STATUS_OK;
}

/* Which corners meet at each vertex: counted, summed, filled in order of slots. */
static void load_incidence(tetra *m) {
    const solid *s = &m->base;
    for (int pass = 0; pass < 2; pass++) {
        for (int32_t slot = 0; slot < s->pack_count * PACK; slot++)
            for (int k = 0; k < 4 && s->id[slot] >= 0; k++) {
                int32_t vertex = m->corner[(slot / PACK * 4 + k) * PACK + slot % PACK];
                if (pass) m->entry[m->row[vertex]++] = 4 * slot + k;
                else m->row[vertex + 1]++;
            }
        if (pass == 0)
            for (int64_t v = 0; v < m->vertex_count; v++) m->row[v + 1] += m->row[v];
    }
    for (int64_t v = m->vertex_count; v > 0; v--) m->row[v] = m->row[v - 1]; /* filling moved each start to the next one's */
    m->row[0] = 0;
}

status tetra_load(tetra *m, report *r) {
    const solid_definition *d = &m->base.definition;
    plan_fields(&m->base);
    status code = allocate(m, r);
    if (code == STATUS_OK) code = load_elements(m, r);
    if (code != STATUS_OK) return code;
    load_incidence(m);
    for (int64_t v = 0; v < d->count; v++)
        for (int c = 0; c < 3; c++) {
            m->place[3 * v + c] = d->start[3 * v + c];
            m->nodes[NODE * v + c] = (real)d->velocity[3 * v + c];
        }
    return STATUS_OK;
}
