/* Internal: parses the header line of a text table: names of columns and their units, in the spellings that files use
 * (`#timestamp[us]`, `"t [ns]"`, `t_ns`, `%time`, `Time (sec)`, `x@1280`), between commas, semicolons, tabs or blanks. */
#ifndef TD_COLUMNS_H
#define TD_COLUMNS_H

#include <stdint.h>

enum { TD_COLUMNS_MAX = 64, TD_COLUMN_NAME = 64, TD_COLUMN_UNIT = 16 };

/* td_columns_find returns these instead of an index. */
enum { TD_COLUMN_NONE = -1, TD_COLUMN_TWICE = -2 };

typedef struct td_column {
    char name[TD_COLUMN_NAME]; /* in lower case, letters and digits only, without the unit: "qrsw" of "q_RS_w []" */
    /* "s", "ms", "us", "ns", "m", "cm", "mm" for any spelling of these; another word in lower case; "" if there is no unit */
    char unit[TD_COLUMN_UNIT];
    int32_t size; /* the number behind '@', as in "x@1280"; 0: none */
} td_column;

typedef struct td_columns {
    int count;      /* all fields of the line; those beyond TD_COLUMNS_MAX have no entry in `column` */
    char separator; /* ',' ';' '\t' or ' ' */
    td_column column[TD_COLUMNS_MAX];
} td_columns;

/* 1 if the line names columns: at least one field is a name, and none is a number. Otherwise 0; `count` and `separator` are
 * set all the same. The line ends at CR, LF or NUL. A byte order mark, '#', '%' and '//' in front are skipped. */
int td_columns_parse(const char *line, td_columns *columns);

/* The index of the column that has one of `names`, such as "t|timestamp|*stamp". '*' stands for any letters or none, and
 * the first of `names` that is found wins. TD_COLUMN_NONE: no column has one. TD_COLUMN_TWICE: two columns have the same. */
int td_columns_find(const td_columns *columns, const char *names);

/* Finds a column of times as td_columns_find does; the name may also end in its unit ("timestampus"). `*digits`: the
 * decimal digits from the unit to nanoseconds, -1 if no unit is given. A unit that isn't one of time gives TD_COLUMN_NONE
 * and *digits = -1. */
int td_columns_time(const td_columns *columns, const char *names, int *digits);

/* Decimal digits from a unit of time to nanoseconds: 9 for "s", 6 for "ms", 3 for "us", 0 for "ns". -1: no unit of time. */
int td_unit_digits(const char *unit);

/* Metres in a unit of length: 1 for "m". 0: no unit of length. */
double td_unit_metres(const char *unit);

/* 1 if `seconds`, counted from 1970, is a date between 1973 and 2128: then a file's clock is likely to count from 1970. */
int td_counts_from_1970(double seconds);

/* Guesses the unit of times from the largest (`last`) and the median step (`step`), both in that unit. Assumes 1 to 1000
 * samples a second, or a clock that counts from 1970. Returns the decimal digits from the unit to nanoseconds. */
int td_likely_digits(double last, double step);

#endif
