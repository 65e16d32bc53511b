/* Writes a made world as a user would have it: path files, and a run file that names them. */
#ifndef CLI_SCENE_RUN_H
#define CLI_SCENE_RUN_H

#include "cli.h"

typedef struct scene_run {
    const char *scene_file, *camera_file;      /* as the run file should name them */
    const char *object_file, *trajectory_file; /* an object of its own; NULL: none */
    const char *seed;                          /* of the simulation; NULL: unsaid */
    const tides_world *world;
} scene_run;

/* The run file at `path`. */
tides_status scene_run_write(const char *path, const scene_run *run, tides_error *error);

#endif
