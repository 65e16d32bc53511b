/* The exact stream of an image: what every error of a benchmark is measured against (DESIGN 7).
 *
 * Refined level by level until the last refinement moves nothing. Under `smooth` a level has half the step of the one before
 * everywhere: its tolerance is a sixteenth, since the cubic's error falls with the fourth power, and its longest step is half,
 * in case the estimate is blind somewhere. It is rendered by the double-precision reference, so that what single precision
 * does to event times counts as an error of whoever uses it. Where the image jumps (`inria`) there is no order of convergence
 * to go by: equal steps, thousands of them, on the device that is measured. */
#include "bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Nothing moves: the unit that events are counted in. */
#define SETTLED_US 1e-3
/* No level after one that took so many full renders: it would take twice that. Renders, not seconds, so that the exact stream
 * doesn't depend on what else the machine does. */
#define LONG_RENDERS 400.0        /* in double */
#define LONG_EQUAL_RENDERS 1000.0 /* equal steps */

/* Smooth images: the first level's tolerance. Its longest step is the scene's truth_step_s: short beside whatever vibrates. */
#define FIRST_TOLERANCE 1e-3
#define LAST_TOLERANCE 1e-9
#define LAST_QUICK_TOLERANCE 1e-7
#define LEAST_STEP_S 1e-8

/* Images that jump: steps per second. LEAST is twice what the finest method has; with --quick half as fine. */
#define FIRST_RATE 64000.0
#define LEAST_RATE 128000.0
#define LAST_RATE 512000.0

int32_t bench_is_continuous(const tides_image_params *image) {
    const tides_smoothing *s = &image->smoothing;
    return image->rules == TIDES_RULES_SMOOTH && s->taper_end > s->taper_begin && s->stop_change > 0 && s->near_fade > 1 &&
           s->soft_depth > 0 && s->ellipses;
}

static tides_stepping level_of(const bench_scene *scene, int32_t continuous, const bench_refining *how, int32_t level) {
    tides_stepping s;
    tides_stepping_defaults(&s);
    s.model = TIDES_MODEL_HERMITE;
    if (continuous) {
        s.mode = TIDES_STEPPING_ERROR;
        s.step_s = ldexp(scene->truth_step_s, -level);
        s.tolerance = ldexp(FIRST_TOLERANCE, -4 * level);
        s.min_step_s = LEAST_STEP_S;
    } else {
        s.mode = TIDES_STEPPING_FIXED;
        s.step_s = ldexp(1 / how->first_rate, -level);
    }
    return s;
}

/* Is another level worth its time? */
static int32_t goes_on(const bench_refining *how, const tides_stepping *done, int32_t continuous, int32_t level,
                       const tides_match *moved, double renders) {
    const int32_t settled = level > 0 && moved->mismatch_percent == 0 && moved->dt_p99_us <= SETTLED_US;
    if (level == 0) return 1;
    if (continuous) return !settled && renders < how->long_renders && done->tolerance / 16 >= how->last_tolerance;
    const double rate = 1 / done->step_s;
    if (rate < how->least_rate * 0.999) return 1;
    return !settled && renders < how->long_renders && rate < how->last_rate * 0.999;
}

tides_status bench_refine(bench *b, const bench_scene *scene, int32_t rules, const bench_refining *how, bench_truth *truth,
                          tides_error *error) {
    bench_stream coarse = {.events = NULL}, fine = {.events = NULL};
    bench_row run;
    tides_match moved = {.matched = 0};
    tides_image_params image = scene->image;
    image.rules = rules;
    const int32_t continuous = bench_is_continuous(&image);
    tides_stepping stepping = level_of(scene, continuous, how, 0);
    tides_status status = TIDES_OK;
    for (int32_t level = 0; status == TIDES_OK; level++) {
        const bench_stream spare = coarse;
        coarse = fine;
        fine = spare;
        memset(&run, 0, sizeof run);
        stepping = level_of(scene, continuous, how, level);
        status = bench_simulate(b, scene, rules, &scene->sensor, &stepping, &fine, &run, error);
        cli_progress_end(&b->progress);
        if (status == TIDES_OK && level > 0)
            status =
                tides_match_events(fine.events, fine.count, coarse.events, coarse.count, BENCH_MATCH_LIMIT_S, &moved, error);
        if (status != TIDES_OK || !goes_on(how, &stepping, continuous, level, &moved, run.stats.renders_full_frame_equivalent))
            break;
    }
    free(coarse.events);
    if (status == TIDES_OK && fine.count == 0)
        status = cli_error(error, TIDES_BAD_ARGUMENT, "scene %s: nothing fires, so nothing can be measured", scene->name);
    if (status != TIDES_OK) {
        free(fine.events);
        return status;
    }
    const double tolerance = stepping.mode == TIDES_STEPPING_FIXED ? 0 : stepping.tolerance;
    *truth = (bench_truth){fine, 1 / stepping.step_s, tolerance, moved, run.stats.worst_residual};
    return TIDES_OK;
}

/* What a benchmark's exact streams are worth. */
static bench_refining refining_of(const bench *b, int32_t continuous) {
    const double half = b->quick ? 0.5 : 1;
    return (bench_refining){.first_rate = half * FIRST_RATE,
                            .least_rate = half * LEAST_RATE,
                            .last_rate = b->quick ? half * LEAST_RATE : LAST_RATE,
                            .last_tolerance = b->float_truth ? BENCH_FLOAT_TOLERANCE
                                              : b->quick     ? LAST_QUICK_TOLERANCE
                                                             : LAST_TOLERANCE,
                            .long_renders = continuous ? LONG_RENDERS : LONG_EQUAL_RENDERS};
}

tides_status bench_find_truth(bench *b, bench_scene *scene, int32_t rules, tides_error *error) {
    tides_image_params image = scene->image;
    image.rules = rules;
    const int32_t continuous = bench_is_continuous(&image);
    const bench_refining how = refining_of(b, continuous);
    bench_truth truth;
    bench on = *b;
    tides_status status = TIDES_OK;
    if (continuous && !b->float_truth) status = tides_device_open("reference", &on.device, error);
    if (status == TIDES_OK) status = bench_refine(&on, scene, rules, &how, &truth, error);
    if (on.device != b->device) tides_device_close(on.device);
    if (status != TIDES_OK) return status;
    free(scene->truth[rules].stream.events);
    scene->truth[rules] = truth;
    const tides_match *moved = &truth.moved;
    const unsigned long long mismatched = moved->missing + moved->spurious;
    bench_say(b,
              "%-13s exact stream of the %s image: %zu events, %.6g steps/s%s; halving the steps moved median %.3g, p95 %.3g, "
              "p99 %.3g, max %.3g us, %llu of them mismatched",
              scene->name, scene->image_name ? scene->image_name : bench_rules_name(rules), truth.stream.count,
              truth.steps_per_s, truth.tolerance > 0 ? " and finer by tile" : "", moved->dt_median_us, moved->dt_p95_us,
              moved->dt_p99_us, moved->dt_max_us, mismatched);
    return TIDES_OK;
}
