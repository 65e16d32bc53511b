/* Opens the limit, and converts scenes for it. The limit is a shared object beside the tool, which renders in plain C. It gets
 * the Gaussians unchanged, and for each object the map to the camera with its rate. */
#include "bench_limit.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* -- the object ----------------------------------------------------------------------------------------------------------- */

/* The Makefile builds the limit with -march=native on a machine with AVX-512. It runs on machines that have AVX-512, too. */
static int32_t runs_here(const limit_functions *f) {
#if defined(__GNUC__) && defined(__x86_64__)
    return f->size == sizeof *f && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
#else
    (void)f;
    return 0;
#endif
}

static int32_t open_object(bench_limit *l) {
    l->object = dlopen(LIMIT_OBJECT, RTLD_NOW | RTLD_LOCAL);
    if (!l->object) {
        snprintf(l->why, sizeof l->why, "%s isn't beside the program; make bench makes one for AVX-512", LIMIT_OBJECT);
        return 0;
    }
    l->functions = dlsym(l->object, LIMIT_SYMBOL);
    if (l->functions && runs_here(l->functions)) return 1;
    snprintf(l->why, sizeof l->why, "%s was made for another machine; make bench builds one for this", LIMIT_OBJECT);
    return 0;
}

/* -- scenes --------------------------------------------------------------------------------------------------------------- */

/* c = a^T b; with `more`, c += a^T b. */
static void multiply(const double a[9], const double b[9], double factor, int32_t more, double c[9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double sum = more ? c[3 * i + j] : 0;
            for (int k = 0; k < 3; k++) sum += factor * a[3 * k + i] * b[3 * k + j];
            c[3 * i + j] = sum;
        }
}

/* p_camera = Rc^T (s Ro p + to - tc), and its rate. */
static limit_view view_of(const tides_pose *camera, const tides_pose *object, double scale) {
    limit_view view;
    multiply(camera->rotation, object->rotation, scale, 0, view.r);
    multiply(camera->rotation_dot, object->rotation, scale, 0, view.r_dot);
    multiply(camera->rotation, object->rotation_dot, scale, 1, view.r_dot);
    for (int i = 0; i < 3; i++) {
        view.t[i] = view.t_dot[i] = 0;
        for (int k = 0; k < 3; k++) {
            const double apart = object->position[k] - camera->position[k];
            const double apart_dot = object->position_dot[k] - camera->position_dot[k];
            view.t[i] += camera->rotation[3 * k + i] * apart;
            view.t_dot[i] += camera->rotation_dot[3 * k + i] * apart + camera->rotation[3 * k + i] * apart_dot;
        }
    }
    return view;
}

static tides_status find_views(const bench_scene *scene, double time, limit_view *views, tides_error *error) {
    tides_pose camera;
    tides_status status = tides_trajectory_at(scene->camera, time, &camera, error);
    for (int32_t k = 0; k < tides_scene_objects(scene->scene) && status == TIDES_OK; k++) {
        tides_object object;
        tides_pose pose = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
        status = tides_scene_object(scene->scene, k, &object, error);
        if (status == TIDES_OK && object.trajectory) status = tides_trajectory_at(object.trajectory, time, &pose, error);
        if (status == TIDES_OK) views[k] = view_of(&camera, &pose, object.scale);
    }
    return status;
}

static limit_object object_of(const tides_gaussians *g) {
    return (limit_object){.count = g->count,
                          .sh_degree = g->sh_degree,
                          .mean = g->mean,
                          .log_scale = g->log_scale,
                          .quaternion = g->quaternion,
                          .opacity_logit = g->opacity_logit,
                          .sh = g->sh,
                          .origin = {g->origin[0], g->origin[1], g->origin[2]}};
}

static tides_status make_from(const bench *b, const bench_scene *scene, limit_object *objects, bench_limit *l,
                              tides_error *error) {
    const int32_t count = tides_scene_objects(scene->scene);
    for (int32_t k = 0; k < count; k++) {
        tides_object object;
        tides_status status = tides_scene_object(scene->scene, k, &object, error);
        if (status != TIDES_OK) return status;
        objects[k] = object_of(&object.gaussians);
        if (!object.motion && object.gaussians.mean && object.gaussians.sh_degree <= 3) continue;
        snprintf(l->why, sizeof l->why, "%s moves by itself, is in double, or has SH of degree 4: the limit has no such",
                 scene->name);
        return TIDES_OK;
    }
    limit_setup setup = {.objects = objects, .object_count = count, .threads = b->info.compute_units};
    setup.width = scene->intrinsics.width, setup.height = scene->intrinsics.height;
    setup.fx = scene->intrinsics.fx, setup.fy = scene->intrinsics.fy;
    setup.cx = scene->intrinsics.cx, setup.cy = scene->intrinsics.cy;
    memcpy(setup.luminance, scene->image.luminance, sizeof setup.luminance);
    memcpy(setup.background, scene->image.background, sizeof setup.background);
    setup.log_eps = scene->image.log_eps, setup.dilation = scene->image.dilation;
    l->limit = l->functions->create(&setup);
    return l->limit ? TIDES_OK : cli_error(error, TIDES_NO_MEMORY, "out of memory: the limit of %s", scene->name);
}

tides_status bench_limit_make(const bench *b, const bench_scene *scene, bench_limit *made, tides_error *error) {
    const size_t objects = (size_t)tides_scene_objects(scene->scene);
    memset(made, 0, sizeof *made);
    if (!open_object(made)) return TIDES_OK;
    made->pixels = (size_t)scene->intrinsics.width * (size_t)scene->intrinsics.height;
    made->L = malloc(made->pixels * sizeof *made->L);
    made->L_dot = malloc(made->pixels * sizeof *made->L_dot);
    made->views = malloc(objects * sizeof *made->views);
    limit_object *list = calloc(objects, sizeof *list);
    tides_status status = made->L && made->L_dot && made->views && list
                              ? make_from(b, scene, list, made, error)
                              : cli_error(error, TIDES_NO_MEMORY, "out of memory: the limit of %s", scene->name);
    free(list);
    if (status != TIDES_OK) bench_limit_free(made);
    return status;
}

void bench_limit_free(bench_limit *l) {
    if (l->limit) l->functions->destroy(l->limit);
    free(l->L);
    free(l->L_dot);
    free(l->views);
    if (l->object) dlclose(l->object);
    memset(l, 0, sizeof *l);
}

tides_status bench_limit_frame(bench_limit *l, const bench_scene *scene, double time, int32_t rates, limit_counts *counts,
                               tides_error *error) {
    tides_status status = find_views(scene, time, l->views, error);
    if (status != TIDES_OK) return status;
    if (l->functions->frame(l->limit, l->views, rates, l->L, l->L_dot, counts)) return TIDES_OK;
    return cli_error(error, TIDES_NO_MEMORY, "out of memory: the limit of %s", scene->name);
}
