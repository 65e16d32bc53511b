/* Internal: one Gaussian's activation, from raw parameters in double. */
#ifndef TD_ACTIVATE_H
#define TD_ACTIVATE_H

/* Mean, log of scale, quaternion wxyz of any length above 0 and logit of opacity to a row of geometry (TD_GEOMETRY_STRIDE, in
 * the order TD_G_* of kernels/layout.h), and their rates [1/s] to the row of its rates. */
void td_activate(const double mean[3], const double log_scale[3], const double quaternion[4], double opacity_logit,
                 double *geometry);
void td_activate_rates(const double mean_dot[3], const double log_scale[3], const double log_scale_dot[3],
                       const double quaternion[4], const double quaternion_dot[4], double opacity_logit,
                       double opacity_logit_dot, double *rates);

#endif
