/* Targets of benchmarks. Each is a row with a bound and a measured value in the benchmark's JSON. */
#ifndef CLI_BENCH_TARGETS_H
#define CLI_BENCH_TARGETS_H

#include "bench.h"

/* One row. `measured` should be at most `bound`; where `least` is 1, it should be at least `bound`. NaN means that it wasn't
 * measured, and `note` says why. */
typedef struct bench_target {
    const char *name;    /* "frame under inria, over the limit" */
    const char *subject; /* "guitar 346x260" */
    const char *unit;    /* "x" */
    const char *note;
    double measured, bound;
    int32_t least;
} bench_target;

/* Appends a row to a JSON list of targets. */
tides_status bench_add_target(cJSON *targets, const bench_target *target, tides_error *error);
/* Prints the targets as a table. */
void bench_print_targets(const cJSON *targets, FILE *out);

#endif
