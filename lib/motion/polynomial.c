/* SpacetimeGaussians: checks the arrays, and packs numbers for the kernel. */
#include "td_models.h"

#include "kernels/motion_polynomial.h"
#include "td_math.h"

#include <math.h>
#include <string.h>

/* Widths from e^-80 to e^80 keep 1 / width within single precision. */
static const double LOG_WIDTH_MOST = 80;

/* The model's fields: opacity_centre (N) [tau], opacity_log_width (N) ln [tau], mean_coefficient (N x 9), three axes for each
 * of the powers k = 1, 2, 3 [scene units / tau^k], quaternion_dot (N x 4) [1 / tau]. */
typedef struct polynomial_fields {
    const td_field *centre, *log_width, *coefficient, *quaternion_dot;
    const td_field *feature, *feature_dot; /* NULL without a decoder */
} polynomial_fields;

static tides_status find_fields(const tides_motion *motion, int64_t count, polynomial_fields *fields, tides_error *error) {
    memset(fields, 0, sizeof *fields);
    tides_status status = td_motion_need_rows(motion, "opacity_centre", count, 1, &fields->centre, error);
    if (status == TIDES_OK) status = td_motion_need_rows(motion, "opacity_log_width", count, 1, &fields->log_width, error);
    if (status == TIDES_OK) status = td_motion_need_rows(motion, "mean_coefficient", count, 9, &fields->coefficient, error);
    if (status == TIDES_OK) status = td_motion_need_rows(motion, "quaternion_dot", count, 4, &fields->quaternion_dot, error);
    if (status != TIDES_OK || td_motion_setting(motion, "decoder", 0) == 0) return status;
    status = td_motion_need_rows(motion, "feature", count, 6, &fields->feature, error);
    if (status == TIDES_OK) status = td_motion_need_rows(motion, "feature_dot", count, 3, &fields->feature_dot, error);
    return status;
}

/* Checks the decoder's arrays, if the settings say that there is a decoder. */
static tides_status check_decoder(const tides_motion *motion, tides_error *error) {
    const uint64_t first[2] = {6, 12}, second[2] = {3, 6};
    const td_field *field = NULL;
    double decoder = td_motion_setting(motion, "decoder", 0);
    if (decoder == 0) return TIDES_OK;
    if (decoder != TIDES_DECODER_SIGMOID && decoder != TIDES_DECODER_CLAMP && decoder != TIDES_DECODER_PLAIN)
        return td_fail(error, TIDES_BAD_FILE, "polynomial motion: setting 'decoder' is %g: must be from %d to %d", decoder,
                       TIDES_DECODER_NONE, TIDES_DECODER_PLAIN);
    tides_status status = td_motion_need_field(motion, "decoder_first", 2, first, &field, error);
    if (status == TIDES_OK) status = td_motion_need_field(motion, "decoder_second", 2, second, &field, error);
    return status;
}

static tides_status check(const tides_motion *motion, const tides_gaussians *gaussians, tides_error *error) {
    polynomial_fields fields;
    tides_status status = find_fields(motion, gaussians->count, &fields, error);
    if (status == TIDES_OK) status = check_decoder(motion, error);
    if (status != TIDES_OK) return status;
    for (int64_t i = 0; i < gaussians->count; i++)
        if (fabs((double)fields.log_width->value[i]) > LOG_WIDTH_MOST)
            return td_fail(error, TIDES_BAD_FILE,
                           "polynomial motion: opacity_log_width %lld is %g: must be from -%g to %g (a logarithm)",
                           (long long)i, fields.log_width->value[i], LOG_WIDTH_MOST, LOG_WIDTH_MOST);
    return TIDES_OK;
}

static void widen(const float *from, int64_t row, int width, double *to) {
    for (int i = 0; i < width; i++) to[i] = from[row * width + i];
}

static void pack_row(const polynomial_fields *fields, const tides_gaussians *gaussians, int64_t i, double *row) {
    widen(gaussians->mean, i, 3, row + TD_POLYNOMIAL_MEAN);
    widen(fields->coefficient->value, i, 9, row + TD_POLYNOMIAL_COEFFICIENT);
    row[TD_POLYNOMIAL_CENTRE] = fields->centre->value[i];
    row[TD_POLYNOMIAL_NARROWNESS] = td_exp(-(double)fields->log_width->value[i]);
    row[TD_POLYNOMIAL_OPACITY] = td_sigmoid(gaussians->opacity_logit[i]);
    widen(gaussians->quaternion, i, 4, row + TD_POLYNOMIAL_QUATERNION);
    widen(fields->quaternion_dot->value, i, 4, row + TD_POLYNOMIAL_QUATERNION_DOT);
    for (int k = 0; k < 3; k++) row[TD_POLYNOMIAL_SCALE + k] = td_exp((double)gaussians->log_scale[3 * i + k]);
}

static tides_status pack(const tides_motion *motion, const tides_gaussians *gaussians, td_mover_numbers *numbers,
                         tides_error *error) {
    polynomial_fields fields;
    tides_status status = find_fields(motion, gaussians->count, &fields, error);
    int stride = fields.feature ? TD_POLYNOMIAL_STRIDE_MOST : TD_POLYNOMIAL_FEATURE;
    if (status == TIDES_OK) status = td_mover_create_rows(numbers, "polynomial", gaussians->count, stride, error);
    for (int64_t i = 0; i < gaussians->count && status == TIDES_OK; i++) {
        double *row = numbers->data + i * stride;
        pack_row(&fields, gaussians, i, row);
        if (!fields.feature) continue;
        widen(fields.feature->value, i, 6, row + TD_POLYNOMIAL_FEATURE);
        widen(fields.feature_dot->value, i, 3, row + TD_POLYNOMIAL_FEATURE + 6);
    }
    numbers->own[TD_POLYNOMIAL_STRIDE] = stride;
    numbers->moves_sh = fields.feature != NULL;
    return status;
}

static int all_zero(const td_field *field, int64_t row, int width) {
    for (int k = 0; k < width; k++)
        if (field->value[row * width + k] != 0) return 0;
    return 1;
}

/* A Gaussian rests if it has no rates, and its opacity over time is so wide that it changes by less than single precision's
 * last bit. */
static void find_moving(const tides_motion *motion, const tides_gaussians *gaussians, uint8_t *moving) {
    const double unseen = ldexp(1, -25);
    polynomial_fields fields;
    if (find_fields(motion, gaussians->count, &fields, NULL) != TIDES_OK) return;
    for (int64_t i = 0; i < gaussians->count; i++) {
        double centre = fields.centre->value[i];
        double reach = fmax(fabs(motion->start - centre), fabs(motion->stop - centre));
        double x = reach * td_exp(-(double)fields.log_width->value[i]);
        moving[i] = !(all_zero(fields.coefficient, i, 9) && all_zero(fields.quaternion_dot, i, 4) && x * x < unseen &&
                      (!fields.feature_dot || all_zero(fields.feature_dot, i, 3)));
    }
}

/* Time in which a quaternion on a line turns by half a radian at its fastest. It turns fastest where it is nearest to zero,
 * at 2 |q_dot| / |q|. */
static double turning_time(const float q[4], const float q_dot[4]) {
    double along = 0, speed = 0, nearest = 0;
    for (int k = 0; k < 4; k++) {
        along += (double)q[k] * q_dot[k];
        speed += (double)q_dot[k] * q_dot[k];
    }
    if (!(speed > 0)) return INFINITY;
    for (int k = 0; k < 4; k++) {
        double x = q[k] - along / speed * q_dot[k];
        nearest += x * x;
    }
    return 0.25 * sqrt(nearest / speed);
}

/* Scales of time from opacity and rotation. Means are cubics, which sweeps follow exactly. */
static void scales(const tides_motion *motion, const tides_gaussians *gaussians, td_time_scale *scales) {
    polynomial_fields fields;
    int found = find_fields(motion, gaussians->count, &fields, NULL) == TIDES_OK;
    for (int64_t i = 0; i < gaussians->count; i++) {
        const td_time_scale none = {INFINITY, 0, INFINITY, 0};
        scales[i] = none;
        if (!found) continue;
        scales[i].centre = fields.centre->value[i];
        scales[i].width = td_exp((double)fields.log_width->value[i]);
        scales[i].always = turning_time(gaussians->quaternion + 4 * i, fields.quaternion_dot->value + 4 * i);
    }
}

const td_motion_class td_polynomial_class = {.name = "polynomial",
                                             .code = TD_MOTION_POLYNOMIAL,
                                             .check = check,
                                             .pack = pack,
                                             .scales = scales,
                                             .find_moving = find_moving};

/* Adds the full model's nine features and its decoder. */
static tides_status add_decoder(tides_motion *made, const tides_polynomial_motion *arrays, tides_error *error) {
    const uint64_t first[2] = {6, 12}, second[2] = {3, 6};
    if (arrays->decoder < TIDES_DECODER_SIGMOID || arrays->decoder > TIDES_DECODER_PLAIN)
        return td_fail(error, TIDES_BAD_ARGUMENT, "polynomial motion: decoder is %d: must be from %d to %d", arrays->decoder,
                       TIDES_DECODER_NONE, TIDES_DECODER_PLAIN);
    tides_status status = td_motion_copy_rows(made, "feature", arrays->count, 6, arrays->feature, error);
    if (status == TIDES_OK) status = td_motion_copy_rows(made, "feature_dot", arrays->count, 3, arrays->feature_dot, error);
    if (status == TIDES_OK) status = td_motion_copy_field(made, "decoder_first", 2, first, arrays->decoder_first, error);
    if (status == TIDES_OK) status = td_motion_copy_field(made, "decoder_second", 2, second, arrays->decoder_second, error);
    if (status == TIDES_OK) status = td_motion_set(made, "decoder", arrays->decoder, error);
    return status;
}

tides_status tides_motion_create_polynomial(const tides_polynomial_motion *arrays, tides_motion **motion, tides_error *error) {
    tides_motion *made = NULL;
    int64_t count = arrays->count;
    *motion = NULL;
    if (count < 1)
        return td_fail(error, TIDES_BAD_ARGUMENT, "polynomial motion: count is %lld: must be at least 1", (long long)count);
    tides_status status = td_motion_create(&td_polynomial_class, arrays->start, arrays->stop, &made, error);
    if (status != TIDES_OK) return status;
    status = td_motion_copy_rows(made, "opacity_centre", count, 1, arrays->opacity_centre, error);
    if (status == TIDES_OK) status = td_motion_copy_rows(made, "opacity_log_width", count, 1, arrays->opacity_log_width, error);
    if (status == TIDES_OK) status = td_motion_copy_rows(made, "mean_coefficient", count, 9, arrays->mean_coefficient, error);
    if (status == TIDES_OK) status = td_motion_copy_rows(made, "quaternion_dot", count, 4, arrays->quaternion_dot, error);
    if (status == TIDES_OK && arrays->decoder != TIDES_DECODER_NONE) status = add_decoder(made, arrays, error);
    if (status == TIDES_OK && arrays->plain_colour) status = td_motion_set(made, "plain_colour", 1, error);
    return td_motion_finish(status, made, motion);
}
