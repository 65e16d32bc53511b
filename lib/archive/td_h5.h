/* Internal: helpers for HDF5 files: silenced error output, reasons of failures, attributes, datasets of rows, closing
 * handles. */
#ifndef TD_H5_H
#define TD_H5_H

#include "tides/base.h"

#include <hdf5.h>

/* HDF5 prints its error stack by default. The switch for this is global to the process (in a thread-safe build, to the thread).
 * Each call of TIDES switches the printing off and restores it at its end, because the program may use HDF5 itself. The stack
 * can still be read. */
typedef struct td_h5_quiet {
    H5E_auto2_t function;
    void *data;
} td_h5_quiet;

void td_h5_quiet_begin(td_h5_quiet *saved);
void td_h5_quiet_end(const td_h5_quiet *saved);

/* The reason for the failure of the last HDF5 call, in HDF5's or the system's words. td_h5_reason_text must be called before
 * any other HDF5 function, which would clear the reason. */
typedef struct td_h5_reason {
    char text[400];
} td_h5_reason;
const char *td_h5_reason_text(td_h5_reason *reason);

/* Keeps a file's changed metadata in HDF5's cache until the next flush. So between flushes only new chunks reach the file,
 * and it stays readable if the process dies. The cache grows by a few kilobytes per million events. */
herr_t td_h5_forbid_evictions(hid_t file);

/* Attributes of a file, group or dataset.
 *
 * td_h5_write_text writes texts of fixed length, because HDF5 may crash on damaged texts of variable length. A text of more
 * than TD_H5_ATTRIBUTE_MAX bytes becomes a scalar dataset called `name`; td_h5_remove_text removes either.
 * td_h5_write_free_text writes a text of variable length, which Prophesee's readers need. td_h5_text and td_h5_read_text read
 * all three. td_h5_text returns the text, which the caller frees, or NULL.
 *
 * Functions that write or remove return a negative number on failure. td_h5_read_text and td_h5_read_int return 1, or 0 if
 * there is no such text or integer. */
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

/* Fails if the dataset needs the filters n-bit or scale-offset, which may overrun their buffers on damaged data. It also
 * fails if the plugin of a filter is missing (the error says how to get it), or if chunks exceed 1 GiB. */
tides_status td_h5_check_filters(const char *path, const char *name, hid_t dataset, tides_error *error);

/* Closes a handle of any type; negative ids are allowed. It preserves the error stack, which HDF5 would clear, so that
 * cleaning up doesn't lose the reason of a failure. */
void td_h5_close(hid_t id);

/* Creates a one-dimensional dataset that grows, in chunks of `chunk` rows, shuffled and deflated at level 1. For events this
 * is as small as Blosc, and needs no plugin. No times of creation are stored, so the same values give the same bytes.
 * Negative on failure. */
hid_t td_h5_create_rows(hid_t file, const char *name, hid_t type, hsize_t chunk);

/* Write or read the rows [first, first + count) of a one-dimensional dataset; `type` is the type of `values`. After
 * td_h5_append_rows the dataset ends with these rows. Negative on failure. */
herr_t td_h5_append_rows(hid_t dataset, hid_t type, uint64_t first, size_t count, const void *values);
herr_t td_h5_read_rows(hid_t dataset, hid_t type, uint64_t first, size_t count, void *values);

/* Packs a whole chunk of `count` integers of `size` bytes (1, 2, 4 or 8), as HDF5's shuffle and deflate filters would. The
 * result is smaller than that of td_h5_append_rows, and takes a quarter of its time. Returns the number of packed bytes; 0
 * on failure. `*packed` points to them within `scratch`, which has TD_H5_CHUNK_ROOM(bytes of the values) bytes. Any thread
 * may call it, because it calls no function of HDF5. */
size_t td_h5_pack_chunk(size_t size, size_t count, const void *values, void *scratch, unsigned char **packed);

/* Appends the rows [first, first + count), a whole chunk, to a dataset of td_h5_create_rows. `packed` and `length` are from
 * td_h5_pack_chunk; if `length` is 0, HDF5 packs the `values`. The dataset's type must be little-endian, and as wide as `type`.
 * Negative on failure. */
herr_t td_h5_append_chunk(hid_t dataset, hid_t type, uint64_t first, size_t count, const void *values,
                          const unsigned char *packed, size_t length);
/* Room for the shuffled values and, behind them, the packed ones. Deflate adds at most 5 bytes per 16 kB, and headers. */
#define TD_H5_CHUNK_ROOM(bytes) (2 * (bytes) + (bytes) / 64 + 1024)

/* Writes all values of a dataset of extent[0] x extent[1] values (extent[1] = 0: one dimension). Chunks have `rows` rows,
 * and are packed by td_h5_pack_chunk. `size`: bytes of a value. Negative on failure, also if memory is short. */
herr_t td_h5_write_chunks(hid_t dataset, const hsize_t extent[2], hsize_t rows, size_t size, const void *values);

#endif
