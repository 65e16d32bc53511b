/* Exact points: each equals a frame of the double reference there, to the error of record paths. Its rate is that of the image
 * of paths. A point doesn't depend, to the bit, on other points that are asked for with it. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "renderer_of.h"
#include "td_device.h"
#include "tests/support/tile_points.h"

#include <math.h>
#include <stdlib.h>

static const double START = 0.3; /* [s] */
enum { POINTS = 2000 };

/* What a scene is looked at with. */
typedef struct point_world {
    random_scene scene;
    tides_device *device;
    tides_renderer *renderer;
    double length; /* of the interval [s] */
} point_world;

/* What colours are of light. */
static int32_t transfer = TIDES_TRANSFER_LINEAR;

static tides_renderer *renderer_of(tides_device *device, const random_scene *s, double soft_depth, int antialias) {
    tides_renderer *renderer = NULL;
    tides_image_params params;
    tides_error error;
    tides_image_params_defaults(&params);
    params.background[1] = 0.2;
    params.antialias = antialias;
    params.transfer = transfer;
    params.smoothing.soft_depth = soft_depth;
    params.smoothing.stop_change = 1e-13; /* the frames' lists to their end */
    scene_expect_ok(tides_renderer_create(device, s->scene, &s->camera, &params, NULL, NULL, &renderer, &error), &error);
    return renderer;
}

static point_world world_on(tides_device *device, const random_recipe *recipe, double length, double soft_depth) {
    tides_error error;
    point_world w = {random_scene_make(recipe), device, NULL, length};
    w.renderer = renderer_of(w.device, &w.scene, soft_depth, recipe->seed % 2 == 1);
    scene_expect_ok(td_renderer_sweep(w.renderer, w.scene.path, START, START + length, &error), &error);
    return w;
}

static point_world open_world(const random_recipe *recipe, const char *device, double length, double soft_depth) {
    return world_on(open_device(device), recipe, length, soft_depth);
}

static void close_world(point_world *w) {
    tides_renderer_destroy(w->renderer);
    tides_device_close(w->device);
    random_scene_free(&w->scene);
}

/* Points all over the image and the interval, its corners and ends too. */
static void scatter(const point_world *w, td_point *points) {
    const int width = w->scene.recipe.width, height = w->scene.recipe.height;
    for (int i = 0; i < POINTS; i++) {
        points[i].time = START + w->length * (double)(i * 37 % POINTS) / (POINTS - 1);
        points[i].x = i * 13 % width;
        points[i].y = i * 29 % height;
    }
    points[1].x = width - 1;
    points[1].y = height - 1;
    points[1].time = START + w->length;
}

/* Exact ones once be_exact has asked for them; before that pixels of whole tiles. */
static void values_of(const point_world *w, const td_point *points, size_t count, td_point_value *values) {
    tides_error error;
    scene_expect_ok((w->renderer->points ? td_renderer_points : tile_points)(w->renderer, w->scene.path, points, count, values,
                                                                             &error),
                    &error);
}

/* Paths are made for a few Gaussians at a time, as points ask for them; else for all at once, there being few. */
static int by_and_by = 0;

static void be_exact(const point_world *w) {
    tides_error error;
    scene_expect_ok(td_renderer_exact_points(w->renderer, &error), &error);
    if (by_and_by) td_renderer_points_groups(w->renderer, 24, 20);
}

/* Largest differences of L and, relative to 1 + |L_dot|, of L_dot. */
static void check_against_frames(const random_recipe *recipe, double length, double soft_depth, double most, double most_rate) {
    static td_point points[POINTS];
    static td_point_value frames[POINTS], exact[POINTS];
    double worst = 0, worst_rate = 0;
    point_world w = open_world(recipe, "reference", length, soft_depth);
    scatter(&w, points);
    values_of(&w, points, POINTS, frames);
    be_exact(&w);
    values_of(&w, points, POINTS, exact);
    for (int i = 0; i < POINTS; i++) {
        const double off = fabs(exact[i].L - frames[i].L);
        const double rate = fabs(exact[i].L_dot - frames[i].L_dot) / (1 + fabs(frames[i].L_dot));
        if (off > worst) worst = off;
        if (rate > worst_rate) worst_rate = rate;
    }
    close_world(&w);
    if (worst > most || worst_rate > most_rate)
        fail_msg("seed %u, %g s: L is off by %.3g, L_dot by %.3g of itself", (unsigned)recipe->seed, length, worst, worst_rate);
}

static void test_pixels_of_the_double_reference(void **state) {
    (void)state;
    for (uint64_t seed = 1410; seed < 1414; seed++) {
        random_recipe recipe = recipe_of(seed);
        recipe.count = 400;
        check_against_frames(&recipe, 1e-4, 1e-4, 1e-9, 1e-6);
        check_against_frames(&recipe, 1e-4, 0, 1e-9, 1e-6);
        check_against_frames(&recipe, 1e-4, 0.05, 1e-9, 1e-6);
        check_against_frames(&recipe, 0, 1e-4, 1e-12, 1e-9); /* no path at all: an instant */
    }
}

/* Splats of an interval get as many nodes as they need: what is left is of the estimate's order (which is for splats as bright
 * as what is seen there; before black it is more); near the target, but for colours that are clamped on the way, whose kink no
 * number of nodes follows. */
static void test_paths_are_as_good_as_they_say(void **state) {
    (void)state;
    for (uint64_t seed = 1410; seed < 1414; seed++) {
        random_recipe recipe = recipe_of(seed);
        recipe.count = 400;
        recipe.spread = 1.2; /* none near the camera */
        check_against_frames(&recipe, 0.01, 1e-4, 1e-5, 0.1);
    }
}

/* Paths follow colours before their clamp, linear ones too: hardly any point projects its splats at its own time, which has the
 * same bits as asking for that. Both are the same image. */
static void test_clamped_colours_have_paths(void **state) {
    static td_point points[POINTS];
    static td_point_value values[POINTS], direct[POINTS];
    tides_error error;
    int same = 0;
    (void)state;
    random_recipe recipe = recipe_of(1420);
    recipe.count = 400;
    recipe.spread = 1.2; /* none near the camera */
    point_world w = open_world(&recipe, "reference", 4e-3, 1e-4);
    td_store *store = &w.renderer->store;
    for (int i = 0; i < store->count * store->sh_stride; i++) /* black, but for what depends on the direction */
        store->sh[i] = i % store->sh_stride < 3 ? (float)(-0.5 / 0.28209479177387814) : 10 * store->sh[i];
    scatter(&w, points);
    be_exact(&w);
    values_of(&w, points, POINTS, values);
    scene_expect_ok(td_renderer_direct_points(w.renderer, w.scene.path, points, POINTS, direct, &error), &error);
    for (int i = 0; i < POINTS; i++) {
        same += memcmp(&values[i], &direct[i], sizeof *values) == 0;
        if (!(fabs(values[i].L - direct[i].L) < 1e-6)) fail_msg("point %d is off by %.3g", i, values[i].L - direct[i].L);
    }
    close_world(&w);
    if (same > POINTS / 10) fail_msg("%d of %d points are projected at their own times", same, POINTS);
}

/* L_dot is the rate of the image that L is of: central differences agree to their own error. */
static void test_rates_are_those_of_the_values(void **state) {
    (void)state;
    static td_point points[POINTS], moved[POINTS];
    static td_point_value values[POINTS], before[POINTS], after[POINTS];
    const double h = 1e-6;
    random_recipe recipe = recipe_of(1430);
    recipe.count = 400;
    point_world w = open_world(&recipe, "reference", 0.005, 1e-4);
    be_exact(&w);
    scatter(&w, points);
    for (int i = 0; i < POINTS; i++) points[i].time = START + 2e-4 + 0.9 * (points[i].time - START);
    values_of(&w, points, POINTS, values);
    for (int side = -1; side <= 1; side += 2) {
        for (int i = 0; i < POINTS; i++) moved[i] = points[i], moved[i].time += side * h;
        values_of(&w, moved, POINTS, side < 0 ? before : after);
    }
    int off = 0;
    for (int i = 0; i < POINTS; i++) {
        const double slope = (after[i].L - before[i].L) / (2 * h);
        if (fabs(slope - values[i].L_dot) > 1e-5 * (1 + fabs(slope))) off++;
    }
    close_world(&w);
    assert_true(off <= POINTS / 500); /* where a kink lies between the two: a channel's clamp, alpha_max */
}

/* Equal depths, needles and nothing at all. */
static void test_depth_ties_and_empty_tiles(void **state) {
    (void)state;
    random_recipe recipe = recipe_of(1440);
    recipe.count = 24; /* most tiles are empty */
    recipe.size = 0.02;
    recipe.camera_speed = 0;
    check_against_frames(&recipe, 1e-4, 1e-4, 1e-9, 1e-6);
}

/* Why there are none. */
static void check_refused(int rules, const char *why) {
    tides_error error;
    random_recipe recipe = recipe_of(1450);
    random_scene s = random_scene_make(&recipe);
    tides_device *device = open_device("reference");
    tides_renderer *renderer = make_renderer(device, s.scene, &s.camera, rules);
    assert_int_equal(td_renderer_exact_points(renderer, &error), TIDES_UNSUPPORTED);
    assert_non_null(strstr(error.text, why));
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    random_scene_free(&s);
}

static void test_images_that_jump_have_none(void **state) {
    (void)state;
    check_refused(TIDES_RULES_INRIA, "abruptly");
    check_refused(TIDES_RULES_GSPLAT, "abruptly");
}

/* Outside of the image or the interval. */
static void test_points_outside_are_refused(void **state) {
    (void)state;
    tides_error error;
    td_point_value value;
    random_recipe recipe = recipe_of(1451);
    point_world w = open_world(&recipe, "reference", 0.005, 1e-4);
    be_exact(&w);
    const td_point outside[] = {{START - 1e-6, 3, 3}, {START + 0.006, 3, 3}, {START, -1, 3}, {START, 3, 43}, {NAN, 3, 3}};
    for (size_t i = 0; i < sizeof outside / sizeof *outside; i++)
        assert_int_equal(td_renderer_points(w.renderer, w.scene.path, &outside[i], 1, &value, &error), TIDES_BAD_ARGUMENT);
    close_world(&w);
}

/* On kernels of `lanes`, however the points are asked for, the bits of the twin; behind them its bits without curves. */
static void check_lanes(int lanes, const random_recipe *recipe, double length, double soft_depth, const td_point *points,
                        const td_point_value *twin) {
    static td_point turned[POINTS];
    static td_point_value all[POINTS], back[POINTS];
    tides_error error;
    tides_device *device = open_device("cpu");
    device->info.lanes = device->double_lanes = lanes;
    point_world w = world_on(device, recipe, length, soft_depth);
    for (int i = 0; i < POINTS; i++) turned[i] = points[POINTS - 1 - i];
    be_exact(&w);
    values_of(&w, points, POINTS, all);
    for (int from = 0, some = 1; from < POINTS; from += some, some = some % 37 + 3)
        values_of(&w, turned + from, (size_t)(POINTS - from < some ? POINTS - from : some), back + from);
    for (int i = 0; i < POINTS; i++) {
        assert_memory_equal(&all[i], &back[POINTS - 1 - i], sizeof *all);
        if (memcmp(&all[i], &twin[i], sizeof *all) != 0)
            fail_msg("%d lanes, point %d: %.17g, the twin has %.17g; %.17g and %.17g", lanes, i, all[i].L, twin[i].L,
                     all[i].L_dot, twin[i].L_dot);
    }
    scene_expect_ok(td_renderer_direct_points(w.renderer, w.scene.path, points, POINTS, back, &error), &error);
    assert_memory_equal(back, twin + POINTS, sizeof back);
    close_world(&w);
}

static void check_devices(const random_recipe *recipe, double length, double soft_depth) {
    static const int lanes[] = {8, 4, 1};
    static td_point points[POINTS];
    static td_point_value twin[2 * POINTS];
    tides_error error;
    point_world c = open_world(recipe, "reference-f32", length, soft_depth);
    scatter(&c, points);
    be_exact(&c);
    values_of(&c, points, POINTS, twin);
    scene_expect_ok(td_renderer_direct_points(c.renderer, c.scene.path, points, POINTS, twin + POINTS, &error), &error);
    for (size_t i = 0; i < sizeof lanes / sizeof *lanes; i++) check_lanes(lanes[i], recipe, length, soft_depth, points, twin);
    close_world(&c);
}

static void check_order(uint64_t begin, uint64_t end) {
    for (uint64_t seed = begin; seed < end; seed++) {
        random_recipe recipe = recipe_of(seed);
        recipe.count = 500;
        recipe.spread = seed % 2 ? 4 : 1.5; /* 4: some are near the camera and behind it */
        check_devices(&recipe, 0.005, 1e-4);
        check_devices(&recipe, 0.005, seed % 2 ? 0 : 0.05);
    }
}

static void test_bits_of_any_device_and_order(void **state) {
    (void)state;
    check_order(1420, 1424);
}

/* Points that a device is at while the renderer is asked for something else; or nobody wants them, or not even the renderer. */
static void test_in_two_calls(void **state) {
    (void)state;
    static td_point points[POINTS], others[POINTS];
    static td_point_value all[POINTS], begun[POINTS], beside[POINTS];
    double plane[TD_OUT_SIGNAL * TD_TILE_PIXELS], time = START;
    td_request request = {.tile = 0, .slot = 0, .blocks = TD_ALL_BLOCKS};
    const td_tile_batch tile = {&time, 1, TD_SIDE_BEGINS, &request, 1, TD_OUT_SIGNAL};
    tides_error error;
    const random_recipe recipe = recipe_of(1425);
    point_world w = open_world(&recipe, "cpu", 0.005, 1e-4);
    be_exact(&w);
    scatter(&w, points);
    for (int i = 0; i < POINTS; i++) others[i] = points[POINTS - 1 - i];
    values_of(&w, points, POINTS, all);
    assert_true(td_renderer_points_go_on(w.renderer));
    scene_expect_ok(td_renderer_points_begin(w.renderer, w.scene.path, points, POINTS, begun, &error), &error);
    scene_expect_ok(td_renderer_tiles(w.renderer, w.scene.path, &tile, plane, &error), &error);
    scene_expect_ok(td_renderer_points_end(w.renderer, &error), &error);
    assert_memory_equal(all, begun, sizeof all);
    scene_expect_ok(td_renderer_points_begin(w.renderer, w.scene.path, others, POINTS, beside, &error), &error);
    td_renderer_points_drop(w.renderer);
    memset(begun, 0, sizeof begun);
    scene_expect_ok(td_renderer_points_begin(w.renderer, w.scene.path, points, POINTS, begun, &error), &error);
    scene_expect_ok(td_renderer_points_end(w.renderer, &error), &error);
    scene_expect_ok(td_renderer_points_end(w.renderer, &error), &error); /* nothing is left */
    assert_memory_equal(all, begun, sizeof all);
    scene_expect_ok(td_renderer_points_begin(w.renderer, w.scene.path, points, POINTS, begun, &error), &error);
    close_world(&w);
}

/* Where a stack of splats lets no light through, those behind it aren't looked at: nothing that counts is lost. */
static void test_behind_what_is_opaque(void **state) {
    (void)state;
    for (uint64_t seed = 1460; seed < 1462; seed++) {
        random_recipe recipe = recipe_of(seed);
        recipe.count = 800;
        recipe.spread = 1;
        recipe.opacity_min = 0.7;
        recipe.opacity_max = 0.99;
        check_against_frames(&recipe, 0, seed % 2 ? 0 : 1e-3, 1e-12, 1e-9);
        check_devices(&recipe, 0.005, seed % 2 ? 0 : 1e-4);
    }
}

/* Large splats that go through one another all through the interval: their tiles' order is of no use to most points, who sort
 * what they see in the end (in hard order for one seed, in soft order for the other). */
static void test_all_change_places(void **state) {
    (void)state;
    for (uint64_t seed = 1480; seed < 1482; seed++) {
        random_recipe recipe = recipe_of(seed);
        recipe.count = 300;
        recipe.spread = 1;
        recipe.size = 0.4;
        recipe.moving = 1;
        recipe.speed = 4;
        recipe.opacity_min = 0.02;
        recipe.opacity_max = 0.1;
        check_devices(&recipe, 0.2, seed % 2 ? 0 : 0.05);
        check_against_frames(&recipe, 0.2, seed % 2 ? 0 : 0.05, 1e-3, 1);
    }
}

/* An interval that a path's samples cut into pieces, in each of which it turns. */
static void test_paths_with_corners(void **state) {
    (void)state;
    random_recipe recipe = recipe_of(1470);
    recipe.count = 200;
    recipe.spread = 1.2;
    check_devices(&recipe, 0.45, 1e-4); /* samples at 0.5 s and 0.75 s */
    check_against_frames(&recipe, 0.45, 1e-4, 1e-4, 0.1);
}

/* All of it where what points may see gets its paths by and by: of an interval, of an instant, with corners of paths, bent
 * ones, ties of depth. A value is then what it is where all have them from the beginning. */
static void test_paths_by_and_by(void **state) {
    static td_point points[POINTS];
    static td_point_value at_once[POINTS], later[POINTS];
    (void)state;
    for (uint64_t seed = 1420; seed < 1423; seed++) {
        random_recipe recipe = recipe_of(seed);
        const double length = seed == 1421 ? 0 : 0.005;
        recipe.count = 500;
        recipe.spread = seed % 2 ? 4 : 1.5;
        for (by_and_by = 0; by_and_by < 2; by_and_by++) {
            point_world w = open_world(&recipe, seed == 1422 ? "reference" : "cpu", length, 1e-4);
            scatter(&w, points);
            be_exact(&w);
            for (int from = 0; from < POINTS && by_and_by; from += 100) values_of(&w, points + from, 100, later + from);
            if (!by_and_by) values_of(&w, points, POINTS, at_once);
            close_world(&w);
        }
        assert_memory_equal(at_once, later, sizeof later);
    }
    by_and_by = 1;
    check_order(1420, 1422);
    test_paths_with_corners(NULL);
    test_depth_ties_and_empty_tiles(NULL);
    test_all_change_places(NULL);
    by_and_by = 0;
}

/* A tile's list is made for one pixel. Points elsewhere get all Gaussians their paths, and then another of its pixels asks.
 * Nobody is without a path any more then, but the list is. */
static void test_lists_made_early(void **state) {
    static td_point points[POINTS];
    static td_point_value at_once[POINTS], later[POINTS];
    (void)state;
    for (uint64_t seed = 1420; seed < 1424; seed++) {
        random_recipe recipe = recipe_of(seed);
        recipe.count = 200;
        recipe.size = 0.4; /* none is within one tile */
        int differ = 0, count = 1;
        point_world w = open_world(&recipe, seed % 2 ? "reference" : "cpu", seed < 1422 ? 0.005 : 0, 1e-4);
        const int width = recipe.width, height = recipe.height, x = width / 2 / TD_TILE * TD_TILE,
                  y = height / 2 / TD_TILE * TD_TILE;
        points[0] = (td_point){START, x, y};
        for (int i = 0; i < width * height; i++)
            if ((i % width / TD_TILE != x / TD_TILE || i / width / TD_TILE != y / TD_TILE) && i % 2 == 0)
                points[count++] = (td_point){START, i % width, i / width};
        const int others = count;
        for (int i = 1; i < TD_TILE; i++) points[count++] = (td_point){START, x + i, y + i};
        assert_true(count <= POINTS);
        be_exact(&w);
        values_of(&w, points, (size_t)count, at_once);
        close_world(&w);
        w = open_world(&recipe, seed % 2 ? "reference" : "cpu", seed < 1422 ? 0.005 : 0, 1e-4);
        be_exact(&w);
        td_renderer_points_groups(w.renderer, 24, 20);
        values_of(&w, points, 1, later);
        values_of(&w, points + 1, (size_t)(others - 1), later + 1);
        values_of(&w, points + others, (size_t)(count - others), later + others);
        close_world(&w);
        for (int i = 0; i < count; i++) differ += memcmp(&at_once[i], &later[i], sizeof later[i]) != 0;
        if (differ) fail_msg("seed %u: %d of %d points depend on who has asked", (unsigned)seed, differ, count);
    }
}

/* Boxes of half their size: all curves stray out of them, as a bent one's may. */
static void shrink_boxes(const point_world *w) {
    for (int i = 0; i < w->renderer->store.count; i++) {
        float *box = w->renderer->sweep.boxes + 4 * (size_t)i;
        for (int k = 0; k < 2; k++) {
            const float quarter = 0.25f * (box[k + 2] - box[k]);
            box[k] += quarter;
            box[k + 2] -= quarter;
        }
    }
}

/* A point sees nothing of a splat that its own pixel doesn't ask for, whether another has asked for it or not. */
static void test_curves_that_stray(void **state) {
    static td_point points[POINTS];
    static td_point_value at_once[POINTS], later[POINTS];
    (void)state;
    for (uint64_t seed = 1420; seed < 1422; seed++) {
        random_recipe recipe = recipe_of(seed);
        recipe.count = 300;
        for (int some = 0; some < 2; some++) {
            point_world w = open_world(&recipe, seed % 2 ? "reference" : "cpu", 0.005, 1e-4);
            scatter(&w, points);
            shrink_boxes(&w);
            be_exact(&w);
            if (some) td_renderer_points_groups(w.renderer, 24, 20);
            for (int from = 0; from < POINTS && some; from += 40) values_of(&w, points + from, 40, later + from);
            if (!some) values_of(&w, points, POINTS, at_once);
            close_world(&w);
        }
        assert_memory_equal(at_once, later, sizeof later);
    }
}

/* All of it where light isn't linear in colours, so that three channels are composited. */
static void test_three_channels(void **state) {
    static const int32_t transfers[] = {TIDES_TRANSFER_SRGB, TIDES_TRANSFER_GAMMA};
    (void)state;
    for (size_t i = 0; i < sizeof transfers / sizeof *transfers; i++) {
        random_recipe recipe = recipe_of(1490 + i);
        transfer = transfers[i];
        recipe.count = 400;
        recipe.moving = (int)i;
        check_devices(&recipe, 0.005, 1e-4); /* hard order, whose kernels are others, is the reference's below */
        check_against_frames(&recipe, 0, 1e-4, 1e-12, 1e-9);
        check_against_frames(&recipe, 0, 0, 1e-12, 1e-9);
        recipe.spread = 1.2, recipe.moving = 0;
        check_against_frames(&recipe, 1e-4, 1e-4, 1e-8, 1e-5);
        check_against_frames(&recipe, 0.01, 1e-4, 1e-4, 0.1);
    }
    test_rates_are_those_of_the_values(NULL);
    transfer = TIDES_TRANSFER_LINEAR;
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_bits_of_any_device_and_order),
                                       cmocka_unit_test(test_in_two_calls),
                                       cmocka_unit_test(test_three_channels),
                                       cmocka_unit_test(test_paths_by_and_by),
                                       cmocka_unit_test(test_lists_made_early),
                                       cmocka_unit_test(test_curves_that_stray),
                                       cmocka_unit_test(test_behind_what_is_opaque),
                                       cmocka_unit_test(test_paths_with_corners),
                                       cmocka_unit_test(test_all_change_places),
                                       cmocka_unit_test(test_pixels_of_the_double_reference),
                                       cmocka_unit_test(test_paths_are_as_good_as_they_say),
                                       cmocka_unit_test(test_clamped_colours_have_paths),
                                       cmocka_unit_test(test_rates_are_those_of_the_values),
                                       cmocka_unit_test(test_depth_ties_and_empty_tiles),
                                       cmocka_unit_test(test_images_that_jump_have_none),
                                       cmocka_unit_test(test_points_outside_are_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
