/* Writes the run file of a generated world. The caller writes the scene and path files that it names. */
#ifndef CLI_SCENE_RUN_H
#define CLI_SCENE_RUN_H

#include "cli.h"

typedef struct scene_run {
    const char *scene_file, *camera_file;      /* as the run file names them */
    const char *object_file, *trajectory_file; /* of a moving object; NULL: none */
    const char *seed;                          /* of the simulation; NULL: not written */
    const tides_world *world;
} scene_run;

/* Writes the run file to `path`. */
tides_status scene_run_write(const char *path, const scene_run *run, tides_error *error);

#endif
