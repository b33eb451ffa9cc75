/* Elasticity of the matrix, fixed-corotated: a second model, chosen instead of `elastic` (METHOD.md §1).
 *
 * Ψμ + Ψλ = μ |F − R|² + λ/2 (J − 1)², F = R S (Stomakhin et al. 2012). With the axes n_i and stretches s_i of b = F Fᵀ, V = √b:
 *     τ = P Fᵀ = 2μ (b − V) + λ (J − 1) J I = Σ (2μ s_i (s_i − 1) + λ (J − 1) J) n_i n_iᵀ.
 * R is a rotation always: where J < 0 the smallest s_i counts as negative (of equal ones, some one). Then Ψμ = μ (|F|² − 2 max_R R:F + 3)
 * for every F, continuous through collapse, and an inverted particle is driven back along its thinnest axis.
 * The plain Lamé λ gives (E, ν) as the linear response. Damage scales Ψμ always and Ψλ only in tension (J ≥ 1), as in `elastic`. */
#include "base/eigen.h"
#include "solid/elasticity.h"
#include "solid/stretch.h"

enum { MU, LAMBDA, WAVE_LAMBDA };
#define TINY_SQUARE ((real)1e-24) /* of a stretch: beneath it the direction is lost */

static void constants(const effect_values *all, const solid_definition *d, bool protects, real out[CONSTANTS]) {
    (void)d, (void)protects;
    double mu = 0, lambda = 0, lame_lambda;
    solid_elastic_moduli(all, &mu, &lambda, &lame_lambda);
    out[MU] = (real)mu;
    out[LAMBDA] = (real)lambda;
    out[WAVE_LAMBDA] = (real)fmax(lambda, 0); /* negative where nu is: then it stiffens no wave */
}

/* The s_i, one of the smallest negated where J < 0. */
SIMD_INLINE vec3v signed_stretches(vec3v square, vec J) {
    vec3v s = {vec_sqrt(square.x), vec_sqrt(square.y), vec_sqrt(square.z)};
    vec_mask inverted = J < 0, x_least = (s.x <= s.y) & (s.x <= s.z), y_least = ~x_least & (s.y <= s.z);
    return (vec3v){vec_select(inverted & x_least, -s.x, s.x), vec_select(inverted & y_least, -s.y, s.y),
                   vec_select(inverted & ~x_least & ~y_least, -s.z, s.z)};
}

/* v made a unit vector, or `other` where v is next to nothing. */
SIMD_INLINE vec3v direction_or(vec3v v, vec3v other) {
    vec square = vec3v_dot(v, v);
    return vec3v_select(square > TINY_SQUARE, vec3v_scale(1 / vec_sqrt(vec_max(square, vec_all(TINY_SQUARE))), v), other);
}

/* R = Σ n_i m_iᵀ, s_i m_i = Fᵀ n_i, for every F: m of the smallest stretch is what makes R a rotation (det R = 1, also where J < 0), and m of
 * a stretch that is lost is some direction across the others. */
SIMD_INLINE mat3v rotation(mat3v F) {
    stretch3v e = mat3v_stretch(F, mat3v_gram(F));
    vec3v s = e.square, n1 = e.first, n2 = e.second, n3 = e.third, p1 = e.pulled_first, p2 = e.pulled_second, p3 = e.pulled_third;
    vec_mask x_least = (s.x <= s.y) & (s.x <= s.z), y_least = ~x_least & (s.y <= s.z);
    vec3v least = vec3v_select(x_least, n1, vec3v_select(y_least, n2, n3));
    vec3v a = vec3v_select(x_least, n2, n1), pulled_a = vec3v_select(x_least, p2, p1);
    vec3v b = vec3v_select(x_least | y_least, n3, n2), pulled_b = vec3v_select(x_least | y_least, p3, p2);
    vec_mask swap = vec3v_dot(pulled_a, pulled_a) < vec3v_dot(pulled_b, pulled_b);
    vec3v large = vec3v_select(swap, b, a), middle = vec3v_select(swap, a, b);
    vec3v pulled_middle = vec3v_select(swap, pulled_a, pulled_b);
    vec3v m1 = direction_or(vec3v_select(swap, pulled_b, pulled_a), large);
    vec along = vec3v_dot(pulled_middle, m1), zero = vec_all(0), one = vec_all(1);
    vec3v axis = vec3v_select(vec_abs(m1.x) < (real)0.6, (vec3v){one, zero, zero}, (vec3v){zero, one, zero});
    vec3v across = direction_or(vec3v_cross(m1, axis), axis); /* never short: the axis is not along m1 */
    vec3v m2 = direction_or((vec3v){pulled_middle.x - along * m1.x, pulled_middle.y - along * m1.y, pulled_middle.z - along * m1.z}, across);
    vec handed = vec_select(vec3v_dot(vec3v_cross(large, middle), least) < 0, vec_all(-1), one);
    vec3v m3 = vec3v_scale(handed, vec3v_cross(m1, m2));
#define ROW(c)                                                                                                         \
    vec_fma(large.c, m1.x, vec_fma(middle.c, m2.x, least.c * m3.x)), vec_fma(large.c, m1.y, vec_fma(middle.c, m2.y, least.c * m3.y)), \
        vec_fma(large.c, m1.z, vec_fma(middle.c, m2.z, least.c * m3.z))
    return (mat3v){ROW(x), ROW(y), ROW(z)};
#undef ROW
}

static void stress(tile_work *w) {
    const solid_field *F_field = &w->state->fields[FIELD_DEFORMATION];
    real mu = w->constants[MU], lambda = w->constants[LAMBDA];
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            mat3v F = mat3v_load(F_field, w->tile->first_pack + k, part);
            vec g = vec_load(scratch_at(w->scratch->degradation, 1, k, 0, part));
            vec J = mat3v_determinant(F), shear = stiffened(w, k, part, 2 * mu * g);
            vec pressure = stiffened(w, k, part, degraded_lambda(J, g, lambda)) * (J - 1) * J;
            stretch3v stretch = mat3v_stretch(F, mat3v_gram(F));
            vec3v s = signed_stretches(stretch.square, J), n1 = stretch.first, n2 = stretch.second, n3 = stretch.third;
            vec t1 = vec_fma(shear * s.x, s.x - 1, pressure), t2 = vec_fma(shear * s.y, s.y - 1, pressure),
                t3 = vec_fma(shear * s.z, s.z - 1, pressure);
            real *tau = w->scratch->kirchhoff;
            vec_store(scratch_at(tau, 6, k, 0, part), vec_fma(t1 * n1.x, n1.x, vec_fma(t2 * n2.x, n2.x, t3 * n3.x * n3.x)));
            vec_store(scratch_at(tau, 6, k, 1, part), vec_fma(t1 * n1.y, n1.y, vec_fma(t2 * n2.y, n2.y, t3 * n3.y * n3.y)));
            vec_store(scratch_at(tau, 6, k, 2, part), vec_fma(t1 * n1.z, n1.z, vec_fma(t2 * n2.z, n2.z, t3 * n3.z * n3.z)));
            vec_store(scratch_at(tau, 6, k, 3, part), vec_fma(t1 * n1.x, n1.y, vec_fma(t2 * n2.x, n2.y, t3 * n3.x * n3.y)));
            vec_store(scratch_at(tau, 6, k, 4, part), vec_fma(t1 * n1.y, n1.z, vec_fma(t2 * n2.y, n2.z, t3 * n3.y * n3.z)));
            vec_store(scratch_at(tau, 6, k, 5, part), vec_fma(t1 * n1.x, n1.z, vec_fma(t2 * n2.x, n2.z, t3 * n3.x * n3.z)));
        }
}

/* P = 2μ (F − R) + λ (J − 1) cof F. */
static void piola(tile_work *w) {
    const solid_field *F_field = &w->state->fields[FIELD_DEFORMATION];
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            mat3v F = mat3v_load(F_field, w->tile->first_pack + k, part);
            vec g = vec_load(scratch_at(w->scratch->degradation, 1, k, 0, part)), J = mat3v_determinant(F), shear = 2 * w->constants[MU] * g;
            mat3v_add_to(w->piola, k, part, shear, F, degraded_lambda(J, g, w->constants[LAMBDA]) * (J - 1), mat3v_cofactor(F));
            mat3v_add_to(w->piola, k, part, -shear, rotation(F), vec_all(0), F);
        }
}

/* 2μ of |F|² (the rest of Ψμ is concave), and of Ψλ as in `elastic`. */
static void stiffness(tile_work *w) {
    const solid_field *F_field = &w->state->fields[FIELD_DEFORMATION];
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            mat3v F = mat3v_load(F_field, w->tile->first_pack + k, part);
            vec g = vec_load(scratch_at(w->scratch->degradation, 1, k, 0, part)), J = mat3v_determinant(F);
            vec lambda = vec_abs(degraded_lambda(J, g, w->constants[LAMBDA]));
            vec bulk = lambda * (mat3v_square_sum(mat3v_cofactor(F)) + vec_abs(J - 1) * mat3v_cofactor_slope(F));
            real *modulus = scratch_at(w->scratch->wave_modulus, 1, k, 0, part);
            vec_store(modulus, vec_load(modulus) + 2 * w->constants[MU] * g + bulk);
        }
}

/* ρ0 c² ≤ 2 g μ n·b n + g₊ λ J². A wave along n polarised along a varies F by D = a (Fᵀ n)ᵀ. Of Ψμ = μ (|F|² − 2 max_R R:F + 3) the first
 * term's second variation is 2μ |D|² = 2μ n·b n; the second term is a maximum of linear functions, convex, and enters with a
 * minus: it never adds. J is linear along D, and cof F : D = J a·n, so Ψλ gives λ J² (a·n)². At rest the bound is λ + 2μ: sharp. */
static void wave(tile_work *w) {
    const solid_field *F_field = &w->state->fields[FIELD_DEFORMATION];
    real mu = w->constants[MU], lambda = w->constants[WAVE_LAMBDA];
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            mat3v F = mat3v_load(F_field, w->tile->first_pack + k, part);
            vec g = vec_load(scratch_at(w->scratch->degradation, 1, k, 0, part));
            vec J = mat3v_determinant(F);
            vec bulk = degraded_lambda(J, g, lambda) * J * J;
            real *modulus = scratch_at(w->scratch->wave_modulus, 1, k, 0, part);
            vec_store(modulus, vec_load(modulus) + stiffened(w, k, part, bulk));
            sym3v_add_to(w->scratch->wave_tensor, k, part, stiffened(w, k, part, 2 * mu * g), mat3v_gram(F));
        }
}

/* Σ (s_i − 1)², with the sign convention of the stress. */
static double corotated_square(const double F[9], double J) {
    double b[9], value[3], axis[3][3], sum = 0;
    matrix_gram(F, b);
    eigen_symmetric(b, value, axis); /* descending: the third is the smallest */
    for (int i = 0; i < 3; i++) {
        const double *n = axis[i];
        double pulled[3], s;
        for (int c = 0; c < 3; c++) pulled[c] = F[c] * n[0] + F[3 + c] * n[1] + F[6 + c] * n[2];
        s = sqrt(pulled[0] * pulled[0] + pulled[1] * pulled[1] + pulled[2] * pulled[2]);
        if (J < 0 && i == 2) s = -s;
        sum += (s - 1) * (s - 1);
    }
    return sum;
}

static void energy(tile_work *w) {
    elastic_energy(w, w->constants[MU], w->constants[LAMBDA], corotated_square);
}

static const parameter parameters[] = {
    ELASTIC_PARAMETERS,
};

static const solid_stages stages = {.constants = constants, .stress = stress, .wave = wave, .energy = energy, .piola = piola, .stiffness = stiffness};

const effect SOLID_EFFECT(corotated) = {
    .name = "corotated", .engine = ENGINE_SOLID, .scope = SCOPE_MATERIAL, .doc = "fixed-corotated elasticity of the matrix, instead of elastic",
    .reference = "Stomakhin et al. 2012; METHOD.md section 1", .parameters = parameters, .parameter_count = 2,
    ELASTIC_TABLES, .stages = &stages,
};
