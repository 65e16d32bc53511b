/* Internal to lib/scene: levels of detail of a scene, of which one is read: 0, the finest, to count - 1. */
#ifndef TD_LEVELS_H
#define TD_LEVELS_H

#include "tides/base.h"

#include <stdint.h>

typedef struct td_levels {
    int64_t level; /* the one that is read */
    int64_t count;
} td_levels;

/* Sets the level that scene.part names, 0 for NULL. TIDES_BAD_ARGUMENT if there is no such level. */
tides_status td_levels_choose(const char *path, const char *part, td_levels *levels, tides_error *error);

/* The error for a scene.part that names no level. */
tides_status td_levels_refuse(const char *path, const char *part, int64_t count, tides_error *error);

/* Notes which level is read, if there are several. */
tides_status td_levels_note(const td_levels *levels, char **notes, tides_error *error);

#endif
