/* Internal: one Gaussian's activation, from raw parameters in double. */
#ifndef TD_ACTIVATE_H
#define TD_ACTIVATE_H

/* Activates a Gaussian: mean, log of scale, quaternion wxyz of any length above 0, and logit of opacity become a row of
 * geometry (TD_GEOMETRY_STRIDE numbers, at TD_G_*). td_activate_rates does so with their rates, in any unit of time. */
void td_activate(const double mean[3], const double log_scale[3], const double quaternion[4], double opacity_logit,
                 double *geometry);
void td_activate_rates(const double mean_dot[3], const double log_scale[3], const double log_scale_dot[3],
                       const double quaternion[4], const double quaternion_dot[4], double opacity_logit,
                       double opacity_logit_dot, double *rates);

#endif
