/* Converts the oracle's scenes to the library's, and runs them. */
#include "tests/oracle/library.h"

#include "tests/oracle/image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The library's objects for one run. */
typedef struct library_world {
    tides_device *device;
    tides_scene *scene;
    tides_trajectory *camera;
    tides_intrinsics intrinsics;
    tides_image_params image;
} library_world;

static void free_world(library_world *w) {
    tides_trajectory_destroy(w->camera);
    tides_scene_destroy(w->scene);
    tides_device_close(w->device);
}

/* -- Gaussians and keyframes as arrays of single precision ---------------------------------------------------------------- */

/* Numbers [first, first + n) of each of `count` splats, one after the other. */
static float *column(const oracle_splat *splats, size_t count, int first, int n) {
    float *out = oracle_alloc(count * (size_t)n, sizeof *out);
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < n; k++)
            out[i * (size_t)n + (size_t)k] = (float)((const double *)(const void *)&splats[i])[first + k];
    return out;
}

typedef struct columns {
    float *mean, *quaternion, *log_scale, *logit, *sh;
} columns;

static columns columns_of(const oracle_splat *splats, size_t count, int degree) {
    return (columns){column(splats, count, ORACLE_MEAN, 3), column(splats, count, ORACLE_QUATERNION, 4),
                     column(splats, count, ORACLE_LOG_SCALE, 3), column(splats, count, ORACLE_LOGIT, 1),
                     column(splats, count, ORACLE_COLOUR, 3 * (degree + 1) * (degree + 1))};
}

static void free_columns(columns *c) {
    free(c->mean);
    free(c->quaternion);
    free(c->log_scale);
    free(c->logit);
    free(c->sh);
}

static tides_status make_motion(const oracle_object *o, tides_motion **motion, tides_error *error) {
    columns c =
        columns_of((const oracle_splat *)(const void *)o->keys.value, (size_t)o->keys.count * (size_t)o->count, o->degree);
    const tides_keyframes_motion arrays = {.frames = o->keys.count,
                                           .count = o->count,
                                           .time = o->keys.time,
                                           .mean = c.mean,
                                           .quaternion = c.quaternion,
                                           .log_scale = o->moves & ORACLE_MOVES_SCALE ? c.log_scale : NULL,
                                           .opacity_logit = o->moves & ORACLE_MOVES_OPACITY ? c.logit : NULL,
                                           .sh = o->moves & ORACLE_MOVES_SH ? c.sh : NULL,
                                           .sh_degree = o->degree,
                                           .catmull_rom = o->keys.law == ORACLE_CATMULL_ROM};
    const tides_status status = tides_motion_create_keyframes(&arrays, motion, error);
    free_columns(&c);
    return status;
}

static tides_status make_path(const oracle_curve *path, tides_trajectory **made, tides_error *error) {
    tides_pose_sample *samples = oracle_alloc((size_t)path->count + 1, sizeof *samples);
    samples[0].quaternion[0] = 1;
    for (int i = 0; i < path->count; i++) {
        samples[i].time = path->time[i];
        memcpy(samples[i].position, path->value + 7 * i, sizeof samples[i].position);
        memcpy(samples[i].quaternion, path->value + 7 * i + 3, sizeof samples[i].quaternion);
    }
    const tides_status status = tides_trajectory_create(samples, path->count ? (size_t)path->count : 1, made, error);
    free(samples);
    return status;
}

static tides_status add_object(const oracle_object *o, tides_scene *scene, tides_error *error) {
    tides_trajectory *path = NULL;
    tides_motion *motion = NULL;
    tides_status status = o->path.count ? make_path(&o->path, &path, error) : TIDES_OK;
    columns c = columns_of(o->splat, (size_t)o->count, o->degree);
    const tides_gaussians gaussians = {.count = o->count,
                                       .sh_degree = o->degree,
                                       .mean = c.mean,
                                       .log_scale = c.log_scale,
                                       .quaternion = c.quaternion,
                                       .opacity_logit = c.logit,
                                       .sh = c.sh};
    if (status == TIDES_OK && o->moves) status = make_motion(o, &motion, error);
    if (status == TIDES_OK && motion) {
        status = tides_scene_add_moving(scene, &gaussians, motion, 0, path, 1, NULL, NULL, error);
        if (status != TIDES_OK) tides_motion_destroy(motion);
    } else if (status == TIDES_OK) {
        status = tides_scene_add(scene, &gaussians, path, 1, NULL, NULL, error);
    }
    free_columns(&c);
    tides_trajectory_destroy(path);
    return status;
}

static tides_status make_world(const oracle_scene *s, const char *device, library_world *w, tides_error *error) {
    memset(w, 0, sizeof *w);
    tides_status status = tides_device_open(device, &w->device, error);
    if (status == TIDES_OK) status = tides_scene_create(&w->scene, error);
    for (int k = 0; k < s->objects && status == TIDES_OK; k++) status = add_object(&s->object[k], w->scene, error);
    if (status == TIDES_OK) status = make_path(&s->camera, &w->camera, error);
    w->intrinsics = (tides_intrinsics){s->width, s->height, s->focal, s->focal, 0.5 * s->width, 0.5 * s->height, {0}};
    tides_image_params_defaults(&w->image);
    w->image.log_eps = s->log_eps;
    w->image.transfer = s->coded ? TIDES_TRANSFER_SRGB : TIDES_TRANSFER_LINEAR;
    for (int c = 0; c < 3; c++) w->image.background[c] = s->background;
    return status;
}

/* -- events ---------------------------------------------------------------------------------------------------------------- */

static int keep(void *user, const tides_event *events, size_t count) {
    library_run *run = user;
    if (run->count + count > run->capacity) {
        const size_t capacity = 2 * (run->count + count);
        tides_event *grown = realloc(run->event, capacity * sizeof *grown);
        if (!grown) return TIDES_NO_MEMORY;
        run->event = grown;
        run->capacity = capacity;
    }
    if (count) memcpy(run->event + run->count, events, count * sizeof *events);
    run->count += count;
    return 0;
}

int library_simulate(const oracle_scene *s, const char *device, const tides_stepping *stepping, library_run *run,
                     tides_error *said) {
    library_world w;
    tides_sensor sensor;
    tides_simulator *simulator = NULL;
    tides_sensor_defaults(&sensor);
    sensor.threshold_on = s->threshold_on;
    sensor.threshold_off = s->threshold_off;
    sensor.leak_rate_hz = s->leak_hz;
    memset(run, 0, sizeof *run);
    tides_status status = make_world(s, device, &w, said);
    if (status == TIDES_OK)
        status = tides_simulator_create(w.device, w.scene, w.camera, &w.intrinsics, &w.image, &sensor, stepping, 0, s->stop,
                                        NULL, NULL, &simulator, said);
    if (status == TIDES_OK) status = tides_simulator_run(simulator, s->stop, keep, run, NULL, NULL, said);
    if (status == TIDES_OK) tides_simulator_stats(simulator, &run->stats);
    tides_simulator_destroy(simulator);
    free_world(&w);
    return status == TIDES_OK;
}

void library_run_free(library_run *run) {
    free(run->event);
    memset(run, 0, sizeof *run);
}

/* -- images ---------------------------------------------------------------------------------------------------------------- */

/* Compositing of a pixel ends where all further splats change L by no more than this. */
#define ALL_LIGHT 1e-15

static tides_status compare_at(const oracle_scene *s, const library_world *w, tides_renderer *renderer, double time,
                               library_difference *difference, tides_error *error) {
    const size_t pixels = (size_t)s->width * (size_t)s->height;
    double *library = oracle_alloc(2 * pixels, sizeof *library), *own = library + pixels;
    oracle_shown *shown = oracle_alloc((size_t)s->splats, sizeof *shown);
    oracle_light *lights = oracle_alloc(pixels, sizeof *lights);
    const tides_frame frame = {.plane = {[TIDES_L] = library}};
    const tides_status status = tides_renderer_frame(renderer, w->camera, time, &frame, error);
    oracle_image(s, shown, oracle_show(s, time, shown), lights, own);
    for (size_t i = 0; i < pixels && status == TIDES_OK; i++)
        if (!(fabs(library[i] - own[i]) <= difference->most))
            *difference = (library_difference){fabs(library[i] - own[i]), time, (int)i % s->width, (int)i / s->width};
    free(library);
    free(shown);
    free(lights);
    return status;
}

/* Time k of a comparison [s]: for even k anywhere in the run, for odd k between two neighbouring samples of an object's
 * path. */
static double time_of(const oracle_scene *s, int k) {
    const double share = fmod(0.5 + k * 0.6180339887498949, 1);
    const oracle_curve *path = &s->object[k / 2 % s->objects].path;
    if (k % 2 == 0 || path->count < 2) return share * s->stop;
    const int i = k / 2 % (path->count - 1);
    return path->time[i] + share * (path->time[i + 1] - path->time[i]);
}

int library_compare_images(const oracle_scene *s, int times, library_difference *difference, tides_error *said) {
    library_world w;
    tides_renderer *renderer = NULL;
    memset(difference, 0, sizeof *difference);
    tides_status status = make_world(s, "reference", &w, said);
    w.image.smoothing.stop_change = ALL_LIGHT;
    if (status == TIDES_OK)
        status = tides_renderer_create(w.device, w.scene, &w.intrinsics, &w.image, NULL, NULL, &renderer, said);
    for (int k = 0; k < times && status == TIDES_OK; k++) status = compare_at(s, &w, renderer, time_of(s, k), difference, said);
    tides_renderer_destroy(renderer);
    free_world(&w);
    return status == TIDES_OK;
}
