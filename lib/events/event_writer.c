/* Writes event files of any format: checks order and size, writes beside the final file, and renames. Each format encodes its
 * own bytes. */
#include "td_base.h"
#include "td_event_format.h"
#include "td_event_h5.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct tides_event_writer {
    const td_event_format *format;
    td_event_sink sink;
    tides_error failure; /* the first failed write; nothing is written after it */
};

int32_t tides_event_format_at(size_t index, tides_event_format *format) {
    size_t count = 0;
    while (td_event_formats[count]) count++;
    if (!format || index >= count) return 0;
    const td_event_format *f = td_event_formats[index];
    *format =
        (tides_event_format){f->name, f->summary, f->endings ? f->endings : "", f->read != NULL, f->create != NULL, f->tick_ns};
    return 1;
}

/* ---- opening ---- */

static const char *why_not_span(const td_event_format *format, int64_t start_ns, int64_t stop_ns) {
    if (format->silence_ns && start_ns > format->silence_ns) return format->silent_start;
    return format->span ? format->span(start_ns, stop_ns) : NULL;
}

static tides_status check_file(const char *path, const td_event_format *format, const tides_event_file *file,
                               tides_error *error) {
    /* Coordinates are 16 bits wide. */
    if (file->width < 1 || file->height < 1 || file->width > 65536 || file->height > 65536)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: an event file can't be %d x %d px: give 1 to 65536", path, file->width,
                       file->height);
    if (!format->create)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: files of the format \"%s\" are only read", path, format->name);
    if (file->width > format->size_limit || file->height > format->size_limit)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: %s holds coordinates below %d only, and the sensor has %d x %d px", path,
                       format->summary, format->size_limit, file->width, file->height);
    if (file->labels && !format->labels)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: %s has no place for labels: write HDF5 (.h5), or leave sensor.labels off",
                       path, format->summary);
    const double start = 1e-9 * (double)file->start_ns, stop = 1e-9 * (double)file->stop_ns;
    const int known = file->stop_ns > file->start_ns;
    if (known && file->start_ns < 0 && !format->negative)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "%s: %s has no times before 0, and the run goes from %.15g to %.15g s: write HDF5 (.h5), or move it "
                       "(camera.rebase or frames.rebase, and time.start)",
                       path, format->summary, start, stop);
    const char *why = known ? why_not_span(format, file->start_ns, file->stop_ns) : NULL;
    if (why) return td_fail(error, TIDES_UNSUPPORTED, "%s: can't hold a run from %.15g to %.15g s: %s", path, start, stop, why);
    return TIDES_OK;
}

static tides_status open_part(td_event_sink *sink, tides_error *error) {
    sink->file = td_part_open(sink->part, sink->path);
    if (sink->file && strcmp(sink->part, sink->path) != 0) sink->claim = td_keep_claim(fileno(sink->file));
    if (sink->file) return TIDES_OK;
    if (errno == EBUSY)
        return td_fail(error, TIDES_WRITE_FAILED, "%s: is being written by another run: wait for it, or name another file",
                       sink->part);
    const char *what = strcmp(sink->part, sink->path) == 0 ? "written" : "created"; /* a device or FIFO exists already */
    return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be %s: %s", sink->part, what, strerror(errno));
}

static void free_writer(tides_event_writer *writer) {
    td_event_sink *sink = &writer->sink;
    if (writer->format->discard) writer->format->discard(sink);
    if (sink->file) fclose(sink->file);
    td_end_claim(sink->claim);
    td_event_ticks_destroy(sink->ticks);
    free(sink->part);
    free(sink->path);
    free(writer);
}

/* Makes a writer, without opening anything. */
static tides_status make_writer(const char *path, const td_event_format *format, const tides_event_file *file,
                                tides_event_writer **writer, tides_error *error) {
    tides_event_writer *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    made->format = format;
    td_event_sink *sink = &made->sink;
    sink->claim = -1;
    sink->width = file->width;
    sink->height = file->height;
    sink->run = file->run;
    sink->seed = file->seed;
    sink->labels = file->labels;
    sink->start_ns = file->start_ns;
    sink->stop_ns = file->stop_ns;
    sink->path = td_strdup(path, error);
    int streams = !format->library && !format->patches;
    tides_status status = sink->path ? td_part_name(path, streams, &sink->part, error) : TIDES_NO_MEMORY;
    if (status == TIDES_OK && format->tick_ns > 1 && !(sink->ticks = td_event_ticks_create(format->tick_ns, error)))
        status = TIDES_NO_MEMORY;
    if (status == TIDES_OK)
        *writer = made;
    else
        free_writer(made);
    return status;
}

static tides_status begin(tides_event_writer *writer, tides_error *error) {
    td_event_sink *sink = &writer->sink;
    if (!writer->format->library) {
        tides_status status = open_part(sink, error);
        if (status != TIDES_OK) return status;
        status = writer->format->create(sink, error);
        if (status != TIDES_OK) td_remove_part(sink->part, sink->path);
        return status;
    }
    td_h5_quiet quiet;
    td_h5_quiet_begin(&quiet);
    tides_status status = writer->format->create(sink, error);
    td_h5_quiet_end(&quiet);
    return status;
}

static tides_status open_format(const char *path, const td_event_format *format, const tides_event_file *file,
                                tides_event_writer **writer, tides_error *error) {
    tides_status status = check_file(path, format, file, error);
    if (status != TIDES_OK) return status;
    tides_event_writer *made = NULL;
    status = make_writer(path, format, file, &made, error);
    if (status != TIDES_OK) return status;
    status = begin(made, error);
    if (status != TIDES_OK) {
        free_writer(made);
        return status;
    }
    made->sink.run = made->sink.seed = NULL;
    *writer = made;
    return TIDES_OK;
}

tides_status tides_event_writer_open(const char *path, const char *format, const tides_event_file *file,
                                     tides_event_writer **writer, tides_error *error) {
    if (!path || !file || !writer) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_event_writer_open: an argument is NULL");
    const td_event_format *found = NULL;
    tides_status status = format ? td_event_format_named(format, &found, error) : td_event_format_for(path, &found, error);
    return status == TIDES_OK ? open_format(path, found, file, writer, error) : status;
}

int32_t tides_event_writer_can_resume(const char *path) {
    const td_event_format *format = NULL;
    return path && td_event_format_for(path, &format, NULL) == TIDES_OK && format->resume;
}

/* If there is no .part, continues a finished recording: in a copy, so that the recording stays until a longer one replaces
 * it. `*copied` is 1 if the .part is such a copy. */
static tides_status take_finished(const td_event_sink *sink, int *copied, tides_error *error) {
    char *copy = NULL;
    *copied = 0;
    /* if both are missing, the format reports it */
    if (access(sink->part, F_OK) == 0 || access(sink->path, F_OK) != 0) return TIDES_OK;
    tides_status status = td_part_name(sink->part, 0, &copy, error);
    if (status != TIDES_OK) return status;
    status = td_copy_file(sink->path, copy, error);
    if (status == TIDES_OK)
        status = td_commit_file(copy, sink->part, error); /* renamed only when complete, since a .part that exists is trusted */
    else
        td_remove_part(copy, sink->part);
    *copied = status == TIDES_OK;
    free(copy);
    return status;
}

static tides_status resume(tides_event_writer *writer, uint64_t count, const tides_event *last, tides_error *error) {
    int copied;
    td_h5_quiet quiet;
    tides_status status = take_finished(&writer->sink, &copied, error);
    if (status != TIDES_OK) return status;
    td_h5_quiet_begin(&quiet);
    status = writer->format->resume(&writer->sink, count, last, error);
    td_h5_quiet_end(&quiet);
    if (status != TIDES_OK && copied) td_remove_part(writer->sink.part, writer->sink.path);
    return status;
}

tides_status tides_event_writer_resume(const char *path, const tides_event_file *file, uint64_t count,
                                       tides_event_writer **writer, tides_error *error) {
    return td_event_writer_resume(path, file, count, NULL, writer, error);
}

tides_status td_event_writer_resume(const char *path, const tides_event_file *file, uint64_t count, const tides_event *last,
                                    tides_event_writer **writer, tides_error *error) {
    if (!path || !file || !writer) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_event_writer_resume: an argument is NULL");
    const td_event_format *format = NULL;
    tides_status status = td_event_format_for(path, &format, error);
    if (status != TIDES_OK) return status;
    if (!format->resume)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: an interrupted recording goes on only in HDF5 (.h5), not in %s", path,
                       format->summary);
    status = check_file(path, format, file, error);
    if (status != TIDES_OK) return status;
    tides_event_writer *made = NULL;
    status = make_writer(path, format, file, &made, error);
    if (status != TIDES_OK) return status;
    status = resume(made, count, last, error);
    if (status == TIDES_OK)
        *writer = made;
    else
        free_writer(made);
    return status;
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

static const char *why_not_after(const td_event_format *format, const td_event_sink *sink, const tides_event *event,
                                 const tides_event *previous) {
    if (format->silence_ns && event->t - (previous ? previous->t : 0) > format->silence_ns) return format->silent_event;
    return format->check ? format->check(sink, event, previous) : NULL;
}

static tides_status check_event(const td_event_format *format, const td_event_sink *sink, const tides_event *event,
                                const tides_event *previous, uint64_t index, tides_error *error) {
    if (event->x >= sink->width || event->y >= sink->height)
        return refuse(event, index, TIDES_BAD_ARGUMENT, "lies outside the image: check the file's width and height", error);
    if (event->polarity != 1 && event->polarity != -1)
        return refuse(event, index, TIDES_BAD_ARGUMENT, "has no polarity: give +1 or -1", error);
    if (event->t < 0 && !format->negative)
        return refuse(event, index, TIDES_BAD_ARGUMENT,
                      "lies before time 0: write HDF5 (.h5), count from the recording's zero (--rebase), or shift it "
                      "(--offset)",
                      error);
    if (previous && before(event, previous))
        return refuse(event, index, TIDES_BAD_ARGUMENT, "comes before the one ahead of it: sort by t, y, x, polarity", error);
    const char *why = why_not_after(format, sink, event, previous);
    return why ? refuse(event, index, TIDES_UNSUPPORTED, why, error) : TIDES_OK;
}

/* 1 if check_event would accept all of them. This test is fast, because it has no branch per event; events are hardly ever
 * refused. */
static int are_plain(const td_event_format *format, const td_event_sink *sink, const tides_event *events, size_t count,
                     const tides_event *previous) {
    const uint32_t width = (uint32_t)sink->width, height = (uint32_t)sink->height;
    uint32_t bad = format->silence_ns || (format->check && !format->check_ends);
    bad |= (events[0].t < 0 && !format->negative) || (previous && before(&events[0], previous));
    for (size_t i = 0; i < count; i++) bad |= (events[i].x >= width) | (events[i].y >= height);
    for (size_t i = 0; i < count; i++) bad |= (uint32_t)(events[i].polarity * events[i].polarity != 1);
    for (size_t i = 1; i < count; i++) {
        const tides_event *a = &events[i - 1], *b = &events[i];
        const uint64_t before_place = (uint64_t)a->y << 24 | (uint64_t)a->x << 8 | (uint64_t)(a->polarity > 0);
        const uint64_t place = (uint64_t)b->y << 24 | (uint64_t)b->x << 8 | (uint64_t)(b->polarity > 0);
        bad |= (uint32_t)(b->t < a->t) | ((uint32_t)(b->t == a->t) & (uint32_t)(place < before_place));
    }
    if (bad) return 0;
    return !format->check || (!format->check(sink, &events[0], previous) && !format->check(sink, &events[count - 1], previous));
}

tides_status td_event_check(const td_event_format *format, const td_event_sink *sink, const tides_event *events, size_t count,
                            tides_error *error) {
    const tides_event *previous = sink->has_last ? &sink->last : NULL;
    if (count == 0 || are_plain(format, sink, events, count, previous)) return TIDES_OK;
    for (size_t i = 0; i < count; i++) {
        tides_status status = check_event(format, sink, &events[i], previous, sink->count + i, error);
        if (status != TIDES_OK) return td_fail_within(error, status, "%s", sink->path);
        previous = &events[i];
    }
    return TIDES_OK;
}

static tides_status repeat_failure(const tides_event_writer *writer, tides_error *error) {
    return td_fail(error, writer->failure.status, "%s", writer->failure.text);
}

/* A failure of the format, or of writing its bytes, is permanent: it is stored and repeated. */
static tides_status settle(tides_event_writer *writer, tides_status status) {
    td_event_sink *sink = &writer->sink;
    if (status == TIDES_OK && sink->failed)
        status = td_fail(&writer->failure, TIDES_WRITE_FAILED, "%s: can't be written: %s", sink->part, strerror(sink->failed));
    writer->failure.status = status;
    return status;
}

static tides_status write_events(tides_event_writer *writer, const tides_event *events, const int64_t *fired, size_t count) {
    td_event_sink *sink = &writer->sink;
    td_h5_quiet quiet;
    sink->fired = fired;
    if (writer->format->library) td_h5_quiet_begin(&quiet);
    tides_status status = writer->format->write(sink, events, count, &writer->failure);
    if (sink->file) td_sink_flush(sink);
    if (writer->format->library) td_h5_quiet_end(&quiet);
    return settle(writer, status);
}

tides_status tides_event_writer_append(tides_event_writer *writer, const tides_event *events, const int64_t *fired,
                                       size_t count, tides_error *error) {
    return td_event_writer_append(writer, events, fired, count, NULL, error);
}

tides_status td_event_writer_append(tides_event_writer *writer, const tides_event *events, const int64_t *fired, size_t count,
                                    td_pool *pool, tides_error *error) {
    if (!writer || (!events && count > 0))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_event_writer_append: an argument is NULL");
    if (writer->failure.status != TIDES_OK) return repeat_failure(writer, error);
    td_event_sink *sink = &writer->sink;
    if (count > 0 && sink->count == 0 && writer->format->begin) writer->format->begin(sink, events);
    tides_status status = td_event_check(writer->format, sink, events, count, error);
    if (status == TIDES_OK && sink->ticks) status = td_event_ticks_add(sink->ticks, events, count, error);
    if (status != TIDES_OK || count == 0) return status;
    sink->pool = pool;
    status = write_events(writer, events, fired, count);
    sink->pool = NULL;
    if (status != TIDES_OK) return repeat_failure(writer, error);
    sink->last = events[count - 1];
    sink->has_last = 1;
    sink->count += count;
    return TIDES_OK;
}

uint64_t tides_event_writer_count(const tides_event_writer *writer) { return writer->sink.count; }

uint64_t tides_event_writer_collapsed(const tides_event_writer *writer) { return td_event_ticks_collapsed(writer->sink.ticks); }

tides_status tides_event_writer_flush(tides_event_writer *writer, tides_error *error) {
    if (!writer) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_event_writer_flush: the writer is NULL");
    if (writer->failure.status != TIDES_OK) return repeat_failure(writer, error);
    if (!writer->format->flush)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: an interrupted recording goes on only in HDF5 (.h5), not in %s",
                       writer->sink.path, writer->format->summary);
    td_h5_quiet quiet;
    td_h5_quiet_begin(&quiet);
    tides_status status = writer->format->flush(&writer->sink, error);
    td_h5_quiet_end(&quiet);
    return status;
}

/* ---- ending ---- */

/* Completes the .part and closes it. */
static tides_status complete(tides_event_writer *writer, int64_t stop_ns) {
    td_event_sink *sink = &writer->sink;
    tides_status status = writer->failure.status;
    td_h5_quiet quiet;
    if (writer->format->library) td_h5_quiet_begin(&quiet);
    if (writer->format->complete && status == TIDES_OK)
        status = settle(writer, writer->format->complete(sink, stop_ns, &writer->failure));
    if (writer->format->library) td_h5_quiet_end(&quiet);
    if (sink->file) td_sink_flush(sink);
    errno = 0;
    if (sink->file && fclose(sink->file) != 0 && !sink->failed) sink->failed = errno ? errno : EIO;
    sink->file = NULL;
    return status == TIDES_OK ? settle(writer, status) : status;
}

tides_status tides_event_writer_finish(tides_event_writer *writer, int64_t stop_ns, tides_error *error) {
    if (!writer) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_event_writer_finish: the writer is NULL");
    tides_status status = complete(writer, stop_ns);
    if (status != TIDES_OK)
        repeat_failure(writer, error);
    else
        status = td_commit_or_keep(writer->sink.part, writer->sink.path, error);
    free_writer(writer);
    return status;
}

void tides_event_writer_abandon(tides_event_writer *writer) {
    if (!writer) return;
    if (writer->format->abandon) {
        td_h5_quiet quiet;
        td_h5_quiet_begin(&quiet);
        writer->format->abandon(&writer->sink);
        td_h5_quiet_end(&quiet);
    } else {
        int64_t stop = writer->sink.has_last ? writer->sink.last.t : 0;
        tides_status ignored = complete(writer, stop);
        (void)ignored; /* the result isn't used any more */
    }
    free_writer(writer);
}
