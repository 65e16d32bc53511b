/* Renders a bench scene with the limit: a renderer in plain C with vectors of AVX-512, compiled for this machine alone. Its
 * time counts as the least cost of a frame here, and TIDES' renderer is compared with it. It is a shared object,
 * libtides-limit.so, opened while the benchmark runs. It may be missing, or made for another machine. */
#ifndef CLI_BENCH_LIMIT_H
#define CLI_BENCH_LIMIT_H

#include "bench.h"
#include "limit/limit.h"

typedef struct bench_limit {
    void *object; /* the open shared object; NULL: not found */
    const limit_functions *functions;
    limit *limit;      /* the renderer; NULL: it can't be used, and `why` has the reason */
    limit_view *views; /* for each object of the scene: the map to the camera, and its rate */
    float *L, *L_dot;  /* (pixels) of the last frame */
    size_t pixels;
    char why[256];
} bench_limit;

/* Prepares to render `scene` under TIDES_RULES_INRIA. If the limit is missing, or can't render this scene, made->limit is NULL
 * and the call returns TIDES_OK. */
tides_status bench_limit_make(const bench *b, const bench_scene *scene, bench_limit *made, tides_error *error);
void bench_limit_free(bench_limit *l);
/* Renders the frame at `time` [s] into l->L and, if `rates` isn't 0, l->L_dot. `counts` gets times of its stages. */
tides_status bench_limit_frame(bench_limit *l, const bench_scene *scene, double time, int32_t rates, limit_counts *counts,
                               tides_error *error);

#endif
