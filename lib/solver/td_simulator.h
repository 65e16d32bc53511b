/* Internal: the simulator's state (simulator.c makes it, simulate.c advances it). */
#ifndef TD_SIMULATOR_H
#define TD_SIMULATOR_H

#include "render/td_render.h"
#include "td_estimate.h"
#include "td_grid.h"
#include "td_refine.h"

enum { TD_BATCH_STEPS = 16 }; /* steps per launch at most */

/* S and S_dot of every pixel at one time, tile by tile, each tile's pixels row by row. */
typedef struct td_sample {
    double *S, *S_dot; /* (pixels) */
} td_sample;

struct tides_simulator {
    tides_renderer *renderer;
    const tides_trajectory *camera;
    td_comparator comparator;
    double start, stop, step_s; /* [s] */
    td_grid grid;               /* where steps begin and end */
    int mode, local;            /* TIDES_STEPPING_*; each tile has its own steps */
    double min_step_s, tolerance, time_tolerance_s, budget;
    tides_risk risk;
    int slope;         /* TIDES_SLOPE_* */
    int outputs;       /* planes that each sample renders: risk wants diagnostics */
    double *tile_risk; /* (tiles) at the time reached */
    td_refine refine;  /* TIDES_STEPPING_ERROR */
    td_timing timing;  /* likewise: estimated errors of event times */
    int broken;        /* a step failed half way: the pixels no longer agree on the time */
    int64_t steps;     /* of the whole run */
    int64_t step;      /* steps taken */
    int started;       /* the first sample is there */
    int width, tiles;
    td_tile *tile;       /* (tiles) */
    size_t *first_pixel; /* (tiles + 1): where a tile's pixels begin in the arrays below */
    td_pixels pixels;
    td_sample now, next;    /* at the step's two ends */
    int batch, batch_limit; /* steps per launch: now, and at most */
    td_request *requests;   /* (batch_limit x tiles) */
    int *moving;            /* (tiles) those that can change in the interval swept last, */
    int moving_count;       /* so many of them */
    double *planes;         /* (batch_limit x tiles x TD_OUT_SIGNAL x TD_TILE_PIXELS) */
    td_event_buffer events; /* of the packet */
    tides_event *scratch;   /* for sorting */
    size_t scratch_capacity;
    td_comparator_counts counts;
    tides_stats stats; /* times and steps; the rest is put together when asked for */
};

/* 1 where the device computes in double precision (checkpoint_facts.c). */
int td_is_double(const tides_device *device);

/* Lists the tiles that can change in the interval that was swept last; all of them where tiles don't go their own ways. */
void td_list_moving(tides_simulator *simulator);

/* Largest risk score of a tile's pixels, from planes of TD_OUT_DIAGNOSTICS. */
double td_tile_risk(const tides_simulator *simulator, const td_tile *tile, const double *planes);

/* TIDES_SLOPE_DIFFERENCE: replaces the slopes at the end of the step of h seconds that is about to be compared, and at the
 * run's start (slope.c). */
void td_difference_slopes(tides_simulator *simulator, double h);

/* S and S_dot of a rendered tile, whose planes are kept block by block, as rows of the tile's pixels. */
static inline void td_unpack_tile(const td_tile *tile, const double *planes, double *S, double *S_dot) {
    for (int y = 0, i = 0; i < tile->count; y++)
        for (int x = 0; x < tile->width; x++, i++) {
            int at = td_tile_pixel(x, y);
            S[i] = planes[TD_OUT_L * TD_TILE_PIXELS + at];
            S_dot[i] = planes[TD_OUT_L_DOT * TD_TILE_PIXELS + at];
        }
}

/* Time of grid point k [s]; the last one is `stop`. */
static inline double td_grid_time(const tides_simulator *simulator, int64_t k) { return td_grid_at(&simulator->grid, k); }

/* At a knot of some motion, where a step begins: the S_dot of the tiles that move (td_list_moving) becomes that of what begins
 * there. The interval is swept already. */
tides_status td_turn_knot(tides_simulator *simulator, tides_error *error);

#endif
