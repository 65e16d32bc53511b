/* A fan in a room: stand and guard at rest, and the blades with their hub as another object. Blades are built in the fan's
 * axes: x and y in its plane, z along the shaft towards the viewer. */
#include "generate/td_generate.h"

#include "td_math.h"

#include <math.h>
#include <string.h>

enum { BLADES = 5 };
#define FAN_X 0.0       /* [m] of the hub */
#define FAN_Y 0.18      /* [m] */
#define FAN_RADIUS 0.78 /* [m] */
#define TURN (-0.38)    /* [rad]: to the viewer's left */
#define TILT (-0.06)    /* [rad]: up */

/* The fan's rotation at rest, Ry(TURN) Rx(TILT); its columns are the fan's axes in the world. */
static void fan_axes(double rotation[9]) {
    const double cy = td_cos(TURN), sy = td_sin(TURN), cx = td_cos(TILT), sx = td_sin(TILT);
    const double made[9] = {cy, sy * sx, sy * cx, 0, cx, -sx, -sy, cy * sx, cy * cx};
    memcpy(rotation, made, sizeof made);
}

/* Converts from the fan's axes to the world. */
static void place(double x, double y, double z, double point[3]) {
    double r[9];
    fan_axes(r);
    point[0] = FAN_X + r[0] * x + r[1] * y + r[2] * z;
    point[1] = FAN_Y + r[3] * x + r[4] * y + r[5] * z;
    point[2] = r[6] * x + r[7] * y + r[8] * z;
}

/* -- blades ----------------------------------------------------------------------------------------------------------- */

/* Surface of a blade: it sweeps back with the radius, is widest at two thirds, and is pitched like a propeller. */
static void blade_surface(const void *shape, double u, double v, double point[3], double colour[3]) {
    static const double hues[BLADES][3] = {{0.90, 0.20, 0.22},
                                           {0.98, 0.66, 0.12},
                                           {0.20, 0.66, 0.32},
                                           {0.12, 0.46, 0.86},
                                           {0.58, 0.26, 0.72}};
    static const double white[3] = {0.97, 0.96, 0.93};
    const int32_t blade = *(const int32_t *)shape;
    const double radius = 0.13 + (FAN_RADIUS - 0.13) * u;
    const double past = fmax(u - 0.9, 0) / 0.105; /* where the tip is rounded */
    const double half_width = 0.33 * td_pow(td_sin(TD_PI * (0.18 + 0.72 * u)), 0.6) * sqrt(1 - past * past);
    const double angle = 2 * TD_PI * blade / BLADES - 0.55 * u + (2 * v - 1) * half_width;
    point[0] = radius * td_cos(angle);
    point[1] = radius * td_sin(angle);
    point[2] = 0.14 * (2 * v - 1) * half_width * (1.3 - 0.6 * u);
    memcpy(colour, hues[blade], sizeof white);
    /* Each blade has its own pattern: bands, chevrons, dots, stripes, or rings of diamonds. */
    const double a = 5 * u, b = 3 * v;
    const double cell = td_hypot(a - floor(a) - 0.5, b - floor(b) - 0.5),
                 diamond = fabs(a - floor(a) - 0.5) + fabs(b - floor(b) - 0.5);
    const int32_t patterns[BLADES] = {(int32_t)floor(a) % 2, (int32_t)floor(a + 3 * fabs(v - 0.5)) % 2, cell < 0.3,
                                      (int32_t)floor(b) % 2, diamond < 0.34};
    if (u > 0.15 && patterns[blade]) memcpy(colour, white, sizeof white);
    const double gloss = 0.80 + 0.25 * v; /* the leading edge is brighter */
    for (int i = 0; i < 3; i++) colour[i] = fmin(1.0, colour[i] * gloss);
}

static void hub_surface(const void *shape, double u, double v, double point[3], double colour[3]) {
    static const double gold[3] = {0.95, 0.78, 0.25}, black[3] = {0.08, 0.08, 0.10};
    (void)shape;
    const double polar = 0.5 * TD_PI * v, angle = -2 * TD_PI * u;
    point[0] = 0.15 * td_sin(polar) * td_cos(angle);
    point[1] = 0.15 * td_sin(polar) * td_sin(angle);
    point[2] = 0.03 + 0.09 * td_cos(polar);
    memcpy(colour, (int32_t)floor(6 * (u + 0.35 * v) + 12) % 2 ? gold : black, sizeof gold);
}

static void build_blades(td_splats *splats, const void *shape) {
    (void)shape;
    for (int32_t blade = 0; blade < BLADES; blade++) td_splats_cover(splats, blade_surface, &blade, 42, 20);
    td_splats_cover(splats, hub_surface, NULL, 48, 9);
}

/* -- stand and guard, at rest ------------------------------------------------------------------------------------------- */

static void foot_surface(const void *shape, double u, double v, double point[3], double colour[3]) {
    static const double steel[3] = {0.30, 0.33, 0.38}, rim[3] = {0.72, 0.74, 0.78};
    (void)shape;
    point[0] = FAN_X + 0.36 * v * td_cos(2 * TD_PI * u);
    point[1] = TD_TABLE_Y + 0.03 + 0.05 * (1 - v * v);
    point[2] = -0.2 + 0.30 * v * td_sin(2 * TD_PI * u);
    memcpy(colour, v > 0.88 ? rim : steel, sizeof steel);
}

static void build_stand(td_splats *splats, const void *shape) {
    const td_tube pole = {{FAN_X, TD_TABLE_Y + 0.03, -0.2}, {FAN_X, FAN_Y, -0.2}, 0.04, {0.55, 0.58, 0.63}, 14, 36};
    td_tube motor = {{0, 0, 0}, {0, 0, 0}, 0.14, {0.24, 0.26, 0.30}, 28, 8};
    (void)shape;
    place(0, 0, -0.36, motor.from);
    place(0, 0, -0.06, motor.to);
    td_splats_cover(splats, foot_surface, NULL, 40, 8);
    td_build_tube(splats, &pole);
    td_build_tube(splats, &motor);
}

/* Wire rings and spokes in front of the blades: so thin that the turning blades are visible. */
static void build_guard(td_splats *splats, const void *shape) {
    enum { PIECES = 96, SPOKES = 16 };
    static const double chrome[3] = {0.86, 0.88, 0.92}, radii[] = {0.86, 0.56, 0.30};
    const double widths[] = {0.012, 0.0045, 0.0045};
    (void)shape;
    for (size_t ring = 0; ring < sizeof radii / sizeof radii[0]; ring++)
        for (int32_t i = 0; i < PIECES; i++) {
            double a[3], b[3];
            place(radii[ring] * td_cos(2 * TD_PI * i / PIECES), radii[ring] * td_sin(2 * TD_PI * i / PIECES), 0.15, a);
            place(radii[ring] * td_cos(2 * TD_PI * (i + 1) / PIECES), radii[ring] * td_sin(2 * TD_PI * (i + 1) / PIECES), 0.15,
                  b);
            td_splats_line(splats, a, b, 1, widths[ring], chrome);
        }
    for (int32_t i = 0; i < SPOKES; i++) {
        double a[3], b[3];
        const double angle = 2 * TD_PI * (i + 0.5) / SPOKES;
        place(0.14 * td_cos(angle), 0.14 * td_sin(angle), 0.17, a);
        place(0.86 * td_cos(angle), 0.86 * td_sin(angle), 0.15, b);
        td_splats_line(splats, a, b, 14, 0.0045, chrome);
    }
}

/* -- the world ---------------------------------------------------------------------------------------------------------- */

tides_status td_generate_fan(const tides_generate_options *options, tides_world *world, tides_error *error) {
    static const td_part stand = {"stand", build_stand, NULL, 0, 0}, guard = {"guard", build_guard, NULL, 0, 0};
    static const double x_axis[3] = {1, 0, 0}, y_axis[3] = {0, 1, 0};
    const td_part blades = {"blades", build_blades, NULL, td_generate_detail(options, TD_FAN_GAUSSIANS), 0};
    td_turning turning = {.centre = {FAN_X, FAN_Y, 0}, .axis = {0, 0, 1}, .rate = 2 * TD_PI * 4.0}; /* 4 turns per second */
    double about_x[4], about_y[4];
    td_quaternion_about(x_axis, TILT, about_x);
    td_quaternion_about(y_axis, TURN, about_y);
    td_quaternion_product(about_y, about_x, turning.rest);
    tides_trajectory *path = NULL;
    tides_status status = td_generate_room(options, world, error);
    if (status == TIDES_OK) status = td_part_add(world->scene, &stand, NULL, 1.0, error);
    if (status == TIDES_OK) status = td_part_add(world->scene, &guard, NULL, 1.0, error);
    if (status == TIDES_OK) status = td_path_turning(&turning, options, &path, error);
    if (status == TIDES_OK) status = td_part_add(world->scene, &blades, path, 1.0, error);
    tides_trajectory_destroy(path);
    return status;
}
