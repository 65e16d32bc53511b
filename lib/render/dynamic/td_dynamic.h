/* Internal: Gaussians that move by themselves, as the renderer keeps them: who they are, and the rows that a backend is
 * asked to work out for them at the times of a sweep or of a batch of jobs. Compiled in double. */
#ifndef TD_MOVED_H
#define TD_MOVED_H

#include "motion/td_time_scale.h"
#include "render/td_backend.h"
#include "tides/scene.h"

/* An object of the store that moves by itself; as many as there are movers, in their order. */
typedef struct td_moved_part {
    int object;                /* in the store */
    int first, count;          /* its Gaussians there, without padding */
    int base;                  /* number of the first among all that move, padded like the store */
    int moves_sh, hosted;      /* rows have SH of their own; come from the host */
    int dear;                  /* the model costs more than interpolating between its rows */
    tides_object of;           /* the scene's object: motion, Gaussians, how long the motion lasts */
    double *knot_s, *knot_tau; /* (knots) in seconds after the epoch, ascending, and of its own time */
    size_t knots;
    td_time_scale *scale; /* (count) of its own time; NULL: the model says none for each Gaussian */
} td_moved_part;

/* Rows of all that move at one time, kept from one sweep to the next. */
typedef struct td_kept {
    double time;
    int side, is_there;
    int row; /* of the first */
} td_kept;

enum { TD_KEPT = 3 };

/* A td_move_batch being put together: entry i is row `row` + i. */
typedef struct td_moving_rows {
    int row, count;
    int *gaussians, *owners; /* (count), (2 x count) */
    size_t gaussian_capacity, owner_capacity;
    double *moments;
    int moment_count;
    size_t moment_capacity;
    td_move_job *jobs;
    int job_count;
    size_t job_capacity;
    double *cubics; /* (cubic_count x TD_CUBIC_REALS) */
    int cubic_count;
    size_t cubic_capacity;
    td_cubic_job *cubic_jobs;
    int cubic_job_count, interpolated; /* rows of these jobs */
    size_t cubic_job_capacity;
    int *kind_first; /* (kinds + 1) */
    td_host_rows *host;
    int host_runs, host_count;
    size_t host_capacity, host_row_capacity[4];
    double *host_row[4]; /* geometry, rates, sh, sh_rates of (host_count) rows */
} td_moving_rows;

/* Rows between which others are interpolated. */
typedef struct td_span {
    const td_kept *from, *to;
} td_span;

typedef struct td_moved {
    double epoch; /* [s] of the scene: times are offsets from it */
    int parts;
    td_moved_part *part;
    const td_store *store;
    int moving;    /* Gaussians, padded; 0: nothing moves by itself */
    double *knots; /* (knot_count) of all parts [s after the epoch], ascending, distinct by more than a nanosecond */
    size_t knot_count;
    td_kept kept[TD_KEPT];
    int kept_rows;   /* rows that are kept: TD_KEPT x moving, or 0 where that is too much */
    uint32_t *stamp; /* (moving) serial of the slot that last wanted the Gaussian */
    int *row_of;     /* (moving) its row there */
    uint32_t serial;
    int lowest, highest; /* that the slot wants */
    td_moving_rows rows;
    int *list; /* candidates of a launch */
    size_t list_capacity;
    uint64_t serial_of_list;
    double tolerance, time_tolerance_s; /* what interpolation may cost, of log_luminance and of times; 0, 0: there's none */
    td_span halves[2];                  /* of the interval swept last; NULL, NULL: nothing is interpolated there */
    float *misfit;                      /* (moving) there, in tolerances; only of dear parts */
    uint8_t *level;                     /* (moving) 2^level pieces that the interval swept last takes */
    int *fine;                          /* (moving) Gaussians of one level, and their boxes and travel */
    float *fine_box, *fine_travel;
} td_moved;

/* Finds what moves in the scene that `store`, which must outlive it, was made of. At most `row_limit` rows are kept. */
tides_status td_moved_create(const tides_scene *scene, const td_store *store, int row_limit, td_moved *moved,
                             tides_error *error);
void td_moved_release(td_moved *moved);

/* From now on times are offsets from `epoch` [s]; at first from 0. What was kept for other times is given up. */
void td_moved_set_epoch(td_moved *moved, double epoch);

/* The scales of time of a part's Gaussians, where the model has them for each. */
tides_status td_moved_find_scales(const td_store *store, td_moved_part *part, tides_error *error);

/* 1 where rates of some motion may jump at `time`, to a nanosecond. */
int td_moved_is_knot(const td_moved *moved, double time);

/* 1 where one is more than that behind `start` and before `stop`. */
int td_moved_knot_within(const td_moved *moved, double start, double stop);

/* -- rows (rows.c) -- */

/* Begins a batch of rows, the first of which is `row`. */
void td_rows_begin(td_moved *moved, int row);

/* Adds a Gaussian of a part, by its number in the store; its row is moved->rows.row + rows.count then. Room must be there. */
tides_status td_rows_reserve(td_moved *moved, int more, tides_error *error);
void td_rows_add(td_moved *moved, const td_moved_part *part, int gaussian);

/* Ends a run of Gaussians of one part that began at entry `first`: pads it and asks for it at `time`. */
tides_status td_rows_end_run(td_moved *moved, const td_moved_part *part, int first, double time, int side, tides_error *error);

/* The same for a Gaussian whose row is interpolated between two kept ones, and for a run of these. */
void td_rows_add_between(td_moved *moved, const td_moved_part *part, int gaussian);
tides_status td_rows_end_between(td_moved *moved, const td_moved_part *part, int first, const td_span *span, double time,
                                 tides_error *error);

/* Has the backend work out the batch. */
tides_status td_rows_send(td_moved *moved, td_backend *backend, tides_error *error);

/* -- interpolation (interpolate.c) -- */

/* From the next sweep on rows between those of its start, middle and end are interpolated where log_luminance is off by less
 * than `tolerance` and, where time_tolerance_s > 0, late by less than that. Only dear models' rows are, and only where rows of
 * all that moves can be kept. */
tides_status td_moved_interpolate(td_moved *moved, td_backend *backend, double tolerance, double time_tolerance_s,
                                  tides_error *error);

/* Misfits of the interval that begins, is halfway and ends with these rows. */
tides_status td_moved_measure(td_moved *moved, td_backend *backend, const double *views, const td_kept *const kept[3],
                              tides_error *error);

/* The half of the interval swept last that has `time` within; NULL where there's none. */
const td_span *td_moved_span(const td_moved *moved, double time);

/* td_cubic (interpolate.h) of `time` between `start` and `stop`. */
void td_cubic_weights(double start, double stop, double time, double weights[TD_CUBIC_REALS]);

/* -- sweeps (sweep_rows.c) -- */

/* Boxes and travel of all that moves over [start, stop], as td_backend_class.sweep gives them. At an instant, start = stop,
 * rates are those of `side`. */
tides_status td_moved_sweep(td_moved *moved, td_backend *backend, const double *views, const double *strays, double start,
                            double stop, int side, int row_limit, float *boxes, float *travel, tides_error *error);

#endif
