/* Fibre directions: whatever comes in, an orthonormal pair goes out. */
#include "base/random.h"
#include "check.h"
#include "geom/fibres.h"

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void check_orthonormal(const double a1[3], const double a2[3]) {
    CHECK_NEAR(dot(a1, a1), 1.0, 1e-15);
    CHECK_NEAR(dot(a2, a2), 1.0, 1e-15);
    CHECK_NEAR(dot(a1, a2), 0.0, 1e-15);
}

static void keeps_direction_and_plane(void) {
    double a1[3] = {3.0, 0.0, 0.0}, a2[3] = {5.0, -2.0, 0.0};
    CHECK(fibres_orthonormalise(a1, a2));
    check_orthonormal(a1, a2);
    CHECK_NEAR(a1[0], 1.0, 0.0);
    CHECK_NEAR(a2[1], -1.0, 1e-15);
}

static void random_pairs(void) {
    for (uint64_t n = 0; n < 10000; n++) {
        double a1[3], a2[3], before[3];
        for (uint64_t i = 0; i < 3; i++) {
            before[i] = a1[i] = random_unit(1, 1, 3 * n + i) - 0.5;
            a2[i] = random_unit(1, 2, 3 * n + i) - 0.5;
        }
        double sense = dot(a1, a2) / sqrt(dot(a1, a1)), orthogonal[3];
        for (int i = 0; i < 3; i++) orthogonal[i] = a2[i] - sense * a1[i] / sqrt(dot(before, before));
        CHECK(fibres_orthonormalise(a1, a2));
        check_orthonormal(a1, a2);
        CHECK_NEAR(dot(a1, before), sqrt(dot(before, before)), 1e-14);
        CHECK_NEAR(dot(a2, orthogonal), sqrt(dot(orthogonal, orthogonal)), 1e-13);
    }
}

/* Nearly parallel directions are where one projection alone loses orthogonality. */
static void nearly_parallel(void) {
    for (double angle = 1e-3; angle > 1e-16; angle *= 0.1) {
        double a1[3] = {1.0, 2.0, -0.5}, a2[3] = {1.0, 2.0 + angle, -0.5};
        CHECK(fibres_orthonormalise(a1, a2));
        check_orthonormal(a1, a2);
    }
}

static void one_direction_only(void) {
    static const double directions[][3] = {{1, 0, 0}, {0, 1, 0},           {0, 0, -1},
                                           {1, 1, 1}, {1e-200, 2e-200, 0}, {1e200, 1e200, 3e200}};
    for (size_t n = 0; n < sizeof directions / sizeof *directions; n++) {
        double a1[3] = {directions[n][0], directions[n][1], directions[n][2]}, a2[3] = {0.0, 0.0, 0.0};
        CHECK(fibres_orthonormalise(a1, a2));
        check_orthonormal(a1, a2);
        double b1[3] = {directions[n][0], directions[n][1], directions[n][2]};
        double b2[3] = {-b1[0], -b1[1], -b1[2]};
        CHECK(fibres_orthonormalise(b1, b2));
        CHECK(memcmp(a2, b2, sizeof a2) == 0);
    }
}

static void refuses_what_has_no_direction(void) {
    double zero[3] = {0.0, 0.0, 0.0}, a2[3] = {0.0, 2.0, 0.0};
    CHECK(!fibres_orthonormalise(zero, a2));
    CHECK(a2[1] == 2.0);
    double infinite[3] = {1.0, HUGE_VAL, 0.0}, undefined[3] = {NAN, 0.0, 0.0}, a1[3] = {4.0, 0.0, 0.0};
    CHECK(!fibres_orthonormalise(infinite, a2));
    CHECK(!fibres_orthonormalise(undefined, a2));
    CHECK(!fibres_orthonormalise(a1, undefined));
    CHECK(a1[0] == 4.0);
}

int main(void) {
    RUN(keeps_direction_and_plane);
    RUN(random_pairs);
    RUN(nearly_parallel);
    RUN(one_direction_only);
    RUN(refuses_what_has_no_direction);
    return check_finish();
}
