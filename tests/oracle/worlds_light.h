/* Kinds of random scenes whose light changes, or is faint. */
#ifndef TESTS_ORACLE_WORLDS_LIGHT_H
#define TESTS_ORACLE_WORLDS_LIGHT_H

#include "tests/oracle/parts.h"

void oracle_lamp(oracle_scene *scene, parts_seed *seed);
void oracle_lamps(oracle_scene *scene, parts_seed *seed);
void oracle_lights(oracle_scene *scene, parts_seed *seed);
void oracle_faint(oracle_scene *scene, parts_seed *seed);
void oracle_veil(oracle_scene *scene, parts_seed *seed);
void oracle_few(oracle_scene *scene, parts_seed *seed);
void oracle_fade(oracle_scene *scene, parts_seed *seed);
void oracle_stops(oracle_scene *scene, parts_seed *seed);
void oracle_taper(oracle_scene *scene, parts_seed *seed);

#endif
