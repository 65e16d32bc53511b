/* Measures a point of an axis: it makes the world, and times frames or a run. Each point has a process of its own, so that
 * threads and memory belong to it alone. */
#define _GNU_SOURCE /* sched_setaffinity */
#include "bench_scaling.h"

#include <math.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#define TOLERANCE 0.01 /* of the steps [thresholds] */

/* Frames and runs are repeated until they took this time [s] together, and at most this often. */
enum { AGAIN_MOST = 5 };
#define LONG_S 1.0
#define LONG_QUICK_S 0.1

static tides_status frames(bench *b, const scaling_world *w, scaling_result *r, tides_error *error) {
    const bench_scene *s = &w->scene;
    const size_t pixels = (size_t)s->intrinsics.width * (size_t)s->intrinsics.height;
    double *planes = malloc(2 * pixels * sizeof *planes);
    tides_renderer *renderer = NULL;
    tides_frame frame = {{NULL}};
    if (!planes) return cli_error(error, TIDES_NO_MEMORY, "out of memory: %zu pixels", pixels);
    frame.plane[TIDES_L] = planes;
    frame.plane[TIDES_L_DOT] = planes + pixels;
    tides_status status = tides_renderer_create(b->device, s->scene, &s->intrinsics, &s->image, NULL, NULL, &renderer, error);
    double spent = 0;
    for (int32_t i = -1; i < AGAIN_MOST && status == TIDES_OK && (i < 1 || spent < (w->quick ? LONG_QUICK_S : LONG_S)); i++) {
        tides_render_stats before;
        tides_renderer_stats(renderer, &before);
        const double began = cli_now(), processor = bench_processor_s(1), own = bench_processor_s(0);
        status = tides_renderer_frame(renderer, s->camera, 0, &frame, error);
        const double took = cli_now() - began, worked = bench_processor_s(1) - processor, host = bench_processor_s(0) - own;
        spent += took;
        if (i < 0) continue; /* this frame builds kernels */
        r->time_s = i ? fmin(r->time_s, took) : took;
        r->processor_s = i ? fmin(r->processor_s, worked) : worked;
        r->host_s = i ? fmin(r->host_s, host) : host;
        r->runs++;
        tides_renderer_stats(renderer, &r->stats.render);
        r->stats.render.gaussians_projected -= before.gaussians_projected; /* leaves those of one frame */
        r->stats.render.pairs_evaluated -= before.pairs_evaluated;
    }
    tides_renderer_destroy(renderer);
    free(planes);
    return status;
}

static tides_status runs(bench *b, const scaling_world *w, scaling_result *r, tides_error *error) {
    tides_status status = TIDES_OK;
    double spent = 0;
    for (int32_t i = -1; i < AGAIN_MOST && status == TIDES_OK && (i < 1 || spent < (w->quick ? LONG_QUICK_S : LONG_S)); i++) {
        bench_row row = {.runs = 0};
        status = bench_simulate(b, &w->scene, TIDES_RULES_SMOOTH, &w->scene.sensor, &w->stepping, NULL, &row, error);
        spent += row.run_time_s;
        r->stats = row.stats;
        if (i < 0 && spent < LONG_S) continue; /* this run builds kernels; a long one counts without the builds */
        r->time_s = r->runs ? fmin(r->time_s, row.run_time_s) : row.run_time_s;
        r->processor_s = r->runs ? fmin(r->processor_s, row.all_threads_s) : row.all_threads_s;
        r->host_s = r->runs ? fmin(r->host_s, row.own_thread_s) : row.own_thread_s;
        r->runs++;
        if (i < 0) break;
    }
    return status;
}

/* Limits the process to as many processors as threads. Otherwise the host's thread would get a processor besides those of the
 * device's threads. */
static void keep_processors(int32_t count) {
    cpu_set_t allowed, kept;
    if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return;
    CPU_ZERO(&kept);
    for (int i = 0; i < CPU_SETSIZE && CPU_COUNT(&kept) < count; i++)
        if (CPU_ISSET(i, &allowed)) CPU_SET(i, &kept);
    (void)sched_setaffinity(0, sizeof kept, &kept);
}

/* PoCL's variables for the number of threads: before version 4, and since. */
static void set_threads(int32_t threads) {
    char text[16];
    if (threads < 1) return;
    keep_processors(threads);
    snprintf(text, sizeof text, "%d", (int)threads);
    setenv("POCL_MAX_PTHREAD_COUNT", text, 1);
    setenv("POCL_CPU_MAX_CU_COUNT", text, 1);
}

void scaling_measure(bench *b, const scaling_axis *axis, double x, scaling_result *r) {
    tides_error error = {TIDES_OK, ""};
    scaling_world w = {.quick = b->quick};
    struct rusage usage;
    memset(r, 0, sizeof *r);
    r->x = x;
    tides_stepping_defaults(&w.stepping);
    w.stepping.tolerance = TOLERANCE;
    bench_choose_parts(&w.stepping, 0);
    tides_status status = axis->make(x, &w, &error);
    set_threads(w.threads);
    if (status == TIDES_OK && axis->work == WORK_START)
        status = scaling_start(b, &w, r, &error);
    else if (status == TIDES_OK)
        status = tides_device_open(b->common->device, &b->device, &error);
    if (status == TIDES_OK && b->device) status = axis->work == WORK_FRAMES ? frames(b, &w, r, &error) : runs(b, &w, r, &error);
    if (axis->by_events) r->x = (double)r->stats.events;
    if (getrusage(RUSAGE_SELF, &usage) == 0) r->peak_bytes = 1024 * (uint64_t)usage.ru_maxrss;
    r->failed = status != TIDES_OK;
    snprintf(r->said, sizeof r->said, "%.255s", error.text);
    tides_device_close(b->device);
    bench_scene_free(&w.scene);
}
