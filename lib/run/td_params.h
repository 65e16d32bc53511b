/* Internal: a row of the parameter table (params_table.c), and the table as the public sees it (params.c). */
#ifndef TD_PARAMS_H
#define TD_PARAMS_H

#include "tides/run.h"

/* A key whose value is not in tides_run_values. */
#define TD_NO_FIELD ((size_t)-1)

/* As tides_param, which is made from it, and: */
typedef struct td_param {
    const char *key;
    int32_t type, is_file; /* 1: the text is a path, relative to the run file, of something that the run reads */
    size_t field;          /* where in tides_run_values; TD_NO_FIELD */
    const char *unit;      /* NULL: none */
    double lower, upper;
    const char *fallback; /* default as JSON text where it isn't the field's own; NULL and a text: required */
    const char *choices;
    const int32_t *constants; /* of the choices, where they aren't 0, 1, 2 ... */
    const char *ideal;        /* what an ideal pixel has here, where nothing else is asked for; NULL: nothing is to be set */
    int32_t common;           /* 1: one of the few that most runs set */
    int32_t no_event; /* 1: changes no event, so that parts of one run may differ in it; else a checkpoint refuses that */
    const char *sentence;
} td_param;

extern const td_param td_params[];
extern const size_t td_params_count;

/* Longest default that is made from a field, as JSON text. */
enum { TD_DEFAULT_MAX = 96 };

/* params.c: a number as JSON, in as few digits as tell it from all others, and with a point or an exponent. */
const char *td_number_text(double value, char text[32]);

#endif
