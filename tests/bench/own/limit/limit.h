/* The least cost of a frame on this machine: the same image and rate as TIDES_RULES_INRIA, in plain C with vectors of AVX-512,
 * made with -O3 -march=native. `own_bench throughput` runs it in turns with the renderer, and reports their ratio stage by
 * stage.
 *
 * It is a shared object (Makefile) that is opened while the benchmark runs, because code made with -march=native runs only on
 * similar machines. It may do what a library can't: it has one image, single precision, one set of rules, and no device.
 *
 * Stages: project (one pass over all Gaussians), sort (one radix sort of the visible ones by depth), lists (in depth order:
 * which 4x4 blocks of which 16x16 tile each may reach), composite (block by block, sixteen pixels in a vector). */
#ifndef LIMIT_H
#define LIMIT_H

#include <stdint.h>

/* The Gaussians of one object, as in tides_gaussians. The motion of the object is in its view. */
typedef struct limit_object {
    int64_t count;
    int32_t sh_degree; /* 0..3; higher bands aren't evaluated */
    const float *mean, *log_scale, *quaternion, *opacity_logit, *sh;
    double origin[3];
} limit_object;

typedef struct limit_setup {
    const limit_object *objects;
    int32_t object_count, threads;
    int32_t width, height; /* [px] */
    double fx, fy, cx, cy; /* [px] */
    double luminance[3], background[3], log_eps, dilation;
} limit_setup;

/* The map from an object's coordinates to the camera's, and the rate of the map. */
typedef struct limit_view {
    double r[9], r_dot[9], t[3], t_dot[3];
} limit_view;

enum { LIMIT_PROJECT = 0, LIMIT_SORT = 1, LIMIT_LISTS = 2, LIMIT_COMPOSITE = 3, LIMIT_STAGES = 4 };

/* The work of a frame. */
typedef struct limit_counts {
    double seconds[LIMIT_STAGES];
    int64_t gaussians, splats; /* all; those that are visible */
    int64_t entries;           /* (splat, tile) pairs */
    int64_t pairs;             /* (splat, pixel) pairs, in blocks of 16 */
} limit_counts;

typedef struct limit limit;

typedef struct limit_functions {
    uint32_t size; /* of this struct */
    int32_t reserved;
    const char *made_by; /* compiler and version */
    /* Copies the Gaussians. Returns NULL if there is no memory. */
    limit *(*create)(const limit_setup *setup);
    void (*destroy)(limit *l);
    /* Renders L and, with `rates`, L_dot, (height x width). `views` has one view for each object. Returns 0 if there is no
     * memory. */
    int32_t (*frame)(limit *l, const limit_view *views, int32_t rates, float *log_luminance, float *log_luminance_dot,
                     limit_counts *counts);
} limit_functions;

/* The only symbol of the shared object. */
#define LIMIT_SYMBOL "limit_of_frames"
#define LIMIT_OBJECT "libtides-limit.so"

#endif
