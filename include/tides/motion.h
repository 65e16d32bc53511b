/* How the Gaussians of an object move by themselves: the motion models that dynamic splatting methods train.
 *
 * A motion belongs to one set of Gaussians (its canonical, raw parameters) and gives their parameters and exact rates at any
 * time of its own clock, [start, stop], in whatever unit the method used. */
#ifndef TIDES_MOTION_H
#define TIDES_MOTION_H

#include "tides/base.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct tides_motion tides_motion;

/* NULL is fine. A motion that a scene took over isn't the caller's any more. */
TIDES_API void tides_motion_destroy(tides_motion *motion);

/* "polynomial", "rotor", "keyframes", "hexplane", "network", "callback"; static storage. */
TIDES_API const char *tides_motion_model(const tides_motion *motion);

/* First and last time of its own clock. */
TIDES_API void tides_motion_range(const tides_motion *motion, double *start, double *stop);

#ifdef __cplusplus
}
#endif
#endif
