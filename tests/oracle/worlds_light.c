/* Random scenes with lamps, with faint splats, and with tapers. */
#include "tests/oracle/worlds_light.h"

#include <math.h>

/* Keyframes every 5 ms: a random light from -0.5 to 0.8, times each splat's own light. It passes the clamp at 0 between
 * frames. */
static void light_up(oracle_object *o, parts_seed *seed, double stop) {
    const int frames = (int)ceil(stop / 5e-3) + 1;
    oracle_object_key(o, ORACLE_MOVES_SH, frames, ORACLE_CATMULL_ROM);
    for (int f = 0; f < frames; f++) {
        const double light = parts_between(seed, -0.5, 0.8);
        o->keys.time[f] = 5e-3 * f;
        for (int i = 0; i < o->count; i++) {
            const double own = o->splat[i].sh[0][0] * 0.28209479177387814 + 0.5;
            parts_set_light(oracle_object_frame(o, f, i), light * own);
        }
    }
}

static void any_camera(oracle_scene *s, parts_seed *seed, double speed) {
    parts_motion eye = {.axis = {0, 1, 0}};
    for (int k = 0; k < 3; k++) eye.velocity[k] = parts_between(seed, -speed, speed);
    for (int k = 0; k < 3; k++) eye.bend[k] = parts_between(seed, -speed, speed) * 10;
    s->camera = parts_path(&eye, s->stop, 31);
}

/* One wide splat with keyframed light. */
void oracle_lamp(oracle_scene *s, parts_seed *seed) {
    parts_camera(s, seed, 32 + 16 * parts_one_of(seed, 3), 5e-3 * (4 + parts_one_of(seed, 6)));
    s->threshold_on *= 3;
    s->threshold_off *= 3;
    oracle_object *o = parts_object(s);
    const oracle_splat one = parts_splat(0.1, 0, 2, parts_between(seed, 0.4, 0.8), parts_between(seed, 0.5, 0.99), 1);
    oracle_object_add(o, &one);
    light_up(o, seed, s->stop);
    if (parts_one_of(seed, 2)) any_camera(s, seed, 2);
    s->background = parts_one_of(seed, 2) ? 0 : 0.05;
}

/* A hundred or a thousand splats, under one keyframed light. */
void oracle_lamps(oracle_scene *s, parts_seed *seed) {
    static const double half[3] = {1.1, 0.8, 0.5};
    const int many = parts_one_of(seed, 3) == 0;
    parts_camera(s, seed, many ? 24 : 40, 5e-3 * (many ? 2 : 3 + parts_one_of(seed, 3)));
    s->threshold_on = s->threshold_off = parts_log(seed, 0.08, 0.3);
    oracle_object *o = parts_object(s);
    if (!many)
        parts_cloud(o, seed, 100, half, 2.3, 0.03, 0.3, 0.2, 0.95);
    else
        parts_cloud(o, seed, 1000, half, 2.3, 0.02, 0.08, 0.2, 0.95);
    for (int i = 0; i < o->count; i++) o->splat[i].sh[0][1] = o->splat[i].sh[0][2] = o->splat[i].sh[0][0];
    light_up(o, seed, s->stop);
    any_camera(s, seed, 1);
    s->background = parts_one_of(seed, 2) ? 0 : 0.05;
}

/* Each splat has keyframed colours of its own, up to 10. */
void oracle_lights(oracle_scene *s, parts_seed *seed) {
    static const double half[3] = {0.9, 0.7, 0.4};
    parts_camera(s, seed, 32, 0.025);
    oracle_object *o = parts_object(s);
    parts_cloud(o, seed, 6 + parts_one_of(seed, 20), half, 2.3, 0.05, 0.4, 0.2, 0.95);
    const double spacing = parts_log(seed, 2e-3, 8e-3);
    const int frames = (int)ceil(s->stop / spacing) + 1;
    oracle_object_key(o, ORACLE_MOVES_SH, frames, parts_one_of(seed, 2) ? ORACLE_CATMULL_ROM : ORACLE_SPLINE);
    for (int f = 0; f < frames; f++) {
        o->keys.time[f] = spacing * f;
        for (int i = 0; i < o->count; i++) parts_colour(oracle_object_frame(o, f, i), seed, -1, parts_log(seed, 0.5, 10));
    }
    any_camera(s, seed, 1);
    s->background = parts_one_of(seed, 2) ? 0 : 0.1;
}

/* Three splats before black that hardly show. */
void oracle_faint(oracle_scene *s, parts_seed *seed) {
    parts_camera(s, seed, 48, 0.03);
    oracle_object *o = parts_object(s);
    const double low = parts_one_of(seed, 2) ? 0.002 : 0.005, high = low == 0.002 ? 0.008 : 0.03;
    for (int i = 0; i < 3; i++) {
        const double x = parts_between(seed, -0.4, 0.4), y = parts_between(seed, -0.3, 0.3), z = parts_between(seed, 1.8, 2.5);
        oracle_splat one = parts_splat(x, y, z, 1, parts_log(seed, low, high), 1);
        parts_shape(&one, seed, 0.08, 0.5);
        parts_set_light(&one, parts_log(seed, 0.3, 10));
        oracle_object_add(o, &one);
    }
    any_camera(s, seed, parts_log(seed, 5, 30));
}

/* Many splats before black, faint ones among them. */
void oracle_veil(oracle_scene *s, parts_seed *seed) {
    static const double half[3] = {1.1, 0.8, 0.6};
    parts_camera(s, seed, 48, 0.02);
    oracle_object *o = parts_object(s);
    parts_cloud(o, seed, 150, half, 2.3, 0.02, 0.2, 0.004, 0.9);
    for (int i = 0; i < o->count; i++) {
        parts_set_opacity(&o->splat[i], parts_log(seed, 0.004, 0.9));
        o->splat[i].logit = (double)(float)o->splat[i].logit;
    }
    any_camera(s, seed, parts_log(seed, 1, 10));
}

/* A few wide splats, as bright as 10. */
void oracle_few(oracle_scene *s, parts_seed *seed) {
    parts_camera(s, seed, 40, 0.02);
    const int count = 2 + parts_one_of(seed, 6);
    for (int i = 0; i < count; i++) {
        oracle_object *o = parts_object(s);
        oracle_splat one = parts_splat(0, 0, 0, 1, parts_between(seed, 0.02, 0.99), 1);
        parts_motion m = {.axis = {0, 0, 1}, .spin = parts_between(seed, -100, 100), .centre = 0.5 * s->stop};
        parts_shape(&one, seed, 0.03, 0.5);
        parts_set_light(&one, parts_log(seed, 0.05, 10));
        oracle_object_add(o, &one);
        m.place[2] = parts_between(seed, 1.8, 2.6);
        for (int k = 0; k < 3; k++) m.velocity[k] = parts_between(seed, -1, 1) * parts_log(seed, 1, 20);
        o->path = parts_path(&m, s->stop, 31);
    }
    s->background = parts_one_of(seed, 2) ? 0 : parts_log(seed, 0.01, 0.5);
}

/* Opacities that are keyframed through the taper before bright light. */
void oracle_fade(oracle_scene *s, parts_seed *seed) {
    parts_camera(s, seed, 32, 0.03);
    oracle_object *o = parts_object(s);
    const int count = 1 + parts_one_of(seed, 6), frames = 7;
    for (int i = 0; i < count; i++) {
        const double x = parts_between(seed, -0.3, 0.3), y = parts_between(seed, -0.2, 0.2), z = 2 + 0.1 * i;
        oracle_splat one = parts_splat(x, y, z, parts_between(seed, 0.2, 0.5), 0.5, 1);
        parts_set_light(&one, parts_log(seed, 0.2, 10));
        oracle_object_add(o, &one);
    }
    oracle_object_key(o, ORACLE_MOVES_OPACITY, frames, parts_one_of(seed, 2) ? ORACLE_CATMULL_ROM : ORACLE_SPLINE);
    for (int f = 0; f < frames; f++) {
        o->keys.time[f] = f + 1 < frames ? s->stop * f / (frames - 1) : s->stop;
        for (int i = 0; i < count; i++) parts_set_opacity(oracle_object_frame(o, f, i), parts_log(seed, 2e-4, 0.3));
    }
    if (parts_one_of(seed, 2)) any_camera(s, seed, 3);
    const oracle_splat wall = parts_splat(0, 0, 3, 2, 0.99, 5.6);
    if (parts_one_of(seed, 4) == 0) oracle_object_add(parts_object(s), &wall);
}

/* Keyframed places that rest, start, and stop. */
void oracle_stops(oracle_scene *s, parts_seed *seed) {
    static const double half[3] = {0.7, 0.5, 0.4}, wide[3] = {1.2, 0.9, 0.2};
    enum { FRAMES = 13 };
    parts_camera(s, seed, 48, 0.024);
    parts_cloud(parts_object(s), seed, 40, wide, 2.8, 0.05, 0.3, 0.2, 0.95);
    oracle_object *o = parts_object(s);
    parts_cloud(o, seed, 15, half, 2.2, 0.03, 0.2, 0.2, 0.95);
    oracle_object_key(o, ORACLE_MOVES_MEAN, FRAMES, parts_one_of(seed, 2) ? ORACLE_CATMULL_ROM : ORACLE_SPLINE);
    for (int i = 0; i < o->count; i++) {
        double gone[3] = {0, 0, 0};
        int rests = 1;
        for (int f = 0; f < FRAMES; f++) {
            if (i == 0) o->keys.time[f] = f + 1 < FRAMES ? s->stop * f / (FRAMES - 1) : s->stop;
            for (int k = 0; k < 3; k++) oracle_object_frame(o, f, i)->mean[k] += gone[k];
            if (parts_one_of(seed, 3) == 0) rests = !rests;
            for (int k = 0; k < 3 && !rests; k++) gone[k] += parts_between(seed, -0.05, 0.05);
        }
    }
    s->background = 0.1;
}

/* Narrow and faint splats that pass pixels at speed before black, so that all of their way is through the taper. */
void oracle_taper(oracle_scene *s, parts_seed *seed) {
    parts_camera(s, seed, 40, 0.02);
    s->spacing = 20e-6;
    for (int i = 0; i < 12; i++) {
        oracle_object *o = parts_object(s);
        parts_motion m = {.axis = {0, 0, 1}, .centre = parts_between(seed, 0, s->stop)};
        for (int k = 0; k < 4; k++) {
            oracle_splat one = parts_splat(parts_between(seed, -0.2, 0.2), parts_between(seed, -0.2, 0.2), 0, 1,
                                           parts_log(seed, 0.001, 0.05), 1);
            parts_shape(&one, seed, 0.01, 0.1);
            parts_set_light(&one, parts_log(seed, 0.5, 10));
            oracle_object_add(o, &one);
        }
        m.place[2] = parts_between(seed, 1.5, 2.5);
        for (int k = 0; k < 2; k++) m.velocity[k] = parts_sign(seed) * parts_log(seed, 1, 60);
        o->path = parts_path(&m, s->stop, 31);
    }
    s->log_eps = parts_one_of(seed, 2) ? 1e-3 : 1e-2;
}
