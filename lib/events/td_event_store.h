/* Internal: the HDF5 side of an event file being written: its datasets, grown chunk by chunk, and its index. */
#ifndef TD_EVENT_STORE_H
#define TD_EVENT_STORE_H

#include "td_event_h5.h"

enum { TD_COLUMN_P, TD_COLUMN_T, TD_COLUMN_X, TD_COLUMN_Y, TD_COLUMN_NS, TD_COLUMNS };

/* Columns beside the events (event_labels.c): their bits are TIDES_LABEL_*. -1: not there, or not yet. */
enum { TD_LABEL_CAUSE, TD_LABEL_FIRED, TD_LABEL_FRONTEND, TD_LABELS };

typedef struct td_event_labels {
    hid_t column[TD_LABELS];
} td_event_labels;

typedef struct td_event_store {
    hid_t file, columns[TD_COLUMNS], index, count, stop; /* the last two are attributes */
    td_event_labels labels;
    int64_t offset;                   /* [us] t_offset: what /events/t and ms_to_idx count from */
    uint64_t rows;                    /* events in the datasets */
    uint64_t index_rows;              /* entries of ms_to_idx in its dataset */
    uint64_t next_ms;                 /* first millisecond without an entry, written or pending */
    uint64_t pending[TD_INDEX_CHUNK]; /* entries that wait for their chunk to fill */
    size_t pending_count;
    void *scratch; /* one column of one chunk, and what packs it: TD_EVENT_SCRATCH bytes */
    int failed;    /* errno of the first write that failed, or 0: HDF5 doesn't see it (archive/td_h5_driver.h) */
} td_event_store;

/* Bytes of a store's scratch. */
#define TD_EVENT_SCRATCH (TD_EVENT_CHUNK * sizeof(int64_t) + TD_H5_CHUNK_ROOM(TD_EVENT_CHUNK * sizeof(int64_t)))

/* Nothing open; all of them in a new file; the labels of `count` events at `row` (`fired` NULL: at their t), where `scratch`
 * holds a chunk of int64; those of an unfinished file, cut to `rows`. */
void td_event_labels_reset(td_event_labels *labels);
herr_t td_event_labels_create(hid_t file, td_event_labels *labels);
herr_t td_event_labels_append(hid_t file, td_event_labels *labels, uint64_t row, const tides_event *events,
                              const int64_t *fired, size_t count, void *scratch);
herr_t td_event_labels_reopen(hid_t file, td_event_labels *labels, uint64_t rows);
void td_event_labels_close(td_event_labels *labels);

/* TIDES_LABEL_* of an open file. */
int32_t td_event_labels_of(hid_t file);

/* "/events/p" ... */
const char *td_event_column_name(int column);

/* The latest time after t_offset that /events/t can hold [ns]. */
#define TD_EVENT_SPAN (((int64_t)UINT32_MAX + 1) * 1000 - 1)

/* [ns] of `t` after `offset` [us]; 1 where it is there and /events/t can hold it. */
static inline int td_event_after(int64_t t, int64_t offset, int64_t *after) {
    const uint64_t gap = (uint64_t)t - (uint64_t)(1000 * offset); /* of any two times */
    if (t < 1000 * offset || gap > (uint64_t)TD_EVENT_SPAN) return 0;
    *after = (int64_t)gap;
    return 1;
}

/* Milliseconds of the index, from `offset` [us] on, that begin at or before `t`: those whose first event is known once an event
 * at `t`, which td_event_after takes, is. */
static inline uint64_t td_milliseconds_begun(int64_t t, int64_t offset) {
    return (uint64_t)((t - 1000 * offset) / 1000000) + 1;
}

/* A store with nothing open. */
void td_event_store_reset(td_event_store *store);

/* Fails where another process writes `path`, or it can't be written; `create` makes it where it isn't there. */
tides_status td_event_store_claim(const char *path, int create, tides_error *error);

/* Creates `path` (replacing it) with empty datasets, all attributes and t_offset [us], and flushes it. On failure neither store
 * nor file is left. */
tides_status td_event_store_create(td_event_store *store, const char *path, const tides_event_file *facts, int64_t offset,
                                   tides_error *error);

/* The t_offset [us] of a file; 0 where it can't be read, which opening it will say. */
int64_t td_event_store_peek_offset(const char *path);

/* Another t_offset, as long as there are no events. */
herr_t td_event_store_set_offset(td_event_store *store, int64_t offset);

/* Opens the unfinished file `path` and cuts it back to its first `rows` events, a multiple of TD_EVENT_CHUNK, as if no more had
 * ever been appended (event_reopen.c). `facts` must fit the file; its run text replaces the file's. Before that cut begins, a
 * failure leaves the file as it was. */
tides_status td_event_store_reopen(td_event_store *store, const char *path, const tides_event_file *facts, uint64_t rows,
                                   tides_error *error);

/* Claims `bytes` behind the end of the file. 0, or the system's error: no space, quota, file size limit. File systems that
 * can't claim are taken at their word. */
int td_event_claim_space(hid_t file, uint64_t bytes);

/* event_cut.c: rows of a dataset of chunks of `chunk` rows, -1 where it is no such; and the dataset cut back to `rows`, with
 * all that lies beyond. */
hssize_t td_event_rows_of(hid_t dataset, hsize_t chunk);
herr_t td_event_cut_rows(hid_t dataset, hsize_t rows, hsize_t chunk);

/* Milliseconds that have no entry yet and begin at or before `t`, which td_event_after takes, start at event `row`, which is at
 * `t`. */
herr_t td_event_store_index(td_event_store *store, int64_t t, uint64_t row);

/* Writes `count` <= TD_EVENT_CHUNK checked events, which fired when `fired` says (NULL: at their t), and makes them durable
 * against the death of the process. On failure the error's text is the bare reason, and what was flushed before stays readable.
 */
tides_status td_event_store_append(td_event_store *store, const tides_event *events, const int64_t *fired, size_t count,
                                   tides_error *error);

/* Completes ms_to_idx to `entries` entries (never fewer than there are), notes the end, flushes. */
tides_status td_event_store_complete(td_event_store *store, uint64_t entries, int64_t stop_ns, tides_error *error);

/* Waits until what was flushed is on the disk; 0 or errno. */
int td_event_store_sync(const td_event_store *store);

/* Closes all that is open and frees the scratch; fails where anything of the file couldn't be written, the error's text is the
 * bare reason. _drop: without an error, where an earlier failure is reported, or the result isn't used. */
tides_status td_event_store_close(td_event_store *store, tides_error *error);
void td_event_store_drop(td_event_store *store);

/* The events after an unfinished file's last whole chunk, kept in a file of their own (event_tail.c): events [first, first +
 * count), and with labels when they fired. Written beside and renamed. */
tides_status td_event_tail_write(const char *path, const tides_event_file *facts, int64_t offset, uint64_t first,
                                 const tides_event *events, const int64_t *fired, size_t count, tides_error *error);

/* Reads `count` events and when they fired (NULL: not asked) from number `first` on, which must be where the tail begins;
 * TIDES_BAD_FILE where it begins elsewhere or holds fewer. */
tides_status td_event_tail_read(const char *path, uint64_t first, tides_event *events, int64_t *fired, size_t count,
                                tides_error *error);

#endif
