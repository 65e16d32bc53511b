/* Test support: a motion by a callback whose parameters are sums of sines, with exact rates. */
#ifndef TESTS_SUPPORT_PULSING_CALLBACK_H
#define TESTS_SUPPORT_PULSING_CALLBACK_H

#include "tests/support/splat_world.h"

/* `p` must outlive the motion. time_scale as in tides_callback_motion [s]. */
tides_motion *pulsing_callback(const splat_set *set, const pulsing *p, double duration_s, double time_scale);

#endif
