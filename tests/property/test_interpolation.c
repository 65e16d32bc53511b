/* Rows interpolated between others (kernels/interpolate.h): their error of log_luminance stays within the tolerance, at kinks
 * of networks too. They are equal to the bit on every device, however launches are cut, and never cross a knot. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/event_list.h"
#include "tests/property/network_scene.h"

#include "render/td_renderer.h"
#include "solver/td_simulator.h"
#include "td_device.h"
#include "tests/support/model_steps.h"
#include "tests/support/moving_scene.h"
#include "tests/support/opencl.h"
#include "td_sort.h"

#include <math.h>
#include <stdlib.h>

static const uint64_t SEED = 4404;
enum { SLOTS = 9 };

/* -- the cubic ----------------------------------------------------------------------------------------------------- */

/* Any cubic polynomial comes back, with its derivative. */
static void test_weights_give_cubics_back(void **state) {
    static const double start = 3.1, stop = 3.107, c[4] = {0.3, -2, 5, 70};
    (void)state;
    for (int i = 0; i <= 8; i++) {
        double time = start + (stop - start) * i / 8, w[TD_CUBIC_REALS], value[3], rate[3];
        const double at[3] = {0, stop - start, time - start};
        for (int k = 0; k < 3; k++) {
            value[k] = c[0] + at[k] * (c[1] + at[k] * (c[2] + at[k] * c[3]));
            rate[k] = c[1] + at[k] * (2 * c[2] + at[k] * 3 * c[3]);
        }
        td_cubic_weights(start, stop, time, w);
        double way = value[1] - value[0];
        assert_true(fabs(value[0] + w[0] * way + w[1] * rate[0] + w[2] * rate[1] - value[2]) < 1e-14);
        assert_true(fabs(w[3] * way + w[4] * rate[0] + w[5] * rate[1] - rate[2]) < 1e-11);
    }
}

/* -- images -------------------------------------------------------------------------------------------------------- */

/* Every tile at SLOTS times spread over (start, stop). */
static double *render_between(tides_renderer *renderer, const tides_trajectory *path, double start, double stop) {
    int tiles = renderer->stats.tiles;
    double times[SLOTS], *planes = malloc((size_t)SLOTS * (size_t)tiles * TD_OUT_SIGNAL * TD_TILE_PIXELS * sizeof *planes);
    td_request *requests = calloc((size_t)SLOTS * (size_t)tiles, sizeof *requests);
    tides_error error;
    assert_true(planes && requests);
    for (int i = 0; i < SLOTS; i++) times[i] = start + (stop - start) * (i + 1) / (SLOTS + 1);
    for (int i = 0; i < SLOTS * tiles; i++) requests[i].tile = i % tiles, requests[i].slot = i / tiles;
    scene_expect_ok(td_renderer_sweep(renderer, path, start, stop, &error), &error);
    scene_expect_ok(td_renderer_tiles(renderer, path,
                                      &(td_tile_batch){times, SLOTS, TD_SIDE_BEGINS, requests, SLOTS * tiles, TD_OUT_SIGNAL},
                                      planes, &error),
                    &error);
    free(requests);
    return planes;
}

static void interpolate(tides_renderer *renderer, double tolerance, double time_tolerance_s) {
    tides_error error;
    scene_expect_ok(td_dynamic_interpolate(&renderer->dynamic, renderer->backend, tolerance, time_tolerance_s, &error), &error);
}

typedef struct cost {
    double worst, rms; /* of log_luminance */
    double share;      /* of the rows wanted that were interpolated */
} cost;

static cost cost_of(tides_device *device, const network_scene *s, double start, double stop, double tolerance,
                    double time_tolerance_s) {
    tides_renderer *exact = make_renderer(device, s->scene, &s->base.camera, TIDES_RULES_SMOOTH);
    tides_renderer *quick = make_renderer(device, s->scene, &s->base.camera, TIDES_RULES_SMOOTH);
    interpolate(quick, tolerance, time_tolerance_s);
    double *a = render_between(exact, s->base.path, start, stop), *b = render_between(quick, s->base.path, start, stop);
    size_t count = (size_t)SLOTS * (size_t)exact->stats.tiles * TD_OUT_SIGNAL * TD_TILE_PIXELS;
    cost found = {0, 0, 0};
    for (size_t i = 0; i < count; i++) {
        if (i / TD_TILE_PIXELS % TD_OUT_SIGNAL != TD_OUT_L) continue;
        double error = fabs(a[i] - b[i]);
        found.worst = fmax(found.worst, error);
        found.rms += 2 * error * error / (double)count;
    }
    found.rms = sqrt(found.rms);
    double all = (double)exact->backend->stats.gaussians_moved, moved = (double)quick->backend->stats.gaussians_moved;
    double sweep = 3 * (double)exact->dynamic.gaussians; /* of both */
    found.share = (all - moved) / (all - sweep);
    assert_int_equal(exact->backend->stats.gaussians_interpolated, 0);
    free(a);
    free(b);
    tides_renderer_destroy(exact);
    tides_renderer_destroy(quick);
    return found;
}

/* Over intervals long and short, with most and with hardly any interpolated; a tolerance ten thousand times as large costs more
 * than the one that is asked for, so the test would see it. */
static void test_cost_stays_within_the_tolerance(void **state) {
    (void)state;
    tides_device *device = open_device("reference");
    network_scene s = network_scene_make(SEED, 0.2);
    for (double length = 0.04; length > 0.004; length /= 3)
        for (double tolerance = 2e-2; tolerance > 1e-5; tolerance /= 10) {
            cost found = cost_of(device, &s, 0.42, 0.42 + length, tolerance, 0);
            print_message("%.4f s, tolerance %.0e: worst %.1e, rms %.1e, %.0f %% interpolated\n", length, tolerance,
                          found.worst, found.rms, 100 * found.share);
            assert_true(found.worst < tolerance && found.share > 0 && found.share <= 1);
        }
    cost all = cost_of(device, &s, 0.42, 0.46, 1e4 * 2e-3, 0);
    assert_true(all.worst > 2e-3 && all.share > 0.99);
    /* A splat that is to be where it belongs within 1 us may be off by less than one that needn't. */
    cost late = cost_of(device, &s, 0.42, 0.46, 1e4 * 2e-3, 1e-6);
    assert_true(late.share < 0.5 && late.worst < 1e-3 * all.worst);
    network_scene_free(&s);
    tides_device_close(device);
}

/* -- bits ---------------------------------------------------------------------------------------------------------- */

static void expect_same_tiles(const tides_renderer *renderer, const double *a, const double *b, const char *what) {
    size_t count = (size_t)SLOTS * (size_t)renderer->stats.tiles * TD_OUT_SIGNAL * TD_TILE_PIXELS;
    for (size_t i = 0; i < count; i++)
        if (memcmp(&a[i], &b[i], sizeof *a) != 0) fail_msg("%s: number %zu is %.9g and %.9g", what, i, a[i], b[i]);
}

/* Renders with interpolation, in launches of so many records (0: as it likes). */
static double *render_with(tides_device *device, const tides_scene *scene, const random_scene *base, int records,
                           uint64_t *interpolated) {
    tides_renderer *renderer = make_renderer(device, scene, &base->camera, TIDES_RULES_SMOOTH);
    if (records) renderer->record_limit = records;
    interpolate(renderer, 2e-2, 1e-3);
    double *planes = render_between(renderer, base->path, 0.40, 0.43);
    *interpolated = renderer->backend->stats.gaussians_interpolated;
    tides_renderer_destroy(renderer);
    return planes;
}

static void check_bits(const tides_scene *scene, const random_scene *base) {
    static const int lanes[] = {16, 8, 4, 1};
    tides_device *reference = open_device("reference-f32"), *device = NULL;
    tides_renderer *shape = make_renderer(reference, scene, &base->camera, TIDES_RULES_SMOOTH);
    uint64_t most, found;
    double *expected = render_with(reference, scene, base, 0, &most), *cut = render_with(reference, scene, base, 48, &found);
    expect_same_tiles(shape, expected, cut, "launches of few records");
    assert_true(most > 0 && found >= most);
    free(cut);
    for (int i = 0; i < 4 && tides_device_open("cpu", &device, NULL) == TIDES_OK; i++) {
        device->info.lanes = lanes[i];
        double *own = render_with(device, scene, base, i ? 0 : 64, &found);
        expect_same_tiles(shape, expected, own, "device and reference");
        assert_true(found >= most);
        free(own);
        tides_device_close(device);
    }
    free(expected);
    tides_renderer_destroy(shape);
    tides_device_close(reference);
}

/* A network, and rows from the host with SH of their own beside a model that isn't interpolated. */
static void test_bits_are_the_same_everywhere(void **state) {
    (void)state;
    network_scene network = network_scene_make(SEED + 1, 0.2);
    check_bits(network.scene, &network.base);
    network_scene_free(&network);
    random_recipe recipe = recipe_of(SEED + 2);
    moving_scene mixed = moving_scene_make(&recipe, 0.5);
    check_bits(mixed.scene, &mixed.base);
    moving_scene_free(&mixed);
    skip_without_opencl();
}

/* -- knots --------------------------------------------------------------------------------------------------------- */

static uint64_t interpolated_in(double start, double stop) {
    random_recipe recipe = recipe_of(SEED + 3);
    moving_scene s = moving_scene_make(&recipe, 0.5);
    tides_device *device = open_device("reference-f32");
    tides_renderer *renderer = make_renderer(device, s.scene, &s.base.camera, TIDES_RULES_SMOOTH);
    interpolate(renderer, 1e6, 0);
    free(render_between(renderer, s.base.path, start, stop));
    uint64_t found = renderer->backend->stats.gaussians_interpolated;
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    moving_scene_free(&s);
    return found;
}

/* Up to a knot and from it on, but not across, however much is tolerated. */
static void test_never_across_a_knot(void **state) {
    (void)state;
    assert_true(interpolated_in(MOVING_KNOT - 0.01, MOVING_KNOT) > 0);
    assert_true(interpolated_in(MOVING_KNOT, MOVING_KNOT + 0.01) > 0);
    assert_int_equal(interpolated_in(MOVING_KNOT - 0.01, MOVING_KNOT + 1e-6), 0);
}

/* -- events -------------------------------------------------------------------------------------------------------- */

/* The network scene from 0.3 s to 0.4 s, across a knot, in macro steps of 20 ms; in one call or in many. */
static stream simulate(tides_device *device, const network_scene *scene, int interpolates, int calls) {
    stream s;
    tides_error error;
    tides_image_params params;
    tides_sensor sensor;
    tides_stepping stepping;
    tides_simulator *simulator = NULL;
    memset(&s, 0, sizeof s);
    tides_image_params_defaults(&params);
    tides_sensor_defaults(&sensor);
    model_steps(&stepping);
    sensor.threshold_on = sensor.threshold_off = 0.05;
    stepping.step_s = 0.02;
    stepping.interpolate_motion = interpolates;
    scene_expect_ok(tides_simulator_create(device, scene->scene, scene->base.path, &scene->base.camera, &params, &sensor,
                                           &stepping, 0.3, 0.4, NULL, NULL, &simulator, &error),
                    &error);
    if (calls > 1) simulator->renderer->record_limit = 100;
    for (int i = 1; i <= calls; i++)
        scene_expect_ok(tides_simulator_run(simulator, i < calls ? 0.3 + 0.1 * i / calls : 0.4, collect, &s, NULL, NULL,
                                            &error),
                        &error);
    tides_simulator_stats(simulator, &s.stats);
    tides_simulator_destroy(simulator);
    return s;
}

static int by_pixel(const void *a, const void *b) {
    const tides_event *x = a, *y = b;
    if (x->y != y->y) return x->y < y->y ? -1 : 1;
    if (x->x != y->x) return x->x < y->x ? -1 : 1;
    return x->t < y->t ? -1 : x->t > y->t;
}

/* Most events are there again, and 95 % of these within what the run says of its own times. */
static void expect_near(stream *a, stream *b) {
    double *late = calloc(a->count + 1, sizeof *late);
    size_t i = 0, k = 0, pairs = 0;
    assert_non_null(late);
    qsort(a->events, a->count, sizeof *a->events, by_pixel);
    qsort(b->events, b->count, sizeof *b->events, by_pixel);
    while (i < a->count && k < b->count) {
        const tides_event *x = &a->events[i], *y = &b->events[k];
        int64_t apart = x->t - y->t;
        if (x->y == y->y && x->x == y->x && x->polarity == y->polarity && apart < 200000 && apart > -200000) {
            late[pairs++] = fabs(1e-9 * (double)apart);
            i++, k++;
        } else if (by_pixel(x, y) < 0)
            i++;
        else
            k++;
    }
    qsort(late, pairs, sizeof *late, td_ascending);
    double p95 = late[pairs * 95 / 100];
    print_message("%zu events, %zu with interpolation, %zu pairs, p95 %.2g us apart; estimated p95 %.2g us\n", a->count,
                  b->count, pairs, 1e6 * p95, 1e6 * a->stats.error_p95_s);
    assert_true((double)pairs > 0.999 * (double)a->count && p95 <= a->stats.error_p95_s);
    free(late);
}

static void test_events(void **state) {
    (void)state;
    network_scene scene = network_scene_make(SEED + 4, 0.3);
    tides_device *device = open_device("reference-f32");
    stream exact = simulate(device, &scene, 0, 1), quick = simulate(device, &scene, 1, 1), cut = simulate(device, &scene, 1, 7);
    assert_true(exact.count > 1000 && exact.stats.render.gaussians_interpolated == 0);
    assert_true(quick.stats.render.gaussians_interpolated > 0);
    assert_true(quick.stats.render.gaussians_moved < exact.stats.render.gaussians_moved);
    assert_int_equal(cut.count, quick.count);
    assert_memory_equal(cut.events, quick.events, quick.count * sizeof *quick.events);
    expect_near(&exact, &quick);
    free(exact.events);
    free(quick.events);
    free(cut.events);
    network_scene_free(&scene);
    tides_device_close(device);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_weights_give_cubics_back),
                                       cmocka_unit_test(test_cost_stays_within_the_tolerance),
                                       cmocka_unit_test(test_bits_are_the_same_everywhere),
                                       cmocka_unit_test(test_never_across_a_knot), cmocka_unit_test(test_events)};
    print_message("seed %llu\n", (unsigned long long)SEED);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
