/* Flat worlds: a textured plane with a camera that moves along it, and turning discs. */
#include "generate/td_generate.h"

#include "td_math.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* -- plane: a mosaic of cells with different colours and patterns ------------------------------------------- */

enum { CELLS_X = 16, CELLS_Y = 12, PATTERNS = 7 };
#define PLANE_WIDTH 4.4  /* [m] */
#define PLANE_HEIGHT 3.3 /* [m] */

/* 1 if (a, b), in [-1, 1]^2 of a cell, is in the light part of its pattern. */
static int lit(int32_t pattern, double a, double b) {
    const double r = td_hypot(a, b);
    switch (pattern) {
        case 0: return r < 0.75;
        case 1: return (int)floor(2 * a + 2) % 2;
        case 2: return (int)floor(2 * b + 2) % 2;
        case 3: return ((int)floor(2 * a + 2) + (int)floor(2 * b + 2)) % 2;
        case 4: return r < 0.35 || (r > 0.6 && r < 0.9);
        case 5: return a + b > 0;
        default: return fabs(a) + fabs(b) < 0.8;
    }
}

static void plane_surface(const void *shape, double u, double v, double point[3], double colour[3]) {
    const uint64_t seed = *(const uint64_t *)shape;
    const double x = CELLS_X * u, y = CELLS_Y * v;
    const int32_t column = (int32_t)floor(x), row = (int32_t)floor(y), cell = row * CELLS_X + column;
    double light[3], dark[3];
    point[0] = PLANE_WIDTH * (u - 0.5);
    point[1] = PLANE_HEIGHT * (v - 0.5);
    point[2] = 0;
    td_colour_pair(seed, cell, light, dark);
    const int32_t pattern = (int32_t)(PATTERNS * td_hash((int32_t)seed, cell, 7));
    memcpy(colour, lit(pattern, 2 * (x - column) - 1, 2 * (y - row) - 1) ? light : dark, sizeof light);
}

static void build_plane(td_splats *splats, const void *seed) { td_splats_cover(splats, plane_surface, seed, 160, 120); }

/* The camera's path: a curve in front of the plane, looking straight at it. The plane moves by up to 300 px/s in an image of
 * 346 px width. */
static void slide(void *shape, tides_pose_sample *sample) {
    static const double along_minus_z[4] = {0, 1, 0, 0}; /* half a turn about x */
    static const double reach[3] = {0.50, 0.28, 0.12}, rate[3] = {2 * TD_PI * 0.7, 2 * TD_PI * 0.9, 2 * TD_PI * 0.5};
    const double *middle = shape;
    for (int k = 0; k < 3; k++) {
        sample->position[k] = middle[k] + reach[k] * td_sin(rate[k] * sample->time);
        sample->velocity[k] = reach[k] * rate[k] * td_cos(rate[k] * sample->time);
    }
    memcpy(sample->quaternion, along_minus_z, sizeof along_minus_z);
}

tides_status td_generate_plane(const tides_generate_options *options, tides_world *world, tides_error *error) {
    double middle[3] = {0, 0, 2.3};
    const td_part plane = {"plane", build_plane, &options->seed, td_generate_detail(options, TD_PLANE_GAUSSIANS), 0};
    tides_status status = td_part_add(world->scene, &plane, NULL, 1.0, error);
    return status == TIDES_OK ? td_sample_path(slide, middle, options, 0.015, &world->camera, error) : status;
}

/* -- discs ---------------------------------------------------------------------------------------------------------------- */

static tides_status add_disc(const tides_generate_options *options, int32_t number, tides_scene *scene, tides_error *error) {
    const int32_t columns = (int32_t)fmax(1, round(sqrt(1.4 * options->count))),
                  rows = (options->count + columns - 1) / columns;
    const int32_t column = number % columns, row = number / columns;
    const double cell = fmin(2.9 / columns, 2.0 / rows);
    td_disc disc = {.sectors = 6 + 2 * (number % 4)};
    td_turning turning = {.centre = {cell * (column - 0.5 * (columns - 1)), cell * (0.5 * (rows - 1) - row) + 0.05, 0},
                          .rest = {1, 0, 0, 0},
                          .axis = {0, 0, 1},
                          .rate = 2 * TD_PI * (3 + 3 * td_hash((int32_t)options->seed, number, 11))};
    if (number % 2) turning.rate = -turning.rate;
    td_colour_pair(options->seed, number, disc.light, disc.dark);
    char name[32];
    snprintf(name, sizeof name, "disc %d", (int)number);
    const td_part part = {name, td_build_disc, &disc, td_generate_detail(options, TD_DISC_GAUSSIANS), 0.004};
    tides_trajectory *path = NULL;
    tides_status status = td_path_turning(&turning, options, &path, error);
    if (status == TIDES_OK) status = td_part_add(scene, &part, path, 0.45 * cell, error);
    tides_trajectory_destroy(path);
    return status;
}

tides_status td_generate_disc(const tides_generate_options *options, tides_world *world, tides_error *error) {
    static const td_part wall = {"wall", td_build_wall, NULL, 0, 0};
    tides_status status = td_part_add(world->scene, &wall, NULL, 1.0, error);
    for (int32_t i = 0; i < options->count && status == TIDES_OK; i++) status = add_disc(options, i, world->scene, error);
    return status == TIDES_OK ? td_path_still_camera(&world->camera, error) : status;
}
