/* The exact stream of a comparison: the ideal pixel with the run's thresholds.
 *
 * Of a scene: the cubic under error control, refined until halving the steps moves nothing any more, or until single precision
 * or the bounds below end it; what the last halving moved is told with the results. Rounding to single precision moves events
 * of slow pixels by a fraction of a microsecond, in methods and exact stream alike: --double takes the reference for the
 * latter. Of frames: nobody knows what happened between them, so that exact are the crossings of straight lines in log
 * luminance from frame to frame, in double precision. */
#include "compare.h"

#include <math.h>

/* The longest first step, a common frame interval. */
#define LONGEST_STEP_S 0.01
/* No level comes after one that took so many full renders; images that jump begin with a quarter of them. */
#define LONG_RENDERS 500.0
#define MOST_RATE 512000.0
#define DOUBLE_TOLERANCE 1e-9 /* of thresholds */

const char *compare_exact_what(const comparison *c) {
    if (c->session.frames) return "straight lines in log luminance between the frames";
    return c->exact.tolerance > 0 ? "cubic under error control, its steps halved" : "cubic on equal steps, halved";
}

static tides_status of_scene(comparison *c, const tides_session_facts *s, tides_error *error) {
    const tides_run_values *v = &s->values;
    const double longest = fmin(v->stop - v->start, LONGEST_STEP_S);
    bench b = {.common = c->common, .directory = c->directory, .device = s->device, .info = s->info, .progress = c->progress};
    const bench_scene scene = {.name = "of the run",
                               .scene = s->scene,
                               .camera = s->camera,
                               .intrinsics = s->intrinsics,
                               .image = v->image,
                               .sensor = v->sensor,
                               .start = v->start,
                               .stop = v->stop,
                               .macro_step_s = longest,
                               .truth_step_s = longest / BENCH_TRUTH_SPLIT};
    const double rate = fmin(LONG_RENDERS / 4 / (v->stop - v->start), MOST_RATE / 2);
    const bench_refining how = {.last_tolerance = c->in_double ? DOUBLE_TOLERANCE : BENCH_FLOAT_TOLERANCE,
                                .first_rate = rate,
                                .least_rate = 2 * rate,
                                .last_rate = MOST_RATE,
                                .long_renders = LONG_RENDERS};
    tides_status status = c->in_double ? tides_device_open("reference", &b.device, error) : TIDES_OK;
    if (status == TIDES_OK) status = bench_refine(&b, &scene, v->image.rules, &how, &c->exact, error);
    if (b.device != s->device) tides_device_close(b.device);
    return status;
}

static tides_status of_frames(comparison *c, tides_session *session, tides_error *error) {
    const tides_status status =
        tides_session_run(session, bench_keep, &c->exact.stream, cli_progress_step, &c->progress, NULL, error);
    if (status != TIDES_OK || c->exact.stream.count) return status;
    return cli_error(error, TIDES_BAD_ARGUMENT, "%s: nothing fires, so nothing can be compared", c->run);
}

tides_status compare_exact(comparison *c, tides_error *error) {
    tides_session *ideal = NULL;
    tides_session_facts facts;
    c->progress.label = "exact";
    tides_status status = compare_configure(c, "tides", 1, NULL, &ideal, error);
    if (status != TIDES_OK) return status;
    tides_session_get(ideal, &facts);
    status = facts.frames ? of_frames(c, ideal, error) : of_scene(c, &facts, error);
    cli_progress_end(&c->progress);
    if (status == TIDES_OK) status = compare_keep_events(c, "exact", &facts, &c->exact.stream, error);
    tides_session_close(ideal);
    return status;
}
