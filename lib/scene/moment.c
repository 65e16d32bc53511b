/* An object's Gaussians at one time, moved by its motion: for bounding boxes, and for tides_scene_gaussians_at. They are
 * computed in double, on the host. */
#include "camera/td_rotation.h"
#include "motion/td_motion.h"
#include "td_math.h"
#include "td_scene.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rows that a motion computes per call: 128 KB of geometry and its rates. */
enum { ROWS = 512, SH_STRIDE = 3 * (TIDES_SH_DEGREE_MAX + 1) * (TIDES_SH_DEGREE_MAX + 1) };

/* The rows of one call. */
typedef struct batch {
    int32_t index[ROWS];
    double geometry[ROWS * TD_GEOMETRY_STRIDE], rates[ROWS * TD_GEOMETRY_STRIDE];
    double sh[ROWS * SH_STRIDE], sh_rates[ROWS * SH_STRIDE];
} batch;

static tides_status visit_rows(const td_object *object, const td_mover_numbers *numbers, double time, batch *rows,
                               td_row_visitor *visit, void *user, tides_error *error) {
    const tides_gaussians g = td_gaussians_view(&object->gaussians);
    const td_motion_sink sink = {rows->geometry, rows->rates, rows->sh, rows->sh_rates, SH_STRIDE};
    double tau = 0, tau_dot = 0;
    tides_status status = td_motion_time(object->motion, object->duration_s, time, &tau, &tau_dot, error);
    for (int64_t first = 0; first < g.count && status == TIDES_OK; first += ROWS) {
        const int64_t count = g.count - first < ROWS ? g.count - first : ROWS;
        for (int64_t i = 0; i < count; i++) rows->index[i] = (int32_t)(first + i);
        const td_motion_asked asked = {tau, tau_dot, 1, 0, rows->index, count};
        status = td_motion_rows(object->motion, &g, numbers, &asked, &sink, error);
        for (int64_t i = 0; i < count && status == TIDES_OK; i++)
            visit(user, first + i, rows->geometry + i * TD_GEOMETRY_STRIDE,
                  numbers->moves_sh ? rows->sh + i * SH_STRIDE : NULL);
    }
    return status;
}

tides_status td_moving_rows(const td_object *object, double time, td_row_visitor *visit, void *user, tides_error *error) {
    const tides_gaussians g = td_gaussians_view(&object->gaussians);
    td_mover_numbers numbers;
    memset(&numbers, 0, sizeof numbers);
    batch *rows = td_alloc(1, sizeof *rows, error);
    tides_status status = rows ? object->motion->type->pack(object->motion, &g, &numbers, error) : TIDES_NO_MEMORY;
    if (status == TIDES_OK) status = visit_rows(object, &numbers, time, rows, visit, user, error);
    td_mover_release(&numbers);
    free(rows);
    return status;
}

/* -- into arrays -- */

typedef struct arrays {
    const td_gaussians *own;
    const tides_theta *theta;
} arrays;

static void put(double *to, int64_t i, const double *values, int width) {
    if (to) memcpy(to + width * i, values, (size_t)width * sizeof *to);
}

static void put_shape(const tides_theta *to, int64_t i, const double mean[3], const double log_scale[3], const double q[4],
                      double logit) {
    put(to->mean, i, mean, 3);
    put(to->log_scale, i, log_scale, 3);
    put(to->quaternion, i, q, 4);
    put(to->opacity_logit, i, &logit, 1);
}

static void put_own_sh(const arrays *a, int64_t i) {
    const int64_t width = 3 * (int64_t)td_sh_coefficients(a->own->sh_degree);
    for (int64_t k = 0; a->theta->sh && k < width; k++) a->theta->sh[width * i + k] = a->own->sh[width * i + k];
}

/* Converts a row back to raw parameters: ln of scales, a quaternion, and the logit of opacity. The columns of the row's factor
 * R diag(scale) have the scales as lengths. */
static void put_row(void *user, int64_t i, const double *geometry, const double *sh) {
    const arrays *a = user;
    const double *m = geometry + TD_G_FACTOR, least = ldexp(1, -24); /* opacities 0 and 1 have no finite logit */
    double mean[3], log_scale[3], rotation[9], q[4];
    for (int k = 0; k < 3; k++) {
        const double length = fmax(sqrt(m[k] * m[k] + m[3 + k] * m[3 + k] + m[6 + k] * m[6 + k]), (double)FLT_MIN);
        mean[k] = geometry[TD_G_MEAN + k] + a->own->origin[k];
        log_scale[k] = td_ln(length);
        for (int row = 0; row < 3; row++) rotation[3 * row + k] = m[3 * row + k] / length;
    }
    td_quaternion_from_rotation(rotation, q);
    const double opacity = fmin(fmax(geometry[TD_G_OPACITY], least), 1 - least), logit = td_ln(opacity / (1 - opacity));
    put_shape(a->theta, i, mean, log_scale, q, logit);
    if (!sh)
        put_own_sh(a, i);
    else if (a->theta->sh)
        put(a->theta->sh, i, sh, 3 * (int)td_sh_coefficients(a->own->sh_degree));
}

static void put_resting(const arrays *a) {
    const td_gaussians *g = a->own;
    for (int64_t i = 0; i < g->count; i++) {
        double mean[3], log_scale[3], q[4];
        const double logit = g->opacity_logit[i];
        for (int k = 0; k < 3; k++) {
            mean[k] = td_gaussians_mean(g, i, k);
            log_scale[k] = g->log_scale[3 * i + k];
        }
        for (int k = 0; k < 4; k++) q[k] = g->quaternion[4 * i + k];
        put_shape(a->theta, i, mean, log_scale, q, logit);
        put_own_sh(a, i);
    }
}

tides_status tides_scene_gaussians_at(const tides_scene *scene, int32_t index, double time, const tides_theta *theta,
                                      tides_error *error) {
    if (!scene || !theta)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_scene_gaussians_at: %s is NULL", scene ? "theta" : "scene");
    tides_status status = td_scene_check_index(scene, index, error);
    if (status) return status;
    const td_object *object = &scene->objects[index];
    arrays all = {&object->gaussians, theta};
    if (object->motion) return td_moving_rows(object, time, put_row, &all, error);
    put_resting(&all);
    return TIDES_OK;
}
