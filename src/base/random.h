/* Random numbers by counter: the value depends on (seed, stream, counter) alone, never on the order of calls or on the
 * number of threads. The mixing is SplitMix64's finaliser (Steele, Lea, Flood 2014) applied to each word in turn. */
#ifndef SUNDER_BASE_RANDOM_H
#define SUNDER_BASE_RANDOM_H

#include <stdint.h>

static inline uint64_t random_mix(uint64_t z) {
    z += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* 64 random bits. `stream` tells uses apart (one constant a use), `counter` is usually a particle's id. */
static inline uint64_t random_bits(uint64_t seed, uint64_t stream, uint64_t counter) {
    return random_mix(counter ^ random_mix(stream ^ random_mix(seed)));
}

/* Uniform in [0, 1), 53 bits. */
static inline double random_unit(uint64_t seed, uint64_t stream, uint64_t counter) {
    return (double)(random_bits(seed, stream, counter) >> 11) * 0x1p-53;
}

#endif
