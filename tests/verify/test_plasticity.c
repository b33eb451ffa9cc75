/* Von Mises return mapping on logarithmic strain (METHOD.md §3), f64 unless said.
 *
 * With F = U Σ Vᵀ, ε = log Σ: where 2μ |dev ε| > τy the deviator is scaled back to τy, F ← U exp(ε) Vᵀ.
 * - random F, inverted ones among them: on the surface to 1e-10; a second call moves F by 1e-12 at most; det F kept to 1e-12; the
 *   result is that of the formula written out with the other side's eigenvectors (FᵀF = V Σ² Vᵀ) and libm, to 1e-11;
 * - states inside keep their bits, also beside a lane that yields; none outside is left there by the early out;
 * - objectivity and isotropy: the map of R F Q is R (the map of F) Q;
 * - repeated, tiny and vanishing singular values: finite, det F kept;
 * - linear hardening: 2μ |dev ε| = τy + h p after any step, and one long proportional step is many short ones;
 * - f32 on every instruction set against f64: 4e-6.
 * What a body makes of it: test_plastic_bar.c. */
#include "check.h"
#include "verify/matrices.h"
#include "verify/plasticity_f32.h"
#include "verify/solid_point.h"

enum { SEED = 33, PLASTIC_FIELD = 9 };
static const double E = 100, NU = 0.3, MU = 100 / 2.6;

static double largest_difference(const double A[9], const double B[9]) {
    double most = 0;
    for (int c = 0; c < 9; c++) most = fmax(most, isfinite(A[c]) ? fabs(A[c] - B[c]) : HUGE_VAL);
    return most;
}

/* R diag(s) Q with random rotations. */
static void compose(uint64_t i, const double s[3], double F[9]) {
    double R[9], Q[9];
    random_rotation(SEED, 2 * i, R);
    random_rotation(SEED, 2 * i + 1, Q);
    for (int c = 0; c < 9; c++) R[c] *= s[c % 3];
    multiply(R, Q, F);
}

/* Stretches and right axes, by the eigenvectors of FᵀF: |F v| is accurate for small stretches too. */
static void right_stretches(const double F[9], double s[3], double axis[3][3], double image[3][3]) {
    double C[9], value[3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) C[3 * i + j] = F[i] * F[j] + F[3 + i] * F[3 + j] + F[6 + i] * F[6 + j];
    eigen_symmetric(C, value, axis);
    for (int e = 0; e < 3; e++) {
        s[e] = 0;
        for (int row = 0; row < 3; row++) {
            image[e][row] = F[3 * row] * axis[e][0] + F[3 * row + 1] * axis[e][1] + F[3 * row + 2] * axis[e][2];
            s[e] += image[e][row] * image[e][row];
        }
        s[e] = sqrt(s[e]);
    }
}

static double deviator_norm(const double F[9]) {
    double s[3], axis[3][3], image[3][3], mean = 0, sum = 0;
    right_stretches(F, s, axis, image);
    for (int e = 0; e < 3; e++) mean += log(s[e]) / 3;
    for (int e = 0; e < 3; e++) sum += (log(s[e]) - mean) * (log(s[e]) - mean);
    return sqrt(sum);
}

/* METHOD.md's formula as it is written: F ← U exp(ε) Vᵀ. */
static void reference_return(double F[9], double yield_stress) {
    double s[3], axis[3][3], image[3][3], mean = 0, norm = deviator_norm(F);
    if (2 * MU * norm <= yield_stress) return;
    right_stretches(F, s, axis, image);
    for (int e = 0; e < 3; e++) mean += log(s[e]) / 3;
    for (int c = 0; c < 9; c++) F[c] = 0;
    for (int e = 0; e < 3; e++) {
        double moved = exp(mean + (log(s[e]) - mean) * yield_stress / (2 * MU * norm));
        for (int c = 0; c < 9; c++) F[c] += moved * image[e][c / 3] / s[e] * axis[e][c % 3];
    }
}

static material_point *plastic_point(double yield_stress, double hardening) {
    material_point *p = point_create(1u << EFFECT_elastic | 1u << EFFECT_plastic);
    p->values[EFFECT_elastic].value[0][0] = E;
    p->values[EFFECT_elastic].value[1][0] = NU;
    p->values[EFFECT_plastic].value[0][0] = yield_stress;
    p->values[EFFECT_plastic].value[1][0] = hardening;
    for (int f = 0; f < PLASTIC_FIELD; f++) p->state.fields[f].name = "";
    p->state.fields[PLASTIC_FIELD] = (solid_field){"plastic_strain", 1, p->storage[PLASTIC_FIELD]};
    p->state.field_count = PLASTIC_FIELD + 1;
    return p;
}

static void update(material_point *p) {
    real constants[CONSTANTS];
    tile_work w = point_work(p, &SOLID_EFFECT(plastic), EFFECT_plastic, constants, 0);
    SOLID_EFFECT(plastic).stages->update(&w);
}

static void get(const material_point *p, int lane, double F[9]) {
    for (int c = 0; c < 9; c++) F[c] = p->storage[FIELD_DEFORMATION][c * PACK + lane];
}

static double strain_of(const material_point *p) {
    return p->storage[PLASTIC_FIELD][0];
}

/* F of one lane after the return; F itself of all lanes before. */
static void map(material_point *p, const double F[9], double out[9]) {
    double zero = 0;
    point_set(p, FIELD_DEFORMATION, F);
    point_set(p, PLASTIC_FIELD, &zero);
    update(p);
    get(p, 0, out);
}

static void returns_to_the_surface(void) {
    double yield_stress = 12, off = 0, again = 0, volume = 0, formula = 0, strain = 0;
    material_point *p = plastic_point(yield_stress, 0);
    int yielded = 0, inverted = 0;
    for (uint64_t i = 0; i < 100000; i++) {
        double F[9], G[9], H[9];
        for (int c = 0; c < 9; c++) F[c] = (c % 4 == 0) + (i % 2 ? 1.2 : 0.2) * random_sign(SEED, (uint64_t)c, i);
        double J = matrix_determinant(F), before = deviator_norm(F);
        if (fabs(J) < 0.01 || 2 * MU * before <= yield_stress) continue;
        map(p, F, G);
        strain = fmax(strain, fabs(strain_of(p) - (before - yield_stress / (2 * MU))) / before);
        off = fmax(off, fabs(2 * MU * deviator_norm(G) / yield_stress - 1));
        volume = fmax(volume, fabs(matrix_determinant(G) / J - 1));
        map(p, G, H);
        again = fmax(again, largest_difference(G, H));
        reference_return(F, yield_stress);
        formula = fmax(formula, largest_difference(F, G));
        yielded++;
        inverted += J < 0;
    }
    printf("  %d yield, %d of them inverted: off the surface %.1e, second call %.1e, det %.1e, formula %.1e, strain %.1e\n", yielded, inverted,
           off, again, volume, formula, strain);
    CHECK(yielded > 40000 && inverted > 10000);
    CHECK_ROW("METHOD 3", "von Mises, random F that yield, inverted ones included: distance to the yield surface over it", 0, off, 1e-10);
    CHECK_ROW("METHOD 3", "the same: what a second return changes", 0, again, 1e-12);
    CHECK_ROW("METHOD 3", "the same: relative change of det F", 0, volume, 1e-12);
    CHECK(formula < 1e-11 && strain < 1e-11);
    free(p);
}

/* Stretches with deviator of a given norm, from a random direction and a random volume. */
static void stretches_at(uint64_t i, double norm, double s[3]) {
    double e[3], mean = 0, length = 0, volume = 0.3 * random_sign(SEED, 53, i);
    for (int c = 0; c < 3; c++) e[c] = random_sign(SEED, 50 + (uint64_t)c, i), mean += e[c] / 3;
    for (int c = 0; c < 3; c++) e[c] -= mean, length += e[c] * e[c];
    for (int c = 0; c < 3; c++) s[c] = exp(volume + e[c] * norm / sqrt(length));
}

/* How many of 1000 states whose deviator has `part` of the yield strain are moved; of the others every bit must stay. */
static int count_moved(material_point *p, double limit, double part) {
    int moved = 0;
    for (uint64_t i = 0; i < 1000; i++) {
        double s[3], F[9], G[9];
        stretches_at(i, limit * part, s);
        compose(i, s, F);
        map(p, F, G);
        bool same = memcmp(F, G, sizeof F) == 0;
        CHECK(same == (strain_of(p) == 0));
        moved += !same;
    }
    return moved;
}

static void inside_keeps_its_bits(void) {
    static const double limits[] = {1e-3, 0.01, 0.3, 3}; /* yield strains */
    static const double inside[] = {0, 0.3, 0.9, 0.999, 1 - 1e-9}, outside[] = {1 + 1e-9, 1.0005, 1.003, 1.1, 3};
    for (size_t l = 0; l < sizeof limits / sizeof *limits; l++) {
        material_point *p = plastic_point(2 * MU * limits[l], 0);
        for (int k = 0; k < 5; k++) {
            CHECK(count_moved(p, limits[l], inside[k]) == 0);
            CHECK(count_moved(p, limits[l], outside[k]) == 1000);
        }
        free(p);
    }
}

static void lanes_yield_alone(void) {
    material_point *p = plastic_point(2 * MU * 0.1, 0);
    double before[PACK][9], after[9];
    for (uint64_t i = 0; i < 500; i++) {
        memset(p->storage[PLASTIC_FIELD], 0, sizeof p->storage[PLASTIC_FIELD]);
        for (int lane = 0; lane < PACK; lane++) {
            double s[3];
            stretches_at(i * PACK + (uint64_t)lane, lane % 3 == 0 ? 0.2 : 0.0999, s);
            compose(i * PACK + (uint64_t)lane, s, before[lane]);
            for (int c = 0; c < 9; c++) p->storage[FIELD_DEFORMATION][c * PACK + lane] = before[lane][c];
        }
        update(p);
        for (int lane = 0; lane < PACK; lane++) {
            get(p, lane, after);
            bool same = memcmp(before[lane], after, sizeof after) == 0;
            CHECK(same == (lane % 3 != 0) && (p->storage[PLASTIC_FIELD][lane] > 0) == (lane % 3 == 0));
        }
    }
    free(p);
}

static void turning_commutes(void) {
    material_point *p = plastic_point(12, 0);
    double worst = 0;
    for (uint64_t i = 0; i < 20000; i++) {
        double R[9], Q[9], F[9], RFQ[9], mapped[9], turned[9];
        random_rotation(SEED, 2 * i, R);
        random_rotation(SEED, 2 * i + 1, Q);
        for (int c = 0; c < 9; c++) F[c] = (c % 4 == 0) + random_sign(SEED, (uint64_t)c, i);
        if (fabs(matrix_determinant(F)) < 0.01) continue;
        multiply(R, F, RFQ);
        multiply(RFQ, Q, RFQ);
        map(p, F, mapped);
        map(p, RFQ, turned);
        multiply(R, mapped, mapped);
        multiply(mapped, Q, mapped);
        worst = fmax(worst, largest_difference(mapped, turned));
    }
    printf("  worst difference %.1e\n", worst);
    CHECK(worst < 1e-11);
    free(p);
}

/* Repeated values: diag(a, a, b) and its turns end at the closed form's stretches; equal ones stay. */
static void repeated_values(void) {
    double limit = 0.1, worst = 0;
    material_point *p = plastic_point(2 * MU * limit, 0);
    static const double spectra[][3] = {{2, 2, 1}, {1, 2, 2}, {1, 1.5, 1}, {0.3, 0.3, 5}, {1, 1 + 1e-12, 2}, {1, 1 + 1e-8, 0.2}};
    for (size_t k = 0; k < sizeof spectra / sizeof *spectra; k++)
        for (uint64_t i = 0; i < 2000; i++) {
            double F[9], G[9];
            compose(i, spectra[k], F);
            map(p, F, G);
            reference_return(F, 2 * MU * limit);
            worst = fmax(worst, largest_difference(F, G));
        }
    printf("  worst difference %.1e\n", worst);
    CHECK(worst < 1e-11);
    for (double s = 0.1; s < 20; s *= 1.7) {
        const double three[3] = {s, s, s};
        double F[9], G[9];
        compose((uint64_t)(1000 * s), three, F);
        map(p, F, G);
        CHECK(memcmp(F, G, sizeof F) == 0);
    }
    free(p);
}

/* Values under the clamp, down to none at all: finite, det F kept, each value scaled as if it stood at 1e-4; and repeated calls end on
 * the surface once nothing is clamped. */
static void collapsed_states(void) {
    double limit = 0.1;
    material_point *p = plastic_point(2 * MU * limit, 0);
    static const double spectra[][3] = {{1, 1, 1e-3}, {1, 1, 1e-5}, {2, 1e-5, 1e-6}, {1, 1, 1e-12}, {1, 1e-9, 1e-9},
                                        {1, 1, 0},    {1, 0, 0},    {0, 0, 0},       {1e-5, 1e-5, 1e-5}, {1e4, 1e-4, 1e-4}};
    for (size_t k = 0; k < sizeof spectra / sizeof *spectra; k++) {
        const double *s = spectra[k];
        double e[3], mean = 0, length = 0, expected[3], J = s[0] * s[1] * s[2], largest = fmax(s[0], fmax(s[1], s[2]));
        for (int c = 0; c < 3; c++) e[c] = log(fmax(s[c], 1e-4)), mean += e[c] / 3;
        for (int c = 0; c < 3; c++) length += (e[c] - mean) * (e[c] - mean);
        double back = fmax(0, 1 - limit / sqrt(fmax(length, 1e-300)));
        for (int c = 0; c < 3; c++) expected[c] = s[c] * exp(-back * (e[c] - mean));
        for (uint64_t i = 0; i < 200; i++) {
            double F[9], G[9];
            compose(i, s, F);
            map(p, F, G);
            /* The product cancels from the scale of the largest value: that much of it is rounding, before and after. */
            CHECK_NEAR(matrix_determinant(G), J, 1e-12 * fabs(J) + 1e-13 * largest * largest * fmax(largest, 1));
            compose(i, expected, F);
            /* A value that grows r times brings along r times the rounding of F. */
            CHECK(largest_difference(F, G) <= 1e-14 * largest * exp(9.3 - mean));
            for (int repeat = 0; repeat < 60; repeat++) update(p);
            get(p, 0, G);
            if (J > 1e-10) CHECK_NEAR(deviator_norm(G), limit, 1e-9);
        }
    }
    free(p);
}

/* Radial return is exact along a proportional path; the path of a spread that grows by a factor is one. */
static void hardening_is_linear(void) {
    double limit = 0.05, H = 60, s[3];
    material_point *p = plastic_point(2 * MU * limit, H);
    stretches_at(7, 1, s);
    double mean = log(s[0] * s[1] * s[2]) / 3, F[9], one = 0, many = 0, zero = 0;
    for (int steps = 1; steps <= 1000; steps *= 1000) {
        double stretch[3] = {1, 1, 1}, turn[9], G[9];
        random_rotation(SEED, 3, turn);
        point_set(p, PLASTIC_FIELD, &zero);
        memcpy(G, turn, sizeof G);
        for (int n = 0; n < steps; n++) {
            for (int c = 0; c < 3; c++) stretch[c] = exp((log(s[c]) - mean) / steps);
            const double D[9] = {stretch[0], 0, 0, 0, stretch[1], 0, 0, 0, stretch[2]};
            multiply(D, G, F);
            point_set(p, FIELD_DEFORMATION, F);
            update(p);
            get(p, 0, G);
            double surface = 2 * MU * limit + H * strain_of(p), norm = 2 * MU * deviator_norm(G);
            CHECK(norm <= surface * (1 + 1e-11));
        }
        CHECK_NEAR(2 * MU * deviator_norm(G), 2 * MU * limit + H * strain_of(p), 1e-9);
        if (steps == 1) one = strain_of(p);
        else many = strain_of(p);
    }
    printf("  plastic strain %.6f in one step, %.6f in a thousand\n", one, many);
    CHECK_NEAR(one, (1 - limit) / (1 + H / (2 * MU)), 1e-12);
    CHECK_NEAR(many, one, 1e-9);
    free(p);
}

static void single_precision_agrees(void) {
    static const char *const simds[] = {"plain", "avx2", "avx512"};
    double yield_stress = 12;
    material_point *p = plastic_point(yield_stress, 0);
    for (int k = 0; k < 3; k++) {
        double worst = 0, volume = 0;
        int built = 1;
        for (uint64_t i = 0; i < 20000 && built; i += PLASTIC_LANES) {
            double F[PLASTIC_LANES][9], exact[PLASTIC_LANES][9];
            for (uint64_t lane = 0; lane < PLASTIC_LANES; lane++) {
                double s[3];
                stretches_at(i + lane, lane % 2 ? 1.5 : 0.25, s);
                compose(i + lane, s, F[lane]);
                for (int c = 0; c < 9; c++) F[lane][c] = (double)(float)F[lane][c];
                map(p, F[lane], exact[lane]);
            }
            built = plastic_return_f32(simds[k], yield_stress, F);
            for (int lane = 0; built && lane < PLASTIC_LANES; lane++) {
                worst = fmax(worst, largest_difference(F[lane], exact[lane]));
                volume = fmax(volume, fabs(matrix_determinant(F[lane]) / matrix_determinant(exact[lane]) - 1));
            }
        }
        if (built) printf("  %-6s worst difference %.1e, det %.1e\n", simds[k], worst, volume);
        CHECK(worst < 4e-6 && volume < 4e-6);
    }
    free(p);
}

int main(void) {
    RUN(returns_to_the_surface);
    RUN(inside_keeps_its_bits);
    RUN(lanes_yield_alone);
    RUN(turning_commutes);
    RUN(repeated_values);
    RUN(collapsed_states);
    RUN(hardening_is_linear);
    RUN(single_precision_agrees);
    return check_finish();
}
