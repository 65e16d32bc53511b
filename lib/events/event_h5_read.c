/* Reads the events of HDF5 files, whatever their layout: columns of integers of any width, of real numbers, of booleans. */
#include "td_base.h"
#include "td_event_h5_source.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- blocks ---- */

/* Rows [first, first + count) of a column as 64-bit integers or doubles, so that nothing is clipped on the way. */
static herr_t read_rows(const td_h5_column *c, uint64_t first, size_t count, int64_t *out) {
    const hsize_t start[2] = {first, c->column < 0 ? 0 : (hsize_t)c->column}, rows[2] = {count, 1};
    hid_t type = H5Dget_type(c->dataset), memory = H5Screate_simple(1, rows, NULL), file = H5Dget_space(c->dataset);
    int bytes = type >= 0 && H5Tget_class(type) == H5T_ENUM; /* HDF5 has no conversion from enumerations */
    herr_t failed = -1;
    if (memory >= 0 && file >= 0 && H5Sselect_hyperslab(file, H5S_SELECT_SET, start, NULL, rows, NULL) >= 0)
        failed = H5Dread(c->dataset,
                         bytes     ? type
                         : c->real ? H5T_NATIVE_DOUBLE
                                   : H5T_NATIVE_INT64,
                         memory, file, H5P_DEFAULT, out);
    if (failed >= 0 && bytes) /* widened in place, from the last */
        for (size_t i = count; i-- > 0;) out[i] = ((const int8_t *)out)[i];
    td_h5_close(file);
    td_h5_close(memory);
    td_h5_close(type);
    return failed;
}

static tides_status read_column(const td_event_source *source, const td_h5_column *c, uint64_t first, size_t count,
                                int64_t *out, tides_error *error) {
    if (read_rows(c, first, count, out) >= 0) return TIDES_OK;
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

/* Replaces doubles by integers: times from seconds to nanoseconds, others as they are. */
static tides_status round_column(const td_event_source *source, const td_h5_column *c, int times, uint64_t first, size_t count,
                                 int64_t *values, tides_error *error) {
    for (size_t i = 0; c->real && i < count; i++) {
        double value;
        memcpy(&value, &values[i], sizeof value);
        if (!isfinite(value) || fabs(value) > 9e9 || (!times && value != floor(value)))
            return bad_real(source, c, first + i, value, times ? "seconds within 285 years" : "a whole number", error);
        values[i] = (int64_t)(times ? nearbyint(value * 1e9) : value);
    }
    return TIDES_OK;
}

static tides_status convert_time(const td_event_source *source, uint64_t row, int64_t stored, int64_t *ns, tides_error *error) {
    const td_h5_column *c = &source->columns[TD_H5_T];
    *ns = stored;
    if (source->nanoseconds || c->real) return TIDES_OK;
    const int64_t limit = INT64_MAX / 2000; /* of each, so that neither the sum nor the product overflows */
    if (stored > limit || stored < -limit || source->offset > limit || source->offset < -limit)
        return bad_row(source, c, row, stored, "microseconds that, with t_offset, fit 64-bit nanoseconds", error);
    *ns = (stored + source->offset) * 1000;
    return TIDES_OK;
}

static tides_status convert_rows(const td_event_source *source, uint64_t first, size_t count, int64_t *const columns[],
                                 tides_event *events, tides_error *error) {
    const td_h5_column *c = source->columns;
    for (size_t i = 0; i < count; i++) {
        int64_t p = columns[TD_H5_P][i], x = columns[TD_H5_X][i], y = columns[TD_H5_Y][i];
        if (p < -1 || p > 1) return bad_row(source, &c[TD_H5_P], first + i, p, "0 or 1 (or -1 and 1)", error);
        if (x < 0 || x > UINT16_MAX) return bad_row(source, &c[TD_H5_X], first + i, x, "0 to 65535", error);
        if (y < 0 || y > UINT16_MAX) return bad_row(source, &c[TD_H5_Y], first + i, y, "0 to 65535", error);
        events[i] = (tides_event){.x = (uint16_t)x, .y = (uint16_t)y, .polarity = p > 0 ? 1 : -1};
        tides_status status = convert_time(source, first + i, columns[TD_H5_T][i], &events[i].t, error);
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}

static tides_status read_block(td_event_source *source, uint64_t first, size_t count, tides_event *events, tides_error *error) {
    int64_t *columns[TD_H5_COLUMNS];
    for (int c = 0; c < TD_H5_COLUMNS; c++) {
        columns[c] = source->scratch + (size_t)c * TD_EVENT_CHUNK;
        tides_status status = read_column(source, &source->columns[c], first, count, columns[c], error);
        if (status == TIDES_OK)
            status = round_column(source, &source->columns[c], c == TD_H5_T, first, count, columns[c], error);
        if (status != TIDES_OK) return status;
    }
    return convert_rows(source, first, count, columns, events, error);
}

tides_status td_h5_source_read(td_event_source *source, uint64_t first, size_t count, tides_event *events, tides_error *error) {
    tides_status status = TIDES_OK;
    for (size_t done = 0; done < count && status == TIDES_OK;) {
        /* Blocks end on chunk borders: a chunk is decompressed once. */
        size_t block = TD_EVENT_CHUNK - (size_t)((first + done) % TD_EVENT_CHUNK);
        if (block > count - done) block = count - done;
        status = read_block(source, first + done, block, events + done, error);
        done += block;
    }
    return status;
}

/* ---- the format's side ---- */

int td_h5_detect(const td_event_probe *probe) { return probe->bytes >= 8 && memcmp(probe->head, "\x89HDF\r\n\x1a\n", 8) == 0; }

tides_status td_h5_open(td_event_stream *stream, tides_error *error) {
    td_event_source *source = td_alloc(1, sizeof *source, error);
    stream->state = source;
    return source ? td_h5_source_open(source, stream->input.path, &stream->facts, error) : TIDES_NO_MEMORY;
}

tides_status td_h5_read_from(td_event_stream *stream, uint64_t first, size_t count, tides_event *events, size_t *got,
                             tides_error *error) {
    td_event_source *source = stream->state;
    uint64_t there = first < source->count ? source->count - first : 0;
    if (there < count) count = (size_t)there;
    tides_status status = td_h5_source_read(source, first, count, events, error);
    if (status == TIDES_OK) *got = count;
    return status;
}

tides_status td_h5_read(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got, tides_error *error) {
    td_event_source *source = stream->state;
    tides_status status = td_h5_read_from(stream, source->next, capacity, events, got, error);
    source->next += *got;
    return status;
}

void td_h5_close_stream(td_event_stream *stream) {
    td_event_source *source = stream->state;
    if (source) td_h5_source_close(source);
    free(source);
}
