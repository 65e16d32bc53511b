/* Files of golden/render: inputs activated, modes translated, per-Gaussian results gathered. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "motion/td_activate.h"
#include "render/td_renderer.h"
#include "render/td_transfer.h"

#include "tests/support/golden_render.h"
#include "tests/support/scene_folder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* The rules and antialiasing that make each mode of the files. */
typedef struct golden_mode {
    const char *name;
    int rules, antialias;
} golden_mode;
static const golden_mode modes[] = {
    {"ideal", TIDES_RULES_INRIA, 0},         {"inria", TIDES_RULES_INRIA, 0},         {"inria_aa", TIDES_RULES_INRIA, 1},
    {"gsplat153", TIDES_RULES_GSPLAT, 0},    {"gsplat153_aa", TIDES_RULES_GSPLAT, 1}, {"gsplat160", TIDES_RULES_GSPLAT, 0},
    {"gsplat160_aa", TIDES_RULES_GSPLAT, 1},
};

static const golden_mode *find_mode(const char *name) {
    for (size_t i = 0; i < sizeof modes / sizeof *modes; i++)
        if (strcmp(modes[i].name, name) == 0) return &modes[i];
    fail_msg("mode \"%s\" is not known", name);
    return NULL;
}

static const void *data_of(const golden_file *file, const char *name, const char *type) {
    const npz_array *array = npz_get(file->npz, name);
    if (array && strcmp(array->dtype, type) == 0) return array->data;
    fail_msg("array %s of type %s is missing", name, type);
    abort(); /* not reached: a failure leaves the test */
}
const double *golden_reals(const golden_file *file, const char *name) { return data_of(file, name, "<f8"); }
const int32_t *golden_ints(const golden_file *file, const char *name) { return data_of(file, name, "<i4"); }
const uint8_t *golden_bytes(const golden_file *file, const char *name) { return data_of(file, name, "|u1"); }

golden_file golden_open(const char *path) {
    golden_file file = {0};
    file.npz = npz_open(path);
    assert_non_null(file.npz);
    const npz_array *means = npz_get(file.npz, "means");
    assert_non_null(means);
    file.times = (int)means->shape[0];
    file.gaussians = (int)means->shape[1];
    file.width = (int)npz_int(file.npz, "width");
    file.height = (int)npz_int(file.npz, "height");
    file.sh_degree = (int)npz_int(file.npz, "sh_degree");
    npz_string(file.npz, "mode", file.mode, sizeof file.mode);
    file.whole_pixel_centres = find_mode(file.mode)->rules == TIDES_RULES_INRIA;
    file.has_tiles = strcmp(file.mode, "ideal") != 0;
    return file;
}

void golden_close(golden_file *file) {
    npz_close(file->npz);
    file->npz = NULL;
}

/* Row `i` of an input array and of its rates, `reals` numbers to a row. */
typedef struct input_row {
    const double *value, *rate;
} input_row;
static input_row row_of(const golden_file *file, const char *name, size_t i, size_t reals) {
    char rate[64];
    snprintf(rate, sizeof rate, "%s_dot", name);
    input_row row = {golden_reals(file, name) + i * reals, golden_reals(file, rate) + i * reals};
    return row;
}

static void activate(const golden_file *file, size_t from, td_store *store, size_t at) {
    size_t own = 3 * (size_t)(file->sh_degree + 1) * (size_t)(file->sh_degree + 1);
    input_row mean = row_of(file, "means", from, 3), scale = row_of(file, "log_scales", from, 3);
    input_row quaternion = row_of(file, "quats_raw", from, 4), logit = row_of(file, "opacity_logit", from, 1);
    input_row sh = row_of(file, "sh", from, own);
    td_activate(mean.value, scale.value, quaternion.value, *logit.value, store->geometry + at * TD_GEOMETRY_STRIDE);
    td_activate_rates(mean.rate, scale.value, scale.rate, quaternion.value, quaternion.rate, *logit.value, *logit.rate,
                      store->rates + at * TD_GEOMETRY_STRIDE);
    memcpy(store->sh_wide + at * (size_t)store->sh_stride, sh.value, own * sizeof *sh.value);
    memcpy(store->sh_rates + at * (size_t)store->sh_stride, sh.rate, own * sizeof *sh.rate);
}

td_store golden_store(const golden_file *file, int time, int sh_degree) {
    td_store store = {0};
    assert_true(sh_degree >= file->sh_degree);
    store.count = (file->gaussians + TD_PAD - 1) / TD_PAD * TD_PAD;
    store.real_count = file->gaussians;
    store.objects = 1;
    store.sh_stride = 3 * (sh_degree + 1) * (sh_degree + 1);
    size_t count = (size_t)store.count;
    store.object = calloc(count, sizeof *store.object);
    store.scene_object = calloc(1, sizeof *store.scene_object);
    store.geometry = calloc(count * TD_GEOMETRY_STRIDE, sizeof *store.geometry);
    store.rates = calloc(count * TD_GEOMETRY_STRIDE, sizeof *store.rates);
    store.sh_wide = calloc(count * (size_t)store.sh_stride, sizeof *store.sh_wide);
    store.sh_rates = calloc(count * (size_t)store.sh_stride, sizeof *store.sh_rates);
    assert_true(store.object && store.scene_object && store.geometry && store.rates && store.sh_wide && store.sh_rates);
    for (int i = 0; i < file->gaussians; i++)
        activate(file, (size_t)time * (size_t)file->gaussians + (size_t)i, &store, (size_t)i);
    return store;
}

void golden_view(const golden_file *file, int time, double view_reals[TD_VIEW_REALS]) {
    input_row matrix = row_of(file, "viewmat", (size_t)time, 16), eye = row_of(file, "campos", (size_t)time, 3);
    td_view view;
    memset(&view, 0, sizeof view);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            view.r[3 * i + j] = matrix.value[4 * i + j];
            view.r_dot[3 * i + j] = matrix.rate[4 * i + j];
        }
        view.t[i] = matrix.value[4 * i + 3];
        view.t_dot[i] = matrix.rate[4 * i + 3];
        view.eye[i] = eye.value[i];
        view.eye_dot[i] = eye.rate[i];
    }
    memcpy(view_reals, &view, sizeof view);
}

void golden_backdrop(const golden_file *file, int time, double reals[TD_BACKDROP_REALS]) {
    input_row colour = row_of(file, "bg", (size_t)time, 3);
    const double *weight = golden_reals(file, "lum_w");
    td_backdrop backdrop;
    memset(&backdrop, 0, sizeof backdrop);
    for (int c = 0; c < 3; c++) {
        backdrop.colour[c] = colour.value[c];
        backdrop.colour_dot[c] = colour.rate[c];
        backdrop.luminance += weight[c] * colour.value[c];
        backdrop.luminance_dot += weight[c] * colour.rate[c];
    }
    memcpy(reals, &backdrop, sizeof backdrop);
}

/* Sets the differences of a mode that no rule of image.rules has. */
static void adjust(const golden_file *file, td_image *image) {
    if (strcmp(file->mode, "ideal") == 0) {
        image->cut = image->cut_full = 0;
        image->cut_rule = TD_CUT_NONE;
        image->stop_rule = TD_STOP_NONE;
        image->extent_rule = TD_EXTENT_ELLIPSE;
    }
    if (strncmp(file->mode, "gsplat160", 9) == 0) {
        image->alpha_max = 0.99;         /* 1.5.3 has 0.999 */
        image->antialias_floor = 2.5e-5; /* a factor of at least 0.005, as INRIA's */
    }
}

td_image_numbers golden_image(const golden_file *file, int sh_degree, int outputs) {
    return golden_coded_image(file, sh_degree, outputs, TIDES_TRANSFER_LINEAR, 1);
}

td_image_numbers golden_coded_image(const golden_file *file, int sh_degree, int outputs, int32_t transfer, double gamma) {
    const golden_mode *mode = find_mode(file->mode);
    const double *k = golden_reals(file, "K"), *weight = golden_reals(file, "lum_w");
    tides_intrinsics camera = {file->width, file->height, k[0], k[4], k[2], k[5], {0}};
    tides_image_params params;
    td_image image;
    tides_error error;
    tides_image_params_defaults(&params);
    params.rules = mode->rules;
    params.antialias = mode->antialias;
    params.log_eps = *golden_reals(file, "lum_eps");
    for (int c = 0; c < 3; c++) params.luminance[c] = weight[c];
    scene_expect_ok(td_image_resolve(&params, &camera, sh_degree, &image, &error), &error);
    adjust(file, &image);
    td_image_set_transfer(transfer, gamma, &image);
    image.objects = 1;
    image.moving = 1;
    image.outputs = outputs;
    return td_image_pack(&image);
}

/* Entry of R(q), written as a bilinear form R(q, q) of the unit quaternion, so that its rate is R(q, q_dot) + R(q_dot, q). */
static double rotation_entry(const double a[4], const double b[4], int i, int j) {
    int k = 3 - i - j;                           /* the third axis, where i != j */
    double sign = (j - i + 3) % 3 == 1 ? -1 : 1; /* of w x_k: minus above the diagonal in cyclic order */
    if (i == j) return a[0] * b[0] + 2 * a[1 + i] * b[1 + i] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    return 2 * (a[1 + i] * b[1 + j] + sign * a[0] * b[1 + k]);
}

static void put_rotation(const input_row *q, golden_splat *splat) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            splat->value[SPLAT_ROTATION + 3 * i + j] = rotation_entry(q->value, q->value, i, j);
            splat->rate[SPLAT_ROTATION + 3 * i + j] =
                rotation_entry(q->value, q->rate, i, j) + rotation_entry(q->rate, q->value, i, j);
        }
}

void golden_expected(const golden_file *file, int time, int gaussian, golden_splat *splat) {
    static const struct {
        const char *name;
        int at, reals;
    } arrays[] = {{"scale", SPLAT_SCALE, 3},
                  {"opacity", SPLAT_OPACITY, 1},
                  {"cov3", SPLAT_COV3, 6},
                  {"pc", SPLAT_PC, 3},
                  {"u", SPLAT_U, 2},
                  {"depth", SPLAT_DEPTH, 1},
                  {"cov2", SPLAT_COV2, 3},
                  {"conic", SPLAT_CONIC, 3},
                  {"color", SPLAT_COLOUR, 3},
                  {"comp", SPLAT_COMP, 1},
                  {"opacity_eff", SPLAT_OPACITY_EFF, 1}};
    size_t i = (size_t)time * (size_t)file->gaussians + (size_t)gaussian;
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) {
        input_row row = row_of(file, arrays[k].name, i, (size_t)arrays[k].reals);
        memcpy(splat->value + arrays[k].at, row.value, (size_t)arrays[k].reals * sizeof *row.value);
        memcpy(splat->rate + arrays[k].at, row.rate, (size_t)arrays[k].reals * sizeof *row.rate);
    }
    input_row quaternion = row_of(file, "quat", i, 4);
    put_rotation(&quaternion, splat);
    if (file->whole_pixel_centres)
        for (int k = 0; k < 2; k++) splat->value[SPLAT_U + k] += 0.5;
    splat->visible = 0;
}
