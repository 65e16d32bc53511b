/* Converts an event file (tides convert, tides cut): keeps events by time and place, sorts them, shifts them, and writes
 * them. */
#include "td_base.h"
#include "td_event_order.h"
#include "td_event_format.h"
#include "tides/convert.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    WINDOW = 65536, /* positions by which an event may be late; in recordings it is a few */
    BATCH = 8192
};

typedef struct converter {
    const char *in, *out;
    tides_event_conversion what;
    tides_event_reader *reader;
    tides_event_writer *writer;
    tides_filter *filter; /* NULL: none */
    tides_event *events;  /* room for 2 WINDOW; when it is full it is sorted, and the first half is written */
    size_t count;
    uint64_t sorted;             /* events that were sorted, filtered and taken out of `events` */
    int64_t sorted_ns;           /* time of the last one taken out */
    int32_t width, height;       /* of the sensor that is read [px] */
    int64_t before, first, last; /* [ns] time of the last event read; earliest and latest of all */
    int32_t started;             /* an event was read */
    tides_event_conversion_report report;
} converter;

void tides_event_conversion_defaults(tides_event_conversion *conversion) {
    *conversion = (tides_event_conversion){.start_ns = INT64_MIN, .stop_ns = INT64_MAX};
}

/* ---- order ---- */

static int compare(const void *a, const void *b) { return td_event_compare(a, b); }

static void sort_events(tides_event *events, size_t count) {
    for (size_t i = 1; i < count; i++) {
        if (td_event_compare(&events[i - 1], &events[i]) <= 0) continue;
        qsort(events, count, sizeof *events, compare);
        return;
    }
}

static tides_status write_first(converter *c, size_t count, tides_error *error) {
    sort_events(c->events, c->count);
    if (count == 0) return TIDES_OK;
    if (c->sorted > 0 && c->events[0].t < c->sorted_ns)
        return td_fail(error, TIDES_BAD_FILE, "%s: an event at %" PRId64 " ns is more than %d places late: sort the file first",
                       c->in, c->events[0].t, WINDOW);
    c->sorted += count;
    c->sorted_ns = c->events[count - 1].t;
    size_t kept = count;
    tides_status status = TIDES_OK;
    if (c->filter) status = tides_filter_apply(c->filter, c->events, NULL, count, &kept, error);
    if (status == TIDES_OK) status = tides_event_writer_append(c->writer, c->events, NULL, kept, error);
    if (kept > 0) {
        if (c->report.written == 0) c->report.first_ns = c->events[0].t;
        c->report.last_ns = c->events[kept - 1].t;
    }
    c->report.written += kept;
    c->count -= count;
    memmove(c->events, c->events + count, c->count * sizeof *c->events);
    return status;
}

/* ---- selection ---- */

static int moved(converter *c, tides_event *e) {
    const tides_event_conversion *w = &c->what;
    if (e->t < w->start_ns || e->t >= w->stop_ns) return 0;
    if (w->cut_width == 0) return 1;
    if (e->x < w->x || e->x - w->x >= w->cut_width || e->y < w->y || e->y - w->y >= w->cut_height) return 0;
    e->x = (uint16_t)(e->x - w->x);
    e->y = (uint16_t)(e->y - w->y);
    return 1;
}

/* 1 if the event lies outside the requested sensor size, which the file itself doesn't state. */
static int is_dropped(converter *c, const tides_event *e) {
    if (!c->what.drop_invalid || (e->x < c->width && e->y < c->height)) return 0;
    c->report.dropped++;
    return 1;
}

static tides_status take(converter *c, const tides_event *events, size_t count, tides_error *error) {
    for (size_t i = 0; i < count; i++) {
        tides_event e = events[i];
        if (c->started && e.t < c->before) c->report.disorder++;
        if (!c->started || e.t < c->first) c->first = e.t;
        if (!c->started || e.t > c->last) c->last = e.t;
        c->started = 1;
        c->before = e.t;
        if (is_dropped(c, &e) || !moved(c, &e)) continue;
        c->events[c->count++] = e;
        tides_status status = c->count == 2 * WINDOW ? write_first(c, WINDOW, error) : TIDES_OK;
        if (status != TIDES_OK) return status;
    }
    c->report.read += count;
    return TIDES_OK;
}

/* Fails if the requested span of time doesn't touch the recording. Such a span is meant on another clock, and an empty output
 * would hide the mistake. */
static tides_status check_stretch(const converter *c, tides_error *error) {
    const tides_event_conversion *w = &c->what;
    tides_event_facts facts;
    tides_event_reader_facts(c->reader, &facts);
    const int known = facts.start_ns < facts.stop_ns;
    int64_t first = c->started ? c->first : facts.start_ns, stop = c->started ? c->last + 1 : facts.stop_ns;
    if (known && facts.start_ns < first) first = facts.start_ns;
    if (known && facts.stop_ns > stop) stop = facts.stop_ns;
    if (!known && !c->started) return TIDES_OK;
    return tides_event_stretch_check(c->in, first, stop, w->start_ns, w->stop_ns, w->rebase, error);
}

/* ---- the sensor ---- */

static tides_status open_reader(const converter *c, tides_event_reader **reader, tides_error *error) {
    const tides_event_conversion *w = &c->what;
    tides_event_reading how;
    tides_event_reading_defaults(&how);
    how.format = w->from;
    how.columns = w->columns;
    how.unit = w->unit;
    how.stream = w->stream;
    how.drop_invalid = w->drop_invalid;
    how.rebase = w->rebase;
    how.offset_ns = w->offset_ns;
    return tides_event_reader_open_as(c->in, &how, reader, error);
}

/* The sensor's size: requested, or stated in the file, or as large as the events' coordinates; for the last, the file is read
 * twice. */
static tides_status find_size(converter *c, int32_t *width, int32_t *height, tides_error *error) {
    tides_event_facts facts;
    tides_event_reader_facts(c->reader, &facts);
    *width = c->what.width ? c->what.width : facts.width;
    *height = c->what.height ? c->what.height : facts.height;
    if (*width && *height) return TIDES_OK;
    tides_event_reader *again = NULL;
    tides_status status = open_reader(c, &again, error);
    int32_t right = 1, bottom = 1;
    for (size_t got = 1; got && status == TIDES_OK;) {
        status = tides_event_reader_read(again, c->events, 2 * WINDOW, &got, error);
        for (size_t i = 0; status == TIDES_OK && i < got; i++) {
            if (c->events[i].x >= right) right = c->events[i].x + 1;
            if (c->events[i].y >= bottom) bottom = c->events[i].y + 1;
        }
    }
    tides_event_reader_close(again);
    if (*width == 0) *width = right;
    if (*height == 0) *height = bottom;
    return status;
}

static tides_status open_writer(converter *c, tides_error *error) {
    int32_t width = 0, height = 0;
    const tides_event_conversion *w = &c->what;
    tides_status status = find_size(c, &width, &height, error);
    if (status != TIDES_OK) return status;
    if (w->cut_width && (w->x >= width || w->y >= height || w->cut_width > width - w->x || w->cut_height > height - w->y))
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: the window %d,%d,%d,%d doesn't lie within its %d x %d px", c->in, w->x,
                       w->y, w->cut_width, w->cut_height, width, height);
    const tides_event_file facts = {.width = w->cut_width ? w->cut_width : width,
                                    .height = w->cut_width ? w->cut_height : height};
    c->width = width;
    c->height = height;
    c->report.width = facts.width;
    c->report.height = facts.height;
    if (w->filters) status = tides_filter_create(w->filters, facts.width, facts.height, 0, &c->filter, error);
    return status == TIDES_OK ? tides_event_writer_open(c->out, w->to, &facts, &c->writer, error) : status;
}

/* ---- the whole ---- */

static tides_status pump(converter *c, tides_progress progress, void *user, tides_error *error) {
    tides_event *batch = td_alloc(BATCH, sizeof *batch, error);
    if (!batch) return TIDES_NO_MEMORY;
    tides_status status = TIDES_OK;
    for (size_t got = 1; got && status == TIDES_OK;) {
        status = tides_event_reader_read(c->reader, batch, BATCH, &got, error);
        if (status == TIDES_OK) status = take(c, batch, got, error);
        if (status == TIDES_OK && progress && progress(user, td_event_reader_part(c->reader), "events"))
            status = td_fail(error, TIDES_CANCELLED, "%s: stopped on request", c->out);
    }
    free(batch);
    if (status == TIDES_OK) status = check_stretch(c, error);
    return status == TIDES_OK ? write_first(c, c->count, error) : status;
}

/* Removes the unfinished output. The input still exists, so half an output has no use. */
static void remove_output(const char *out) {
    char *part = NULL;
    if (td_part_name(out, 1, &part, NULL) == TIDES_OK) td_remove_part(part, out);
    free(part);
}

static tides_status run(converter *c, tides_progress progress, void *user, tides_error *error) {
    c->events = td_alloc((size_t)2 * WINDOW, sizeof *c->events, error);
    if (!c->events) return TIDES_NO_MEMORY;
    tides_status status = open_reader(c, &c->reader, error);
    if (status == TIDES_OK) status = open_writer(c, error);
    if (status == TIDES_OK) status = pump(c, progress, user, error);
    if (status != TIDES_OK) return status;
    c->report.collapsed = tides_event_writer_collapsed(c->writer);
    tides_event_writer *writer = c->writer;
    c->writer = NULL; /* tides_event_writer_finish frees it in any case */
    status = tides_event_writer_finish(writer, c->report.last_ns, error);
    if (status != TIDES_OK) remove_output(c->out);
    return status;
}

static void report_formats(converter *c) {
    tides_event_facts facts;
    const td_event_format *to = NULL;
    tides_event_reader_facts(c->reader, &facts);
    memcpy(c->report.from, facts.format, sizeof c->report.from);
    memcpy(c->report.read_as, facts.read_as, sizeof c->report.read_as);
    c->report.labels = facts.labels;
    tides_filter_stats filters = {.in = 0};
    if (c->filter) tides_filter_stats_get(c->filter, &filters);
    memcpy(c->report.filtered, filters.dropped, sizeof c->report.filtered);
    c->report.read += facts.dropped;
    c->report.dropped += facts.dropped;
    c->report.zero = c->what.rebase ? facts.zero : 0;
    c->report.zero_ns = c->what.rebase ? facts.zero_ns : 0;
    if (c->what.to)
        snprintf(c->report.to, sizeof c->report.to, "%s", c->what.to);
    else if (td_event_format_for(c->out, &to, NULL) == TIDES_OK)
        snprintf(c->report.to, sizeof c->report.to, "%s", to->name);
}

static tides_status check_what(const tides_event_conversion *w, tides_error *error) {
    if (w->width < 0 || w->height < 0 || w->width > 65536 || w->height > 65536)
        return td_fail(error, TIDES_BAD_ARGUMENT, "a sensor of %d x %d px: give 1 to 65536", w->width, w->height);
    if (w->cut_width < 0 || w->cut_height < 0 || (w->cut_width == 0) != (w->cut_height == 0) || w->x < 0 || w->y < 0)
        return td_fail(error, TIDES_BAD_ARGUMENT, "the window %d,%d,%d,%d isn't x, y, width, height in pixels", w->x, w->y,
                       w->cut_width, w->cut_height);
    if (w->start_ns >= w->stop_ns) return td_fail(error, TIDES_BAD_ARGUMENT, "the stretch to keep ends before it begins");
    return TIDES_OK;
}

tides_status tides_events_convert(const char *in, const char *out, const tides_event_conversion *what, tides_progress progress,
                                  void *user, tides_event_conversion_report *report, tides_error *error) {
    if (!in || !out || !what) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_events_convert: an argument is NULL");
    tides_status status = check_what(what, error);
    if (status == TIDES_OK) status = tides_files_apart(&in, 1, &out, 1, error);
    if (status != TIDES_OK) return status;
    converter c = {.in = in, .out = out, .what = *what};
    status = run(&c, progress, user, error);
    if (status == TIDES_OK) report_formats(&c);
    if (c.writer) {
        tides_event_writer_abandon(c.writer);
        remove_output(out);
    }
    tides_event_reader_close(c.reader);
    tides_filter_destroy(c.filter);
    free(c.events);
    if (status == TIDES_OK && report) *report = c.report;
    return status;
}
