/* Exact points against frames: the cost of a point, in core seconds of this process, and of an interval's rows and lists.
 *   bench_points RUN.json [START [INTERVAL [POINTS [DEVICE [COMPARE]]]]]
 * Points are where events are: anywhere in the interval, at pixels as often as log_luminance changes there. Compare numbers of
 * one run only. */
#include "render/td_render.h"
#include "tides.h"
#include "tests/support/scene_make.h"
#include "tests/support/tile_points.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { FRAMES = 8, ROUNDS = 5 };

static void stop_on(tides_status status, const tides_error *error) {
    if (status == TIDES_OK) return;
    fprintf(stderr, "bench_points: %s\n", error->text);
    exit(1);
}

/* Pixels by their share of the sum of |L_dot|, which becomes running sums. */
static void scatter(double *rates, size_t pixels, int32_t width, double start, double length, td_point *points, size_t count) {
    uint64_t state = 1;
    double sum = 0;
    for (size_t i = 0; i < pixels; i++) rates[i] = sum += fabs(rates[i]);
    for (size_t i = 0; i < count; i++) {
        const double at = sum * scene_between(&state, 0, 1);
        size_t low = 0, high = pixels - 1;
        while (low < high) {
            const size_t middle = (low + high) / 2;
            if (rates[middle] < at)
                low = middle + 1;
            else
                high = middle;
        }
        points[i] = (td_point){start + length * scene_between(&state, 0, 1), (int32_t)low % width, (int32_t)low / width};
    }
}

static double core_seconds(void) { return (double)clock() / CLOCKS_PER_SEC; }

/* Core seconds of a frame, the least of some. */
static double time_frames(tides_renderer *renderer, const tides_trajectory *camera, double time, double *planes,
                          size_t pixels) {
    double best = HUGE_VAL;
    tides_error error;
    for (int i = 0; i < FRAMES; i++) {
        tides_frame frame = {{NULL}};
        frame.plane[TIDES_L] = planes;
        frame.plane[TIDES_L_DOT] = planes + pixels;
        const double begun = core_seconds();
        stop_on(td_renderer_frame(renderer, camera, time, &frame, &error), &error);
        if (core_seconds() - begun < best) best = core_seconds() - begun;
    }
    return best;
}

static double time_points(tides_renderer *renderer, const tides_trajectory *camera, const td_point *points, size_t count,
                          td_point_value *values) {
    tides_error error;
    const double begun = core_seconds();
    stop_on(td_renderer_points(renderer, camera, points, count, values, &error), &error);
    return core_seconds() - begun;
}

static int ascending(const void *a, const void *b) {
    const double *x = a, *y = b;
    return *x < *y ? -1 : *x > *y;
}

/* How far values are from pixels of the double reference, whose lists end by `stop_change`. */
static void compare(const char *file, double stop_change, double start, double length, const td_point *points,
                    const td_point_value *values) {
    enum { COMPARED = 1500 };
    static td_point_value truth[COMPARED];
    static double off[COMPARED], late[COMPARED];
    tides_error error;
    tides_session *session = NULL;
    tides_renderer *renderer = NULL;
    tides_session_facts facts;
    stop_on(tides_session_load(file, NULL, 0, "reference", &session, &error), &error);
    tides_session_get(session, &facts);
    facts.values.image.smoothing.stop_change = stop_change;
    stop_on(tides_renderer_create(facts.device, facts.scene, &facts.intrinsics, &facts.values.image, NULL, NULL, &renderer,
                                  &error),
            &error);
    stop_on(td_renderer_sweep(renderer, facts.camera, start, start + length, &error), &error);
    stop_on(tile_points(renderer, facts.camera, points, COMPARED, truth, &error), &error);
    for (int i = 0; i < COMPARED; i++) {
        off[i] = fabs(values[i].L - truth[i].L);
        late[i] = off[i] / (fabs(truth[i].L_dot) + 1e-9);
    }
    qsort(off, COMPARED, sizeof *off, ascending);
    qsort(late, COMPARED, sizeof *late, ascending);
    printf("stop_change %g: L is off by %.2g (median), %.2g (p95), %.2g; an event by %.2g, %.2g, %.2g us\n", stop_change,
           off[COMPARED / 2], off[COMPARED * 95 / 100], off[COMPARED - 1], 1e6 * late[COMPARED / 2],
           1e6 * late[COMPARED * 95 / 100], 1e6 * late[COMPARED - 1]);
    tides_renderer_destroy(renderer);
    tides_session_close(session);
}

int main(int argc, char **argv) {
    if (argc < 2) {
        fprintf(stderr, "usage: bench_points RUN.json [START [INTERVAL [POINTS [DEVICE [COMPARE]]]]]\n");
        return 2;
    }
    const double start = argc > 2 ? atof(argv[2]) : 0.1, length = argc > 3 ? atof(argv[3]) : 0.005;
    const size_t count = argc > 4 ? (size_t)atol(argv[4]) : 40000;
    tides_error error;
    tides_session *session = NULL;
    tides_renderer *renderer = NULL;
    tides_session_facts facts;
    stop_on(tides_session_load(argv[1], NULL, 0, argc > 5 ? argv[5] : "cpu", &session, &error), &error);
    stop_on(tides_session_renderer(session, NULL, NULL, &renderer, &error), &error);
    tides_session_get(session, &facts);
    const size_t pixels = (size_t)facts.intrinsics.width * (size_t)facts.intrinsics.height;
    double *planes = malloc(2 * pixels * sizeof *planes);
    td_point *points = malloc(count * sizeof *points);
    td_point_value *values = malloc(count * sizeof *values);
    if (!planes || !points || !values) exit(1);
    double frame = time_frames(renderer, facts.camera, start, planes, pixels);
    scatter(planes + pixels, pixels, facts.intrinsics.width, start, length, points, count);
    stop_on(td_renderer_exact_points(renderer, &error), &error);
    double first = HUGE_VAL, again = HUGE_VAL;
    for (int i = 0; i < ROUNDS; i++) {
        stop_on(td_renderer_sweep(renderer, facts.camera, start, start + length, &error), &error);
        const double a = time_points(renderer, facts.camera, points, count, values);
        const double b = time_points(renderer, facts.camera, points, count, values);
        if (a < first) first = a;
        if (b < again) again = b;
    }
    printf("frame: %.2f ms, %.3f us per pixel; %zu points: %.2f ms with rows and lists, %.3f us per point without: %.2f "
           "pixels\n",
           1e3 * frame, 1e6 * frame / (double)pixels, count, 1e3 * first, 1e6 * again / (double)count,
           again / (double)count / (frame / (double)pixels));
    static const double stops[] = {1e-12, 1e-7, 1e-6, 1e-5};
    for (size_t i = 0; i < sizeof stops / sizeof *stops && argc > 6; i++)
        compare(argv[1], stops[i], start, length, points, values);
    free(planes);
    free(points);
    free(values);
    tides_renderer_destroy(renderer);
    tides_session_close(session);
    return 0;
}
