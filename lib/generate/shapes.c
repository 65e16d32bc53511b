/* Shapes of radius 1 for the generators of worlds (ball, disc, die), and tubes. */
#include "generate/td_generate.h"

#include "td_math.h"

#include <math.h>
#include <string.h>

static void paint(const double from[3], double colour[3]) { memcpy(colour, from, 3 * sizeof *colour); }

/* -- colours ------------------------------------------------------------------------------------------------------------ */

/* Converts a hue in [0, 1) to sRGB, with a given saturation and brightness. */
static void hue_colour(double hue, double share, double light, double colour[3]) {
    for (int k = 0; k < 3; k++) {
        const double ramp = fabs(fmod(6 * hue + 4 - 2 * k, 6) - 3) - 1; /* trapezoid of the HSV model: up, 1, down, 0 */
        colour[k] = light * (1 - share + share * fmin(fmax(ramp, 0), 1));
    }
}

void td_colour_pair(uint64_t seed, int32_t number, double light[3], double dark[3]) {
    const int32_t low = (int32_t)(seed & 0x7fffffff), high = (int32_t)(seed >> 33);
    const double first = td_hash(low, high, -1);
    const double hue = fmod(first + 0.618034 * number, 1.0); /* steps of the golden ratio keep neighbours apart */
    if (td_hash(low, high, number) < 0.5) {
        hue_colour(hue, 0.10, 0.97, light);
        hue_colour(hue, 0.80, 0.80, dark);
    } else {
        hue_colour(hue, 0.75, 0.97, light);
        hue_colour(hue, 0.40, 0.15, dark);
    }
}

/* -- ball --------------------------------------------------------------------------------------------------------------- */

static void ball_colour(const td_ball *b, double u, double v, double colour[3]) {
    static const double white[3] = {0.96, 0.95, 0.92};
    const double across = b->pattern == TD_BALL_DOTS ? 10 * u : 12 * u, upwards = b->pattern == TD_BALL_DOTS ? 6 * v : 8 * v;
    const int32_t meridian = (int32_t)floor(across), parallel = (int32_t)floor(upwards);
    if (b->pattern == TD_BALL_STRIPES)
        paint(meridian % 2 ? white : meridian % 4 ? b->light : b->dark, colour);
    else if (b->pattern == TD_BALL_CHECKER)
        paint((meridian + parallel) % 2 ? b->light : b->dark, colour);
    else
        paint(td_hypot(across - meridian - 0.5, upwards - parallel - 0.5) < 0.34 ? b->light : b->dark, colour);
}

/* Surface of a ball. Its pole leans towards the camera, so that a pattern doesn't look like a globe. */
static void ball_surface(const void *shape, double u, double v, double point[3], double colour[3]) {
    const double longitude = 2 * TD_PI * u, latitude = TD_PI * (v - 0.5), lean = 0.6;
    const double y = td_sin(latitude), z = td_cos(latitude) * td_cos(longitude);
    point[0] = td_cos(latitude) * td_sin(longitude);
    point[1] = td_cos(lean) * y - td_sin(lean) * z;
    point[2] = td_sin(lean) * y + td_cos(lean) * z;
    ball_colour(shape, u, v, colour);
}

void td_build_ball(td_splats *splats, const void *ball) { td_splats_cover(splats, ball_surface, ball, 60, 30); }

/* -- disc --------------------------------------------------------------------------------------------------------------- */

static void disc_surface(const void *shape, double u, double v, double point[3], double colour[3]) {
    const td_disc *disc = shape;
    const double radius = 0.04 + 0.96 * v, angle = -2 * TD_PI * u; /* faces +z */
    point[0] = radius * td_cos(angle);
    point[1] = radius * td_sin(angle);
    /* Sectors are tilted vanes: neighbours differ in depth, and keep their order as the disc turns. */
    point[2] = 0.12 * (disc->sectors * u - floor(disc->sectors * u)) + 0.1 * (1 - v);
    paint((int32_t)floor(disc->sectors * u + (v > 0.55 ? 0.5 : 0)) % 2 ? disc->light : disc->dark, colour);
}

void td_build_disc(td_splats *splats, const void *disc) { td_splats_cover(splats, disc_surface, disc, 60, 12); }

/* -- die ---------------------------------------------------------------------------------------------------------------- */

/* A face of the die: its normal points along an axis (0: x, 1: y, 2: z) in the direction of `sign`. */
typedef struct die_face {
    const td_die *die;
    int axis, sign, pips;
} die_face;

/* 1 if a place on the face, in [-1, 1]^2, is in a pip. */
static int on_pip(int pips, double a, double b) {
    static const double where[7][2] = {{0, 0}, {-0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}, {0.5, -0.5}, {-0.5, 0}, {0.5, 0}};
    for (int i = pips % 2 ? 0 : 1; i < pips + (pips % 2 ? 0 : 1); i++)
        if (td_hypot(a - where[i][0], b - where[i][1]) < 0.24) return 1;
    return 0;
}

static void die_surface(const void *shape, double u, double v, double point[3], double colour[3]) {
    const die_face *face = shape;
    /* the sign makes normals point outwards */
    const double half = sqrt(1.0 / 3.0), a = 2 * u - 1, b = face->sign * (2 * v - 1);
    point[face->axis] = face->sign * half;
    point[(face->axis + 1) % 3] = half * a;
    point[(face->axis + 2) % 3] = half * b;
    paint(on_pip(face->pips, a, b) ? face->die->pips : face->die->colour, colour);
}

void td_build_die(td_splats *splats, const void *die) {
    for (int axis = 0; axis < 3; axis++)
        for (int sign = -1; sign < 2; sign += 2) {
            const die_face face = {die, axis, sign, sign > 0 ? axis + 1 : 6 - axis}; /* opposite faces make seven */
            td_splats_cover(splats, die_surface, &face, 12, 12);
        }
}

/* -- tube --------------------------------------------------------------------------------------------------------------- */

/* Surface of a cylinder. u = 0 is on the side of the cross product of x and the axis; of y, if the axis is nearly along x. */
static void tube_surface(const void *shape, double u, double v, double point[3], double colour[3]) {
    const td_tube *t = shape;
    double axis[3], side[3], other[3], length = 0;
    for (int i = 0; i < 3; i++) axis[i] = t->to[i] - t->from[i];
    length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    for (int i = 0; i < 3; i++) axis[i] /= length;
    const double flat = td_hypot(axis[1], axis[2]);
    side[0] = 0;
    side[1] = flat > 0.3 ? -axis[2] / flat : 1;
    side[2] = flat > 0.3 ? axis[1] / flat : 0;
    other[0] = axis[1] * side[2] - axis[2] * side[1];
    other[1] = axis[2] * side[0] - axis[0] * side[2];
    other[2] = axis[0] * side[1] - axis[1] * side[0];
    for (int i = 0; i < 3; i++)
        point[i] = t->from[i] + v * length * axis[i] +
                   t->radius *
                       (td_cos(2 * TD_PI * u) * side[i] + td_sin(2 * TD_PI * u) * other[i]); /* so that u x v points outwards */
    paint(t->colour, colour);
}

void td_build_tube(td_splats *splats, const void *tube) {
    const td_tube *t = tube;
    td_splats_cover(splats, tube_surface, t, t->around, t->along);
}
