/* Who is bonded to whom, and how strongly: in f64, compiled once for all variants. */
#ifndef SUNDER_SHEET_NETWORK_H
#define SUNDER_SHEET_NETWORK_H

#include "sheet/plan.h"
#include "sheet/sheet.h"

/* Every bond is stored from both ends: arrays over directed bonds, each particle's in ascending order of its neighbours. */
typedef struct sheet_network {
    int64_t count, bond_count;
    int64_t *start;         // [count + 1]
    int32_t *neighbour;     // [bond_count]
    double *length;         // [bond_count], rest length
    double *weight;         // [bond_count], W
    uint8_t *cut;           // [bond_count], 1: crossed by a notch
    uint8_t *body;          // [count]
    /* calibrated */
    double *stiffness;      // [bond_count], c W A_j / (|r⁰| ρ h): acceleration of this end when f/c = 1
    double *limit;          // [bond_count], critical stretch; NULL: nothing breaks
    double *conduct;        // [bond_count], κ W A_j / (|r⁰|² ρ C), per time; NULL: nothing diffuses
    double *coupling;       // [bond_count], weight of ϑ_i/w_i + ϑ_j/w_j beside the stretch; NULL: no state-based form
    double *dilation;       // [bond_count], 2 W A_j / w_i²
    double *laplace;        // [bond_count], Σ laplace (x_j − x_i) is the Laplacian; NULL: nothing resists bending
    double *sum;            // [count], w_i = Σ W A_j
    double *pace;           // [count], Σ c W A_j / (2 ρ h r²): Δt ≤ 1/√ of it
    double momentum_bound;  /* the largest pace */
    double bending_bound;   /* largest (Σ laplace) √(B/ρh): Δt ≤ 1/it */
    double diffusion_bound; /* largest Σ κ W A_j / (ρ C r²): Δt ≤ 1/it */
    sheet_calibration calibration[SHEET_BODIES];
} sheet_network;

/* Finds bonds, weights and cuts. plans has shape [material_count]. Errors: STATUS_INPUT for a radius that leaves no isotropic weights or
 * particles that coincide, STATUS_SYSTEM when memory is out; the network is then empty. */
status network_build(const sheet_definition *d, const sheet_plan *plans, sheet_network *n, report *r);
void network_free(sheet_network *n);

/* Fills what is calibrated: once, and again when a knob is turned. Errors: values that do not go together. */
status network_calibrate(const sheet_definition *d, const sheet_plan *plans, sheet_network *n, report *r);

/* The neighbours of one particle of an endless lattice of spacing 1 within `radius`, by x then y: xy [limit][2]. Returns how many. */
enum { LATTICE_LIMIT = 128 };
int lattice_neighbours(sheet_lattice kind, double radius, double (*xy)[2]);

/* What a straight crack needs of a lattice with isotropic weights, over the toughness of the bonds that it cuts: at rest, bond by bond; and while it runs. `radius` in spacings; at rest lattices
 * alone. */
double trapping_at_rest(sheet_lattice lattice, double radius);
double trapping_toughness(sheet_lattice lattice, double radius, int neighbours);

/* Weights of those neighbours. Errors: STATUS_INPUT when no weights ≥ 0 make the lattice isotropic. */
status lattice_weights(sheet_weight kind, double radius, const double (*xy)[2], int count, double *weight, report *r);

#endif
