/* Internal to lib/render: record paths in double precision, for points: which Gaussians have which nodes in the interval
 * swept last, their rows, and the curves between them. */
#ifndef TD_POINT_NODES_H
#define TD_POINT_NODES_H

#include "td_points.h"

/* Largest error of paths, in log_luminance: with L_dot = 20 /s it is 25 ns. */
#define TD_POINT_PATH_TARGET 5e-7

/* Largest error of paths of Gaussians that a motion model moves. Their rows may be in single precision, rounded to about 1e-5
 * px, so that a smaller error may be rounding. With 1e-5 here, p95 was 0.7 us in a scene whose samples in single precision
 * have 0.2 us (tests/property/test_motion_events.c). */
#define TD_POINT_PATH_MOVED 1e-6

/* The interval in which points are requested, or a part of it: candidate lists, begin and end. */
typedef struct td_point_span {
    const int *first, *list; /* as in td_candidates */
    double start, stop;      /* [s after the epoch] */
    double shortest;         /* least length of a part that is cut because paths bend [s] */
    uint64_t serial;         /* identifies the swept interval */
} td_point_span;

/* Length of an instant's only curve, of which only the beginning is used [s]: so short that nothing moves on it, and a power
 * of two, so that rates keep their bits. */
#define TD_POINT_INSTANT 0x1p-40

typedef struct td_point_nodes {
    td_exact *exact; /* its rows are valid until another user of the scene finds rows */
    int is_shared;   /* 1: it belongs to another td_point_nodes */
    td_view *kept;   /* (objects) views of a kept instant, which open paths may have forgotten; else NULL */
    double *knot;    /* (pieces + 1) ends of the pieces of the interval [s after the epoch] */
    int pieces;
    double *piece_length; /* (pieces) [s] */
    int *path;            /* (store.count) as in td_points_interval */
    int *gaussians;       /* (count) Gaussians in some list */
    int count;
    uint8_t *level; /* (count) 2^level curves per piece */
    int *open_at;   /* (count) for a level whose rows come from the previous level, except for open curves: */
    uint8_t *open;  /* from open[open_at[i]] on, 1 for each open curve of the previous level; -1: all rows are computed */
    int open_count;
    int *halve_from, *halve_to; /* (halves) first rows, in a level and in the next one */
    int halves;
    int *first; /* (count + TD_PAD) first rows */
    int rows;
    int *row;       /* (2 x curves) rows at which each curve begins and ends */
    double *length; /* (curves) [s] */
    int curves;
    double halve;       /* time at which the span must be cut into parts with their own rows; NAN: the rows are complete */
    uint8_t *is_direct; /* (count) 1: no curve follows the Gaussian, so points that may see it project all at their own time */
    int direct;         /* number of those */
    int moving, bent;   /* Gaussians that move; those with too large an error */
    int *tried;         /* (count + TD_PAD) first rows of a level, */
    td_points_fit fit;  /* and the errors of their cubics: (count + TD_PAD) */
    double *time;       /* of the nodes of a level */
    int *entry, *at;    /* (entries) Gaussians and rows of the jobs */
    td_node_job *jobs;
    int entries, job_count;
    size_t open_capacity, each_capacity, knot_capacity, piece_capacity, row_capacity, length_capacity, time_capacity,
        entry_capacity[2], job_capacity;
} td_point_nodes;

/* 1 for an instant, for which each Gaussian needs only one row. */
static inline int td_point_is_instant(const td_point_nodes *nodes) { return !(nodes->knot[0] < nodes->knot[nodes->pieces]); }

struct tides_renderer;
/* `shared`: the scene in double of another td_point_nodes, or NULL. */
tides_status td_point_nodes_create(const struct tides_renderer *renderer, td_exact *shared, td_point_nodes *nodes,
                                   tides_error *error);
void td_point_nodes_release(td_point_nodes *nodes);

/* Finds all rows; or sets `halve`, if there would be too many rows, or if paths bend more than all levels can follow. */
tides_status td_point_nodes_find(struct tides_renderer *renderer, const tides_trajectory *camera, td_points_engine *engine,
                                 const td_point_span *span, td_point_nodes *nodes, tides_error *error);

/* Computes the rows of the Gaussians of a level, at all nodes where they need computed ones. */
tides_status td_point_rows_project(struct tides_renderer *renderer, const tides_trajectory *camera, td_point_nodes *nodes,
                                   int level, tides_error *error);

/* Computes the first rows of Gaussians [end[k - 1], end[k]) at time[k], for each k below `slots`, whatever their level. */
tides_status td_point_rows_direct(struct tides_renderer *renderer, const tides_trajectory *camera, td_point_nodes *nodes,
                                  const double *time, const int *end, int slots, tides_error *error);

/* Number of slices of the interval, for tests of which splats a point may see. */
td_points_slices td_point_nodes_slices(const td_point_nodes *nodes);

#endif
