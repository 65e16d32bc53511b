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
    /* Default as JSON text. NULL: the default that td_run_values_defaults sets in the field; a text must then be given. */
    const char *fallback;
    const char *choices;      /* "smooth|inria|gsplat", or NULL */
    const int32_t *constants; /* values of the choices, unless these are 0, 1, 2 ... */
    const char *ideal;        /* value for pixels without noise, filters or delays, unless the user sets it; NULL: none */
    int32_t common;           /* 1: one of the few keys that most runs set */
    /* 1: events don't depend on it, so a run may continue from a checkpoint with another value. 0: that is refused. */
    int32_t no_event;
    const char *sentence;
} td_param;

extern const td_param td_params[];
extern const size_t td_params_count;

/* Bytes of the longest default that is made from a field, as JSON text with its closing 0. */
enum { TD_DEFAULT_MAX = 96 };

/* Formats a number as JSON, with the fewest digits that distinguish it from all others, and with a point or an exponent. */
const char *td_number_text(double value, char text[32]);

#endif
