/* Internal: helpers for HDF5 files: silenced error output, reasons of failures, attributes, datasets of rows, closing
 * handles. */
#ifndef TD_H5_H
#define TD_H5_H

#include "tides/base.h"

#include <hdf5.h>

/* HDF5 prints its error stack by default, and the setting is the process's (or thread's). It is switched off during one call
 * of ours and then restored, because the program around us may use HDF5, too. The stack can still be read. */
typedef struct td_h5_quiet {
    H5E_auto2_t function;
    void *data;
} td_h5_quiet;

void td_h5_quiet_begin(td_h5_quiet *saved);
void td_h5_quiet_end(const td_h5_quiet *saved);

/* Why the last HDF5 call failed, in HDF5's or the system's words. Ask before any other HDF5 call, which would clear it. */
typedef struct td_h5_reason {
    char text[400];
} td_h5_reason;
const char *td_h5_reason_text(td_h5_reason *reason);

/* Keeps metadata of a file being written in the cache until we flush. The cache grows by a few kilobytes per million events. */
herr_t td_h5_forbid_evictions(hid_t file);

/* Attributes of a file, group or dataset. Texts have fixed length: HDF5 may crash on damaged ones of variable length. Only
 * _free_text writes these, because Prophesee's readers need them. A text too long for an attribute becomes a scalar dataset
 * of this name. Negative on failure. Readers return 1, or 0 if the attribute is absent or of another kind. td_h5_text returns
 * the text, which the caller frees, or NULL. */
enum {
    TD_H5_ATTRIBUTE_MAX = 60000, /* bytes: a message in an object header has 65 535 at most */
    TD_H5_TEXT_MAX = 1 << 24     /* longest text that is read: a damaged file can't exhaust the memory */
};
herr_t td_h5_write_text(hid_t file, const char *name, const char *text);
herr_t td_h5_write_free_text(hid_t file, const char *name, const char *text);
herr_t td_h5_remove_text(hid_t file, const char *name);
char *td_h5_text(hid_t file, const char *name);
herr_t td_h5_write_number(hid_t file, const char *name, hid_t file_type, hid_t memory_type, const void *value);
herr_t td_h5_write_int(hid_t file, const char *name, hid_t type, int64_t value);
int td_h5_read_text(hid_t file, const char *name, char *text, size_t size);
int td_h5_read_int(hid_t file, const char *name, int64_t *value);

/* Fails if the dataset needs a filter that is unsafe, or whose plugin is missing (the error says how to get it), or if its
 * chunks exceed 1 GiB. */
tides_status td_h5_check_filters(const char *path, const char *name, hid_t dataset, tides_error *error);

/* Closes a handle of any type; negative ids are allowed. It preserves the error stack, which HDF5 would clear, so that
 * cleaning up doesn't lose the reason of a failure. */
void td_h5_close(hid_t id);

/* Makes a one-dimensional dataset that grows: chunks of `chunk` rows, shuffled and deflated at level 1. On events that is as
 * small as Blosc, and needs no plugin. No times of creation are stored, so the same values give the same bytes. Negative on
 * failure. */
hid_t td_h5_create_rows(hid_t file, const char *name, hid_t type, hsize_t chunk);

/* Reads or writes rows [first, first + count) of a one-dimensional dataset; `type` is the type of `values`. td_h5_append_rows
 * makes the dataset end with these rows. */
herr_t td_h5_append_rows(hid_t dataset, hid_t type, uint64_t first, size_t count, const void *values);
herr_t td_h5_read_rows(hid_t dataset, hid_t type, uint64_t first, size_t count, void *values);

/* Packs a whole chunk of `count` integers of `size` bytes, smaller and in a quarter of the time of td_h5_append_rows. Returns
 * the number of bytes and where they are in `scratch`, which has TD_H5_CHUNK_ROOM(bytes of the values) bytes; 0 on failure. Any
 * thread may call it: HDF5 isn't. */
size_t td_h5_pack_chunk(size_t size, size_t count, const void *values, void *scratch, unsigned char **packed);

/* Appends a chunk that was packed to `length` bytes, or, if that is 0, the values. The dataset is from td_h5_create_rows, with
 * `type`'s size, little-endian. */
herr_t td_h5_append_chunk(hid_t dataset, hid_t type, uint64_t first, size_t count, const void *values,
                          const unsigned char *packed, size_t length);
#define TD_H5_CHUNK_ROOM(bytes) (2 * (bytes) + (bytes) / 64 + 1024) /* deflate adds at most 5 bytes per 16 kB, and a few */

/* Writes all values of a dataset in such chunks of `rows` rows, packed the same way. `extent[1]` = 0: one dimension. `size`:
 * bytes of a value. Negative on failure, also if memory is short. */
herr_t td_h5_write_chunks(hid_t dataset, const hsize_t extent[2], hsize_t rows, size_t size, const void *values);

#endif
