/* The kinds of random scenes that move or turn; those whose light changes are in worlds_light.c. */
#include "tests/oracle/worlds.h"

#include "tests/oracle/parts.h"
#include "tests/oracle/worlds_light.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* An object whose depth is a parabola in time: it comes 1e-3 before another object for 0.2 to 12 ms (accelerations of 2e5 to
 * 50 units/s^2), and is far behind it before and after. */
static void dip(oracle_scene *s, parts_seed *seed) {
    parts_camera(s, seed, 32, 0.03);
    const double past = 1e-3, lasts = parts_log(seed, 2e-4, 12e-3), a = 8 * past / (lasts * lasts);
    const double z = parts_between(seed, 1.5, 3), at = parts_between(seed, 0.1, 0.9) * s->stop;
    const int bright = parts_one_of(seed, 2);
    oracle_splat one = parts_splat(0, 0, z, 0.4, parts_between(seed, 0.5, 0.95), bright ? parts_between(seed, 0.5, 3) : 0.2);
    oracle_splat two = parts_splat(parts_between(seed, -0.2, 0.2), 0, 0, 0.4, parts_between(seed, 0.5, 0.95), bright ? 0.2 : 2);
    const parts_motion path = {.place = {0, 0, z - past}, .bend = {0, 0, 0.5 * a}, .centre = at};
    oracle_object_add(parts_object(s), &one);
    oracle_object *moved = parts_object(s);
    oracle_object_add(moved, &two);
    moved->path = parts_path(&path, s->stop, 31);
    s->background = parts_between(seed, 0, 0.3);
    s->spacing = 10e-6;
}

/* Wide splats that spin together, so that all of them change places in depth. */
static void spin(oracle_scene *s, parts_seed *seed) {
    const double turns = parts_log(seed, 1, 100);
    parts_camera(s, seed, 32, fmin(0.03, fmax(0.01, 0.5 / turns)));
    static const double half[3] = {0.5, 0.5, 0.5};
    oracle_object *o = parts_object(s);
    parts_cloud(o, seed, 60, half, 0, 0.1, 0.3, 0.2, 0.95);
    parts_motion m = {.place = {0, 0, parts_between(seed, 2, 3)}, .spin = 2 * PARTS_PI * turns, .centre = 0};
    double length = 0;
    for (int k = 0; k < 3; k++) {
        m.axis[k] = k == 1 ? 1 : parts_between(seed, -0.7, 0.7);
        length += m.axis[k] * m.axis[k];
    }
    for (int k = 0; k < 3; k++) m.axis[k] /= sqrt(length);
    o->path = parts_path(&m, s->stop, 31);
    s->background = 0.2;
    s->spacing = 20e-6;
}

static parts_motion wander(parts_seed *seed, double speed, double spin_rate) {
    parts_motion m = {.axis = {0, 1, 0}, .spin = spin_rate};
    for (int k = 0; k < 3; k++) m.velocity[k] = parts_between(seed, -speed, speed);
    for (int k = 0; k < 3; k++) m.bend[k] = parts_between(seed, -5 * speed, 5 * speed);
    return m;
}

/* Many random splats before a moving camera, one object that moves among them. */
static void crowd(oracle_scene *s, parts_seed *seed) {
    static const double wide[3] = {1.2, 0.9, 0.8}, small[3] = {0.2, 0.2, 0.2};
    parts_camera(s, seed, 64, 0.02);
    parts_cloud(parts_object(s), seed, 300, wide, 2.5, 0.03, 0.3, 0.1, 0.95);
    oracle_object *o = parts_object(s);
    parts_cloud(o, seed, 20, small, 0, 0.03, 0.2, 0.3, 0.95);
    parts_motion m = wander(seed, 3, parts_between(seed, -60, 60));
    m.place[2] = 2.3;
    m.centre = 0.5 * s->stop;
    o->path = parts_path(&m, s->stop, 31);
    const parts_motion eye = wander(seed, parts_log(seed, 1, 15), parts_between(seed, -15, 15));
    s->camera = parts_path(&eye, s->stop, 31);
    s->background = 0.1;
}

/* Wide splats under a turning camera. */
static void sweep(oracle_scene *s, parts_seed *seed) {
    static const double half[3] = {1.5, 1, 0.8};
    parts_camera(s, seed, 48, 0.02);
    parts_cloud(parts_object(s), seed, 30 + parts_one_of(seed, 60), half, 2.2, 0.2, 0.6, 0.1, 0.95);
    const parts_motion eye = wander(seed, 1, parts_sign(seed) * parts_log(seed, 3, 60));
    s->camera = parts_path(&eye, s->stop, 31);
    s->threshold_on *= 0.3;
    s->threshold_off *= 0.3;
    s->background = 0.1;
}

/* Splats with spherical harmonics, on an object that turns fast. */
static void harmonics(oracle_scene *s, parts_seed *seed) {
    static const double half[3] = {0.7, 0.5, 0.4};
    parts_camera(s, seed, 40, 0.02);
    oracle_object *o = parts_object(s);
    parts_cloud(o, seed, 30, half, 0, 0.05, 0.3, 0.2, 0.95);
    o->degree = 1 + parts_one_of(seed, 3);
    for (int i = 0; i < o->count; i++)
        for (int k = 1; k < (o->degree + 1) * (o->degree + 1); k++)
            for (int c = 0; c < 3; c++) o->splat[i].sh[k][c] = (double)(float)parts_between(seed, -0.6, 0.6);
    parts_motion m = {.place = {0, 0, 2.5}, .axis = {0, 1, 0}, .spin = parts_sign(seed) * parts_log(seed, 20, 400)};
    o->path = parts_path(&m, s->stop, 31);
    s->background = parts_one_of(seed, 2) ? 0 : 0.1;
}

/* An opaque object with straight edges that begin on pixels' centres, starts and stops, before a texture. */
static void edge(oracle_scene *s, parts_seed *seed) {
    static const double half[3] = {1.2, 0.9, 0.1};
    enum { SIDE = 8, SAMPLES = 41 };
    parts_camera(s, seed, 48, 0.03);
    parts_cloud(parts_object(s), seed, 60, half, 3, 0.03, 0.2, 0.3, 0.95);
    oracle_object *o = parts_object(s);
    const double px = 2 / s->focal, light = parts_log(seed, 0.02, 5);
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            /* Splats stand evenly, so that all rows and columns of pixels see the same. */
            const oracle_splat one = parts_splat((x + 0.5) * px, (y + 0.5) * px, 1e-3 * x, 0.6 * px, 0.995, light);
            oracle_object_add(o, &one);
        }
    o->path = oracle_path_make(SAMPLES, ORACLE_SPLINE);
    const double speed = parts_sign(seed) * parts_log(seed, 300, 5000) * px, begin = parts_between(seed, 0.002, 0.015);
    for (int i = 0; i < SAMPLES; i++) {
        const double t = i + 1 < SAMPLES ? s->stop * i / (SAMPLES - 1) : s->stop, gone = fmin(fmax(t - begin, 0), 0.01);
        double *p = o->path.value + 7 * i;
        o->path.time[i] = t;
        p[0] = -4 * px + speed * gone;
        p[1] = -4 * px;
        p[2] = 2;
    }
    s->background = 0.1;
}

/* An object that leaps twice: it is at another place 20 us later. */
static void leap(oracle_scene *s, parts_seed *seed) {
    static const double wide[3] = {1.2, 0.9, 0.3}, small[3] = {0.25, 0.25, 0.2};
    enum { SAMPLES = 6 };
    parts_camera(s, seed, 40, 0.02);
    parts_cloud(parts_object(s), seed, 60, wide, 2.5, 0.05, 0.3, 0.2, 0.95);
    oracle_object *o = parts_object(s);
    parts_cloud(o, seed, 12, small, 0, 0.05, 0.2, 0.3, 0.95);
    const double first = parts_between(seed, 0.003, 0.009), second = parts_between(seed, 0.011, 0.017);
    const double times[SAMPLES] = {0, first, first + 20e-6, second, second + 20e-6, s->stop};
    const double far_x = parts_between(seed, -0.8, 0.8), far_z = parts_between(seed, 1.7, 2.6);
    o->path = oracle_path_make(SAMPLES, ORACLE_RESTING);
    for (int i = 0; i < SAMPLES; i++) {
        double *p = o->path.value + 7 * i;
        o->path.time[i] = times[i];
        p[0] = i == 2 || i == 3 ? far_x : -0.1;
        p[2] = i == 2 || i == 3 ? far_z : 2.1;
    }
    const parts_motion eye = wander(seed, 0.5, 0);
    s->camera = parts_path(&eye, s->stop, 31);
    s->background = 0.1;
}

/* Many nearly opaque sheets, one close behind the other, seen askew by a camera that moves. */
static void stack(oracle_scene *s, parts_seed *seed) {
    enum { SHEETS = 24 };
    parts_camera(s, seed, 32, 0.02);
    oracle_object *o = parts_object(s);
    const double apart = parts_log(seed, 1e-4, 3e-2);
    for (int i = 0; i < SHEETS; i++) {
        oracle_splat one = parts_splat(parts_between(seed, -0.3, 0.3), parts_between(seed, -0.3, 0.3), apart * i, 0.3,
                                       parts_between(seed, 0.6, 0.999), parts_log(seed, 0.01, 3));
        one.log_scale[2] = log(0.01);
        oracle_object_add(o, &one);
    }
    parts_motion m = {.place = {0, 0, 2}, .axis = {0, 1, 0}, .spin = parts_sign(seed) * parts_log(seed, 2, 100)};
    m.centre = parts_between(seed, 0, s->stop);
    o->path = parts_path(&m, s->stop, 31);
    const parts_motion eye = wander(seed, 1, 0);
    s->camera = parts_path(&eye, s->stop, 31);
    s->background = 0.1;
}

/* A camera that flies into splats: they fade at the near plane. */
static void near_plane(oracle_scene *s, parts_seed *seed) {
    static const double half[3] = {0.5, 0.4, 0.5};
    parts_camera(s, seed, 40, 0.02);
    parts_cloud(parts_object(s), seed, 60, half, 0.7, 0.02, 0.15, 0.1, 0.95);
    parts_motion eye = wander(seed, 1, parts_between(seed, -5, 5));
    eye.velocity[2] = parts_log(seed, 5, 40);
    s->camera = parts_path(&eye, s->stop, 31);
    s->background = 0.1;
}

static const struct kind {
    const char *name;
    void (*make)(oracle_scene *scene, parts_seed *seed);
} kinds[] = {{"dip", dip},
             {"spin", spin},
             {"lamp", oracle_lamp},
             {"faint", oracle_faint},
             {"crowd", crowd},
             {"lamps", oracle_lamps},
             {"sweep", sweep},
             {"veil", oracle_veil},
             {"few", oracle_few},
             {"fade", oracle_fade},
             {"harmonics", harmonics},
             {"edge", edge},
             {"stops", oracle_stops},
             {"leap", leap},
             {"stack", stack},
             {"taper", oracle_taper},
             {"near", near_plane},
             {"lights", oracle_lights}};
enum { KINDS = sizeof kinds / sizeof *kinds };

int oracle_world_kinds(void) { return KINDS; }
const char *oracle_world_name(int kind) { return kinds[kind % KINDS].name; }

int oracle_world_named(const char *name) {
    for (int k = 0; k < KINDS; k++)
        if (strcmp(kinds[k].name, name) == 0) return k;
    return -1;
}

oracle_scene oracle_world_make(int kind, unsigned long long seed, double share) {
    const struct kind *k = &kinds[kind % KINDS];
    parts_seed draws = seed * 0x2545f4914f6cdd1du + (unsigned)(kind % KINDS) * 0x9e3779b97f4a7c15u;
    oracle_scene scene;
    memset(&scene, 0, sizeof scene);
    snprintf(scene.kind, sizeof scene.kind, "%s", k->name);
    scene.seed = seed;
    scene.share = share;
    k->make(&scene, &draws);
    oracle_scene_finish(&scene);
    return scene;
}
