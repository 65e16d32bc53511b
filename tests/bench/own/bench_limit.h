/* A scene rendered by the limit, plain C made for this machine (limit/limit.h), where that is installed. */
#ifndef CLI_BENCH_LIMIT_H
#define CLI_BENCH_LIMIT_H

#include "bench.h"
#include "limit/limit.h"

typedef struct bench_limit {
    void *object;
    const limit_functions *functions;
    limit *limit; /* NULL: there is none, and `why` says so */
    limit_view *views;
    float *L, *L_dot;
    size_t pixels;
    char why[256];
} bench_limit;

/* Makes the limit of a scene's frames under TIDES_RULES_INRIA. That there is none is no failure. */
tides_status bench_limit_make(const bench *b, const bench_scene *scene, bench_limit *made, tides_error *error);
void bench_limit_free(bench_limit *l);
/* A frame into L and L_dot. */
tides_status bench_limit_frame(bench_limit *l, const bench_scene *scene, double time, int32_t rates, limit_counts *counts,
                               tides_error *error);

#endif
