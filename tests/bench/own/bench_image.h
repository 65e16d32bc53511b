/* The value of the measures that make the image continuous in time. */
#ifndef TESTS_BENCH_IMAGE_H
#define TESTS_BENCH_IMAGE_H

#include "bench.h"

/* bench_jumps.c: measures of an image that need no events. */
typedef struct bench_jumps {
    double per_pixel_s; /* number of jumps of L above 0.001 [1/s per pixel] */
    double sum_per_s;   /* sum of their sizes [log units/s per pixel] */
    double largest;     /* size of the largest jump [log units] */
    double psnr;        /* of the colours against those of inria, with a peak of 1 [dB] */
    double furthest;    /* largest difference of a colour channel from that of inria, */
    int32_t x, y;       /* in this pixel, */
    double time;        /* at this time [s] */
} bench_jumps;
tides_status bench_find_jumps(bench *b, const bench_scene *scene, const tides_image_params *image, bench_jumps *jumps,
                              tides_error *error);

/* Measures the run time [s] of a frame with L and L_dot for each of the `images`: the least of many runs. The images take
 * turns. */
tides_status bench_frame_costs(bench *b, const bench_scene *scene, const tides_image_params *images, size_t count,
                               double *seconds, tides_error *error);

tides_status bench_image(bench *b, const cli_list *scenes, tides_error *error);

#endif
