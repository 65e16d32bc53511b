/* Applies mip-splatting's 3D smoothing filter (Yu et al. 2024) to the Gaussians once, so that all later code sees plain
 * ones.
 *
 * Convolving a Gaussian of scales s with an isotropic one of size f and keeping its mass:
 *     s_i'^2 = s_i^2 + f^2,   opacity' = opacity c,   c = sqrt(prod s_i^2 / prod s_i'^2) <= 1.
 * All is computed in logarithms, in double. With the logit l of the opacity, the new logit l' = ln(o' / (1 - o')) is
 *     l' = l + ln c - ln(1 + (1 - c) e^l),
 * which neither overflows nor cancels for any finite l. */
#include "td_scene.h"

#include "td_math.h"

#include <math.h>

/* ln(1 + e^x) */
static double softplus(double x) { return x > 0 ? x + td_log1p(td_exp(-x)) : td_log1p(td_exp(x)); }

void td_gaussians_fold_filter(td_gaussians *gaussians, const float *filter) {
    for (int64_t i = 0; i < gaussians->count; i++) {
        double size = fabs((double)filter[i]);
        if (size == 0) continue; /* unchanged: keeps the trained bits */
        double log_size = td_ln(size), log_c = 0;
        for (int axis = 0; axis < 3; axis++) {
            float *log_scale = gaussians->log_scale + 3 * i + axis;
            double grown = *log_scale + 0.5 * softplus(2 * (log_size - *log_scale));
            log_c += *log_scale - grown;
            *log_scale = (float)grown;
        }
        double logit = gaussians->opacity_logit[i];
        double one_minus_c = -td_expm1(log_c);
        double loss = one_minus_c > 0 ? softplus(logit + td_ln(one_minus_c)) : 0;
        gaussians->opacity_logit[i] = (float)(logit + log_c - loss);
    }
}
