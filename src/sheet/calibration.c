/* From moduli to numbers of each bond (METHOD.md §6, 2 to 8). */
#include "sheet/network.h"

#include "geom/vector.h"

#include <float.h>
#include <math.h>

static const double PI = 3.14159265358979323846;

/* Sums over the neighbours of an interior particle. */
typedef struct interior {
    double weight_sum; /* Σ W A */
    double crossing;   /* Σ A W (r·n) over bonds that leave through a line along the lattice: bonds cut by a unit of crack, times A² */
    int neighbours;
} interior;

static status interior_of_lattice(const sheet_body *b, const sheet_plan *p, interior *out, report *r) {
    double xy[LATTICE_LIMIT][2], weight[LATTICE_LIMIT], dx = b->spacing;
    int count = lattice_neighbours(b->lattice, b->radius, xy);
    status code = lattice_weights(p->weight, b->radius, (const double(*)[2])xy, count, weight, r);
    double area = dx * dx * (b->lattice == SHEET_HEXAGONAL ? sqrt(0.75) : 1);
    for (int k = 0; k < count && code == STATUS_OK; k++) {
        out->weight_sum += weight[k] * area;
        out->crossing += weight[k] * area * dx * fmax(0, xy[k][1]);
        out->neighbours += weight[k] > 0;
    }
    return code;
}

/* Of scattered particles: means, over all directions of the crack. */
static void interior_of_scatter(const sheet_definition *d, const sheet_body *b, const sheet_network *n, interior *out) {
    double bonds = 0;
    for (int64_t i = b->first; i < b->first + b->count; i++)
        for (int64_t k = n->start[i]; k < n->start[i + 1]; k++) {
            double share = n->weight[k] * d->area[n->neighbour[k]] / (double)b->count;
            out->weight_sum += share;
            out->crossing += share * n->length[k] / PI;
            bonds += n->weight[k] > 0;
        }
    out->neighbours = (int)lround(bonds / (double)b->count);
}

/* ---- laws: stored energy of a bond over c --------------------------------------------------------------------------- */

/* The two coefficients of rubber, each over c. */
static void rubber_constants(const sheet_plan *p, double c, double *cn, double *cs) {
    *cs = p->c_star / c;
    *cn = (1 - *cs * p->power * (p->power - 1)) / 8;
}

static double rubber_force(const sheet_plan *p, double c, double s) {
    double cn, cs;
    rubber_constants(p, c, &cn, &cs);
    return 2 * cn * (s - 1 / (s * s * s)) + cs * p->power * (pow(s, p->power - 1) - 1);
}

static double rubber_energy(const sheet_plan *p, double c, double s) {
    double cn, cs;
    rubber_constants(p, c, &cn, &cs);
    return cn * (s * s + 1 / (s * s) - 2) + cs * (pow(s, p->power) - 1 - p->power * (s - 1));
}

static double plastic_energy(double eta0, double beta, double eta) {
    if (eta <= eta0) return 0.5 * eta * eta;
    return 0.5 * eta0 * eta0 - eta0 * eta0 / beta * expm1(-beta * (eta - eta0) / eta0);
}

/* The stretch at which rubber has stored `energy`; 0 when it softens before. */
static double rubber_stretch(const sheet_plan *p, double c, double energy) {
    double low = 0, high = 1e-3;
    while (rubber_energy(p, c, 1 + high) < energy) {
        if (rubber_force(p, c, 1 + high) <= 0 || high > 1e6) return 0;
        low = high, high *= 1.3;
    }
    for (int i = 0; i < 200; i++) {
        double middle = 0.5 * (low + high);
        *(rubber_energy(p, c, 1 + middle) < energy ? &low : &high) = middle;
    }
    return high;
}

/* The decay that lets a bond take `energy` up to the stretch `eta`; 0 when there is none. */
static double plastic_decay(double eta0, double eta, double energy) {
    double low = 1e-9, high = 1e9;
    if (!(eta > eta0) || plastic_energy(eta0, high, eta) > energy || plastic_energy(eta0, low, eta) < energy) return 0;
    for (int i = 0; i < 200; i++) {
        double middle = sqrt(low * high);
        *(plastic_energy(eta0, middle, eta) > energy ? &low : &high) = middle;
    }
    return sqrt(low * high);
}

static double plastic_stretch(double eta0, double beta, double energy) {
    double low = 0, high = eta0 * (1 + 700 / beta);
    if (plastic_energy(eta0, beta, high) < energy) return 0;
    for (int i = 0; i < 200; i++) {
        double middle = 0.5 * (low + high);
        *(plastic_energy(eta0, beta, middle) < energy ? &low : &high) = middle;
    }
    return high;
}

static status fail(report *r, const char *key, const char *expected, const char *found) {
    return report_input(r, NULL, 0, key, expected, found, NULL);
}

static double energy_at(const sheet_plan *p, double c, double beta, double eta) {
    if (p->law == LAW_RUBBER) return rubber_energy(p, c, 1 + eta);
    return p->law == LAW_ELASTOPLASTIC ? plastic_energy(p->eta0, beta, eta) : 0.5 * eta * eta;
}

/* Of elastoplastic bonds two of toughness, critical stretch and decay are given, and fix the third. */
static status calibrate_plastic(const sheet_plan *p, double energy, sheet_calibration *out, report *r) {
    out->beta = p->beta;
    if (p->beta > 0) {
        out->critical_stretch = p->stretch > 0 ? p->stretch : plastic_stretch(p->eta0, p->beta, energy);
        if (p->stretch > 0 && p->toughness > 0)
            return fail(r, "fracture", "two of elastoplastic.beta, fracture.G and fracture.stretch: they fix the third", "all three");
        if (!(out->critical_stretch > 0))
            return fail(r, "fracture.G", "a toughness that bonds with this eta0 and beta can take", "more");
        return STATUS_OK;
    }
    if (!(p->stretch > 0) || !(p->toughness > 0))
        return fail(r, "fracture", "two of elastoplastic.beta, fracture.G and fracture.stretch", "fewer");
    out->critical_stretch = p->stretch;
    out->beta = plastic_decay(p->eta0, p->stretch, energy);
    return out->beta > 0 ? STATUS_OK
                         : fail(r, "fracture.stretch", "one above eta0 at which bonds can have taken the toughness G", "another");
}

static status calibrate_fracture(const sheet_body *b, const sheet_plan *p, const interior *in, sheet_calibration *out, report *r) {
    double per_energy = out->stiffness * in->crossing / b->thickness; /* G of bonds that break at the energy 1 (over c) */
    out->critical_stretch = HUGE_VAL;
    out->trapping = 1;
    out->beta = p->beta;
    if (!p->fractures)
        return p->law == LAW_ELASTOPLASTIC && !(p->beta > 0) ? fail(r, "elastoplastic.beta", "a value above 0 where nothing fractures", "none") : STATUS_OK;
    out->trapping = p->untrapped || p->paper ? 1 : sqrt(trapping_toughness(b->lattice, b->radius, in->neighbours));
    double energy = p->toughness / (per_energy * out->trapping * out->trapping);
    if (p->law == LAW_ELASTOPLASTIC) {
        status code = calibrate_plastic(p, energy, out, r);
        if (code != STATUS_OK) return code;
    } else if ((p->stretch > 0) == (p->toughness > 0)) {
        return fail(r, "fracture", "one of G and stretch", p->stretch > 0 ? "both" : "neither");
    } else if (p->stretch > 0) {
        out->critical_stretch = p->stretch;
    } else if (p->paper) {
        out->critical_stretch = sqrt(4 * PI * p->toughness / (9 * p->E * b->radius * b->spacing));
    } else {
        out->critical_stretch = p->law == LAW_RUBBER ? rubber_stretch(p, out->stiffness, energy) : sqrt(2 * energy);
    }
    if (p->law == LAW_RUBBER)
        for (int i = 1; i <= 1000; i++)
            if (!(out->critical_stretch > 0) || rubber_force(p, out->stiffness, 1 + out->critical_stretch * i / 1000) <= 0)
                return fail(r, "rubber.c_star", "a force that stays positive until bonds break", "one that softens before");
    out->toughness = per_energy * out->trapping * out->trapping * energy_at(p, out->stiffness, out->beta, out->critical_stretch);
    return STATUS_OK;
}

/* ---- each bond --------------------------------------------------------------------------------------------------- */

/* cos² of the angle between a bond and the grain, the mean of its ends' axes. */
static double along_grain(const sheet_definition *d, int64_t i, int64_t j) {
    double difference[3], squares = 0;
    int64_t ends[2] = {i < j ? i : j, i < j ? j : i};
    vector_subtract(d->rest + 3 * ends[1], d->rest + 3 * ends[0], difference);
    for (int e = 0; e < 2; e++) {
        double along = vector_dot(difference, d->grain + 3 * ends[e]);
        squares += 0.5 * along * along;
    }
    return squares / vector_dot(difference, difference);
}

/* c of the particle's own neighbourhood: at edges, where bonds are missing, those that are left are stiffer. */
static double own_stiffness(const sheet_body *b, const sheet_plan *p, double sum) {
    double R = b->radius * b->spacing;
    if (p->paper) return 18 * p->E / (3 * (1 - 2 * p->nu)) / (PI * R * R * R * R);
    if (p->state) return 8 * p->E * b->thickness / (1 + p->nu) / sum;
    return 6 * p->E * b->thickness / sum;
}

static double own_diffusivity(const sheet_plan *p, double sum, double area) {
    return p->paper ? p->conductivity / area : 4 * p->conductivity / sum;
}

/* Largest rise of a law's stiffness over c while it is a spring: what the time step must allow at the start. */
static double state_bound(const sheet_plan *p) {
    if (!p->state) return 1;
    double mu = 1 / (2 * (1 + p->nu)), lambda = (3 * p->nu - 1) / (2 * (1 - p->nu * p->nu));
    return 1 + fmax(0, lambda) / (2 * mu);
}

static void calibrate_bond(const sheet_definition *d, const sheet_body *b, const sheet_plan *p, sheet_network *n, int64_t i, int64_t k) {
    int64_t j = n->neighbour[k];
    double density = d->materials[b->material].density, share = n->weight[k] * d->area[j], length = n->length[k];
    double grain = d->grain && (p->grain_stiffness != 1 || p->grain_toughness != 1) ? along_grain(d, i, j) : 0;
    double stiffer = 1 + grain * (p->grain_stiffness - 1), tougher = 1 + grain * (p->grain_toughness - 1);
    double c = 0.5 * (own_stiffness(b, p, n->sum[i]) + own_stiffness(b, p, n->sum[j])) * stiffer;
    n->stiffness[k] = c * share / (length * density * b->thickness);
    if (n->limit) {
        const sheet_calibration *own = &n->calibration[n->body[i]];
        bool held = !p->fractures || (d->protected && (d->protected[i] || d->protected[j]));
        n->limit[k] = held || !isfinite(own->critical_stretch) ? FLT_MAX / 16 : own->critical_stretch * sqrt(tougher / stiffer);
    }
    if (n->conduct) {
        double kappa = p->diffuses ? 0.5 * (own_diffusivity(p, n->sum[i], d->area[i]) + own_diffusivity(p, n->sum[j], d->area[j])) : 0;
        n->conduct[k] = p->diffuses ? kappa * share / (length * length * density * p->capacity) : 0;
    }
    if (n->laplace) n->laplace[k] = p->bending > 0 ? 4 / n->calibration[n->body[i]].weight_sum * share / (length * length) : 0; /* no correction: edges do not count */
    if (n->coupling) {
        double mu = 1 / (2 * (1 + p->nu)), lambda = (3 * p->nu - 1) / (2 * (1 - p->nu * p->nu));
        /* √ of what the grain does in both, so that their product, an energy's gradient, has it once. */
        n->coupling[k] = p->state ? lambda / (4 * mu) / (1 / n->sum[i] + 1 / n->sum[j]) / sqrt(stiffer) : 0;
        n->dilation[k] = p->state ? 2 * share / (n->sum[i] * n->sum[i]) * sqrt(stiffer) : 0;
    }
}

static void calibrate_body(const sheet_definition *d, const sheet_plan *p, int body, sheet_network *n) {
    const sheet_body *b = &d->bodies[body];
    for (int64_t i = b->first; i < b->first + b->count; i++) {
        double momentum = 0, diffusion = 0, laplace = 0;
        for (int64_t k = n->start[i]; k < n->start[i + 1]; k++) {
            calibrate_bond(d, b, p, n, i, k);
            momentum += n->stiffness[k] / (2 * n->length[k]);
            if (n->conduct) diffusion += n->conduct[k];
            if (n->laplace) laplace += n->laplace[k];
        }
        n->pace[i] = momentum * state_bound(p);
        n->momentum_bound = fmax(n->momentum_bound, n->pace[i]);
        n->diffusion_bound = fmax(n->diffusion_bound, diffusion);
        n->bending_bound = fmax(n->bending_bound, laplace * sqrt(p->bending / (d->materials[b->material].density * b->thickness)));
    }
}

static status calibrate_interior(const sheet_definition *d, const sheet_plan *p, int body, sheet_network *n, report *r) {
    const sheet_body *b = &d->bodies[body];
    interior in = {0};
    status code = STATUS_OK;
    if (b->lattice == SHEET_SCATTERED) interior_of_scatter(d, b, n, &in);
    else code = interior_of_lattice(b, p, &in, r);
    if (code != STATUS_OK) return code;
    sheet_calibration *out = &n->calibration[body];
    *out = (sheet_calibration){.weight_sum = in.weight_sum, .neighbours = in.neighbours};
    out->stiffness = own_stiffness(b, p, in.weight_sum);
    return calibrate_fracture(b, p, &in, out, r);
}

status network_calibrate(const sheet_definition *d, const sheet_plan *plans, sheet_network *n, report *r) {
    for (int64_t i = 0; i < n->count; i++) {
        n->sum[i] = 0;
        for (int64_t k = n->start[i]; k < n->start[i + 1]; k++) n->sum[i] += n->weight[k] * d->area[n->neighbour[k]];
    }
    n->momentum_bound = n->diffusion_bound = n->bending_bound = 0;
    for (int b = 0; b < d->body_count; b++) {
        const sheet_plan *p = &plans[d->bodies[b].material];
        status code = calibrate_interior(d, p, b, n, r);
        if (code != STATUS_OK) return code;
        calibrate_body(d, p, b, n);
    }
    return STATUS_OK;
}
