/* Grips and colliders: rigid shapes that set the velocity of the grid nodes inside them.
 *
 * A grip prescribes its own velocity. A collider is sticky (the same), slips (no normal motion relative to it) or separates
 * (may leave, not enter), the latter two with Coulomb friction. What they put in is counted: impulse on the nodes, and work as
 * that impulse times the boundary's velocity. */
#include "solid/state.h"

/* How a boundary that has left a node with a velocity holds it. */
static hold_kind hold_of(const solid_boundary *b, contact_outcome outcome) {
    bool separates = !b->grip && b->contact == CONTACT_SEPARATE;
    switch (outcome) {
    case OUTCOME_HELD: return HOLD_FIXED;
    case OUTCOME_LEFT: return HOLD_CANDIDATE;
    case OUTCOME_STUCK: return separates ? HOLD_STUCK : HOLD_FIXED;
    case OUTCOME_SLID: break;
    }
    return separates ? HOLD_TOUCHING : HOLD_PLANE;
}

/* Where boundaries overlap: a node that two of them hold in different planes cannot move; one that is only near a boundary is
 * whatever the other makes of it. */
static void merge_hold(node_hold *into, const node_hold *from) {
    real alike = into->normal[0] * from->normal[0] + into->normal[1] * from->normal[1] + into->normal[2] * from->normal[2];
    if (into->kind == HOLD_FIXED || (from->kind == HOLD_CANDIDATE && into->kind != HOLD_FREE)) return;
    bool both = into->kind != HOLD_FREE && into->kind != HOLD_CANDIDATE && from->kind != HOLD_FIXED;
    hold_kind kind = both && alike < (real)0.99 ? HOLD_FIXED : (hold_kind)from->kind;
    *into = *from;
    into->kind = (int32_t)kind;
}

/* What boundaries did to a block's nodes. Where several have hold of one node, each undoes what those before it did: only what the node is left with is an
 * impulse, and the boundary whose velocity the node was given last did its work. */
typedef struct node_pushes {
    uint64_t pushed;               /* a bit for each node */
    double before[BLOCK_NODES][3]; /* velocity, of those */
    double by[BLOCK_NODES][3];     /* velocity of what pushed */
} node_pushes;

static void note_push(node_pushes *p, int node, const double before[3], const double u[3], const double normal[3], bool slides) {
    bool first = !(p->pushed >> node & 1);
    double along = 0;
    p->pushed |= (uint64_t)1 << node;
    for (int c = 0; c < 3 && !first; c++) along += (u[c] - p->by[node][c]) * normal[c];
    for (int c = 0; c < 3; c++) {
        if (first) p->before[node][c] = before[c];
        p->by[node][c] = first || !slides ? u[c] : p->by[node][c] + along * normal[c];
    }
}

static void count_pushes(const node_pushes *p, const real *nodes, block_result *result) {
    for (uint64_t left = p->pushed; left; left &= left - 1) {
        int node = __builtin_ctzll(left);
        for (int c = 0; c < 3; c++) {
            double impulse = (double)nodes[node * NODE + 3] * ((double)nodes[node * NODE + c] - p->before[node][c]);
            result->grip_impulse[c] += impulse;
            result->grip_work += impulse * p->by[node][c];
        }
    }
}

/* Applies one boundary to one node at world position x; `hold` is NULL unless someone wants to know. */
static void apply_to_node(const solid_boundary *b, const double x[3], double dx, int node, real *nodes, node_pushes *pushes, node_hold *hold) {
    double rest[3];
    real *own = nodes + node * NODE;
    rigid_motion_to_rest(&b->motion, x, rest);
    if (shape_distance(b->shape, rest) >= 0) return;
    double u[3], v[3] = {(double)own[0], (double)own[1], (double)own[2]}, normal[3] = {0, 0, 0};
    double before[3] = {v[0], v[1], v[2]};
    rigid_motion_velocity(&b->motion, x, u);
    contact_outcome outcome = rigid_boundary_velocity(b, rest, 1e-3 * dx, u, v, normal);
    if (hold) {
        node_hold now = {.wall = (real)(u[0] * normal[0] + u[1] * normal[1] + u[2] * normal[2]), .kind = (int32_t)hold_of(b, outcome)};
        for (int c = 0; c < 3; c++) now.normal[c] = (real)normal[c], now.before[c] = (real)before[c];
        merge_hold(hold, &now);
    }
    if (outcome == OUTCOME_LEFT) return;
    note_push(pushes, node, before, u, normal, outcome == OUTCOME_SLID);
    for (int c = 0; c < 3; c++) own[c] = (real)v[c];
}

/* A mesh's vertices, each where it is. */
static void hold_vertices(const grid_work *w) {
    const solid *s = w->state;
    node_pushes pushes;
    pushes.pushed = 0;
    for (int i = 0; i < s->definition.boundary_count; i++)
        for (int v = 0; v < BLOCK_NODES && s->definition.boundaries[i].motion.active; v++)
            if (w->nodes[v * NODE + 3] > 0)
                apply_to_node(&s->definition.boundaries[i], w->places + 3 * v, s->definition.dx, v, w->nodes, &pushes, NULL);
    count_pushes(&pushes, w->nodes, w->result);
}

static void hold(const grid_work *w) {
    if (w->places) {
        hold_vertices(w);
        return;
    }
    const solid *s = w->state;
    double dx = s->definition.dx;
    const int32_t *block = s->slot_coordinate[w->slot];
    node_hold *holds = s->constraint.on ? s->constraint.holds + (int64_t)w->slot * BLOCK_NODES : NULL;
    double corner[3], center[3], reach = 0.5 * sqrt(3.0) * (BLOCK - 1) * dx;
    node_pushes pushes;
    pushes.pushed = 0;
    for (int c = 0; c < 3; c++) {
        corner[c] = (double)block[c] * BLOCK * dx;
        center[c] = corner[c] + 0.5 * (BLOCK - 1) * dx;
    }
    for (int i = 0; i < s->definition.boundary_count; i++) {
        const solid_boundary *b = &s->definition.boundaries[i];
        if (!b->motion.active) continue;
        double rest[3];
        rigid_motion_to_rest(&b->motion, center, rest);
        if (shape_distance(b->shape, rest) > reach) continue; /* the whole block is outside */
        for (int node = 0; node < BLOCK_NODES; node++) {
            if (!(w->nodes[node * NODE + 3] > 0)) continue;
            double x[3] = {corner[0] + dx * (node / 16), corner[1] + dx * (node / 4 % 4), corner[2] + dx * (node % 4)};
            apply_to_node(b, x, dx, node, w->nodes, &pushes, holds ? holds + node : NULL);
        }
    }
    count_pushes(&pushes, w->nodes, w->result);
}

static const effect_measure measures[] = {
    {"grip_work", "mass length^2/time^2", "work that grips and colliders have done on the material"},
};

static const solid_stages stages = {.grid = hold};

const effect SOLID_EFFECT(boundary) = {
    .name = "boundary", .engine = ENGINE_SOLID, .scope = SCOPE_SCENE, .doc = "grips, colliders and walls of the scene",
    .reference = "METHOD.md section 3", .measures = measures, .measure_count = 1, .stages = &stages,
};
