/* Makes random scenes. Values at time 0 are rounded to float, so that the scene, which is in float, and the renderer's store
 * agree. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "motion/td_activate.h"
#include "render/td_renderer.h"
#include "render/td_transfer.h"

#include "tests/support/random_scene.h"
#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PATH_SAMPLES = 5 };

random_recipe random_recipe_defaults(uint64_t seed) {
    random_recipe recipe = {seed, 60, 1, 3, 0, 64, 48, 1.5, 0.12, 0.1, 0.9, 1, TIDES_LENS_NONE, 1};
    return recipe;
}

/* Raw parameters of one Gaussian at time 0. Colours are mostly, not always, positive for every direction. */
static void draw_gaussian(const random_recipe *recipe, uint64_t *seed, double *raw) {
    for (int i = 0; i < 3; i++) raw[RANDOM_MEAN + i] = scene_between(seed, -recipe->spread, recipe->spread);
    for (int i = 0; i < 3; i++) raw[RANDOM_LOG_SCALE + i] = log(recipe->size) + scene_between(seed, -1.1, 1.1);
    for (int i = 0; i < 4; i++) raw[RANDOM_QUATERNION + i] = scene_between(seed, -1, 1);
    raw[RANDOM_QUATERNION] += raw[RANDOM_QUATERNION] < 0 ? -0.5 : 0.5; /* far from a zero quaternion while it moves */
    double opacity = scene_between(seed, recipe->opacity_min, recipe->opacity_max);
    raw[RANDOM_LOGIT] = log(opacity / (1 - opacity));
    double *sh = raw + RANDOM_SH;
    for (int k = 0; k < (recipe->sh_degree + 1) * (recipe->sh_degree + 1); k++)
        for (int c = 0; c < 3; c++) sh[3 * k + c] = k == 0 ? scene_between(seed, -1, 1.5) : scene_between(seed, -0.15, 0.15);
}

static void draw_all(random_scene *s, uint64_t *seed) {
    size_t reals = (size_t)s->recipe.count * (size_t)s->parameters;
    for (int k = 0; k < 3; k++) {
        s->raw[k] = calloc(reals, sizeof *s->raw[k]);
        assert_non_null(s->raw[k]);
    }
    for (int i = 0; i < s->recipe.count; i++) draw_gaussian(&s->recipe, seed, s->raw[0] + (size_t)i * (size_t)s->parameters);
    for (size_t i = 0; i < reals; i++) s->raw[0][i] = (float)s->raw[0][i];
    if (!s->recipe.moving) return;
    for (size_t i = 0; i < reals; i++) {
        double share = i % (size_t)s->parameters < RANDOM_SH ? 0.5 : 0.2;
        s->raw[1][i] = s->recipe.speed * scene_between(seed, -share, share);
        s->raw[2][i] = s->recipe.speed * scene_between(seed, -share, share);
    }
}

/* A path in [0, 1] s that wanders about a place and turns by up to `turn` [rad]. */
static tides_trajectory *draw_path(uint64_t *seed, const double place[3], double wander, double turn) {
    tides_pose_sample samples[PATH_SAMPLES] = {{0}};
    tides_trajectory *path = NULL;
    tides_error error;
    for (int i = 0; i < PATH_SAMPLES; i++) {
        samples[i].time = i / (double)(PATH_SAMPLES - 1);
        samples[i].quaternion[0] = 1;
        for (int k = 0; k < 3; k++) {
            samples[i].position[k] = place[k] + scene_between(seed, -wander, wander);
            samples[i].quaternion[1 + k] = scene_between(seed, -0.5 * turn, 0.5 * turn);
        }
    }
    scene_expect_ok(tides_trajectory_create(samples, PATH_SAMPLES, &path, &error), &error);
    return path;
}

static int first_of(const random_recipe *recipe, int object) { return recipe->count * object / recipe->objects; }

/* Object `which` as float arrays. */
static td_gaussians object_gaussians(const random_scene *s, int which) {
    int first = first_of(&s->recipe, which), count = first_of(&s->recipe, which + 1) - first;
    int sh = s->parameters - RANDOM_SH;
    td_gaussians g;
    tides_error error;
    scene_expect_ok(td_gaussians_create(&g, count, s->recipe.sh_degree, &error), &error);
    for (int i = 0; i < count; i++) {
        const double *raw = s->raw[0] + (size_t)(first + i) * (size_t)s->parameters;
        for (int k = 0; k < 3; k++) g.mean[3 * i + k] = (float)raw[RANDOM_MEAN + k];
        for (int k = 0; k < 3; k++) g.log_scale[3 * i + k] = (float)raw[RANDOM_LOG_SCALE + k];
        for (int k = 0; k < 4; k++) g.quaternion[4 * i + k] = (float)raw[RANDOM_QUATERNION + k];
        g.opacity_logit[i] = (float)raw[RANDOM_LOGIT];
        for (int k = 0; k < sh; k++) g.sh[sh * i + k] = (float)raw[RANDOM_SH + k];
    }
    return g;
}

static void add_objects(random_scene *s, uint64_t *seed) {
    tides_error error;
    scene_expect_ok(tides_scene_create(&s->scene, &error), &error);
    for (int i = 0; i < s->recipe.objects; i++) {
        static const double middle[3] = {0, 0, 0};
        td_gaussians g = object_gaussians(s, i);
        tides_gaussians view = td_gaussians_view(&g);
        tides_trajectory *path = i == 0 ? NULL : draw_path(seed, middle, 0.3, 1.2);
        double scale = i == 0 ? 1 : scene_between(seed, 0.6, 1.4);
        scene_expect_ok(tides_scene_add(s->scene, &view, path, scale, NULL, NULL, &error), &error);
        tides_trajectory_destroy(path);
        td_gaussians_free(&g);
    }
}

/* Sets a lens; an equidistant one has its farthest corner at 75 degrees. */
static void bend(tides_intrinsics *camera, int lens) {
    static const tides_lens radtan = {TIDES_LENS_RADTAN, 0, -0.21, 0.06, -0.004, 0, 2e-3, -3e-3};
    static const tides_lens equidistant = {TIDES_LENS_EQUIDISTANT, 0, -0.03, 0.006, -0.001, 1e-4, 0, 0};
    if (lens == TIDES_LENS_RADTAN) camera->lens = radtan;
    if (lens != TIDES_LENS_EQUIDISTANT) return;
    const double corner = hypot(camera->width - camera->cx, camera->height - camera->cy), angle = 75 / 57.29577951308232;
    camera->lens = equidistant;
    camera->fx = corner / (angle * (1 + angle * angle * (-0.03 + angle * angle * 0.006)));
    camera->fy = 0.96 * camera->fx;
}

random_scene random_scene_make(const random_recipe *recipe) {
    static const double eye[3] = {0, 0, -4};
    random_scene s = {0};
    uint64_t seed = recipe->seed;
    s.recipe = *recipe;
    s.camera.width = recipe->width;
    s.camera.height = recipe->height;
    s.camera.fx = 1.1 * recipe->width;
    s.camera.fy = 1.05 * recipe->width; /* not square, and the centre a little off, so that a mix-up shows */
    s.camera.cx = 0.5 * recipe->width + 1.3;
    s.camera.cy = 0.5 * recipe->height - 0.7;
    bend(&s.camera, recipe->lens);
    s.parameters = RANDOM_SH + 3 * (recipe->sh_degree + 1) * (recipe->sh_degree + 1);
    draw_all(&s, &seed);
    add_objects(&s, &seed);
    s.path = draw_path(&seed, eye, 0.25 * recipe->camera_speed, 0.25 * recipe->camera_speed);
    return s;
}

void random_scene_free(random_scene *scene) {
    for (int k = 0; k < 3; k++) free(scene->raw[k]);
    tides_scene_destroy(scene->scene);
    tides_trajectory_destroy(scene->path);
    memset(scene, 0, sizeof *scene);
}

/* One Gaussian's raw parameters and their rates at `time` into its place in the store. */
static void activate_at(const random_scene *s, int gaussian, double time, double *raw, double *rate, td_store *store,
                        size_t at) {
    size_t from = (size_t)gaussian * (size_t)s->parameters;
    for (int k = 0; k < s->parameters; k++) {
        double bend = s->raw[2][from + (size_t)k];
        raw[k] = s->raw[0][from + (size_t)k] + time * (s->raw[1][from + (size_t)k] + 0.5 * time * bend);
        rate[k] = s->raw[1][from + (size_t)k] + time * bend;
    }
    td_activate(raw + RANDOM_MEAN, raw + RANDOM_LOG_SCALE, raw + RANDOM_QUATERNION, raw[RANDOM_LOGIT],
                store->geometry + at * TD_GEOMETRY_STRIDE);
    td_activate_rates(rate + RANDOM_MEAN, raw + RANDOM_LOG_SCALE, rate + RANDOM_LOG_SCALE, raw + RANDOM_QUATERNION,
                      rate + RANDOM_QUATERNION, raw[RANDOM_LOGIT], rate[RANDOM_LOGIT], store->rates + at * TD_GEOMETRY_STRIDE);
    for (int k = 0; k < store->sh_stride; k++) {
        store->sh_wide[at * (size_t)store->sh_stride + (size_t)k] = raw[RANDOM_SH + k];
        store->sh_rates[at * (size_t)store->sh_stride + (size_t)k] = rate[RANDOM_SH + k];
    }
}

td_store random_scene_store(const random_scene *scene, double time) {
    td_store store = {0};
    tides_error error;
    scene_expect_ok(td_store_create(scene->scene, NULL, 1, 0, &store, &error), &error); /* places, padding */
    if (!scene->recipe.moving) return store;
    size_t count = (size_t)store.count;
    free(store.sh);
    store.sh = NULL;
    store.rates = calloc(count * TD_GEOMETRY_STRIDE, sizeof *store.rates);
    store.sh_wide = calloc(count * (size_t)store.sh_stride, sizeof *store.sh_wide);
    store.sh_rates = calloc(count * (size_t)store.sh_stride, sizeof *store.sh_rates);
    double *raw = calloc(2 * (size_t)scene->parameters, sizeof *raw);
    assert_true(store.rates && store.sh_wide && store.sh_rates && raw);
    size_t at = 0;
    for (int object = 0; object < scene->recipe.objects; object++) {
        for (int i = first_of(&scene->recipe, object); i < first_of(&scene->recipe, object + 1); i++, at++)
            activate_at(scene, i, time, raw, raw + scene->parameters, &store, at);
        at = (at + TD_PAD - 1) / TD_PAD * TD_PAD;
    }
    free(raw);
    return store;
}

double *random_scene_views(const random_scene *scene, const double *times, int slots) {
    td_view *views = calloc((size_t)slots * (size_t)scene->recipe.objects, sizeof *views);
    tides_error error;
    assert_non_null(views);
    for (int i = 0; i < slots; i++)
        scene_expect_ok(td_views_at(scene->scene, scene->path, 0, times[i], views + i * scene->recipe.objects, &error), &error);
    return (double *)views;
}

double *random_scene_backdrops(const random_scene *scene, const double *times, int slots) {
    static const double luminance[3] = {0.2126, 0.7152, 0.0722};
    td_backdrop *backdrops = calloc((size_t)slots, sizeof *backdrops);
    assert_non_null(backdrops);
    for (int i = 0; i < slots; i++) {
        td_backdrop *b = &backdrops[i];
        for (int c = 0; c < 3; c++) {
            double rate = scene->recipe.moving ? (1 + c) * scene->recipe.speed : 0;
            b->colour[c] = 0.3 + 0.1 * c + 0.2 * sin(rate * times[i]);
            b->colour_dot[c] = 0.2 * rate * cos(rate * times[i]);
            b->luminance += luminance[c] * b->colour[c];
            b->luminance_dot += luminance[c] * b->colour_dot[c];
        }
    }
    return (double *)backdrops;
}

td_image_numbers random_scene_image(const random_scene *scene, int rules, int antialias, int outputs) {
    tides_image_params params;
    td_image image;
    tides_error error;
    tides_image_params_defaults(&params);
    params.rules = rules;
    params.antialias = antialias;
    scene_expect_ok(td_image_resolve(&params, &scene->camera, scene->recipe.sh_degree, &image, &error), &error);
    image.objects = scene->recipe.objects;
    image.moving = scene->recipe.moving;
    image.outputs = outputs;
    return td_image_pack(&image);
}

td_image_numbers random_scene_coded(const td_image_numbers *numbers, int transfer, double gamma) {
    td_image image;
    memcpy(&image, numbers->real, sizeof numbers->real);
    memcpy((char *)&image + sizeof numbers->real, numbers->whole, sizeof numbers->whole);
    td_image_set_transfer(transfer, gamma, &image);
    return td_image_pack(&image);
}

tides_session *random_scene_session(void *folder, const random_scene *scene, const char *run, const char *const *sets,
                                    size_t count) {
    tides_error error;
    tides_session *session = NULL;
    scene_expect_ok(tides_scene_save(scene->scene, scene_in_folder(folder, "scene.h5"), &error), &error);
    scene_expect_ok(tides_path_save(scene_in_folder(folder, "path.json"), scene->path, &scene->camera, &error), &error);
    scene_file_write(scene_in_folder(folder, "run.json"), run, strlen(run));
    scene_expect_ok(tides_session_load(scene_in_folder(folder, "run.json"), sets, count, NULL, &session, &error), &error);
    return session;
}
