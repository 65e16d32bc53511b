/* Times frames. The renderer times its own stages; the rest of a frame's time is `other`. The makers take turns within each
 * round, so that other load affects all of them alike. Results are medians over the rounds, and so are ratios. */
#include "bench_frames.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Most frames of a maker in a round. The number is less if that many of the slowest maker take longer than ROUND_S [s]. */
enum { FRAMES_MOST = 8 };
#define ROUND_S 0.1

static const char *const stage_names[STAGES] = {"motion",   "sweep", "project", "sort",     "composite",
                                                "transfer", "other", "frame",   "processor"};
const char *frame_stage_name(frame_stage stage) { return stage_names[stage]; }

const char *frame_maker_name(int32_t maker) {
    static const char *const names[MAKERS] = {"limit",  "limit L",  "inria",  "inria Y",
                                              "gsplat", "gsplat Y", "smooth", "smooth Y"};
    return names[maker];
}

/* -- the makers -------------------------------------------------------------------------------------------------------- */

typedef struct workshop {
    const bench_scene *scene;
    tides_renderer *renderers[MAKERS]; /* one for each maker, since a renderer counts its own stages */
    bench_limit limit;
    double *L, *L_dot;
    size_t pixels;
} workshop;

static const int32_t rules_of[MAKERS] =
    {[INRIA] = TIDES_RULES_INRIA, [GSPLAT] = TIDES_RULES_GSPLAT, [SMOOTH] = TIDES_RULES_SMOOTH};

static tides_status open_workshop(bench *b, workshop *w, tides_error *error) {
    w->pixels = (size_t)w->scene->intrinsics.width * (size_t)w->scene->intrinsics.height;
    w->L = malloc(w->pixels * sizeof *w->L);
    w->L_dot = malloc(w->pixels * sizeof *w->L_dot);
    if (!w->L || !w->L_dot) return cli_error(error, TIDES_NO_MEMORY, "out of memory: images");
    tides_status status = bench_limit_make(b, w->scene, &w->limit, error);
    for (int32_t maker = INRIA; maker < MAKERS && status == TIDES_OK; maker++) {
        tides_image_params image = w->scene->image;
        image.rules = rules_of[maker & ~1];
        status = tides_renderer_create(b->device, w->scene->scene, &w->scene->intrinsics, &image, cli_progress_step,
                                       &b->progress, &w->renderers[maker], error);
    }
    return status;
}

static void close_workshop(workshop *w) {
    for (int32_t maker = 0; maker < MAKERS; maker++) tides_renderer_destroy(w->renderers[maker]);
    bench_limit_free(&w->limit);
    free(w->L);
    free(w->L_dot);
}

/* -- a maker's frames of a round ------------------------------------------------------------------------------------------ */

/* The rounds are spread over the scene's time. The frames of a round cover half of the time to the next round. */
static double time_of(const workshop *w, int32_t round, int32_t i) {
    const double share = (round + 0.5 * i / FRAMES_MOST) / FRAME_ROUNDS;
    return w->scene->start + share * (w->scene->stop - w->scene->start);
}

static tides_status limit_frames(workshop *w, int32_t maker, int32_t round, int32_t frames, double s[STAGES],
                                 frame_times *times, tides_error *error) {
    static const frame_stage stage_of[LIMIT_STAGES] = {[LIMIT_PROJECT] = STAGE_PROJECT,
                                                       [LIMIT_SORT] = STAGE_SORT,
                                                       [LIMIT_LISTS] = STAGE_SWEEP,
                                                       [LIMIT_COMPOSITE] = STAGE_COMPOSITE};
    limit_counts *counts = &times->counted[maker - LIMIT];
    tides_status status = TIDES_OK;
    for (int32_t i = 0; i < frames && status == TIDES_OK; i++) {
        status = bench_limit_frame(&w->limit, w->scene, time_of(w, round, i), maker == LIMIT, counts, error);
        for (int k = 0; k < LIMIT_STAGES && status == TIDES_OK; k++) s[stage_of[k]] += counts->seconds[k];
    }
    return status;
}

static tides_status renderer_frames(workshop *w, int32_t maker, int32_t round, int32_t frames, double s[STAGES],
                                    frame_times *times, tides_error *error) {
    tides_renderer *renderer = w->renderers[maker];
    tides_frame frame = {{NULL}};
    tides_render_stats before, *after = &times->done[maker];
    tides_status status = TIDES_OK;
    if (maker & 1) { /* luminance alone: a plane of log-luminance would come from the kernel with rates */
        frame.plane[TIDES_Y] = w->L;
    } else {
        frame.plane[TIDES_L] = w->L;
        frame.plane[TIDES_L_DOT] = w->L_dot;
    }
    tides_renderer_stats(renderer, &before);
    for (int32_t i = 0; i < frames && status == TIDES_OK; i++)
        status = tides_renderer_frame(renderer, w->scene->camera, time_of(w, round, i), &frame, error);
    tides_renderer_stats(renderer, after);
    s[STAGE_MOTION] = after->time_motion_s - before.time_motion_s;
    s[STAGE_SWEEP] = after->time_sweep_s - before.time_sweep_s;
    s[STAGE_PROJECT] = after->time_project_s - before.time_project_s;
    s[STAGE_SORT] = after->time_sort_s - before.time_sort_s;
    s[STAGE_COMPOSITE] = after->time_composite_s - before.time_composite_s;
    s[STAGE_TRANSFER] = after->time_transfer_s - before.time_transfer_s;
    return status;
}

static tides_status make_frames(workshop *w, int32_t maker, int32_t round, int32_t frames, double s[STAGES], frame_times *times,
                                tides_error *error) {
    memset(s, 0, STAGES * sizeof *s);
    const double began = cli_now(), processor = bench_processor_s(1);
    tides_status status = maker < INRIA ? limit_frames(w, maker, round, frames, s, times, error)
                                        : renderer_frames(w, maker, round, frames, s, times, error);
    s[STAGE_FRAME] = cli_now() - began;
    s[STAGE_PROCESSOR] = bench_processor_s(1) - processor;
    s[STAGE_OTHER] = s[STAGE_FRAME];
    for (int k = 0; k < STAGE_OTHER; k++) s[STAGE_OTHER] -= s[k];
    for (int k = 0; k < STAGES; k++) s[k] /= frames;
    return status;
}

/* -- the measurement --------------------------------------------------------------------------------------------------- */

/* How far the limit's image is from that of inria, which it renders. */
static void compare_images(const workshop *w, frame_times *times) {
    double apart = 0, rate_apart = 0, rate = 0;
    for (size_t i = 0; i < w->pixels; i++) {
        apart += fabs(w->L[i] - (double)w->limit.L[i]);
        rate_apart += fabs(w->L_dot[i] - (double)w->limit.L_dot[i]);
        rate += fabs(w->L_dot[i]);
    }
    times->L_apart = apart / (double)w->pixels;
    times->L_dot_apart = rate > 0 ? rate_apart / rate : 0;
}

/* The first frames build kernels and fill caches. They tell how many frames make a round, and how far images differ. */
static tides_status warm_up(workshop *w, frame_times *times, int32_t *frames, tides_error *error) {
    static const int32_t order[] = {LIMIT, INRIA, LIMIT + 1, INRIA + 1, GSPLAT, GSPLAT + 1, SMOOTH, SMOOTH + 1};
    double s[STAGES] = {0}, slowest = 0;
    tides_status status = TIDES_OK;
    for (int i = 0; i < MAKERS && status == TIDES_OK; i++) {
        if (order[i] < INRIA && !times->limited) continue;
        for (int again = 0; again < 2 && status == TIDES_OK; again++) status = make_frames(w, order[i], 0, 1, s, times, error);
        slowest = fmax(slowest, s[STAGE_FRAME]);
        if (order[i] == INRIA && times->limited && status == TIDES_OK) compare_images(w, times);
    }
    *frames = (int32_t)fmax(1, fmin(FRAMES_MOST, ROUND_S / slowest));
    for (int32_t maker = INRIA; maker < MAKERS; maker++) times->done[maker] = (tides_render_stats){0};
    return status;
}

static tides_status take_turns(bench *b, workshop *w, frame_times *times, int32_t frames, tides_error *error) {
    tides_render_stats before[MAKERS];
    tides_status status = TIDES_OK;
    for (int32_t maker = INRIA; maker < MAKERS; maker++) tides_renderer_stats(w->renderers[maker], &before[maker]);
    for (int32_t round = 0; round < times->rounds; round++)
        for (int32_t maker = times->limited ? LIMIT : INRIA; maker < MAKERS && status == TIDES_OK; maker++) {
            double s[STAGES];
            status = make_frames(w, maker, round, frames, s, times, error);
            for (int k = 0; k < STAGES; k++) times->s[maker][k][round] = s[k];
            if (cli_progress_step(&b->progress, 0, "frames")) return cli_error(error, TIDES_CANCELLED, "stopped on request");
        }
    times->frames = (int64_t)times->rounds * frames;
    for (int32_t maker = INRIA; maker < MAKERS; maker++) { /* the statistics of these frames alone */
        tides_render_stats *d = &times->done[maker];
        d->tile_jobs -= before[maker].tile_jobs;
        d->blocks -= before[maker].blocks;
        d->gaussians_projected -= before[maker].gaussians_projected;
        d->gaussians_culled -= before[maker].gaussians_culled;
        d->pairs_evaluated -= before[maker].pairs_evaluated;
        d->sweeps -= before[maker].sweeps;
    }
    return status;
}

tides_status frames_measure(bench *b, const bench_scene *scene, frame_times *times, tides_error *error) {
    workshop w = {.scene = scene};
    int32_t frames = 1;
    memset(times, 0, sizeof *times);
    times->rounds = b->quick ? FRAME_ROUNDS_QUICK : FRAME_ROUNDS;
    tides_status status = open_workshop(b, &w, error);
    times->limited = w.limit.limit != NULL;
    memcpy(times->why, w.limit.why, sizeof times->why);
    if (status == TIDES_OK) status = warm_up(&w, times, &frames, error);
    if (status == TIDES_OK) status = take_turns(b, &w, times, frames, error);
    close_workshop(&w);
    return status;
}
