/* 4-D Gaussians (4d-gaussian-splatting): checks the arrays, and packs numbers for the kernel.
 *
 * Fields: centre (N) [tau], log_scale_time (N), quaternion_right (N x 4; absent: space and time don't mix, so Gaussians don't
 * move) and sh_harmonic (N x harmonics x K x 3; absent: colours don't change). Settings: period [tau], time_prefilter
 * [tau^2].
 *
 * In four dimensions (x y z t) a Gaussian has the factor L = R diag(s) and the covariance L L^T, with R from two unit
 * quaternions. A are the rows of L for space, l its row for time, and n the unit vector along l. At a given time the
 * covariance is A (I - n n^T) A^T: only the part of A normal to n counts. So its factor is A times a basis normal to n. That
 * avoids the cancellation in S11 - S12 S12^T / S44. Such a basis comes from a Householder reflection that maps n to the last
 * axis. */
#include "td_models.h"

#include "kernels/motion_rotor.h"
#include "td_math.h"

#include <math.h>
#include <string.h>

/* Largest number of harmonics that a motion may have. */
enum { HARMONICS_MOST = 4 };

typedef struct rotor_fields {
    const td_field *centre, *log_scale_time, *quaternion_right, *sh_harmonic; /* the last two may be NULL */
    int harmonics;
} rotor_fields;

static tides_status find_fields(const tides_motion *motion, const tides_gaussians *gaussians, rotor_fields *fields,
                                tides_error *error) {
    const uint64_t coefficients = (uint64_t)(gaussians->sh_degree + 1) * (uint64_t)(gaussians->sh_degree + 1);
    const uint64_t shape[4] = {(uint64_t)gaussians->count, 0, coefficients, 3};
    memset(fields, 0, sizeof *fields);
    tides_status status = td_motion_need_rows(motion, "centre", gaussians->count, 1, &fields->centre, error);
    if (status == TIDES_OK)
        status = td_motion_need_rows(motion, "log_scale_time", gaussians->count, 1, &fields->log_scale_time, error);
    if (status == TIDES_OK && td_motion_field(motion, "quaternion_right"))
        status = td_motion_need_rows(motion, "quaternion_right", gaussians->count, 4, &fields->quaternion_right, error);
    if (status == TIDES_OK && td_motion_field(motion, "sh_harmonic"))
        status = td_motion_need_field(motion, "sh_harmonic", 4, shape, &fields->sh_harmonic, error);
    if (status == TIDES_OK && fields->sh_harmonic) fields->harmonics = (int)fields->sh_harmonic->shape[1];
    return status;
}

/* -- geometry ------------------------------------------------------------------------------------------------------- */

/* Normalises a quaternion; 0 if it has no direction. */
static int unit_quaternion(const float raw[4], double q[4]) {
    double norm = 0;
    for (int i = 0; i < 4; i++) norm += (double)raw[i] * raw[i];
    norm = sqrt(norm);
    for (int i = 0; i < 4; i++) q[i] = raw[i] / norm;
    return norm > 0;
}

/* R in the order x y z t: the product of the matrices of the left and the right quaternion, with both axes reversed. */
static void rotation_4d(const double l[4], const double r[4], double out[4][4]) {
    const double left[4][4] = {{l[0], -l[1], -l[2], -l[3]},
                               {l[1], l[0], -l[3], l[2]},
                               {l[2], l[3], l[0], -l[1]},
                               {l[3], -l[2], l[1], l[0]}};
    const double right[4][4] = {{r[0], r[1], r[2], r[3]},
                                {-r[1], r[0], -r[3], r[2]},
                                {-r[2], r[3], r[0], -r[1]},
                                {-r[3], -r[2], r[1], r[0]}};
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            double sum = 0;
            for (int k = 0; k < 4; k++) sum += left[i][k] * right[k][j];
            out[3 - i][3 - j] = sum;
        }
}

/* A reflection whose first three columns are normal to the unit vector n. */
static void reflection_of(const double n[4], double h[4][4]) {
    double v[4] = {n[0], n[1], n[2], n[3] + (n[3] < 0 ? -1 : 1)}, square = 0; /* never near 0 */
    for (int i = 0; i < 4; i++) square += v[i] * v[i];
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) h[i][j] = (i == j) - 2 * v[i] * v[j] / square;
}

/* Velocity, factor and variance in time of a Gaussian whose axes mix space and time. */
static void slice(const double l[4], const double r[4], const double scale[4], double *row, double *variance) {
    double factor[4][4], h[4][4], n[4], length;
    rotation_4d(l, r, factor);
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) factor[i][j] *= scale[j];
    const double *time = factor[3];
    *variance = time[0] * time[0] + time[1] * time[1] + time[2] * time[2] + time[3] * time[3];
    length = sqrt(*variance);
    for (int j = 0; j < 4; j++) n[j] = time[j] / length;
    reflection_of(n, h);
    for (int i = 0; i < 3; i++) {
        double along = 0;
        for (int k = 0; k < 4; k++) along += factor[i][k] * n[k];
        row[TD_ROTOR_VELOCITY + i] = along / length;
        for (int j = 0; j < 3; j++) {
            double sum = 0;
            for (int k = 0; k < 4; k++) sum += factor[i][k] * h[k][j];
            row[TD_ROTOR_FACTOR + 3 * i + j] = sum;
        }
    }
}

/* Factor and variance in time of a Gaussian without such mixing. Its scale in time is used as the variance, as in the
 * method's code. */
static void stand(const double q[4], const double scale[4], double *row, double *variance) {
    double w = q[0], x = q[1], y = q[2], z = q[3];
    const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                         2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    for (int k = 0; k < 9; k++) row[TD_ROTOR_FACTOR + k] = r[k] * scale[k % 3];
    *variance = scale[3];
}

/* Computes a Gaussian's numbers except its colour. */
static tides_status pack_geometry(const tides_motion *motion, const rotor_fields *fields, const tides_gaussians *gaussians,
                                  int64_t i, double row[TD_ROTOR_TURN], tides_error *error) {
    double l[4], r[4], scale[4], variance, prefilter = td_motion_setting(motion, "time_prefilter", 0);
    int fine = unit_quaternion(gaussians->quaternion + 4 * i, l);
    memset(row, 0, TD_ROTOR_TURN * sizeof *row);
    for (int k = 0; k < 3; k++) scale[k] = td_exp((double)gaussians->log_scale[3 * i + k]);
    scale[3] = td_exp((double)fields->log_scale_time->value[i]);
    if (fields->quaternion_right) {
        fine = fine && unit_quaternion(fields->quaternion_right->value + 4 * i, r);
        if (fine) slice(l, r, scale, row, &variance);
    } else if (fine)
        stand(l, scale, row, &variance);
    for (int k = 0; k < 3; k++) row[TD_ROTOR_MEAN + k] = gaussians->mean[3 * i + k];
    row[TD_ROTOR_CENTRE] = fields->centre->value[i];
    if (fine) row[TD_ROTOR_NARROWNESS] = 1 / sqrt(2 * (variance + (prefilter > 0 ? prefilter : 0)));
    row[TD_ROTOR_OPACITY] = td_sigmoid(gaussians->opacity_logit[i]);
    /* The kernel squares these in single precision, whose largest number is 3e38. */
    for (int k = 0; k < TD_ROTOR_TURN; k++) fine = fine && fabs(row[k]) < 1e18;
    if (fine) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE,
                   "rotor motion: Gaussian %lld has a zero quaternion, or a scale in space or time "
                   "(log_scale_time %g) beyond what can be computed with",
                   (long long)i, (double)fields->log_scale_time->value[i]);
}

/* -- class ---------------------------------------------------------------------------------------------------------- */

static tides_status check(const tides_motion *motion, const tides_gaussians *gaussians, tides_error *error) {
    rotor_fields fields;
    double row[TD_ROTOR_TURN];
    tides_status status = find_fields(motion, gaussians, &fields, error);
    if (status == TIDES_OK && fields.harmonics > HARMONICS_MOST)
        status = td_fail(error, TIDES_BAD_FILE, "rotor motion: array 'sh_harmonic' has %d harmonics: at most %d",
                         fields.harmonics, HARMONICS_MOST);
    if (status == TIDES_OK && !(td_motion_setting(motion, "period", 1) > 0))
        status = td_fail(error, TIDES_BAD_FILE, "rotor motion: setting 'period' must be positive");
    for (int64_t i = 0; i < gaussians->count && status == TIDES_OK; i++)
        status = pack_geometry(motion, &fields, gaussians, i, row, error);
    return status;
}

static double frequency(const tides_motion *motion) {
    return 2 * TD_PI / td_motion_setting(motion, "period", motion->stop - motion->start);
}

static void pack_colour(const tides_motion *motion, const rotor_fields *fields, const tides_gaussians *gaussians, int64_t i,
                        int entries, double *row) {
    for (int k = 1; k <= fields->harmonics; k++) {
        double angle = frequency(motion) * k * fields->centre->value[i];
        *row++ = td_cos(angle);
        *row++ = td_sin(angle);
    }
    for (int e = 0; e < entries; e++) *row++ = gaussians->sh[i * entries + e];
    for (int e = 0; e < fields->harmonics * entries; e++)
        *row++ = fields->sh_harmonic->value[i * fields->harmonics * entries + e];
}

static tides_status pack(const tides_motion *motion, const tides_gaussians *gaussians, td_mover_numbers *numbers,
                         tides_error *error) {
    rotor_fields fields;
    tides_status status = find_fields(motion, gaussians, &fields, error);
    int entries = 3 * (gaussians->sh_degree + 1) * (gaussians->sh_degree + 1), stride = TD_ROTOR_TURN;
    if (fields.harmonics > 0) stride += 2 * fields.harmonics + (fields.harmonics + 1) * entries;
    if (status == TIDES_OK) status = td_mover_create_rows(numbers, "rotor", gaussians->count, stride, error);
    for (int64_t i = 0; i < gaussians->count && status == TIDES_OK; i++) {
        double *row = numbers->data + i * stride;
        status = pack_geometry(motion, &fields, gaussians, i, row, error);
        if (fields.harmonics > 0) pack_colour(motion, &fields, gaussians, i, entries, row + TD_ROTOR_TURN);
    }
    numbers->own[TD_ROTOR_STRIDE] = stride;
    numbers->own[TD_ROTOR_HARMONICS] = fields.harmonics;
    numbers->own[TD_ROTOR_SH_ENTRIES] = entries;
    numbers->real[TD_ROTOR_FREQUENCY] = frequency(motion);
    numbers->moves_sh = fields.harmonics > 0;
    return status;
}

static void moment(const tides_motion *motion, double tau, int side, double real[TD_MOMENT_REALS]) {
    (void)side;
    for (int k = 1; k <= HARMONICS_MOST; k++) {
        real[TD_ROTOR_MOMENT_TURN + 2 * (k - 1)] = td_cos(frequency(motion) * k * tau);
        real[TD_ROTOR_MOMENT_TURN + 2 * (k - 1) + 1] = td_sin(frequency(motion) * k * tau);
    }
}

static int colour_rests(const rotor_fields *fields, int64_t i) {
    if (!fields->sh_harmonic) return 1;
    uint64_t own = fields->sh_harmonic->shape[1] * fields->sh_harmonic->shape[2] * 3;
    for (uint64_t e = 0; e < own; e++)
        if (fields->sh_harmonic->value[(uint64_t)i * own + e] != 0) return 0;
    return 1;
}

/* A Gaussian rests if its velocity is 0 and its harmonics are 0. Its opacity over time must be so wide that it changes by less
 * than single precision's last bit. */
static void find_moving(const tides_motion *motion, const tides_gaussians *gaussians, uint8_t *moving) {
    const double unseen = ldexp(1, -25);
    rotor_fields fields;
    double row[TD_ROTOR_TURN];
    if (find_fields(motion, gaussians, &fields, NULL) != TIDES_OK) return;
    for (int64_t i = 0; i < gaussians->count; i++) {
        if (pack_geometry(motion, &fields, gaussians, i, row, NULL) != TIDES_OK) continue;
        double centre = row[TD_ROTOR_CENTRE], reach = fmax(fabs(motion->start - centre), fabs(motion->stop - centre));
        double x = reach * row[TD_ROTOR_NARROWNESS];
        const double *velocity = row + TD_ROTOR_VELOCITY;
        int drifts = velocity[0] != 0 || velocity[1] != 0 || velocity[2] != 0;
        moving[i] = drifts || x * x >= unseen || !colour_rests(&fields, i);
    }
}

/* Scales of time from the width of opacity and the period of the highest harmonic. */
static void scales(const tides_motion *motion, const tides_gaussians *gaussians, td_time_scale *scales) {
    rotor_fields fields;
    double row[TD_ROTOR_TURN];
    int found = find_fields(motion, gaussians, &fields, NULL) == TIDES_OK;
    for (int64_t i = 0; i < gaussians->count; i++) {
        const td_time_scale none = {INFINITY, 0, INFINITY, 0};
        scales[i] = none;
        if (!found || pack_geometry(motion, &fields, gaussians, i, row, NULL) != TIDES_OK) continue;
        scales[i].centre = row[TD_ROTOR_CENTRE];
        scales[i].width = 1 / row[TD_ROTOR_NARROWNESS];
        if (!colour_rests(&fields, i)) scales[i].always = 2 * TD_PI / (frequency(motion) * fields.harmonics);
    }
}

const td_motion_class td_rotor_class = {.name = "rotor",
                                        .code = TD_MOTION_ROTOR,
                                        .check = check,
                                        .pack = pack,
                                        .moment = moment,
                                        .scales = scales,
                                        .find_moving = find_moving};

static tides_status add_harmonics(tides_motion *made, const tides_rotor_motion *arrays, tides_error *error) {
    if (arrays->harmonics == 0) return TIDES_OK;
    if (arrays->harmonics < 0 || arrays->harmonics > HARMONICS_MOST || arrays->sh_degree < 0 ||
        arrays->sh_degree > TIDES_SH_DEGREE_MAX)
        return td_fail(error, TIDES_BAD_ARGUMENT, "rotor motion: harmonics is %d and sh_degree %d: must be from 0 to %d and %d",
                       arrays->harmonics, arrays->sh_degree, HARMONICS_MOST, TIDES_SH_DEGREE_MAX);
    const uint64_t coefficients = (uint64_t)(arrays->sh_degree + 1) * (uint64_t)(arrays->sh_degree + 1);
    const uint64_t shape[4] = {(uint64_t)arrays->count, (uint64_t)arrays->harmonics, coefficients, 3};
    return td_motion_copy_field(made, "sh_harmonic", 4, shape, arrays->sh_harmonic, error);
}

tides_status tides_motion_create_rotor(const tides_rotor_motion *arrays, tides_motion **motion, tides_error *error) {
    tides_motion *made = NULL;
    *motion = NULL;
    if (arrays->count < 1 || arrays->period < 0)
        return td_fail(error, TIDES_BAD_ARGUMENT, "rotor motion: count is %lld and period %g: must be at least 1 and 0",
                       (long long)arrays->count, arrays->period);
    tides_status status = td_motion_create(&td_rotor_class, arrays->start, arrays->stop, &made, error);
    if (status != TIDES_OK) return status;
    status = td_motion_copy_rows(made, "centre", arrays->count, 1, arrays->centre, error);
    if (status == TIDES_OK)
        status = td_motion_copy_rows(made, "log_scale_time", arrays->count, 1, arrays->log_scale_time, error);
    if (status == TIDES_OK && arrays->quaternion_right)
        status = td_motion_copy_rows(made, "quaternion_right", arrays->count, 4, arrays->quaternion_right, error);
    if (status == TIDES_OK) status = add_harmonics(made, arrays, error);
    if (status == TIDES_OK && arrays->period > 0) status = td_motion_set(made, "period", arrays->period, error);
    if (status == TIDES_OK && arrays->time_prefilter > 0)
        status = td_motion_set(made, "time_prefilter", arrays->time_prefilter, error);
    return td_motion_finish(status, made, motion);
}
