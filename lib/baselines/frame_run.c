/* Runs a method on frames: of a sequence, or of a renderer at a fixed rate or at ESIM's adaptive times. It handles progress
 * and statistics; the method makes the events of a frame. */
#include "render/td_render.h"
#include "td_baseline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* State of a run on frames. */
typedef struct frame_run {
    tides_baseline *baseline;
    const tides_frame_supply *supply;
    tides_event_sink sink;
    void *sink_user;
    tides_progress progress;
    void *user;
    td_share share; /* progress of the current time */
    double *Y;      /* a frame, all planes */
    double *speeds; /* (pixels) L_dot or Z of the frame, if ESIM samples by brightness or by motion */
    uint64_t frames;
    int32_t cut; /* 1: the first or last interval crosses the run's start or stop, and events outside are left out */
    int64_t start_ns, stop_ns; /* the run's */
    tides_stats stats;
} frame_run;

/* Passes on events within the run. They come in order of time, so these are one contiguous part. */
static int take(void *user, const tides_event *events, size_t count) {
    frame_run *r = user;
    if (r->cut) {
        for (; count > 0 && events[0].t < r->start_ns; count--) events++;
        while (count > 0 && events[count - 1].t > r->stop_ns) count--;
        if (count == 0) return 0;
    }
    for (size_t k = 0; k < count; k++) {
        if (events[k].polarity > 0)
            r->stats.events_on++;
        else
            r->stats.events_off++;
        r->stats.events_by_cause[events[k].cause]++;
    }
    r->stats.events += count;
    r->stats.events_written += count;
    double began = td_now();
    int stop = r->sink ? r->sink(r->sink_user, events, count) : 0;
    r->stats.time_sink_s += td_now() - began;
    return stop;
}

/* Gives the frame in r->Y, at `offset` after `time`, to the method. */
static tides_status push(frame_run *r, double time, double offset, tides_error *error) {
    const tides_frame_supply *supply = r->supply;
    double part = ((time - supply->start) + offset) / (supply->stop - supply->start);
    if (r->progress && r->progress(r->user, fmin(fmax(part, 0), 1), "simulating"))
        return td_fail(error, TIDES_CANCELLED, "stopped on request at %.9g s", time + offset);
    double began = td_now(), sunk = r->stats.time_sink_s;
    tides_status status = td_baseline_push(r->baseline, time, offset, r->Y, take, r, error);
    r->stats.time_compare_s += td_now() - began - (r->stats.time_sink_s - sunk);
    r->frames++;
    return status;
}

static tides_status fail_outside(const frame_run *r, double from, double to, tides_error *error) {
    const tides_frame_supply *supply = r->supply;
    return td_fail(error, TIDES_BAD_ARGUMENT,
                   "frames last from %.15g to %.15g s, and nothing of that lies within time.start = %.15g and time.stop = "
                   "%.15g s%s",
                   from, to, supply->start, supply->stop,
                   from >= supply->stop ? ": set them to that, or frames.rebase to true, which puts the first frame at 0" : "");
}

/* Finds the frames [*first, *end) that bound all intervals which overlap the run. A run that begins or ends within an
 * interval uses all of it, and keeps the events of its own part. */
static tides_status find_frames(frame_run *r, double lasts, double rounding, size_t *first, size_t *end, tides_error *error) {
    const tides_frame_supply *supply = r->supply;
    const size_t count = tides_frames_count(supply->frames);
    const double from = tides_frames_time(supply->frames, 0), to = tides_frames_time(supply->frames, count - 1) + lasts;
    const size_t step = lasts > 0 ? 0 : 1; /* frames from an interval's first to its last */
    *first = 0, *end = count;
    while (*first + step < count && tides_frames_time(supply->frames, *first + step) + lasts <= supply->start + rounding)
        ++*first;
    while (*end > *first + step && tides_frames_time(supply->frames, *end - 1 - step) >= supply->stop - rounding) --*end;
    if (*first + step >= *end) return fail_outside(r, from, to, error);
    r->start_ns = td_time_ns(supply->start);
    r->stop_ns = td_time_ns(supply->stop);
    r->cut = tides_frames_time(supply->frames, *first) < supply->start ||
             tides_frames_time(supply->frames, *end - 1) + lasts > supply->stop + rounding;
    return TIDES_OK;
}

static tides_status run_sequence(frame_run *r, tides_error *error) {
    const tides_frame_supply *supply = r->supply;
    tides_frames *frames = supply->frames;
    int32_t width, height, planes = (int32_t)(td_baseline_values(r->baseline) / r->baseline->pixels);
    tides_frames_size(frames, &width, &height);
    if (width != r->baseline->width || height != r->baseline->height)
        return td_fail(error, TIDES_BAD_ARGUMENT, "frames are %d x %d px, the pixels %d x %d", width, height,
                       r->baseline->width, r->baseline->height);
    if (tides_frames_planes(frames) != planes)
        return td_fail(error, TIDES_BAD_ARGUMENT, "frames have %d values per pixel; method %s takes %s",
                       tides_frames_planes(frames), r->baseline->method->name, planes > 1 ? "voxel grids" : "luminance");
    const double lasts = td_baseline_lasts(r->baseline), rounding = planes > 1 ? 1e-9 : 0;
    size_t first, end;
    tides_status status = find_frames(r, lasts, rounding, &first, &end, error);
    double last = supply->start;
    for (size_t k = first; status == TIDES_OK && k < end; k++) {
        const double time = tides_frames_time(frames, k);
        status = tides_frames_read(frames, k, r->Y, error);
        if (status == TIDES_OK) status = push(r, time, 0, error);
        if (r->frames == 1) r->stats.simulated_s = -fmax(time, supply->start);
        last = fmin(time + lasts, supply->stop);
    }
    r->stats.simulated_s += last;
    return status;
}

/* -- renders --------------------------------------------------------------------------------------------------------------- */

/* The value that limits ESIM's next interval, from the rendered frame: the largest |L_dot| [1/s], or the fastest motion
 * [px/s]. */
static tides_status find_fastest(const frame_run *r, double time, double *fastest, tides_error *error) {
    const tides_frame_supply *supply = r->supply;
    if (r->baseline->params.esim.adaptive_sampling == TIDES_ESIM_MOTION)
        return td_renderer_flow(supply->renderer, supply->camera, time, 0, supply->stop - supply->start, r->speeds, fastest,
                                error);
    *fastest = 0;
    for (size_t i = 0; i < r->baseline->pixels; i++) *fastest = fmax(*fastest, fabs(r->speeds[i]));
    return TIDES_OK;
}

/* Time of the next render [s after the start]. Frames are at k / rate (a product, so that rounding doesn't add up), unless
 * ESIM samples adaptively. */
static tides_status next_time(const frame_run *r, double time, double *next, tides_error *error) {
    const tides_frame_supply *supply = r->supply;
    double fastest;
    *next = (double)r->frames / supply->frames_per_second;
    if (r->speeds) {
        tides_status status = find_fastest(r, time, &fastest, error);
        if (status != TIDES_OK) return status;
        *next = tides_esim_next_time(&r->baseline->params.esim, time, fastest);
        if (!(*next > time + 1e-9))
            return td_fail(error, TIDES_OUT_OF_RANGE,
                           "at %.9g s the image changes so fast that ESIM's next render would come within a nanosecond: raise "
                           "esim.simulation_adaptive_sampling_lambda",
                           supply->start + time);
    }
    /* A remainder below a nanosecond would be no interval. */
    if (*next > supply->stop - supply->start - 1e-9) *next = supply->stop - supply->start;
    return TIDES_OK;
}

static tides_status run_renders(frame_run *r, tides_error *error) {
    const tides_frame_supply *supply = r->supply;
    tides_frame frame;
    memset(&frame, 0, sizeof frame);
    frame.plane[TIDES_Y] = r->Y;
    frame.plane[r->baseline->params.esim.adaptive_sampling == TIDES_ESIM_MOTION ? TIDES_Z : TIDES_L_DOT] = r->speeds;
    tides_status status = TIDES_OK;
    if (r->progress) status = tides_renderer_set_progress(supply->renderer, td_share_step, &r->share, error);
    td_renderer_set_epoch(supply->renderer, supply->start);
    for (double time = 0; status == TIDES_OK;) {
        r->share = (td_share){r->progress, r->user, time / (supply->stop - supply->start), 0, "simulating"};
        status = td_renderer_frame(supply->renderer, supply->camera, time, &frame, error);
        if (status == TIDES_OK) status = push(r, supply->start, time, error);
        if (status != TIDES_OK || time >= supply->stop - supply->start) break;
        status = next_time(r, time, &time, error);
    }
    td_renderer_set_epoch(supply->renderer, 0);
    const tides_status silent = r->progress ? tides_renderer_set_progress(supply->renderer, NULL, NULL, error) : TIDES_OK;
    if (status == TIDES_OK) status = silent;
    tides_renderer_stats(supply->renderer, &r->stats.render);
    r->stats.renders_full_frame_equivalent = (double)r->frames;
    r->stats.simulated_s = supply->stop - supply->start;
    return status;
}

/* -- the run ----------------------------------------------------------------------------------------------------------- */

static tides_status check_supply(const frame_run *r, tides_error *error) {
    const tides_frame_supply *supply = r->supply;
    const tides_baseline_params *params = &r->baseline->params;
    if (!supply->frames && !(supply->renderer && supply->camera))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_baseline_run: give frames, or a renderer and its camera");
    if (!(supply->start < supply->stop))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_baseline_run: stop = %.9g s isn't after start = %.9g s", supply->stop,
                       supply->start);
    if (supply->frames && params->method == TIDES_METHOD_ESIM && params->esim.adaptive_sampling == TIDES_ESIM_MOTION)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "esim.simulation_adaptive_sampling_method = \"motion\" needs a scene to render: frames are as they are, "
                       "and have no depth; set it to \"none\"");
    if (!supply->frames && r->baseline->method->planes)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_baseline_run: method %s takes voxel grids, not a scene's renders",
                       r->baseline->method->name);
    if (!supply->frames && !(supply->frames_per_second > 0 && supply->frames_per_second <= 1e9))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_baseline_run: frames_per_second = %.9g; it must lie in (0, 1e9]",
                       supply->frames_per_second);
    return TIDES_OK;
}

static tides_status run(frame_run *r, tides_error *error) {
    const tides_baseline_params *params = &r->baseline->params;
    int adaptive = !r->supply->frames && params->method == TIDES_METHOD_ESIM && params->esim.adaptive_sampling;
    r->Y = td_alloc(td_baseline_values(r->baseline), sizeof *r->Y, error);
    if (adaptive) r->speeds = td_alloc(r->baseline->pixels, sizeof *r->speeds, error);
    if (!r->Y || (adaptive && !r->speeds)) return TIDES_NO_MEMORY;
    tides_status status = r->supply->frames ? run_sequence(r, error) : run_renders(r, error);
    return status == TIDES_OK ? tides_baseline_finish(r->baseline, take, r, error) : status;
}

tides_status tides_baseline_run(tides_baseline *baseline, const tides_frame_supply *supply, tides_event_sink sink,
                                void *sink_user, tides_progress progress, void *user, tides_stats *stats, tides_error *error) {
    if (!baseline || !supply) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_baseline_run: baseline or supply is NULL");
    double began = td_now();
    frame_run r =
        {.baseline = baseline, .supply = supply, .sink = sink, .sink_user = sink_user, .progress = progress, .user = user};
    tides_status status = check_supply(&r, error);
    if (status != TIDES_OK) return status;
    status = run(&r, error);
    free(r.Y);
    free(r.speeds);
    const tides_render_stats *render = &r.stats.render;
    r.stats.run_time_s = td_now() - began;
    r.stats.real_time_factor = r.stats.run_time_s > 0 ? r.stats.simulated_s / r.stats.run_time_s : 0;
    r.stats.peak_memory_bytes = td_peak_memory();
    r.stats.time_other_s = r.stats.run_time_s - r.stats.time_compare_s - r.stats.time_sink_s - render->time_motion_s -
                           render->time_sweep_s - render->time_project_s - render->time_sort_s - render->time_composite_s -
                           render->time_transfer_s;
    if (stats) *stats = r.stats;
    return status;
}
