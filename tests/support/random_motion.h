/* Test support: seeded random motions, each with the Gaussians that it moves. A kind is a motion model with certain options;
 * the models are polynomials, rotors and keyframes. Errors fail the running cmocka test. */
#ifndef TESTS_SUPPORT_RANDOM_MOTION_H
#define TESTS_SUPPORT_RANDOM_MOTION_H

#include "motion/td_motion.h"

/* Gaussians of each motion, frames of the keyframes, and the kind that is a polynomial with a decoder of colours. */
enum { RANDOM_MOTION_GAUSSIANS = 48, RANDOM_MOTION_FRAMES = 7, RANDOM_MOTION_DECODER = 0 };

typedef struct random_motion {
    const char *name;
    tides_gaussians gaussians; /* arrays owned */
    tides_motion *motion;
} random_motion;

/* Number of kinds; `kind` below counts from 0. */
int random_motion_kinds(void);
random_motion random_motion_make(int kind, uint64_t seed);
void random_motion_free(random_motion *made);

#endif
