/* Internal: the line of a text table that names its columns, and what it says of their units, in any spelling that such files
 * use: `#timestamp[us]`, `"t [ns]"`, `t_ns`, `%time`, `Time (sec)`, `x@1280`; commas, semicolons, tabs or blanks between. */
#ifndef TD_COLUMNS_H
#define TD_COLUMNS_H

#include <stdint.h>

enum { TD_COLUMNS_MAX = 64, TD_COLUMN_NAME = 64, TD_COLUMN_UNIT = 16 };

/* Answers of td_columns_find in place of a column. */
enum { TD_COLUMN_NONE = -1, TD_COLUMN_TWICE = -2 };

typedef struct td_column {
    char name[TD_COLUMN_NAME]; /* small letters and digits alone, without its unit: "qrsw" of "q_RS_w []" */
    char unit[TD_COLUMN_UNIT]; /* "s", "ms", "us", "ns", "m", "cm", "mm" of whatever means that; another word as the file has
                                  it, in small letters; "" where nothing is said */
    int32_t size;              /* of "x@1280"; 0: none */
} td_column;

typedef struct td_columns {
    int count;      /* fields of the line, those beyond TD_COLUMNS_MAX too: they have no name here */
    char separator; /* ',' ';' '\t' or ' ' */
    td_column column[TD_COLUMNS_MAX];
} td_columns;

/* 1 where the line at `line` (up to CR, LF or NUL; a byte order mark, '#', '%' and '//' in front are skipped) names columns: it
 * has a name, and no field that is a number. 0 where it doesn't; `count` and `separator` are then those of its fields. */
int td_columns_parse(const char *line, td_columns *columns);

/* The column that has one of `names`, "t|timestamp|*stamp": first names win, '*' is any letters or none.
 * TD_COLUMN_NONE where none has, TD_COLUMN_TWICE where two have the same. */
int td_columns_find(const td_columns *columns, const char *names);

/* Finds a column of times as td_columns_find does; units may be in its name, too ("timestampus"). `*digits`: the decimal digits
 * from its unit to nanoseconds, -1 where no unit is said. A unit that isn't one of time gives TD_COLUMN_NONE and *digits -1. */
int td_columns_time(const td_columns *columns, const char *names, int *digits);

/* Decimal digits from a unit of td_column to nanoseconds: 9 of "s", 6, 3, 0; -1: no unit of time. */
int td_unit_digits(const char *unit);

/* Metres of a unit of td_column: 1 of "m"; 0: no unit of length. */
double td_unit_metres(const char *unit);

/* 1 for seconds that a clock which counts from 1970 has between 1973 and 2128. */
int td_counts_from_1970(double seconds);

/* The unit in which times are likely to be whose largest is `last` and whose middle step is `step`, both in that unit, of
 * samples that come 1 to 1000 times a second or that count from 1970: its decimal digits to nanoseconds. */
int td_likely_digits(double last, double step);

#endif
