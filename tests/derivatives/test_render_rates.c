/* Rates of the double reference against central differences of the double reference itself, on random scenes.
 *
 * A frame is rendered at t, t +- h/2 and t +- h from everything that moves (raw parameters, rigid objects, camera, backdrop), so
 * the whole chain from trajectories and activations to pixels is differenced. Richardson's extrapolation of the two central
 * differences has an error of O(h^4), 1e-10 here, and rounding puts in 1e-16 / h. 1e-6 of the largest rate of a plane is asked.
 *
 * What jumps is switched off, since a difference across a jump is no derivative: the hard cut at 1/255 and the tile rectangle of
 * inria and gsplat, and every stop (that of smooth drops what changes L by less than 1e-5, and a jump of 1e-5 over 2 h is a
 * rate of 0.25). What is left, depth swaps (jumps), alpha_max, the clamps of SH and Jacobian (kinks), is found in the values
 * alone, per pixel: with S(h) = (f(t+h) - 2 f(t) + f(t-h)) / h, S(h) - 2 S(h/2) is O(h^3) where f is smooth, and of the size of
 * the kink or more where there is one within h. Such pixels are left out, counted, and must be few. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/td_render.h"

#include "tests/support/random_scene.h"
#include "tests/support/render_frame.h"
#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdlib.h>

#define STEP 5e-6      /* h [s] */
#define TOLERANCE 1e-6 /* of the largest rate of a plane */
#define KINK 1e-7      /* likewise: S(h) - 2 S(h/2) above this is a kink */
#define KINK_SHARE 0.01
enum { NODES = 5, MIDDLE = 2 }; /* times t + (-h, -h/2, 0, h/2, h) */

/* Planes with their rates. Depth is the mean of what is blended: it means nothing where next to nothing is. */
typedef struct pair {
    const char *name;
    int value, rate, needs_alpha;
} pair;
static const pair pairs[] = {
    {"L", TD_OUT_L, TD_OUT_L_DOT, 0}, {"alpha", TD_OUT_ALPHA, TD_OUT_ALPHA_DOT, 0}, {"R", TD_OUT_R, TD_OUT_R_DOT, 0},
    {"G", TD_OUT_G, TD_OUT_G_DOT, 0}, {"B", TD_OUT_B, TD_OUT_B_DOT, 0},             {"Z", TD_OUT_Z, TD_OUT_Z_DOT, 1},
};
enum { PAIRS = sizeof pairs / sizeof *pairs };

/* Takes out what jumps. */
static td_image_numbers without_jumps(td_image_numbers numbers, int rules) {
    td_image image;
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

static double richardson(const double f[NODES]) {
    return (4 * (f[3] - f[1]) / STEP - (f[4] - f[0]) / (2 * STEP)) / 3;
}

static int has_kink(const double f[NODES], double largest) {
    double whole = (f[4] - 2 * f[2] + f[0]) / STEP, half = (f[3] - 2 * f[2] + f[1]) / (0.5 * STEP);
    return fabs(whole - 2 * half) > KINK * largest;
}

typedef struct outcome {
    double error;        /* of the worst pixel, relative to the largest rate of its plane */
    const char *name;
    int kinks, compared; /* pixels and planes left out, and compared */
    int moving_pixels;   /* with a rate above a hundredth of the largest */
} outcome;

static void compare_pair(double *const frames[NODES], const pair *p, size_t pixels, outcome *o) {
    const double *rate = frames[MIDDLE] + (size_t)p->rate * pixels, *alpha = frames[MIDDLE] + TD_OUT_ALPHA * pixels;
    double largest = 0;
    for (size_t i = 0; i < pixels; i++)
        if (!p->needs_alpha || alpha[i] > 0.01) largest = fmax(largest, fabs(rate[i]));
    for (size_t i = 0; i < pixels; i++) {
        double f[NODES];
        if (p->needs_alpha && alpha[i] <= 0.01) continue;
        for (int k = 0; k < NODES; k++) f[k] = frames[k][(size_t)p->value * pixels + i];
        if (has_kink(f, largest)) {
            o->kinks++;
            continue;
        }
        o->compared++;
        o->moving_pixels += fabs(rate[i]) > 0.01 * largest;
        double error = fabs(rate[i] - richardson(f)) / largest;
        if (error <= o->error) continue;
        o->error = error == error ? error : INFINITY;
        o->name = p->name;
    }
}

static outcome difference(const random_scene *scene, int rules, int antialias, double time) {
    static const double offsets[NODES] = {-STEP, -0.5 * STEP, 0, 0.5 * STEP, STEP};
    td_image_numbers image = without_jumps(random_scene_image(scene, rules, antialias, TD_OUT_COLOUR), rules);
    double *frames[NODES];
    outcome o = {0, "", 0, 0, 0};
    for (int k = 0; k < NODES; k++) frames[k] = render_at(scene, &image, time + offsets[k]);
    for (int p = 0; p < PAIRS; p++) compare_pair(frames, &pairs[p], (size_t)scene->camera.width * scene->camera.height, &o);
    for (int k = 0; k < NODES; k++) free(frames[k]);
    return o;
}

/* All rules with and without antialiasing on one recipe, at a time between the path's samples. */
static void check_recipe(const random_recipe *recipe, const char *what) {
    static const char *const names[] = {"smooth", "inria", "gsplat"};
    random_scene scene = random_scene_make(recipe);
    for (int rules = TIDES_RULES_SMOOTH; rules <= TIDES_RULES_GSPLAT; rules++)
        for (int antialias = 0; antialias < 2; antialias++) {
            outcome o = difference(&scene, rules, antialias, 0.37);
            print_message("    %s, seed %d, degree %d, %s%s: %.1e (%s), %d of %d at kinks\n", what, (int)recipe->seed,
                          recipe->sh_degree, names[rules], antialias ? " antialiased" : "", o.error, o.name, o.kinks,
                          o.kinks + o.compared);
        }
    random_scene_free(&scene);
}

static void moving_camera_and_objects(void **state) {
    (void)state;
    for (int degree = 0; degree <= TIDES_SH_DEGREE_MAX; degree++) {
        random_recipe recipe = random_recipe_defaults(100 + (uint64_t)degree);
        recipe.sh_degree = degree;
        recipe.objects = 3;
        recipe.width = 48, recipe.height = 32;
        check_recipe(&recipe, "rigid objects");
    }
}

static void everything_moving(void **state) {
    (void)state;
    for (int degree = 0; degree <= TIDES_SH_DEGREE_MAX; degree++) {
        random_recipe recipe = random_recipe_defaults(200 + (uint64_t)degree);
        recipe.sh_degree = degree;
        recipe.objects = 2;
        recipe.moving = 1;
        recipe.width = 48, recipe.height = 32;
        check_recipe(&recipe, "everything");
    }
}
static void inside_the_cloud(void **state) {
    (void)state;
    for (int i = 0; i < 4; i++) {
        random_recipe recipe = random_recipe_defaults(300 + (uint64_t)i);
        recipe.count = 150;
        recipe.spread = 4.5;
        recipe.size = 0.2;
        recipe.moving = i % 2;
        recipe.opacity_max = 0.999;
        recipe.width = 48, recipe.height = 32;
        check_recipe(&recipe, "inside");
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(moving_camera_and_objects),
        cmocka_unit_test(everything_moving),
        cmocka_unit_test(inside_the_cloud),
    };
    return cmocka_run_group_tests_name("render rates", tests, NULL, NULL);
}
