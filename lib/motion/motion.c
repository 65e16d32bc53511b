/* Motion models as data: named arrays and settings, with the code common to all models. */
#include "td_motion.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

tides_status td_motion_create(const td_motion_class *type, double start, double stop, tides_motion **motion,
                              tides_error *error) {
    if (!(isfinite(start) && isfinite(stop) && start < stop))
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s motion: time range [%g, %g] must be finite and rising", type->name, start,
                       stop);
    tides_motion *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    made->type = type;
    made->start = start;
    made->stop = stop;
    *motion = made;
    return TIDES_OK;
}

void tides_motion_destroy(tides_motion *motion) {
    if (!motion) return;
    if (motion->type->release) motion->type->release(motion);
    for (int i = 0; i < motion->fields; i++) free(motion->field[i].value);
    free(motion);
}

const char *tides_motion_model(const tides_motion *motion) { return motion->type->name; }

void tides_motion_range(const tides_motion *motion, double *start, double *stop) {
    *start = motion->start;
    *stop = motion->stop;
}

static uint64_t field_count(int rank, const uint64_t *shape) {
    uint64_t count = 1;
    for (int i = 0; i < rank; i++) count *= shape[i];
    return count;
}

tides_status td_motion_take_field(tides_motion *motion, const char *name, int rank, const uint64_t *shape, float *value,
                                  tides_error *error) {
    tides_status status = TIDES_OK;
    uint64_t count = field_count(rank, shape);
    if (motion->fields == TD_FIELDS_MAX || strlen(name) >= sizeof motion->field[0].name || td_motion_field(motion, name))
        status =
            td_fail(error, TIDES_BAD_FILE, "%s motion: array '%.80s' is one too many, there twice, or its name is too long",
                    motion->type->name, name);
    for (uint64_t i = 0; i < count && status == TIDES_OK; i++)
        if (!isfinite(value[i]))
            status = td_fail(error, TIDES_BAD_FILE, "%s motion: value %llu of array '%s' is %g: must be finite",
                             motion->type->name, (unsigned long long)i, name, value[i]);
    if (status != TIDES_OK) {
        free(value);
        return status;
    }
    td_field *field = &motion->field[motion->fields++];
    memcpy(field->name, name, strlen(name) + 1);
    field->rank = rank;
    for (int i = 0; i < rank; i++) field->shape[i] = shape[i];
    field->value = value;
    return TIDES_OK;
}

tides_status td_motion_set(tides_motion *motion, const char *name, double value, tides_error *error) {
    if (motion->settings == TD_SETTINGS_MAX || strlen(name) >= sizeof motion->setting[0].name || !isfinite(value))
        return td_fail(error, TIDES_BAD_FILE, "%s motion: setting '%.80s' is one too many, too long, or isn't finite",
                       motion->type->name, name);
    td_setting *setting = &motion->setting[motion->settings++];
    memcpy(setting->name, name, strlen(name) + 1);
    setting->value = value;
    return TIDES_OK;
}

const td_field *td_motion_field(const tides_motion *motion, const char *name) {
    for (int i = 0; i < motion->fields; i++)
        if (strcmp(motion->field[i].name, name) == 0) return &motion->field[i];
    return NULL;
}

double td_motion_setting(const tides_motion *motion, const char *name, double fallback) {
    for (int i = 0; i < motion->settings; i++)
        if (strcmp(motion->setting[i].name, name) == 0) return motion->setting[i].value;
    return fallback;
}

tides_status td_motion_need_field(const tides_motion *motion, const char *name, int rank, const uint64_t *shape,
                                  const td_field **field, tides_error *error) {
    const td_field *found = td_motion_field(motion, name);
    int fits = found && found->rank == rank;
    for (int i = 0; i < rank && fits; i++) fits = shape[i] == 0 || found->shape[i] == shape[i];
    if (!fits)
        return td_fail(error, TIDES_BAD_FILE, "%s motion: array '%s' is %s", motion->type->name, name,
                       found ? "of another shape than the others ask for" : "missing");
    *field = found;
    return TIDES_OK;
}

void td_motion_moment(const tides_motion *motion, double tau, double tau_dot, int side, double real[TD_MOMENT_REALS]) {
    memset(real, 0, TD_MOMENT_REALS * sizeof *real);
    real[TD_MOMENT_TAU] = (float)tau;
    real[TD_MOMENT_TAU_REST] = tau - real[TD_MOMENT_TAU];
    real[TD_MOMENT_TAU_DOT] = tau_dot;
    if (motion->type->moment) motion->type->moment(motion, tau, side, real);
}

tides_status td_motion_time(const tides_motion *motion, double duration_s, double time, double *tau, double *tau_dot,
                            tides_error *error) {
    /* [s] the resolution of event times, or for very late times the rounding of `time` */
    const double slack = fmax(1e-9, 4 * DBL_EPSILON * fabs(time));
    if (!(time >= -slack && time <= duration_s + slack))
        return td_fail(error, TIDES_OUT_OF_RANGE,
                       "%.15g s is outside the motion's time, 0 to %.15g s; change the time, or scene.duration_s", time,
                       duration_s);
    *tau_dot = (motion->stop - motion->start) / duration_s;
    *tau = time <= 0 ? motion->start : time >= duration_s ? motion->stop : motion->start + time * *tau_dot;
    return TIDES_OK;
}

void td_motion_find_moving(const tides_motion *motion, const tides_gaussians *gaussians, uint8_t *moving) {
    memset(moving, 1, (size_t)gaussians->count);
    if (motion->type->find_moving) motion->type->find_moving(motion, gaussians, moving);
}

void td_mover_release(td_mover_numbers *numbers) {
    free(numbers->data);
    memset(numbers, 0, sizeof *numbers);
}
