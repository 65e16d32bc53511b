/* Internal: the parameter table of the run file: the struct of its rows. */
#ifndef TD_PARAMS_H
#define TD_PARAMS_H

#include "tides/run.h"

/* Field of a key whose value is not in tides_run_values. */
#define TD_NO_FIELD ((size_t)-1)

/* A row: the fields of the public tides_param, which is made from it, and further ones. */
typedef struct td_param {
    const char *key;
    int32_t type, is_file; /* is_file: 1: a path, relative to the run file, of an input */
    size_t field;          /* offset in tides_run_values, or TD_NO_FIELD */
    const char *unit;      /* NULL: none */
    double lower, upper;
    const char *fallback; /* default as JSON text, if it isn't the field's own; a text with NULL here is required */
    const char *choices;
    const int32_t *constants; /* values of the choices, unless these are 0, 1, 2 ... */
    const char *ideal;        /* value for an ideal pixel, unless the user sets another; NULL: not set */
    int32_t common;           /* 1: one of the few keys that most runs set */
    int32_t no_event; /* 1: doesn't change events, so parts of one run may differ in it; otherwise a checkpoint refuses that */
    const char *sentence;
} td_param;

extern const td_param td_params[];
extern const size_t td_params_count;

/* Longest default made from a field, as JSON text. */
enum { TD_DEFAULT_MAX = 96 };

/* Formats a number as JSON, with the fewest digits that distinguish it from all others, and with a point or an exponent. */
const char *td_number_text(double value, char text[32]);

#endif
