/* The built-in scenes of `tides bench`, each for a run of 5 to 20 ms. They are the same at every run of the benchmark, and
 * small enough for one on two cores. */
#include "bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
#define CAMERA_Z 3.05 /* z [m] of all cameras here but the orbit's; the demo's camera has it, too */
#define SLACK_S 0.01  /* [s] paths end this much later than the run */

typedef tides_status (*scene_maker)(bench_scene *s, tides_error *error);

/* A built-in scene. Width, height and duration are those without --quick. */
typedef struct recipe {
    const char *name, *sentence;
    scene_maker make;
    const char *file;      /* without `make`: a .ply below $TIDES_SHARED/data; NULL, too: the scene's name is a path */
    int32_t width, height; /* [px] */
    double duration_s, macro_step_s;
    double truth_step_s; /* [s] longest step with which the search of the exact stream begins; 0: macro_step_s / 8 */
    int32_t transfer;    /* TIDES_TRANSFER_*; all but _FILE override the transfer that the .ply names */
} recipe;

/* -- rooms ------------------------------------------------------------------------------------------------------------- */

/* A camera at rest at (0, 0.1, 3.05) that looks along -z: the pose of the still cameras of `tides scene`. */
static tides_status still_camera(bench_scene *s, tides_error *error) {
    static const double position[3] = {0, 0.1, CAMERA_Z}, along_minus_z[4] = {0, 1, 0, 0}; /* half a turn about x */
    return tides_trajectory_create_static(position, along_minus_z, &s->camera, error);
}

static tides_status handheld_camera(bench_scene *s, double frequency, double shift, double turn, tides_error *error) {
    const tides_handheld hand = {
        .position = {0.10, 0.42, CAMERA_Z},
        .target = {0.0, -0.02, 0.0},
        .up = {0, 1, 0},
        .position_amplitude = shift,
        .rotation_amplitude = turn,
        .frequency = frequency,
        .seed = 346,
        .start = 0,
        .stop = s->stop + SLACK_S,
    };
    return tides_trajectory_create_handheld(&hand, &s->camera, error);
}

/* Pixels per metre at depth z = 0, where all moving objects are. */
static double pixels_per_metre(const bench_scene *s) { return s->intrinsics.fx / CAMERA_Z; }

static tides_status make_fan(bench_scene *s, tides_error *error) {
    tides_status status = bench_add_room(s->scene, error);
    if (status == TIDES_OK) status = bench_add_fan(s->scene, s->stop + SLACK_S, error);
    return status == TIDES_OK ? handheld_camera(s, 1.5, 0.012, 0.006, error) : status; /* the demo's shake */
}

static tides_status make_handheld(bench_scene *s, tides_error *error) {
    tides_status status = bench_add_room(s->scene, error);
    return status == TIDES_OK ? handheld_camera(s, 2.0, 0.02, 0.03, error) : status;
}

static tides_status make_occluder(bench_scene *s, tides_error *error) {
    static const double centre[3] = {0, 0.1, 0}, pixels_per_s = 1200;
    tides_status status = bench_add_wall(s->scene, error);
    if (status == TIDES_OK)
        status = bench_add_flying_ball(s->scene, centre, 0.3, pixels_per_s / pixels_per_metre(s), s->stop + SLACK_S, error);
    return status == TIDES_OK ? still_camera(s, error) : status;
}

static tides_status make_nearly_static(bench_scene *s, tides_error *error) {
    static const double centre[3] = {0.35, 0.25, 0}, moving_share = 0.02, turns_per_s = 6;
    const double pixels = moving_share * s->intrinsics.width * s->intrinsics.height;
    const double radius = sqrt(pixels / PI) / pixels_per_metre(s);
    tides_status status = bench_add_room(s->scene, error);
    if (status == TIDES_OK) status = bench_add_turning_disc(s->scene, centre, radius, turns_per_s, s->stop + SLACK_S, error);
    return status == TIDES_OK ? still_camera(s, error) : status;
}

/* -- scenes that return to their state within a step ------------------------------------------------------------------- */

/* A ball vibrates by 2 px at 100 Hz and by 0.5 px at 200 Hz. The camera vibrates by 0.5 px at 200 Hz and by 0.2 px at 137.5 Hz,
 * which isn't a multiple of 100 Hz, the rate of macro steps. Without 137.5 Hz, the scene would be in the same state at the
 * start of every macro step. */
static tides_status make_vibration(bench_scene *s, tides_error *error) {
    const double pixel = 1 / pixels_per_metre(s);
    const bench_vibration ball = {.centre = {0, 0.1, 0},
                                  .quaternion = {1, 0, 0, 0},
                                  .along = {0.8, 0.6, 0},
                                  .amplitude = {2 * pixel, 0.5 * pixel},
                                  .hz = {100, 200}};
    const bench_vibration camera = {.centre = {0, 0.1, CAMERA_Z},
                                    .quaternion = {0, 1, 0, 0},
                                    .along = {0.6, 0.8, 0},
                                    .amplitude = {0.5 * pixel, 0.2 * pixel},
                                    .hz = {200, 137.5}};
    tides_status status = bench_add_plane(s->scene, 2000, error);
    if (status == TIDES_OK) status = bench_add_vibrating_ball(s->scene, &ball, 0.3, s->stop + SLACK_S, error);
    return status == TIDES_OK ? bench_vibrating_path(&camera, s->stop + SLACK_S, &s->camera, error) : status;
}

/* Two planes side by side, the left one under a lamp on mains at 100 Hz, the right one under LEDs at 1 kHz. */
static tides_status make_flicker(bench_scene *s, tides_error *error) {
    const bench_lamp mains = {.centre = {-0.75, 0.1, 0}, .scale = 0.55, .gaussians = 1200, .hz = 100, .depth = 0.5};
    const bench_lamp leds = {.centre = {0.75, 0.1, 0}, .scale = 0.55, .gaussians = 1200, .hz = 1000, .depth = 0.3};
    tides_status status = bench_add_lit_plane(s->scene, &mains, s->stop + SLACK_S, error);
    if (status == TIDES_OK) status = bench_add_lit_plane(s->scene, &leds, s->stop + SLACK_S, error);
    return status == TIDES_OK ? still_camera(s, error) : status;
}

/* -- trained scenes ------------------------------------------------------------------------------------------------------ */

static int ascending(const void *a, const void *b) {
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* The value below which `share` of the numbers lie; sorts them. */
static double quantile(float *values, size_t count, double share) {
    qsort(values, count, sizeof *values, ascending);
    return values[(size_t)(share * (double)(count - 1))];
}

/* Finds the place of a trained object. Its centre has the medians of the splats' x, y and z, and 90 % of the splats lie within
 * its radius. So distant floaters (stray splats) hardly move either. */
static tides_status find_object(const tides_scene *scene, double centre[3], double *radius, tides_error *error) {
    tides_object object;
    tides_status status = tides_scene_object(scene, 0, &object, error);
    if (status != TIDES_OK) return status;
    const size_t count = (size_t)object.gaussians.count;
    float *values = malloc(count * sizeof *values);
    if (!values) return cli_error(error, TIDES_NO_MEMORY, "out of memory: %zu Gaussians", count);
    const float *mean = object.gaussians.mean;
    for (size_t k = 0; k < 3; k++) {
        for (size_t i = 0; i < count; i++) values[i] = mean[3 * i + k];
        centre[k] = quantile(values, count, 0.5);
    }
    for (size_t i = 0; i < count; i++)
        values[i] = (float)sqrt(pow(mean[3 * i] - centre[0], 2) + pow(mean[3 * i + 1] - centre[1], 2) +
                                pow(mean[3 * i + 2] - centre[2], 2));
    *radius = quantile(values, count, 0.9);
    free(values);
    return TIDES_OK;
}

/* An orbit at 6 rad/s, at a distance from which the object fills the view. */
static tides_status orbit_camera(bench_scene *s, tides_error *error) {
    tides_orbit orbit = {.up = {0, -1, 0}, .angular_speed = 6.0, .start = 0, .stop = s->stop + SLACK_S};
    double radius = 1;
    tides_status status = find_object(s->scene, orbit.target, &radius, error);
    if (status != TIDES_OK) return status;
    orbit.radius = radius * s->intrinsics.fy / (0.5 * s->intrinsics.height);
    orbit.height = 0.2 * orbit.radius;
    return tides_trajectory_create_orbit(&orbit, &s->camera, error);
}

/* A file with more Gaussians than this gets a run of at most 2 ms instead of 6 ms. The double reference renders the exact
 * stream, which took 100 s of processor time for 90 000 Gaussians. */
#define LARGE_SCENE 50000
#define LARGE_SCENE_STOP_S 0.002

static tides_status make_trained(bench_scene *s, const char *file, tides_error *error) {
    tides_status status = tides_scene_add_file(s->scene, file, NULL, 1.0, error);
    if (tides_scene_count(s->scene) > LARGE_SCENE) s->stop = fmin(s->stop, LARGE_SCENE_STOP_S);
    return status == TIDES_OK ? orbit_camera(s, error) : status;
}

/* -- the table ------------------------------------------------------------------------------------------------------------- */

/* Column macro_step_s is 10 ms, the default of run files, or the whole run if that is shorter. Error control cuts a macro step
 * with motion into at least two steps. */
static const recipe recipes[] = {
    {"fan", "a textured fan before a room, handheld camera", make_fan, NULL, 240, 180, 0.005, 0.005, 0, 0},
    {"handheld", "a textured room at rest, handheld camera", make_handheld, NULL, 240, 180, 0.005, 0.005, 0, 0},
    {"occluder", "a ball at 1200 px/s before a textured wall, camera at rest", make_occluder, NULL, 240, 180, 0.020, 0.010, 0,
     0},
    {"nearly_static", "a disc on 2 % of the view turns, all else at rest", make_nearly_static, NULL, 240, 180, 0.020, 0.010, 0,
     0},
    {"vibration", "a ball before a textured plane and the camera vibrate, 100, 137.5 and 200 Hz", make_vibration, NULL, 120, 90,
     0.0147, 0.010, 5e-4, 0},
    {"flicker", "textured planes under lamps at 100 Hz and 1 kHz, camera at rest", make_flicker, NULL, 120, 90, 0.0103, 0.010,
     1e-4, 0},
    {"trained", "guitar of 20 000 splats, camera in orbit", NULL, "playcanvas/guitar_20k_inria_sh0.ply", 240, 180, 0.006, 0.006,
     2.5e-4, TIDES_TRANSFER_LINEAR},
    {"playbot", "playbot of 3 000 splats, camera in orbit", NULL, "playcanvas/playbot_lod5_inria_sh2.ply", 240, 180, 0.006,
     0.006, 2.5e-4, TIDES_TRANSFER_LINEAR},
    {"trained_srgb", "guitar of 20 000 splats, colours decoded as sRGB, camera in orbit", NULL,
     "playcanvas/guitar_20k_inria_sh0.ply", 240, 180, 0.006, 0.006, 2.5e-4, TIDES_TRANSFER_SRGB},
    {"playbot_srgb", "playbot of 3 000 splats, colours decoded as sRGB, camera in orbit", NULL,
     "playcanvas/playbot_lod5_inria_sh2.ply", 240, 180, 0.006, 0.006, 2.5e-4, TIDES_TRANSFER_SRGB},
};
enum { RECIPES = sizeof recipes / sizeof recipes[0] };
static const recipe any_file = {"",     "a trained scene, camera in orbit",
                                NULL,   NULL,
                                240,    180,
                                0.006,  0.006,
                                2.5e-4, TIDES_TRANSFER_FILE};

const char *const *bench_scene_names(void) {
    static const char *const names[] = {"fan",     "handheld", "occluder",     "nearly_static", "vibration", "flicker",
                                        "trained", "playbot",  "trained_srgb", "playbot_srgb",  NULL};
    return names;
}

/* Sets all of a scene but its content. With --quick, an image has 96x72 pixels and a run lasts 2.5 ms, so that a benchmark
 * takes seconds. */
static void lay_out(bench_scene *s, const recipe *r, int32_t quick) {
    const int32_t width = quick ? 96 : r->width, height = quick ? 72 : r->height;
    const double focal = 300.0 / 346.0 * width; /* the demo's field of view */
    s->sentence = r->sentence;
    s->intrinsics = (tides_intrinsics){width, height, focal, focal, 0.5 * width, 0.5 * height, {0}};
    s->start = 0;
    s->stop = quick ? 0.0025 : r->duration_s;
    s->macro_step_s = r->macro_step_s;
    s->truth_step_s = r->truth_step_s > 0 ? r->truth_step_s : r->macro_step_s / BENCH_TRUTH_SPLIT;
    tides_image_params_defaults(&s->image);
    s->image.log_eps = 0.01;
    s->image.transfer = r->transfer;
    tides_sensor_defaults(&s->sensor);
    s->sensor.threshold_on = s->sensor.threshold_off = 0.2;
    s->sensor.max_events_per_step = 64;
    tides_readout_defaults(&s->readout);
    tides_filters_defaults(&s->filters);
}

void bench_lay_out(bench_scene *scene, const char *name, const char *sentence) {
    memset(scene, 0, sizeof *scene);
    snprintf(scene->name, sizeof scene->name, "%s", name);
    lay_out(scene, &any_file, 0);
    scene->sentence = sentence;
}

tides_status bench_scene_make(const char *name, int32_t quick, bench_scene *scene, tides_error *error) {
    const recipe *r = &any_file;
    for (size_t i = 0; i < RECIPES; i++)
        if (strcmp(recipes[i].name, name) == 0) r = &recipes[i];
    const char *shared = getenv("TIDES_SHARED");
    char file[4200];
    if (r->file)
        snprintf(file, sizeof file, "%s/data/%s", shared && *shared ? shared : "../shared", r->file);
    else
        snprintf(file, sizeof file, "%s", name);
    const char *slash = strrchr(name, '/');
    bench_scene made;
    memset(&made, 0, sizeof made);
    snprintf(made.name, sizeof made.name, "%s", slash ? slash + 1 : name);
    lay_out(&made, r, quick);
    tides_status status = tides_scene_create(&made.scene, error);
    if (status == TIDES_OK) status = r->make ? r->make(&made, error) : make_trained(&made, file, error);
    if (status == TIDES_OK)
        *scene = made;
    else
        bench_scene_free(&made);
    return status;
}

void bench_scene_free(bench_scene *scene) {
    tides_trajectory_destroy(scene->camera);
    tides_scene_destroy(scene->scene);
    for (size_t i = 0; i < BENCH_RULES; i++) tides_free(scene->truth[i].events);
    memset(scene, 0, sizeof *scene);
}
