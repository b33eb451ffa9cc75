/* The f32 builds' return mapping, for test_plasticity.c, which is f64. */
#ifndef SUNDER_TESTS_PLASTICITY_F32_H
#define SUNDER_TESTS_PLASTICITY_F32_H

enum { PLASTIC_LANES = 16 };

/* F has shape [PLASTIC_LANES][9] and is replaced by what the instruction set `simd` makes of it (rounded to f32 on the way in); moduli
 * E = 100, ν = 0.3. 0 when this processor or build lacks `simd`. */
int plastic_return_f32(const char *simd, double yield_stress, double F[PLASTIC_LANES][9]);

#endif
