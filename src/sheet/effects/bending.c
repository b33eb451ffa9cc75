/* Bending stiffness, an option: a sheet of the paper has none.
 *
 * U = ½ B Σ A_i |L_i|², with L_i = Σ_j l_ij (x_j − x_i) the Laplacian of the places over the rest sheet: its mean curvature vector for a sheet that
 * bends without stretching (as in quadratic bending models; Bergou et al. 2006). Affine motions give none. The force is the gradient,
 * F_k = B A_k Σ_j l_kj (L_k − L_j), since A_i l_ij is symmetric. Only particles with all their neighbours count: edges are free, and cracks. */
#include "sheet/state.h"

static void declare(const effect_values *own, sheet_plan *p) {
    p->bending = own->value[0][0];
}

static void curve(const pack_work *w) {
    sheet *s = w->state;
    const sheet_pack *pack = &s->packs[w->pack];
    for (int part = 0; part < PACK_PARTS; part++) {
        int first = part * VEC_LANES;
        own_place own;
        vec r[4], sum[3] = {vec_all(0), vec_all(0), vec_all(0)}, total = vec_all(0);
        own_place_load(s, w->pack, first, &own);
        for (int32_t k = 0; k < pack->slots; k++) {
            int64_t at = ((int64_t)pack->first_slot + k) * PACK + first;
            vec laplace = vec_load(s->laplace + at);
            bond_vector(s, s->neighbour + at, &own, r);
            for (int c = 0; c < 3; c++) sum[c] = vec_fma(laplace, r[c], sum[c]);
            total = total + laplace;
        }
        vec_mask whole = total == vec_load(s->whole + (int64_t)w->pack * PACK + first);
        for (int c = 0; c < 3; c++) {
            real lanes[VEC_LANES];
            vec_store(lanes, vec_select(whole, sum[c], vec_all(0)));
            for (int i = 0; i < VEC_LANES; i++) s->curvature[((int64_t)w->pack * PACK + first + i) * 4 + c] = lanes[i];
        }
    }
}

static void straighten(const pack_work *w) {
    sheet *s = w->state;
    const sheet_pack *pack = &s->packs[w->pack];
    for (int part = 0; part < PACK_PARTS; part++) {
        int first = part * VEC_LANES;
        int32_t self[VEC_LANES];
        for (int i = 0; i < VEC_LANES; i++) self[i] = w->pack * PACK + first + i;
        vec own[4], far[4], sum[3] = {vec_all(0), vec_all(0), vec_all(0)};
        vec_gather4(s->curvature, self, 4, own);
        for (int32_t k = 0; k < pack->slots; k++) {
            int64_t at = ((int64_t)pack->first_slot + k) * PACK + first;
            vec_gather4(s->curvature, s->neighbour + at, 4, far);
            for (int c = 0; c < 3; c++) sum[c] = vec_fma(vec_load(s->laplace + at), own[c] - far[c], sum[c]);
        }
        for (int c = 0; c < 3; c++) {
            real *v = s->velocity + ((int64_t)w->pack * 3 + c) * PACK + first;
            vec_store(v, vec_fma(sum[c], vec_all(w->body->bending * w->dt), vec_load(v)));
        }
    }
}

static status before(sheet *s, real dt, report *r) {
    (void)r;
    if (!s->laplace) return STATUS_OK; /* a stiffness of 0 */
    sheet_for_packs(s, dt, curve);
    sheet_for_packs(s, dt, straighten);
    return STATUS_OK;
}

static double energy(const sheet *s, int32_t p, int lane) {
    const sheet_pack *pack = &s->packs[p];
    const body_constants *b = &s->bodies[pack->body];
    if (!s->laplace) return 0;
    double L[3] = {0}, square = 0;
    real total = 0;
    for (int32_t k = 0; k < pack->slots; k++) {
        int64_t at = ((int64_t)pack->first_slot + k) * PACK + lane;
        total += s->laplace[at];
        for (int c = 0; c < 3; c++)
            L[c] += (double)s->laplace[at] * (coordinate_of(s->node + (int64_t)s->neighbour[at] * NODE, c) - coordinate_of(node_at(s, p, lane), c));
    }
    int64_t place = (int64_t)p * PACK + lane;
    if (total != s->whole[place]) return 0;
    for (int c = 0; c < 3; c++) square += L[c] * L[c];
    return 0.5 * (double)b->bending * b->surface_density * square * (double)s->area[place];
}

static const parameter parameters[] = {
    {.key = "stiffness", .unit = "mass length^2/time^2", .doc = "moment per curvature and width; a plate's is E h^3/(12 (1 - nu^2))", .minimum = 0,
     .maximum = 1e18, .live = true, .logarithmic = true, .required = true, .short_form = "bending = 1e-4"},
};

static const sheet_stages stages = {.declare = declare, .before = before, .energy = energy};

const effect SHEET_EFFECT(bending) = {
    .name = "bending", .engine = ENGINE_SHEET, .scope = SCOPE_MATERIAL, .doc = "resistance to bending", .reference = "METHOD.md section 6, beyond the paper",
    .parameters = parameters, .parameter_count = 1, .needs = SHEET_ELASTICITY, .sheet = &stages,
};
