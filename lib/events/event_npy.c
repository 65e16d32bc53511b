/* Reads numpy's files. A .npy has one structured array (tonic's dtype, Metavision's, or fields of other usual names) or a table
 * of four columns. A .npz has one such array, or one array per column:
 *   keys t, x, y, p                t in nanoseconds (rpg_vid2e, TIDES); in microseconds if nanoseconds would mean hundreds of
 *                                  events per pixel and second
 *   with coordinates above 8191    HS-ERGB: coordinates are 1/32 px, t in microseconds
 *   x, y, timestamp, polarity,     BS-ERGB: the units of HS-ERGB; coordinates left of or above the image wrap around 65536
 *   coordinates above 8191
 * HS-ERGB files with all events below 8192 / 32 px look like the first kind: the format name "ergb" settles it. */
#include "archive/td_npy.h"
#include "archive/td_zip.h"
#include "td_base.h"
#include "td_event_npy.h"
#include "td_event_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    FINE = 32,         /* units of a coordinate per pixel, in HS-ERGB and BS-ERGB */
    FINE_WRAP = 65536, /* BS-ERGB's unsigned coordinates wrap around here */
    BUSY = 300,        /* mean events per pixel and second; no recording has so many */
    JUDGED = 1000      /* events needed to judge a rate */
};

static const int fields[TD_NPY_COLUMNS] =
    {[TD_NPY_T] = TD_ROW_T, [TD_NPY_X] = TD_ROW_X, [TD_NPY_Y] = TD_ROW_Y, [TD_NPY_P] = TD_ROW_P};

/* Value number i is element number stride * i + offset of the array. */
typedef struct npy_column {
    const td_npy_array *array;
    const td_npy_field *field;
    size_t stride, offset;
} npy_column;

typedef struct npy_state {
    td_npz *npz;
    npy_column columns[TD_NPY_COLUMNS];
    size_t count, next;
    int32_t fine;   /* coordinates are 1/32 px */
    int64_t limit;  /* x and y beyond it have wrapped; 0: none have */
    int32_t digits; /* 10^digits [ns] is the unit of times; -1: not known yet */
} npy_state;

static int detect_npy(const td_event_probe *probe) { return probe->bytes >= 6 && memcmp(probe->head, "\x93NUMPY", 6) == 0; }
static int detect_npz(const td_event_probe *probe) { return td_zip_is(probe->head, probe->bytes); }

/* ---- values ---- */

static int stored(const npy_column *c, size_t index, double *value) {
    return td_npy_number(c->array, c->field, c->stride * index + c->offset, value);
}

static void sample(const npy_column *c, size_t count, td_table_column *facts) {
    memset(facts, 0, sizeof *facts);
    for (size_t i = 0; i < count && i < TD_TABLE_SAMPLE; i++) {
        double value;
        if (stored(c, i, &value) && isfinite(value)) td_table_add(facts, value, 0);
    }
}

static int has_large(const npy_state *state) {
    for (size_t i = 0; i < state->count; i++) {
        double x, y;
        if (stored(&state->columns[TD_NPY_X], i, &x) && x > TD_TABLE_COORDINATE) return 1;
        if (stored(&state->columns[TD_NPY_Y], i, &y) && y > TD_TABLE_COORDINATE) return 1;
    }
    return 0;
}

/* ---- columns ---- */

static tides_status open_archive(td_event_stream *stream, tides_error *error) {
    npy_state *state = td_alloc(1, sizeof *state, error);
    stream->state = state;
    if (!state) return TIDES_NO_MEMORY;
    state->digits = -1;
    return td_npz_open(stream->input.path, &state->npz, error);
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

/* Appends a name to a list of names in a row, as in a text file's header. */
static void add_name(char list[TD_TABLE_COLUMNS_MAX * TD_NPY_NAME_MAX], const char *name) {
    const size_t length = strlen(list);
    snprintf(list + length, TD_TABLE_COLUMNS_MAX * TD_NPY_NAME_MAX - length, "%s%s", length ? "," : "",
             strpbrk(name, ",;\"\t ") ? "-" : name);
}

static tides_status find_names(const char *list, td_table_meaning *meaning, tides_error *error) {
    td_columns named;
    td_columns_parse(list, &named);
    return td_table_named(&named, meaning, error);
}

static tides_status open_structured(td_event_stream *stream, const td_npy_array *array, tides_error *error) {
    npy_state *state = stream->state;
    char list[TD_TABLE_COLUMNS_MAX * TD_NPY_NAME_MAX] = "";
    td_table_meaning meaning;
    for (size_t i = 0; i < array->field_count && i < TD_TABLE_COLUMNS_MAX; i++) add_name(list, array->fields[i].name);
    if (array->ndim != 1 || find_names(list, &meaning, NULL) != TIDES_OK)
        return td_fail(error, TIDES_BAD_FILE,
                       "%s: should be one structured array with the fields t, x, y and p, or a table of four columns, not "
                       "%.120s",
                       stream->input.path, array->dtype);
    for (int c = 0; c < TD_NPY_COLUMNS; c++)
        state->columns[c] = (npy_column){array, &array->fields[meaning.column[fields[c]]], 1, 0};
    state->digits = meaning.digits;
    count_events(stream, array->count);
    return TIDES_OK;
}

/* Opens a table (N, 4): columns in the caller's order, or found from the values. */
static tides_status open_table(td_event_stream *stream, const td_npy_array *array, tides_error *error) {
    npy_state *state = stream->state;
    const char *said = stream->reading.columns;
    td_table_column facts[TD_ROW_FIELDS];
    td_table_meaning meaning;
    tides_error reason = {TIDES_OK, ""};
    char order[16];
    count_events(stream, array->shape[0]);
    const npy_column first = {array, td_npy_find_field(array, NULL), 4, 0};
    for (int c = 0; c < TD_ROW_FIELDS; c++) {
        npy_column one = first;
        one.offset = (size_t)c;
        sample(&one, state->count, &facts[c]);
    }
    tides_status status =
        said ? find_names(said, &meaning, &reason) : td_table_guess(facts, TD_ROW_FIELDS, &meaning, order, &reason);
    for (int f = 0; f < TD_ROW_FIELDS && status == TIDES_OK; f++)
        if (meaning.column[f] >= TD_ROW_FIELDS) status = td_fail(&reason, TIDES_BAD_FILE, "names more than four columns");
    if (status != TIDES_OK) return td_fail(error, status, "%s: %s", stream->input.path, reason.text);
    if (!said) snprintf(stream->facts.read_as, sizeof stream->facts.read_as, "columns %s, told apart by their values", order);
    for (int c = 0; c < TD_NPY_COLUMNS; c++) {
        state->columns[c] = first;
        state->columns[c].offset = (size_t)meaning.column[fields[c]];
    }
    state->digits = meaning.digits;
    return TIDES_OK;
}

static tides_status named_columns(const td_event_stream *stream, tides_error *error) {
    return td_fail(error, TIDES_BAD_ARGUMENT, "%s: its columns have names: leave --columns (columns) out", stream->input.path);
}

static int is_table(const td_npy_array *array) {
    return array->ndim == 2 && array->shape[1] == 4 && array->field_count == 1 && td_npy_find_field(array, NULL);
}

static tides_status open_single(td_event_stream *stream, const char *name, tides_error *error) {
    npy_state *state = stream->state;
    const td_npy_array *array = NULL;
    tides_status status = td_npz_get(state->npz, name, &array, error);
    if (status != TIDES_OK) return status;
    if (is_table(array)) return open_table(stream, array, error);
    return stream->reading.columns ? named_columns(stream, error) : open_structured(stream, array, error);
}

static tides_status open_column(td_event_stream *stream, int column, const char *name, tides_error *error) {
    npy_state *state = stream->state;
    npy_column *c = &state->columns[column];
    tides_status status = td_npz_get(state->npz, name, &c->array, error);
    if (status != TIDES_OK) return status;
    c->stride = 1;
    c->offset = 0;
    c->field = td_npy_find_field(c->array, NULL);
    if (c->array->ndim != 1 || !c->field || c->array->count != state->columns[TD_NPY_T].array->count)
        return td_fail(error, TIDES_BAD_FILE, "%s: array %s should be one column of numbers, as long as that of the times",
                       stream->input.path, name);
    return TIDES_OK;
}

/* Opens one array per column. `*time` is the name of the array of times. */
static tides_status open_columns(td_event_stream *stream, const char **time, tides_error *error) {
    char list[TD_TABLE_COLUMNS_MAX * TD_NPY_NAME_MAX] = "";
    td_table_meaning meaning;
    tides_error reason = {TIDES_OK, ""};
    tides_status status = open_archive(stream, error);
    if (status != TIDES_OK) return status;
    npy_state *state = stream->state;
    *time = "";
    const size_t arrays = td_npz_count(state->npz);
    if (arrays == 1) return open_single(stream, td_npz_name(state->npz, 0), error);
    if (stream->reading.columns) return named_columns(stream, error);
    for (size_t i = 0; i < arrays && i < TD_TABLE_COLUMNS_MAX; i++) add_name(list, td_npz_name(state->npz, i));
    if (find_names(list, &meaning, &reason) != TIDES_OK) /* its advice behind the colon is a table's */
        return td_fail(error, TIDES_BAD_FILE,
                       "%s: of arrays t, x, y and p it %.*s: write them by these names, or as one table (N, 4)",
                       stream->input.path, (int)strcspn(reason.text, ":"), reason.text);
    for (int c = 0; c < TD_NPY_COLUMNS && status == TIDES_OK; c++)
        status = open_column(stream, c, td_npz_name(state->npz, (size_t)meaning.column[fields[c]]), error);
    if (status != TIDES_OK) return status;
    *time = td_npz_name(state->npz, (size_t)meaning.column[TD_ROW_T]);
    state->digits = meaning.digits;
    count_events(stream, state->columns[TD_NPY_T].array->count);
    return TIDES_OK;
}

tides_status td_event_npz_is_fine(const char *path, int *fine, tides_error *error) {
    td_event_stream stream = {.input = {.path = path}};
    const char *time = "";
    tides_status status = open_columns(&stream, &time, error);
    if (status == TIDES_OK) *fine = strcmp(time, "timestamp") == 0 || has_large(stream.state);
    close_npy(&stream);
    return status;
}

/* ---- the unit of times ---- */

/* 1 if times are implausible as nanoseconds. Whole numbers called t are nanoseconds in files of rpg_vid2e and TIDES, but
 * microseconds in other tools' files. Microseconds read as nanoseconds give a thousand times the rate of events. */
static int busy_as_nanoseconds(const npy_state *state) {
    double first = INFINITY, last = -INFINITY, right = 1, bottom = 1;
    for (size_t i = 0; i < state->count; i++) {
        double t, x, y;
        if (!stored(&state->columns[TD_NPY_T], i, &t) || !stored(&state->columns[TD_NPY_X], i, &x) ||
            !stored(&state->columns[TD_NPY_Y], i, &y))
            continue;
        first = fmin(first, t);
        last = fmax(last, t);
        right = fmax(right, x + 1);
        bottom = fmax(bottom, y + 1);
    }
    return state->count >= JUDGED && last > first && (double)state->count > BUSY * right * bottom * 1e-9 * (last - first);
}

/* Finds the unit. `whole`: digits of the unit of whole numbers; -1: found from the values. */
static tides_status find_unit(td_event_stream *stream, int whole, tides_error *error) {
    npy_state *state = stream->state;
    const td_npy_field *field = state->columns[TD_NPY_T].field;
    td_table_column facts;
    tides_error reason = {TIDES_OK, ""};
    if (stream->reading.unit) return td_table_unit_named(stream->reading.unit, &state->digits, error);
    if (state->digits >= 0) return TIDES_OK;
    state->digits = whole;
    if (whole >= 0 && field->kind != 'f') return TIDES_OK;
    sample(&state->columns[TD_NPY_T], state->count, &facts);
    if (td_table_unit(&facts, 1, &state->digits, &reason) != TIDES_OK)
        return td_fail(error, TIDES_BAD_FILE, "%s: %s", stream->input.path, reason.text);
    td_table_tell_unit(&facts, state->digits, 0, stream->facts.read_as, sizeof stream->facts.read_as);
    td_table_tell_falls(&facts, state->digits, stream->facts.read_as, sizeof stream->facts.read_as);
    return TIDES_OK;
}

/* ---- opening ---- */

static tides_status open_npy(td_event_stream *stream, tides_error *error) {
    tides_status status = open_archive(stream, error);
    if (status == TIDES_OK) status = open_single(stream, "data", error);
    if (status != TIDES_OK) return status;
    const npy_column *t = &((npy_state *)stream->state)->columns[TD_NPY_T];
    td_table_column facts;
    sample(t, ((npy_state *)stream->state)->count, &facts);
    /* tonic's and Metavision's arrays: microseconds, however rare the events */
    const int usual = t->stride == 1 && fabs(facts.most) < 1e17;
    const int32_t said = ((npy_state *)stream->state)->digits >= 0 || stream->reading.unit;
    status = find_unit(stream, usual ? 3 : -1, error);
    if (status == TIDES_OK && usual && !said && t->field->kind != 'f')
        td_table_tell_unit(&facts, 3, 1, stream->facts.read_as, sizeof stream->facts.read_as);
    return status;
}

static tides_status set_fine(td_event_stream *stream, const char *time, tides_error *error) {
    npy_state *state = stream->state;
    state->fine = 1;
    /* Values in the upper fifth of 16 bits have wrapped: images are 970 px wide, which is 31040 in 1/32 px. */
    state->limit = strcmp(time, "timestamp") == 0 ? 52429 : 0;
    snprintf(stream->facts.format, sizeof stream->facts.format, "%s", state->limit ? "bs-ergb" : "hs-ergb");
    return find_unit(stream, 3, error);
}

static tides_status open_ergb(td_event_stream *stream, tides_error *error) {
    const char *time = "";
    tides_status status = open_columns(stream, &time, error);
    return status == TIDES_OK ? set_fine(stream, time, error) : status;
}

/* 1 if the arrays have the types that TIDES writes; then times are nanoseconds, however dense the events. rpg_vid2e has other
 * types. */
static int is_ours(const npy_state *state) {
    static const char *const types[TD_NPY_COLUMNS] =
        {[TD_NPY_T] = "<i8", [TD_NPY_X] = "<u2", [TD_NPY_Y] = "<u2", [TD_NPY_P] = "|i1"};
    int ours = 1;
    for (int k = 0; k < TD_NPY_COLUMNS; k++) ours = ours && strcmp(state->columns[k].array->dtype, types[k]) == 0;
    return ours;
}

static tides_status open_npz(td_event_stream *stream, tides_error *error) {
    const char *time = "";
    tides_status status = open_columns(stream, &time, error);
    if (status != TIDES_OK) return status;
    npy_state *state = stream->state;
    if (has_large(state)) return set_fine(stream, time, error);
    char *told = stream->facts.read_as;
    if (strcmp(time, "timestamp") == 0 && !told[0])
        snprintf(told, sizeof stream->facts.read_as, "coordinates taken as whole pixels: --from ergb for BS-ERGB's 1/32 px");
    if (strcmp(time, "t") != 0 || state->digits >= 0 || stream->reading.unit) return find_unit(stream, -1, error);
    const int ours = is_ours(state), busy = !ours && busy_as_nanoseconds(state);
    const int whole = state->columns[TD_NPY_T].field->kind != 'f';
    if (busy)
        snprintf(told, sizeof stream->facts.read_as,
                 "times taken as microseconds: as nanoseconds each pixel would have over %d events a second; --unit says "
                 "another",
                 BUSY);
    else if (!ours && whole)
        snprintf(told, sizeof stream->facts.read_as, "times taken as nanoseconds, as rpg_vid2e has them: --unit says another");
    return find_unit(stream, busy ? 3 : 0, error);
}

/* ---- reading ---- */

/* Rounds a coordinate to the nearest pixel; places left of or above the first pixel are clipped to it. */
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

static int take_time(const npy_state *state, size_t index, int64_t *ns) {
    const npy_column *c = &state->columns[TD_NPY_T];
    int64_t value, unit = 1;
    double real;
    for (int i = 0; i < state->digits; i++) unit *= 10;
    if (td_npy_integer(c->array, c->field, c->stride * index + c->offset, &value)) {
        if (value > INT64_MAX / unit || value < INT64_MIN / unit) return 0;
        *ns = value * unit;
        return 1;
    }
    if (!stored(c, index, &real) || !(fabs(real) * (double)unit < 9e18)) return 0;
    *ns = (int64_t)nearbyint(real * (double)unit);
    return 1;
}

static tides_status take_event(const td_event_stream *stream, size_t i, tides_event *e, tides_error *error) {
    const npy_state *state = stream->state;
    double p;
    *e = (tides_event){0};
    if (!take_time(state, i, &e->t)) return td_event_bad(stream, i, "has a time that is no number within 292 years", error);
    if (!take_coordinate(state, TD_NPY_X, i, &e->x) || !take_coordinate(state, TD_NPY_Y, i, &e->y))
        return td_event_bad(stream, i, "has a coordinate that is no whole number from 0 to 65535", error);
    if (!stored(&state->columns[TD_NPY_P], i, &p) || !(p >= -1 && p <= 1))
        return td_event_bad(stream, i, "has a polarity that isn't 0 or 1 (or -1 and 1)", error);
    e->polarity = p > 0 ? 1 : -1;
    return TIDES_OK;
}

static tides_status read_npy(td_event_stream *stream, tides_event *events, size_t capacity, size_t *got, tides_error *error) {
    npy_state *state = stream->state;
    for (; *got < capacity && state->next < state->count; state->next++) {
        tides_status status = take_event(stream, state->next, &events[*got], error);
        const int whole = status == TIDES_OK;
        if (!whole) status = td_event_invalid(stream, status, error);
        if (status != TIDES_OK) return status;
        *got += (size_t)whole;
    }
    return TIDES_OK;
}

const td_event_format td_format_npy = {
    .name = "npy",
    .endings = ".npy",
    .summary = "numpy's structured array x, y, t [us], p (tonic)",
    .tick_ns = 1000,
    .size_limit = 32768,
    .library = 1,
    .takes = TD_TAKES_UNIT | TD_TAKES_COLUMNS,
    .detect = detect_npy,
    .open = open_npy,
    .read = read_npy,
    .close = close_npy,
    .create = td_event_npy_create,
    .write = td_event_npy_write,
    .complete = td_event_npy_complete,
    .discard = td_event_npy_discard,
};

const td_event_format td_format_npz = {
    .name = "npz",
    .endings = ".npz",
    .summary = "numpy's arrays t [ns], x, y, p (rpg_vid2e); reads HS-ERGB and BS-ERGB too",
    .tick_ns = 1,
    .size_limit = TD_TABLE_COORDINATE + 1, /* larger coordinates would be read as HS-ERGB's */
    .library = 1,
    .takes = TD_TAKES_UNIT | TD_TAKES_COLUMNS,
    .detect = detect_npz,
    .open = open_npz,
    .read = read_npy,
    .close = close_npy,
    .create = td_event_npz_create,
    .write = td_event_npz_write,
    .complete = td_event_npz_complete,
    .discard = td_event_npy_discard,
};

const td_event_format td_format_ergb = {
    .name = "ergb",
    .summary = "numpy's arrays of HS-ERGB and BS-ERGB, coordinates in 1/32 px",
    .library = 1,
    .takes = TD_TAKES_UNIT,
    .open = open_ergb,
    .read = read_npy,
    .close = close_npy,
};
