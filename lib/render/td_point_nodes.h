/* Internal to lib/render: record paths in double precision for single pixels (points.c): which Gaussians have which nodes in
 * the interval swept last, their rows, and the curves between those. */
#ifndef TD_POINT_NODES_H
#define TD_POINT_NODES_H

#include "td_points.h"

/* Error that paths may have, in log_luminance, at most: at L_dot = 20 /s it is 25 ns. */
#define TD_POINT_PATH_TARGET 5e-7

/* Error that paths may have where a motion model moves the Gaussian. Its rows may be in single precision, rounded to some 1e-5
 * px: a misfit of sixteen times this isn't all rounding. With 1e-5, p95 was 0.7 us in a scene whose samples in single precision
 * alone have 0.2 us (tests/property/test_motion_events.c). */
#define TD_POINT_PATH_MOVED 1e-6

/* The interval in which points are asked for: the lists of a swept interval, and its ends, or the ends of a part of it. */
typedef struct td_point_span {
    const int *first, *list; /* as td_candidates has them */
    double start, stop;      /* [s after the epoch] */
    double shortest;         /* no part is shorter because paths bend [s] */
    uint64_t serial;         /* tells it from others */
} td_point_span;

/* How long the one curve of an instant is, of which but the beginning is asked for [s]: so short that nothing moves on it, and
 * a power of two, so that rates are what they were. */
#define TD_POINT_INSTANT 0x1p-40

typedef struct td_point_nodes {
    td_exact *exact; /* whose rows are its own until the next that share it are found */
    int is_shared;   /* it is another's */
    td_view *kept;   /* (objects) views of an instant that is kept, whose paths may have forgotten it; else NULL */
    double *knot;    /* (pieces + 1) where the pieces of the interval begin and end [s after the epoch] */
    int pieces;
    double *piece_length; /* (pieces) [s] */
    int *path;            /* (store.count) as td_points_interval has it */
    int *gaussians;       /* (count) those in a list */
    int count;
    uint8_t *level; /* (count) 2^level curves a piece */
    int *open_at;   /* (count) of those that have a level's rows from the one before, but for what was open: */
    uint8_t *open;  /* from open[open_at[i]] on, each curve of the level before that; -1: all rows are their own */
    int open_count;
    int *halve_from, *halve_to; /* (halves) first rows, of a level and of the next */
    int halves;
    int *first; /* (count + TD_PAD) first rows */
    int rows;
    int *row;       /* (2 x curves) the rows that each begins and ends with */
    double *length; /* (curves) [s] */
    int curves;
    double halve;       /* where the span is to be cut in two, each part with rows of its own; NAN: it has its rows */
    uint8_t *is_direct; /* (count) 1: no curve follows it, and who may see it has all projected (points_direct.c); */
    int direct;         /* so many */
    int moving, bent;   /* those that move; of which paths are off by more than they should */
    int *tried;         /* (count + TD_PAD) first rows of a level's, */
    td_points_fit fit;  /* and how well they do: (count + TD_PAD) */
    double *time;       /* of a level's nodes */
    int *entry, *at;    /* (entries) Gaussians, and rows, of the jobs */
    td_node_job *jobs;
    int entries, job_count;
    size_t open_capacity, each_capacity, knot_capacity, piece_capacity, row_capacity, length_capacity, time_capacity,
        entry_capacity[2], job_capacity;
} td_point_nodes;

/* 1 for an instant, where one row of each Gaussian is enough. */
static inline int td_point_is_instant(const td_point_nodes *nodes) { return !(nodes->knot[0] < nodes->knot[nodes->pieces]); }

struct tides_renderer;
/* `shared`: another's scene in double, or NULL. */
tides_status td_point_nodes_create(const struct tides_renderer *renderer, td_exact *shared, td_point_nodes *nodes,
                                   tides_error *error);
void td_point_nodes_release(td_point_nodes *nodes);

/* All of them, or where to cut: rows would be too many, or paths bend more than all levels can follow. */
tides_status td_point_nodes_find(struct tides_renderer *renderer, const tides_trajectory *camera, td_points_engine *engine,
                                 const td_point_span *span, td_point_nodes *nodes, tides_error *error);

/* Rows of the Gaussians of a level, at all its nodes that are theirs to have (point_rows.c). */
tides_status td_point_rows_project(struct tides_renderer *renderer, const tides_trajectory *camera, td_point_nodes *nodes,
                                   int level, tides_error *error);

/* Rows of Gaussians [end[k - 1], end[k]) at time[k], for k below `slots`: their first, whatever their level. */
tides_status td_point_rows_direct(struct tides_renderer *renderer, const tides_trajectory *camera, td_point_nodes *nodes,
                                  const double *time, const int *end, int slots, tides_error *error);

/* How many slices their interval has, for tests (kernels/point_tests.h). */
td_points_slices td_point_nodes_slices(const td_point_nodes *nodes);

#endif
