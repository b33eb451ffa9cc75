/* Elasticity at one material point (METHOD.md §1, §2): the engine's own stages against closed forms.
 *
 * - P(F) against central differences of Ψ, f64, h = 3e-6: 1e-8 of |P| where ℓ ≥ 0.05, 1e-6 elsewhere. The stage gives
 *   τ = P Fᵀ, so the check compares τ with (∂Ψ/∂F) Fᵀ, which needs no inverse and holds for singular F too.
 * - Objectivity: Ψ(RF) = Ψ(F) to 1e-12 for 10⁴ rotations.
 * - The closed form equals the paper's QR form to 1e-12 for 10⁶ random F, inverted and near-singular ones among them.
 * - g(0) = 1, g(1) = r, and compression (J < 1) leaves Ψλ undegraded. */
#include "check.h"
#include "verify/matrices.h"
#include "verify/solid_point.h"

enum { SEED = 20 };

static material_point *fibred_point(void) {
    material_point *p = point_create(1u << EFFECT_elastic | 1u << EFFECT_fibres);
    p->values[EFFECT_elastic].value[0][0] = 3;
    p->values[EFFECT_elastic].value[1][0] = 0.3;
    p->values[EFFECT_fibres].value[0][0] = 2;
    p->values[EFFECT_fibres].value[1][0] = 0.7;
    return p;
}

/* Turns the two fibre families by a rotation, so that no axis is special. */
static void turn_fibres(material_point *p, const double R[9]) {
    const double a1[3] = {R[0], R[3], R[6]}, a2[3] = {R[1], R[4], R[7]};
    point_set(p, 7, a1);
    point_set(p, 8, a2);
}

static void stress_is_the_gradient_of_energy(void) {
    material_point *p = fibred_point();
    double worst_long = 0, worst_short = 0, h = 3e-6;
    int short_ones = 0;
    for (uint64_t i = 0; i < 4000; i++) {
        double R[9], F[9], P[9], tau[6];
        random_rotation(SEED, i, R);
        turn_fibres(p, R);
        random_matrix(SEED, i, i % 2 ? 1.5 : 0.4, F);
        if (i % 5 == 0) /* a fibre squeezed to a few hundredths */
            for (int row = 0; row < 3; row++) {
                double along = F[3 * row] * R[0] + F[3 * row + 1] * R[3] + F[3 * row + 2] * R[6];
                for (int c = 0; c < 3; c++) F[3 * row + c] -= (1 - 0.03) * along * R[3 * c];
            }
        /* Below 1e-3 the differences' own error takes over. */
        double f1[3] = {F[0] * R[0] + F[1] * R[3] + F[2] * R[6], F[3] * R[0] + F[4] * R[3] + F[5] * R[6], F[6] * R[0] + F[7] * R[3] + F[8] * R[6]};
        double f2[3] = {F[0] * R[1] + F[1] * R[4] + F[2] * R[7], F[3] * R[1] + F[4] * R[4] + F[5] * R[7], F[6] * R[1] + F[7] * R[4] + F[8] * R[7]};
        double shortest = fmin(norm(f1, 3), norm(f2, 3));
        if (shortest < 1e-3) continue;
        for (int c = 0; c < 9; c++) {
            double G[9];
            memcpy(G, F, sizeof G);
            G[c] = F[c] + h;
            point_set(p, FIELD_DEFORMATION, G);
            double up = point_energy(p);
            G[c] = F[c] - h;
            point_set(p, FIELD_DEFORMATION, G);
            P[c] = (up - point_energy(p)) / (2 * h);
        }
        point_set(p, FIELD_DEFORMATION, F);
        point_stress(p, tau);
        const double full[9] = {tau[0], tau[3], tau[5], tau[3], tau[1], tau[4], tau[5], tau[4], tau[2]};
        double error = 0, Ft[9] = {F[0], F[3], F[6], F[1], F[4], F[7], F[2], F[5], F[8]}, PFt[9];
        multiply(P, Ft, PFt);
        for (int c = 0; c < 9; c++) error += (PFt[c] - full[c]) * (PFt[c] - full[c]);
        error = sqrt(error) / (norm(P, 9) * norm(F, 9) + 1e-3);
        if (shortest >= 0.05) worst_long = fmax(worst_long, error);
        else worst_short = fmax(worst_short, error), short_ones++;
    }
    printf("  worst relative difference %.2e (fibres over 0.05), %.2e (shorter)\n", worst_long, worst_short);
    CHECK_ROW("METHOD 1", "P against central differences of the energy, fibres over 0.05: worst relative difference", 0, worst_long, 1e-8);
    CHECK_ROW("METHOD 1", "the same, fibres from 0.001 to 0.05", 0, worst_short, 1e-6);
    CHECK(short_ones > 300);
    free(p);
}

static void energy_is_objective(void) {
    material_point *p = fibred_point();
    double worst = 0;
    for (uint64_t i = 0; i < 10000; i++) {
        double R[9], F[9], RF[9];
        random_rotation(SEED, i, R);
        random_matrix(SEED, i, 1.5, F);
        point_set(p, FIELD_DEFORMATION, F);
        double before = point_energy(p);
        multiply(R, F, RF);
        point_set(p, FIELD_DEFORMATION, RF);
        worst = fmax(worst, fabs(point_energy(p) - before) / (fabs(before) + 1));
    }
    CHECK_ROW("METHOD 1", "energy under 10^4 random rotations: worst relative change", 0, worst, 1e-12);
    free(p);
}

/* The paper's form: F B = QR by Gram–Schmidt, in a basis B whose first axis is a1 and second a2; Ψ from the entries of R alone. */
static double qr_energy(const double F[9], const double B[9], double mu, double lambda, double kx, double ky) {
    double M[9], r[3][3] = {{0}}, q[3][3];
    multiply(F, B, M);
    for (int j = 0; j < 3; j++) {
        double v[3] = {M[j], M[3 + j], M[6 + j]};
        for (int pass = 0; pass < 2; pass++) /* twice: orthogonal to round-off also for nearly singular F */
            for (int k = 0; k < j; k++) {
                double dot = q[k][0] * v[0] + q[k][1] * v[1] + q[k][2] * v[2];
                r[k][j] += dot;
                for (int c = 0; c < 3; c++) v[c] -= dot * q[k][c];
            }
        r[j][j] = norm(v, 3);
        for (int c = 0; c < 3; c++) q[j][c] = v[c] / r[j][j];
    }
    /* The third axis completes a right-handed frame: the sign of the determinant goes to r33. */
    const double Q[9] = {q[0][0], q[1][0], q[2][0], q[0][1], q[1][1], q[2][1], q[0][2], q[1][2], q[2][2]};
    if (matrix_determinant(Q) < 0) r[2][2] = -r[2][2];
    double square = 0, J = r[0][0] * r[1][1] * r[2][2];
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++) square += r[i][j] * r[i][j];
    double l1 = r[0][0], l2 = sqrt(r[0][1] * r[0][1] + r[1][1] * r[1][1]);
    return 0.5 * mu * (square - 3) - mu * (J - 1) + 0.5 * lambda * (J - 1) * (J - 1) + 0.5 * kx * (l1 - 1) * (l1 - 1) +
           0.5 * ky * (l2 - 1) * (l2 - 1);
}

static void closed_form_is_the_qr_form(void) {
    material_point *p = fibred_point();
    double E = 3, nu = 0.3, mu = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu)) + mu, worst = 0;
    int inverted = 0, singular = 0;
    for (uint64_t i = 0; i < 1000000; i++) {
        double B[9], F[9];
        random_rotation(SEED, i % 512, B);
        random_matrix(SEED, i, i % 3 ? 1.5 : 0.5, F);
        if (i % 7 == 0) /* nearly singular: the third row almost in the plane of the others */
            for (int c = 0; c < 3; c++) F[6 + c] = F[c] + F[3 + c] + 1e-6 * F[6 + c];
        inverted += matrix_determinant(F) < 0;
        singular += fabs(matrix_determinant(F)) < 1e-5;
        turn_fibres(p, B);
        point_set(p, FIELD_DEFORMATION, F);
        double energy = point_energy(p), reference = qr_energy(F, B, mu, lambda, mu * 2, mu * 0.7);
        worst = fmax(worst, fabs(energy - reference) / (1 + fabs(reference)));
    }
    printf("  worst relative difference %.2e over 10^6 F, %d inverted, %d nearly singular\n", worst, inverted, singular);
    CHECK_ROW("METHOD 1", "closed form against the QR form, 10^6 random F, inverted ones included: worst relative difference", 0, worst, 1e-12);
    CHECK(inverted > 100000 && singular > 100000);
    free(p);
}

/* The stress at rest is nothing; the linear response of the default (consistent) λ is Hooke's. */
static void small_strain_is_hooke(void) {
    material_point *p = point_create(1u << EFFECT_elastic);
    double E = 7, nu = 0.31, e = 1e-7, tau[6];
    p->values[EFFECT_elastic].value[0][0] = E;
    p->values[EFFECT_elastic].value[1][0] = nu;
    point_stress(p, tau);
    CHECK(norm(tau, 6) < 1e-14);
    double mu = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
    const double F[9] = {1 + e, 0, 0, 0, 1, 0, 0, 0, 1};
    point_set(p, FIELD_DEFORMATION, F);
    point_stress(p, tau);
    CHECK_NEAR(tau[0] / e, lambda + 2 * mu, 1e-5);
    CHECK_NEAR(tau[1] / e, lambda, 1e-5);
    const double S[9] = {1, e, 0, 0, 1, 0, 0, 0, 1};
    point_set(p, FIELD_DEFORMATION, S);
    point_stress(p, tau);
    CHECK_NEAR(tau[3] / e, mu, 1e-5);
    free(p);
}

static void damage_degrades_tension_only(void) {
    material_point *p = point_create(1u << EFFECT_elastic | 1u << EFFECT_damage);
    double one = 1, zero = 0, r = 0.013, whole[6], broken[6];
    p->values[EFFECT_damage].value[0][0] = 1;
    p->values[EFFECT_damage].value[5][0] = r;
    const double stretched[9] = {1.2, 0.1, 0, 0, 1.1, 0, 0, 0, 1.05}, squeezed[9] = {0.8, 0, 0, 0, 0.8, 0, 0, 0, 0.8};
    point_set(p, FIELD_DEFORMATION, stretched);
    point_set(p, 5, &zero);
    point_stress(p, whole);
    point_set(p, 5, &one);
    point_stress(p, broken);
    for (int c = 0; c < 6; c++) CHECK_NEAR(broken[c], r * whole[c], 1e-9 * norm(whole, 6));
    /* Uniform squeeze s: τ = g μ (s² − J) + λ (J − 1) J; the second term is whole. */
    point_set(p, FIELD_DEFORMATION, squeezed);
    point_stress(p, broken);
    double E = p->values[EFFECT_elastic].value[0][0], nu = p->values[EFFECT_elastic].value[1][0], J = 0.512;
    double mu = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu)) + mu;
    CHECK_NEAR(broken[0], r * mu * (0.64 - J) + lambda * (J - 1) * J, 1e-9 * E);
    free(p);
}

/* ρ0 c² of the stage bounds the acoustic tensor, by finite differences of P along rank-one directions (METHOD.md §3). */
static void wave_modulus_bounds_the_acoustic_tensor(void) {
    material_point *p = fibred_point();
    double worst = 0, h = 1e-5;
    for (uint64_t i = 0; i < 3000; i++) {
        double R[9], F[9], N[9], n[3];
        random_rotation(SEED, i, R);
        turn_fibres(p, R);
        random_matrix(SEED, i, 0.6, F);
        if (matrix_determinant(F) < 0.05) continue;
        random_rotation(SEED, i + 77777, N);
        for (int c = 0; c < 3; c++) n[c] = N[c];
        /* Second derivative of Ψ along F + s n⊗(Fᵀn'): longitudinal and transverse polarisations of a wave along n. */
        for (int polarisation = 0; polarisation < 3; polarisation++) {
            double D[9], G[9], energy[3];
            for (int a = 0; a < 3; a++)
                for (int b = 0; b < 3; b++)
                    D[3 * a + b] = N[3 * polarisation + a] * (n[0] * F[b] + n[1] * F[3 + b] + n[2] * F[6 + b]);
            for (int k = 0; k < 3; k++) {
                for (int c = 0; c < 9; c++) G[c] = F[c] + (k - 1) * h * D[c];
                point_set(p, FIELD_DEFORMATION, G);
                energy[k] = point_energy(p);
            }
            double curvature = (energy[0] - 2 * energy[1] + energy[2]) / (h * h);
            point_set(p, FIELD_DEFORMATION, F);
            worst = fmax(worst, curvature / point_wave(p));
        }
    }
    printf("  largest curvature over bound %.3f\n", worst);
    CHECK_ROW("METHOD 3", "curvature of the energy along rank-one waves over the step limit's bound: largest ratio", 0.5, worst, 0.501);
    CHECK(worst > 0.3); /* a bound that is many times too large would waste steps */
    free(p);
}

static sym3v tensor_of(const double s[3], const double R[9]) {
    double S[9] = {0};
    for (int i = 0; i < 9; i++)
        for (int k = 0; k < 3; k++) S[i] += s[k] * R[i / 3 * 3 + k] * R[i % 3 * 3 + k];
    return (sym3v){vec_all(S[0]), vec_all(S[4]), vec_all(S[8]), vec_all(S[1]), vec_all(S[5]), vec_all(S[2])};
}

/* Any eigenvalues, two or three of them equal or nearly so: never below, and above by 1.4 % of the largest at most. */
static void largest_eigenvalue_is_bounded_closely(void) {
    double least = HUGE_VAL, most = 0;
    for (uint64_t i = 0; i < 20000; i++) {
        double R[9], s[3] = {random_unit(50, 0, i), random_unit(50, 1, i), random_unit(50, 2, i)}, near = i % 16 < 8 ? 0 : pow(10, -(double)(i % 16));
        if (i % 4 == 1) s[1] = s[0] * (1 - near);
        if (i % 4 == 2) s[1] = s[0] * (1 - near), s[2] = 0;
        if (i % 4 == 3) s[1] = s[0] * (1 - near), s[2] = s[0] * (1 + near);
        random_rotation(SEED, i, R);
        double ratio = sym3v_largest(tensor_of(s, R))[0] / fmax(fmax(s[0], s[1]), s[2]);
        least = fmin(least, ratio), most = fmax(most, ratio);
    }
    CHECK(least >= 1 - 1e-12);
    CHECK(most <= 1.014);
}

/* Fibres that cross at right angles stiffen different waves: at rest ρ0 c² = μ + λ + max(k1, k2), not their sum. */
static void crossed_fibres_do_not_add_up(void) {
    material_point *p = fibred_point();
    double E = 3, nu = 0.3, mu = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu)) + mu;
    CHECK_ROW("METHOD 3", "step limit's bound at rest, two families at right angles: ρ0 c² over its exact value", 1, point_wave(p) / (mu + lambda + 2 * mu), 0.014);
    double R[9], F[9] = {0};
    for (uint64_t i = 0; i < 100; i++) {
        random_rotation(SEED, i, R);
        point_set(p, FIELD_DEFORMATION, R);
        CHECK_NEAR(point_wave(p), mu + lambda + 2 * mu, 0.014 * (mu + lambda + 2 * mu));
    }
    for (int c = 0; c < 3; c++) F[4 * c] = 2; /* twice as long: b and both families by 4, J² by 64 */
    point_set(p, FIELD_DEFORMATION, F);
    CHECK_NEAR(point_wave(p), 4 * (mu + 2 * mu) + 64 * lambda, 0.014 * (12 * mu + 64 * lambda));
    free(p);
}

/* The hard case without fibres (METHOD.md §1): under a uniform squeeze s the way back to s = 1 is barred below the root of
 * λs⁴ − (λ+μ)s + μ; pressure changes sign there. ν = 0.25 with the consistent λ: λ = 2μ. */
static void a_deep_squeeze_is_barred_without_fibres(void) {
    material_point *p = point_create(1u << EFFECT_elastic);
    p->values[EFFECT_elastic].value[0][0] = 2.5;
    p->values[EFFECT_elastic].value[1][0] = 0.25;
    double low = 0.1, high = 0.6, tau[6], root = 0.3;
    for (int i = 0; i < 60; i++) {
        double s = 0.5 * (low + high);
        const double F[9] = {s, 0, 0, 0, s, 0, 0, 0, s};
        point_set(p, FIELD_DEFORMATION, F);
        point_stress(p, tau);
        if (tau[0] > 0) low = s; /* contracts further */
        else high = s;
        root -= (2 * pow(root, 4) - 3 * root + 1) / (8 * pow(root, 3) - 3); /* Newton's, of the formula */
    }
    CHECK_ROW("METHOD 1", "uniform squeeze below which the closed form contracts further (gamma 0, lambda = 2 mu)", root, low, 1e-9);
    free(p);
}

int main(void) {
    RUN(stress_is_the_gradient_of_energy);
    RUN(energy_is_objective);
    RUN(closed_form_is_the_qr_form);
    RUN(small_strain_is_hooke);
    RUN(damage_degrades_tension_only);
    RUN(a_deep_squeeze_is_barred_without_fibres);
    RUN(wave_modulus_bounds_the_acoustic_tensor);
    RUN(largest_eigenvalue_is_bounded_closely);
    RUN(crossed_fibres_do_not_add_up);
    return check_finish();
}
