/* Internal to lib/render: dynamic Gaussians, those that a motion model moves within their object.
 *
 * A Gaussian at rest has one row of geometry in the store, for good; a dynamic one is elsewhere at each time, so that a row of
 * it is worked out (by the backend's kernels, or on the host for callbacks) for each time that something asks for: three for a
 * sweep, one for each sample of a tile. This folder decides which rows those are, has them worked out in as few launches as it
 * can, keeps what is asked for again, and interpolates between rows where a model is expensive. The cost of a row is the
 * backend's, and a model's arithmetic is lib/motion's. Objects that move as a whole, and the camera, need no rows. Compiled in
 * double. */
#ifndef TD_DYNAMIC_H
#define TD_DYNAMIC_H

#include "motion/td_time_scale.h"
#include "render/td_backend.h"
#include "tides/scene.h"

/* An object of the store whose Gaussians a motion moves; as many as there are movers, in their order. */
typedef struct td_dynamic_object {
    int in_store;              /* the object's number there */
    int first, count;          /* its Gaussians there, without padding */
    int base;                  /* number of the first among all that move, padded like the store */
    int moves_sh, hosted;      /* rows have SH of their own; come from the host */
    int expensive;             /* the model costs more than interpolating between its rows */
    tides_object of;           /* the scene's object: motion, Gaussians, how long the motion lasts */
    double *knot_s, *knot_tau; /* (knots) in seconds after the epoch, ascending, and of its own time */
    size_t knots;
    td_time_scale *scale; /* (count) of its own time; NULL: the model says none for each Gaussian */
} td_dynamic_object;

/* Rows of all dynamic Gaussians at one time: the next sweep begins where this one ended. */
typedef struct td_row_cache {
    double time;
    int side, is_there;
    int row; /* of the first */
} td_row_cache;

enum { TD_ROW_CACHES = 3 }; /* start, middle and end of a sweep */

/* A td_move_batch being put together: entry i is row `row` + i. */
typedef struct td_dynamic_rows {
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
} td_dynamic_rows;

/* Two times between whose rows others are interpolated. */
typedef struct td_span {
    const td_row_cache *from, *to;
} td_span;

typedef struct td_dynamic {
    double epoch; /* [s] of the scene: times are offsets from it */
    int objects;
    td_dynamic_object *object;
    const td_store *store;
    int gaussians; /* of all objects, padded; 0: nothing moves by itself */
    double *knots; /* (knot_count) of all objects [s after the epoch], ascending, distinct by more than a nanosecond */
    size_t knot_count;
    td_row_cache cached[TD_ROW_CACHES];
    int cached_rows; /* TD_ROW_CACHES x gaussians, or 0 where that is too much */
    uint32_t *stamp; /* (gaussians) serial of the slot that last wanted the Gaussian */
    int *row_of;     /* (gaussians) its row there */
    uint32_t serial;
    int lowest, highest; /* that the slot wants */
    td_dynamic_rows rows;
    int *list; /* candidates of a launch */
    size_t list_capacity;
    uint64_t serial_of_list;
    double tolerance, time_tolerance_s; /* what interpolation may cost, of log_luminance and of times; 0, 0: there's none */
    td_span halves[2];                  /* of the interval swept last; NULL, NULL: nothing is interpolated there */
    float *misfit;                      /* (gaussians) there, in tolerances; only of expensive objects */
    uint8_t *level;                     /* (gaussians) 2^level pieces that the interval swept last takes */
    int *fine;                          /* (gaussians) Gaussians of one level, and their boxes and travel */
    float *fine_box, *fine_travel;
} td_dynamic;

/* Finds what moves in the scene that `store`, which must outlive it, was made of. At most `row_limit` rows are cached. */
tides_status td_dynamic_create(const tides_scene *scene, const td_store *store, int row_limit, td_dynamic *dynamic,
                               tides_error *error);
void td_dynamic_release(td_dynamic *dynamic);

/* From now on times are offsets from `epoch` [s]; at first from 0. Rows cached for other times are given up. */
void td_dynamic_set_epoch(td_dynamic *dynamic, double epoch);

/* The scales of time of an object's Gaussians, where the model has them for each. */
tides_status td_dynamic_find_scales(const td_store *store, td_dynamic_object *object, tides_error *error);

/* The object that a Gaussian of the store belongs to; NULL where it doesn't move by itself. */
static inline const td_dynamic_object *td_dynamic_object_of(const td_dynamic *dynamic, int gaussian) {
    const int mover = dynamic->store->mover[dynamic->store->object[gaussian]];
    return mover < 0 ? NULL : &dynamic->object[mover];
}

/* 1 where some object's model is expensive. */
int td_dynamic_has_expensive(const td_dynamic *dynamic);

/* The highest level of all that moves in the interval swept last: its motion happens on 2^-level of that. */
int td_dynamic_finest(const td_dynamic *dynamic);

/* An interval [s after the epoch] in an object's own time, and how fast that runs [1/s] (nullable). */
tides_status td_dynamic_own_times(const td_dynamic *dynamic, const td_dynamic_object *object, double start, double stop,
                                  double *from, double *to, double *rate, tides_error *error);

/* The shortest scale of time [s] on which some motion says that something may happen in [start, stop]; INFINITY: none. */
tides_status td_dynamic_shortest(td_dynamic *dynamic, double start, double stop, double *shortest, tides_error *error);

/* 1 where rates of some motion may jump at `time`, to a nanosecond. */
int td_dynamic_is_knot(const td_dynamic *dynamic, double time);

/* Times in (start, stop) where some motion's curves are joined (td_motion_class.joints), object by object: adds them to times
 * [0 .. *count), which grow. */
tides_status td_dynamic_joints(const td_dynamic *dynamic, double start, double stop, double **times, int *count,
                               size_t *capacity, tides_error *error);

/* 1 where one is more than that behind `start` and before `stop`. */
int td_dynamic_knot_within(const td_dynamic *dynamic, double start, double stop);

/* -- rows (rows.c) -- */

/* Begins a batch of rows, the first of which is `row`. */
void td_rows_begin(td_dynamic *dynamic, int row);

/* Adds a Gaussian of an object, by its number in the store; its row is dynamic->rows.row + rows.count then. Room must be
 * there. */
tides_status td_rows_reserve(td_dynamic *dynamic, int more, tides_error *error);
void td_rows_add(td_dynamic *dynamic, const td_dynamic_object *object, int gaussian);

/* Ends a run of Gaussians of one object that began at entry `first`: pads it and asks for it at `time`. */
tides_status td_rows_end_run(td_dynamic *dynamic, const td_dynamic_object *object, int first, double time, int side,
                             tides_error *error);

/* Like td_rows_add and td_rows_end_run, for Gaussians whose rows are interpolated between two cached ones. */
void td_rows_add_between(td_dynamic *dynamic, const td_dynamic_object *object, int gaussian);
tides_status td_rows_end_between(td_dynamic *dynamic, const td_dynamic_object *object, int first, const td_span *span,
                                 double time, tides_error *error);

/* Has the backend work out the batch. */
tides_status td_rows_send(td_dynamic *dynamic, td_backend *backend, tides_error *error);

/* Rows of `count` Gaussians of the store, in order, at a time, and then at others (rows_at.c): those cached by the sweep, or
 * dynamic->rows.count behind these that td_rows_send works out, until the next batch begins; what doesn't move by itself is its
 * own row. Each run of an object is padded to TD_PAD. */
void td_dynamic_rows_open(td_dynamic *dynamic);
tides_status td_dynamic_rows_ask(td_dynamic *dynamic, const int *gaussians, int count, double time, int side, int *rows,
                                 tides_error *error);

/* Opens a batch, asks for the rows of Gaussians at one time, and sends it. */
tides_status td_dynamic_rows_at(td_dynamic *dynamic, td_backend *backend, const int *gaussians, int count, double time,
                                int side, int *rows, tides_error *error);

/* The rows cached for a time, or NULL. Where rates don't jump either side will do (sweep_rows.c). */
td_row_cache *td_dynamic_find_cached(td_dynamic *dynamic, double time, int side);

/* -- interpolation (interpolate.c) -- */

/* From the next sweep on rows between those of its start, middle and end are interpolated where log_luminance is off by less
 * than `tolerance` and, where time_tolerance_s > 0, late by less than that. Only expensive models' rows are, and only where
 * rows of all dynamic Gaussians can be cached. */
tides_status td_dynamic_interpolate(td_dynamic *dynamic, td_backend *backend, double tolerance, double time_tolerance_s,
                                    tides_error *error);

/* Misfits of the interval that begins, is halfway and ends with these rows. */
tides_status td_dynamic_measure(td_dynamic *dynamic, td_backend *backend, const double *views,
                                const td_row_cache *const cached[3], tides_error *error);

/* The half of the interval swept last that has `time` within; NULL where there's none. */
const td_span *td_dynamic_span(const td_dynamic *dynamic, double time);

/* td_cubic (interpolate.h) of `time` between `start` and `stop`. */
void td_cubic_weights(double start, double stop, double time, double weights[TD_CUBIC_REALS]);

/* -- sweeps (sweep_rows.c) -- */

/* An interval [start, stop] to sweep, and where its results go. At an instant, start = stop, rates are those of what begins
 * there. */
typedef struct td_dynamic_sweep {
    const double *views, *strays; /* of td_sweep_request */
    double start, stop;           /* [s after the epoch] */
    int row_limit;                /* rows per launch, where they aren't cached */
    float *boxes, *travel;        /* (store.count x 4) and (store.count), results */
} td_dynamic_sweep;

/* Boxes and travel of all that moves. */
tides_status td_dynamic_sweep_rows(td_dynamic *dynamic, td_backend *backend, const td_dynamic_sweep *sweep, tides_error *error);

#endif
