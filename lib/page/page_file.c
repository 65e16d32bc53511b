/* Writes the page of an event file: reads events in batches, with their labels and ground truth. */
#include "events/td_event_format.h"
#include "td_base.h"
#include "td_folder.h"
#include "td_page.h"
#include "td_struct.h"

#include <stdlib.h>
#include <string.h>

enum { BATCH = 65536 }; /* events read at once */

typedef struct source {
    const char *path;
    tides_event_reader *reader;
    tides_event_facts facts;
    tides_event *events;
    tides_event_truth *truth;  /* NULL: none in the file */
    int64_t first_ns, last_ns; /* of the events read so far */
} source;

static tides_status open_source(source *s, const tides_page_options *options, tides_error *error) {
    tides_event_reading how;
    tides_event_reading_defaults(&how);
    how.format = options->format;
    s->events = td_alloc(BATCH, sizeof *s->events, error);
    if (!s->events) return TIDES_NO_MEMORY;
    tides_status status = tides_event_reader_open_as(s->path, options->reading ? options->reading : &how, &s->reader, error);
    if (status != TIDES_OK) return status;
    tides_event_reader_facts(s->reader, &s->facts);
    tides_error no_truth;
    status = tides_events_truth(s->path, 0, 0, NULL, &no_truth);
    if (status == TIDES_UNSUPPORTED) return TIDES_OK;
    if (status != TIDES_OK) return td_fail(error, status, "%s", no_truth.text);
    s->truth = td_alloc(BATCH, sizeof *s->truth, error);
    return s->truth ? TIDES_OK : TIDES_NO_MEMORY;
}

static void close_source(source *s) {
    tides_event_reader_close(s->reader);
    free(s->events);
    free(s->truth);
}

/* 1 if any event of a batch is shown: only then are its labels and truth read. All are tested, since they may be out of
 * order. */
static int any_shown(const source *s, size_t count, const tides_page_options *o) {
    for (size_t i = 0; i < count; i++)
        if (s->events[i].t >= o->start_ns && s->events[i].t < o->stop_ns) return 1;
    return 0;
}

static void add_stretch(source *s, uint64_t row, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const int64_t t = s->events[i].t;
        if (row + i == 0 || t < s->first_ns) s->first_ns = t;
        if (row + i == 0 || t > s->last_ns) s->last_ns = t;
    }
}

/* Fails if the requested span is empty though the recording isn't: the span was probably given for another clock. */
static tides_status check_stretch(const source *s, const td_page *page, uint64_t rows, tides_error *error) {
    const tides_page_options *o = &page->options;
    if (rows == 0 || page->report.events) return TIDES_OK;
    const int known = s->facts.start_ns < s->facts.stop_ns;
    const int64_t first = known && s->facts.start_ns < s->first_ns ? s->facts.start_ns : s->first_ns;
    const int64_t end = known && s->facts.stop_ns > s->last_ns ? s->facts.stop_ns : s->last_ns + 1;
    return tides_event_stretch_check(s->path, first, end, o->start_ns, o->stop_ns, o->reading && o->reading->rebase, error);
}

static tides_status pump(source *s, td_page *page, tides_progress progress, void *user, tides_error *error) {
    tides_status status = TIDES_OK;
    uint64_t row = 0;
    for (size_t got = 1; got && status == TIDES_OK && !page->report.ended; row += got) {
        status = tides_event_reader_read(s->reader, s->events, BATCH, &got, error);
        if (status == TIDES_OK) add_stretch(s, row, got);
        const int shown = status == TIDES_OK && any_shown(s, got, &page->options);
        if (shown && s->facts.labels & TIDES_LABEL_CAUSE)
            status = tides_events_labels(s->path, row, got, s->events, NULL, error);
        if (status == TIDES_OK && shown && s->truth) status = tides_events_truth(s->path, row, got, s->truth, error);
        if (status == TIDES_OK) status = td_page_append(page, s->events, s->truth, got, error);
        if (status == TIDES_OK && progress && progress(user, td_event_reader_part(s->reader), "events"))
            status = td_fail(error, TIDES_CANCELLED, "%s: stopped on request", page->text.path);
    }
    return status == TIDES_OK ? check_stretch(s, page, row, error) : status;
}

/* Fills options that were left open from the file. */
static void fill_in(td_page *page, const source *s) {
    tides_page_options *o = &page->options;
    const char *name = td_base_name(s->path);
    if (!o->title) o->title = *name ? name : s->path;
    if (!o->width) o->width = s->facts.width;
    if (!o->height) o->height = s->facts.height;
    page->known_start = s->facts.start_ns;
    page->known_stop = s->facts.stop_ns;
}

tides_status tides_page_write_file(const char *events, const char *path, const tides_page_options *options,
                                   tides_progress progress, void *user, tides_page_report *report, tides_error *error) {
    if (!path || !events) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_page_write_file: an argument is NULL");
    source s = {.path = events};
    td_page page;
    tides_page_options given;
    tides_page_options_defaults(&given);
    tides_status status = options ? TD_TAKE_STRUCT(tides_page_options, &given, options, error) : TIDES_OK;
    if (status == TIDES_OK) status = tides_files_apart(&events, 1, &path, 1, error);
    if (status == TIDES_OK) status = open_source(&s, &given, error);
    if (status != TIDES_OK) {
        close_source(&s);
        return status;
    }
    status = td_page_begin(&page, path, options, s.truth != NULL, error);
    if (status == TIDES_OK) fill_in(&page, &s);
    if (status == TIDES_OK) status = pump(&s, &page, progress, user, error);
    status = td_page_end(&page, status, error);
    close_source(&s);
    if (status == TIDES_OK && report) *report = page.report;
    return status;
}
