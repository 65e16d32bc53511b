/* Rows of `tides bench stability` about places and times: far coordinates, late starts, fast, shaking and jumping cameras. */
#include "bench_stability.h"

#include <stdlib.h>
#include <string.h>

enum { BACKDROP = 100 };

/* The backdrop with means `offset` away, and the camera there too. Offsets are whole numbers up to 1e7, to which doubles add
 * the means' binary digits exactly. */
static tides_status far_means(stability_world *w, double offset, tides_error *error) {
    stability_pile pile = {.count = 0};
    const double place[3] = {offset, -offset, offset};
    const stability_slide slide = {.from = {place[0], place[1], place[2]}, .velocity = {STABILITY_SPEED, 1, 0}, .turn = 0.5};
    stability_backdrop(&pile, BACKDROP);
    for (size_t i = 0; i < 3 * pile.count; i++) pile.mean[i] += place[i % 3];
    tides_status status = stability_put(&pile, w, NULL, error);
    return status == TIDES_OK ? stability_path(w, &slide, &w->scene.camera, error) : status;
}

/* The backdrop, moved by its object's path to `offset`, and the camera there too. */
static tides_status far_object(stability_world *w, double offset, tides_error *error) {
    static const double not_turned[4] = {1, 0, 0, 0};
    stability_pile pile = {.count = 0};
    const double place[3] = {offset, -offset, offset};
    const stability_slide slide = {.from = {place[0], place[1], place[2]}, .velocity = {STABILITY_SPEED, 1, 0}, .turn = 0.5};
    tides_trajectory *path = NULL;
    tides_status status = tides_trajectory_create_static(place, not_turned, &path, error);
    if (status == TIDES_OK) {
        stability_backdrop(&pile, BACKDROP);
        status = stability_put(&pile, w, path, error);
    }
    tides_trajectory_destroy(path);
    return status == TIDES_OK ? stability_path(w, &slide, &w->scene.camera, error) : status;
}

static tides_status put_backdrop(stability_world *w, tides_error *error) {
    stability_pile pile = {.count = 0};
    stability_backdrop(&pile, BACKDROP);
    return stability_put(&pile, w, NULL, error);
}

/* A run of two hundred microseconds in steps of one, with a camera so fast that there are events. */
static tides_status late_start(stability_world *w, double start, tides_error *error) {
    static const stability_slide fast = {.velocity = {100 * STABILITY_SPEED, 100, 0}, .turn = 50};
    w->scene.start = start;
    w->scene.stop = start + 2e-4;
    w->stepping.step_s = 1e-6;
    w->stepping.min_step_s = 1e-8;
    const tides_status status = put_backdrop(w, error);
    return status == TIDES_OK ? stability_path(w, &fast, &w->scene.camera, error) : status;
}

/* The camera's speed in pixels per second at the middle of the backdrop, for a crossing of the view or the whole run. */
static tides_status speed(stability_world *w, double pixels_per_s, tides_error *error) {
    const double depth = 5, across = pixels_per_s * depth / w->scene.intrinsics.fx;
    const stability_slide slide = {.from = {-2, 0, 0}, .velocity = {across, 0, 0}};
    const double crossing = 4 / across; /* from 2 scene units left of the middle to 2 right of it */
    if (crossing < w->scene.stop) w->scene.stop = crossing;
    const tides_status status = put_backdrop(w, error);
    return status == TIDES_OK ? stability_path(w, &slide, &w->scene.camera, error) : status;
}

/* A camera that swings along x and y by `amplitude` at `hz`, with eight samples per period. */
static tides_status shake(stability_world *w, double hz, double amplitude, tides_error *error) {
    static const double sine[8] = {0, 0.70710678118654752,  1,  0.70710678118654752,
                                   0, -0.70710678118654752, -1, -0.70710678118654752};
    w->scene.stop = 0.005;
    const size_t count = (size_t)(8 * hz * w->scene.stop) + 2;
    tides_pose_sample *samples = calloc(count, sizeof *samples);
    if (!samples) return cli_error(error, TIDES_NO_MEMORY, "out of memory: a path of %zu samples", count);
    for (size_t i = 0; i < count; i++) {
        samples[i].time = (double)i / (8 * hz);
        samples[i].position[0] = amplitude * sine[i % 8];
        samples[i].position[1] = 0.5 * amplitude * sine[(i + 2) % 8];
        samples[i].quaternion[0] = 1;
    }
    const tides_status status = tides_trajectory_create(samples, count, &w->scene.camera, error);
    free(samples);
    return status;
}

/* A steady path with a leap in the middle, which takes `within` seconds. With `far` 0 there is no leap, only two samples that
 * near each other. */
static tides_status leap(stability_world *w, double within, double far, tides_error *error) {
    enum { SAMPLES = 6 };
    static const double shares[SAMPLES] = {0, 0.25, 0.5, 0.5, 0.75, 1};
    tides_pose_sample samples[SAMPLES];
    memset(samples, 0, sizeof samples);
    for (int i = 0; i < SAMPLES; i++) {
        samples[i].time = shares[i] * w->scene.stop + (i == 3 ? within : 0);
        samples[i].position[0] = STABILITY_SPEED * samples[i].time + (i > 2 ? far : 0);
        samples[i].quaternion[0] = 1;
        samples[i].quaternion[2] = i > 2 ? 0.25 * far : 0;
    }
    return tides_trajectory_create(samples, SAMPLES, &w->scene.camera, error);
}

tides_status stability_places(const stability_case *c, stability_world *w, tides_error *error) {
    switch (c->kind) {
        case PLACE_MEANS: return far_means(w, c->size, error);
        case PLACE_OBJECT: return far_object(w, c->size, error);
        case PLACE_EPOCH: return late_start(w, c->size, error);
        case PLACE_SPEED: return speed(w, c->size, error);
        default: break;
    }
    const tides_status status = put_backdrop(w, error);
    if (status != TIDES_OK) return status;
    if (c->kind == PLACE_VIBRATION) return shake(w, c->size, 0.1, error); /* 1.2 px */
    return leap(w, c->size, c->kind == PLACE_JUMP ? 0.5 : 0, error);
}
