/* The exact streams of a benchmark's scenes (tides_exact_stream), against which every error is measured (DESIGN 7).
 *
 * Streams of `smooth` are rendered by the double-precision reference, so that errors of event times by single precision count
 * against the method that uses it. Streams of images that jump (`inria`) are rendered on the device that is measured. */
#include "bench.h"

/* The exact stream's last level is the first that takes so many full renders, in double precision. */
#define LONG_RENDERS 400.0        /* in double */
#define LONG_EQUAL_RENDERS 1000.0 /* with equal steps */

/* Smooth images. The first level's longest step is the scene's truth_step_s, which is short beside any vibration. */
#define LAST_TOLERANCE 1e-9
#define LAST_QUICK_TOLERANCE 1e-7

/* stop_change of the exact stream. By default a smooth image leaves out light that changes L by at most 1e-5, which is 10 ns
 * where L moves by a thousand a second. The exact stream leaves out 1e-9 only, so that the effect counts as an error. Events
 * looked up in double precision don't have it. */
#define STOP_CHANGE 1e-9

/* Images that jump: steps per second. The last rate is twice that of the finest method; with --quick half. */
#define FIRST_RATE 64000.0
#define LEAST_RATE 128000.0
#define LAST_RATE 512000.0

/* Options of a benchmark's exact streams. */
static tides_exact_options options_of(const bench *b, const bench_scene *scene, int32_t continuous) {
    const double half = b->quick ? 0.5 : 1;
    tides_exact_options how;
    tides_exact_options_defaults(&how);
    how.in_double = continuous && !b->float_truth;
    how.first_step_s = scene->truth_step_s;
    how.first_rate = half * FIRST_RATE;
    how.least_rate = half * LEAST_RATE;
    how.last_rate = b->quick ? half * LEAST_RATE : LAST_RATE;
    how.last_tolerance = b->float_truth ? 0 : b->quick ? LAST_QUICK_TOLERANCE : LAST_TOLERANCE; /* 0: the device's */
    how.long_renders = continuous ? LONG_RENDERS : LONG_EQUAL_RENDERS;
    return how;
}

tides_status bench_find_truth(bench *b, bench_scene *scene, int32_t rules, tides_error *error) {
    tides_image_params image = scene->image;
    tides_exact truth;
    tides_error reason = {TIDES_OK, ""};
    image.rules = rules;
    if (tides_image_is_continuous(&image)) image.smoothing.stop_change = STOP_CHANGE;
    const tides_exact_options how = options_of(b, scene, tides_image_is_continuous(&image));
    tides_status status = tides_exact_stream(b->device, scene->scene, scene->camera, &scene->intrinsics, &image, &scene->sensor,
                                             scene->start, scene->stop, &how, cli_progress_step, &b->progress, &truth, &reason);
    cli_progress_end(&b->progress);
    if (status != TIDES_OK) return cli_error(error, status, "scene %s: %s", scene->name, reason.text);
    tides_free(scene->truth[rules].events);
    scene->truth[rules] = truth;
    const tides_match *moved = &truth.moved;
    const unsigned long long mismatched = moved->missing + moved->spurious;
    bench_say(b,
              "%-13s exact stream of the %s image: %zu events, %.6g steps/s%s; halving the steps moved median %.3g, p95 %.3g, "
              "p99 %.3g, max %.3g us, %llu of them mismatched",
              scene->name, scene->image_name ? scene->image_name : bench_rules_name(rules), truth.count, truth.steps_per_s,
              truth.tolerance > 0 ? " and finer by tile" : "", moved->dt_median_us, moved->dt_p95_us, moved->dt_p99_us,
              moved->dt_max_us, mismatched);
    return TIDES_OK;
}
