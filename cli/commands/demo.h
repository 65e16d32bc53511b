/* The files of the demo's world. */
#ifndef CLI_DEMO_H
#define CLI_DEMO_H

#include "cli.h"

/* Writes room.h5, fan.ply, fan.json, camera.json and run.json below `directory`. */
tides_status demo_scene_write(const char *directory, tides_error *error);

#endif
