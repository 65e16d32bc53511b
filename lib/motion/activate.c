/* Activation of a Gaussian's raw parameters to the values and rates that projection reads (paper, Sec. 3.2), in double. It
 * serves the renderer's store and motions computed on the host; kernels activate on the device. */
#include "td_activate.h"
#include "td_models.h"

#include "camera/td_rotation.h"
#include "kernels/motion.h"
#include "td_math.h"

#include <math.h>

/* dR/dt for a unit quaternion q with rate p. It isn't td_rotation_rate, whose sums have another order: other rounding would
 * change the last bits of events. */
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

void td_activate(const double mean[3], const double log_scale[3], const double quaternion[4], double opacity_logit,
                 double *geometry) {
    double q[4], r[9];
    normalise(quaternion, q);
    td_rotation_from_quaternion(q, r);
    for (int i = 0; i < 3; i++) geometry[TD_G_MEAN + i] = geometry[TD_G_ORIGIN + i] = mean[i];
    geometry[TD_G_OPACITY] = td_sigmoid(opacity_logit);
    const double scale[3] = {td_exp(log_scale[0]), td_exp(log_scale[1]), td_exp(log_scale[2])};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) geometry[TD_G_FACTOR + 3 * i + j] = r[3 * i + j] * scale[j];
}

void td_activate_rates(const double mean_dot[3], const double log_scale[3], const double log_scale_dot[3],
                       const double quaternion[4], const double quaternion_dot[4], double opacity_logit,
                       double opacity_logit_dot, double *rates) {
    double q[4], p[4], r[9], r_dot[9];
    double norm = normalise(quaternion, q);
    double along = 0;
    for (int i = 0; i < 4; i++) along += q[i] * quaternion_dot[i];
    for (int i = 0; i < 4; i++) p[i] = (quaternion_dot[i] - q[i] * along) / norm;
    td_rotation_from_quaternion(q, r);
    rotation_rate_of(q, p, r_dot);
    double opacity = td_sigmoid(opacity_logit);
    for (int i = 0; i < 3; i++) rates[TD_G_MEAN + i] = rates[TD_G_ORIGIN + i] = mean_dot[i];
    rates[TD_G_OPACITY] = opacity * (1 - opacity) * opacity_logit_dot;
    const double scale[3] = {td_exp(log_scale[0]), td_exp(log_scale[1]), td_exp(log_scale[2])};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            rates[TD_G_FACTOR + 3 * i + j] = (r_dot[3 * i + j] + r[3 * i + j] * log_scale_dot[j]) * scale[j];
}
