/* Computes the exact events of an image, against which errors of methods are measured. For tides compare, tides bench, and
 * users who measure their own method.
 *
 * It refines level by level until the last level moves no event. With `smooth` rules each level has half the steps of the one
 * before: its tolerance is a sixteenth, because the cubic's error falls with the fourth power. Its longest step is half, too,
 * in case the estimate misses an error. An image that jumps (`inria`) has no order of convergence, so equal steps are used,
 * thousands of them. */
#include "signal/td_event_buffer.h"
#include "td_base.h"
#include "td_struct.h"
#include "tides/measure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Events that shift by no more than this [us] count as settled: event times are stored in whole nanoseconds. */
#define SETTLED_US 1e-3
/* After a level with this many full renders no level follows, since it would take twice as many. Renders are counted and not
 * seconds, so that the result doesn't depend on the machine's load. */
#define LONG_RENDERS 500.0

/* For smooth images: the first level's tolerance [thresholds], and the shortest step of any level. The first level's longest
 * step is LONGEST_STEP_S, a common frame interval, or the run's length if that is less, divided by SPLIT. */
#define FIRST_TOLERANCE 1e-3
#define LONGEST_STEP_S 0.01
#define SPLIT 8
#define LEAST_STEP_S 1e-8
/* The last level's tolerance [thresholds]. In single precision, rounding hides errors of L below about 1e-6, and thresholds
 * are about 0.2. In double precision, event times settle before rounding matters. */
#define FLOAT_TOLERANCE 3e-6
#define DOUBLE_TOLERANCE 1e-9

/* For images that jump: the first level has a quarter of the last one's renders; 512 kHz means steps of 2 us. */
#define MOST_RATE 512000.0

void tides_exact_options_defaults(tides_exact_options *options) {
    *options = (tides_exact_options){.size = sizeof *options, .long_renders = LONG_RENDERS};
}

int32_t tides_image_is_continuous(const tides_image_params *image) {
    const tides_smoothing *s = &image->smoothing;
    return image->rules == TIDES_RULES_SMOOTH && s->taper_end > s->taper_begin && s->stop_change > 0 && s->near_fade > 1 &&
           s->soft_depth > 0 && s->ellipses;
}

/* Input of all levels. */
typedef struct job {
    tides_device *device;
    const tides_scene *scene;
    const tides_trajectory *camera;
    const tides_intrinsics *intrinsics;
    const tides_image_params *image;
    const tides_sensor *sensor;
    double start, stop;
    tides_exact_options how; /* with defaults filled in */
    int32_t continuous;
    tides_progress progress;
    void *user;
} job;

static tides_status check_options(const tides_exact_options *how, tides_error *error) {
    const struct {
        const char *name;
        double value;
    } numbers[] = {{"first_step_s", how->first_step_s}, {"last_tolerance", how->last_tolerance},
                   {"first_rate", how->first_rate},     {"least_rate", how->least_rate},
                   {"last_rate", how->last_rate},       {"long_renders", how->long_renders}};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        if (!(numbers[i].value >= 0) || !isfinite(numbers[i].value))
            return td_fail(error, TIDES_BAD_ARGUMENT, "exact stream: %s %g must be 0 or more", numbers[i].name,
                           numbers[i].value);
    return TIDES_OK;
}

static double or_else(double given, double otherwise) { return given > 0 ? given : otherwise; }

/* Fills in options that were left open; their defaults depend on the run's length. */
static void fill_in(job *j) {
    const double length = j->stop - j->start;
    tides_exact_options *how = &j->how;
    how->long_renders = or_else(how->long_renders, LONG_RENDERS);
    how->first_step_s = or_else(how->first_step_s, fmin(length, LONGEST_STEP_S) / SPLIT);
    how->last_tolerance = or_else(how->last_tolerance, how->in_double ? DOUBLE_TOLERANCE : FLOAT_TOLERANCE);
    how->first_rate = or_else(how->first_rate, fmin(how->long_renders / 4 / length, MOST_RATE / 2));
    how->least_rate = or_else(how->least_rate, 2 * how->first_rate);
    how->last_rate = or_else(how->last_rate, MOST_RATE);
}

static tides_stepping level_of(const job *j, int32_t level) {
    tides_stepping s;
    tides_stepping_defaults(&s);
    s.model = TIDES_MODEL_HERMITE;
    s.solve = TIDES_SOLVE_OFF;
    s.unit = TIDES_UNIT_TILE;
    if (j->continuous) {
        s.mode = TIDES_STEPPING_ERROR;
        s.step_s = ldexp(j->how.first_step_s, -level);
        s.tolerance = ldexp(FIRST_TOLERANCE, -4 * level);
        s.min_step_s = LEAST_STEP_S;
    } else {
        s.mode = TIDES_STEPPING_FIXED;
        s.step_s = ldexp(1 / j->how.first_rate, -level);
    }
    return s;
}

/* 1 if another level is worth its time. */
static int32_t goes_on(const job *j, const tides_stepping *done, int32_t level, const tides_match *moved, double renders) {
    const tides_exact_options *how = &j->how;
    const int32_t settled = level > 0 && moved->mismatch_percent == 0 && moved->dt_p99_us <= SETTLED_US;
    if (level == 0) return 1;
    if (j->continuous) return !settled && renders < how->long_renders && done->tolerance / 16 >= how->last_tolerance;
    const double rate = 1 / done->step_s;
    if (rate < how->least_rate * 0.999) return 1;
    return !settled && renders < how->long_renders && rate < how->last_rate * 0.999;
}

/* An event sink that keeps all events. */
static int keep(void *user, const tides_event *events, size_t count) {
    td_event_buffer *stream = user;
    if (count == 0) return 0;
    tides_status status = td_event_buffer_reserve(stream, count, NULL);
    if (status != TIDES_OK) return status;
    memcpy(stream->events + stream->count, events, count * sizeof *events);
    stream->count += count;
    return 0;
}

static tides_status simulate(const job *j, const tides_stepping *stepping, td_event_buffer *stream, tides_stats *stats,
                             tides_error *error) {
    tides_simulator *simulator = NULL;
    stream->count = 0;
    tides_status status = tides_simulator_create(j->device, j->scene, j->camera, j->intrinsics, j->image, j->sensor, stepping,
                                                 j->start, j->stop, j->progress, j->user, &simulator, error);
    if (status == TIDES_OK) status = tides_simulator_run(simulator, j->stop, keep, stream, j->progress, j->user, error);
    if (status == TIDES_OK) tides_simulator_stats(simulator, stats);
    tides_simulator_destroy(simulator);
    return status;
}

static tides_status refine(const job *j, tides_exact *exact, tides_error *error) {
    td_event_buffer coarse = {NULL, 0, 0}, fine = {NULL, 0, 0};
    tides_stats stats;
    tides_match moved;
    memset(&moved, 0, sizeof moved);
    memset(&stats, 0, sizeof stats);
    tides_stepping stepping = level_of(j, 0);
    tides_status status = TIDES_OK;
    for (int32_t level = 0; status == TIDES_OK; level++) {
        const td_event_buffer spare = coarse;
        coarse = fine;
        fine = spare;
        stepping = level_of(j, level);
        status = simulate(j, &stepping, &fine, &stats, error);
        if (status == TIDES_OK && level > 0)
            status =
                tides_match_events(fine.events, fine.count, coarse.events, coarse.count, TIDES_MATCH_LIMIT_S, &moved, error);
        if (status != TIDES_OK || !goes_on(j, &stepping, level, &moved, stats.renders_full_frame_equivalent)) break;
    }
    td_event_buffer_release(&coarse);
    if (status == TIDES_OK && fine.count == 0)
        status = td_fail(error, TIDES_BAD_ARGUMENT, "nothing fires, so nothing can be measured; lower the thresholds");
    if (status != TIDES_OK) {
        td_event_buffer_release(&fine);
        return status;
    }
    *exact = (tides_exact){.events = fine.events,
                           .count = fine.count,
                           .steps_per_s = 1 / stepping.step_s,
                           .tolerance = j->continuous ? stepping.tolerance : 0,
                           .moved = moved,
                           .worst_residual = stats.worst_residual,
                           .renders = stats.renders_full_frame_equivalent};
    return TIDES_OK;
}

tides_status tides_exact_stream(tides_device *device, const tides_scene *scene, const tides_trajectory *camera,
                                const tides_intrinsics *intrinsics, const tides_image_params *image, const tides_sensor *sensor,
                                double start, double stop, const tides_exact_options *options, tides_progress progress,
                                void *user, tides_exact *exact, tides_error *error) {
    if (!device || !scene || !camera || !intrinsics || !image || !sensor || !exact)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_exact_stream: one of its pointers is NULL");
    if (!(stop > start)) return td_fail(error, TIDES_BAD_ARGUMENT, "exact stream: stop %g s isn't after %g s", stop, start);
    job j = {device, scene, camera, intrinsics, image, sensor, start, stop, {0}, 0, progress, user};
    tides_exact_options_defaults(&j.how);
    tides_status status = options ? TD_TAKE_STRUCT(tides_exact_options, &j.how, options, error) : TIDES_OK;
    if (status == TIDES_OK) status = check_options(&j.how, error);
    if (status != TIDES_OK) return status;
    j.continuous = tides_image_is_continuous(image);
    fill_in(&j);
    if (j.how.in_double) status = tides_device_open("reference", &j.device, error);
    if (status == TIDES_OK) status = refine(&j, exact, error);
    if (j.how.in_double && j.device != device) tides_device_close(j.device);
    return status;
}

/* -- a session's exact events ------------------------------------------------------------------------------------------ */

/* The exact events of a run on frames: with straight lines between frames, as the method `tides` has them. */
static tides_status of_frames(tides_session *ideal, tides_progress progress, void *user, tides_exact *exact,
                              tides_error *error) {
    td_event_buffer stream = {NULL, 0, 0};
    tides_status status = tides_session_run(ideal, keep, &stream, progress, user, NULL, error);
    if (status == TIDES_OK && stream.count == 0)
        status = td_fail(error, TIDES_BAD_ARGUMENT, "nothing fires, so nothing can be compared; lower the thresholds");
    if (status == TIDES_OK)
        *exact = (tides_exact){.events = stream.events, .count = stream.count};
    else
        td_event_buffer_release(&stream);
    return status;
}

tides_status tides_session_exact(tides_session *session, const tides_exact_options *options, tides_progress progress,
                                 void *user, tides_exact *exact, tides_error *error) {
    if (!session || !exact) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_session_exact: session or exact is NULL");
    tides_session_facts f;
    tides_session *ideal = NULL;
    const char **settings = NULL;
    size_t count = 0;
    tides_session_get(session, &f);
    tides_status status = tides_ideal_settings(f.run, "tides", TIDES_IDEAL_PIXEL, &settings, &count, error);
    if (status == TIDES_OK) status = tides_session_vary(session, settings, count, &ideal, error);
    free(settings);
    if (status != TIDES_OK) return status;
    tides_session_get(ideal, &f);
    const tides_run_values *v = &f.values;
    status = f.frames ? of_frames(ideal, progress, user, exact, error)
                      : tides_exact_stream(f.device, f.scene, f.camera, &f.intrinsics, &v->image, &v->sensor, v->start, v->stop,
                                           options, progress, user, exact, error);
    tides_session_close(ideal);
    return status;
}
