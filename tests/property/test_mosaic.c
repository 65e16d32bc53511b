/* A colour filter: each pixel of an image, its points and its events equal, to the bit, those of a renderer or run whose
 * luminance is that pixel's channel alone. Settings that exclude it are refused. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/event_list.h"
#include "tests/property/renderer_of.h"
#include "tides/exposure.h"
#include "tides/simulate.h"

#include <stdlib.h>

enum { WIDTH = 61, HEIGHT = 43, PIXELS = WIDTH * HEIGHT, FILTERS = 4, CHANNELS = 3 };

static tides_image_params seen_through(int filter, int channel) {
    tides_image_params params;
    tides_image_params_defaults(&params);
    params.background[0] = 0.3, params.background[1] = 0.2, params.background[2] = 0.05;
    params.colour_filter = filter;
    for (int c = 0; c < 3 && channel >= 0; c++) params.luminance[c] = c == channel;
    return params;
}

static tides_renderer *renderer_of(tides_device *device, const random_scene *scene, int filter, int channel) {
    const tides_image_params params = seen_through(filter, channel);
    tides_renderer *renderer = NULL;
    tides_error error;
    scene_expect_ok(tides_renderer_create(device, scene->scene, &scene->camera, &params, NULL, NULL, &renderer, &error),
                    &error);
    return renderer;
}

/* The cells as everybody writes them: RGGB has red at even x and even y, blue at odd and odd. */
static void cells_are_as_named(void **state) {
    (void)state;
    static const char *const names[FILTERS] = {"RGGB", "GRBG", "GBRG", "BGGR"};
    for (int filter = 1; filter <= FILTERS; filter++)
        for (int i = 0; i < 16; i++) {
            const int x = i % 4, y = i / 4;
            assert_int_equal("RGB"[tides_colour_filter_channel(filter, x, y)], names[filter - 1][y % 2 * 2 + x % 2]);
        }
    assert_int_equal(tides_colour_filter_channel(TIDES_FILTER_OFF, 0, 0), -1);
    assert_int_equal(tides_colour_filter_channel(FILTERS + 1, 0, 0), -1);
    assert_int_equal(tides_colour_filter_channel(-1, 0, 0), -1);
}

enum { PLANES = TIDES_R_DOT }; /* of a frame: those before */

static void draw(tides_renderer *renderer, const tides_trajectory *path, double (*planes)[PIXELS]) {
    tides_frame frame = {{NULL}};
    tides_error error;
    for (int c = 0; c < PLANES; c++) frame.plane[c] = planes[c];
    scene_expect_ok(tides_renderer_frame(renderer, path, 0.5, &frame, &error), &error);
}

static void pixels_show_their_channel(void **state) {
    (void)state;
    static double filtered[PLANES][PIXELS], alone[CHANNELS][PLANES][PIXELS];
    const random_recipe recipe = recipe_of(11);
    random_scene scene = random_scene_make(&recipe);
    tides_device *device = open_fast_device();
    tides_error error;
    for (int filter = 1; filter <= FILTERS; filter++) {
        const double sigma = filter == TIDES_FILTER_GRBG ? 1.2 : 0;
        for (int c = -1; c < CHANNELS; c++) {
            tides_renderer *renderer = renderer_of(device, &scene, c < 0 ? filter : 0, c);
            scene_expect_ok(tides_renderer_set_psf(renderer, sigma, TIDES_PSF_LINEAR, &error), &error);
            draw(renderer, scene.path, c < 0 ? filtered : alone[c]);
            tides_renderer_destroy(renderer);
        }
        int differ = 0;
        for (int i = 0; i < PIXELS; i++) {
            const int c = tides_colour_filter_channel(filter, i % WIDTH, i / WIDTH);
            for (int p = 0; p < PLANES; p++) assert_memory_equal(&filtered[p][i], &alone[c][p][i], sizeof(double));
            differ += alone[0][TIDES_L][i] != alone[2][TIDES_L][i];
        }
        assert_true(differ > PIXELS / 2); /* the channels are told apart */
    }
    tides_device_close(device);
    random_scene_free(&scene);
}

static tides_simulator *simulator_of(tides_device *device, const random_scene *scene, const tides_image_params *params,
                                     const tides_stepping *stepping, const tides_sensor *sensor) {
    tides_simulator *simulator = NULL;
    tides_error error;
    scene_expect_ok(tides_simulator_create(device, scene->scene, scene->path, &scene->camera, params, sensor, stepping, 0.4,
                                           0.44, NULL, NULL, &simulator, &error),
                    &error);
    return simulator;
}

static stream run_through(tides_device *device, const random_scene *scene, int filter, int channel,
                          const tides_stepping *stepping, const tides_sensor *sensor) {
    const tides_image_params params = seen_through(filter, channel);
    stream s = {0};
    tides_error error;
    tides_simulator *simulator = simulator_of(device, scene, &params, stepping, sensor);
    scene_expect_ok(tides_simulator_run(simulator, 0.44, collect, &s, NULL, NULL, &error), &error);
    tides_simulator_stats(simulator, &s.stats);
    tides_simulator_destroy(simulator);
    return s;
}

/* Events of `alone` at pixels that see `channel`, each to the bit the next of those in `filtered`; how many. */
static size_t match_channel(const stream *filtered, const stream *alone, int filter, int channel) {
    size_t found = 0, at = 0;
    for (size_t i = 0; i < alone->count; i++) {
        const tides_event *own = &alone->events[i];
        if (tides_colour_filter_channel(filter, own->x, own->y) != channel) continue;
        while (at < filtered->count &&
               tides_colour_filter_channel(filter, filtered->events[at].x, filtered->events[at].y) != channel)
            at++;
        assert_true(at < filtered->count);
        assert_memory_equal(&filtered->events[at++], own, sizeof *own);
        found++;
    }
    return found;
}

static void check_run(uint64_t seed, const tides_stepping *stepping, const tides_sensor *sensor) {
    random_recipe recipe = recipe_of(seed);
    recipe.size = 0.05;
    random_scene scene = random_scene_make(&recipe);
    tides_device *device = open_fast_device();
    stream filtered = run_through(device, &scene, TIDES_FILTER_RGGB, -1, stepping, sensor);
    size_t found = 0;
    uint64_t jobs = 0;
    for (int c = 0; c < CHANNELS; c++) {
        stream alone = run_through(device, &scene, 0, c, stepping, sensor);
        found += match_channel(&filtered, &alone, TIDES_FILTER_RGGB, c);
        jobs += alone.stats.render.tile_jobs;
        free(alone.events);
    }
    assert_int_equal(found, filtered.count);
    assert_true(found > 1000);
    assert_int_equal(jobs, filtered.stats.render.tile_jobs); /* the work of the three is counted */
    free(filtered.events);
    tides_device_close(device);
    random_scene_free(&scene);
}

/* With noise, mismatch and a filter of each pixel's own, which know nothing of the channels. */
static void events_are_their_channels(void **state) {
    (void)state;
    tides_stepping stepping;
    tides_sensor sensor;
    tides_stepping_defaults(&stepping);
    tides_sensor_defaults(&sensor);
    stepping.mode = TIDES_STEPPING_FIXED;
    stepping.step_s = 2e-3;
    sensor.threshold_on = sensor.threshold_off = 0.08;
    sensor.threshold_sigma = 0.01;
    sensor.shot_noise_hz = 20;
    sensor.psf_sigma_px = 0.7;
    sensor.photoreceptor_cutoff_hz = 300;
    check_run(21, &stepping, &sensor);
}

/* The pixel's events, from `at` on: how many. */
static size_t of_pixel(const stream *s, size_t at, int x, int y) {
    size_t count = 0;
    while (at + count < s->count && s->events[at + count].x == x && s->events[at + count].y == y) count++;
    return count;
}

static int by_pixel(const void *a, const void *b) {
    const tides_event *x = a, *y = b;
    if (x->y != y->y) return x->y < y->y ? -1 : 1;
    if (x->x != y->x) return x->x < y->x ? -1 : 1;
    return x->t < y->t ? -1 : x->t > y->t;
}

/* What two runs of a channel have unlike: pixels with another number of events; events that are further apart than twice what
 * looking up leaves (10 ns), where the signal hardly crosses its level. */
typedef struct unlike {
    size_t pixels, events;
} unlike;

static unlike compare_channel(const stream *filtered, const stream *alone, int filter, int channel) {
    unlike found = {0};
    size_t f = 0, a = 0;
    for (int i = 0; i < PIXELS; i++) {
        const int x = i % WIDTH, y = i / WIDTH;
        const size_t own = of_pixel(filtered, f, x, y), one = of_pixel(alone, a, x, y);
        if (tides_colour_filter_channel(filter, x, y) == channel) {
            found.pixels += own != one;
            for (size_t k = 0; k < own && own == one; k++)
                found.events += llabs(filtered->events[f + k].t - alone->events[a + k].t) > 20;
        }
        f += own, a += one;
    }
    return found;
}

/* Steps are chosen for all three channels together: events looked up in the image are the same up to what that leaves, but for
 * those that both runs know to be uncertain. */
static void solved_events_are_their_channels(void **state) {
    (void)state;
    random_recipe recipe = recipe_of(23);
    recipe.size = 0.05;
    random_scene scene = random_scene_make(&recipe);
    tides_device *device = open_fast_device();
    tides_stepping stepping;
    tides_sensor sensor;
    tides_stepping_defaults(&stepping);
    tides_sensor_defaults(&sensor);
    stepping.solve = TIDES_SOLVE_DOUBLE;
    stepping.unit = TIDES_UNIT_BLOCK;
    sensor.threshold_on = sensor.threshold_off = 0.08;
    stream filtered = run_through(device, &scene, TIDES_FILTER_BGGR, -1, &stepping, &sensor);
    qsort(filtered.events, filtered.count, sizeof *filtered.events, by_pixel);
    assert_true(filtered.stats.solve == TIDES_SOLVE_DOUBLE && filtered.stats.events_solved > 1000);
    for (int c = 0; c < CHANNELS; c++) {
        stream alone = run_through(device, &scene, 0, c, &stepping, &sensor);
        qsort(alone.events, alone.count, sizeof *alone.events, by_pixel);
        const unlike found = compare_channel(&filtered, &alone, TIDES_FILTER_BGGR, c);
        print_message("channel %d: %zu pixels and %zu events of %zu unlike\n", c, found.pixels, found.events, alone.count);
        assert_true(found.pixels <= filtered.stats.events_uncertain + alone.stats.events_uncertain);
        assert_true(1000 * found.events <= alone.count);
        free(alone.events);
    }
    free(filtered.events);
    tides_device_close(device);
    random_scene_free(&scene);
}

static void refused(void **state) {
    (void)state;
    const random_recipe recipe = recipe_of(31);
    random_scene scene = random_scene_make(&recipe);
    tides_device *device = open_fast_device();
    tides_renderer *renderer = NULL;
    tides_error error;
    tides_image_params params = seen_through(TIDES_FILTER_RGGB, 1);
    tides_status status = tides_renderer_create(device, scene.scene, &scene.camera, &params, NULL, NULL, &renderer, &error);
    assert_int_equal(status, TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "image.luminance is given beside sensor.colour_filter"));
    params = seen_through(FILTERS + 1, -1);
    status = tides_renderer_create(device, scene.scene, &scene.camera, &params, NULL, NULL, &renderer, &error);
    assert_int_equal(status, TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "sensor.colour_filter: 5 is none of"));
    assert_null(renderer);
    renderer = renderer_of(device, &scene, TIDES_FILTER_RGGB, -1);
    tides_exposure exposure;
    static double light[PIXELS];
    tides_exposure_defaults(&exposure);
    exposure.colour = 0;
    status = tides_renderer_expose(renderer, scene.path, 0.5, &exposure, light, NULL, &error);
    assert_int_equal(status, TIDES_UNSUPPORTED);
    assert_non_null(strstr(error.text, "exposure.colour is false with sensor.colour_filter"));
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    random_scene_free(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cells_are_as_named),
        cmocka_unit_test(pixels_show_their_channel),
        cmocka_unit_test(events_are_their_channels),
        cmocka_unit_test(solved_events_are_their_channels),
        cmocka_unit_test(refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
