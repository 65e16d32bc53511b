/* Internal: HDF5 for everyone who reads or writes files of it: without noise, with reasons, and with every handle closed.
 * Groups with messages that say where are td_h5_place.h's; how files are opened is td_h5_driver.h's. */
#ifndef TD_H5_H
#define TD_H5_H

#include "tides/base.h"

#include <hdf5.h>

/* HDF5 prints its error stack unless told otherwise, and the setting is the process's (or thread's): it is switched off for the
 * length of one call of ours and put back, because the program around us may use HDF5 too. The stack itself stays readable. */
typedef struct td_h5_quiet {
    H5E_auto2_t function;
    void *data;
} td_h5_quiet;

void td_h5_quiet_begin(td_h5_quiet *saved);
void td_h5_quiet_end(const td_h5_quiet *saved);

/* Why the last HDF5 call failed, in HDF5's or the system's own words; to be asked before any other HDF5 call. */
typedef struct td_h5_reason {
    char text[400];
} td_h5_reason;
const char *td_h5_reason_text(td_h5_reason *reason);

/* Metadata of a file being written may leave the cache only when we flush. Its growth is a few kilobytes per million events. */
herr_t td_h5_forbid_evictions(hid_t file);

/* Attributes of a file, group or dataset. Texts are written with fixed length, because damage to one of variable length is
 * what HDF5 can't stand (td_h5_text.h); one that is too long for an attribute becomes a scalar dataset of the same name.
 * Prophesee's readers want variable length: _free_text. All return negative on failure; readers return 0 where the attribute
 * is absent (or of another kind) and 1 where it was read; td_h5_text NULL, or the text, freed by the caller. */
enum {
    TD_H5_ATTRIBUTE_MAX = 60000, /* bytes: an object header's message ends at 65 535 */
    TD_H5_TEXT_MAX = 1 << 24     /* no text in a file is longer; guards the memory that a damaged one could ask for */
};
herr_t td_h5_write_text(hid_t file, const char *name, const char *text);
herr_t td_h5_write_free_text(hid_t file, const char *name, const char *text);
herr_t td_h5_remove_text(hid_t file, const char *name);
char *td_h5_text(hid_t file, const char *name);
herr_t td_h5_write_number(hid_t file, const char *name, hid_t file_type, hid_t memory_type, const void *value);
herr_t td_h5_write_int(hid_t file, const char *name, hid_t type, int64_t value);
int td_h5_read_text(hid_t file, const char *name, char *text, size_t size);
int td_h5_read_int(hid_t file, const char *name, int64_t *value);

/* Fails where the dataset needs a filter whose plugin is missing (the error names the remedy) or that isn't to be trusted, or
 * has chunks of more than a GiB. */
tides_status td_h5_check_filters(const char *path, const char *name, hid_t dataset, tides_error *error);

/* Closes a dataset, attribute, space, type ... by what it is; negative ids are fine. Keeps the error stack, which HDF5 would
 * clear, so that cleaning up doesn't lose the reason. */
void td_h5_close(hid_t id);

/* Datasets of one dimension that grow: in chunks of `chunk` rows, shuffled and deflated at level 1, which is as small as Blosc
 * here and needs no plugin. Without the times of creation, the same values make the same bytes. Negative on failure. */
hid_t td_h5_create_rows(hid_t file, const char *name, hid_t type, hsize_t chunk);

/* Rows [first, first + count) of a dataset of one dimension, whose values are of `type` in memory. _append makes the dataset
 * end with them. */
herr_t td_h5_append_rows(hid_t dataset, hid_t type, uint64_t first, size_t count, const void *values);
herr_t td_h5_read_rows(hid_t dataset, hid_t type, uint64_t first, size_t count, void *values);

/* _append_rows, of whole chunks of a dataset of integers that td_h5_create_rows has made with `type`'s size and the lowest byte
 * first: packed smaller in a quarter of the time (h5_chunk.c). `scratch` has TD_H5_CHUNK_ROOM of the values' bytes. */
herr_t td_h5_append_chunk(hid_t dataset, hid_t type, uint64_t first, size_t count, const void *values, void *scratch);
#define TD_H5_CHUNK_ROOM(bytes) (2 * (bytes) + (bytes) / 64 + 1024) /* deflate may add 5 bytes per 16 kB, and a few */

/* All values of a dataset, packed in the same way: of `extent` (the second 0: one dimension), of `size` bytes each, in chunks
 * of `rows` whole rows, shuffled and deflated. Negative where there was no memory, too. */
herr_t td_h5_write_chunks(hid_t dataset, const hsize_t extent[2], hsize_t rows, size_t size, const void *values);

#endif
