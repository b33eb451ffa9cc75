/* The sheet paper's comparison with smoothed particle hydrodynamics (Figs. 9 and 10): the ways of two particles of a stretched sheet.
 *
 * The SPH sheet is total Lagrangian, in the plane: with the cubic spline W over rest places, F_i = Σ_j A_j (x_j − x_i) ⊗ K_i⁻¹ ∇W_ij (corrected, so that it is
 * exact for linear fields), P = F S with the Saint-Venant–Kirchhoff stress S of plane stress, and m_i a_i = h A_i Σ_j A_j (P_i K_i⁻¹ + P_j K_j⁻¹) ∇W_ij (Bonet and
 * Lok 1999; Ganzenmüller 2015). Small strains, ν = 1/3: both models are then the same elastic sheet. The paper's points are P1 (0.64, 0.84) and
 * P2 (1.64, 1.64) of a 2 × 2 sheet drawn at its sides. */
#include "check.h"
#include "verify/sheet_patch.h"

enum { SIDE = 100, COUNT = SIDE * SIDE, REACH_LIMIT = 40 };

static const double E = 2e4, RHO = 5000, H = 0.02, DX = 0.02, PULL = 0.03, DURATION = 1.2;

typedef struct sph {
    double rest[COUNT][2], x[COUNT][2], v[COUNT][2];
    int count[COUNT], neighbour[COUNT][REACH_LIMIT];
    double gradient[COUNT][REACH_LIMIT][2]; /* A_j K_i⁻¹ ∇W */
    double P[COUNT][4];
} sph;

/* dW/dr of the cubic spline with support 2 s, up to a factor, which the correction takes out. */
static double kernel_slope(double r, double s) {
    double q = r / s;
    return q < 1 ? -3 * q + 2.25 * q * q : q < 2 ? -0.75 * (2 - q) * (2 - q) : 0;
}

static void find_neighbours(sph *s) {
    double smooth = 1.3 * DX;
    for (int i = 0; i < COUNT; i++) {
        double K[4] = {0};
        for (int j = 0; j < COUNT; j++) {
            double r[2] = {s->rest[j][0] - s->rest[i][0], s->rest[j][1] - s->rest[i][1]}, length = hypot(r[0], r[1]);
            if (j == i || length >= 2 * smooth) continue;
            int k = s->count[i]++;
            s->neighbour[i][k] = j;
            double slope = -kernel_slope(length, smooth) / length * DX * DX;
            for (int a = 0; a < 2; a++) {
                s->gradient[i][k][a] = slope * r[a];
                for (int b = 0; b < 2; b++) K[2 * a + b] += slope * r[a] * r[b];
            }
        }
        double det = K[0] * K[3] - K[1] * K[2], inverse[4] = {K[3] / det, -K[1] / det, -K[2] / det, K[0] / det};
        for (int k = 0; k < s->count[i]; k++) {
            double g[2] = {s->gradient[i][k][0], s->gradient[i][k][1]};
            for (int a = 0; a < 2; a++) s->gradient[i][k][a] = inverse[2 * a] * g[0] + inverse[2 * a + 1] * g[1];
        }
    }
}

static void stress(sph *s, int i) {
    double F[4] = {0}, nu = 1.0 / 3, C[4], S[4], modulus = E / (1 - nu * nu);
    for (int k = 0; k < s->count[i]; k++)
        for (int a = 0; a < 2; a++)
            for (int b = 0; b < 2; b++) F[2 * a + b] += (s->x[s->neighbour[i][k]][a] - s->x[i][a]) * s->gradient[i][k][b];
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++) C[2 * a + b] = 0.5 * (F[a] * F[b] + F[2 + a] * F[2 + b] - (a == b));
    S[0] = modulus * (C[0] + nu * C[3]);
    S[3] = modulus * (C[3] + nu * C[0]);
    S[1] = S[2] = modulus * (1 - nu) * C[1];
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++) s->P[i][2 * a + b] = F[2 * a] * S[b] + F[2 * a + 1] * S[2 + b];
}

static bool is_held(const double rest[2]) {
    return rest[0] < 0.08 || rest[0] > 1.92;
}

static void sph_step(sph *s, double dt) {
    for (int i = 0; i < COUNT; i++) stress(s, i);
    for (int i = 0; i < COUNT; i++)
        for (int k = 0; k < s->count[i]; k++) /* the pair's force on both, so that momentum is kept */
            for (int a = 0; a < 2; a++) {
                int j = s->neighbour[i][k];
                double pull = (s->P[i][2 * a] * s->gradient[i][k][0] + s->P[i][2 * a + 1] * s->gradient[i][k][1]) / RHO * dt;
                s->v[i][a] += pull;
                s->v[j][a] -= pull;
            }
    for (int i = 0; i < COUNT; i++)
        for (int a = 0; a < 2; a++) {
            if (is_held(s->rest[i])) s->v[i][a] = a ? 0 : s->rest[i][0] < 1 ? -PULL : PULL;
            s->x[i][a] += dt * s->v[i][a];
        }
}

static void trajectories_agree_with_sph(void) {
    static sph s;
    arena *memory = arena_create("sph");
    patch *p = patch_create(SHEET_SQUARE, DX, 1.5, H);
    p->d.materials[0].density = RHO;
    for (int i = 0; i < COUNT; i++) {
        double at[2] = {(i % SIDE + 0.5) * DX, (i / SIDE + 0.5) * DX};
        patch_add(p, at[0], at[1], 0, DX * DX);
        memcpy(s.rest[i], at, sizeof at);
        memcpy(s.x[i], at, sizeof at);
    }
    find_neighbours(&s);
    patch_set(p, "linear", "E", E);
    for (int k = 0; k < 2; k++)
        p->d.boundaries[k] = (rigid_boundary){.shape = shape_box(memory, (const double[]){k ? 1.92 : -9, -9, -9}, (const double[]){k ? 9 : 0.08, 9, 9}), .grip = true,
                                              .motion = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .velocity = {k ? PULL : -PULL, 0, 0}, .active = true}};
    p->d.boundary_count = 2;
    CHECK(patch_start(p, 64, "auto", 1));
    double dt = 0.3 * patch_limit(p), worst[2] = {0}, most[2] = {0}, (*x)[3] = malloc(COUNT * sizeof *x);
    static const double points[2][2] = {{0.64, 0.84}, {1.64, 1.64}};
    for (double t = 0; t < DURATION; t += dt) {
        CHECK(patch_steps(p, 1, dt) == STATUS_OK);
        sph_step(&s, dt);
        p->engine->read(p->state, "position", x[0]);
        for (int n = 0; n < 2; n++) {
            int i = (int)(points[n][1] / DX) * SIDE + (int)(points[n][0] / DX);
            worst[n] = fmax(worst[n], hypot(x[i][0] - s.x[i][0], x[i][1] - s.x[i][1]));
            most[n] = fmax(most[n], hypot(s.x[i][0] - s.rest[i][0], s.x[i][1] - s.rest[i][1]));
        }
    }
    CHECK(most[0] > 0.3 * PULL * DURATION * 0.5 && most[1] > 0.3 * PULL * DURATION);
    CHECK_ROW("METHOD 7", "stretched sheet, P1: largest distance from SPH's place over the grips' way", 0, worst[0] / (PULL * DURATION), 0.03);
    CHECK_ROW("METHOD 7", "stretched sheet, P2: largest distance from SPH's place over the grips' way", 0, worst[1] / (PULL * DURATION), 0.03);
    free(x);
    patch_free(p);
    arena_destroy(memory);
}

int main(void) {
    RUN(trajectories_agree_with_sph);
    return check_finish();
}
