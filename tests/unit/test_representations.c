/* Voxel grids, event frames and time surfaces: by hand, at their limits, and refusals. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/representations.h"

#include "tests/support/event_stream.h"

#include <math.h>
#include <string.h>

enum { W = 3, H = 2, PIXELS = W * H };

static void assert_near(double got, double expected) {
    if (!(fabs(got - expected) <= 1e-14)) fail_msg("got %.17g, expected %.17g", got, expected);
}

static void grid_of(const tides_event *events, size_t count, const tides_voxel_options *options, double *grid) {
    tides_error error;
    if (tides_voxel_grid(events, count, W, H, options, grid, &error) != TIDES_OK) fail_msg("%s", error.text);
}

/* Five bins over 0 to 4: an event at 1.25 goes to bins 1 and 2 by 3 to 1. */
static void events_are_shared_between_bins(void **state) {
    (void)state;
    tides_event events[] = {event_at(0, 0, 0, 1), event_at(125, 2, 1, -1), event_at(400, 1, 0, 1)};
    double grid[5 * PIXELS], sum = 0;
    tides_voxel_options o;
    tides_voxel_options_defaults(&o, TIDES_VOXEL_E2VID);
    o.normalise = TIDES_NORMALISE_NONE;
    grid_of(events, 3, &o, grid);
    assert_near(grid[0], 1);
    assert_near(grid[1 * PIXELS + 5], -0.75);
    assert_near(grid[2 * PIXELS + 5], -0.25);
    assert_near(grid[4 * PIXELS + 1], 1);
    for (int i = 0; i < 5 * PIXELS; i++) sum += fabs(grid[i]);
    assert_near(sum, 3);
}

/* Between two images: events before and after are left out, those on the images' times are in. */
static void interval_of_images(void **state) {
    (void)state;
    tides_event events[] = {event_at(99, 0, 0, 1), event_at(100, 1, 0, 1), event_at(150, 1, 1, 1), event_at(300, 2, 0, -1),
                            event_at(301, 0, 0, 1)};
    double grid[5 * PIXELS];
    tides_voxel_options o;
    tides_voxel_options_defaults(&o, TIDES_VOXEL_TIMELENS);
    assert_int_equal(o.normalise, TIDES_NORMALISE_NONE);
    o.start_ns = 100;
    o.stop_ns = 300;
    grid_of(events, 5, &o, grid);
    assert_near(grid[1], 1);
    assert_near(grid[PIXELS + 4], 1);
    assert_near(grid[4 * PIXELS + 2], -1);
    for (int bin = 0; bin < 5; bin++) assert_near(grid[bin * PIXELS], 0);
}

/* Cells of 1, 1 and -1: mean 1/3, deviation sqrt(8/9) over n and sqrt(4/3) over n - 1. */
static void normalisations(void **state) {
    (void)state;
    tides_event events[] = {event_at(7, 0, 0, 1), event_at(7, 1, 0, 1), event_at(7, 2, 0, -1)};
    double grid[15 * PIXELS];
    tides_voxel_options o;
    tides_voxel_options_defaults(&o, TIDES_VOXEL_E2VID);
    grid_of(events, 3, &o, grid);
    assert_near(grid[0], (2.0 / 3.0) / sqrt(8.0 / 9.0));
    assert_near(grid[2], (-4.0 / 3.0) / sqrt(8.0 / 9.0));
    assert_near(grid[3], 0);
    tides_voxel_options_defaults(&o, TIDES_VOXEL_DSEC);
    assert_int_equal(o.bins, 15);
    grid_of(events, 3, &o, grid);
    assert_near(grid[0], (2.0 / 3.0) / sqrt(4.0 / 3.0));
    for (int kind = TIDES_NORMALISE_POPULATION; kind <= TIDES_NORMALISE_SAMPLE; kind++) {
        o.normalise = kind;
        grid_of(events, 2, &o, grid); /* all equal */
        assert_near(grid[0], 0);
        grid_of(events, 1, &o, grid);
        assert_near(grid[0], 0);
        grid_of(NULL, 0, &o, grid);
        assert_near(grid[0], 0);
    }
    o.bins = 1;
    o.normalise = TIDES_NORMALISE_NONE;
    grid_of(events, 3, &o, grid);
    assert_near(grid[2], -1);
}

static void frames_and_surfaces(void **state) {
    (void)state;
    tides_event events[] = {event_at(-1000000, 0, 0, 1), event_at(0, 0, 0, 1), event_at(0, 0, 0, -1),
                            event_at(2000000, 2, 1, 1), event_at(3000000, 0, 0, 1)};
    double out[2 * PIXELS];
    assert_int_equal(tides_event_frame(events, 5, W, H, out, NULL), TIDES_OK);
    assert_near(out[0], 1);
    assert_near(out[PIXELS], 3);
    assert_near(out[PIXELS + 5], 1);
    assert_near(out[5], 0);
    assert_int_equal(tides_time_surface(events, 5, W, H, 2000000, 1e-3, out, NULL), TIDES_OK);
    assert_near(out[0], exp(-2));
    assert_near(out[PIXELS], exp(-2));
    assert_near(out[PIXELS + 5], 1);
    assert_near(out[5], 0);
    assert_int_equal(tides_event_frame(NULL, 0, W, H, out, NULL), TIDES_OK);
    assert_near(out[PIXELS], 0);
}

static void refused(void **state) {
    (void)state;
    tides_event late_first[] = {event_at(5, 0, 0, 1), event_at(4, 0, 0, 1)}, outside[] = {event_at(5, 3, 0, 1)};
    tides_event flat[] = {event_at(5, 0, 0, 0)};
    double out[5 * PIXELS] = {42};
    tides_voxel_options o;
    tides_error e;
    tides_voxel_options_defaults(&o, TIDES_VOXEL_E2VID);
    assert_int_equal(tides_voxel_grid(late_first, 2, W, H, &o, out, &e), TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(e.text, "event 1 comes before"));
    assert_int_equal(tides_event_frame(outside, 1, W, H, out, &e), TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(e.text, "(3, 0), outside the image of 3x2 px"));
    assert_int_equal(tides_time_surface(flat, 1, W, H, 9, 1.0, out, &e), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_time_surface(flat, 0, W, H, 9, 0.0, out, &e), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_time_surface(flat, 0, W, H, INT64_MAX, 1.0, out, &e), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_event_frame(flat, 0, 0, H, out, &e), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_event_frame(flat, 0, W, H, NULL, &e), TIDES_BAD_ARGUMENT);
    o.bins = 0;
    assert_int_equal(tides_voxel_grid(flat, 0, W, H, &o, out, &e), TIDES_BAD_ARGUMENT);
    o.bins = 5, o.normalise = 3;
    assert_int_equal(tides_voxel_grid(flat, 0, W, H, &o, out, &e), TIDES_BAD_ARGUMENT);
    o.normalise = 0, o.start_ns = 2, o.stop_ns = 1;
    assert_int_equal(tides_voxel_grid(flat, 0, W, H, &o, out, &e), TIDES_BAD_ARGUMENT);
    o.size = 0;
    assert_int_equal(tides_voxel_grid(flat, 0, W, H, &o, out, &e), TIDES_BAD_ARGUMENT);
    assert_true(out[0] == 42);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(events_are_shared_between_bins),
        cmocka_unit_test(interval_of_images),
        cmocka_unit_test(normalisations),
        cmocka_unit_test(frames_and_surfaces),
        cmocka_unit_test(refused),
    };
    return cmocka_run_group_tests_name("representations", tests, NULL, NULL);
}
