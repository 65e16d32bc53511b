/* Internal to lib/render: record paths in double precision for single pixels (points.c): which Gaussians have which nodes in
 * the interval swept last, their rows, and the curves between those. They are made for a group of Gaussians at a time. */
#ifndef TD_POINT_NODES_H
#define TD_POINT_NODES_H

#include "td_points.h"

/* Largest error of paths of Gaussians that a motion model moves. Their rows may be in single precision, rounded to about 1e-5
 * px, so that a smaller error may be rounding. With 1e-5 here, p95 was 0.7 us in a scene whose samples in single precision
 * have 0.2 us (tests/property/test_motion_events.c). */
#define TD_POINT_PATH_MOVED 1e-6

/* The interval in which points are requested, or a part of it: candidate lists, begin and end. */
typedef struct td_point_span {
    const int *first, *list; /* as td_candidates has them */
    const float *boxes;      /* (store.count x 4) what each Gaussian in a list touches */
    double start, stop;      /* [s after the epoch] */
    double shortest;         /* least length of a part that is cut because paths bend [s] */
    uint64_t serial;         /* identifies the swept interval */
} td_point_span;

/* Length of an instant's only curve, of which only the beginning is used [s]: so short that nothing moves on it, and a power
 * of two, so that rates keep their bits. */
#define TD_POINT_INSTANT 0x1p-40

/* The Gaussians whose paths are made together. Rows are places in the exact scene's memory. */
typedef struct td_path_group {
    int *gaussians; /* (count) in the store */
    int count;
    int *own;       /* (count) their paths */
    uint8_t *level; /* (count) 2^level curves a piece */
    int *open_at;   /* (count) place in `open` of a Gaussian that has rows of the level before; -1: all rows are its own */
    uint8_t *open;  /* for each curve of the level before: 1 if it must be halved */
    int open_count;
    int *halve_from, *halve_to; /* (halves) first rows, in a level and in the next one */
    int halves;
    int *first; /* (count + TD_PAD) first rows */
    int *kept;  /* (count) first rows of level 1, while a Gaussian whose curves fit there is tried once more; -1: others */
    int rows;
    int *row;       /* (2 x curves) the rows at the ends of each curve */
    double *length; /* (curves) [s] */
    int curves;
    uint8_t *is_direct; /* (count) 1: no curve follows it, so points that see it project all their splats at their own time */
    int *tried;         /* (count + TD_PAD) first rows of the level that is tried, */
    td_points_fit fit;  /* (count + TD_PAD) and how well its curves fit */
    size_t open_capacity, each_capacity, row_capacity, length_capacity;
} td_path_group;

/* The nodes of a level, for the backend. */
typedef struct td_path_jobs {
    double *time;    /* of the level's nodes [s after the epoch] */
    int *entry, *at; /* (entries) Gaussians and rows of the jobs */
    td_node_job *list;
    int entries, count;
    size_t time_capacity, entry_capacity[2], capacity;
} td_path_jobs;

typedef struct td_point_nodes {
    td_exact *exact; /* its rows are valid until another user of the scene finds rows */
    int is_shared;   /* 1: it belongs to another td_point_nodes */
    td_view *kept;   /* (objects) views of a kept instant, which open paths may have forgotten; else NULL */
    double *knot;    /* (pieces + 1) ends of the pieces of the interval [s after the epoch] */
    int pieces;
    int joints;           /* number of joints of motions within the interval */
    double place;         /* rounding of the camera's place in the interval [scene units] */
    double *piece_length; /* (pieces) [s] */
    int *path;            /* (store.count) first curve * TD_PATH_LEVELS + level; or TD_PATH_UNSEEN, ... */
    int *listed;          /* (listed_count) the Gaussians in a list, rising */
    int listed_count;
    int made;    /* number of Gaussians with paths */
    int curves;  /* of all that have paths */
    int *wanted; /* (wanted_count, at most listed_count) the next Gaussians to get paths, rising */
    int wanted_count;
    int group_size;  /* most Gaussians of a group */
    int sample_size; /* of a longer list, as many Gaussians decide the pieces of all */
    td_path_group group;
    td_path_jobs jobs;
    double halve; /* where to cut the span in two, each part with rows of its own [s after the epoch]; NAN: nowhere */
    int moving;   /* number of Gaussians that move, */
    int bent;     /* and of those whose paths have a larger error than allowed */
    size_t knot_capacity, piece_capacity;
} td_point_nodes;

/* 1 for an instant, for which each Gaussian needs only one row. */
static inline int td_point_is_instant(const td_point_nodes *nodes) { return !(nodes->knot[0] < nodes->knot[nodes->pieces]); }

struct tides_renderer;
/* `shared`: the scene in double of another td_point_nodes, or NULL. */
tides_status td_point_nodes_create(const struct tides_renderer *renderer, td_exact *shared, td_point_nodes *nodes,
                                   tides_error *error);
void td_point_nodes_release(td_point_nodes *nodes);

/* A Gaussian in a list that has no path yet; and one that is about to get it. */
enum { TD_PATH_UNMADE = -3, TD_PATH_WANTED = -4 };

/* Finds the Gaussians in lists, the pieces of their paths, and a first group with paths, which stands for all others. Short
 * lists are that group as a whole. Or it says where to cut: rows would be too many, or paths bend more than all levels can
 * follow. */
tides_status td_point_nodes_find(struct tides_renderer *renderer, const tides_trajectory *camera, td_points_engine *engine,
                                 const td_point_span *span, td_point_nodes *nodes, tides_error *error);

/* Makes the next of the wanted Gaussians the group, as many as are made together; each has a path then. */
tides_status td_point_nodes_next(struct tides_renderer *renderer, const tides_trajectory *camera, td_points_engine *engine,
                                 td_point_nodes *nodes, tides_error *error);

/* The group, for an engine. */
td_points_group td_point_nodes_group(const td_point_nodes *nodes);

/* Curves that an interval may come to have. */
int td_point_nodes_expected(const td_point_nodes *nodes);

/* Rows of the Gaussians of a level, at all its nodes that are theirs to have (point_rows.c). */
tides_status td_point_rows_project(struct tides_renderer *renderer, const tides_trajectory *camera, td_point_nodes *nodes,
                                   int level, tides_error *error);

/* Computes the first rows of Gaussians [end[k - 1], end[k]) at time[k], for each k below `slots`, whatever their level. */
tides_status td_point_rows_direct(struct tides_renderer *renderer, const tides_trajectory *camera, td_point_nodes *nodes,
                                  const double *time, const int *end, int slots, tides_error *error);

/* Number of slices of the interval, for tests of which splats a point may see. */
td_points_slices td_point_nodes_slices(const td_point_nodes *nodes);

#endif
