/* Any tiny scene with any sensor. A run at once, a run that is cut at any times and continued from checkpoints, and, if
 * TIDES_FUZZ_DEVICE names an OpenCL device, that device's run give the same events to the bit. Events are in order, within the
 * image and the run. */
#include "fuzz.h"

#include "bytes.h"
#include "tides/motion.h"
#include "tides/simulate.h"

#include <math.h>

enum { SPLATS = 6, CUTS = 3, WIDTH = 20, HEIGHT = 17 };

/* What is simulated. */
typedef struct world {
    tides_scene *scene;
    tides_trajectory *camera;
    tides_intrinsics intrinsics;
    tides_image_params image;
    tides_sensor sensor;
    tides_stepping stepping;
    double start, stop;
    int bends; /* something moves by itself */
} world;

typedef struct stream {
    tides_event *events;
    size_t count, capacity;
} stream;

static int collect(void *user, const tides_event *events, size_t count) {
    stream *s = user;
    if (s->count + count > s->capacity) {
        s->capacity = 2 * (s->count + count);
        s->events = realloc(s->events, s->capacity * sizeof *events);
        if (!s->events) abort();
    }
    if (count) memcpy(s->events + s->count, events, count * sizeof *events);
    s->count += count;
    return 0;
}

/* -- making it ------------------------------------------------------------------------------------------------------------- */

static tides_trajectory *path_of(fuzz_bytes *b, double start, double stop, double away) {
    tides_pose_sample samples[4];
    tides_trajectory *path = NULL;
    tides_error error = {TIDES_OK, ""};
    memset(samples, 0, sizeof samples);
    for (int i = 0; i < 4; i++) {
        samples[i].time = start + (stop - start) * i / 3;
        samples[i].quaternion[0] = 1;
        for (int k = 0; k < 3; k++) {
            samples[i].position[k] = fuzz_between(b, -0.1, 0.1) - (k == 2 ? away : 0);
            samples[i].quaternion[1 + k] = fuzz_between(b, -0.05, 0.05);
        }
    }
    if (tides_trajectory_create(samples, 4, &path, &error) != TIDES_OK) abort();
    return path;
}

/* Cubics of time, in turn and opacity too. */
static tides_motion *motion_of(fuzz_bytes *b, int count) {
    float centre[SPLATS], width[SPLATS], bend[9 * SPLATS], turn[4 * SPLATS];
    tides_motion *motion = NULL;
    tides_error error = {TIDES_OK, ""};
    for (int i = 0; i < count; i++) {
        centre[i] = (float)fuzz_between(b, 0, 1);
        width[i] = (float)fuzz_between(b, -3, 3);
    }
    for (int i = 0; i < 9 * count; i++) bend[i] = (float)fuzz_between(b, -0.5, 0.5);
    for (int i = 0; i < 4 * count; i++) turn[i] = (float)fuzz_between(b, -1, 1);
    const tides_polynomial_motion arrays = {.count = count,
                                            .stop = 1,
                                            .opacity_centre = centre,
                                            .opacity_log_width = width,
                                            .mean_coefficient = bend,
                                            .quaternion_dot = turn};
    if (tides_motion_create_polynomial(&arrays, &motion, &error) != TIDES_OK) abort();
    return motion;
}

/* On a path, or bent in `duration` seconds. */
static void add_splats(tides_scene *scene, fuzz_bytes *b, const tides_trajectory *path, double duration) {
    float mean[3 * SPLATS], log_scale[3 * SPLATS], quaternion[4 * SPLATS], logit[SPLATS], sh[3 * SPLATS];
    tides_error error = {TIDES_OK, ""};
    const int count = 1 + (int)fuzz_byte(b) % SPLATS;
    for (int i = 0; i < 3 * count; i++) {
        mean[i] = (float)fuzz_between(b, -1, 1);
        log_scale[i] = (float)fuzz_between(b, -4, 0);
        sh[i] = (float)fuzz_between(b, -2, 3);
    }
    for (int i = 0; i < 4 * count; i++) quaternion[i] = (float)(i % 4 ? fuzz_between(b, -1, 1) : 1);
    for (int i = 0; i < count; i++) logit[i] = (float)fuzz_between(b, -5, 5);
    const tides_gaussians g =
        {.count = count, .mean = mean, .log_scale = log_scale, .quaternion = quaternion, .opacity_logit = logit, .sh = sh};
    const tides_status status =
        duration > 0 ? tides_scene_add_moving(scene, &g, motion_of(b, count), duration, path, 1, NULL, NULL, &error)
                     : tides_scene_add(scene, &g, path, 1, NULL, NULL, &error);
    if (status != TIDES_OK) abort();
}

/* Switches by bits, so that the device has few programs to build. */
static void choose(world *w, fuzz_bytes *b) {
    static const double tolerances[] = {0.05, 0.005, 0.2, 1};
    const uint32_t bits = fuzz_byte(b), noise = fuzz_byte(b), more = fuzz_byte(b);
    tides_sensor_defaults(&w->sensor);
    tides_stepping_defaults(&w->stepping);
    tides_image_params_defaults(&w->image);
    w->image.background[0] = 0.2;
    w->image.rules = bits & 1 ? TIDES_RULES_INRIA : TIDES_RULES_SMOOTH;
    w->stepping.mode = bits & 2 ? TIDES_STEPPING_FIXED : TIDES_STEPPING_ERROR;
    w->stepping.unit = bits & 4 ? TIDES_UNIT_BLOCK : TIDES_UNIT_TILE;
    w->stepping.solve = bits & 8 && !(bits & 1) ? TIDES_SOLVE_DOUBLE : TIDES_SOLVE_OFF;
    w->stepping.step_s = 2e-3;
    w->stepping.tolerance = tolerances[more >> 2 & 3];
    w->stepping.interpolate_motion = (int32_t)(more >> 1) & 1;
    w->bends = more & 1;
    w->sensor.threshold_on = fuzz_between(b, 0.05, 0.6);
    w->sensor.threshold_off = fuzz_between(b, 0.05, 0.6);
    w->sensor.refractory_law = (int32_t)(bits >> 5) % 3;
    w->sensor.refractory_s = noise & 1 ? 1e-4 : 0;
    w->sensor.threshold_sigma = noise & 2 ? 0.03 : 0;
    w->sensor.leak_rate_hz = noise & 4 ? 5 : 0;
    w->sensor.shot_noise_hz = noise & 8 ? 20 : 0;
    w->sensor.seed = noise;
    if (noise & 16 && w->stepping.solve == TIDES_SOLVE_OFF) w->sensor.photoreceptor_cutoff_hz = 200;
    if (noise & 32 && w->stepping.solve == TIDES_SOLVE_OFF) w->sensor.noise_rms = 0.02, w->sensor.noise_cutoff_hz = 1000;
}

static void make(world *w, fuzz_bytes *b) {
    static const double epochs[] = {0, -5, 1e3, 1e9};
    tides_error error = {TIDES_OK, ""};
    memset(w, 0, sizeof *w);
    choose(w, b);
    w->start = epochs[fuzz_byte(b) % 4];
    w->stop = w->start + fuzz_between(b, 1e-3, 8e-3);
    w->intrinsics = (tides_intrinsics){WIDTH, HEIGHT, 18, 18, 10, 8, {0}};
    w->camera = path_of(b, w->start, w->stop, 3);
    tides_trajectory *path = path_of(b, w->start, w->stop, 0);
    if (tides_scene_create(&w->scene, &error) != TIDES_OK) abort();
    add_splats(w->scene, b, NULL, 0);
    add_splats(w->scene, b, path, 0);
    if (w->bends) add_splats(w->scene, b, NULL, w->stop - w->start);
    tides_trajectory_destroy(path);
}

/* -- running it ------------------------------------------------------------------------------------------------------------ */

/* NULL where it is refused in one line. */
static tides_simulator *begin(const world *w, tides_device *device) {
    tides_simulator *made = NULL;
    tides_error error = {TIDES_OK, ""};
    const tides_status status = tides_simulator_create(device, w->scene, w->camera, &w->intrinsics, &w->image, &w->sensor,
                                                       &w->stepping, w->start, w->stop, NULL, NULL, &made, &error);
    if (status == TIDES_OK) return made;
    if (made) abort();
    fuzz_one_line(status, &error);
    return NULL;
}

static void go(tides_simulator *s, double to, stream *into) {
    tides_error error = {TIDES_OK, ""};
    if (tides_simulator_run(s, to, collect, into, NULL, NULL, &error) != TIDES_OK) abort();
}

/* Cut at CUTS times, each time gone on with by a new simulator from a checkpoint. */
static stream run_in_pieces(const world *w, tides_device *device, fuzz_bytes *b) {
    stream out = {NULL, 0, 0};
    char path[FUZZ_PATH];
    tides_error error = {TIDES_OK, ""};
    double at = w->start;
    tides_simulator *s = begin(w, device);
    for (int i = 0; i < CUTS; i++) {
        at += fuzz_between(b, 0, 1) * (w->stop - at);
        go(s, at, &out);
        if (tides_simulator_save(s, NULL, fuzz_path(path, "checkpoint.h5"), &error) != TIDES_OK) abort();
        tides_simulator_destroy(s);
        s = begin(w, device);
        if (!s || tides_simulator_restore(s, NULL, path, &error) != TIDES_OK) abort();
    }
    go(s, w->stop, &out);
    tides_simulator_destroy(s);
    return out;
}

static void check(const world *w, const stream *s) {
    const int64_t start = (int64_t)floor(w->start * 1e9), length = (int64_t)ceil((w->stop - w->start) * 1e9);
    for (size_t i = 0; i < s->count; i++) {
        const tides_event *e = &s->events[i];
        if (e->x >= WIDTH || e->y >= HEIGHT || (e->polarity != 1 && e->polarity != -1)) abort();
        if (e->t < start - 1000 || e->t - start > length + 1000 || (i && e->t < s->events[i - 1].t)) abort();
    }
}

static void expect_same(const stream *a, const stream *b) {
    if (a->count != b->count) abort();
    for (size_t i = 0; i < a->count; i++) {
        const tides_event *x = &a->events[i], *y = &b->events[i];
        if (x->t != y->t || x->x != y->x || x->y != y->y || x->polarity != y->polarity || x->cause != y->cause) abort();
    }
}

static tides_device *open_device(const char *name) {
    tides_device *device = NULL;
    tides_error error = {TIDES_OK, ""};
    if (tides_device_open(name, &device, &error) != TIDES_OK) {
        fprintf(stderr, "%s\n", error.text);
        abort();
    }
    return device;
}

static void run_all(const world *w, tides_device *reference, tides_device *other, fuzz_bytes *b) {
    stream whole = {NULL, 0, 0};
    tides_simulator *s = begin(w, reference);
    if (!s) return;
    go(s, w->stop, &whole);
    tides_simulator_destroy(s);
    check(w, &whole);
    stream pieces = run_in_pieces(w, reference, b);
    expect_same(&whole, &pieces);
    free(pieces.events);
    if (other) {
        stream there = {NULL, 0, 0};
        if (!(s = begin(w, other))) abort();
        go(s, w->stop, &there);
        tides_simulator_destroy(s);
        expect_same(&whole, &there);
        free(there.events);
    }
    free(whole.events);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static tides_device *reference = NULL, *other = NULL; /* kept: to open one takes longer than to simulate */
    const char *name = getenv("TIDES_FUZZ_DEVICE");
    fuzz_bytes b = {data, size};
    world w;
    if (!reference) {
        reference = open_device("reference-f32");
        if (name && name[0]) other = open_device(name);
    }
    make(&w, &b);
    run_all(&w, reference, other, &b);
    tides_scene_destroy(w.scene);
    tides_trajectory_destroy(w.camera);
    return 0;
}
