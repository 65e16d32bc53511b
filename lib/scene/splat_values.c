/* Decodes bytes of packed splat files (.splat, .ksplat, .spz, .sog), in double until the last step, so that each value is
 * rounded only once. */
#include "td_base.h"
#include "td_math.h"
#include "td_splat.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define SH_C0 0.28209479177387814 /* the constant band, 1 / (2 sqrt(pi)) */

float td_splat_logit(double opacity) {
    const double least = 0x1p-24; /* 0 and 1 have no finite logit; a float's nearest neighbour of 1 is 1 - 2^-24 */
    if (opacity < least) opacity = least;
    if (opacity > 1 - least) opacity = 1 - least;
    return (float)td_ln(opacity / (1 - opacity));
}

float td_splat_log_scale(double scale) { return (float)td_ln(scale == 0 ? (double)FLT_MIN : scale); }

float td_splat_dc(double colour) { return (float)((colour - 0.5) / SH_C0); }

double td_splat_colour(double dc) { return 0.5 + SH_C0 * dc; }

double td_splat_opacity(float logit) { return 1 / (1 + td_exp(-(double)logit)); }

void td_splat_unit(const float q[4], double out[4]) {
    double square = 0;
    for (int k = 0; k < 4; k++) square += (double)q[k] * q[k];
    for (int k = 0; k < 4; k++) out[k] = q[k] / sqrt(square);
}

tides_status td_splat_refuse_discs(const char *path, tides_error *error) {
    return td_fail(error, TIDES_UNSUPPORTED,
                   "%s: holds discs, 2-D Gaussians as 2DGS and SuGaR's kind train them, which are cut by rays and not "
                   "projected: "
                   "this version can't draw them; train the scene with 3-D Gaussians (gsplat, Brush, INRIA's 3DGS)",
                   path);
}

void td_splat_rebuild(const double others[3], unsigned largest, float q[4]) {
    double rest = 1;
    for (unsigned i = 0, k = 0; i < 4; i++) {
        if (i == largest) continue;
        rest -= others[k] * others[k];
        q[i] = (float)others[k++];
    }
    q[largest] = (float)sqrt(rest > 0 ? rest : 0);
}
