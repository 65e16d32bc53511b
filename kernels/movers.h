/* Calls the motion model of an object. An OpenCL program contains one model, TD_BUILD_MODEL; the reference contains all. */
#ifndef TD_MOVERS_H
#define TD_MOVERS_H

#include "motion.h"
#include "motion_hexplane.h"
#include "motion_keyframes.h"
#include "motion_network.h"
#include "motion_polynomial.h"
#include "motion_rotor.h"

#ifdef TD_BUILD_MODEL
#define TD_HAS_MODEL(code) (TD_BUILD_MODEL == (code))
#else
#define TD_HAS_MODEL(code) 1
#endif

/* TD_LANES Gaussians of one object at a moment, to `sink`. `gaussian` counts within the object, whose numbers begin at
 * `data`. */
TD_INLINE void td_move_group(TD_GLOBAL const td_mover *mover, TD_GLOBAL const td_real *data, TD_GLOBAL const td_real *moment,
                             td_index gaussian, const td_theta_sink *sink) {
    if (TD_HAS_MODEL(TD_MOTION_POLYNOMIAL) && mover->model == TD_MOTION_POLYNOMIAL)
        td_polynomial_move(mover, data, moment, gaussian, sink);
    if (TD_HAS_MODEL(TD_MOTION_ROTOR) && mover->model == TD_MOTION_ROTOR) td_rotor_move(mover, data, moment, gaussian, sink);
    if (TD_HAS_MODEL(TD_MOTION_KEYFRAMES) && mover->model == TD_MOTION_KEYFRAMES)
        td_keyframes_move(mover, data, moment, gaussian, sink);
    if (TD_HAS_MODEL(TD_MOTION_HEXPLANE) && mover->model == TD_MOTION_HEXPLANE)
        td_hexplane_move(mover, data, moment, gaussian, sink);
    if (TD_HAS_MODEL(TD_MOTION_NETWORK) && mover->model == TD_MOTION_NETWORK)
        td_network_move(mover, data, moment, gaussian, sink);
}

#endif
