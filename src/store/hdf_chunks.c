#include "store/hdf_chunks.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>
#include <zlib.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
               "chunks are written in memory's byte order, which the file says is little");

enum {
    WORTHWHILE = 1 << 14, /* bytes: below, a chunk index costs what compression saves */
    CHUNK_BYTES = 1 << 17,
    SAMPLE_BYTES = 1 << 13,
    SAMPLES = 2048, /* bytes of a plane that are counted */
};
static const double NOISE_BITS = 7;

/* One chunk on its way to the file. `block` is one allocation that holds the three buffers. */
typedef struct packer {
    char *block;
    size_t block_bytes, chunk_bytes;
    const char *raw;       /* [chunk_bytes] as the caller has it, or a padded copy of the last rows */
    char *padded;          /* [chunk_bytes] */
    unsigned char *mixed;  /* [chunk_bytes] shuffled */
    unsigned char *packed; /* [chunk_bytes]: what does not fit is not worth packing */
    size_t element;        /* bytes of one element */
    int level, strategy;   /* of the whole array */
    bool by_plane;         /* each plane's worth is looked at */
    z_stream stream;
} packer;

static size_t row_bytes(const hdf_array *array) {
    return record_type_size(array->type) * (size_t)array->components;
}

int64_t hdf_chunk_rows(const hdf_array *array) {
    size_t row = row_bytes(array), count = (size_t)array->count;
    if (row == 0 || count == 0 || row * count < WORTHWHILE) return 0;
    size_t rows = row < CHUNK_BYTES ? CHUNK_BYTES / row : 1;
    return (int64_t)(rows < count ? rows : count);
}

/* HDF5's shuffle: byte k of every element goes to plane k. */
static void shuffle(unsigned char *to, const char *from, size_t elements, size_t element) {
    for (size_t k = 0; k < element; k++) {
        unsigned char *plane = to + k * elements;
        for (size_t i = 0; i < elements; i++) plane[i] = (unsigned char)from[i * element + k];
    }
}

/* Whether Huffman's code would save less than an eighth: a plane of low digits is nearly noise, and coding it takes most of the time for next to nothing. */
static bool is_noise(const unsigned char *plane, size_t bytes) {
    int count[256] = {0}, taken = 0;
    for (size_t i = 0; i < bytes; i += bytes / SAMPLES + 1, taken++) count[plane[i]]++;
    double bits = 0;
    for (int b = 0; b < 256; b++)
        if (count[b]) bits -= count[b] * log2((double)count[b] / taken);
    return taken >= SAMPLES / 2 && bits > NOISE_BITS * taken;
}

/* Deflates `bytes` shuffled bytes, planes of noise as they are; 0 when the result would not fit (it is no smaller than what went in). */
static size_t pack(packer *p, size_t bytes) {
    deflateReset(&p->stream);
    p->stream.next_in = p->mixed;
    p->stream.avail_in = 0;
    p->stream.next_out = p->packed;
    p->stream.avail_out = (uInt)bytes;
    int planes = p->by_plane ? (int)p->element : 1, state = Z_OK;
    for (int k = 0; k < planes && state == Z_OK; k++) {
        size_t plane = bytes / (size_t)planes;
        int level = planes > 1 && is_noise(p->mixed + plane * (size_t)k, plane) ? 0 : p->level;
        state = deflateParams(&p->stream, level, p->strategy); /* what has been put in so far is packed as it was to be */
        p->stream.avail_in = (uInt)plane;
        if (state == Z_OK) state = deflate(&p->stream, k + 1 < planes ? Z_NO_FLUSH : Z_FINISH);
    }
    return state == Z_STREAM_END ? p->stream.total_out : 0;
}

/* Tries both strategies on a piece from the middle of the array and keeps the one that packs it better. */
static void choose_strategy(packer *p, const hdf_array *array) {
    size_t total = row_bytes(array) * (size_t)array->count;
    size_t bytes = (size_t)SAMPLE_BYTES < p->chunk_bytes ? (size_t)SAMPLE_BYTES : p->chunk_bytes;
    bytes -= bytes % p->element;
    size_t start = (total - bytes) / 2;
    shuffle(p->mixed, (const char *)array->data + start - start % p->element, bytes / p->element, p->element);
    p->strategy = Z_DEFAULT_STRATEGY;
    size_t searched = pack(p, bytes);
    p->strategy = Z_RLE;
    size_t runs = pack(p, bytes);
    bool repeats = searched > 0 && (runs == 0 || searched < runs - runs / 8);
    if (repeats) p->strategy = Z_DEFAULT_STRATEGY;
    else p->by_plane = p->element > 1;
}

static status packer_begin(packer *p, const char *path, const hdf_array *array, int level, report *r) {
    *p = (packer){.element = record_type_size(array->type), .level = level};
    p->chunk_bytes = (size_t)hdf_chunk_rows(array) * row_bytes(array);
    p->block_bytes = 3 * p->chunk_bytes;
    p->block = memory_allocate(p->block_bytes);
    if (p->block && deflateInit(&p->stream, level) == Z_OK) {
        p->padded = p->block;
        p->mixed = (unsigned char *)p->block + p->chunk_bytes;
        p->packed = (unsigned char *)p->block + 2 * p->chunk_bytes;
        choose_strategy(p, array);
        return STATUS_OK;
    }
    memory_free(p->block, p->block_bytes);
    return report_set(r, STATUS_SYSTEM, "%s: out of memory to compress '%s'", path, array->name);
}

static void packer_end(packer *p) {
    deflateEnd(&p->stream);
    memory_free(p->block, p->block_bytes);
}

/* Writes the chunk in p->raw: packed, or as it is (both filters masked out) when packing gains nothing. */
static herr_t write_chunk(packer *p, hid_t set, int64_t first_row) {
    hsize_t offset[2] = {(hsize_t)first_row, 0};
    shuffle(p->mixed, p->raw, p->chunk_bytes / p->element, p->element);
    size_t packed = pack(p, p->chunk_bytes);
    if (packed > 0) return H5Dwrite_chunk(set, H5P_DEFAULT, 0, offset, packed, p->packed);
    uint32_t all_filters = p->element > 1 ? 3 : 1;
    return H5Dwrite_chunk(set, H5P_DEFAULT, all_filters, offset, p->chunk_bytes, p->raw);
}

status hdf_write_chunks(hid_t set, const char *path, const hdf_array *array, int level, report *r) {
    packer p;
    status s = packer_begin(&p, path, array, level, r);
    if (s) return s;
    int64_t rows = hdf_chunk_rows(array);
    size_t row = row_bytes(array);
    for (int64_t first = 0; first < array->count && !s; first += rows) {
        int64_t left = array->count - first;
        p.raw = (const char *)array->data + (size_t)first * row;
        if (left < rows) { /* HDF5 stores the last chunk whole */
            memset(p.padded, 0, p.chunk_bytes);
            memcpy(p.padded, p.raw, (size_t)left * row);
            p.raw = p.padded;
        }
        if (write_chunk(&p, set, first) < 0) s = hdf_fail(r, path, "write a chunk");
    }
    packer_end(&p);
    return s;
}
