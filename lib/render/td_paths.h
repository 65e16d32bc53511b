/* Internal to lib/render: record paths, the host's side (kernels/path.h has the arithmetic).
 *
 * A sweep of an interval is followed by the nodes of its paths: both ends, and what cuts it into 2, 4, 8 .. parts. Every
 * Gaussian of some tile's list gets as many as it needs: as many as its object's path asks for (td_stray.h has looked at all
 * its samples), and more while the cubic through neighbouring nodes and what was projected in the middle differ in what they
 * do to log_luminance. The nodes depend on the interval alone, so that every evaluation within it is of one image, whatever
 * asks for it and when. Compiled in double. */
#ifndef TD_RECORD_PATHS_H
#define TD_RECORD_PATHS_H

#include "td_backend.h"
#include "tides/trajectory.h"

typedef struct td_record_paths {
    int on;
    double tolerance, time_tolerance_s; /* what paths may be off by, of log_luminance and of times (0: not asked) */
    int there;                          /* 1: the interval swept last has paths */
    double start, stop;                 /* that interval [s after the epoch] */
    int *path_of;                       /* (gaussians of the store) layout.h */
    int row_count;
    uint64_t serial;  /* of path_of */
    int *direct;      /* (tiles) entries of its list that have no path */
    int direct_moves; /* 1: one of these moves by itself */
    double *cubics;   /* (slots x TD_PATH_LEVELS x TD_PATH_CUBIC) of the batch in hand, and its nodes */
    int *nodes;
    uint8_t *level; /* (gaussians) level that is wanted; while paths are being found */
    int *wanted;    /* those of a level */
    int *gaussians, *rows, *first;
    td_node_job *jobs;
    double *time;
    float *misfit;
    int job_count, entries;
    size_t direct_capacity, cubic_capacity, node_capacity, wanted_capacity, entry_capacity[2], first_capacity, job_capacity,
        time_capacity, misfit_capacity;
} td_record_paths;

void td_paths_release(td_record_paths *paths);

/* Node k of 2^level + 1 [s after the epoch]. */
double td_paths_node(const td_record_paths *paths, int level, int k);

/* Rows of a path of a level. */
static inline int td_paths_rows(int level) { return (1 << level) + 1; }

/* The nodes before these times, and the weights from there: paths->nodes and ->cubics. */
tides_status td_paths_moments(td_record_paths *paths, const double *times, int slots, tides_error *error);

#endif
