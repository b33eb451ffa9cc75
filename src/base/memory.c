#include "base/memory.h"

#include <assert.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

static _Atomic size_t live_bytes, peak_bytes;
static _Atomic uint64_t allocation_count;
static _Atomic int64_t fail_countdown;
static _Atomic int fail_sticky;

static int must_fail(void) {
    if (atomic_load_explicit(&fail_countdown, memory_order_relaxed) <= 0) return 0;
    int64_t left = atomic_fetch_sub(&fail_countdown, 1) - 1;
    if (left > 0) return 0;
    if (left < 0) return 0;
    if (atomic_load(&fail_sticky)) atomic_store(&fail_countdown, 1);
    return 1;
}

static size_t rounded(size_t bytes) {
    size_t units = (bytes + MEMORY_ALIGNMENT - 1) / MEMORY_ALIGNMENT;
    return (units ? units : 1) * MEMORY_ALIGNMENT;
}

enum { HUGE_PAGE = 2 << 20 };

/* Large arrays lie in huge pages where the system has them: a block's particles are a stretch of each of some 30 arrays, and every pass would
 * miss the address tables of small pages. Only whole huge pages are asked for, so that none is filled in vain. */
static void *allocate_aligned(size_t bytes) {
    if (bytes < HUGE_PAGE || bytes > SIZE_MAX - HUGE_PAGE) return aligned_alloc(MEMORY_ALIGNMENT, bytes);
    void *block = aligned_alloc(HUGE_PAGE, (bytes + HUGE_PAGE - 1) / HUGE_PAGE * HUGE_PAGE);
#ifdef MADV_HUGEPAGE
    if (block) (void)madvise(block, bytes / HUGE_PAGE * HUGE_PAGE, MADV_HUGEPAGE); /* a hint: small pages do as well */
#endif
    return block;
}

void *memory_allocate(size_t bytes) {
    atomic_fetch_add(&allocation_count, 1);
    if (must_fail() || bytes > SIZE_MAX - MEMORY_ALIGNMENT) return NULL;
    void *block = allocate_aligned(rounded(bytes));
    if (!block) return NULL;
    memset(block, 0, rounded(bytes));
    size_t now = atomic_fetch_add(&live_bytes, bytes) + bytes;
    size_t peak = atomic_load(&peak_bytes);
    while (now > peak && !atomic_compare_exchange_weak(&peak_bytes, &peak, now)) {}
    return block;
}

void *memory_allocate_array(size_t count, size_t size) {
    if (size != 0 && count > SIZE_MAX / size) return NULL;
    return memory_allocate(count * size);
}

void memory_free(void *block, size_t bytes) {
    if (!block) return;
    assert(atomic_load(&live_bytes) >= bytes);
    atomic_fetch_sub(&live_bytes, bytes);
    free(block);
}

void *memory_resize(void *block, size_t old_bytes, size_t new_bytes) {
    void *fresh = memory_allocate(new_bytes);
    if (!fresh) return NULL;
    if (block) memcpy(fresh, block, old_bytes < new_bytes ? old_bytes : new_bytes);
    memory_free(block, old_bytes);
    return fresh;
}

size_t memory_live_bytes(void) {
    return atomic_load(&live_bytes);
}

size_t memory_peak_bytes(void) {
    return atomic_load(&peak_bytes);
}

void memory_fail_after(int64_t countdown, int sticky) {
    atomic_store(&fail_sticky, sticky);
    atomic_store(&fail_countdown, countdown);
}

uint64_t memory_allocation_count(void) {
    return atomic_load(&allocation_count);
}

/* ---- arenas ------------------------------------------------------------------------------------------------------ */

enum { ARENA_CHUNK = 64 * 1024 };

typedef struct arena_chunk {
    struct arena_chunk *next;
    size_t size, used; /* bytes, this header included */
} arena_chunk;

struct arena {
    const char *name;
    arena_chunk *chunks;
};

arena *arena_create(const char *name) {
    arena *a = memory_allocate(sizeof *a);
    if (a) a->name = name;
    return a;
}

void arena_destroy(arena *a) {
    if (!a) return;
    for (arena_chunk *chunk = a->chunks; chunk;) {
        arena_chunk *next = chunk->next;
        memory_free(chunk, chunk->size);
        chunk = next;
    }
    memory_free(a, sizeof *a);
}

void *arena_allocate(arena *a, size_t bytes) {
    if (bytes > SIZE_MAX / 2) return NULL;
    size_t need = rounded(bytes), header = rounded(sizeof(arena_chunk));
    if (!a->chunks || a->chunks->size - a->chunks->used < need) {
        size_t size = need + header > ARENA_CHUNK ? need + header : (size_t)ARENA_CHUNK;
        arena_chunk *chunk = memory_allocate(size);
        if (!chunk) return NULL;
        *chunk = (arena_chunk){.next = a->chunks, .size = size, .used = header};
        a->chunks = chunk;
    }
    void *block = (char *)a->chunks + a->chunks->used;
    a->chunks->used += need;
    return block;
}

char *arena_copy_string(arena *a, const char *text) {
    size_t size = strlen(text) + 1;
    char *copy = arena_allocate(a, size);
    if (copy) memcpy(copy, text, size);
    return copy;
}
