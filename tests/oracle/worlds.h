/* Random scenes of the kinds that are hard for a solver: where splats swap in depth, colours meet their clamp, splats are faint
 * before black, fade by the taper, leap, rest and start. */
#ifndef TESTS_ORACLE_WORLDS_H
#define TESTS_ORACLE_WORLDS_H

#include "tests/oracle/scene.h"

int oracle_world_kinds(void);
const char *oracle_world_name(int kind);
/* The number of the kind called `name`; below 0 if there is none. */
int oracle_world_named(const char *name);
/* Makes the scene of a kind and a seed; `share` scales its image's width. To be freed by oracle_scene_free. */
oracle_scene oracle_world_make(int kind, unsigned long long seed, double share);

#endif
