/* Finds out the order of a table's columns and the unit of its times, for HDF5 event files whose layout doesn't define them. */
#include "td_base.h"
#include "td_event_h5_source.h"
#include "td_event_table.h"

#include <math.h>
#include <string.h>

static const int fields[TD_H5_COLUMNS] =
    {[TD_H5_P] = TD_ROW_P, [TD_H5_T] = TD_ROW_T, [TD_H5_X] = TD_ROW_X, [TD_H5_Y] = TD_ROW_Y};

/* Samples the first values of a column. In an unsigned column, the largest value counts as -1. */
static herr_t sample(const td_event_source *source, const td_h5_column *c, td_table_column *facts, int *wrapped) {
    const size_t count = source->count < TD_TABLE_SAMPLE ? (size_t)source->count : TD_TABLE_SAMPLE;
    memset(facts, 0, sizeof *facts);
    if (count && td_h5_column_rows(c, 0, count, source->scratch) < 0) return -1;
    for (size_t i = 0; i < count; i++) {
        double value = (double)source->scratch[i];
        if (c->real) memcpy(&value, &source->scratch[i], sizeof value);
        const int is_wrapped = c->wrapped && source->scratch[i] == c->wrapped;
        if (wrapped) *wrapped |= is_wrapped;
        if (isfinite(value)) td_table_add(facts, is_wrapped ? -1 : value, 0);
    }
    return 0;
}

/* Finds an unsigned column of polarities that holds 1 and the largest value, but no 0: there, v2e has written -1 for OFF. */
static void find_wraps(td_event_source *source, char told[160]) {
    const td_h5_column *p = &source->columns[TD_H5_P];
    td_table_column facts;
    int wrapped = 0;
    if (!p->wrapped || sample(source, p, &facts, &wrapped) < 0 || !wrapped || facts.zeros) return;
    source->wraps = 1;
    const size_t used = strlen(told);
    snprintf(told + used, 160 - used, "%s%s of p are -1, OFF", used ? "; " : "",
             p->wrapped == INT64_MAX ? "2^64 - 1" : "4294967295");
}

static tides_status set_order(td_event_source *source, const td_table_meaning *meaning) {
    for (int c = 0; c < TD_H5_COLUMNS; c++) source->columns[c].column = meaning->column[fields[c]];
    return TIDES_OK;
}

static tides_status said_order(td_event_source *source, const char *columns, tides_error *error) {
    td_columns list;
    td_table_meaning meaning;
    tides_error reason = {TIDES_OK, ""};
    td_columns_parse(columns, &list);
    if (list.count == TD_ROW_FIELDS && td_table_named(&list, &meaning, &reason) == TIDES_OK) return set_order(source, &meaning);
    return td_fail(error, TIDES_BAD_ARGUMENT, "%s: --columns (columns) %s: should say what four columns are, as t,x,y,p",
                   source->path, columns);
}

/* Finds the order of columns: the caller's, or the one that fits the values, or, if several fit, the layout's. */
static tides_status find_order(td_event_source *source, const tides_event_reading *how, int known, char told[160],
                               tides_error *error) {
    td_table_column facts[TD_ROW_FIELDS];
    td_table_meaning meaning;
    tides_error reason = {TIDES_OK, ""};
    char order[16];
    if (how->columns) return said_order(source, how->columns, error);
    for (int c = 0; c < TD_ROW_FIELDS; c++) {
        td_h5_column one = source->columns[0];
        one.column = c;
        /* a read failure is reported when the events are read */
        if (sample(source, &one, &facts[c], NULL) < 0) return TIDES_OK;
    }
    const int guessed = td_table_guess(facts, TD_ROW_FIELDS, &meaning, order, &reason) == TIDES_OK;
    if (!guessed && known) return TIDES_OK;
    if (!guessed) return td_fail(error, TIDES_BAD_FILE, "%s: %s %s", source->path, source->columns[0].name, reason.text);
    int same = 1;
    for (int c = 0; c < TD_H5_COLUMNS; c++) same = same && source->columns[c].column == meaning.column[fields[c]];
    if (!same || !known) snprintf(told, 160, "columns %s, told apart by their values", order);
    return set_order(source, &meaning);
}

/* 1 if the place has a name that other tools' files use, too, so that microseconds are only a guess. DSEC's files have an
 * index of milliseconds, and RVT's the sensor's size. */
static int is_common(const td_event_source *source) {
    const char *t = source->columns[TD_H5_T].name;
    if (strcmp(t, "/t") == 0) return 1;
    return strcmp(t, "/events/t") == 0 && !td_h5_exists(source->file, "/ms_to_idx") &&
           !td_h5_exists(source->file, "/events/height");
}

/* The unit in the attribute "unit" or "units" of the times; -1 if there is none or it is unknown. */
static int unit_of_attribute(const td_event_source *source) {
    static const char *const names[] = {"unit", "units", "time_unit"};
    for (int i = 0; i < 3; i++) {
        char text[64] = "";
        td_columns named;
        if (!td_h5_read_text(source->columns[TD_H5_T].dataset, names[i], text, sizeof text)) continue;
        char line[96];
        snprintf(line, sizeof line, "t[%s],x", text);
        if (td_columns_parse(line, &named)) return td_unit_digits(named.column[0].unit);
    }
    return -1;
}

/* Finds the unit of times. `layout` 1: the layout is known, and its whole numbers are microseconds, however rare the events
 * are. */
static tides_status find_unit(td_event_source *source, const tides_event_reading *how, int known, int layout, char told[160],
                              tides_error *error) {
    td_table_column facts;
    tides_error reason = {TIDES_OK, ""};
    source->digits = source->nanoseconds ? 0 : known;
    if (how->unit) return td_table_unit_named(how->unit, &source->digits, error);
    if (source->nanoseconds || known >= 0 || (source->digits = source->place.digits) >= 0) return TIDES_OK;
    if (source->columns[TD_H5_T].column < 0 && (source->digits = unit_of_attribute(source)) >= 0) return TIDES_OK;
    source->digits = 3;
    if (sample(source, &source->columns[TD_H5_T], &facts, NULL) < 0) return TIDES_OK;
    const int plausible = td_table_unit(&facts, 1, &source->digits, &reason) == TIDES_OK;
    if (!plausible && !(layout && source->digits == 3))
        return td_fail(error, TIDES_BAD_FILE, "%s: %s", source->path, reason.text);
    td_table_tell_falls(&facts, source->digits, told, 160);
    if (source->digits != 9) td_table_tell_unit(&facts, source->digits, layout && !is_common(source), told, 160);
    return TIDES_OK;
}

tides_status td_h5_find_meaning(td_event_source *source, const tides_event_reading *how, int known_digits, int known_order,
                                char told[160], tides_error *error) {
    const int table = source->columns[0].column >= 0;
    if (how->columns && !table)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: its columns have names: leave --columns (columns) out", source->path);
    tides_status status = table ? find_order(source, how, known_order, told, error) : TIDES_OK;
    if (status == TIDES_OK) status = find_unit(source, how, known_digits, known_order, told, error);
    if (status == TIDES_OK) find_wraps(source, told);
    return status;
}
