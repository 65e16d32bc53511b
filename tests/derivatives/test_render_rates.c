/* Rates of the double reference against central differences of the double reference itself, on random scenes.
 *
 * A frame is rendered at t, t +- h/2 and t +- h from everything that moves (raw parameters, rigid objects, camera, backdrop),
 * so that the whole chain from trajectories and activations to pixels is differenced. Richardson's extrapolation of the two
 * central differences has an error of O(h^4), some 1e-12 here, and rounding adds 1e-16 / h, at most 1e-10. The bound is 1e-6 of
 * a plane's largest rate.
 *
 * A difference across a jump is no derivative, so that jumps are switched off: the hard cut at 1/255 and the tile rectangle of
 * inria and gsplat, and every stop. (The stop of smooth drops splats that change L by less than 1e-5; a jump of 1e-5 over 2 h
 * looks like a rate of 1.) Depth swaps (jumps), alpha_max and the clamps of SH and Jacobian (kinks) remain, and are found in
 * the values alone, per pixel. With S(h) = (f(t+h) - 2 f(t) + f(t-h)) / h, S(h) - 2 S(h/2) is O(h^3) where f is smooth, and of
 * the size of the kink where there is one within h. Such pixels are left out, counted, and must be few. The last test leaves
 * everything on: between its jumps an image has the same exact rates. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/td_renderer.h"

#include "tests/support/random_scene.h"
#include "tests/support/render_frame.h"
#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdlib.h>

#define STEP 5e-6               /* h [s] */
#define SOFT_STEP 1e-6          /* likewise for smooth: a soft swap of depths lasts a small part of what else there is */
#define TOLERANCE 1e-6          /* of the largest rate of a plane */
#define KINK 1e-7               /* likewise: S(h) - 2 S(h/2) above this is a kink */
#define KINK_SHARE 0.01         /* of pixels with a kink within h */
#define JUMP_SHARE 0.05         /* likewise where every cut is on */
enum { NODES = 5, MIDDLE = 2 }; /* times t + (-h, -h/2, 0, h/2, h) */

/* Planes with their rates. Depth is the mean of what is blended: it means nothing where next to nothing is. */
typedef struct pair {
    const char *name;
    int value, rate, needs_alpha;
} pair;
static const pair pairs[] = {
    {"L", TD_OUT_L, TD_OUT_L_DOT, 0}, {"alpha", TD_OUT_ALPHA, TD_OUT_ALPHA_DOT, 0},
    {"R", TD_OUT_R, TD_OUT_R_DOT, 0}, {"G", TD_OUT_G, TD_OUT_G_DOT, 0},
    {"B", TD_OUT_B, TD_OUT_B_DOT, 0}, {"Z", TD_OUT_Z, TD_OUT_Z_DOT, 1},
};
enum { PAIRS = sizeof pairs / sizeof *pairs };

/* What is done to an image before it is differenced. */
enum { SMOOTHED, FADED, AS_IT_IS };

/* Takes out what jumps. FADED: the fade at the near plane reaches through the whole scene, for all splats to be in it. */
static td_image_numbers prepare(td_image_numbers numbers, int rules, int how) {
    td_image image;
    if (how == AS_IT_IS) return numbers;
    memcpy(&image, numbers.real, sizeof numbers.real);
    memcpy((char *)&image + sizeof numbers.real, numbers.whole, sizeof numbers.whole);
    if (rules == TIDES_RULES_SMOOTH) {
        image.stop = 0; /* the bound on L is then 0: nothing visible is dropped */
    } else {
        image.stop_rule = TD_STOP_NONE;
        image.cut_rule = TD_CUT_NONE;
        image.cut = image.cut_full = 0;
        image.extent_rule = TD_EXTENT_ELLIPSE;
    }
    if (how == FADED) image.near_full = 7;
    return td_image_pack(&image);
}

static double *render_at(const random_scene *scene, const td_image_numbers *image, double time) {
    td_store store = random_scene_store(scene, time);
    double *views = random_scene_views(scene, &time, 1), *backdrop = random_scene_backdrops(scene, &time, 1);
    td_backend *backend = NULL;
    tides_error error;
    scene_expect_ok(td_backend_create_f64(&store, image, &backend, &error), &error);
    frame_input input = {&store, image, views, backdrop, scene->camera.width, scene->camera.height, TD_OUT_COLOUR};
    double *frame = frame_render(backend, &input, FRAME_SWEPT);
    backend->type->destroy(backend);
    td_store_release(&store);
    free(views);
    free(backdrop);
    return frame;
}

static double richardson(const double f[NODES], double h) { return (4 * (f[3] - f[1]) / h - (f[4] - f[0]) / (2 * h)) / 3; }

static int has_kink(const double f[NODES], double h, double largest) {
    double whole = (f[4] - 2 * f[2] + f[0]) / h, half = (f[3] - 2 * f[2] + f[1]) / (0.5 * h);
    return fabs(whole - 2 * half) > KINK * largest;
}

typedef struct outcome {
    double error; /* of the worst pixel, relative to the largest rate of its plane */
    const char *name;
    int kinks, compared; /* pixels of all planes: left out, and compared */
    int moving;          /* of these, with a rate above a hundredth of the largest */
} outcome;

static void compare_pair(double *const frames[NODES], double h, const pair *p, size_t pixels, outcome *o) {
    const double *rate = frames[MIDDLE] + (size_t)p->rate * pixels, *alpha = frames[MIDDLE] + TD_OUT_ALPHA * pixels;
    double largest = 0;
    for (size_t i = 0; i < pixels; i++)
        if (!p->needs_alpha || alpha[i] > 0.01) largest = fmax(largest, fabs(rate[i]));
    for (size_t i = 0; i < pixels; i++) {
        double f[NODES];
        if (p->needs_alpha && alpha[i] <= 0.01) continue;
        for (int k = 0; k < NODES; k++) f[k] = frames[k][(size_t)p->value * pixels + i];
        if (has_kink(f, h, largest)) {
            o->kinks++;
            continue;
        }
        o->compared++;
        o->moving += fabs(rate[i]) > 0.01 * largest;
        double error = fabs(rate[i] - richardson(f, h)) / largest;
        if (error <= o->error) continue;
        o->error = isnan(error) ? INFINITY : error;
        o->name = p->name;
    }
}

static outcome difference(const random_scene *scene, const td_image_numbers *image, double time, double h) {
    const double offsets[NODES] = {-h, -0.5 * h, 0, 0.5 * h, h};
    double *frames[NODES];
    outcome o = {0, "", 0, 0, 0};
    for (int k = 0; k < NODES; k++) frames[k] = render_at(scene, image, time + offsets[k]);
    for (int p = 0; p < PAIRS; p++) compare_pair(frames, h, &pairs[p], (size_t)scene->camera.width * scene->camera.height, &o);
    for (int k = 0; k < NODES; k++) free(frames[k]);
    return o;
}

/* All rules with and without antialiasing on one recipe, at a time between the samples of its paths (a rotation's curve is C1
 * at a sample). */
static void check_recipe(const random_recipe *recipe, int how) {
    static const char *const names[] = {"smooth", "inria", "gsplat"};
    random_scene scene = random_scene_make(recipe);
    for (int rules = TIDES_RULES_SMOOTH; rules <= TIDES_RULES_GSPLAT; rules++)
        for (int antialias = 0; antialias < 2; antialias++) {
            td_image_numbers image = prepare(random_scene_image(&scene, rules, antialias, TD_OUT_COLOUR), rules, how);
            outcome o = difference(&scene, &image, 0.37, rules == TIDES_RULES_SMOOTH ? SOFT_STEP : STEP);
            int all = o.kinks + o.compared;
            int wrong = !(o.error <= TOLERANCE) || o.kinks > (how == AS_IT_IS ? JUMP_SHARE : KINK_SHARE) * all;
            if (wrong || 5 * o.moving < all)
                fail_msg("seed %d, degree %d, %s%s: error %.1e (%s), %d of %d at kinks, %d moving", (int)recipe->seed,
                         recipe->sh_degree, names[rules], antialias ? " antialiased" : "", o.error, o.name, o.kinks, all,
                         o.moving);
        }
    random_scene_free(&scene);
}

static random_recipe small_recipe(uint64_t seed) {
    random_recipe recipe = random_recipe_defaults(seed);
    recipe.width = 48;
    recipe.height = 32;
    return recipe;
}

/* Gaussians at rest in objects that move, turn and are scaled; a camera that moves and turns. */
static void rigid_objects(void **state) {
    (void)state;
    for (int degree = 0; degree <= TIDES_SH_DEGREE_MAX; degree++) {
        random_recipe recipe = small_recipe(100 + (uint64_t)degree);
        recipe.sh_degree = degree;
        recipe.objects = 3;
        check_recipe(&recipe, SMOOTHED);
    }
}

/* The same, and every raw parameter and the backdrop have rates too. */
static void everything_moving(void **state) {
    (void)state;
    for (int degree = 0; degree <= TIDES_SH_DEGREE_MAX; degree++) {
        random_recipe recipe = small_recipe(200 + (uint64_t)degree);
        recipe.sh_degree = degree;
        recipe.objects = 2;
        recipe.moving = 1;
        check_recipe(&recipe, SMOOTHED);
    }
}

/* Through lenses: Jacobians with rates of their own. */
static void lenses(void **state) {
    (void)state;
    for (int lens = TIDES_LENS_RADTAN; lens <= TIDES_LENS_EQUIDISTANT; lens++) {
        random_recipe recipe = small_recipe(240 + (uint64_t)lens);
        recipe.sh_degree = 1;
        recipe.objects = 2;
        recipe.lens = lens;
        recipe.moving = lens == TIDES_LENS_RADTAN;
        check_recipe(&recipe, SMOOTHED);
    }
}

/* A moving scene and a camera at rest. */
static void camera_at_rest(void **state) {
    (void)state;
    random_recipe recipe = small_recipe(250);
    recipe.moving = 1;
    recipe.camera_speed = 0;
    check_recipe(&recipe, SMOOTHED);
}

/* Splats at the near plane and behind it, beyond the Jacobian's clamps, and saturated. */
static void inside_the_cloud(void **state) {
    (void)state;
    for (int i = 0; i < 4; i++) {
        random_recipe recipe = small_recipe(300 + (uint64_t)i);
        recipe.count = 150;
        recipe.spread = 4.5;
        recipe.size = 0.2;
        recipe.moving = i % 2;
        recipe.opacity_max = 0.999;
        check_recipe(&recipe, SMOOTHED);
    }
}

static void within_the_near_fade(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        random_recipe recipe = small_recipe(350 + (uint64_t)i);
        recipe.moving = i;
        check_recipe(&recipe, FADED);
    }
}

/* Splats of a quarter of a pixel, where antialiasing takes most of the opacity, and of a fortieth, where it is at its floor. */
static void small_splats(void **state) {
    (void)state;
    for (int i = 0; i < 4; i++) {
        random_recipe recipe = small_recipe(400 + (uint64_t)i);
        recipe.count = 400;
        recipe.size = i < 2 ? 0.02 : 0.002;
        recipe.moving = i % 2;
        recipe.opacity_min = 0.5;
        check_recipe(&recipe, SMOOTHED);
    }
}

static void with_all_cuts(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        random_recipe recipe = small_recipe(500 + (uint64_t)i);
        recipe.opacity_min = 0.7;
        recipe.opacity_max = 0.999;
        recipe.moving = i % 2;
        check_recipe(&recipe, AS_IT_IS);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rigid_objects),  cmocka_unit_test(everything_moving),    cmocka_unit_test(lenses),
        cmocka_unit_test(camera_at_rest), cmocka_unit_test(within_the_near_fade), cmocka_unit_test(inside_the_cloud),
        cmocka_unit_test(small_splats),   cmocka_unit_test(with_all_cuts),
    };
    return cmocka_run_group_tests_name("render rates", tests, NULL, NULL);
}
