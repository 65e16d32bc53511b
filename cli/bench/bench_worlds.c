/* Scenes for timing frames and runs: trained ones, and generated ones of any number of splats. bench_world_make gives those of
 * its table a camera in orbit at 1 rad/s, except for the demo, whose camera is handheld. */
#include "bench_worlds.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ORBIT_S 2.0  /* duration of paths */
#define FRAMES_S 0.3 /* time over which frames are spread */

/* -- random numbers ------------------------------------------------------------------------------------------------------- */

static double uniform(uint64_t *state) { /* splitmix64 */
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static double normal(uint64_t *state) {
    double sum = 0;
    for (int i = 0; i < 12; i++) sum += uniform(state);
    return sum - 6;
}

/* -- made scenes ---------------------------------------------------------------------------------------------------------- */

/* Arrays of Gaussians to be filled. */
typedef struct cloud {
    int64_t count;
    int32_t degree;
    float *mean, *scale, *quaternion, *opacity, *sh;
} cloud;

static size_t coefficients(const cloud *c) { return 3 * (size_t)(c->degree + 1) * (size_t)(c->degree + 1); }

static void free_cloud(cloud *c) { free(c->mean), free(c->scale), free(c->quaternion), free(c->opacity), free(c->sh); }

static int32_t make_cloud(cloud *c, int64_t count, int32_t degree) {
    const size_t n = (size_t)count;
    *c = (cloud){.count = count, .degree = degree};
    c->mean = malloc(3 * n * sizeof *c->mean);
    c->scale = malloc(3 * n * sizeof *c->scale);
    c->quaternion = malloc(4 * n * sizeof *c->quaternion);
    c->opacity = malloc(n * sizeof *c->opacity);
    c->sh = malloc(coefficients(c) * n * sizeof *c->sh);
    if (c->mean && c->scale && c->quaternion && c->opacity && c->sh) return 1;
    free_cloud(c);
    return 0;
}

static tides_status add_cloud(tides_scene *scene, cloud *c, const tides_trajectory *path, const char *name,
                              tides_error *error) {
    tides_gaussians g = {.count = c->count, .sh_degree = c->degree, .mean = c->mean, .log_scale = c->scale, .sh = c->sh};
    g.quaternion = c->quaternion;
    g.opacity_logit = c->opacity;
    tides_status status = tides_scene_add(scene, &g, path, 1, name, NULL, error);
    free_cloud(c);
    return status;
}

static void paint(cloud *c, uint64_t *state) {
    const size_t each = coefficients(c);
    for (size_t i = 0; i < each * (size_t)c->count; i++) c->sh[i] = (float)((i % each < 3 ? 1 : 0.1) * normal(state));
}

/* Splats in a cube of edge 2 about the origin; its density doesn't depend on their number. */
static int32_t make_random(cloud *c, int64_t count) {
    uint64_t state = 1;
    if (!make_cloud(c, count, 3)) return 0;
    const double size = log(0.006) + log(1e5 / (double)count) / 3;
    for (int64_t i = 0; i < 3 * count; i++) c->mean[i] = (float)(2 * uniform(&state) - 1);
    for (int64_t i = 0; i < 3 * count; i++) c->scale[i] = (float)(size + 0.5 * normal(&state));
    for (int64_t i = 0; i < 4 * count; i++) c->quaternion[i] = (float)normal(&state);
    for (int64_t i = 0; i < count; i++) c->opacity[i] = (float)(2 * normal(&state));
    paint(c, &state);
    return 1;
}

tides_status bench_add_random(tides_scene *scene, int64_t count, tides_error *error) {
    cloud c;
    if (!make_random(&c, count)) return cli_error(error, TIDES_NO_MEMORY, "out of memory: %lld Gaussians", (long long)count);
    return add_cloud(scene, &c, NULL, "random", error);
}

static void copy_one(const cloud *from, int64_t i, cloud *to, int64_t k) {
    const size_t each = coefficients(from);
    memcpy(to->mean + 3 * k, from->mean + 3 * i, 3 * sizeof *to->mean);
    memcpy(to->scale + 3 * k, from->scale + 3 * i, 3 * sizeof *to->scale);
    memcpy(to->quaternion + 4 * k, from->quaternion + 4 * i, 4 * sizeof *to->quaternion);
    to->opacity[k] = from->opacity[i];
    memcpy(to->sh + each * (size_t)k, from->sh + each * (size_t)i, each * sizeof *to->sh);
}

tides_status bench_add_random_apart(tides_scene *scene, int64_t count, int64_t others, const double at[3], tides_error *error) {
    cloud here, there, all;
    const int64_t total = count + others;
    if (others == 0) return bench_add_random(scene, count, error);
    const int32_t first = make_random(&here, count), second = make_random(&there, others), third = make_cloud(&all, total, 3);
    for (int64_t i = 0; i < 3 * others && second; i++) there.mean[i] += (float)at[i % 3];
    for (int64_t i = 0; i < total && first && second && third; i++) {
        const int64_t before = i * count / total, next = (i + 1) * count / total;
        copy_one(next > before ? &here : &there, next > before ? before : i - before, &all, i);
    }
    if (first) free_cloud(&here);
    if (second) free_cloud(&there);
    if (third && !(first && second)) free_cloud(&all);
    if (!first || !second || !third)
        return cli_error(error, TIDES_NO_MEMORY, "out of memory: %lld Gaussians", (long long)total);
    return add_cloud(scene, &all, NULL, "random", error);
}

/* A quaternion that lays a splat flat on a sphere with the normal `n`: its third axis points outwards. */
static void lay_flat(const double n[3], float q[4]) {
    const double size = sqrt(2 * (1 + n[2])); /* |z + n|; 0: n is -z, half a turn about x */
    q[0] = (float)(size > 1e-6 ? 0.5 * size : 0);
    q[1] = (float)(size > 1e-6 ? -n[1] / size : 1);
    q[2] = (float)(size > 1e-6 ? n[0] / size : 0);
    q[3] = 0;
}

/* Spheres of radius 0.08 to 0.3, one behind the other, of flat splats that overlap, as in trained scenes: their median sigma is
 * their spacing, and their median opacity 0.5. */
tides_status bench_add_surfaces(tides_scene *scene, int64_t count, tides_error *error) {
    enum { SPHERES = 40 };
    double centre[SPHERES][3], radius[SPHERES], area[SPHERES + 1] = {0};
    uint64_t state = 2;
    cloud c;
    if (!make_cloud(&c, count, 2)) return cli_error(error, TIDES_NO_MEMORY, "out of memory: %lld Gaussians", (long long)count);
    for (int s = 0; s < SPHERES; s++) {
        radius[s] = 0.08 + 0.22 * uniform(&state);
        for (int k = 0; k < 3; k++) centre[s][k] = 1.6 * uniform(&state) - 0.8;
        area[s + 1] = area[s] + radius[s] * radius[s];
    }
    const double apart = sqrt(4 * 3.14159265358979 * area[SPHERES] / (double)count);
    for (int64_t i = 0; i < count; i++) {
        const double at = area[SPHERES] * ((double)i + 0.5) / (double)count;
        double n[3], size = 0;
        int s = 0;
        while (s + 1 < SPHERES && area[s + 1] < at) s++;
        for (int k = 0; k < 3; k++) n[k] = normal(&state), size += n[k] * n[k];
        for (int k = 0; k < 3; k++) n[k] /= sqrt(size), c.mean[3 * i + k] = (float)(centre[s][k] + radius[s] * n[k]);
        lay_flat(n, c.quaternion + 4 * i);
        for (int k = 0; k < 3; k++) c.scale[3 * i + k] = (float)(log((k < 2 ? 1.0 : 0.1) * apart) + 0.3 * normal(&state));
        c.opacity[i] = (float)normal(&state);
    }
    paint(&c, &state);
    return add_cloud(scene, &c, NULL, "surfaces", error);
}

/* -- patches -------------------------------------------------------------------------------------------------------------- */

/* Size of the plane z = 0 [scene units] in the view of the camera that faces the patches, and the camera's distance, for an
 * image of 4 by 3. */
#define VIEW_WIDTH 2.0
#define VIEW_HEIGHT 1.5
#define VIEW_DISTANCE 1.8
#define SWING_HZ 20.0

static tides_status swing_path(double stop, tides_trajectory **path, tides_error *error) {
    const bench_vibration swing = {.quaternion = {1, 0, 0, 0}, .along = {0.8, 0.6, 0}, .amplitude = {0.03}, .hz = {SWING_HZ}};
    return bench_vibrating_path(&swing, stop, path, error);
}

/* Fills in one patch's splats; the middle one is about (x, y). */
static void fill_patch(const bench_patch *p, double x, double y, int32_t columns, int32_t rows, cloud *c, uint64_t *state) {
    int64_t i = 0;
    for (int32_t layer = 0; layer < p->layers; layer++) {
        const double shift_x = uniform(state), shift_y = uniform(state);
        for (int32_t row = 0; row < rows; row++)
            for (int32_t column = 0; column < columns; column++, i++) {
                const double at[3] = {x + p->spacing * (column - 0.5 * columns + shift_x),
                                      y + p->spacing * (row - 0.5 * rows + shift_y), p->apart * layer};
                const float turn[4] = {1, 0, 0, 0};
                for (int k = 0; k < 3; k++) c->mean[3 * i + k] = (float)at[k];
                for (int k = 0; k < 3; k++) c->scale[3 * i + k] = (float)log((k < 2 ? 1 : 0.1) * p->width * p->spacing);
                memcpy(c->quaternion + 4 * i, turn, sizeof turn);
                c->opacity[i] = (float)log(p->opacity / (1 - p->opacity));
            }
    }
    paint(c, state);
}

tides_status bench_add_patches(tides_scene *scene, const bench_patch *p, tides_error *error) {
    const int32_t count = p->columns * p->rows;
    const double width = VIEW_WIDTH / p->columns, height = VIEW_HEIGHT / p->rows;
    const int32_t columns = (int32_t)ceil(width / p->spacing), rows = (int32_t)ceil(height / p->spacing);
    uint64_t state = 3;
    tides_trajectory *swing = NULL;
    tides_status status = swing_path(ORBIT_S, &swing, error);
    for (int32_t i = 0; i < count && status == TIDES_OK; i++) {
        cloud c;
        if (!make_cloud(&c, (int64_t)columns * rows * p->layers, 0)) {
            status = cli_error(error, TIDES_NO_MEMORY, "out of memory: patches");
            break;
        }
        const int32_t column = i % p->columns, row = i / p->columns;
        const double x = width * (column + 0.5) - 0.5 * VIEW_WIDTH, y = height * (row + 0.5) - 0.5 * VIEW_HEIGHT;
        fill_patch(p, x, y, columns, rows, &c, &state);
        const int32_t place = (7 * i) % count; /* spread over the view; counts in use have no factor 7 */
        status = add_cloud(scene, &c, place < p->swinging ? swing : NULL, "patch", error);
    }
    tides_trajectory_destroy(swing);
    return status;
}

tides_status bench_face_patches(bench_scene *s, tides_error *error) {
    static const double position[3] = {0, 0, -VIEW_DISTANCE}, straight[4] = {1, 0, 0, 0};
    return tides_trajectory_create_static(position, straight, &s->camera, error);
}

tides_status bench_pass_patches(bench_scene *s, tides_error *error) {
    const tides_dolly pass = {.from = {-0.4, 0, -VIEW_DISTANCE},
                              .to = {0.4, 0.1, -VIEW_DISTANCE},
                              .target = {0, 0, 0},
                              .up = {0, -1, 0},
                              .start = 0,
                              .stop = 0.5};
    return tides_trajectory_create_dolly(&pass, &s->camera, error);
}

/* -- cameras -------------------------------------------------------------------------------------------------------------- */

tides_status bench_orbit_all(bench_scene *s, double rad_per_s, tides_error *error) {
    double lower[3], upper[3], size = 0;
    tides_orbit orbit = {.up = {0, -1, 0}, .angular_speed = rad_per_s, .start = 0, .stop = ORBIT_S};
    tides_scene_bounds(s->scene, lower, upper);
    for (int k = 0; k < 3; k++) {
        orbit.target[k] = 0.5 * (lower[k] + upper[k]);
        size = fmax(size, upper[k] - lower[k]);
    }
    orbit.radius = 1.1 * size;
    return tides_trajectory_create_orbit(&orbit, &s->camera, error);
}

void bench_resize(bench_scene *s, int32_t width, int32_t height) {
    s->intrinsics = (tides_intrinsics){width, height, 1.2 * height, 1.2 * height, 0.5 * width, 0.5 * height, {0}};
}

/* -- the table ------------------------------------------------------------------------------------------------------------ */

typedef struct world {
    const char *name, *sentence;
    const char *file; /* below $TIDES_SHARED/data */
    tides_status (*add)(tides_scene *scene, int64_t count, tides_error *error);
    int64_t count, quick;
} world;

static const world worlds[] = {
    {"guitar", "a trained guitar, tiny splats", "playcanvas/guitar.compressed.ply", NULL, 0, 0},
    {"playbot", "a trained robot, few splats of SH 2", "playcanvas/playbot_lod5_inria_sh2.ply", NULL, 0, 0},
    {"random", "random splats of SH 3 that fill the view", NULL, bench_add_random, 100000, 2000},
    {"surfaces", "soft splats of SH 2 on surfaces, one behind the other", NULL, bench_add_surfaces, 500000, 2000},
    {"demo", "the demo: a textured fan before a room, handheld camera", NULL, NULL, 0, 0},
};
enum { WORLDS = sizeof worlds / sizeof worlds[0] };

const char *const *bench_world_names(void) {
    static const char *const names[WORLDS + 1] = {"guitar", "playbot", "random", "surfaces", "demo", NULL};
    return names;
}

/* The demo, and each name that isn't listed, goes to bench_scene_make: a scene of bench_scenes.c, or a splat file's path. */
tides_status bench_world_make(const char *name, int32_t quick, bench_scene *scene, tides_error *error) {
    const world *w = NULL;
    for (size_t i = 0; i < WORLDS; i++)
        if (strcmp(worlds[i].name, name) == 0) w = &worlds[i];
    if (!w || (!w->file && !w->add)) {
        tides_status status = bench_scene_make(w ? "fan" : name, quick, scene, error);
        if (status == TIDES_OK) scene->image.transfer = TIDES_TRANSFER_LINEAR;
        if (status == TIDES_OK && w) snprintf(scene->name, sizeof scene->name, "%s", w->name), scene->sentence = w->sentence;
        return status;
    }
    bench_scene made;
    char file[4200];
    const char *shared = getenv("TIDES_SHARED");
    bench_lay_out(&made, w->name, w->sentence);
    snprintf(file, sizeof file, "%s/data/%s", shared && *shared ? shared : "../shared", w->file ? w->file : "");
    made.stop = FRAMES_S;
    made.image.transfer = TIDES_TRANSFER_LINEAR; /* as in the renderers that TIDES is compared with */
    tides_status status = tides_scene_create(&made.scene, error);
    if (status == TIDES_OK)
        status = w->add ? w->add(made.scene, quick ? w->quick : w->count, error)
                        : tides_scene_add_file(made.scene, file, NULL, 1.0, error);
    if (status == TIDES_OK) status = bench_orbit_all(&made, 1.0, error);
    if (status == TIDES_OK)
        *scene = made;
    else
        bench_scene_free(&made);
    return status;
}

tides_status bench_make_demo(double duration_s, bench_scene *scene, tides_error *error) {
    tides_generate_options options;
    tides_world made;
    tides_generate_options_defaults(&options);
    if (duration_s > 0) options.duration_s = duration_s;
    options.width = 346;
    options.height = 260;
    tides_status status = tides_generate("fan", &options, &made, error);
    if (status != TIDES_OK) return status;
    bench_lay_out(scene, "demo", "the demo: a textured fan before a room, handheld camera");
    scene->scene = made.scene;
    scene->camera = made.camera;
    scene->intrinsics = made.intrinsics;
    scene->stop = made.duration_s;
    for (int k = 0; k < 3; k++) scene->image.background[k] = made.background[k];
    return TIDES_OK;
}
