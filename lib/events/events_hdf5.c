/* Writes event files: HDF5 in the layout of DSEC (https://dsec.ifi.uzh.ch/data-format), which most readers of event data know.
 *
 *   /events/p      u1   1 ON, 0 OFF
 *   /events/t      u4   [us] after t_offset; floor(t_ns / 1000)
 *   /events/x, y   u2   [px]
 *   /events/t_ns   i8   [ns] the exact time; ours, ignored by others
 *   /events/cause  u1   TIDES_CAUSE_*; only where some event is not the signal's (event_cause.c)
 *   /ms_to_idx     u8   entry k: the first event with t >= 1000 k. It covers the recording's end: a query that ends within the
 *                       recording finds its entry. (DSEC's own reader fails on a window without events; that is its defect.)
 *   /t_offset      i8   scalar, 0
 *   attributes of the root: format "tides-events", version 1, tides_version, width, height, seed, run (the run file's JSON),
 *     count (events that are safely in the file), stop_ns (end of the recording; -1 while it is being written)
 *
 * All datasets are chunked, shuffled and deflated (level 1). The microseconds end after 71.6 minutes, as in DSEC.
 *
 * A file grows as PATH.part; event_store.c says why it stays readable whatever happens to the process. In a .part, ms_to_idx
 * lags behind (whole chunks only), and the datasets may hold rows beyond `count` that mean nothing. What a flush finds after
 * the last whole chunk goes to PATH.part.tail (event_tail.c), from which an interrupted recording is resumed. */
#include "tides/events.h"

#include "td_base.h"
#include "td_event_store.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct tides_event_writer {
    char *path, *part, *tail;
    int32_t width, height;
    td_event_store store;
    tides_event *buffer; /* TD_EVENT_CHUNK of them */
    size_t buffered;
    tides_event last; /* appended; the order is checked against it */
    int32_t has_last;
    tides_error failure; /* the first failed write: nothing is written after it */
};

/* The latest time that /events/t can hold [ns]. */
#define LAST_TIME (((int64_t)UINT32_MAX + 1) * 1000 - 1)

/* ---- opening ---- */

static tides_status check_facts(const char *path, const tides_event_file *file, tides_error *error) {
    /* Coordinates are 16 bits wide. */
    if (file->width < 1 || file->height < 1 || file->width > 65536 || file->height > 65536)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: an event file can't be %d x %d px: give 1 to 65536", path, file->width,
                       file->height);
    struct stat there;
    if (stat(path, &there) == 0 && S_ISDIR(there.st_mode))
        return td_fail(error, TIDES_WRITE_FAILED, "%s: is a folder: name a file in it", path);
    return TIDES_OK;
}

static void free_writer(tides_event_writer *writer) {
    free(writer->buffer);
    free(writer->tail);
    free(writer->part);
    free(writer->path);
    free(writer);
}

/* A writer that has nothing open yet; NULL: out of memory. */
static tides_event_writer *make_writer(const char *path, const tides_event_file *file, tides_error *error) {
    tides_event_writer *made = td_alloc(1, sizeof *made, error);
    if (!made) return NULL;
    made->width = file->width;
    made->height = file->height;
    td_event_store_reset(&made->store);
    made->path = td_strdup(path, error);
    made->part = made->path ? td_part_name(path, error) : NULL;
    made->tail = made->part ? td_format(error, "%s.tail", made->part) : NULL;
    made->buffer = made->tail ? td_alloc(TD_EVENT_CHUNK, sizeof *made->buffer, error) : NULL;
    if (made->buffer) return made;
    free_writer(made);
    return NULL;
}

tides_status tides_event_writer_open(const char *path, const tides_event_file *file, tides_event_writer **writer,
                                     tides_error *error) {
    if (!path || !file || !writer) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_event_writer_open: an argument is NULL");
    tides_status status = check_facts(path, file, error);
    if (status != TIDES_OK) return status;
    tides_event_writer *made = make_writer(path, file, error);
    if (!made) return TIDES_NO_MEMORY;
    td_h5_quiet quiet;
    td_h5_quiet_begin(&quiet);
    status = td_event_store_create(&made->store, made->part, file, error);
    td_h5_quiet_end(&quiet);
    if (status != TIDES_OK) {
        free_writer(made);
        return status;
    }
    unlink(made->tail); /* of an earlier run, whose .part is gone now */
    *writer = made;
    return TIDES_OK;
}

/* ---- appending ---- */

static int before(const tides_event *a, const tides_event *b) {
    if (a->t != b->t) return a->t < b->t;
    if (a->y != b->y) return a->y < b->y;
    if (a->x != b->x) return a->x < b->x;
    return a->polarity < b->polarity;
}

static tides_status refuse(const tides_event *event, uint64_t index, tides_status status, const char *why, tides_error *error) {
    return td_fail(error, status, "event %" PRIu64 " (t %" PRId64 " ns, x %u, y %u, polarity %d) %s", index, event->t, event->x,
                   event->y, event->polarity, why);
}

static tides_status check_event(const tides_event_writer *writer, const tides_event *event, const tides_event *previous,
                                uint64_t index, tides_error *error) {
    if (event->x >= writer->width || event->y >= writer->height)
        return refuse(event, index, TIDES_BAD_ARGUMENT, "lies outside the image: check the file's width and height", error);
    if (event->polarity != 1 && event->polarity != -1)
        return refuse(event, index, TIDES_BAD_ARGUMENT, "has no polarity: give +1 or -1", error);
    if (event->t < 0)
        return refuse(event, index, TIDES_BAD_ARGUMENT, "lies before time 0: count times from the run's start", error);
    if (previous && before(event, previous))
        return refuse(event, index, TIDES_BAD_ARGUMENT, "comes before the one ahead of it: sort by t, y, x, polarity", error);
    if (event->t > LAST_TIME)
        return refuse(event, index, TIDES_UNSUPPORTED,
                      "is too late: the file's 32-bit microseconds end after 4294.967295 s: "
                      "write several files",
                      error);
    return TIDES_OK;
}

static tides_status check_events(const tides_event_writer *writer, const tides_event *events, size_t count,
                                 tides_error *error) {
    const tides_event *previous = writer->has_last ? &writer->last : NULL;
    uint64_t index = tides_event_writer_count(writer);
    for (size_t i = 0; i < count; i++) {
        tides_status status = check_event(writer, &events[i], previous, index + i, error);
        if (status != TIDES_OK) return td_fail_within(error, status, "%s", writer->path);
        previous = &events[i];
    }
    return TIDES_OK;
}

static tides_status repeat_failure(const tides_event_writer *writer, tides_error *error) {
    return td_fail(error, writer->failure.status, "%s", writer->failure.text);
}

static void remember_failure(tides_event_writer *writer, tides_status status, const char *reason) {
    td_fail(&writer->failure, status, "%s: can't be written: %s; its first %" PRIu64 " events are safe", writer->part, reason,
            writer->store.rows);
}

/* Writes what is buffered. A failure is for good: it is kept and told again by every later call. */
static tides_status flush_buffer(tides_event_writer *writer) {
    if (writer->failure.status != TIDES_OK) return writer->failure.status;
    tides_error reason = {0};
    td_h5_quiet quiet;
    td_h5_quiet_begin(&quiet);
    tides_status status = td_event_store_append(&writer->store, writer->buffer, writer->buffered, &reason);
    td_h5_quiet_end(&quiet);
    if (status == TIDES_OK)
        writer->buffered = 0;
    else
        remember_failure(writer, status, reason.text);
    return status;
}

tides_status tides_event_writer_append(tides_event_writer *writer, const tides_event *events, size_t count,
                                       tides_error *error) {
    if (!writer || (!events && count > 0))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_event_writer_append: an argument is NULL");
    if (writer->failure.status != TIDES_OK) return repeat_failure(writer, error);
    tides_status status = check_events(writer, events, count, error);
    if (status != TIDES_OK) return status;
    while (count > 0) {
        size_t room = TD_EVENT_CHUNK - writer->buffered, taken = count < room ? count : room;
        memcpy(writer->buffer + writer->buffered, events, taken * sizeof *events);
        writer->buffered += taken;
        writer->last = events[taken - 1];
        writer->has_last = 1;
        events += taken;
        count -= taken;
        if (writer->buffered == TD_EVENT_CHUNK && flush_buffer(writer) != TIDES_OK) return repeat_failure(writer, error);
    }
    return TIDES_OK;
}

uint64_t tides_event_writer_count(const tides_event_writer *writer) { return writer->store.rows + writer->buffered; }

/* ---- surviving, and going on ---- */

tides_status tides_event_writer_flush(tides_event_writer *writer, tides_error *error) {
    if (!writer) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_event_writer_flush: the writer is NULL");
    if (writer->failure.status != TIDES_OK) return repeat_failure(writer, error);
    if (writer->buffered == 0) return TIDES_OK; /* whole chunks are in the file as soon as they are whole */
    const tides_event_file facts = {writer->width, writer->height, NULL, NULL};
    td_h5_quiet quiet;
    td_h5_quiet_begin(&quiet);
    tides_status status =
        td_event_tail_write(writer->tail, &facts, writer->store.rows, writer->buffer, writer->buffered, error);
    td_h5_quiet_end(&quiet);
    return status;
}

/* Events [rows, rows + buffered), after the last whole chunk that stays: from the tail, or from the .part itself where it has
 * gone on past them; then they become the tail before the .part is cut. */
static tides_status find_tail(tides_event_writer *writer, uint64_t rows, tides_error *error) {
    if (writer->buffered == 0) return TIDES_OK;
    size_t got = 0;
    tides_error reason = {0};
    tides_status status = td_event_tail_read(writer->tail, rows, writer->buffer, writer->buffered, &reason);
    if (status == TIDES_OK) return check_events(writer, writer->buffer, writer->buffered, error);
    status = tides_events_read(writer->part, rows, writer->buffered, writer->buffer, &got, error);
    if (status == TIDES_OK) status = tides_events_causes(writer->part, rows, got, writer->buffer, error);
    if (status != TIDES_OK) return status;
    if (got < writer->buffered)
        return td_fail(error, TIDES_BAD_FILE,
                       "%s: ends %zu events before event %" PRIu64 ", where the run was interrupted (%s): start anew",
                       writer->part, writer->buffered - got, rows + writer->buffered, reason.text);
    status = check_events(writer, writer->buffer, writer->buffered, error);
    const tides_event_file facts = {writer->width, writer->height, NULL, NULL};
    return status == TIDES_OK ? td_event_tail_write(writer->tail, &facts, rows, writer->buffer, writer->buffered, error)
                              : status;
}

/* The last event, against which the next one's order is checked. */
static tides_status find_last(tides_event_writer *writer, uint64_t count, tides_error *error) {
    size_t got = 1;
    if (count == 0) return TIDES_OK;
    tides_status status = TIDES_OK;
    if (writer->buffered > 0)
        writer->last = writer->buffer[writer->buffered - 1];
    else
        status = tides_events_read(writer->part, count - 1, 1, &writer->last, &got, error);
    if (status == TIDES_OK && got == 0)
        return td_fail(error, TIDES_BAD_FILE, "%s: holds fewer than %" PRIu64 " events: start anew", writer->part, count);
    writer->has_last = status == TIDES_OK;
    return status;
}

tides_status tides_event_writer_resume(const char *path, const tides_event_file *file, uint64_t count,
                                       tides_event_writer **writer, tides_error *error) {
    if (!path || !file || !writer) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_event_writer_resume: an argument is NULL");
    tides_status status = check_facts(path, file, error);
    if (status != TIDES_OK) return status;
    tides_event_writer *made = make_writer(path, file, error);
    if (!made) return TIDES_NO_MEMORY;
    uint64_t rows = count / TD_EVENT_CHUNK * TD_EVENT_CHUNK;
    td_h5_quiet quiet;
    td_h5_quiet_begin(&quiet);
    status = td_event_store_claim(made->part, 0, error);
    made->buffered = (size_t)(count - rows);
    if (status == TIDES_OK) status = find_tail(made, rows, error);
    if (status == TIDES_OK) status = find_last(made, count, error);
    if (status == TIDES_OK) status = td_event_store_reopen(&made->store, made->part, file, rows, error);
    td_h5_quiet_end(&quiet);
    if (status != TIDES_OK) {
        free_writer(made);
        return status;
    }
    *writer = made;
    return TIDES_OK;
}

/* ---- ending ---- */

/* Entries of ms_to_idx: DSEC's reader looks up ceil(end / 1 ms) and the millisecond after the last event. */
static uint64_t index_entries(const tides_event_writer *writer, int64_t stop_ns) {
    uint64_t entries = stop_ns > 0 ? (uint64_t)((stop_ns - 1) / 1000000) + 2 : 1;
    uint64_t needed = writer->has_last ? (uint64_t)(writer->last.t / 1000000) + 2 : 1;
    return entries > needed ? entries : needed;
}

static tides_status complete(tides_event_writer *writer, int64_t stop_ns) {
    if (stop_ns < 0) stop_ns = 0;
    if (writer->has_last && stop_ns < writer->last.t) stop_ns = writer->last.t;
    tides_status status = flush_buffer(writer);
    if (status != TIDES_OK) return status;
    if (stop_ns > LAST_TIME)
        return td_fail(&writer->failure, TIDES_UNSUPPORTED,
                       "%s: can't end at %" PRId64 " ns: its 32-bit microseconds end after "
                       "4294.967295 s: write several files",
                       writer->part, stop_ns);
    tides_error reason = {0};
    status = td_event_store_complete(&writer->store, index_entries(writer, stop_ns), stop_ns, &reason);
    if (status != TIDES_OK) remember_failure(writer, status, reason.text);
    return status;
}

static tides_status close_store(tides_event_writer *writer) {
    uint64_t rows = writer->store.rows;
    if (td_event_store_close(&writer->store) >= 0) return TIDES_OK;
    td_h5_reason reason;
    const char *text = td_h5_reason_text(&reason);
    writer->store.rows = rows;
    if (writer->failure.status == TIDES_OK) remember_failure(writer, TIDES_WRITE_FAILED, text);
    return TIDES_WRITE_FAILED;
}

tides_status tides_event_writer_finish(tides_event_writer *writer, int64_t stop_ns, tides_error *error) {
    if (!writer) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_event_writer_finish: the writer is NULL");
    td_h5_quiet quiet;
    td_h5_quiet_begin(&quiet);
    tides_status status = complete(writer, stop_ns);
    tides_status closed = close_store(writer);
    td_h5_quiet_end(&quiet);
    if (status == TIDES_OK) status = closed;
    if (status != TIDES_OK)
        repeat_failure(writer, error);
    else
        status = td_commit_file(writer->part, writer->path, error);
    if (status == TIDES_OK) unlink(writer->tail);
    free_writer(writer);
    return status;
}

void tides_event_writer_abandon(tides_event_writer *writer) {
    if (!writer) return;
    td_h5_quiet quiet;
    td_h5_quiet_begin(&quiet);
    int safe = flush_buffer(writer) == TIDES_OK;
    if (safe) {
        tides_status ignored = td_event_store_complete(&writer->store, writer->store.next_ms, -1, NULL);
        (void)ignored; /* only the index's last entries are at stake */
    }
    if (td_event_store_close(&writer->store) >= 0 && safe) unlink(writer->tail); /* the .part has all of it */
    td_h5_quiet_end(&quiet);
    free_writer(writer);
}
