#include "base/sparse.h"

#include "base/memory.h"

#include <string.h>

#ifdef SUNDER_HAS_CHOLMOD
#include <dlfcn.h>
#include <suitesparse/cholmod.h>
#endif
#ifdef SUNDER_HAS_HYPRE
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wstrict-prototypes"
#include <HYPRE.h>
#include <HYPRE_IJ_mv.h>
#include <HYPRE_parcsr_ls.h>
#include <mpi.h>
#pragma GCC diagnostic pop
#include <stdlib.h>
#endif

struct sparse_solver {
    sparse_kind kind;
    int32_t size;
    double making, applying; /* sparse_price */
#ifdef SUNDER_HAS_CHOLMOD
    cholmod_common common;
    cholmod_factor *factor;
    cholmod_dense *right, *solution, *work_y, *work_e;
#endif
#ifdef SUNDER_HAS_HYPRE
    HYPRE_Solver amg;
    HYPRE_IJMatrix matrix;
    HYPRE_IJVector b, x;
    HYPRE_ParCSRMatrix parcsr;
    HYPRE_ParVector parcsr_b, parcsr_x;
    HYPRE_BigInt *rows; // [size], 0 … size − 1
#endif
};

bool sparse_available(sparse_kind kind) {
#ifdef SUNDER_HAS_CHOLMOD
    if (kind == SPARSE_DIRECT) return true;
#endif
#ifdef SUNDER_HAS_HYPRE
    if (kind == SPARSE_AMG) return true;
#endif
    (void)kind;
    return false;
}

const char *sparse_package(sparse_kind kind) {
    return kind == SPARSE_DIRECT ? "libsuitesparse-dev" : "libhypre-dev";
}

bool sparse_start(sparse_matrix *m, int32_t size) {
    *m = (sparse_matrix){.size = size};
    m->start = memory_allocate_array((size_t)size + 1, sizeof *m->start);
    return m->start;
}

bool sparse_allocate(sparse_matrix *m) {
    m->capacity = m->start[m->size];
    m->row = memory_allocate_array((size_t)m->capacity, sizeof *m->row);
    m->value = memory_allocate_array((size_t)m->capacity, sizeof *m->value);
    return m->row && m->value;
}

void sparse_free(sparse_matrix *m) {
    memory_free(m->start, m->start ? ((size_t)m->size + 1) * sizeof *m->start : 0);
    memory_free(m->row, m->row ? (size_t)m->capacity * sizeof *m->row : 0);
    memory_free(m->value, m->value ? (size_t)m->capacity * sizeof *m->value : 0);
    *m = (sparse_matrix){0};
}

/* ---- CHOLMOD ----------------------------------------------------------------------------------------------------- */

#ifdef SUNDER_HAS_CHOLMOD
/* For sparse_price, nanoseconds: of analysis and copies an entry of the matrix, of a factorisation (with a BLAS that is made for the processor) and of
 * a solve a multiplication. */
static const double ANALYSING = 10, FACTORING = 0.05, SOLVING = 0.6;

/* CHOLMOD's view of a matrix that it does not own. */
static cholmod_sparse view_of(const sparse_matrix *m) {
    return (cholmod_sparse){.nrow = (size_t)m->size, .ncol = (size_t)m->size, .nzmax = (size_t)m->start[m->size], .p = m->start, .i = m->row,
                            .x = m->value, .stype = -1, .itype = CHOLMOD_INT, .xtype = CHOLMOD_REAL, .dtype = CHOLMOD_DOUBLE,
                            .sorted = 0, .packed = 1};
}

/* CHOLMOD asks OpenMP for four threads, and OpenBLAS takes all processors where it is not the serial one: with blocks as small as these they mostly wait for each
 * other, and sums may be split by the number of threads. Neither need be there: what BLAS is, the system decides when the program starts. */
static void stay_on_one_thread(void) {
    static const struct {
        const char *name;
        int argument;
    } calls[] = {{"omp_set_max_active_levels", 0}, {"openblas_set_num_threads", 1}};
    for (size_t i = 0; i < sizeof calls / sizeof calls[0]; i++) {
        void (*call)(int) = NULL;
        void *found = dlsym(RTLD_DEFAULT, calls[i].name);
        memcpy(&call, &found, sizeof call); /* C has no cast from an object's pointer to a function's */
        if (call) call(calls[i].argument);
    }
}

static status direct_create(sparse_solver *s, const sparse_matrix *m, double work_limit, bool *too_much, report *r) {
    cholmod_sparse a = view_of(m);
    stay_on_one_thread();
    cholmod_start(&s->common);
    s->common.print = 0;
    s->common.nmethods = 1;
    s->common.method[0].ordering = m->ordered ? CHOLMOD_NATURAL : CHOLMOD_AMD;
    s->common.postorder = !m->ordered;
    s->factor = cholmod_analyze(&a, &s->common);
    *too_much = s->factor && work_limit > 0 && s->common.fl > work_limit;
    if (*too_much) return STATUS_OK;
    if (!s->factor || !cholmod_factorize(&a, s->factor, &s->common) || s->common.status != CHOLMOD_OK)
        return report_set(r, STATUS_DIVERGED, "the factorisation of %d unknowns failed (CHOLMOD status %d)", m->size, s->common.status);
    s->making = FACTORING * s->common.fl + ANALYSING * (double)m->start[m->size];
    s->applying = SOLVING * 2 * s->common.lnz;
    s->right = cholmod_allocate_dense((size_t)m->size, 1, (size_t)m->size, CHOLMOD_REAL, &s->common);
    return s->right ? STATUS_OK : report_set(r, STATUS_SYSTEM, "out of memory for a factorisation of %d unknowns", m->size);
}

static void direct_destroy(sparse_solver *s) {
    cholmod_free_factor(&s->factor, &s->common);
    cholmod_free_dense(&s->right, &s->common);
    cholmod_free_dense(&s->solution, &s->common);
    cholmod_free_dense(&s->work_y, &s->common);
    cholmod_free_dense(&s->work_e, &s->common);
    cholmod_finish(&s->common);
}

static status direct_apply(sparse_solver *s, const double *right, double *z, report *r) {
    size_t bytes = (size_t)s->size * sizeof *z;
    memcpy(s->right->x, right, bytes);
    if (!cholmod_solve2(CHOLMOD_A, s->factor, s->right, NULL, &s->solution, NULL, &s->work_y, &s->work_e, &s->common))
        return report_set(r, STATUS_SYSTEM, "a solve with %d unknowns failed (CHOLMOD status %d)", s->size, s->common.status);
    memcpy(z, s->solution->x, bytes);
    return STATUS_OK;
}
#endif

/* ---- hypre ------------------------------------------------------------------------------------------------------- */

#ifdef SUNDER_HAS_HYPRE
/* For sparse_price: of set-up and cycle, an entry of the matrix. */
static const double SETTING_UP = 500, CYCLING = 40;

static void leave_mpi(void) {
    int over = 0;
    MPI_Finalized(&over);
    if (over) return;
    HYPRE_Finalize();
    MPI_Finalize();
}

/* hypre talks through MPI even alone: one process, no network, no helper programs. */
static void enter_mpi(void) {
    int begun = 0;
    MPI_Initialized(&begun);
    if (begun) return;
    setenv("OMPI_MCA_btl", "self", 0);
    setenv("OMPI_MCA_pml", "ob1", 0);
    setenv("OMPI_MCA_plm_rsh_agent", "", 0);
    int provided;
    MPI_Init_thread(NULL, NULL, MPI_THREAD_SERIALIZED, &provided);
    HYPRE_Init();
    atexit(leave_mpi);
}

/* Both triangles, row by row. */
static bool fill_matrix(sparse_solver *s, const sparse_matrix *m) {
    HYPRE_BigInt last = m->size - 1;
    HYPRE_IJMatrixCreate(MPI_COMM_SELF, 0, last, 0, last, &s->matrix);
    HYPRE_IJMatrixSetObjectType(s->matrix, HYPRE_PARCSR);
    HYPRE_IJMatrixInitialize(s->matrix);
    for (int32_t column = 0; column < m->size; column++)
        for (int32_t e = m->start[column]; e < m->start[column + 1]; e++) {
            HYPRE_Int one = 1;
            HYPRE_BigInt i = m->row[e], j = column;
            HYPRE_IJMatrixAddToValues(s->matrix, 1, &one, &i, &j, &m->value[e]);
            if (i != j) HYPRE_IJMatrixAddToValues(s->matrix, 1, &one, &j, &i, &m->value[e]);
        }
    HYPRE_IJMatrixAssemble(s->matrix);
    HYPRE_IJMatrixGetObject(s->matrix, (void **)&s->parcsr);
    return HYPRE_GetError() == 0;
}

static void make_vector(int32_t size, HYPRE_IJVector *v, HYPRE_ParVector *parcsr) {
    HYPRE_IJVectorCreate(MPI_COMM_SELF, 0, size - 1, v);
    HYPRE_IJVectorSetObjectType(*v, HYPRE_PARCSR);
    HYPRE_IJVectorInitialize(*v);
    HYPRE_IJVectorAssemble(*v);
    HYPRE_IJVectorGetObject(*v, (void **)parcsr);
}

static status amg_create(sparse_solver *s, const sparse_matrix *m, report *r) {
    enter_mpi();
    s->rows = memory_allocate_array((size_t)m->size, sizeof *s->rows);
    if (!s->rows) return report_set(r, STATUS_SYSTEM, "out of memory for a multigrid of %d unknowns", m->size);
    for (int32_t i = 0; i < m->size; i++) s->rows[i] = i;
    bool fine = fill_matrix(s, m);
    make_vector(m->size, &s->b, &s->parcsr_b);
    make_vector(m->size, &s->x, &s->parcsr_x);
    s->making = SETTING_UP * (double)m->start[m->size];
    s->applying = CYCLING * (double)m->start[m->size];
    HYPRE_BoomerAMGCreate(&s->amg);
    HYPRE_BoomerAMGSetPrintLevel(s->amg, 0);
    HYPRE_BoomerAMGSetMaxIter(s->amg, 1);
    HYPRE_BoomerAMGSetTol(s->amg, 0);
    HYPRE_BoomerAMGSetRelaxType(s->amg, 8);    /* l1 symmetric Gauss–Seidel: a V-cycle stays symmetric */
    HYPRE_BoomerAMGSetCoarsenType(s->amg, 10); /* HMIS */
    HYPRE_BoomerAMGSetInterpType(s->amg, 6);   /* extended + i */
    HYPRE_BoomerAMGSetStrongThreshold(s->amg, 0.5);
    fine = fine && HYPRE_BoomerAMGSetup(s->amg, s->parcsr, s->parcsr_b, s->parcsr_x) == 0;
    return fine ? STATUS_OK : report_set(r, STATUS_DIVERGED, "the multigrid set-up of %d unknowns failed (hypre)", m->size);
}

static void amg_destroy(sparse_solver *s) {
    if (s->amg) HYPRE_BoomerAMGDestroy(s->amg);
    if (s->matrix) HYPRE_IJMatrixDestroy(s->matrix);
    if (s->b) HYPRE_IJVectorDestroy(s->b);
    if (s->x) HYPRE_IJVectorDestroy(s->x);
    memory_free(s->rows, s->rows ? (size_t)s->size * sizeof *s->rows : 0);
}

static status amg_apply(sparse_solver *s, const double *right, double *z, report *r) {
    memset(z, 0, (size_t)s->size * sizeof *z);
    HYPRE_IJVectorSetValues(s->b, s->size, s->rows, right);
    HYPRE_IJVectorSetValues(s->x, s->size, s->rows, z);
    HYPRE_BoomerAMGSolve(s->amg, s->parcsr, s->parcsr_b, s->parcsr_x);
    HYPRE_ClearAllErrors(); /* one cycle does not converge, and is not asked to */
    HYPRE_IJVectorGetValues(s->x, s->size, s->rows, z);
    (void)r;
    return STATUS_OK;
}
#endif

/* ---- either ------------------------------------------------------------------------------------------------------ */

status sparse_create(sparse_kind kind, const sparse_matrix *m, double work_limit, sparse_solver **out, report *r) {
    *out = NULL;
    if (!sparse_available(kind)) return report_set(r, STATUS_SYSTEM, "this build lacks the package %s, which the solver asked for needs", sparse_package(kind));
    sparse_solver *s = memory_allocate(sizeof *s);
    if (!s) return report_set(r, STATUS_SYSTEM, "out of memory for a solver");
    s->kind = kind;
    s->size = m->size;
    status code = STATUS_OK;
    bool too_much = false;
    (void)work_limit;
#ifdef SUNDER_HAS_CHOLMOD
    if (kind == SPARSE_DIRECT) code = direct_create(s, m, work_limit, &too_much, r);
#endif
#ifdef SUNDER_HAS_HYPRE
    if (kind == SPARSE_AMG) code = amg_create(s, m, r);
#endif
    if (code != STATUS_OK || too_much) {
        sparse_destroy(s);
        return code;
    }
    *out = s;
    return STATUS_OK;
}

void sparse_destroy(sparse_solver *s) {
    if (!s) return;
#ifdef SUNDER_HAS_CHOLMOD
    if (s->kind == SPARSE_DIRECT) direct_destroy(s);
#endif
#ifdef SUNDER_HAS_HYPRE
    if (s->kind == SPARSE_AMG) amg_destroy(s);
#endif
    memory_free(s, sizeof *s);
}

void sparse_price(const sparse_solver *s, double *making, double *applying) {
    *making = s->making;
    *applying = s->applying;
}

status sparse_apply(sparse_solver *s, const double *right, double *z, report *r) {
#ifdef SUNDER_HAS_CHOLMOD
    if (s->kind == SPARSE_DIRECT) return direct_apply(s, right, z, r);
#endif
#ifdef SUNDER_HAS_HYPRE
    if (s->kind == SPARSE_AMG) return amg_apply(s, right, z, r);
#endif
    (void)s, (void)right, (void)z;
    return report_set(r, STATUS_SYSTEM, "this build has no library for the solve");
}
