/* Measures how often and how far L jumps in an image, the distance of its colours from inria's, and the cost of a frame. */
#include "bench_image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Distance of neighbouring samples. Between two samples an image without jumps follows the trapezoid of its rates, with an
 * error far below LEAST_JUMP. A larger difference is a jump, or a change too fast to tell from one. */
#define SAMPLE_S (1.0 / 64000)
#define LEAST_JUMP 1e-3 /* [log units]: half a percent of a threshold of 0.2 */

enum { SAMPLES = 128, QUICK_SAMPLES = 16, VIEWS = 5, ROUNDS = 40, QUICK_ROUNDS = 4 };

/* L and L_dot of two neighbouring samples, or the colours of two images. */
typedef struct planes {
    double *at[6];
    size_t count;
} planes;

static int32_t make_planes(planes *p, int32_t planes_wanted, size_t pixels) {
    memset(p, 0, sizeof *p);
    p->count = pixels;
    for (int32_t i = 0; i < planes_wanted; i++)
        if (!(p->at[i] = malloc(pixels * sizeof *p->at[i]))) return 0;
    return 1;
}

static void free_planes(planes *p) {
    for (size_t i = 0; i < sizeof p->at / sizeof p->at[0]; i++) free(p->at[i]);
}

static tides_renderer *make_renderer(bench *b, const bench_scene *scene, const tides_image_params *image, tides_error *error) {
    tides_renderer *renderer = NULL;
    tides_status status = tides_renderer_create(b->device, scene->scene, &scene->intrinsics, image, cli_progress_step,
                                                &b->progress, &renderer, error);
    return status == TIDES_OK ? renderer : NULL;
}

static void add_jumps(const planes *p, bench_jumps *jumps) {
    for (size_t i = 0; i < p->count; i++) {
        const double moved = p->at[2][i] - p->at[0][i], expected = 0.5 * SAMPLE_S * (p->at[1][i] + p->at[3][i]);
        const double jump = fabs(moved - expected);
        if (!(jump > LEAST_JUMP)) continue;
        jumps->per_pixel_s += 1;
        jumps->sum_per_s += jump;
        jumps->largest = fmax(jumps->largest, jump);
    }
}

static tides_status scan(bench *b, const bench_scene *scene, tides_renderer *renderer, bench_jumps *jumps, tides_error *error) {
    const int32_t samples = b->quick ? QUICK_SAMPLES : SAMPLES;
    planes p;
    tides_status status = TIDES_OK;
    if (!make_planes(&p, 4, (size_t)scene->intrinsics.width * (size_t)scene->intrinsics.height))
        status = cli_error(error, TIDES_NO_MEMORY, "out of memory: samples");
    for (int32_t k = 0; k <= samples && status == TIDES_OK; k++) {
        tides_frame frame = {{NULL}};
        for (size_t i = 0; i < 2; i++) {
            double *passed = p.at[i];
            p.at[i] = p.at[i + 2];
            p.at[i + 2] = passed;
        }
        frame.plane[TIDES_L] = p.at[2];
        frame.plane[TIDES_L_DOT] = p.at[3];
        status = tides_renderer_frame(renderer, scene->camera, scene->start + k * SAMPLE_S, &frame, error);
        if (status == TIDES_OK && k > 0) add_jumps(&p, jumps);
    }
    jumps->per_pixel_s /= (double)p.count * samples * SAMPLE_S;
    jumps->sum_per_s /= (double)p.count * samples * SAMPLE_S;
    free_planes(&p);
    return status;
}

/* Adds the squares of the differences of two images at one time, and keeps the largest difference. */
static double compare(const planes *p, int32_t width, double time, bench_jumps *jumps) {
    double squares = 0;
    for (size_t i = 0; i < p->count; i++)
        for (size_t c = 0; c < 3; c++) {
            const double difference = fabs(p->at[c][i] - p->at[3 + c][i]);
            squares += difference * difference;
            if (difference <= jumps->furthest) continue;
            jumps->furthest = difference;
            jumps->x = (int32_t)(i % (size_t)width);
            jumps->y = (int32_t)(i / (size_t)width);
            jumps->time = time;
        }
    return squares;
}

static tides_status look(const bench_scene *scene, tides_renderer *const renderers[2], bench_jumps *jumps, tides_error *error) {
    planes p;
    double squares = 0;
    tides_status status = TIDES_OK;
    if (!make_planes(&p, 6, (size_t)scene->intrinsics.width * (size_t)scene->intrinsics.height))
        status = cli_error(error, TIDES_NO_MEMORY, "out of memory: images");
    for (int32_t k = 0; k < VIEWS && status == TIDES_OK; k++) {
        const double time = scene->start + (scene->stop - scene->start) * k / (VIEWS - 1);
        for (size_t i = 0; i < 2 && status == TIDES_OK; i++) {
            tides_frame frame = {{NULL}};
            for (size_t c = 0; c < 3; c++) frame.plane[TIDES_R + c] = p.at[3 * i + c];
            status = tides_renderer_frame(renderers[i], scene->camera, time, &frame, error);
        }
        if (status == TIDES_OK) squares += compare(&p, scene->intrinsics.width, time, jumps);
    }
    jumps->psnr = -10 * log10(squares / (3.0 * (double)p.count * VIEWS));
    free_planes(&p);
    return status;
}

tides_status bench_find_jumps(bench *b, const bench_scene *scene, const tides_image_params *image, bench_jumps *jumps,
                              tides_error *error) {
    tides_image_params inria = *image;
    inria.rules = TIDES_RULES_INRIA;
    tides_renderer *const renderers[2] = {make_renderer(b, scene, image, error), make_renderer(b, scene, &inria, error)};
    tides_status status = renderers[0] && renderers[1] ? TIDES_OK : error->status;
    memset(jumps, 0, sizeof *jumps);
    if (status == TIDES_OK) status = scan(b, scene, renderers[0], jumps, error);
    if (status == TIDES_OK) status = look(scene, renderers, jumps, error);
    tides_renderer_destroy(renderers[0]);
    tides_renderer_destroy(renderers[1]);
    return status;
}

tides_status bench_frame_costs(bench *b, const bench_scene *scene, const tides_image_params *images, size_t count,
                               double *seconds, tides_error *error) {
    const int32_t rounds = b->quick ? QUICK_ROUNDS : ROUNDS;
    planes p;
    tides_status status = TIDES_OK;
    tides_renderer **renderers = calloc(count, sizeof(tides_renderer *));
    if (!renderers) return cli_error(error, TIDES_NO_MEMORY, "out of memory: frames");
    if (!make_planes(&p, 2, (size_t)scene->intrinsics.width * (size_t)scene->intrinsics.height))
        status = cli_error(error, TIDES_NO_MEMORY, "out of memory: frames");
    for (size_t i = 0; i < count && status == TIDES_OK; i++)
        if (!(renderers[i] = make_renderer(b, scene, &images[i], error))) status = error->status;
    const tides_frame frame = {.plane = {[TIDES_L] = p.at[0], [TIDES_L_DOT] = p.at[1]}};
    for (int32_t round = -1; round < rounds; round++) /* the first round warms up */
        for (size_t i = 0; i < count && status == TIDES_OK; i++) {
            const double began = cli_now();
            status = tides_renderer_frame(renderers[i], scene->camera, scene->start, &frame, error);
            const double took = cli_now() - began;
            if (round <= 0 || took < seconds[i]) seconds[i] = took;
        }
    for (size_t i = 0; i < count; i++) tides_renderer_destroy(renderers[i]);
    free(renderers);
    free_planes(&p);
    return status;
}
