/* Internal: finds the meaning of the columns of an event table and the unit of its times. A header or the caller gives them;
 * otherwise they are the only meaning that fits the values. A column's position alone decides nothing. */
#ifndef TD_EVENT_TABLE_H
#define TD_EVENT_TABLE_H

#include "td_columns.h"
#include "tides/base.h"

#include <stdint.h>

enum { TD_ROW_T, TD_ROW_X, TD_ROW_Y, TD_ROW_P, TD_ROW_FIELDS };
enum {
    TD_TABLE_COLUMNS_MAX = 16,
    TD_TABLE_SAMPLE = 4096,    /* rows at a table's beginning that are sampled */
    TD_TABLE_COORDINATE = 8191 /* no sensor has more pixels: a larger value is a time, or in 1/32 px */
};

/* Facts about the first values of a column; zeroed at first. */
typedef struct td_table_column {
    double least, most, first, last, fall; /* fall: the largest from one value to the next */
    uint32_t rows, falls;                  /* falls: values that are below the one before */
    uint32_t fractional, dotted, beyond;   /* not whole; written with a point or an exponent; impossible as coordinates */
    uint32_t zeros, ones, minuses, others; /* number of 0s, 1s, -1s, and other values */
    int32_t counting;                      /* 1: the values count 0, 1, 2 .. or 1, 2, 3 .. */
    int32_t decimals;                      /* most decimals of a value */
} td_table_column;

/* Adds a value. `decimals`: how many it is written with; 0 without a point or an exponent. */
void td_table_add(td_table_column *column, double value, int decimals);

/* Meaning of a table's columns. */
typedef struct td_table_meaning {
    int column[TD_ROW_FIELDS]; /* of t, x, y, p */
    int digits;                /* 10^digits [ns] is the unit of times; -1: not known yet */
} td_table_meaning;

/* Finds the meaning from the names in a header, or in the caller's list. TIDES_BAD_FILE says which column is missing or
 * double; its text continues "PATH: its header ". */
tides_status td_table_named(const td_columns *named, td_table_meaning *meaning, tides_error *error);

/* 1 if a header names x, y, t and nothing that only poses have: then the table is of events, even if a column is missing. */
int td_table_is_events(const td_columns *named);

/* Finds the meaning of `count` columns from their values. `order` becomes such as "t x y p". TIDES_BAD_FILE says why it isn't
 * clear; its text continues "PATH: ". */
tides_status td_table_guess(const td_table_column *columns, int count, td_table_meaning *meaning, char order[16],
                            tides_error *error);

/* Guesses the unit of times: seconds if they have decimals; else nanoseconds above 10^17 (3000 years in microseconds); else
 * microseconds. TIDES_BAD_FILE if that means less than one event a second, or more than 10^9. `whole`: decimals don't mean
 * seconds, since the file writes all numbers with them. */
tides_status td_table_unit(const td_table_column *times, int whole, int *digits, tides_error *error);

/* Adds to `told` which unit was guessed. With `expected`, the format usually has this unit. Then a note is added only for
 * seconds with few decimals, for an unlikely rate of events, and for nanoseconds. */
void td_table_tell_unit(const td_table_column *times, int digits, int expected, char *told, size_t size);

/* Adds a note to `told` if times fall by more than half of their range: sorting such events may mix two recordings. */
void td_table_tell_falls(const td_table_column *times, int digits, char *told, size_t size);

/* Digits of a unit named "s", "ms", "us" or "ns"; TIDES_BAD_ARGUMENT for others. */
tides_status td_table_unit_named(const char *unit, int *digits, tides_error *error);

/* The name of a unit: "microseconds" for 3 digits. */
const char *td_table_unit_word(int digits);

#endif
