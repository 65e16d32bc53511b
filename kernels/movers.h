/* Which model moves an object. In kernels TD_BUILD_MODEL is the one model that is compiled; the reference has all of them. */
#ifndef TD_MOVERS_H
#define TD_MOVERS_H

#include "motion.h"

#ifdef TD_BUILD_MODEL
#define TD_HAS_MODEL(code) (TD_BUILD_MODEL == (code))
#else
#define TD_HAS_MODEL(code) 1
#endif

/* TD_LANES Gaussians of one object (numbers within the object) at a moment, to `sink`. `data` begins with the object's. */
TD_INLINE void td_move_group(TD_GLOBAL const td_mover *mover, TD_GLOBAL const td_real *data, TD_GLOBAL const td_real *moment,
                             td_index gaussian, const td_theta_sink *sink) {
    (void)mover, (void)data, (void)moment, (void)gaussian, (void)sink;
    /* one line per model: if (TD_HAS_MODEL(TD_MOTION_NAME) && mover->model == TD_MOTION_NAME) td_NAME_move(...) */
}

#endif
