/* What the inextensible solve shares with the boundaries that hold the grid and with the engine. */
#ifndef SUNDER_SOLID_INEXTENSIBLE_H
#define SUNDER_SOLID_INEXTENSIBLE_H

#include "base/sparse.h"
#include "solid/state.h"

/* Memory for a number of grid slots; bytes of it. */
status constraint_reserve(solid *s, int32_t slots, report *r);
void constraint_free(solid *s);
double constraint_bytes(const solid *s);
/* Takes the stretching along inextensible fibres out of the grid's velocities (METHOD.md §4): the grid's last stage. Errors: STATUS_DIVERGED when
 * the tension is not finite. */
status constraint_solve(solid *s, real dt, report *r);

/* What to precondition with (constraint_solver.c). AUTO starts with Jacobi's and goes over to a factorisation, or to multigrid where that would
 * take too much work, when it is slow: decided by iterations and operations, never by time, so that runs repeat. */
typedef enum constraint_solver { CONSTRAINT_AUTO, CONSTRAINT_JACOBI, CONSTRAINT_DIRECT, CONSTRAINT_AMG } constraint_solver;

/* Whether it is time to make a (new) preconditioner, `since` iterations after the solve's start or its last making; `built` are the solve's own. */
bool constraint_is_slow(const solid *s, int since, int built);
/* Takes note of a solve that has ended. */
void constraint_solved(solid *s, int since, int built);
/* Makes one from the operator as it is. It serves the steps that follow, too. */
status constraint_precondition(solid *s, real dt, report *r);
/* Finds its unknowns again after the grid was built anew. */
void constraint_map(solid *s);
/* Drops it; a frame starts without, so that a resumed run has the same bits. */
void constraint_forget(solid *s);
void constraint_begin_frame(solid *s);

/* Σ V Γ and ε of a cell, and the root of Jacobi's preconditioner: 0 where a cell has no say. */
double constraint_weight(const solid *s, int32_t slot, int n);
double constraint_scale(const solid *s, int32_t slot, int n);
double constraint_relaxation(const solid *s, int32_t slot, int n);
/* Two cells that are further apart than this along an axis share no node. */
int constraint_reach(const solid *s);
/* The operator as a matrix over the cells that have a number (constraint_matrix.c). Errors: out of memory. */
status constraint_assemble(solid *s, real dt, const int32_t *number, int32_t cells, sparse_matrix *m, report *r);

#endif
