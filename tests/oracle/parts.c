/* Random numbers, splats and paths of random scenes. */
#include "tests/oracle/parts.h"

#include <math.h>
#include <string.h>

static parts_seed next(parts_seed *seed) { /* splitmix64 */
    parts_seed z = (*seed += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

double parts_between(parts_seed *seed, double low, double high) {
    return low + (high - low) * (double)(next(seed) >> 11) * 0x1p-53;
}
double parts_log(parts_seed *seed, double low, double high) { return low * pow(high / low, parts_between(seed, 0, 1)); }
int parts_one_of(parts_seed *seed, int count) { return (int)(next(seed) % (unsigned)count); }
double parts_sign(parts_seed *seed) { return next(seed) % 2 ? 1 : -1; }

void parts_set_light(oracle_splat *splat, double light) {
    for (int c = 0; c < 3; c++) splat->sh[0][c] = (light - 0.5) / 0.28209479177387814;
}

void parts_set_opacity(oracle_splat *splat, double opacity) { splat->logit = log(opacity / (1 - opacity)); }

void parts_colour(oracle_splat *splat, parts_seed *seed, double low, double high) {
    for (int c = 0; c < 3; c++) splat->sh[0][c] = (parts_between(seed, low, high) - 0.5) / 0.28209479177387814;
}

oracle_splat parts_splat(double x, double y, double z, double scale, double opacity, double light) {
    oracle_splat s = {{x, y, z}, {1, 0, 0, 0}, {log(scale), log(scale), log(scale)}, 0, {{0}}};
    parts_set_opacity(&s, opacity);
    parts_set_light(&s, light);
    return s;
}

void parts_shape(oracle_splat *splat, parts_seed *seed, double low, double high) {
    for (int k = 0; k < 3; k++) splat->log_scale[k] = log(parts_log(seed, low, high));
    for (int k = 0; k < 4; k++) splat->quaternion[k] = parts_between(seed, -1, 1);
    splat->quaternion[0] += 1.5;
}

oracle_object *parts_object(oracle_scene *scene) { return &scene->object[scene->objects++]; }

void parts_cloud(oracle_object *object, parts_seed *seed, int count, const double half[3], double depth, double low,
                 double high, double faintest, double most_opaque) {
    for (int i = 0; i < count; i++) {
        const double x = parts_between(seed, -half[0], half[0]), y = parts_between(seed, -half[1], half[1]);
        const double z = depth + parts_between(seed, -half[2], half[2]);
        oracle_splat s = parts_splat(x, y, z, 1, parts_between(seed, faintest, most_opaque), 0.5);
        parts_shape(&s, seed, low, high);
        parts_colour(&s, seed, 0.02, 1);
        oracle_object_add(object, &s);
    }
}

oracle_curve parts_path(const parts_motion *m, double stop, int least) {
    const double turn = fabs(m->spin) * stop;
    const int count = (int)fmax(least, ceil(turn / (2 * PARTS_PI) * 48) + 1);
    oracle_curve path = oracle_path_make(count, ORACLE_SPLINE);
    for (int i = 0; i < count; i++) {
        const double t = i + 1 < count ? stop * i / (count - 1) : stop, d = t - m->centre;
        double *p = path.value + 7 * i;
        path.time[i] = t;
        for (int k = 0; k < 3; k++) p[k] = m->place[k] + d * (m->velocity[k] + d * m->bend[k]);
        if (m->spin == 0) continue;
        p[3] = cos(0.5 * m->spin * d);
        for (int k = 0; k < 3; k++) p[4 + k] = m->axis[k] * sin(0.5 * m->spin * d);
    }
    return path;
}

void parts_camera(oracle_scene *s, parts_seed *seed, int width, double stop) {
    s->width = (int)(s->share * width / 4) * 4;
    s->height = s->width * 3 / 4;
    s->focal = 1.25 * s->width;
    s->stop = stop;
    s->log_eps = 1e-3;
    s->leak_hz = 0.3;
    s->spacing = 40e-6;
    s->threshold_on = parts_log(seed, 0.015, 0.2);
    s->threshold_off = parts_one_of(seed, 3) ? s->threshold_on : s->threshold_on * parts_between(seed, 0.6, 1.5);
}
