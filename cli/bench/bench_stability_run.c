/* Measures one row of `tides bench stability` on the device, and an ordinary world of its size for comparison of run times.
 * The references follow: the device must match the float reference's bits, and rounding is measured against the double
 * reference. */
#include "bench_stability.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The least time of several runs counts, because other load of the machine affects it less. A first run below LONG_RUN_S [s]
 * is repeated, because PoCL may build kernels in it (about 1 s with an empty cache). While the least is below SHORT_RUN_S
 * [s], there are up to RUNS runs. */
enum { FRAMES = 5, RUNS = 3 };
#define SHORT_RUN_S 0.2
#define LONG_RUN_S 5

static const double frame_shares[FRAMES] = {0, 0.13, 0.5, 0.77, 1}; /* of the run, ends included */

/* Results of a world on a device. */
typedef struct outcome {
    cli_stream stream;
    bench_row row;
    double seconds; /* the least time of its runs */
    double *planes; /* L, L_dot of each frame */
} outcome;

static void free_outcome(outcome *o) {
    free(o->stream.events);
    free(o->planes);
    memset(o, 0, sizeof *o);
}

static size_t plane_size(const stability_world *w) {
    return (size_t)w->scene.intrinsics.width * (size_t)w->scene.intrinsics.height;
}

static tides_status render(const bench *b, const stability_world *w, outcome *o, tides_error *error) {
    const size_t pixels = plane_size(w);
    const bench_scene *s = &w->scene;
    tides_renderer *renderer = NULL;
    o->planes = malloc(2 * FRAMES * pixels * sizeof *o->planes);
    if (!o->planes) return cli_error(error, TIDES_NO_MEMORY, "out of memory: %d frames of %zu px", FRAMES, pixels);
    tides_status status = tides_renderer_create(b->device, s->scene, &s->intrinsics, &s->image, NULL, NULL, &renderer, error);
    for (size_t f = 0; f < FRAMES && status == TIDES_OK; f++) {
        tides_frame frame = {{NULL}};
        frame.plane[TIDES_L] = o->planes + 2 * f * pixels;
        frame.plane[TIDES_L_DOT] = frame.plane[TIDES_L] + pixels;
        status = tides_renderer_frame(renderer, s->camera, s->start + frame_shares[f] * (s->stop - s->start), &frame, error);
    }
    tides_renderer_destroy(renderer);
    return status;
}

/* 1 where the device computes on this processor: then processor time is measured, which other load doesn't affect. */
static int32_t computes_here(const bench *b) {
    return b->info.kind == TIDES_DEVICE_CPU || b->info.kind == TIDES_DEVICE_REFERENCE;
}

/* Simulates. Events are kept only where they are compared, since they would dominate the memory measured. */
static tides_status simulate(bench *b, const stability_world *w, int runs, int32_t keep, outcome *o, tides_error *error) {
    const bench_scene *s = &w->scene;
    cli_stream *stream = keep ? &o->stream : NULL;
    tides_status status = TIDES_OK;
    for (int i = 0; i < runs && status == TIDES_OK && (i == 0 || o->seconds < (i == 1 ? LONG_RUN_S : SHORT_RUN_S)); i++) {
        status = bench_simulate(b, s, s->image.rules, &s->sensor, &w->stepping, stream, &o->row, error);
        const double seconds = computes_here(b) ? o->row.all_threads_s : o->row.run_time_s;
        o->seconds = i == 0 ? seconds : fmin(o->seconds, seconds);
    }
    return status;
}

/* Runs a world on a device: events before frames, so that memory is measured without the frames. */
static tides_status run_on(const bench *b, const char *device, const stability_world *w, int32_t flags, outcome *o,
                           tides_error *error) {
    bench on = *b;
    tides_status status = tides_device_open(device, &on.device, error);
    if (status == TIDES_OK && !(flags & STABILITY_IMAGE_ONLY))
        status = simulate(&on, w, device == b->common->device ? RUNS : 1, !(flags & STABILITY_ALONE), o, error);
    if (status == TIDES_OK && !(flags & STABILITY_ALONE)) status = render(&on, w, o, error);
    tides_device_close(on.device);
    return status;
}

static tides_status time_benign(const bench *b, const stability_world *like, double *seconds, tides_error *error) {
    stability_world w;
    outcome o;
    bench on = *b;
    memset(&o, 0, sizeof o);
    tides_status status = stability_make_benign(like, &w, error);
    if (status != TIDES_OK) return status;
    status = tides_device_open(b->common->device, &on.device, error);
    if (status == TIDES_OK) status = simulate(&on, &w, RUNS, 0, &o, error);
    *seconds = o.seconds;
    tides_device_close(on.device);
    free_outcome(&o);
    bench_scene_free(&w.scene);
    return status;
}

/* -- comparing ----------------------------------------------------------------------------------------------------------- */

static int32_t same_events(const cli_stream *a, const cli_stream *b) {
    if (a->count != b->count) return 0;
    for (size_t i = 0; i < a->count; i++) {
        const tides_event *x = &a->events[i], *y = &b->events[i];
        if (x->t != y->t || x->x != y->x || x->y != y->y || x->polarity != y->polarity) return 0;
    }
    return 1;
}

static int32_t same_bits(const stability_world *w, const outcome *a, const outcome *b) {
    if (a->planes && b->planes && memcmp(a->planes, b->planes, 2 * FRAMES * plane_size(w) * sizeof *a->planes) != 0) return 0;
    return !b->row.runs || same_events(&a->stream, &b->stream);
}

/* The worst error of L, and of L_dot over the largest rate in its frame (or 1/s, if that is larger). */
static void compare_images(const stability_world *w, const outcome *a, const outcome *exact, stability_result *r) {
    const size_t pixels = plane_size(w);
    for (size_t f = 0; f < FRAMES; f++) {
        const double *L = a->planes + 2 * f * pixels, *true_L = exact->planes + 2 * f * pixels;
        double most = 1, worst = 0;
        for (size_t i = 0; i < pixels; i++) {
            r->L = fmax(r->L, fabs(L[i] - true_L[i]));
            most = fmax(most, fabs(true_L[pixels + i]));
            worst = fmax(worst, fabs(L[pixels + i] - true_L[pixels + i]));
        }
        r->L_dot = fmax(r->L_dot, worst / most);
    }
    r->rendered = 1;
}

static tides_status compare(const stability_world *w, const outcome *device, const outcome *exact, stability_result *r,
                            tides_error *error) {
    if (device->planes && exact->planes) compare_images(w, device, exact, r);
    if (!exact->row.runs) return TIDES_OK;
    r->exact = exact->row.stats;
    r->exact_s = exact->seconds;
    r->simulated = 1;
    return tides_match_events(exact->stream.events, exact->stream.count, device->stream.events, device->stream.count,
                              TIDES_MATCH_LIMIT_S, &r->match, error);
}

/* -- a row --------------------------------------------------------------------------------------------------------------- */

static int32_t is_reference(const bench *b) { return b->info.kind == TIDES_DEVICE_REFERENCE; }

static tides_status against_references(const bench *b, const stability_case *c, const stability_world *w, const outcome *device,
                                       stability_result *r, tides_error *error) {
    outcome single, exact;
    memset(&single, 0, sizeof single);
    memset(&exact, 0, sizeof exact);
    tides_status status = TIDES_OK;
    if (!is_reference(b)) {
        status = run_on(b, "reference-f32", w, c->flags, &single, error);
        if (status == TIDES_OK) r->same_bits = same_bits(w, device, &single);
    }
    free_outcome(&single);
    if (status == TIDES_OK) status = run_on(b, "reference", w, c->flags, &exact, error);
    if (status == TIDES_OK) status = compare(w, device, &exact, r, error);
    free_outcome(&exact);
    return status;
}

static tides_status measure_world(const bench *b, const stability_case *c, const stability_world *w, stability_result *r,
                                  tides_error *error) {
    outcome device;
    memset(&device, 0, sizeof device);
    r->gaussians = tides_scene_count(w->scene.scene);
    r->pixels = (int64_t)plane_size(w);
    tides_status status = c->refusal ? TIDES_OK : time_benign(b, w, &r->benign_s, error);
    if (status == TIDES_OK) status = run_on(b, b->common->device, w, c->flags & ~STABILITY_IMAGE_ONLY, &device, error);
    r->stats = device.row.stats;
    r->run_time_s = device.seconds;
    r->peak_bytes = device.row.stats.peak_memory_bytes;
    if (status == TIDES_OK && !(c->flags & STABILITY_ALONE)) status = against_references(b, c, w, &device, r, error);
    free_outcome(&device);
    return status;
}

void stability_measure(const bench *b, const stability_case *c, stability_result *r) {
    tides_error error = {TIDES_OK, ""};
    stability_world w;
    const double began = cli_now();
    memset(r, 0, sizeof *r);
    r->same_bits = -1;
    tides_status status = stability_make(c, &w, &error);
    if (status == TIDES_OK) {
        status = measure_world(b, c, &w, r, &error);
        bench_scene_free(&w.scene);
    }
    r->how = status == TIDES_OK ? BENCH_RAN : status == TIDES_CANCELLED ? BENCH_STOPPED : BENCH_REFUSED;
    snprintf(r->said, sizeof r->said, "%s", error.text);
    r->elapsed_s = cli_now() - began;
}
