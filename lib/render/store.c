/* Activation: raw parameters to what the projection reads, values and rates (paper, Sec. 3.2), and the padded arrays of a whole
 * scene. Done once, in double. */
#include "td_render.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>

/* R(q) of a unit quaternion wxyz, row-major. */
static void rotation_of(const double q[4], double r[9]) {
    double w = q[0], x = q[1], y = q[2], z = q[3];
    r[0] = 1 - 2 * (y * y + z * z), r[1] = 2 * (x * y - w * z), r[2] = 2 * (x * z + w * y);
    r[3] = 2 * (x * y + w * z), r[4] = 1 - 2 * (x * x + z * z), r[5] = 2 * (y * z - w * x);
    r[6] = 2 * (x * z - w * y), r[7] = 2 * (y * z + w * x), r[8] = 1 - 2 * (x * x + y * y);
}

/* dR/dt for a unit quaternion q with rate p. */
static void rotation_rate_of(const double q[4], const double p[4], double r[9]) {
    double w = q[0], x = q[1], y = q[2], z = q[3];
    double a = p[0], b = p[1], c = p[2], d = p[3];
    r[0] = -4 * (y * c + z * d), r[1] = 2 * (b * y + x * c - a * z - w * d), r[2] = 2 * (b * z + x * d + a * y + w * c);
    r[3] = 2 * (b * y + x * c + a * z + w * d), r[4] = -4 * (x * b + z * d), r[5] = 2 * (c * z + y * d - a * x - w * b);
    r[6] = 2 * (b * z + x * d - a * y - w * c), r[7] = 2 * (c * z + y * d + a * x + w * b), r[8] = -4 * (x * b + y * c);
}

static double normalise(const double raw[4], double q[4]) {
    double norm = sqrt(raw[0] * raw[0] + raw[1] * raw[1] + raw[2] * raw[2] + raw[3] * raw[3]);
    for (int i = 0; i < 4; i++) q[i] = raw[i] / norm;
    return norm;
}

static double sigmoid(double x) { return 1 / (1 + exp(-x)); }

void td_activate(const double mean[3], const double log_scale[3], const double quaternion[4], double opacity_logit,
                 double *geometry) {
    double q[4], r[9];
    normalise(quaternion, q);
    rotation_of(q, r);
    for (int i = 0; i < 3; i++) geometry[TD_G_MEAN + i] = mean[i];
    geometry[TD_G_OPACITY] = sigmoid(opacity_logit);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) geometry[TD_G_FACTOR + 3 * i + j] = r[3 * i + j] * exp(log_scale[j]);
}

void td_activate_rates(const double mean_dot[3], const double log_scale[3], const double log_scale_dot[3],
                       const double quaternion[4], const double quaternion_dot[4], double opacity_logit,
                       double opacity_logit_dot, double *rates) {
    double q[4], p[4], r[9], r_dot[9];
    double norm = normalise(quaternion, q);
    double along = 0;
    for (int i = 0; i < 4; i++) along += q[i] * quaternion_dot[i];
    for (int i = 0; i < 4; i++) p[i] = (quaternion_dot[i] - q[i] * along) / norm;
    rotation_of(q, r);
    rotation_rate_of(q, p, r_dot);
    double opacity = sigmoid(opacity_logit);
    for (int i = 0; i < 3; i++) rates[TD_G_MEAN + i] = mean_dot[i];
    rates[TD_G_OPACITY] = opacity * (1 - opacity) * opacity_logit_dot;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            rates[TD_G_FACTOR + 3 * i + j] = (r_dot[3 * i + j] + r[3 * i + j] * log_scale_dot[j]) * exp(log_scale[j]);
}

static void widen(const float *from, double *to, int count) {
    for (int i = 0; i < count; i++) to[i] = from[i];
}

/* One object's Gaussians into the store from index `first` on. Coefficients of a lower degree than the scene's are padded
 * with zeros. */
static void add_object(const tides_gaussians *gaussians, int object, int first, td_store *store) {
    int own = 3 * (gaussians->sh_degree + 1) * (gaussians->sh_degree + 1);
    for (int64_t i = 0; i < gaussians->count; i++) {
        double mean[3], log_scale[3], quaternion[4];
        widen(gaussians->mean + 3 * i, mean, 3);
        widen(gaussians->log_scale + 3 * i, log_scale, 3);
        widen(gaussians->quaternion + 4 * i, quaternion, 4);
        size_t at = (size_t)(first + i);
        td_activate(mean, log_scale, quaternion, gaussians->opacity_logit[i], store->geometry + at * TD_GEOMETRY_STRIDE);
        memcpy(store->sh + at * store->sh_stride, gaussians->sh + i * own, own * sizeof *store->sh);
    }
    for (int i = first; i < store->count; i++) store->object[i] = object; /* the next object overwrites its own part */
}

/* Count with every object padded; -1 where it is more than 32-bit indices reach. */
static int padded_count(const tides_scene *scene, int sh_stride) {
    int64_t padded = 0;
    for (int32_t i = 0; i < tides_scene_objects(scene); i++) {
        tides_object object;
        if (tides_scene_object(scene, i, &object, NULL) != TIDES_OK) return -1;
        padded += (object.gaussians.count + TD_PAD - 1) / TD_PAD * TD_PAD;
        int64_t widest = sh_stride > TD_GEOMETRY_STRIDE ? sh_stride : TD_GEOMETRY_STRIDE;
        if (padded > INT_MAX / widest) return -1;
    }
    return (int)padded;
}

tides_status td_store_create(const tides_scene *scene, td_store *store, tides_error *error) {
    int degree = tides_scene_sh_degree(scene);
    td_store made = {0};
    made.objects = tides_scene_objects(scene);
    made.sh_stride = 3 * (degree + 1) * (degree + 1);
    made.count = padded_count(scene, made.sh_stride);
    made.real_count = (int)tides_scene_count(scene);
    if (made.count < 0)
        return td_fail(error, TIDES_UNSUPPORTED, "scene: %lld Gaussians of SH degree %d are more than 32-bit indices reach",
                       (long long)tides_scene_count(scene), degree);
    if (made.count == 0) return td_fail(error, TIDES_BAD_ARGUMENT, "scene: holds no Gaussian; add one before rendering");
    made.object = td_alloc(made.count, sizeof *made.object, error);
    made.geometry = td_alloc((size_t)made.count * TD_GEOMETRY_STRIDE, sizeof *made.geometry, error);
    made.sh = td_alloc((size_t)made.count * made.sh_stride, sizeof *made.sh, error);
    if (!made.object || !made.geometry || !made.sh) {
        td_store_release(&made);
        return TIDES_NO_MEMORY;
    }
    int first = 0;
    for (int32_t i = 0; i < made.objects; i++) {
        tides_object object;
        tides_status status = tides_scene_object(scene, i, &object, error);
        if (status != TIDES_OK) {
            td_store_release(&made);
            return status;
        }
        add_object(&object.gaussians, i, first, &made);
        first += (int)((object.gaussians.count + TD_PAD - 1) / TD_PAD * TD_PAD);
    }
    *store = made;
    return TIDES_OK;
}

void td_store_release(td_store *store) {
    free(store->object);
    free(store->geometry);
    free(store->rates);
    free(store->sh);
    free(store->sh_wide);
    free(store->sh_rates);
    memset(store, 0, sizeof *store);
}
