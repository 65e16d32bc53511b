/* Test support: seeded random scenes that are difficult for estimates of timing errors. Signals graze a level, peaks end just
 * short of one or just beyond, and drifts are so slow that a small error is a long time. Ordinary scenes are among them. */
#ifndef TESTS_SUPPORT_GRAZING_WORLD_H
#define TESTS_SUPPORT_GRAZING_WORLD_H

#include "tests/support/judged_run.h"

/* How many kinds there are; seed % kinds is the kind of a scene. Its name says both. */
int grazing_world_kinds(void);
judged grazing_world_make(uint64_t seed);

#endif
