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
    MEMORY_LEVEL = 8,    /* zlib's default */
    STORED_MOST = 65535, /* bytes of one of deflate's stored blocks */
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
    size_t used, room;     /* bytes of `packed` */
    size_t element;        /* bytes of one element */
    int level;
    bool by_plane;         /* each plane's worth is looked at */
    z_stream stream;       /* deflate's own format, without zlib's head and sum */
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

/* Appends to what is packed; false when there is no room. */
static bool put(packer *p, const void *bytes, size_t count) {
    if (count > p->room - p->used) return false;
    memcpy(p->packed + p->used, bytes, count);
    p->used += count;
    return true;
}

/* Appends bytes as they are, in deflate's stored blocks (RFC 1951, 3.2.4). What is before ends with a whole byte. */
static bool store(packer *p, const unsigned char *from, size_t count, bool last) {
    while (count > 0) {
        unsigned size = (unsigned)(count < STORED_MOST ? count : STORED_MOST), other = ~size;
        const unsigned char head[5] = {last && size == count, (unsigned char)size, (unsigned char)(size >> 8), (unsigned char)other,
                                       (unsigned char)(other >> 8)};
        if (!put(p, head, sizeof head) || !put(p, from, size)) return false;
        from += size, count -= size;
    }
    return true;
}

/* Appends bytes deflated. They are searched for repeats of each other alone: deflate does not know of blocks that were stored without it. */
static bool squeeze(packer *p, unsigned char *from, size_t count, bool last) {
    z_stream *z = &p->stream;
    if (deflateReset(z) != Z_OK) return false;
    z->next_in = from;
    z->avail_in = (uInt)count;
    z->next_out = p->packed + p->used;
    z->avail_out = (uInt)(p->room - p->used);
    int state = deflate(z, last ? Z_FINISH : Z_SYNC_FLUSH);
    p->used = p->room - z->avail_out;
    return last ? state == Z_STREAM_END : state == Z_OK && z->avail_out > 0;
}

/* Makes a zlib stream (RFC 1950) of `bytes` shuffled bytes, planes of noise as they are; 0 when it would be no smaller than what went in. */
static size_t pack(packer *p, size_t bytes) {
    static const unsigned char head[2] = {0x78, 0x01};
    size_t planes = p->by_plane ? p->element : 1, plane = bytes / planes;
    bool noise[sizeof(int64_t)] = {false}, fits;
    for (size_t k = 0; k < planes && planes > 1; k++) noise[k] = is_noise(p->mixed + plane * k, plane);
    p->used = 0;
    p->room = bytes;
    fits = put(p, head, sizeof head);
    for (size_t k = 0, end; k < planes && fits; k = end) {
        for (end = k + 1; end < planes && noise[end] == noise[k];) end++;
        unsigned char *from = p->mixed + plane * k;
        fits = noise[k] ? store(p, from, plane * (end - k), end == planes) : squeeze(p, from, plane * (end - k), end == planes);
    }
    uint32_t sum = fits ? (uint32_t)adler32(1, p->mixed, (uInt)bytes) : 0;
    const unsigned char tail[4] = {(unsigned char)(sum >> 24), (unsigned char)(sum >> 16), (unsigned char)(sum >> 8), (unsigned char)sum};
    return fits && put(p, tail, sizeof tail) ? p->used : 0;
}

static bool set_strategy(packer *p, int strategy, bool by_plane) {
    p->by_plane = by_plane;
    bool fresh = deflateReset(&p->stream) == Z_OK;
    p->stream.avail_in = 0;
    p->stream.next_out = p->packed; /* older versions of zlib ask for room, though there is nothing to write */
    p->stream.avail_out = (uInt)p->chunk_bytes;
    return fresh && deflateParams(&p->stream, p->level, strategy) == Z_OK;
}

/* What the first `bytes` shuffled bytes come to. */
static size_t try_strategy(packer *p, int strategy, bool by_plane, size_t bytes) {
    size_t packed = set_strategy(p, strategy, by_plane) ? pack(p, bytes) : 0;
    return packed > 0 ? packed : bytes;
}

/* Tries a piece from the middle of the array. Where a search for repeats finds next to none, only runs and frequencies of single bytes are looked for;
 * where it finds most of the array, it gets all of it, and else what is not noise: searching that takes most of the time for next to nothing. */
static bool choose_strategy(packer *p, const hdf_array *array) {
    size_t total = row_bytes(array) * (size_t)array->count;
    size_t bytes = (size_t)SAMPLE_BYTES < p->chunk_bytes ? (size_t)SAMPLE_BYTES : p->chunk_bytes;
    bytes -= bytes % p->element;
    size_t start = (total - bytes) / 2;
    shuffle(p->mixed, (const char *)array->data + start - start % p->element, bytes / p->element, p->element);
    size_t searched = try_strategy(p, Z_DEFAULT_STRATEGY, false, bytes), runs = try_strategy(p, Z_RLE, p->element > 1, bytes);
    return set_strategy(p, searched < runs - runs / 8 ? Z_DEFAULT_STRATEGY : Z_RLE, p->element > 1 && searched >= runs / 2);
}

static status packer_begin(packer *p, const char *path, const hdf_array *array, int level, report *r) {
    *p = (packer){.element = record_type_size(array->type), .level = level};
    p->chunk_bytes = (size_t)hdf_chunk_rows(array) * row_bytes(array);
    p->block_bytes = 3 * p->chunk_bytes;
    p->block = memory_allocate(p->block_bytes);
    if (p->block && deflateInit2(&p->stream, level, Z_DEFLATED, -MAX_WBITS, MEMORY_LEVEL, Z_DEFAULT_STRATEGY) == Z_OK) {
        p->padded = p->block;
        p->mixed = (unsigned char *)p->block + p->chunk_bytes;
        p->packed = (unsigned char *)p->block + 2 * p->chunk_bytes;
        if (choose_strategy(p, array)) return STATUS_OK;
        deflateEnd(&p->stream);
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
