/* Compressed chunks, made here instead of inside HDF5: any reader sees HDF5's ordinary shuffle and deflate filters, but
 * the strategy is ours to choose. On shuffled floating-point planes zlib's search for repeats finds none; run lengths
 * with Huffman codes give smaller output in a third of the time. Internal to this floor. */
#ifndef SUNDER_STORE_HDF_CHUNKS_H
#define SUNDER_STORE_HDF_CHUNKS_H

#include "store/hdf.h"

/* Rows of an array in one chunk (at least 1, at most count), or 0 when the array is too small to be worth compressing.
 */
int64_t hdf_chunk_rows(const hdf_array *array);

/* Writes the chunks of a dataset created with hdf_chunk_rows rows a chunk and the filters shuffle (unless elements are
 * single bytes) and deflate, in this order. `level` is 1–9. */
status hdf_write_chunks(hid_t set, const char *path, const hdf_array *array, int level, report *r);

#endif
