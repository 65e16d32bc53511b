/* Numpy's files: .npy with one structured array whose fields are t, x, y and p (tonic's dtype), times in microseconds; .npz
 * with one array per column:
 *   keys x, y, t, p                        t in nanoseconds (rpg_vid2e, and what is written here)
 *   the same, coordinates beyond 8191      HS-ERGB: coordinates are 1/32 px, t in microseconds
 *   keys x, y, timestamp, polarity         BS-ERGB: the same, and what lies left of or above the image wraps around 65536
 * HS-ERGB whose events all lie below 8192 / 32 px can't be told from the first: the format "ergb" says it. */
#include "archive/td_npy.h"
#include "archive/td_zip.h"
#include "td_base.h"
#include "td_endian.h"
#include "td_event_format.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    COLUMN_T,
    COLUMN_X,
    COLUMN_Y,
    COLUMN_P,
    COLUMNS,
    FINE = 32,           /* steps per pixel of HS-ERGB and BS-ERGB */
    FINE_WRAP = 65536,   /* where BS-ERGB's unsigned coordinates wrap around */
    LARGEST_PLAIN = 8191 /* no sensor has more pixels: larger coordinates are fine ones */
};

typedef struct npy_column {
    const td_npy_array *array;
    const td_npy_field *field;
} npy_column;

typedef struct npy_state {
    td_npz *npz;
    npy_column columns[COLUMNS];
    size_t count, next;
    int32_t fine;  /* coordinates are 1/32 px */
    int64_t limit; /* of x and y beyond which they wrap; 0: none do */
    int64_t unit;  /* [ns] of integer times */
} npy_state;

static int detect_npy(const td_event_probe *probe) { return probe->bytes >= 6 && memcmp(probe->head, "\x93NUMPY", 6) == 0; }
static int detect_npz(const td_event_probe *probe) { return td_zip_is(probe->head, probe->bytes); }

/* ---- opening ---- */

static tides_status open_archive(td_event_stream *stream, tides_error *error) {
    npy_state *state = td_alloc(1, sizeof *state, error);
    stream->state = state;
    return state ? td_npz_open(stream->input.path, &state->npz, error) : TIDES_NO_MEMORY;
}

static void close_npy(td_event_stream *stream) {
    npy_state *state = stream->state;
    if (state) td_npz_close(state->npz);
    free(state);
}

static void count_events(td_event_stream *stream, size_t count) {
    npy_state *state = stream->state;
    state->count = count;
    stream->facts.counted = 1;
    stream->facts.count = count;
}

static tides_status open_npy(td_event_stream *stream, tides_error *error) {
    static const char *const names[COLUMNS][2] = {{"t", "timestamp"}, {"x", "x"}, {"y", "y"}, {"p", "polarity"}};
    const td_npy_array *array = NULL;
    tides_status status = open_archive(stream, error);
    if (status != TIDES_OK) return status;
    npy_state *state = stream->state;
    status = td_npz_get(state->npz, "data", &array, error);
    if (status != TIDES_OK) return status;
    for (int c = 0; c < COLUMNS; c++) {
        const td_npy_field *field = td_npy_find_field(array, names[c][0]);
        if (!field) field = td_npy_find_field(array, names[c][1]);
        state->columns[c] = (npy_column){array, field};
        if (array->ndim != 1 || !field || array->field_count < COLUMNS)
            return td_fail(error, TIDES_BAD_FILE,
                           "%s: should be one structured array with the fields t, x, y and p, not %.120s", stream->input.path,
                           array->dtype);
    }
    state->unit = 1000;
    count_events(stream, array->count);
    return TIDES_OK;
}

static int holds(const npy_state *state, const char *name) {
    for (size_t i = 0; i < td_npz_count(state->npz); i++)
        if (strcmp(td_npz_name(state->npz, i), name) == 0) return 1;
    return 0;
}

static tides_status open_column(td_event_stream *stream, int column, const char *name, tides_error *error) {
    npy_state *state = stream->state;
    npy_column *c = &state->columns[column];
    tides_status status = td_npz_get(state->npz, name, &c->array, error);
    if (status != TIDES_OK) return status;
    c->field = td_npy_find_field(c->array, NULL);
    if (c->array->ndim != 1 || !c->field || c->array->count != state->columns[COLUMN_T].array->count)
        return td_fail(error, TIDES_BAD_FILE, "%s: array %s should be one column of numbers, as long as that of the times",
                       stream->input.path, name);
    return TIDES_OK;
}

static tides_status open_columns(td_event_stream *stream, tides_error *error) {
    tides_status status = open_archive(stream, error);
    if (status != TIDES_OK) return status;
    npy_state *state = stream->state;
    int long_names = holds(state, "timestamp"); /* BS-ERGB's */
    const char *const names[COLUMNS] = {long_names ? "timestamp" : "t", "x", "y", long_names ? "polarity" : "p"};
    for (int c = 0; c < COLUMNS && status == TIDES_OK; c++) status = open_column(stream, c, names[c], error);
    if (status != TIDES_OK) return status;
    count_events(stream, state->columns[COLUMN_T].array->count);
    return TIDES_OK;
}

/* The coordinate of an event as it is stored, integer or real; 0 where it is no number. */
static int stored(const npy_column *c, size_t index, double *value) { return td_npy_number(c->array, c->field, index, value); }

static int has_large(const npy_state *state) {
    for (size_t i = 0; i < state->count; i++) {
        double x, y;
        if (stored(&state->columns[COLUMN_X], i, &x) && x > LARGEST_PLAIN) return 1;
        if (stored(&state->columns[COLUMN_Y], i, &y) && y > LARGEST_PLAIN) return 1;
    }
    return 0;
}

tides_status td_event_npz_is_fine(const char *path, int *fine, tides_error *error) {
    td_event_stream stream = {.input = {.path = path}};
    tides_status status = open_columns(&stream, error);
    if (status == TIDES_OK) *fine = holds(stream.state, "timestamp") || has_large(stream.state);
    close_npy(&stream);
    return status;
}

static tides_status open_ergb(td_event_stream *stream, tides_error *error) {
    tides_status status = open_columns(stream, error);
    if (status != TIDES_OK) return status;
    npy_state *state = stream->state;
    state->fine = 1;
    state->unit = 1000;
    /* Of 16 bits, the upper fifth is what wrapped: images are 970 px wide, 31040 in 1/32 px. */
    state->limit = holds(state, "timestamp") ? 52429 : 0;
    snprintf(stream->facts.format, sizeof stream->facts.format, "%s", state->limit ? "bs-ergb" : "hs-ergb");
    return TIDES_OK;
}

static tides_status open_npz(td_event_stream *stream, tides_error *error) {
    tides_status status = open_columns(stream, error);
    if (status != TIDES_OK) return status;
    npy_state *state = stream->state;
    if (holds(state, "timestamp") || has_large(state)) {
        close_npy(stream);
        stream->state = NULL;
        return open_ergb(stream, error);
    }
    state->unit = 1;
    return TIDES_OK;
}

/* ---- reading ---- */

static tides_status bad_value(const td_event_stream *stream, size_t index, const char *what, tides_error *error) {
    return td_event_bad(stream, index, what, error);
}

/* To the nearest pixel; what lies beyond the first is clipped to it. */
static int take_coordinate(const npy_state *state, int column, size_t index, uint16_t *out) {
    double value;
    if (!stored(&state->columns[column], index, &value) || !(value >= -FINE_WRAP && value <= FINE_WRAP)) return 0;
    if (state->fine) {
        if (state->limit && value > (double)state->limit) value -= FINE_WRAP;
        value = floor(value / FINE + 0.5);
        if (value < 0) value = 0;
    } else if (value != floor(value)) {
        return 0;
    }
    if (value < 0 || value > UINT16_MAX) return 0;
    *out = (uint16_t)value;
    return 1;
}

/* Integers in the file's unit, real numbers in seconds. */
static int take_time(const npy_state *state, size_t index, int64_t *ns) {
    const npy_column *c = &state->columns[COLUMN_T];
    int64_t value;
    double seconds;
    if (td_npy_integer(c->array, c->field, index, &value)) {
        if (value > INT64_MAX / state->unit || value < INT64_MIN / state->unit) return 0;
        *ns = value * state->unit;
        return 1;
    }
    if (!stored(c, index, &seconds) || !(fabs(seconds) < 9e9)) return 0;
    *ns = (int64_t)nearbyint(seconds * 1e9);
    return 1;
}

static tides_status read_npy(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got, tides_error *error) {
    npy_state *state = stream->state;
    for (; *got < capacity && state->next < state->count; state->next++, ++*got) {
        tides_event *e = &events[*got];
        size_t i = state->next;
        double p;
        *e = (tides_event){0};
        if (!take_time(state, i, &e->t)) return bad_value(stream, i, "has a time that is no number within 292 years", error);
        if (!take_coordinate(state, COLUMN_X, i, &e->x) || !take_coordinate(state, COLUMN_Y, i, &e->y))
            return bad_value(stream, i, "has a coordinate that is no whole number from 0 to 65535", error);
        if (!stored(&state->columns[COLUMN_P], i, &p) || !(p >= -1 && p <= 1))
            return bad_value(stream, i, "has a polarity that isn't 0 or 1 (or -1 and 1)", error);
        e->polarity = p > 0 ? 1 : -1;
    }
    return TIDES_OK;
}

/* ---- writing .npy ---- */

/* Bytes of a packed row, 8 for t, 2 for x, 2 for y, 1 for p; rows written at once. */
enum { RECORD = 13, ROWS = 4096 };

typedef struct npy_writer {
    td_npy_writer *file;
    FILE *spool; /* .npz: the events, until their columns are written one after the other */
    unsigned char rows[ROWS * 16];
} npy_writer;

static void discard_npy(td_event_sink *sink) {
    npy_writer *w = sink->state;
    if (!w) return;
    td_npy_writer_discard(w->file);
    if (w->spool) fclose(w->spool);
    free(w);
}

/* The library writes beside the name that it is given, which is our .part. */
static tides_status create_writer(td_event_sink *sink, int zipped, tides_error *error) {
    npy_writer *w = td_alloc(1, sizeof *w, error);
    sink->state = w;
    return w ? td_npy_writer_open(sink->part, zipped, &w->file, error) : TIDES_NO_MEMORY;
}

/* Polarity as int8: tonic's voxel grids lose it where it is bool. Coordinates as int16, which tonic's own readers give. */
static tides_status create_npy(td_event_sink *sink, tides_error *error) {
    tides_status status = create_writer(sink, 0, error);
    npy_writer *w = sink->state;
    return status == TIDES_OK ? td_npy_writer_begin(w->file, "data", "[('x', '<i2'), ('y', '<i2'), ('t', '<i8'), ('p', '|i1')]",
                                                    RECORD, 1, NULL, error)
                              : status;
}

static tides_status write_npy(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error) {
    npy_writer *w = sink->state;
    tides_status status = TIDES_OK;
    for (size_t done = 0; done < count && status == TIDES_OK;) {
        size_t some = count - done < ROWS ? count - done : ROWS;
        for (size_t i = 0; i < some; i++) {
            const tides_event *e = &events[done + i];
            unsigned char *p = w->rows + RECORD * i;
            td_put_le16(p, e->x);
            td_put_le16(p + 2, e->y);
            td_put_le64(p + 4, (uint64_t)(e->t / 1000));
            p[12] = e->polarity > 0;
        }
        status = td_npy_writer_append(w->file, w->rows, some, error);
        done += some;
    }
    return status;
}

static tides_status complete_npy(td_event_sink *sink, int64_t stop_ns, tides_error *error) {
    (void)stop_ns;
    npy_writer *w = sink->state;
    td_npy_writer *file = w->file;
    w->file = NULL; /* gone in any case */
    return td_npy_writer_close(file, error);
}

/* ---- writing .npz ---- */

static tides_status create_npz(td_event_sink *sink, tides_error *error) {
    tides_status status = create_writer(sink, 1, error);
    npy_writer *w = sink->state;
    if (status != TIDES_OK) return status;
    char *name = td_format(error, "%s.spool", sink->part);
    if (!name) return TIDES_NO_MEMORY;
    w->spool = td_part_open(name, sink->path);
    if (!w->spool) status = td_fail(error, TIDES_WRITE_FAILED, "%s: can't be created: %s", name, strerror(errno));
    remove(name); /* it lives as long as it is open */
    free(name);
    return status;
}

static tides_status write_npz(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error) {
    npy_writer *w = sink->state;
    if (fwrite(events, sizeof *events, count, w->spool) == count) return TIDES_OK;
    return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: the space for its columns is full", sink->part);
}

static size_t put_field(unsigned char *out, const tides_event *e, int column) {
    switch (column) {
        case COLUMN_T: td_put_le64(out, (uint64_t)e->t); return 8;
        case COLUMN_X: td_put_le16(out, e->x); return 2;
        case COLUMN_Y: td_put_le16(out, e->y); return 2;
        default: out[0] = (unsigned char)e->polarity; return 1;
    }
}

static tides_status write_column(npy_writer *w, int column, tides_error *error) {
    tides_event events[256];
    tides_status status = TIDES_OK;
    rewind(w->spool);
    for (size_t got = 1; got && status == TIDES_OK;) {
        unsigned char *out = w->rows;
        got = fread(events, sizeof *events, sizeof events / sizeof *events, w->spool);
        for (size_t i = 0; i < got; i++) out += put_field(out, &events[i], column);
        if (got) status = td_npy_writer_append(w->file, w->rows, got, error);
    }
    return status;
}

static tides_status complete_npz(td_event_sink *sink, int64_t stop_ns, tides_error *error) {
    static const struct {
        const char *name, *dtype;
        size_t bytes;
    } arrays[COLUMNS] = {{"t", "'<i8'", 8}, {"x", "'<u2'", 2}, {"y", "'<u2'", 2}, {"p", "'|i1'", 1}};
    npy_writer *w = sink->state;
    if (fflush(w->spool) != 0) return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: its disk is full", sink->part);
    for (int c = 0; c < COLUMNS; c++) {
        tides_status status = td_npy_writer_begin(w->file, arrays[c].name, arrays[c].dtype, arrays[c].bytes, 1, NULL, error);
        if (status == TIDES_OK) status = write_column(w, c, error);
        if (status != TIDES_OK) return status;
    }
    return complete_npy(sink, stop_ns, error);
}

const td_event_format td_format_npy = {
    .name = "npy",
    .endings = ".npy",
    .summary = "numpy's structured array x, y, t [us], p (tonic)",
    .tick_ns = 1000,
    .size_limit = 32768,
    .library = 1,
    .detect = detect_npy,
    .open = open_npy,
    .read = read_npy,
    .close = close_npy,
    .create = create_npy,
    .write = write_npy,
    .complete = complete_npy,
    .discard = discard_npy,
};

const td_event_format td_format_npz = {
    .name = "npz",
    .endings = ".npz",
    .summary = "numpy's arrays t [ns], x, y, p (rpg_vid2e); reads HS-ERGB and BS-ERGB too",
    .tick_ns = 1,
    .size_limit = LARGEST_PLAIN + 1, /* or it would be read as HS-ERGB */
    .library = 1,
    .detect = detect_npz,
    .open = open_npz,
    .read = read_npy,
    .close = close_npy,
    .create = create_npz,
    .write = write_npz,
    .complete = complete_npz,
    .discard = discard_npy,
};

const td_event_format td_format_ergb = {
    .name = "ergb",
    .summary = "numpy's arrays of HS-ERGB and BS-ERGB, coordinates in 1/32 px",
    .library = 1,
    .open = open_ergb,
    .read = read_npy,
    .close = close_npy,
};
