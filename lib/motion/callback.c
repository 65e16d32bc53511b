/* Motions given by a user's function: its raw parameters and rates are checked, then activated on the host. */
#include "td_activate.h"
#include "td_models.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Arrays of a Gaussian, in the order of memory; the rates of each follow it. */
enum { MEAN = 0, LOG_SCALE, QUATERNION, LOGIT, SH, PARTS };
static const char *const part_names[PARTS] = {"mean", "log_scale", "quaternion", "opacity_logit", "sh"};

typedef struct callback_rows {
    double *memory; /* owned */
    double *value[PARTS], *rate[PARTS];
    int width[PARTS];
} callback_rows;

static tides_status check(const tides_motion *motion, const tides_gaussians *gaussians, tides_error *error) {
    const tides_callback_motion *own = motion->own;
    if (!own)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "callback motion: a file can't hold one; make it with "
                       "tides_motion_create_callback");
    if (own->count != gaussians->count)
        return td_fail(error, TIDES_BAD_ARGUMENT, "callback motion: is for %lld Gaussians, not %lld", (long long)own->count,
                       (long long)gaussians->count);
    return TIDES_OK;
}

static tides_status pack(const tides_motion *motion, const tides_gaussians *gaussians, td_mover_numbers *numbers,
                         tides_error *error) {
    const tides_callback_motion *own = motion->own;
    (void)gaussians, (void)error;
    numbers->moves_sh = own->moves_sh != 0;
    return TIDES_OK;
}

static tides_status rows_create(callback_rows *rows, const tides_gaussians *gaussians, int moves_sh, int64_t count,
                                tides_error *error) {
    const int widths[PARTS] = {3, 3, 4, 1, moves_sh ? 3 * (gaussians->sh_degree + 1) * (gaussians->sh_degree + 1) : 0};
    size_t width = 0;
    memset(rows, 0, sizeof *rows);
    for (int part = 0; part < PARTS; part++) width += 2 * (size_t)widths[part];
    rows->memory = td_alloc((size_t)count, width * sizeof *rows->memory, error);
    if (!rows->memory) return TIDES_NO_MEMORY;
    double *next = rows->memory;
    for (int part = 0; part < PARTS; part++) {
        size_t reals = (size_t)count * (size_t)widths[part];
        rows->width[part] = widths[part];
        if (reals == 0) continue;
        rows->value[part] = next;
        rows->rate[part] = next + reals;
        next += 2 * reals;
    }
    return TIDES_OK;
}

/* Fills in the Gaussians' own parameters, which the function may leave or change. */
static void rows_fill(callback_rows *rows, const tides_gaussians *gaussians, const int32_t *index, int64_t count) {
    const float *const own[PARTS] = {gaussians->mean, gaussians->log_scale, gaussians->quaternion, gaussians->opacity_logit,
                                     gaussians->sh};
    for (int part = 0; part < PARTS; part++)
        for (int64_t i = 0; i < count; i++)
            for (int k = 0; k < rows->width[part]; k++)
                rows->value[part][i * rows->width[part] + k] = own[part][(int64_t)index[i] * rows->width[part] + k];
    for (int64_t i = 0; i < 3 * count; i++) rows->value[MEAN][i] += gaussians->origin[i % 3];
}

static tides_status call(const tides_callback_motion *own, double tau, int side, const int32_t *index, int64_t count,
                         const callback_rows *rows, tides_error *error) {
    const tides_theta theta = {.mean = rows->value[MEAN],
                               .mean_dot = rows->rate[MEAN],
                               .log_scale = rows->value[LOG_SCALE],
                               .log_scale_dot = rows->rate[LOG_SCALE],
                               .quaternion = rows->value[QUATERNION],
                               .quaternion_dot = rows->rate[QUATERNION],
                               .opacity_logit = rows->value[LOGIT],
                               .opacity_logit_dot = rows->rate[LOGIT],
                               .sh = rows->value[SH],
                               .sh_dot = rows->rate[SH]};
    tides_error own_error = {0, ""};
    tides_status status = own->function(own->user, tau, side, index, count, &theta, &own_error);
    if (status == TIDES_OK) return TIDES_OK;
    if (strcmp(tides_status_name(status), tides_status_name(-1)) == 0) status = TIDES_CANCELLED;
    own_error.text[sizeof own_error.text - 1] = '\0';
    return td_fail(error, status, "callback motion at time %.9g: %s", tau,
                   own_error.text[0] ? own_error.text : "the function gave up");
}

static tides_status check_rows(const callback_rows *rows, double tau, const int32_t *index, int64_t count, tides_error *error) {
    for (int part = 0; part < PARTS; part++)
        for (int64_t k = 0; k < count * rows->width[part]; k++) {
            double value = rows->value[part][k], rate = rows->rate[part][k];
            if (isfinite(value) && isfinite(rate)) continue;
            return td_fail(error, TIDES_BAD_ARGUMENT,
                           "callback motion at time %.9g: %s of Gaussian %d is %g with rate %g: must be "
                           "finite",
                           tau, part_names[part], (int)index[k / rows->width[part]], value, rate);
        }
    for (int64_t i = 0; i < count; i++) {
        const double *q = rows->value[QUATERNION] + 4 * i, *s = rows->value[LOG_SCALE] + 3 * i;
        double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
        if (square > 0 && fabs(s[0]) < 80 && fabs(s[1]) < 80 && fabs(s[2]) < 80) continue;
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "callback motion at time %.9g: Gaussian %d has a quaternion of zero or a log_scale beyond +-80", tau,
                       (int)index[i]);
    }
    return TIDES_OK;
}

static void activate(const callback_rows *rows, int64_t i, double *geometry, double *rates) {
    const double *const *v = (const double *const *)rows->value, *const *r = (const double *const *)rows->rate;
    td_activate(v[MEAN] + 3 * i, v[LOG_SCALE] + 3 * i, v[QUATERNION] + 4 * i, v[LOGIT][i], geometry);
    td_activate_rates(r[MEAN] + 3 * i, v[LOG_SCALE] + 3 * i, r[LOG_SCALE] + 3 * i, v[QUATERNION] + 4 * i, r[QUATERNION] + 4 * i,
                      v[LOGIT][i], r[LOGIT][i], rates);
    for (int k = 0; k < 3; k++) {
        geometry[TD_G_ORIGIN + k] = geometry[TD_G_MEAN + k];
        rates[TD_G_ORIGIN + k] = rates[TD_G_MEAN + k];
    }
}

static tides_status evaluate(const tides_motion *motion, const tides_gaussians *gaussians, const td_motion_asked *asked,
                             const td_motion_sink *to, tides_error *error) {
    const int32_t *index = asked->index;
    const int64_t count = asked->count;
    const tides_callback_motion *own = motion->own;
    callback_rows rows;
    tides_status status = rows_create(&rows, gaussians, own->moves_sh, count, error);
    if (status != TIDES_OK) return status;
    rows_fill(&rows, gaussians, index, count);
    status = call(own, asked->tau, asked->side, index, count, &rows, error);
    for (int64_t i = 0; i < 3 * count; i++) rows.value[MEAN][i] -= gaussians->origin[i % 3];
    if (status == TIDES_OK) status = check_rows(&rows, asked->tau, index, count, error);
    for (int64_t i = 0; i < count && status == TIDES_OK; i++) {
        activate(&rows, i, to->geometry + i * TD_GEOMETRY_STRIDE, to->rates + i * TD_GEOMETRY_STRIDE);
        for (int k = 0; k < rows.width[SH]; k++) {
            to->sh[i * to->sh_stride + k] = rows.value[SH][i * rows.width[SH] + k];
            to->sh_rates[i * to->sh_stride + k] = rows.rate[SH][i * rows.width[SH] + k];
        }
    }
    free(rows.memory);
    return status;
}

static double scale(const tides_motion *motion, double from, double to) {
    const tides_callback_motion *own = motion->own;
    (void)from, (void)to;
    return own && own->time_scale > 0 ? own->time_scale : INFINITY;
}

static void release(tides_motion *motion) { free(motion->own); }

const td_motion_class td_callback_class = {.name = "callback",
                                           .code = TD_MOTION_HOST,
                                           .expensive = 1,
                                           .check = check,
                                           .pack = pack,
                                           .evaluate = evaluate,
                                           .scale = scale,
                                           .release = release};

tides_status tides_motion_create_callback(const tides_callback_motion *callback, tides_motion **motion, tides_error *error) {
    tides_motion *made = NULL;
    *motion = NULL;
    if (callback->count < 1 || !callback->function)
        return td_fail(error, TIDES_BAD_ARGUMENT, "callback motion: needs a function and at least one Gaussian, not %lld",
                       (long long)callback->count);
    if (!(callback->time_scale >= 0) || isinf(callback->time_scale))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "callback motion: time_scale is %g: must be positive, or 0 where a step of the run is short enough",
                       callback->time_scale);
    tides_status status = td_motion_create(&td_callback_class, callback->start, callback->stop, &made, error);
    if (status != TIDES_OK) return status;
    made->own = td_alloc(1, sizeof *callback, error);
    if (!made->own) return td_motion_finish(TIDES_NO_MEMORY, made, motion);
    memcpy(made->own, callback, sizeof *callback);
    return td_motion_finish(TIDES_OK, made, motion);
}
