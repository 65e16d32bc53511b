/* Internal to lib/render: dynamic Gaussians, those that a motion model moves within their object.
 *
 * A Gaussian at rest has one row of geometry in the store. A dynamic one has a row for each time that is needed: three for a
 * sweep, and one for each sample of a tile. Rows are computed by the backend's kernels, or on the host for callbacks. This
 * folder decides which rows are needed, computes them in few launches, caches rows that are needed again, and interpolates
 * between rows where a model is expensive. Objects that move as a whole, and the camera, need no rows. Compiled in double. */
#ifndef TD_DYNAMIC_H
#define TD_DYNAMIC_H

#include "motion/td_time_scale.h"
#include "render/td_backend.h"
#include "tides/scene.h"

/* An object of the store whose Gaussians a motion moves; there is one for each mover, in the same order. */
typedef struct td_dynamic_object {
    int in_store;              /* number in the store */
    int first, count;          /* its Gaussians in the store, without padding */
    int base;                  /* index of its first Gaussian among all that move, padded as in the store */
    int moves_sh, hosted;      /* rows have their own SH; rows come from the host */
    int expensive;             /* the model costs more than interpolating between two rows */
    tides_object of;           /* the scene's object: motion, Gaussians, duration */
    double *knot_s, *knot_tau; /* (knots) ascending, in seconds after the epoch, and in own time */
    size_t knots;
    td_time_scale *scale; /* (count) scale of each Gaussian, in own time; NULL: the model declares none */
} td_dynamic_object;

/* Rows of all dynamic Gaussians at one time, kept because the next sweep begins where this one ends. */
typedef struct td_row_cache {
    double time;
    int side, is_there;
    int row; /* number of the first row */
} td_row_cache;

enum { TD_ROW_CACHES = 3 }; /* start, middle and end of a sweep */

/* A td_move_batch that is being assembled: entry i is row `row` + i. */
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
    int cubic_job_count, interpolated; /* interpolated: number of rows of these jobs */
    size_t cubic_job_capacity;
    int *kind_first; /* (kinds + 1) */
    td_host_rows *host;
    int host_runs, host_count;
    size_t host_capacity, host_row_capacity[4];
    double *host_row[4]; /* geometry, rates, sh, sh_rates of (host_count) rows */
} td_dynamic_rows;

/* Two times, between whose rows others are interpolated. */
typedef struct td_span {
    const td_row_cache *from, *to;
} td_span;

typedef struct td_dynamic {
    double epoch; /* [s] all times are offsets from it */
    int objects;
    td_dynamic_object *object;
    const td_store *store;
    int gaussians; /* of all objects, padded; 0: no Gaussian moves by itself */
    double *knots; /* (knot_count) of all objects [s after the epoch], ascending, at least a nanosecond apart */
    size_t knot_count;
    td_row_cache cached[TD_ROW_CACHES];
    int cached_rows; /* TD_ROW_CACHES x gaussians; 0 if that is too much memory */
    uint32_t *stamp; /* (gaussians) serial number of the slot that last requested the Gaussian */
    int *row_of;     /* (gaussians) its row in that slot */
    uint32_t serial;
    int lowest, highest; /* range of Gaussians requested by the slot */
    td_dynamic_rows rows;
    int *list; /* candidate lists of a launch */
    size_t list_capacity;
    uint64_t serial_of_list;
    /* allowed errors of interpolation, of log_luminance and of times; 0, 0: no interpolation */
    double tolerance, time_tolerance_s;
    td_span halves[2]; /* of the interval swept last; NULL, NULL: no interpolation in it */
    float *misfit;     /* (gaussians) errors of interpolation in it, in tolerances; only of expensive models */
    uint8_t *level;    /* (gaussians) 2^level pieces for the interval swept last */
    int *fine;         /* (gaussians) scratch: Gaussians of one level, their boxes and travel */
    float *fine_box, *fine_travel;
} td_dynamic;

/* Finds the moving objects of a scene. `store` was made from the scene and must outlive this. At most `row_limit` rows are
 * cached. */
tides_status td_dynamic_create(const tides_scene *scene, const td_store *store, int row_limit, td_dynamic *dynamic,
                               tides_error *error);
void td_dynamic_release(td_dynamic *dynamic);

/* Sets the epoch [s] from which times count, 0 at first. It drops cached rows of other times. */
void td_dynamic_set_epoch(td_dynamic *dynamic, double epoch);

/* Finds the scales of time of an object's Gaussians, if the model has one for each. */
tides_status td_dynamic_find_scales(const td_store *store, td_dynamic_object *object, tides_error *error);

/* The object of a Gaussian of the store; NULL if the Gaussian doesn't move by itself. */
static inline const td_dynamic_object *td_dynamic_object_of(const td_dynamic *dynamic, int gaussian) {
    const int mover = dynamic->store->mover[dynamic->store->object[gaussian]];
    return mover < 0 ? NULL : &dynamic->object[mover];
}

/* 1 if some object's model is expensive. */
int td_dynamic_has_expensive(const td_dynamic *dynamic);

/* The highest level in the interval swept last: the shortest scale of time is 2^-level of it. */
int td_dynamic_finest(const td_dynamic *dynamic);

/* Converts an interval [s after the epoch] to an object's own time; `rate` (may be NULL) is own time per second. */
tides_status td_dynamic_own_times(const td_dynamic *dynamic, const td_dynamic_object *object, double start, double stop,
                                  double *from, double *to, double *rate, tides_error *error);

/* The shortest scale of time [s] that a motion declares in [start, stop]; INFINITY: none. */
tides_status td_dynamic_shortest(td_dynamic *dynamic, double start, double stop, double *shortest, tides_error *error);

/* 1 if the rates of some motion may jump at `time`, to a nanosecond. */
int td_dynamic_is_knot(const td_dynamic *dynamic, double time);

/* Appends the times in (start, stop) where curves of a motion are joined, object by object, to times[0 .. *count). */
tides_status td_dynamic_joints(const td_dynamic *dynamic, double start, double stop, double **times, int *count,
                               size_t *capacity, tides_error *error);

/* 1 if a knot lies within (start, stop), by more than a nanosecond. */
int td_dynamic_knot_within(const td_dynamic *dynamic, double start, double stop);

/* -- rows -- */

/* Begins a batch of rows, with number `row` for the first. */
void td_rows_begin(td_dynamic *dynamic, int row);

/* Adds a Gaussian of an object, by its number in the store, as row dynamic->rows.row + rows.count. td_rows_reserve makes
 * room. */
tides_status td_rows_reserve(td_dynamic *dynamic, int more, tides_error *error);
void td_rows_add(td_dynamic *dynamic, const td_dynamic_object *object, int gaussian);

/* Ends a run of an object's Gaussians, which began at entry `first`: pads it, and requests its rows at `time`. */
tides_status td_rows_end_run(td_dynamic *dynamic, const td_dynamic_object *object, int first, double time, int side,
                             tides_error *error);

/* As above, for Gaussians whose rows are interpolated between two cached rows. */
void td_rows_add_between(td_dynamic *dynamic, const td_dynamic_object *object, int gaussian);
tides_status td_rows_end_between(td_dynamic *dynamic, const td_dynamic_object *object, int first, const td_span *span,
                                 double time, tides_error *error);

/* Lets the backend compute the batch. */
tides_status td_rows_send(td_dynamic *dynamic, td_backend *backend, tides_error *error);

/* Requests rows of `count` Gaussians of the store, in order, at a time; call it for further times as needed. `rows` become
 * cached rows, or rows behind these that td_rows_send computes, valid until the next batch begins. A Gaussian that doesn't
 * move by itself has its own row. Each run of an object is padded to TD_PAD. */
void td_dynamic_rows_open(td_dynamic *dynamic);
tides_status td_dynamic_rows_ask(td_dynamic *dynamic, const int *gaussians, int count, double time, int side, int *rows,
                                 tides_error *error);

/* Opens a batch, asks for the rows of Gaussians at one time, and sends it. */
tides_status td_dynamic_rows_at(td_dynamic *dynamic, td_backend *backend, const int *gaussians, int count, double time,
                                int side, int *rows, tides_error *error);

/* The cached rows of a time, or NULL. If rates don't jump there, rows of either side are fine. */
td_row_cache *td_dynamic_find_cached(td_dynamic *dynamic, double time, int side);

/* -- interpolation -- */

/* Allows interpolation from the next sweep on, between rows of its start, middle and end. The error of log_luminance must be
 * below `tolerance` and, if time_tolerance_s > 0, that of times below this. Only rows of expensive models are interpolated,
 * and only if rows of all dynamic Gaussians fit into the cache. */
tides_status td_dynamic_interpolate(td_dynamic *dynamic, td_backend *backend, double tolerance, double time_tolerance_s,
                                    tides_error *error);

/* Measures the misfits of an interval, given its cached rows at start, middle and end. */
tides_status td_dynamic_measure(td_dynamic *dynamic, td_backend *backend, const double *views,
                                const td_row_cache *const cached[3], tides_error *error);

/* The half of the interval swept last that contains `time`; NULL: no interpolation there. */
const td_span *td_dynamic_span(const td_dynamic *dynamic, double time);

/* Weights of the cubic at `time` between `start` and `stop`. */
void td_cubic_weights(double start, double stop, double time, double weights[TD_CUBIC_REALS]);

/* -- sweeps -- */

/* An interval [start, stop] to sweep, and its results. At an instant, start = stop, rates are those after it. */
typedef struct td_dynamic_sweep {
    const double *views, *strays; /* of td_sweep_request */
    double start, stop;           /* [s after the epoch] */
    int row_limit;                /* rows per launch, unless they are cached */
    float *boxes, *travel;        /* (store.count x 4) and (store.count), results */
} td_dynamic_sweep;

/* Sets boxes and travel (in diameters) of all dynamic Gaussians. */
tides_status td_dynamic_sweep_rows(td_dynamic *dynamic, td_backend *backend, const td_dynamic_sweep *sweep, tides_error *error);

#endif
