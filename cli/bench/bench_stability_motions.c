/* Rows of `tides bench stability` about Gaussians that move by themselves: keyframes whose quaternions change sign or that are
 * a microsecond apart, and networks with huge weights. */
#include "bench_stability.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = 60, KEYS = 6, CLOSE = 3, SEED = 16180 };

/* Adds the pile with its motion, and frees both where that fails. */
static tides_status put_moving(stability_pile *pile, tides_motion *motion, stability_world *w, tides_error *error) {
    const tides_gaussians g = stability_gaussians(pile);
    const tides_status status = tides_scene_add_moving(w->scene.scene, &g, motion, 0, NULL, 1, NULL, NULL, error);
    if (status != TIDES_OK) tides_motion_destroy(motion);
    stability_free(pile);
    return status;
}

/* -- keyframes ----------------------------------------------------------------------------------------------------------- */

typedef struct keys {
    double time[KEYS], mean[KEYS * COUNT * 3];
    float quaternion[KEYS * COUNT * 4];
} keys;

/* Keys with drifting means, and quaternions that turn a little and change sign from key to key where `flip`. Key CLOSE is only
 * `close` later than the one before it, like a frame that a capture wrote twice. */
static void set_keys(keys *k, const stability_pile *pile, int32_t flip, double close) {
    uint64_t state = SEED;
    for (size_t f = 0; f < KEYS; f++) {
        const double drift = f == 0 ? 0 : close > 0 && f == CLOSE ? close : 0.1;
        const size_t from = f == CLOSE && close > 0 ? f - 1 : 0;
        for (size_t i = 0; i < 3 * COUNT; i++)
            k->mean[3 * COUNT * f + i] =
                (from ? k->mean[3 * COUNT * from + i] : pile->mean[i]) + stability_between(&state, -drift, drift);
        for (size_t i = 0; i < 4 * COUNT; i++) {
            const double turned =
                (from ? k->quaternion[4 * COUNT * from + i] : pile->quaternion[i]) + stability_between(&state, -drift, drift);
            k->quaternion[4 * COUNT * f + i] = (float)(flip && f % 2 ? -turned : turned);
        }
    }
}

static tides_status keyframes(const stability_case *c, stability_world *w, tides_error *error) {
    stability_pile pile = {.count = 0};
    keys *k = malloc(sizeof *k);
    tides_motion *motion = NULL;
    stability_backdrop(&pile, COUNT);
    tides_status status = k && !pile.failed ? TIDES_OK : cli_error(error, TIDES_NO_MEMORY, "out of memory: keyframes");
    if (status == TIDES_OK) {
        set_keys(k, &pile, c->kind == MOTION_FLIPS, c->kind == MOTION_CLOSE_KEYS ? c->size : 0);
        for (int f = 0; f < KEYS; f++) k->time[f] = w->scene.stop * f / (KEYS - 1);
        if (c->kind == MOTION_CLOSE_KEYS) k->time[CLOSE] = k->time[CLOSE - 1] + c->size;
        const tides_keyframes_motion arrays = {.frames = KEYS,
                                               .count = COUNT,
                                               .time = k->time,
                                               .mean_double = k->mean,
                                               .quaternion = k->quaternion};
        status = tides_motion_create_keyframes(&arrays, &motion, error);
    }
    free(k);
    if (status == TIDES_OK) return put_moving(&pile, motion, w, error);
    stability_free(&pile);
    return status;
}

/* -- networks ------------------------------------------------------------------------------------------------------------ */

/* SpacetimeGaussians' full model: a network of two layers, with weights up to `size`, makes each pixel's colour. */
static tides_status decoder(double size, stability_world *w, tides_error *error) {
    static const float zero[9 * COUNT];
    float feature[6 * COUNT], rate[3 * COUNT], wide[COUNT], first[72], second[18];
    stability_pile pile = {.count = 0};
    tides_motion *motion = NULL;
    uint64_t state = SEED;
    for (int i = 0; i < 6 * COUNT; i++) feature[i] = (float)stability_between(&state, -1, 1);
    for (int i = 0; i < 3 * COUNT; i++) rate[i] = (float)stability_between(&state, -1, 1);
    for (int i = 0; i < COUNT; i++) wide[i] = 3;
    for (int i = 0; i < 72; i++) first[i] = (float)stability_between(&state, -size, size);
    for (int i = 0; i < 18; i++) second[i] = (float)stability_between(&state, -size, size);
    const tides_polynomial_motion arrays = {.count = COUNT,
                                            .stop = w->scene.stop,
                                            .opacity_centre = zero,
                                            .opacity_log_width = wide,
                                            .mean_coefficient = zero,
                                            .quaternion_dot = zero,
                                            .decoder = TIDES_DECODER_SIGMOID,
                                            .feature = feature,
                                            .feature_dot = rate,
                                            .decoder_first = first,
                                            .decoder_second = second};
    const tides_status status = tides_motion_create_polynomial(&arrays, &motion, error);
    if (status != TIDES_OK) return status;
    stability_backdrop(&pile, COUNT);
    return put_moving(&pile, motion, w, error);
}

/* A deformation network of time: a hidden layer with ReLU, a second one that sums it, and x / (1 + |x|). Weights are within
 * +-size, and kinks of the ReLUs spread over a second around the run. So the motion has kinks, and turns within
 * microseconds. */
enum { HIDDEN = 16 };
typedef struct network {
    double in[HIDDEN], knee[HIDDEN], out[3][HIDDEN];
} network;

static network network_of(double size) {
    network n;
    uint64_t state = SEED;
    for (int j = 0; j < HIDDEN; j++) {
        n.in[j] = stability_between(&state, -size, size);
        n.knee[j] = stability_between(&state, -0.02, 0.04);
        for (int k = 0; k < 3; k++) n.out[k][j] = stability_between(&state, -size, size);
    }
    return n;
}

static tides_status bend(void *user, double time, int32_t side, const int32_t *index, int64_t count, const tides_theta *theta,
                         tides_error *error) {
    const network *n = user;
    (void)error;
    for (int64_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            double x = 0.1 * index[i], rate = 0; /* Gaussians differ by a bias */
            for (int j = 0; j < HIDDEN; j++) {
                const double since = time - n->knee[j], hidden = n->in[j] * since;
                if (hidden > 0 || (hidden == 0 && side * n->in[j] > 0)) {
                    x += n->out[k][j] * hidden;
                    rate += n->out[k][j] * n->in[j];
                }
            }
            const double under = 1 + fabs(x);
            theta->mean[3 * i + k] += 0.3 * x / under;
            theta->mean_dot[3 * i + k] = 0.3 * rate / (under * under);
        }
    return TIDES_OK;
}

static tides_status deformation(double size, stability_world *w, tides_error *error) {
    static network thousand; /* used by the motion until the process ends */
    stability_pile pile = {.count = 0};
    tides_motion *motion = NULL;
    thousand = network_of(size);
    const tides_callback_motion callback = {.count = COUNT,
                                            .stop = w->scene.stop,
                                            .function = bend,
                                            .user = &thousand,
                                            .time_scale = 10 / (size * size)};
    const tides_status status = tides_motion_create_callback(&callback, &motion, error);
    if (status != TIDES_OK) return status;
    stability_backdrop(&pile, COUNT);
    return put_moving(&pile, motion, w, error);
}

tides_status stability_motions(const stability_case *c, stability_world *w, tides_error *error) {
    if (c->kind == MOTION_DECODER) return decoder(c->size, w, error);
    if (c->kind == MOTION_NETWORK) return deformation(c->size, w, error);
    return keyframes(c, w, error);
}
