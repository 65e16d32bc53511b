/* Internal to lib/render: engines that compute points (single pixels at single times) in double precision. Two classes,
 * OpenCL and C, give the same bits. */
#ifndef TD_POINTS_ENGINE_H
#define TD_POINTS_ENGINE_H

#ifndef TD_REAL_DOUBLE
#define TD_REAL_DOUBLE
#endif
#include "kernels/layout.h"
#include "td_backend.h"
#include "td_exact.h"
#include "tides/device.h"

enum { TD_POINT_COLUMNS = 4 };

/* A tile's candidates, or the splats of its list; layout of td_point_tile in the kernels. */
typedef struct td_points_tile {
    int x, y, first, count;
} td_points_tile;

/* Points [first, first + count) of one tile; layout of td_point_chunk. */
typedef struct td_points_chunk {
    int tile, first, count;
} td_points_chunk;

/* How an interval is sliced for tests of splats against points; layout of td_point_slices. */
typedef struct td_points_slices {
    int pieces, count, split, group;
} td_points_slices;

/* An interval, in which nothing has a path yet. Everything is borrowed until the next one begins. */
typedef struct td_points_interval {
    int gaussians; /* of the store */
    int curves;    /* that are expected in all */
    td_points_slices slices;
    const int *candidates; /* (candidate_count) what tiles point into */
    int candidate_count;
    const td_points_tile *tiles; /* (tile_count) all tiles of the image */
    int tile_count;
} td_points_interval;

/* Gaussians that get paths. Nothing is borrowed beyond the call, but of `exact`, whose rows stay until it has others. */
typedef struct td_points_group {
    td_exact *exact; /* whose rows are wanted */
    int row_count;
    const int *row;        /* (2 x curves) the rows that each begins and ends with */
    const double *lengths; /* (curves) [s] */
    int first, curves;     /* the interval has `first` without these */
    const int *seen;       /* (seen_count) the Gaussians, */
    const int *path;       /* (seen_count) of each its first curve in the interval * TD_PATH_LEVELS + level, */
    const int *sights;     /* (2 x seen_count) and the pixels that may see it, as kernels/point_lists.h has them */
    int seen_count;
} td_points_group;

/* The backdrop: its luminance, or its red, green and blue where light isn't linear in these (td_point_backdrop). */
typedef struct td_points_backdrop {
    double first, first_dot, green, blue;
} td_points_backdrop;

static inline td_points_backdrop td_points_backdrop_of(const td_image *image, const td_backdrop *backdrop) {
    if (!image->is_coded) return (td_points_backdrop){backdrop->luminance, backdrop->luminance_dot, 0, 0};
    return (td_points_backdrop){backdrop->colour[0], backdrop->colour_dot[0], backdrop->colour[1], backdrop->colour[2]};
}

/* Points, tile by tile; TD_PAD numbers behind the end of each array must be readable. */
typedef struct td_points_batch {
    const double *column[TD_POINT_COLUMNS]; /* pixel centres x and y; place s in the curve; length h of the curve [s] */
    const int *piece;
    int count;
    const td_points_chunk *chunks;
    int chunk_count;
    td_points_backdrop backdrop;
} td_points_batch;

/* Points whose splats were projected at the points' own times, each to a row. */
typedef struct td_points_instants {
    td_exact *exact;     /* whose rows they are */
    const double *x, *y; /* (count) pixel centres */
    const int *end;      /* (count) point k has the rows from end[k - 1] up to end[k] */
    int count, most;     /* most: rows that a point has at most */
    td_points_backdrop backdrop;
} td_points_instants;

/* A request for misfits of a level's paths, given by their first rows (count; TD_PAD more must be readable). */
typedef struct td_points_misfits {
    td_exact *exact;
    int row_count; /* number of all rows */
    const int *first;
    int count, level;      /* level: at least 1 */
    const double *lengths; /* (pieces) [s] */
    int pieces;
    double target; /* allowed error of log_luminance */
    double place;  /* rounding of the camera's place [scene units], which no curve follows */
} td_points_misfits;

/* Misfits of the previous level's cubics: how far they miss the rows in their middles, in units of the target. worst: of each
 * path (count). each: of every curve, each[curve x count], or NULL. */
typedef struct td_points_fit {
    float *worst, *each;
} td_points_fit;

/* Curves of the previous level. */
static inline size_t td_points_tried(const td_points_misfits *request) {
    return (size_t)request->pieces << (request->level - 1);
}

typedef struct td_points_engine td_points_engine;

typedef struct td_points_class {
    tides_status (*misfits)(td_points_engine *engine, const td_points_misfits *request, const td_points_fit *fit,
                            tides_error *error);
    tides_status (*begin)(td_points_engine *engine, const td_points_interval *interval, tides_error *error);
    /* Curves, depths and tests of a group. */
    tides_status (*add)(td_points_engine *engine, const td_points_group *group, tides_error *error);
    /* Makes the lists of these tiles of the interval, of what has paths: (count). */
    tides_status (*lists)(td_points_engine *engine, const int *tiles, int count, tides_error *error);
    /* Computes values: (2 x count) L and L_dot, valid after `finish`. The batch isn't read after the call. Lists of its tiles
     * must be made before. */
    tides_status (*values)(td_points_engine *engine, const td_points_batch *batch, double *values, tides_error *error);
    tides_status (*finish)(td_points_engine *engine, tides_error *error);
    /* Computes values (2 x count) of points without curves, of which the interval knows nothing. No other values may be under
     * way. */
    tides_status (*instants)(td_points_engine *engine, const td_points_instants *points, double *values, tides_error *error);
    void (*destroy)(td_points_engine *engine);
} td_points_class;

struct td_points_engine {
    const td_points_class *type;
    int lanes;   /* largest number of points in a chunk */
    int goes_on; /* 1: values are computed while the host does other work, */
    double took; /* for so long, the last ones that were finished [s] */
};

/* Engines: on an OpenCL device with double precision (else TIDES_UNSUPPORTED), or in C on the host. */
tides_status td_points_create_opencl(tides_device *device, const td_image_numbers *image, td_points_engine **engine,
                                     tides_error *error);
tides_status td_points_create_twin(const td_image_numbers *image, td_points_engine **engine, tides_error *error);

#endif
