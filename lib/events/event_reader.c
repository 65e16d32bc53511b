/* Reading event files of any format, behind tides_event_reader: what is the same for all of them: order, bounds, blocks. The
 * bytes are each format's own. */
#include "td_event_format.h"
#include "td_event_h5.h"
#include "td_folder.h"
#include "td_kinds.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { BATCH = 4096 }; /* events that a format is asked for at once; every format can give 32 into less */

struct tides_event_reader {
    const td_event_format *format;
    td_event_stream stream;
    tides_error failure; /* the first: told again by every later call */
    size_t held, taken;  /* events in batch; handed out */
    tides_event batch[BATCH];
};

/* ---- opening ---- */

static tides_status choose(tides_event_reader *reader, const char *path, const char *name, tides_error *error) {
    const td_event_format **format = &reader->format;
    tides_status status = name ? td_event_format_named(name, format, error) : td_event_format_detect(path, format, error);
    if (status != TIDES_OK) return status;
    if (!(*format)->read)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: files of the format \"%s\" are only written", path, (*format)->name);
    if (name && td_is_folder(path)) {
        reader->stream.named = *format;
        *format = &td_format_folder;
    }
    return TIDES_OK;
}

static tides_status open_stream(tides_event_reader *reader, const char *path, tides_error *error) {
    td_event_stream *stream = &reader->stream;
    snprintf(stream->facts.format, sizeof stream->facts.format, "%s", reader->format->name);
    if (!reader->format->library) {
        tides_status status = td_input_open(&stream->input, path, error);
        return status == TIDES_OK ? reader->format->open(stream, error) : status;
    }
    stream->input.path = path;
    td_h5_quiet quiet;
    td_h5_quiet_begin(&quiet);
    tides_status status = reader->format->open(stream, error);
    td_h5_quiet_end(&quiet);
    return status;
}

tides_status tides_event_reader_open(const char *path, const char *format, tides_event_reader **reader, tides_error *error) {
    if (!path || !reader) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_event_reader_open: an argument is NULL");
    tides_event_reader *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    tides_status status = choose(made, path, format, error);
    char *kept = status == TIDES_OK ? td_strdup(path, error) : NULL;
    if (status == TIDES_OK) status = kept ? open_stream(made, kept, error) : TIDES_NO_MEMORY;
    if (status == TIDES_OK) {
        *reader = made;
        return TIDES_OK;
    }
    if (kept) made->stream.input.path = kept;
    if (!kept) made->format = NULL; /* nothing was opened */
    tides_event_reader_close(made);
    return td_kind_judge(path, TD_WANTS_EVENTS, status, error); /* a ZIP may hold anything */
}

void tides_event_reader_close(tides_event_reader *reader) {
    if (!reader) return;
    const char *path = reader->stream.input.path;
    if (reader->format) {
        td_h5_quiet quiet;
        td_h5_quiet_begin(&quiet);
        reader->format->close(&reader->stream);
        td_h5_quiet_end(&quiet);
        td_input_close(&reader->stream.input);
    }
    free((char *)(uintptr_t)path); /* our copy */
    free(reader);
}

void tides_event_reader_facts(const tides_event_reader *reader, tides_event_facts *facts) { *facts = reader->stream.facts; }

/* ---- reading ---- */

/* Formats give what they find; whether it fits the sensor that the file itself names is the same question for all. */
static tides_status check_batch(const tides_event_reader *reader, size_t count, tides_error *error) {
    const tides_event_facts *facts = &reader->stream.facts;
    if (facts->width == 0) return TIDES_OK;
    for (size_t i = 0; i < count; i++) {
        const tides_event *e = &reader->batch[i];
        if (e->x < facts->width && e->y < facts->height) continue;
        return td_fail(error, TIDES_BAD_FILE,
                       "%s: event %" PRIu64 " at (%u, %u) lies outside the %d x %d px that the file itself says",
                       reader->stream.input.path, reader->stream.done + i, e->x, e->y, facts->width, facts->height);
    }
    return TIDES_OK;
}

/* Events before a failure are handed out first. */
static void fill_batch(tides_event_reader *reader) {
    size_t got = 0;
    td_h5_quiet quiet;
    if (reader->format->library) td_h5_quiet_begin(&quiet);
    tides_status status = reader->format->read(&reader->stream, reader->batch, BATCH, &got, &reader->failure);
    if (reader->format->library) td_h5_quiet_end(&quiet);
    if (status == TIDES_OK) reader->failure.status = TIDES_OK;
    tides_error outside = {TIDES_OK, ""};
    if (check_batch(reader, got, &outside) != TIDES_OK) {
        reader->failure = outside;
        for (got = 0; reader->batch[got].x < reader->stream.facts.width && reader->batch[got].y < reader->stream.facts.height;)
            got++;
    }
    reader->stream.done += got;
    reader->held = got;
    reader->taken = 0;
}

tides_status tides_event_reader_read(tides_event_reader *reader, tides_event *events, size_t capacity, size_t *got,
                                     tides_error *error) {
    if (!reader || !got || (!events && capacity > 0))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_event_reader_read: an argument is NULL");
    *got = 0;
    while (*got < capacity) {
        if (reader->taken == reader->held && reader->failure.status == TIDES_OK) fill_batch(reader);
        if (reader->taken == reader->held) break;
        size_t room = capacity - *got, there = reader->held - reader->taken, count = there < room ? there : room;
        memcpy(events + *got, reader->batch + reader->taken, count * sizeof *events);
        reader->taken += count;
        *got += count;
    }
    if (*got > 0 || capacity == 0 || reader->failure.status == TIDES_OK) return TIDES_OK;
    return td_fail(error, reader->failure.status, "%s", reader->failure.text);
}

double td_event_reader_part(const tides_event_reader *reader) {
    const td_event_stream *stream = &reader->stream;
    if (stream->facts.counted) return stream->facts.count ? (double)stream->done / (double)stream->facts.count : 1.0;
    return stream->input.size ? (double)stream->input.at / (double)stream->input.size : -1.0;
}

/* ---- whole files ---- */

static void add_event(tides_event_summary *s, const tides_event *e, int64_t before) {
    if (s->count == 0) s->first_ns = s->last_ns = e->t;
    if (s->count > 0 && e->t < before) s->disorder++;
    if (e->t < s->first_ns) s->first_ns = e->t;
    if (e->t > s->last_ns) s->last_ns = e->t;
    if (e->x >= s->right) s->right = e->x + 1;
    if (e->y >= s->bottom) s->bottom = e->y + 1;
    s->count_on += e->polarity > 0;
    s->count++;
}

static tides_status summarise(tides_event_reader *reader, tides_event_summary *summary, tides_error *error) {
    tides_event events[1024];
    int64_t before = 0;
    for (;;) {
        size_t got = 0;
        tides_status status = tides_event_reader_read(reader, events, sizeof events / sizeof *events, &got, error);
        if (status != TIDES_OK || got == 0) return status;
        for (size_t i = 0; i < got; i++) {
            add_event(summary, &events[i], before);
            before = events[i].t;
        }
    }
}

tides_status tides_events_summary(const char *path, tides_event_summary *summary, tides_error *error) {
    if (!path || !summary) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_events_summary: an argument is NULL");
    tides_event_reader *reader = NULL;
    tides_event_summary made = {0};
    tides_status status = tides_event_reader_open(path, NULL, &reader, error);
    if (status != TIDES_OK) return status;
    const tides_event_facts *facts = &reader->stream.facts;
    made.width = facts->width;
    made.height = facts->height;
    made.labels = facts->labels;
    memcpy(made.layout, facts->format, sizeof made.layout);
    memcpy(made.version, facts->version, sizeof made.version);
    status = summarise(reader, &made, error);
    tides_event_reader_close(reader);
    if (status == TIDES_OK) *summary = made;
    return status;
}

/* From the beginning on, in whole. */
static tides_status read_on(tides_event_reader *reader, uint64_t first, size_t count, tides_event *events, size_t *got,
                            tides_error *error) {
    tides_event passed[1024];
    size_t done = 0, some = 1;
    tides_status status = TIDES_OK;
    for (uint64_t at = 0; at < first && some && status == TIDES_OK; at += some) {
        size_t wanted = first - at < 1024 ? (size_t)(first - at) : 1024;
        status = tides_event_reader_read(reader, passed, wanted, &some, error);
    }
    while (status == TIDES_OK && done < count && some) {
        status = tides_event_reader_read(reader, events + done, count - done, &some, error);
        done += some;
    }
    if (status == TIDES_OK) *got = done;
    return status;
}

tides_status tides_events_read(const char *path, uint64_t first, size_t count, tides_event *events, size_t *got,
                               tides_error *error) {
    if (!path || !got || (!events && count > 0))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_events_read: an argument is NULL");
    tides_event_reader *reader = NULL;
    tides_status status = tides_event_reader_open(path, NULL, &reader, error);
    if (status != TIDES_OK) return status;
    td_h5_quiet quiet;
    td_h5_quiet_begin(&quiet);
    if (reader->format == &td_format_hdf5)
        status = td_h5_read_from(&reader->stream, first, count, events, got, error);
    else
        status = read_on(reader, first, count, events, got, error);
    td_h5_quiet_end(&quiet);
    tides_event_reader_close(reader);
    return status;
}
