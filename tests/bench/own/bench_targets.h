/* Targets: rows with a bound and a measured value, in the JSON of each benchmark that has some. */
#ifndef CLI_BENCH_TARGETS_H
#define CLI_BENCH_TARGETS_H

#include "bench.h"

/* One row: `measured` is to be `most` at most (or, where `least`, at least). NaN: not measured here, and `note` says why. */
typedef struct bench_target {
    const char *name;    /* "frame under inria, over the limit" */
    const char *subject; /* "guitar 346x260" */
    const char *unit;    /* "x" */
    const char *note;
    double measured, bound;
    int32_t least;
} bench_target;

/* Appends a row to a list of them; out of memory is an error. */
tides_status bench_add_target(cJSON *targets, const bench_target *target, tides_error *error);
/* As a table. */
void bench_print_targets(const cJSON *targets, FILE *out);

#endif
