/* Parts of the rows of `tides bench stability`: single splats, a camera's path, and the ordinary world with which run times are
 * compared. Nothing here calls libm, so that scenes are equal on all machines. */
#include "bench_stability.h"

#include <stdlib.h>
#include <string.h>

#define TOLERANCE 0.01 /* of the cubic's steps */

enum { WIDTH = 64, HEIGHT = 48, FOCAL = 60, BACKDROP_SEED = 31415 };
#define DURATION_S 0.02

/* -- numbers ------------------------------------------------------------------------------------------------------------- */

double stability_random(uint64_t *state) { /* splitmix64: Steele, Lea and Flood 2014 */
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 32) * 0x1p-32;
}

double stability_between(uint64_t *state, double low, double high) { return low + (high - low) * stability_random(state); }

/* -- splats -------------------------------------------------------------------------------------------------------------- */

static int32_t grow(stability_pile *p) {
    const size_t n = p->capacity ? 2 * p->capacity : 256;
    double *mean = realloc(p->mean, 3 * n * sizeof *mean);
    if (mean) p->mean = mean;
    float *const old[] = {p->log_scale, p->quaternion, p->logit, p->sh}, *grown[4];
    static const size_t widths[] = {3, 4, 1, 3};
    int32_t ok = mean != NULL;
    for (size_t i = 0; i < 4; i++) {
        grown[i] = realloc(old[i], widths[i] * n * sizeof **grown);
        if (!grown[i]) {
            grown[i] = old[i];
            ok = 0;
        }
    }
    p->log_scale = grown[0];
    p->quaternion = grown[1];
    p->logit = grown[2];
    p->sh = grown[3];
    if (ok) p->capacity = n;
    return ok;
}

void stability_add(stability_pile *p, const stability_splat *s) {
    if (p->failed || (p->count == p->capacity && !grow(p))) {
        p->failed = 1;
        return;
    }
    const size_t i = p->count++;
    for (size_t k = 0; k < 3; k++) {
        p->mean[3 * i + k] = s->mean[k];
        p->log_scale[3 * i + k] = (float)(STABILITY_LN10 * s->decades[k]);
        p->sh[3 * i + k] = (float)s->sh;
    }
    for (size_t k = 0; k < 4; k++) p->quaternion[4 * i + k] = (float)s->quaternion[k];
    p->logit[i] = (float)s->logit;
}

tides_gaussians stability_gaussians(const stability_pile *p) {
    return (tides_gaussians){.count = (int64_t)p->count,
                             .log_scale = p->log_scale,
                             .quaternion = p->quaternion,
                             .opacity_logit = p->logit,
                             .sh = p->sh,
                             .mean_double = p->mean};
}

void stability_free(stability_pile *p) {
    free(p->mean);
    free(p->log_scale);
    free(p->quaternion);
    free(p->logit);
    free(p->sh);
    memset(p, 0, sizeof *p);
}

tides_status stability_put(stability_pile *p, stability_world *w, const tides_trajectory *path, tides_error *error) {
    const tides_gaussians g = stability_gaussians(p);
    tides_status status = p->failed ? cli_error(error, TIDES_NO_MEMORY, "out of memory: %zu splats", p->count)
                                    : tides_scene_add(w->scene.scene, &g, path, 1, NULL, NULL, error);
    stability_free(p);
    return status;
}

stability_splat stability_ordinary(uint64_t *state) {
    stability_splat s = {.logit = stability_between(state, -1, 3), .sh = stability_between(state, -1.5, 1.5)};
    const double z = stability_between(state, 4, 6);
    s.mean[0] = z * stability_between(state, -0.6, 0.6); /* tangents of half the view: 0.53 and 0.4 */
    s.mean[1] = z * stability_between(state, -0.45, 0.45);
    s.mean[2] = z;
    for (size_t k = 0; k < 3; k++) s.decades[k] = stability_between(state, -1.2, -0.5);
    for (size_t k = 0; k < 4; k++) s.quaternion[k] = stability_between(state, -1, 1);
    return s;
}

void stability_backdrop(stability_pile *p, size_t count) {
    uint64_t state = BACKDROP_SEED;
    for (size_t i = 0; i < count; i++) {
        const stability_splat s = stability_ordinary(&state);
        stability_add(p, &s);
    }
}

void stability_wall(stability_pile *p, const stability_world *w, int32_t across, int32_t down, double z, double wide) {
    const tides_intrinsics *camera = &w->scene.intrinsics;
    const double view[2] = {1.2 * z * camera->width / camera->fx, 1.2 * z * camera->height / camera->fy};
    const double pitch[2] = {view[0] / across, view[1] / down};
    const double scale = wide * (pitch[0] < pitch[1] ? pitch[0] : pitch[1]);
    uint64_t state = BACKDROP_SEED;
    double decades = -6, power = 1e-6; /* finds the largest tenth of a decade up to `scale`, without log10 */
    for (; power * 1.2589254117941673 <= scale; power *= 1.2589254117941673) decades += 0.1;
    for (int32_t i = 0; i < across * down; i++) {
        const int32_t column = i % across, row = i / across;
        const stability_splat s = {.mean = {pitch[0] * (column + 0.5) - 0.5 * view[0], pitch[1] * (row + 0.5) - 0.5 * view[1],
                                            z},
                                   .decades = {decades, decades, decades},
                                   .quaternion = {1, 0, 0, 0},
                                   .logit = 2,
                                   .sh = stability_between(&state, -1.5, 1.5)};
        stability_add(p, &s);
    }
}

/* -- paths --------------------------------------------------------------------------------------------------------------- */

tides_status stability_path(const stability_world *w, const stability_slide *slide, tides_trajectory **path,
                            tides_error *error) {
    enum { SAMPLES = 5 };
    tides_pose_sample samples[SAMPLES];
    const double span = w->scene.stop - w->scene.start;
    memset(samples, 0, sizeof samples);
    for (int i = 0; i < SAMPLES; i++) {
        samples[i].time = w->scene.start + 0.5 * (i - 1) * span; /* half a run before the start, and one after */
        const double t = samples[i].time - w->scene.start;
        for (size_t k = 0; k < 3; k++) samples[i].position[k] = slide->from[k] + slide->velocity[k] * t;
        samples[i].quaternion[0] = 1;
        samples[i].quaternion[2] = slide->turn * t;
    }
    return tides_trajectory_create(samples, SAMPLES, path, error);
}

/* -- worlds -------------------------------------------------------------------------------------------------------------- */

static tides_status lay_out(stability_world *w, tides_error *error) {
    memset(w, 0, sizeof *w);
    bench_scene *s = &w->scene;
    s->intrinsics = (tides_intrinsics){WIDTH, HEIGHT, FOCAL, FOCAL, 0.5 * WIDTH, 0.5 * HEIGHT, {0}};
    s->stop = DURATION_S;
    tides_image_params_defaults(&s->image);
    s->image.log_eps = 0.01;
    tides_sensor_defaults(&s->sensor);
    tides_readout_defaults(&s->readout);
    tides_filters_defaults(&s->filters);
    tides_stepping_defaults(&w->stepping);
    w->stepping.tolerance = TOLERANCE;
    bench_choose_parts(&w->stepping, 0);
    return tides_scene_create(&s->scene, error);
}

static tides_status slide_camera(stability_world *w, tides_error *error) {
    static const stability_slide aside = {.velocity = {STABILITY_SPEED, 1, 0}, .turn = 0.5};
    return w->scene.camera ? TIDES_OK : stability_path(w, &aside, &w->scene.camera, error);
}

tides_status stability_make(const stability_case *c, stability_world *w, tides_error *error) {
    tides_status status = lay_out(w, error);
    snprintf(w->scene.name, sizeof w->scene.name, "%s", c->name);
    if (status == TIDES_OK) status = c->make(c, w, error);
    if (status == TIDES_OK) status = slide_camera(w, error);
    if (c->parts) bench_choose_parts(&w->stepping, c->parts);
    if (status != TIDES_OK) bench_scene_free(&w->scene);
    return status;
}

/* The square root of a count, rounded up. */
static int32_t side_of(int64_t count) {
    int32_t side = 1;
    while ((int64_t)side * side < count) side++;
    return side;
}

tides_status stability_make_benign(const stability_world *like, stability_world *w, tides_error *error) {
    stability_pile pile = {.count = 0};
    tides_status status = lay_out(w, error);
    if (status != TIDES_OK) return status;
    const int32_t side = side_of(tides_scene_count(like->scene.scene));
    snprintf(w->scene.name, sizeof w->scene.name, "benign");
    w->scene.intrinsics = like->scene.intrinsics;
    w->scene.stop = like->scene.stop - like->scene.start;
    w->stepping.step_s = like->stepping.step_s;
    stability_wall(&pile, w, side, side, 5, 1);
    status = stability_put(&pile, w, NULL, error);
    if (status == TIDES_OK) status = slide_camera(w, error);
    if (status != TIDES_OK) bench_scene_free(&w->scene);
    return status;
}
