/* Internal: the HDF5 datasets of an event file that is being written, which grow chunk by chunk, and its index. */
#ifndef TD_EVENT_STORE_H
#define TD_EVENT_STORE_H

#include "td_event_h5.h"
#include "td_pool.h"

enum { TD_COLUMN_P, TD_COLUMN_T, TD_COLUMN_X, TD_COLUMN_Y, TD_COLUMN_NS, TD_COLUMNS };

/* Labels: columns beside the events, with bits TIDES_LABEL_*. A handle of -1: the column doesn't exist (yet). */
enum { TD_LABEL_CAUSE, TD_LABEL_FIRED, TD_LABEL_FRONTEND, TD_LABELS };

typedef struct td_event_labels {
    hid_t column[TD_LABELS];
} td_event_labels;

typedef struct td_event_store {
    hid_t file, columns[TD_COLUMNS], index, count, stop; /* count and stop are attributes */
    td_event_labels labels;
    int64_t offset;                   /* [us] t_offset: /events/t and ms_to_idx count from it */
    uint64_t rows;                    /* events in the datasets */
    uint64_t index_rows;              /* entries of ms_to_idx in its dataset */
    uint64_t next_ms;                 /* first millisecond without an entry */
    uint64_t pending[TD_INDEX_CHUNK]; /* entries that wait until they fill a chunk */
    size_t pending_count;
    void *scratch; /* the columns of a chunk, each with room to pack it: TD_EVENT_SCRATCH bytes */
    td_pool *pool; /* whose threads share the packing, during an append; NULL: the calling thread does all */
    int failed;    /* errno of the first failed write, which the file driver hides from HDF5; or 0 */
} td_event_store;

/* Bytes of an event in the columns: polarity, t, x, y, t_ns; and of a store's scratch. */
#define TD_EVENT_BYTES (size_t)(1 + 4 + 2 + 2 + 8)
#define TD_EVENT_SCRATCH \
    (TD_EVENT_CHUNK * TD_EVENT_BYTES + TD_H5_CHUNK_ROOM(TD_EVENT_CHUNK * TD_EVENT_BYTES) + TD_COLUMNS * TD_H5_CHUNK_ROOM(0))

/* Labels of a file. _reset marks all columns as not open, _create creates all in a new file, and _reopen opens those of an
 * unfinished file and cuts them to `rows`. _append adds those of `count` events at row `row`; with `fired` NULL events fired at
 * their own t, and `scratch` has room for a chunk of int64. */
void td_event_labels_reset(td_event_labels *labels);
herr_t td_event_labels_create(hid_t file, td_event_labels *labels);
herr_t td_event_labels_append(hid_t file, td_event_labels *labels, uint64_t row, const tides_event *events,
                              const int64_t *fired, size_t count, void *scratch);
herr_t td_event_labels_reopen(hid_t file, td_event_labels *labels, uint64_t rows);
void td_event_labels_close(td_event_labels *labels);

/* TIDES_LABEL_* bits of an open file. */
int32_t td_event_labels_of(hid_t file);

/* The path of a column, such as "/events/p". */
const char *td_event_column_name(int column);

/* The latest time after t_offset that /events/t can hold [ns]. */
#define TD_EVENT_SPAN (((int64_t)UINT32_MAX + 1) * 1000 - 1)

/* Computes `t` - `offset` [ns]; `offset` is in [us]. 1 if it isn't negative and /events/t can hold it. */
static inline int td_event_after(int64_t t, int64_t offset, int64_t *after) {
    const uint64_t gap = (uint64_t)t - (uint64_t)(1000 * offset); /* never overflows */
    if (t < 1000 * offset || gap > (uint64_t)TD_EVENT_SPAN) return 0;
    *after = (int64_t)gap;
    return 1;
}

/* Number of milliseconds, from `offset` [us] on, that begin at or before `t`. Their first events are known when an event at
 * `t` is known. td_event_after must accept `t`. */
static inline uint64_t td_milliseconds_begun(int64_t t, int64_t offset) {
    return (uint64_t)((t - 1000 * offset) / 1000000) + 1;
}

/* Makes a store with nothing open. */
void td_event_store_reset(td_event_store *store);

/* Fails if another process writes `path`, or if it can't be written; `create` creates it if it doesn't exist. */
tides_status td_event_store_claim(const char *path, int create, tides_error *error);

/* Creates (or replaces) `path` with empty datasets, all attributes and t_offset [us], and flushes it. On failure the file is
 * removed. */
tides_status td_event_store_create(td_event_store *store, const char *path, const tides_event_file *facts, int64_t offset,
                                   tides_error *error);

/* Reads t_offset [us] of a file; 0 if that fails (opening the file will report it). */
int64_t td_event_store_peek_offset(const char *path);

/* Changes t_offset, as long as there are no events. */
herr_t td_event_store_set_offset(td_event_store *store, int64_t offset);

/* Opens the unfinished file `path`, and cuts it back to its first `rows` events, a multiple of TD_EVENT_CHUNK, as if no more
 * had been appended. `facts` must fit the file; the run text in `facts` replaces the file's. If it fails before the cut, the
 * file is unchanged. */
tides_status td_event_store_reopen(td_event_store *store, const char *path, const tides_event_file *facts, uint64_t rows,
                                   tides_error *error);

/* Claims `bytes` behind the end of the file. 0, or the system's error: no space, quota, file size limit. File systems that
 * can't claim space report 0. */
int td_event_claim_space(hid_t file, uint64_t bytes);

/* The number of rows of a dataset with chunks of `chunk` rows, -1 if it is another kind. td_event_cut_rows cuts it to `rows`,
 * and removes stray chunks beyond. */
hssize_t td_event_rows_of(hid_t dataset, hsize_t chunk);
herr_t td_event_cut_rows(hid_t dataset, hsize_t rows, hsize_t chunk);

/* Adds index entries for the milliseconds without one that begin at or before `t`: they start at event `row`, which is at
 * `t`. td_event_after must accept `t`. */
herr_t td_event_store_index(td_event_store *store, int64_t t, uint64_t row);

/* Writes `count` <= TD_EVENT_CHUNK checked events, which fired at `fired` (NULL: their own t), and flushes, so that they
 * survive the death of the process. On failure the error's text is only the reason, and events flushed before stay readable. */
tides_status td_event_store_append(td_event_store *store, const tides_event *events, const int64_t *fired, size_t count,
                                   tides_error *error);

/* Fills ms_to_idx up to `entries` (at least as many as exist), sets the end, flushes. */
tides_status td_event_store_complete(td_event_store *store, uint64_t entries, int64_t stop_ns, tides_error *error);

/* Waits until all flushed data is on the disk; 0 or errno. */
int td_event_store_sync(const td_event_store *store);

/* Closes everything and frees the scratch. It fails if any write to the file failed; the error's text is only the reason.
 * td_event_store_drop is for use after an earlier failure: it reports nothing. */
tides_status td_event_store_close(td_event_store *store, tides_error *error);
void td_event_store_drop(td_event_store *store);

/* Writes the tail of an unfinished file: events [first, first + count) after its last whole chunk, and, with labels, when
 * they fired. It is a file of its own, written beside and renamed. */
tides_status td_event_tail_write(const char *path, const tides_event_file *facts, int64_t offset, uint64_t first,
                                 const tides_event *events, const int64_t *fired, size_t count, tides_error *error);

/* Reads `count` events and (if not NULL) when they fired. The tail must begin at number `first`; TIDES_BAD_FILE if it begins
 * elsewhere or holds fewer. */
tides_status td_event_tail_read(const char *path, uint64_t first, tides_event *events, int64_t *fired, size_t count,
                                tides_error *error);

#endif
