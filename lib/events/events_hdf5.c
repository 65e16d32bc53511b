/* Writes event files: HDF5 in the layout of DSEC (https://dsec.ifi.uzh.ch/data-format), which most readers of event data know.
 *
 *   /events/p      u1   1 ON, 0 OFF
 *   /events/t      u4   [us] after t_offset: floor(t_ns / 1000) - t_offset
 *   /events/x, y   u2   [px]
 *   /events/t_ns   i8   [ns] the exact time, absolute (t_offset is included); TIDES's own, other readers ignore it
 *   /events/height, width   i4 scalars [px], where RVT's reader looks for them
 *   /events/cause, fired, frontend: labels, if the run has any
 *   /ms_to_idx     u8   entry k: the first event with t >= 1000 k, so it counts from t_offset too. It covers the recording's
 *                       end: a query that ends within the recording finds its entry. (DSEC's own reader fails on a window
 *                       without events; that is its defect.)
 *   /t_offset      i8   scalar [us], to be added to t, as in DSEC. It is 0 if the recording lies within the first 4294.967 s,
 *                       which 32 bits of microseconds hold; otherwise it is the recording's start
 *   attributes of the root: format "tides-events", version 1, tides_version, width, height, seed, run (the run file's JSON; a
 *     scalar dataset /run if it is longer than 60 kB), count (events that are safely in the file), start_ns (the recording's
 *     begin, if known), stop_ns (its end; -1 while it is being written). Texts have fixed length (h5py gives bytes); in older
 *     files they have variable length
 *
 * All datasets are chunked, shuffled and deflated. The microseconds end 71.6 minutes after t_offset, as in DSEC.
 *
 * A file is written as PATH.part, and stays readable if the process dies. In a .part, ms_to_idx lags behind (whole chunks
 * only), and datasets may hold invalid rows beyond `count`. A flush puts events after the last whole chunk into
 * PATH.part.tail, from which an interrupted recording is resumed. */
#include "archive/td_h5_driver.h"
#include "td_base.h"
#include "td_event_format.h"
#include "td_event_store.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct hdf5_writer {
    char *tail;
    td_event_store store;
    tides_event *buffer; /* room for TD_EVENT_CHUNK */
    int64_t *fired;      /* room for TD_EVENT_CHUNK; NULL: the file has no labels */
    size_t buffered;
    int32_t failed; /* 1 after a failed write: nothing is written any more */
    int32_t placed; /* 1: t_offset is final, since the recording's span is known or there are events */
    int64_t offset; /* [us] the final or intended t_offset */
} hdf5_writer;

/* Assumed length of a recording whose end isn't known [ns]: half of the time that /events/t can hold. */
#define TAKEN_LENGTH (TD_EVENT_SPAN / 2)

/* ---- t_offset ---- */

/* Rounds a time down to microseconds. Within the lowest microsecond of 64 bits it rounds up; such times are refused later. */
static int64_t floor_microseconds(int64_t ns) { return ns / 1000 - (ns % 1000 < 0 && ns >= INT64_MIN + 1000); }

static int64_t offset_for(int64_t start_ns, int64_t stop_ns) {
    return start_ns >= 0 && stop_ns <= TD_EVENT_SPAN ? 0 : floor_microseconds(start_ns);
}

/* Sets t_offset from the recording's start and stop, if the sink has them. */
static void place(td_event_sink *sink) {
    hdf5_writer *w = sink->state;
    w->placed = sink->stop_ns > sink->start_ns;
    w->offset = w->placed ? offset_for(sink->start_ns, sink->stop_ns) : 0;
}

/* Sets t_offset from the first event, if start and stop weren't known. */
static void begin_hdf5(td_event_sink *sink, const tides_event *first) {
    hdf5_writer *w = sink->state;
    if (!w->placed) w->offset = offset_for(first->t, first->t > INT64_MAX - TAKEN_LENGTH ? INT64_MAX : first->t + TAKEN_LENGTH);
}

static const char *span_hdf5(int64_t start_ns, int64_t stop_ns) {
    int64_t after;
    return !td_event_after(stop_ns, offset_for(start_ns, stop_ns), &after)
               ? "the file's 32-bit microseconds hold 4294.967 s: write several files (time.start, time.stop)"
               : NULL;
}

/* ---- opening ---- */

/* Makes a state with nothing open. */
static tides_status make_state(td_event_sink *sink, tides_error *error) {
    hdf5_writer *w = td_alloc(1, sizeof *w, error);
    sink->state = w;
    if (!w) return TIDES_NO_MEMORY;
    td_event_store_reset(&w->store);
    w->tail = td_format(error, "%s.tail", sink->part);
    w->buffer = w->tail ? td_alloc(TD_EVENT_CHUNK, sizeof *w->buffer, error) : NULL;
    if (w->buffer && sink->labels) w->fired = td_alloc(TD_EVENT_CHUNK, sizeof *w->fired, error);
    return w->buffer && (w->fired || !sink->labels) ? TIDES_OK : TIDES_NO_MEMORY;
}

static void discard_hdf5(td_event_sink *sink) {
    hdf5_writer *w = sink->state;
    if (!w) return;
    td_event_store_drop(&w->store);
    free(w->buffer);
    free(w->fired);
    free(w->tail);
    free(w);
}

static tides_event_file facts_of(const td_event_sink *sink) {
    return (tides_event_file){sink->width, sink->height, sink->run, sink->seed, sink->labels, sink->start_ns, sink->stop_ns};
}

static tides_status create_hdf5(td_event_sink *sink, tides_error *error) {
    const tides_event_file facts = facts_of(sink);
    tides_status status = make_state(sink, error);
    if (status != TIDES_OK) return status;
    hdf5_writer *w = sink->state;
    place(sink);
    char *checkpoint = td_format(error, "%s.checkpoint", sink->path);
    status = checkpoint ? td_event_store_create(&w->store, sink->part, &facts, w->offset, error) : TIDES_NO_MEMORY;
    if (status == TIDES_OK) sink->claim = td_keep_claim(td_h5_descriptor(w->store.file));
    if (status == TIDES_OK) unlink(w->tail); /* the tail belongs to an earlier run, whose .part was replaced */
    if (status == TIDES_OK)
        td_remove_file(checkpoint, NULL); /* the earlier run's, or that of the finished file that will be replaced */
    free(checkpoint);
    return status;
}

/* ---- appending ---- */

static const char *check_hdf5(const td_event_sink *sink, const tides_event *event, const tides_event *previous) {
    (void)previous;
    const int64_t offset = ((const hdf5_writer *)sink->state)->offset;
    int64_t after;
    if (event->t < 1000 * offset) return "is too early: it lies before the start that the recording was said to have";
    return !td_event_after(event->t, offset, &after)
               ? "is too late: the file's 32-bit microseconds end 4294.967295 s after its t_offset: write several files"
               : NULL;
}

static tides_status write_failed(td_event_sink *sink, tides_status status, const char *reason, tides_error *error) {
    hdf5_writer *w = sink->state;
    w->failed = 1;
    sink->count = w->store.rows + w->buffered;
    return td_fail(error, status, "%s: can't be written: %s; its first %" PRIu64 " events are safe", sink->part, reason,
                   w->store.rows);
}

static tides_status flush_buffer(td_event_sink *sink, tides_error *error) {
    hdf5_writer *w = sink->state;
    tides_error reason = {0};
    w->store.pool = sink->pool;
    tides_status status = td_event_store_append(&w->store, w->buffer, w->fired, w->buffered, &reason);
    if (status != TIDES_OK) return write_failed(sink, status, reason.text, error);
    w->buffered = 0;
    return TIDES_OK;
}

static tides_status write_hdf5(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error) {
    hdf5_writer *w = sink->state;
    const int64_t *fired = sink->fired;
    if (!w->placed && count > 0) {
        if (td_event_store_set_offset(&w->store, w->offset) < 0)
            return write_failed(sink, TIDES_WRITE_FAILED, "t_offset", error);
        w->placed = 1;
    }
    while (count > 0) {
        size_t room = TD_EVENT_CHUNK - w->buffered, taken = count < room ? count : room;
        memcpy(w->buffer + w->buffered, events, taken * sizeof *events);
        for (size_t i = 0; i < taken && w->fired; i++) w->fired[w->buffered + i] = fired ? *fired++ : events[i].t;
        w->buffered += taken;
        events += taken;
        count -= taken;
        tides_status status = w->buffered == TD_EVENT_CHUNK ? flush_buffer(sink, error) : TIDES_OK;
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}

/* ---- surviving an interruption, and resuming ---- */

/* Writes the buffer's events as the tail. */
static tides_status write_tail(const td_event_sink *sink, uint64_t first, tides_error *error) {
    const hdf5_writer *w = sink->state;
    const tides_event_file facts = {sink->width, sink->height, NULL, NULL, sink->labels, 0, 0};
    return td_event_tail_write(w->tail, &facts, w->offset, first, w->buffer, w->fired, w->buffered, error);
}

static tides_status flush_hdf5(td_event_sink *sink, tides_error *error) {
    hdf5_writer *w = sink->state;
    int unsynced = td_event_store_sync(&w->store); /* a checkpoint that survives a power cut needs its events */
    if (unsynced) return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be put on the disk: %s", sink->part, strerror(unsynced));
    if (w->buffered == 0) return TIDES_OK; /* whole chunks are written at once */
    return write_tail(sink, w->store.rows, error);
}

/* Loads events [rows, rows + buffered), which follow the last whole chunk that stays: from the tail, or from the .part itself
 * if that is longer (`*from_part`). */
static tides_status find_tail(td_event_sink *sink, uint64_t rows, int *from_part, tides_error *error) {
    hdf5_writer *w = sink->state;
    *from_part = 0;
    if (w->buffered == 0) return TIDES_OK;
    size_t got = 0;
    tides_error reason = {0};
    tides_status status = td_event_tail_read(w->tail, rows, w->buffer, w->fired, w->buffered, &reason);
    if (status == TIDES_OK) return td_event_check(&td_format_hdf5, sink, w->buffer, w->buffered, error);
    status = tides_events_read(sink->part, rows, w->buffered, w->buffer, &got, error);
    if (status == TIDES_OK) status = tides_events_labels(sink->part, rows, got, w->buffer, w->fired, error);
    if (status != TIDES_OK) return status;
    if (got < w->buffered)
        return td_fail(error, TIDES_BAD_FILE,
                       "%s: ends %zu events before event %" PRIu64 ", where the run was interrupted (%s): start anew",
                       sink->part, w->buffered - got, rows + w->buffered, reason.text);
    *from_part = 1;
    return td_event_check(&td_format_hdf5, sink, w->buffer, w->buffered, error);
}

static int is_same(const tides_event *a, const tides_event *b) {
    return a->t == b->t && a->x == b->x && a->y == b->y && a->polarity == b->polarity;
}

/* Finds the last event, to check the order of the next one. If `wanted` isn't NULL, it must be equal to it. */
static tides_status find_last(td_event_sink *sink, uint64_t count, const tides_event *wanted, tides_error *error) {
    const hdf5_writer *w = sink->state;
    size_t got = 1;
    if (count == 0) return TIDES_OK;
    tides_status status = TIDES_OK;
    if (w->buffered > 0)
        sink->last = w->buffer[w->buffered - 1];
    else
        status = tides_events_read(sink->part, count - 1, 1, &sink->last, &got, error);
    if (status == TIDES_OK && got == 0)
        return td_fail(error, TIDES_BAD_FILE, "%s: holds fewer than %" PRIu64 " events: start anew", sink->part, count);
    if (status == TIDES_OK && wanted && !is_same(wanted, &sink->last))
        return td_fail(error, TIDES_BAD_FILE,
                       "%s: is of another recording than its checkpoint: their event %" PRIu64 " isn't the same; start anew",
                       sink->path, count - 1);
    sink->has_last = status == TIDES_OK;
    return status;
}

/* Takes the .part's t_offset, which may have been chosen for another stop. Without events it may still change. */
static tides_status resume_offset(td_event_sink *sink, uint64_t count, tides_error *error) {
    hdf5_writer *w = sink->state;
    place(sink);
    if (count == 0) return TIDES_OK;
    int64_t after;
    w->offset = td_event_store_peek_offset(sink->part);
    if (w->placed && (sink->start_ns < 1000 * w->offset || !td_event_after(sink->stop_ns, w->offset, &after)))
        return td_fail(error, TIDES_UNSUPPORTED,
                       "%s: counts its 32-bit microseconds from %.15g s, which can't hold the run up to its new stop, %.15g s: "
                       "simulate from the beginning",
                       sink->part, 1e-6 * (double)w->offset, 1e-9 * (double)sink->stop_ns);
    w->placed = 1;
    return TIDES_OK;
}

static tides_status resume_hdf5(td_event_sink *sink, uint64_t count, const tides_event *last, tides_error *error) {
    const tides_event_file facts = facts_of(sink);
    tides_status status = make_state(sink, error);
    if (status != TIDES_OK) return status;
    hdf5_writer *w = sink->state;
    int from_part = 0;
    uint64_t rows = count / TD_EVENT_CHUNK * TD_EVENT_CHUNK;
    status = td_event_store_claim(sink->part, 0, error);
    w->buffered = (size_t)(count - rows);
    if (status == TIDES_OK) status = resume_offset(sink, count, error);
    if (status == TIDES_OK) status = find_tail(sink, rows, &from_part, error);
    if (status == TIDES_OK) status = find_last(sink, count, last, error);
    if (status == TIDES_OK && from_part) status = write_tail(sink, rows, error); /* before the .part is cut */
    if (status == TIDES_OK) status = td_event_store_reopen(&w->store, sink->part, &facts, rows, error);
    if (status == TIDES_OK && w->placed && td_event_store_set_offset(&w->store, w->offset) < 0)
        status = write_failed(sink, TIDES_WRITE_FAILED, "t_offset", error);
    if (status == TIDES_OK) sink->claim = td_keep_claim(td_h5_descriptor(w->store.file));
    sink->count = count;
    return status;
}

/* ---- ending ---- */

/* Number of entries of ms_to_idx. DSEC's reader looks up ceil(end / 1 ms), and the millisecond after the last event. */
static uint64_t index_entries(const td_event_sink *sink, int64_t stop_ns) {
    const int64_t from = 1000 * ((const hdf5_writer *)sink->state)->offset, end = stop_ns - from;
    uint64_t entries = end > 0 ? (uint64_t)((end - 1) / 1000000) + 2 : 1;
    uint64_t needed = sink->has_last ? (uint64_t)((sink->last.t - from) / 1000000) + 2 : 1;
    return entries > needed ? entries : needed;
}

static tides_status close_store(td_event_sink *sink, tides_error *error) {
    hdf5_writer *w = sink->state;
    uint64_t rows = w->store.rows;
    tides_error reason = {0};
    tides_status status = td_event_store_close(&w->store, &reason);
    w->store.rows = rows;
    return status == TIDES_OK ? status : write_failed(sink, status, reason.text, error);
}

static tides_status complete_hdf5(td_event_sink *sink, int64_t stop_ns, tides_error *error) {
    hdf5_writer *w = sink->state;
    const int64_t least = sink->has_last ? sink->last.t : 1000 * w->offset;
    if (stop_ns < least) stop_ns = least;
    tides_status status = flush_buffer(sink, error);
    if (status != TIDES_OK) return status;
    int64_t after;
    if (!td_event_after(stop_ns, w->offset, &after))
        return td_fail(error, TIDES_UNSUPPORTED,
                       "%s: can't end at %" PRId64 " ns: its 32-bit microseconds end 4294.967295 s after its t_offset, %" PRId64
                       " us: write several files",
                       sink->part, stop_ns, w->offset);
    tides_error reason = {0};
    status = td_event_store_complete(&w->store, index_entries(sink, stop_ns), stop_ns, &reason);
    if (status != TIDES_OK) return write_failed(sink, status, reason.text, error);
    status = close_store(sink, error);
    if (status == TIDES_OK) unlink(w->tail);
    return status;
}

static void abandon_hdf5(td_event_sink *sink) {
    hdf5_writer *w = sink->state;
    int safe = !w->failed && flush_buffer(sink, NULL) == TIDES_OK;
    if (safe) {
        tides_status ignored = td_event_store_complete(&w->store, w->store.next_ms, -1, NULL);
        (void)ignored; /* only the last entries of the index would be lost */
    }
    if (td_event_store_close(&w->store, NULL) == TIDES_OK && safe) unlink(w->tail); /* the .part has all events */
}

const td_event_format td_format_hdf5 = {
    .takes = TD_TAKES_COLUMNS | TD_TAKES_UNIT | TD_TAKES_STREAM,
    .name = "hdf5",
    .endings = ".h5 .hdf5",
    .summary = "HDF5: DSEC's layout with nanoseconds; reads EDS, MVSEC, M3ED, RVT, v2e and TimoStoff's too",
    .tick_ns = 1,
    .size_limit = 65536,
    .library = 1,
    .labels = 1,
    .negative = 1,
    .detect = td_h5_detect,
    .open = td_h5_open,
    .read = td_h5_read,
    .close = td_h5_close_stream,
    .create = create_hdf5,
    .span = span_hdf5,
    .begin = begin_hdf5,
    .check = check_hdf5,
    .check_ends = 1,
    .write = write_hdf5,
    .complete = complete_hdf5,
    .discard = discard_hdf5,
    .flush = flush_hdf5,
    .resume = resume_hdf5,
    .abandon = abandon_hdf5,
};
