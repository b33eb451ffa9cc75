/* One allocator hook with sized free, and named arenas on top of it.
 *
 * Every byte that our own code takes from the heap passes through here, so that tests can count what is live and make
 * the Nth allocation fail. Blocks are zeroed and aligned to 64 bytes (a cache line, a 512-bit register). */
#ifndef SUNDER_BASE_MEMORY_H
#define SUNDER_BASE_MEMORY_H

#include <stddef.h>
#include <stdint.h>

enum { MEMORY_ALIGNMENT = 64 };

/* Returns `bytes` zeroed bytes, or NULL when memory is out. A request for 0 bytes returns a valid, freeable block. */
void *memory_allocate(size_t bytes);

/* Zeroed array of count × size bytes; NULL when out of memory or when the product overflows. */
void *memory_allocate_array(size_t count, size_t size);

/* Gives back a block with the size that it was asked for; NULL is ignored. */
void memory_free(void *block, size_t bytes);

/* Resizes a block, keeping min(old, new) bytes and zeroing what is new. NULL (block kept) when out of memory. */
void *memory_resize(void *block, size_t old_bytes, size_t new_bytes);

/* Bytes now allocated through this hook, and the most there have been. */
size_t memory_live_bytes(void);
size_t memory_peak_bytes(void);

/* Makes the allocation number `countdown` from now on (1 = the next) return NULL, and every later one too when
 * `sticky`. 0 turns failing off. For tests. */
void memory_fail_after(int64_t countdown, int sticky);

/* Allocations made so far (failed ones included): tests compare it before and after a step. */
uint64_t memory_allocation_count(void);

/* An arena hands out memory that lives until the arena is destroyed. */
typedef struct arena arena;

/* Creates an arena; `name` is kept by pointer and must be a string constant. NULL when out of memory. */
arena *arena_create(const char *name);
void arena_destroy(arena *a);

/* `bytes` zeroed bytes aligned to 64, or NULL. */
void *arena_allocate(arena *a, size_t bytes);

/* A copy of `text` in the arena, or NULL. */
char *arena_copy_string(arena *a, const char *text);

#endif
