/* Reads the events of HDF5 files of any layout: columns of integers of any width, of floats, or of booleans. */
#include "td_base.h"
#include "td_event_h5_source.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- blocks ---- */

static tides_status read_column(const td_event_source *source, const td_h5_column *c, uint64_t first, size_t count,
                                int64_t *out, tides_error *error) {
    if (td_h5_column_rows(c, first, count, out) >= 0) return TIDES_OK;
    td_h5_reason reason;
    const char *text = td_h5_reason_text(&reason);
    return td_fail(error, TIDES_BAD_FILE, "%s: %s, rows %" PRIu64 " to %" PRIu64 ", can't be read: %s", source->path,
                   c->name + 1, first, first + count - 1, text);
}

/* ---- values ---- */

static tides_status bad_row(const td_event_source *source, const td_h5_column *c, uint64_t row, int64_t value, const char *want,
                            tides_error *error) {
    return td_fail(error, TIDES_BAD_FILE, "%s: %s of event %" PRIu64 " is %" PRId64 ": should be %s", source->path, c->name + 1,
                   row, value, want);
}

static tides_status bad_real(const td_event_source *source, const td_h5_column *c, uint64_t row, double value, const char *want,
                             tides_error *error) {
    return td_fail(error, TIDES_BAD_FILE, "%s: %s of event %" PRIu64 " is %g: should be %s", source->path, c->name + 1, row,
                   value, want);
}

static int64_t unit_of(const td_event_source *source) {
    int64_t unit = 1;
    for (int i = 0; i < source->digits; i++) unit *= 10;
    return unit;
}

/* Converts a stored value to an integer; a time in floats becomes nanoseconds. */
static tides_status take_value(const td_event_source *source, int column, uint64_t row, int64_t stored, int64_t *out,
                               tides_error *error) {
    const td_h5_column *c = &source->columns[column];
    const int times = column == TD_H5_T;
    const double unit = times ? (double)unit_of(source) : 1.0;
    double value;
    *out = stored;
    if (!c->real) return TIDES_OK;
    memcpy(&value, &stored, sizeof value);
    if (!isfinite(value) || fabs(value) * unit > 9e18 || (!times && value != floor(value)))
        return bad_real(source, c, row, value, times ? "a time within 285 years" : "a whole number", error);
    *out = (int64_t)(times ? nearbyint(value * unit) : value);
    return TIDES_OK;
}

static tides_status take_time(const td_event_source *source, uint64_t row, int64_t stored, int64_t *ns, tides_error *error) {
    const td_h5_column *c = &source->columns[TD_H5_T];
    tides_status status = take_value(source, TD_H5_T, row, stored, ns, error);
    if (status != TIDES_OK || source->nanoseconds || c->real) return status;
    /* the limit holds for the time and for the offset, so that neither their sum nor its product with the unit overflows */
    const int64_t unit = unit_of(source), limit = INT64_MAX / (2 * unit);
    if (stored > limit || stored < -limit || source->offset > limit || source->offset < -limit)
        return bad_row(source, c, row, stored, "a time that, with t_offset, fits 64-bit nanoseconds", error);
    *ns = (stored + source->offset) * unit;
    return TIDES_OK;
}

static tides_status take_row(const td_event_source *source, uint64_t row, const int64_t stored[TD_H5_COLUMNS], tides_event *e,
                             tides_error *error) {
    const td_h5_column *c = source->columns;
    int64_t v[TD_H5_COLUMNS] = {0};
    *e = (tides_event){0};
    for (int k = 0; k < TD_H5_COLUMNS; k++) {
        tides_status status = k == TD_H5_T ? take_time(source, row, stored[k], &e->t, error)
                                           : take_value(source, k, row, stored[k], &v[k], error);
        if (status != TIDES_OK) return status;
    }
    if (source->wraps && v[TD_H5_P] == c[TD_H5_P].wrapped) v[TD_H5_P] = -1;
    if (v[TD_H5_P] < -1 || v[TD_H5_P] > 1) return bad_row(source, &c[TD_H5_P], row, v[TD_H5_P], "0 or 1 (or -1 and 1)", error);
    for (int k = TD_H5_X; k <= TD_H5_Y; k++)
        if (v[k] < 0 || v[k] > UINT16_MAX) return bad_row(source, &c[k], row, v[k], "0 to 65535", error);
    e->x = (uint16_t)v[TD_H5_X];
    e->y = (uint16_t)v[TD_H5_Y];
    e->polarity = v[TD_H5_P] > 0 ? 1 : -1;
    return TIDES_OK;
}

/* Converts `count` rows to `*got` events: fewer if the stream allows to leave out invalid ones. */
static tides_status convert_rows(const td_event_source *source, td_event_stream *stream, uint64_t first, size_t count,
                                 tides_event *events, size_t *got, tides_error *error) {
    for (size_t i = 0; i < count; i++) {
        int64_t stored[TD_H5_COLUMNS];
        for (int c = 0; c < TD_H5_COLUMNS; c++) stored[c] = source->scratch[(size_t)c * TD_EVENT_CHUNK + i];
        tides_status status = take_row(source, first + i, stored, &events[*got], error);
        const int whole = status == TIDES_OK;
        if (!whole && stream) status = td_event_invalid(stream, status, error);
        if (status != TIDES_OK) return status;
        *got += (size_t)whole;
    }
    return TIDES_OK;
}

tides_status td_h5_source_read(td_event_source *source, td_event_stream *stream, uint64_t first, size_t count,
                               tides_event *events, size_t *got, tides_error *error) {
    tides_status status = TIDES_OK;
    *got = 0;
    for (size_t done = 0; done < count && status == TIDES_OK;) {
        /* Blocks end on chunk borders, so that each chunk is decompressed only once. */
        size_t block = TD_EVENT_CHUNK - (size_t)((first + done) % TD_EVENT_CHUNK);
        if (block > count - done) block = count - done;
        for (int c = 0; c < TD_H5_COLUMNS && status == TIDES_OK; c++)
            status = read_column(source, &source->columns[c], first + done, block, source->scratch + (size_t)c * TD_EVENT_CHUNK,
                                 error);
        if (status == TIDES_OK) status = convert_rows(source, stream, first + done, block, events, got, error);
        done += block;
    }
    return status;
}

/* ---- functions of the format ---- */

int td_h5_detect(const td_event_probe *probe) { return probe->bytes >= 8 && memcmp(probe->head, "\x89HDF\r\n\x1a\n", 8) == 0; }

tides_status td_h5_open(td_event_stream *stream, tides_error *error) {
    td_event_source *source = td_alloc(1, sizeof *source, error);
    stream->state = source;
    return source ? td_h5_source_open(source, stream->input.path, &stream->reading, &stream->facts, error) : TIDES_NO_MEMORY;
}

tides_status td_h5_read_from(td_event_stream *stream, uint64_t first, size_t count, tides_event *events, size_t *got,
                             tides_error *error) {
    td_event_source *source = stream->state;
    uint64_t there = first < source->count ? source->count - first : 0;
    if (there < count) count = (size_t)there;
    return td_h5_source_read(source, stream, first, count, events, got, error);
}

/* Reads the next events. If all events of a block are left out it reads on: 0 events only mean the end. */
tides_status td_h5_read(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got, tides_error *error) {
    td_event_source *source = stream->state;
    tides_status status = TIDES_OK;
    while (status == TIDES_OK && *got == 0 && source->next < source->count) {
        status = td_h5_read_from(stream, source->next, capacity, events, got, error);
        source->next += capacity < source->count - source->next ? capacity : source->count - source->next;
    }
    return status;
}

void td_h5_close_stream(td_event_stream *stream) {
    td_event_source *source = stream->state;
    if (source) td_h5_source_close(source);
    free(source);
}
