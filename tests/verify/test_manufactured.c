/* Manufactured solutions of the momentum equation (METHOD.md §3), f64, cubic kernel.
 *
 * A displacement u(X, t) is chosen, ρ0 b = ρ0 ü − div P(I + ∇u) follows, and the engine, given b, must find u again. Set up as METHOD.md says:
 * particles on a lattice of half the spacing, velocity given at −Δt/2, Δt ∝ dx². u and its first three derivatives vanish at the body's faces, so that
 * the free surface, which the grid knows to within a cell only, carries neither stress nor motion.
 *
 * The body force needs no place in the engine: Δt b is added to the particles' velocities before each step, whence P2G carries it to the grid
 * as it carries a force of m b (with APIC a particle's own velocity has no other use).
 *
 * - 1D: motion along x only (slip walls hold all nodes in y and z). The law is linear there, P = (λ + μ)(F − 1).
 * - 3D: three components of different shape, strains up to one half. div P is that of the closed form, by div cof F = 0:
 *   div P = μ Δu + λ cof F ∇J,  ∂_j J = cof F_kl ∂_l ∂_j u_k.
 * - The same with the velocity given at time 0: one order less, as METHOD.md expects. */
#include "check.h"
#include "verify/solid_particles.h"

#include <string.h>

static const double E = 1, NU = 0.3, DENSITY = 1, OMEGA = 3, END = 0.5;
static double width; /* of the bar */

static double shear_modulus(void) {
    return E / (2 * (1 + NU));
}

static double lambda_modulus(void) {
    return E * NU / ((1 + NU) * (1 - 2 * NU)) + shear_modulus();
}

/* cos⁴(πx) and, `odd`, cos⁴(πx) sin(2πx), with two derivatives; nothing beyond |x| = ½. */
static void bump(double x, bool odd, double f[3]) {
    double k = 2 * M_PI, c1 = cos(k * x), s1 = sin(k * x), c2 = cos(2 * k * x), s2 = sin(2 * k * x);
    double g[3] = {(3 + 4 * c1 + c2) / 8, -k * (4 * s1 + 2 * s2) / 8, -k * k * (4 * c1 + 4 * c2) / 8};
    double h[3] = {s1, k * c1, -k * k * s1};
    memset(f, 0, 3 * sizeof *f);
    if (fabs(x) >= 0.5) return;
    f[0] = odd ? g[0] * h[0] : g[0];
    f[1] = odd ? g[1] * h[0] + g[0] * h[1] : g[1];
    f[2] = odd ? g[2] * h[0] + 2 * g[1] * h[1] + g[0] * h[2] : g[2];
}

/* s(t) = sin ωt + 1 − cos ωt and two derivatives: nothing at first, but with speed and with acceleration, so that it matters at which time the
 * velocity is given. */
static void course(double t, double s[3]) {
    s[0] = sin(OMEGA * t) + 1 - cos(OMEGA * t);
    s[1] = OMEGA * (cos(OMEGA * t) + sin(OMEGA * t));
    s[2] = OMEGA * OMEGA * (cos(OMEGA * t) - sin(OMEGA * t));
}

/* What u is made of at one rest place: u_k = s(t) shape_k. */
typedef struct mode {
    double shape[3], gradient[3][3], hessian[3][3][3];
} mode;

/* x only depends on x; y and z of no effect. */
static void line_mode(const double X[3], mode *m) {
    double f[3];
    memset(m, 0, sizeof *m);
    bump(X[0], true, f);
    m->shape[0] = 0.05 * f[0], m->gradient[0][0] = 0.05 * f[1], m->hessian[0][0][0] = 0.05 * f[2];
}

static void space_mode(const double X[3], mode *m) {
    static const double size[3] = {0.04, -0.05, 0.03};
    for (int k = 0; k < 3; k++) {
        double f[3][3]; /* [axis][derivative] */
        for (int axis = 0; axis < 3; axis++) bump(X[axis], axis == k, f[axis]);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                int order[3] = {0, 0, 0};
                order[i]++, order[j]++;
                m->hessian[k][i][j] = size[k] * f[0][order[0]] * f[1][order[1]] * f[2][order[2]];
                order[j]--;
                m->gradient[k][i] = size[k] * f[0][order[0]] * f[1][order[1]] * f[2][order[2]];
            }
        m->shape[k] = size[k] * f[0][0] * f[1][0] * f[2][0];
    }
}

static void body_force(const mode *m, double t, bool line, double b[3]) {
    double F[3][3], cofactor[3][3], slope[3] = {0, 0, 0}, now[3];
    course(t, now);
    double s = now[0];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) F[i][j] = (i == j) + s * m->gradient[i][j];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int a = (i + 1) % 3, c = (i + 2) % 3, d = (j + 1) % 3, e = (j + 2) % 3;
            cofactor[i][j] = F[a][d] * F[c][e] - F[a][e] * F[c][d];
        }
    for (int j = 0; j < 3; j++)
        for (int k = 0; k < 3; k++)
            for (int l = 0; l < 3; l++) slope[j] += cofactor[k][l] * s * m->hessian[k][l][j];
    for (int i = 0; i < 3; i++) {
        double divergence = 0;
        for (int j = 0; j < 3; j++) divergence += shear_modulus() * s * m->hessian[i][j][j] + lambda_modulus() * cofactor[i][j] * slope[j];
        b[i] = line && i > 0 ? 0 : now[2] * m->shape[i] - divergence / DENSITY;
    }
}

static const shape *bar(arena *a) {
    return shape_box(a, (const double[]){-0.5, 0, 0}, (const double[]){0.5, width, width});
}

/* Error of u at the end over u itself, both as root mean squares over the particles. The velocity is that of
 * the time `lead`, in steps. */
static double solve(bool line, int cells, double dt, double lead) {
    width = 2.0 / cells;
    scene *s = test_scene(line ? bar : test_cube, E, NU, DENSITY);
    s->dx = 1.0 / cells;
    s->particles_per_cell = 8;
    s->kernel = KERNEL_CUBIC;
    if (line) forbid_motion(s, 1), forbid_motion(s, 2);
    simulation *sim = test_simulation(s, 64, "auto", 2);
    int64_t n = simulation_get_plan(sim)->particles;
    double *rest = particles_get(sim, "position"), *kick = memory_allocate((size_t)n * 24);
    mode *modes = memory_allocate((size_t)n * sizeof *modes);
    int steps = (int)ceil(END / dt - 1e-9);
    dt = END / steps;
    double s0[3];
    course(lead * dt, s0);
    CHECK(n == (line ? 2 * cells * 16 : 8 * cells * cells * cells));
    for (int64_t i = 0; i < n; i++) {
        (line ? line_mode : space_mode)(rest + 3 * i, &modes[i]);
        for (int c = 0; c < 3; c++) kick[3 * i + c] = s0[1] * modes[i].shape[c];
    }
    particles_kick(sim, 1, kick);
    report r;
    for (int step = 0; step < steps; step++) {
        for (int64_t i = 0; i < n; i++) body_force(&modes[i], step * dt, line, kick + 3 * i);
        particles_kick(sim, dt, kick);
        CHECK(simulation_step(sim, dt, &r) == STATUS_OK);
    }
    course(END, s0);
    double *x = particles_get(sim, "position"), error = 0, size = 0;
    for (int64_t i = 0; i < n; i++)
        for (int c = 0; c < 3; c++) {
            double u = s0[0] * modes[i].shape[c];
            error += pow(x[3 * i + c] - rest[3 * i + c] - u, 2), size += u * u;
        }
    particles_drop(sim, x), particles_drop(sim, rest);
    memory_free(kick, (size_t)n * 24);
    memory_free(modes, (size_t)n * sizeof *modes);
    simulation_destroy(sim);
    scene_destroy(s);
    return sqrt(error / size);
}

/* Δt ∝ dx², the coarsest at 0.3 of the time that a wave takes over a cell. */
static double step_of(int cells, int coarsest) {
    double c = sqrt((lambda_modulus() + shear_modulus()) / DENSITY);
    return 0.3 / (c * coarsest) * pow((double)coarsest / cells, 2);
}

static double order_of(bool line, const int *cells, int levels, double lead, bool linear) {
    double error[4], order = 0;
    for (int i = 0; i < levels; i++) {
        double dt = linear ? step_of(cells[0], cells[0]) * cells[0] / cells[i] : step_of(cells[i], cells[0]);
        error[i] = solve(line, cells[i], dt, lead);
        if (i) order = log(error[i - 1] / error[i]) / log((double)cells[i] / cells[i - 1]);
        printf("  %d cells: error %.3e", cells[i], error[i]);
        printf(i ? ", order %.2f\n" : "\n", order);
    }
    return order;
}

static void a_line_at_second_order(void) {
    static const int cells[] = {16, 32, 64, 128};
    CHECK_ROW("METHOD 3", "1D manufactured solution, cubic, dt ~ dx^2: order of the displacement, 64 to 128 cells", 2, order_of(true, cells, 4, -0.5, false), 0.2);
}

static void space_at_second_order(void) {
    static const int cells[] = {12, 18, 27};
    CHECK_ROW("METHOD 3", "3D manufactured solution, cubic, dt ~ dx^2: order of the displacement, 18 to 27 cells", 2, order_of(false, cells, 3, -0.5, false), 0.2);
}

static void a_late_velocity_costs_an_order(void) {
    static const int cells[] = {16, 32, 64, 128};
    double half_step = order_of(true, cells, 4, -0.5, true), none = order_of(true, cells, 4, 0, true);
    CHECK_ROW("METHOD 3", "1D manufactured solution, cubic, dt ~ dx, velocity given at 0: order, 64 to 128 cells", 1, none, 0.3);
    CHECK(half_step > none + 0.5);
}

int main(void) {
    RUN(a_line_at_second_order);
    RUN(a_late_velocity_costs_an_order);
    RUN(space_at_second_order);
    return check_finish();
}
