/* Reads event files of any format: checks order and bounds, applies the options for times, and hands out blocks. Each format
 * decodes its own bytes. */
#include "td_event_format.h"
#include "td_event_h5.h"
#include "td_folder.h"
#include "td_kinds.h"
#include "td_struct.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { BATCH = 4096 }; /* events requested from a format at once; a format may need room for 32 */

struct tides_event_reader {
    const td_event_format *format;
    td_event_stream stream;
    char *texts[3]; /* copies of the options' texts: columns, unit, stream */
    int64_t shift;  /* [ns] added to all times, once `placed` */
    int32_t placed;
    tides_error failure; /* the first failure, repeated by every later call */
    size_t held, taken;  /* events in batch; events handed out of it */
    tides_event batch[BATCH];
};

/* ---- opening ---- */

static tides_status choose(tides_event_reader *reader, const char *path, tides_error *error) {
    const td_event_format **format = &reader->format;
    const tides_event_reading *how = &reader->stream.reading;
    tides_status status =
        how->format ? td_event_format_named(how->format, format, error) : td_event_format_detect(path, how, format, error);
    if (status != TIDES_OK) return status;
    if (!(*format)->read)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: files of the format \"%s\" are only written", path, (*format)->name);
    if (how->format && td_is_folder(path)) {
        reader->stream.named = *format;
        *format = &td_format_folder;
    }
    return TIDES_OK;
}

/* Refuses an option that has no meaning for the file's format: it would be ignored in silence. */
static tides_status check_use(const td_event_format *format, const char *path, const tides_event_reading *how,
                              tides_error *error) {
    const struct {
        int32_t flag;
        const char *given, *what;
    } all[] = {{TD_TAKES_COLUMNS, how->columns, "columns (--columns) are"},
               {TD_TAKES_UNIT, how->unit, "a unit of times (--unit) is"},
               {TD_TAKES_STREAM, how->stream, "a stream's name (--stream) is"}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (all[i].given && !(format->takes & all[i].flag))
            return td_fail(error, TIDES_BAD_ARGUMENT, "%s: is %s, for which %s of no use: leave it out", path, format->name,
                           all[i].what);
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

void tides_event_reading_defaults(tides_event_reading *reading) { *reading = (tides_event_reading){.size = sizeof *reading}; }

/* Copies the options' texts, which the caller may free: a folder uses them until its last file. */
static tides_status keep_reading(tides_event_reader *reader, const tides_event_reading *given, tides_error *error) {
    tides_event_reading *how = &reader->stream.reading;
    tides_event_reading_defaults(how);
    tides_status status = given ? TD_TAKE_STRUCT(tides_event_reading, how, given, error) : TIDES_OK;
    if (status == TIDES_OK && ((how->rebase | 1) != 1 || (how->drop_invalid | 1) != 1))
        status = td_fail(error, TIDES_BAD_ARGUMENT, "tides_event_reading: rebase = %d, drop_invalid = %d: should be 0 or 1",
                         how->rebase, how->drop_invalid);
    const char **const texts[3] = {&how->columns, &how->unit, &how->stream};
    for (int i = 0; i < 3 && status == TIDES_OK; i++) {
        if (!*texts[i]) continue;
        *texts[i] = reader->texts[i] = td_strdup(*texts[i], error);
        if (!reader->texts[i]) status = TIDES_NO_MEMORY;
    }
    return status;
}

tides_status tides_event_reader_open_as(const char *path, const tides_event_reading *reading, tides_event_reader **reader,
                                        tides_error *error) {
    if (!path || !reader) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_event_reader_open: an argument is NULL");
    tides_event_reader *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    tides_status status = keep_reading(made, reading, error);
    if (status == TIDES_OK) status = choose(made, path, error);
    if (status == TIDES_OK) status = check_use(made->format, path, &made->stream.reading, error);
    char *kept = status == TIDES_OK ? td_strdup(path, error) : NULL;
    if (status == TIDES_OK) status = kept ? open_stream(made, kept, error) : TIDES_NO_MEMORY;
    if (status == TIDES_OK) {
        made->stream.reading.format = NULL; /* the caller's text, not needed any more */
        *reader = made;
        return TIDES_OK;
    }
    if (kept) made->stream.input.path = kept;
    if (!kept) made->format = NULL; /* nothing was opened */
    tides_event_reader_close(made);
    return td_kind_judge(path, TD_WANTS_EVENTS, status, error); /* a ZIP may hold anything */
}

tides_status tides_event_reader_open(const char *path, const char *format, tides_event_reader **reader, tides_error *error) {
    tides_event_reading reading;
    tides_event_reading_defaults(&reading);
    reading.format = format;
    return tides_event_reader_open_as(path, &reading, reader, error);
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
    for (int i = 0; i < 3; i++) free(reader->texts[i]);
    free((char *)(uintptr_t)path); /* a copy made here */
    free(reader);
}

/* Adds two times; 0 if the sum overflows 64 bits. */
static int add_time(int64_t a, int64_t b, int64_t *sum) {
    if (b > 0 ? a > INT64_MAX - b : a < INT64_MIN - b) return 0;
    *sum = a + b;
    return 1;
}

/* Finds the shift for the file's times; 0 if it overflows 64 bits. */
static int find_shift(const td_event_stream *stream, int64_t *shift) {
    const tides_event_reading *how = &stream->reading;
    if (how->rebase && stream->facts.zero_ns == INT64_MIN) return 0;
    return add_time(how->offset_ns, how->rebase ? -stream->facts.zero_ns : 0, shift);
}

void tides_event_reader_facts(const tides_event_reader *reader, tides_event_facts *facts) {
    const td_event_stream *stream = &reader->stream;
    *facts = stream->facts;
    int64_t shift = 0;
    if (facts->start_ns == facts->stop_ns) return;
    if (!find_shift(stream, &shift) || !add_time(facts->start_ns, shift, &facts->start_ns) ||
        !add_time(facts->stop_ns, shift, &facts->stop_ns))
        facts->start_ns = facts->stop_ns = 0;
}

/* ---- reading ---- */

/* Checks that events fit the sensor's size in the file. `*good` events precede the first that doesn't fit; or all that fit,
 * if others are left out. */
static tides_status check_batch(tides_event_reader *reader, size_t count, size_t *good, tides_error *error) {
    td_event_stream *stream = &reader->stream;
    const tides_event_facts *facts = &stream->facts;
    size_t kept = 0;
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < count && status == TIDES_OK; i++) {
        const tides_event *e = &reader->batch[i];
        if (facts->width == 0 || (e->x < facts->width && e->y < facts->height)) {
            reader->batch[kept++] = *e;
            continue;
        }
        status = td_fail(error, TIDES_BAD_FILE,
                         "%s: event %" PRIu64 " at (%u, %u) lies outside the %d x %d px that the file itself says",
                         stream->input.path, td_event_number(stream, kept), e->x, e->y, facts->width, facts->height);
        status = td_event_invalid(stream, status, error);
    }
    *good = kept;
    return status;
}

/* Sets the zero to the first event, or to the first frame in a list beside the file. The frame counts only within a second of
 * the first event, since its list may have another clock. */
static void find_zero(tides_event_facts *facts, const char *path, int64_t first) {
    int64_t frame;
    facts->zero_ns = first;
    if (!td_event_first_frame(path, &frame) || frame < 0 || first < 0) return;
    if ((frame > first ? frame - first : first - frame) > 1000000000) return;
    facts->zero = TIDES_ZERO_FRAME;
    facts->zero_ns = frame;
}

/* Shifts times to the requested clock. If that counts from the first event, its time is known now. */
static tides_status place(tides_event_reader *reader, size_t count, tides_error *error) {
    td_event_stream *stream = &reader->stream;
    int fits = 1;
    if (!reader->placed && count) {
        if (stream->facts.zero == TIDES_ZERO_EVENT) find_zero(&stream->facts, stream->input.path, reader->batch[0].t);
        fits = find_shift(stream, &reader->shift);
        reader->placed = 1;
    }
    for (size_t i = 0; i < count && reader->shift && fits; i++)
        fits = add_time(reader->batch[i].t, reader->shift, &reader->batch[i].t);
    return fits ? TIDES_OK : td_fail(error, TIDES_BAD_FILE, "%s: spans more than 292 years", stream->input.path);
}

/* Asks the format for its next events. If it fails, the events before the failure are still given. */
static tides_status ask_format(tides_event_reader *reader, size_t *got, tides_error *error) {
    td_h5_quiet quiet;
    if (reader->format->library) td_h5_quiet_begin(&quiet);
    tides_status status = reader->format->read(&reader->stream, reader->batch, BATCH, got, error);
    if (reader->format->library) td_h5_quiet_end(&quiet);
    return status;
}

/* Fills the batch. Events before a failure are handed out first. If all events of a batch are left out, it reads on. */
static void fill_batch(tides_event_reader *reader) {
    size_t got = 0, good = 0;
    tides_status status = TIDES_OK;
    do {
        got = good = 0;
        status = ask_format(reader, &got, &reader->failure);
        if (status == TIDES_OK) reader->failure.status = TIDES_OK;
        tides_error outside = {TIDES_OK, ""};
        tides_status checked = check_batch(reader, got, &good, &outside);
        if (checked == TIDES_OK) checked = place(reader, good, &outside);
        if (checked != TIDES_OK) reader->failure = outside;
        if (checked != TIDES_OK) status = checked;
        reader->stream.done += good;
    } while (status == TIDES_OK && got && !good);
    reader->held = good;
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

tides_status tides_event_reader_summary(tides_event_reader *reader, tides_event_summary *summary, tides_error *error) {
    if (!reader || !summary) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_event_reader_summary: an argument is NULL");
    tides_event_summary made = {0};
    tides_status status = summarise(reader, &made, error);
    if (status != TIDES_OK) return status;
    const tides_event_facts *facts = &reader->stream.facts; /* some formats know the size only after reading all */
    made.width = facts->width;
    made.height = facts->height;
    made.labels = facts->labels;
    memcpy(made.layout, facts->format, sizeof made.layout);
    memcpy(made.version, facts->version, sizeof made.version);
    *summary = made;
    return TIDES_OK;
}

tides_status tides_events_summary(const char *path, tides_event_summary *summary, tides_error *error) {
    if (!path || !summary) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_events_summary: an argument is NULL");
    tides_event_reader *reader = NULL;
    tides_status status = tides_event_reader_open(path, NULL, &reader, error);
    if (status == TIDES_OK) status = tides_event_reader_summary(reader, summary, error);
    tides_event_reader_close(reader);
    return status;
}

/* Reads from the beginning, for formats that can't seek. */
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
    size_t some = 0;
    td_h5_quiet_begin(&quiet);
    if (reader->format == &td_format_hdf5)
        status = td_h5_read_from(&reader->stream, first, count, events, &some, error);
    else
        status = read_on(reader, first, count, events, &some, error);
    if (status == TIDES_OK) *got = some;
    td_h5_quiet_end(&quiet);
    tides_event_reader_close(reader);
    return status;
}
