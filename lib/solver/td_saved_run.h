/* Internal: a run as checkpoints see it: the values by which it is known again, its arrays, and how it goes on. */
#ifndef TD_SAVED_RUN_H
#define TD_SAVED_RUN_H

#include "readout/td_arbiter.h"
#include "render/td_render.h"
#include "td_state.h"
#include "tides/simulate.h"

/* The values of a run that decide its events. All belong to the simulator. */
typedef struct td_saved_run {
    const tides_scene *scene;
    const tides_trajectory *camera;
    const tides_renderer *renderer;
    const tides_stepping *stepping; /* with open choices as the simulator settled them */
    const tides_sensor *sensor;
    uint64_t maps_checksum; /* of the sensor's file of maps; 0: there was none */
    uint64_t kick_checksum; /* of its file of frame times; 0: there was none */
    const tides_readout *readout;
    const tides_filters *filters;
    const tides_arbiter *arbiter; /* NULL: there is no readout */
    int width, height;
    double epoch, length; /* start and length [s] */
    int64_t steps;        /* of the grid */
} td_saved_run;
td_saved_run td_simulator_saved(const tides_simulator *simulator);

/* Time of grid point k [s after the run's start]. */
double td_simulator_grid_time(const tides_simulator *simulator, int64_t k);

/* Adds the arrays that a checkpoint holds: the simulator's and the sensor's. */
void td_simulator_state(tides_simulator *simulator, td_state *state);

/* Copies values of `size` bytes from an array of pixels in the simulator's order to an image, or into the array from it. */
enum { TD_TO_IMAGE, TD_FROM_IMAGE };
void td_simulator_copy_pixels(const tides_simulator *simulator, int direction, size_t size, void *values, void *image);

/* The rest of a saved state. */
typedef struct td_resumed {
    int64_t step;
    tides_event last;       /* given to the sink; polarity 0: none was */
    tides_stats totals;     /* counts until then */
    tides_arbiter *arbiter; /* NULL without a readout */
} td_resumed;

/* Goes on from a saved state, when its arrays are restored. The simulator's arbiter and the resumed one change places. */
void td_simulator_resume(tides_simulator *simulator, td_resumed *from);

/* Sets one of the statistics (counts and reals) to a number. */
void td_stat_set(tides_stats *stats, const tides_stat *row, double value);

#endif
