/* Scenes in which Gaussians move by themselves, of three kinds. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/moving_scene.h"

#include "motion/td_activate.h"
#include "motion/td_motion.h"
#include "render/td_renderer.h"
#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdlib.h>

/* A number in [-1, 1) that depends on its three arguments alone (splitmix64). */
static double random_number(uint64_t seed, uint64_t gaussian, uint64_t which) {
    uint64_t x = seed * 0x9e3779b97f4a7c15u + gaussian * 0xbf58476d1ce4e5b9u + which * 0x94d049bb133111ebu;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    x ^= x >> 31;
    return (double)(x >> 11) * 0x1p-52 - 1;
}

/* -- bent ---------------------------------------------------------------------------------------------------------- */

static const double bent_knot = 2 + 3 * MOVING_KNOT;

static tides_status bent_check(const tides_motion *motion, const tides_gaussians *gaussians, tides_error *error) {
    (void)motion, (void)gaussians, (void)error;
    return TIDES_OK;
}

static tides_status bent_pack(const tides_motion *motion, const tides_gaussians *gaussians, td_mover_numbers *numbers,
                              tides_error *error) {
    (void)motion, (void)gaussians, (void)error;
    numbers->moves_sh = 1;
    return TIDES_OK;
}

static size_t bent_knots(const tides_motion *motion, double *tau, size_t capacity) {
    (void)motion;
    if (capacity) tau[0] = bent_knot;
    return 1;
}

static void bent_find_moving(const tides_motion *motion, const tides_gaussians *gaussians, uint8_t *moving) {
    (void)motion;
    for (int64_t i = 0; i < gaussians->count; i++) moving[i] = i % 3 != 0;
}

static void bent_row(const tides_motion *motion, const tides_gaussians *g, double tau, int side, int32_t i, double *geometry,
                     double *rates) {
    double speed = i % 3 ? td_motion_setting(motion, "speed", 0) : 0, mean[3], log_scale[3], quaternion[4];
    uint64_t seed = (uint64_t)td_motion_setting(motion, "seed", 0);
    int after = tau > bent_knot || (tau >= bent_knot && side > 0);
    for (int k = 0; k < 4; k++) quaternion[k] = g->quaternion[4 * i + k];
    for (int k = 0; k < 3; k++) {
        mean[k] = g->mean[3 * i + k];
        log_scale[k] = g->log_scale[3 * i + k];
    }
    memset(rates, 0, TD_GEOMETRY_STRIDE * sizeof *rates);
    td_activate(mean, log_scale, quaternion, g->opacity_logit[i], geometry);
    for (int k = 0; k < 3; k++) {
        double before = speed * random_number(seed, (uint64_t)i, (uint64_t)k);
        double bend = speed * random_number(seed, (uint64_t)i, (uint64_t)k + 3);
        double way = before * (tau - 2) + (after ? bend * (tau - bent_knot) : 0);
        geometry[TD_G_MEAN + k] += way;
        geometry[TD_G_ORIGIN + k] += way;
        rates[TD_G_MEAN + k] = rates[TD_G_ORIGIN + k] = before + (after ? bend : 0);
    }
    double breath = speed > 0 ? 0.3 : 0;
    geometry[TD_G_OPACITY] *= 1 - breath * sin(2 * tau) * sin(2 * tau);
    rates[TD_G_OPACITY] = -geometry[TD_G_OPACITY] / (1 - breath * sin(2 * tau) * sin(2 * tau)) * breath * 2 * sin(4 * tau);
}

static tides_status bent_evaluate(const tides_motion *motion, const tides_gaussians *g, const td_motion_asked *asked,
                                  const td_motion_sink *to, tides_error *error) {
    const double tau = asked->tau;
    const int sh_stride = to->sh_stride;
    int own = 3 * (g->sh_degree + 1) * (g->sh_degree + 1);
    (void)error;
    for (int64_t n = 0; n < asked->count; n++) {
        int32_t i = asked->index[n];
        bent_row(motion, g, tau, asked->side, i, to->geometry + n * TD_GEOMETRY_STRIDE, to->rates + n * TD_GEOMETRY_STRIDE);
        for (int k = 0; k < sh_stride; k++) {
            double change = i % 3 && k < 3 ? 0.1 : 0;
            to->sh[n * sh_stride + k] = k < own ? g->sh[(int64_t)i * own + k] + change * sin(tau + k) : 0;
            to->sh_rates[n * sh_stride + k] = change * cos(tau + k);
        }
    }
    return TIDES_OK;
}

static const td_motion_class bent_class = {.name = "bent",
                                           .code = TD_MOTION_HOST,
                                           .expensive = 1,
                                           .check = bent_check,
                                           .pack = bent_pack,
                                           .knots = bent_knots,
                                           .find_moving = bent_find_moving,
                                           .evaluate = bent_evaluate};

tides_motion *bent_motion_make(uint64_t seed, double speed) {
    tides_motion *motion = NULL;
    tides_error error;
    scene_expect_ok(td_motion_create(&bent_class, 2, 5, &motion, &error), &error);
    scene_expect_ok(td_motion_set(motion, "seed", (double)(seed & 0xffffff), &error), &error);
    scene_expect_ok(td_motion_set(motion, "speed", speed / 3, &error), &error);
    return motion;
}

/* -- polynomial ---------------------------------------------------------------------------------------------------- */

tides_motion *polynomial_motion_make(uint64_t seed, int64_t count, double speed) {
    float *centre = calloc((size_t)count, sizeof *centre), *width = calloc((size_t)count, sizeof *width);
    float *mean = calloc(9 * (size_t)count, sizeof *mean), *turn = calloc(4 * (size_t)count, sizeof *turn);
    tides_motion *motion = NULL;
    tides_error error;
    assert_true(centre && width && mean && turn);
    for (int64_t i = 0; i < count; i++) {
        uint64_t g = (uint64_t)i;
        centre[i] = (float)(0.5 + 0.6 * random_number(seed, g, 0));
        width[i] = i % 4 ? (float)(0.5 * random_number(seed, g, 1) - 0.3) : 60;
        for (int k = 0; k < 9 && i % 4; k++) mean[9 * i + k] = (float)(speed * random_number(seed, g, 10 + (uint64_t)k));
        for (int k = 0; k < 4 && i % 4; k++) turn[4 * i + k] = (float)(speed * random_number(seed, g, 20 + (uint64_t)k));
    }
    tides_polynomial_motion arrays = {.count = count, .stop = 1, .opacity_centre = centre, .opacity_log_width = width};
    arrays.mean_coefficient = mean;
    arrays.quaternion_dot = turn;
    scene_expect_ok(tides_motion_create_polynomial(&arrays, &motion, &error), &error);
    free(centre);
    free(width);
    free(mean);
    free(turn);
    return motion;
}

/* -- scenes -------------------------------------------------------------------------------------------------------- */

moving_scene moving_scene_make(const random_recipe *recipe, double speed) {
    moving_scene made;
    random_recipe own = *recipe;
    tides_error error;
    own.objects = 3;
    own.moving = 0;
    made.base = random_scene_make(&own);
    made.scene = NULL;
    scene_expect_ok(tides_scene_create(&made.scene, &error), &error);
    for (int i = 0; i < 3; i++) {
        tides_object o;
        scene_expect_ok(tides_scene_object(made.base.scene, i, &o, &error), &error);
        tides_motion *motion = i == 1   ? polynomial_motion_make(own.seed, o.gaussians.count, speed)
                               : i == 2 ? bent_motion_make(own.seed, speed)
                                        : NULL;
        scene_expect_ok(motion ? tides_scene_add_moving(made.scene, &o.gaussians, motion, 1, o.trajectory, o.scale, o.name,
                                                        NULL, &error)
                               : tides_scene_add(made.scene, &o.gaussians, o.trajectory, o.scale, o.name, NULL, &error),
                        &error);
    }
    return made;
}

moving_scene moving_scene_small(uint64_t seed) {
    random_recipe recipe = random_recipe_defaults(seed);
    recipe.sh_degree = 1;
    recipe.width = 43;
    recipe.height = 37;
    recipe.size = 0.2;
    recipe.camera_speed = 0.5;
    return moving_scene_make(&recipe, 1);
}

void moving_scene_free(moving_scene *scene) {
    tides_scene_destroy(scene->scene);
    random_scene_free(&scene->base);
}
