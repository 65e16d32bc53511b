/* A bell in time: the opacity of several motion models rises and falls by it. */
#ifndef TD_MOTION_BELL_H
#define TD_MOTION_BELL_H

#include "motion.h"

/* exp(-(dt narrowness)^2). Its exponent is held at -80, where the bell is invisible; below, single precision would
 * underflow. */
TD_INLINE td_dual td_motion_bell(td_dual dt, td_lanes narrowness) {
    td_dual x = td_dual_make(dt.v * narrowness, dt.d * narrowness);
    td_dual power = td_dual_clamp(td_dual_mul(x, x), -1, 80);
    return td_dual_exp(td_dual_negate(power));
}

#endif
