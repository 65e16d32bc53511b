/* Test support: seeded random motions of every model, with the Gaussians that they are for. Errors fail the running cmocka
 * test. */
#ifndef TESTS_SUPPORT_RANDOM_MOTION_H
#define TESTS_SUPPORT_RANDOM_MOTION_H

#include "motion/td_motion.h"

enum { RANDOM_MOTION_GAUSSIANS = 48, RANDOM_MOTION_FRAMES = 7, RANDOM_MOTION_DECODER = 0 };

typedef struct random_motion {
    const char *name;
    tides_gaussians gaussians; /* arrays owned */
    tides_motion *motion;
} random_motion;

/* Number of kinds. */
int random_motion_kinds(void);
random_motion random_motion_make(int kind, uint64_t seed);
void random_motion_free(random_motion *made);

#endif
