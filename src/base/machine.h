/* What the machine could do at best: the figures that measured speeds are held against. */
#ifndef SUNDER_BASE_MACHINE_H
#define SUNDER_BASE_MACHINE_H

#include "base/status.h"

#include <stdint.h>

enum { MACHINE_CACHE_LEVELS = 4 };

typedef struct machine {
    char processor[128];                       /* its name, or the architecture's where the system knows no name */
    int processors;                            /* that this process may run on */
    int64_t cache_bytes[MACHINE_CACHE_LEVELS]; /* [level − 1], data or unified, one instance; 0: not known */
} machine;

void machine_describe(machine *m);

/* STREAM's triad a = b + s c in GB/s (1e9 bytes), on arrays four times the last cache each: the best of several passes. Counted as STREAM does,
 * three reals an element; that a store first loads its line is not. Errors: out of memory. */
status machine_triad(int threads, double *gb_s, report *r);

/* The most multiply-adds that one core does, in GFLOP/s (a multiply-add is two), with operands in registers; precision 32 or 64.
 * *simd becomes the name of the best instruction set of those compiled: "plain" (multiply, then add), "avx2" or "avx512". */
double machine_fma(int precision, const char **simd);

#endif
