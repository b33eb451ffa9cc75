/* Preconditioners for symmetric positive definite systems, from libraries that may be absent.
 *
 * The systems are those that a solver of ours meets matrix-free and cannot bring down alone; an assembled copy, even of some steps
 * ago, makes a good preconditioner. CHOLMOD (SuiteSparse) factors it; hypre's BoomerAMG runs one V-cycle over it. One thread, f64:
 * the same bits whatever runs beside, as long as the libraries are the same: CHOLMOD factors dense blocks by the machine's BLAS. */
#ifndef SUNDER_BASE_SPARSE_H
#define SUNDER_BASE_SPARSE_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* The lower triangle by columns; within a column rows are in any order, the diagonal among them. */
typedef struct sparse_matrix {
    int32_t size;
    int32_t *start; /* [size + 1] */
    int32_t *row;   /* [start[size]] */
    double *value;  /* [start[size]] */
    int32_t capacity; /* of row and value, for sparse_free */
    bool ordered;     /* numbered so that a factorisation fills in little (dissection.h); else the library looks for an order */
} sparse_matrix;

typedef enum sparse_kind { SPARSE_DIRECT, SPARSE_AMG, SPARSE_KINDS } sparse_kind;

typedef struct sparse_solver sparse_solver;

/* Whether this build has the library, and the Debian package that brings it. */
bool sparse_available(sparse_kind kind);
const char *sparse_package(sparse_kind kind);

/* Room for `start`, zeroed; once that holds the columns' beginnings, room for the entries. False when memory is out. sparse_free takes what either
 * left. */
bool sparse_start(sparse_matrix *m, int32_t size);
bool sparse_allocate(sparse_matrix *m);
void sparse_free(sparse_matrix *m);

/* Makes a preconditioner from a matrix, which it copies. `work_limit` (0: none) is the most multiplications that a factorisation may
 * take: above it *out is NULL and the status is OK. Errors: a library that is absent or fails. */
status sparse_create(sparse_kind kind, const sparse_matrix *m, double work_limit, sparse_solver **out, report *r);
void sparse_destroy(sparse_solver *s);

/* Nanoseconds, roughly, that making it from its matrix took and that an application takes, from counts alone: for decisions that must repeat. */
void sparse_price(const sparse_solver *s, double *making, double *applying);

/* z ← P⁻¹ r, both [size]. Errors: the library's. */
status sparse_apply(sparse_solver *s, const double *right, double *z, report *r);

#endif
