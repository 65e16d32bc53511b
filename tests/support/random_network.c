/* Makes random deformation networks. Aborts if memory runs out. */
#include "tests/support/random_network.h"
#include "tests/support/scene_make.h"

#include "motion/td_hexplane.h"

#include <stdlib.h>
#include <string.h>

static void expect(tides_status status, const tides_error *error) {
    if (status == TIDES_OK) return;
    fprintf(stderr, "random_network: %s\n", error->text);
    abort();
}

random_gaussians random_gaussians_make(uint64_t seed, int count, int sh_degree, double spread) {
    size_t n = (size_t)count, sh = 3 * (size_t)(sh_degree + 1) * (size_t)(sh_degree + 1);
    random_gaussians made;
    made.values = malloc(n * (11 + sh) * sizeof(float));
    if (!made.values) abort();
    float *mean = made.values, *scale = mean + 3 * n, *rotation = scale + 3 * n, *opacity = rotation + 4 * n,
          *colour = opacity + n;
    for (size_t i = 0; i < 3 * n; i++) mean[i] = (float)(spread * scene_between(&seed, -1, 1));
    for (size_t i = 0; i < 3 * n; i++) scale[i] = (float)(-4 + scene_between(&seed, -1, 1));
    for (size_t i = 0; i < 4 * n; i++) rotation[i] = (float)((i % 4 == 0 ? 1.5 : 0) + scene_between(&seed, -1, 1));
    for (size_t i = 0; i < n; i++) opacity[i] = (float)(3 * scene_between(&seed, -1, 1));
    for (size_t i = 0; i < sh * n; i++) colour[i] = (float)(0.5 * scene_between(&seed, -1, 1));
    made.view = (tides_gaussians){.count = count, .sh_degree = sh_degree, .mean = mean, .log_scale = scale};
    made.view.quaternion = rotation;
    made.view.opacity_logit = opacity;
    made.view.sh = colour;
    return made;
}

void random_gaussians_free(random_gaussians *gaussians) {
    free(gaussians->values);
    memset(gaussians, 0, sizeof *gaussians);
}

void random_field(tides_motion *motion, uint64_t *state, const char *name, int rank, const uint64_t *shape, double strength,
                  double offset) {
    tides_error error = {0};
    size_t count = 1;
    for (int i = 0; i < rank; i++) count *= shape[i];
    float *value = malloc(count * sizeof *value);
    if (!value) abort();
    for (size_t i = 0; i < count; i++) value[i] = (float)(strength * scene_between(state, -1, 1) + offset);
    expect(td_motion_take_field(motion, name, rank, shape, value, &error), &error);
}

/* A layer whose outputs are of the order of its inputs times `gain`. */
static void random_layer(tides_motion *motion, uint64_t *state, const char *name, int rows, int columns, double gain) {
    const uint64_t shape[2] = {(uint64_t)rows, (uint64_t)columns};
    char key[64];
    snprintf(key, sizeof key, "%s.weight", name);
    random_field(motion, state, key, 2, shape, gain * sqrt(6.0 / columns), 0);
    snprintf(key, sizeof key, "%s.bias", name);
    random_field(motion, state, key, 1, shape, gain * 0.3, 0);
}

random_hexplane_recipe random_hexplane_defaults(uint64_t seed) {
    return (random_hexplane_recipe){seed, 32, {64, 64, 64, 75}, 2, 64, 1, TD_HEAD_MEAN | TD_HEAD_SCALE | TD_HEAD_ROTATION,
                                    0,    0.2};
}

static void make_grid(tides_motion *motion, uint64_t *state, const random_hexplane_recipe *recipe) {
    static const int axes[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    for (int level = 0; level < recipe->levels; level++)
        for (int plane = 0; plane < 6; plane++) {
            int i = axes[plane][0], j = axes[plane][1], time = j == 3;
            const uint64_t shape[4] = {1, (uint64_t)recipe->channels,
                                       (uint64_t)recipe->size[j] * (time ? 1u : (unsigned)level + 1),
                                       (uint64_t)recipe->size[i] * ((unsigned)level + 1)};
            char name[32];
            snprintf(name, sizeof name, "grid.grids.%d.%d", level, plane);
            random_field(motion, state, name, 4, shape, time ? 0.3 : 0.5, time ? 1 : 0.7);
        }
}

static void make_heads(tides_motion *motion, uint64_t *state, const random_hexplane_recipe *recipe) {
    static const char *const flags[TD_HEADS] = {"no_dx", "no_ds", "no_dr", "no_do", "no_dshs"};
    static const int outputs[TD_HEADS] = {3, 3, 4, 1, 48};
    tides_error error = {0};
    for (int head = 0; head < TD_HEADS; head++) {
        char name[48];
        int on = recipe->heads >> head & 1;
        expect(td_motion_set(motion, flags[head], !on, &error), &error);
        if (!on) continue;
        snprintf(name, sizeof name, "%s.1", td_hexplane_heads[head]);
        random_layer(motion, state, name, recipe->width, recipe->width, 1);
        snprintf(name, sizeof name, "%s.3", td_hexplane_heads[head]);
        random_layer(motion, state, name, outputs[head], recipe->width, recipe->strength);
    }
    expect(td_motion_set(motion, "apply_rotation", recipe->turns, &error), &error);
}

tides_motion *random_hexplane_make(const random_hexplane_recipe *recipe) {
    static const uint64_t box_shape[2] = {2, 3};
    tides_motion *motion = NULL;
    tides_error error = {0};
    uint64_t state = recipe->seed;
    expect(td_motion_create(td_motion_class_find("hexplane"), 0, 1, &motion, &error), &error);
    float *box = malloc(6 * sizeof *box);
    if (!box) abort();
    for (int i = 0; i < 6; i++) box[i] = i < 3 ? 1.6f : -1.6f;
    expect(td_motion_take_field(motion, "grid.aabb", 2, box_shape, box, &error), &error);
    make_grid(motion, &state, recipe);
    random_layer(motion, &state, "feature_out.0", recipe->width, recipe->levels * recipe->channels, 1);
    for (int layer = 1; layer < recipe->layers; layer++) {
        char name[32];
        snprintf(name, sizeof name, "feature_out.%d", 2 * layer);
        random_layer(motion, &state, name, recipe->width, recipe->width, 1);
    }
    make_heads(motion, &state, recipe);
    return motion;
}

/* -- Deformable-3DGS ------------------------------------------------------------------------------------------------ */

random_network_recipe random_network_defaults(uint64_t seed) {
    return (random_network_recipe){seed, 256, 8, 5, 10, 0, 0, 0, 0.2};
}

tides_motion *random_network_make(const random_network_recipe *recipe) {
    tides_motion *motion = NULL;
    tides_error error = {0};
    uint64_t state = recipe->seed;
    int embedded = 1 + 2 * recipe->octaves, inputs = 63 + (recipe->time_width ? recipe->times : embedded);
    expect(td_motion_create(td_motion_class_find("network"), 0, 1, &motion, &error), &error);
    if (recipe->time_width) {
        random_layer(motion, &state, "timenet.0", recipe->time_width, embedded, 1);
        random_layer(motion, &state, "timenet.2", recipe->times, recipe->time_width, 1);
    }
    for (int layer = 0; layer < recipe->layers; layer++) {
        char name[32];
        int columns = (layer == 0 || layer == recipe->skip ? inputs : 0) + (layer > 0 ? recipe->width : 0);
        snprintf(name, sizeof name, "linear.%d", layer);
        random_layer(motion, &state, name, recipe->width, columns, 1);
    }
    random_layer(motion, &state, recipe->screw ? "branch_w" : "gaussian_warp", 3, recipe->width, recipe->strength);
    if (recipe->screw) random_layer(motion, &state, "branch_v", 3, recipe->width, recipe->strength);
    random_layer(motion, &state, "gaussian_rotation", 4, recipe->width, recipe->strength);
    random_layer(motion, &state, "gaussian_scaling", 3, recipe->width, 0.05 * recipe->strength);
    return motion;
}
