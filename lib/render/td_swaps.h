/* Internal to lib/render: swaps of depth. When two overlapping splats come within reach of each other's depth, the image
 * changes from one order to the other, or there and back. That may happen between two samples. With soft order, its length is
 * soft_depth times the depth, divided by the rate of the depths' difference. Its time follows from the motions, and steps are
 * cut there. */
#ifndef TD_SWAPS_H
#define TD_SWAPS_H

#include "camera/td_rotation.h"
#include "td_renderer.h"

#include <math.h>

/* Reach: splats are apart when less than exp(-TD_SWAP_REACH), 2 %, of the light they take is still shared. */
#define TD_SWAP_REACH 4.0

/* A smaller change of Y isn't counted as a swap. */
#define TD_SWAP_LEAST_LIGHT 1e-5

/* Swaps that take a larger share of the interval than this, to either side, are seen by its samples; of splats of one body
 * that is seen to turn evenly, and of those that motion models move, a larger one than the other where a tile has many.
 * Choices: demo's 50 ms took 15 % longer with 0.25, 7 with 0.1, 0 so; 30 ms of `tides scene crowd` with what moves 140 % with
 * 0.25, 25 % so. */
#define TD_SWAP_SLOW 0.25
#define TD_SWAP_SLOW_WITHIN 0.05

/* A splat that a motion model moves, at a sample: where it is in its object's units, and how fast it goes [1/s]. */
typedef struct td_swap_move {
    double mean[3], rate[3];
} td_swap_move;

/* The most that a splat takes of the light in each block of its tile, at a part of the interval (0: not known). */
typedef struct td_swap_taken {
    int32_t part;
    double share[TD_TILE_BLOCKS];
} td_swap_taken;

/* A Gaussian of a tile's list: its box, depths within the interval, and these and their rates at the samples (parts + 1). */
typedef struct td_swap_splat {
    const float *box;
    double least, most, sway; /* sway: half the distance by which a turn moves its depth against that of overlapping splats */
    const double *geometry;
    double opacity, luminance, varies; /* luminance in the middle of the interval, and how far it is from that elsewhere */
    int object, group, may;
    const td_swap_move *move; /* at the samples; NULL: it rests in its object */
    const double *z, *z_dot;
    td_swap_taken *taken;
} td_swap_splat;

/* Samples for the search: parts of the interval, and views at their ends (parts + 1 x objects). */
enum { TD_SWAP_PARTS_MOST = 64 };
typedef struct td_swap_samples {
    int parts, objects;
    double time[TD_SWAP_PARTS_MOST + 1]; /* (parts + 1) [s after the epoch] */
    const td_view *view;
} td_swap_samples;

/* Length of part k [s], and of all parts. */
static inline double td_swaps_length(const td_swap_samples *at, int k) { return at->time[k + 1] - at->time[k]; }
static inline double td_swaps_span(const td_swap_samples *at) { return at->time[at->parts] - at->time[0]; }

/* Swaps of a tile at one time that take about as long: the number of their sum in the list by block, below 0 where there is
 * none, and the blocks in which these change all that they may. */
typedef struct td_swap_sum {
    int32_t part;
    uint32_t length, whole;
    int32_t at[TD_TILE_BLOCKS];
} td_swap_sum;

/* A portion of the tiles, which one thread searches: its swaps, sorted by block, then time, and scratch of one tile. */
enum { TD_SWAP_SUMS = 64 };
typedef struct td_swap_portion {
    td_swap_sum sum[TD_SWAP_SUMS];
    td_swap *swap; /* (count) */
    size_t count, swap_capacity;
    int tiles_cut;               /* tiles whose pairs were too many: fainter splats were left out */
    td_swap_splat *splat;        /* of a tile */
    const td_swap_splat **order; /* these, sorted */
    double *depth;               /* their depths and rates */
    td_swap_taken *taken;
    size_t splat_capacity, order_capacity, depth_capacity, taken_capacity;
    tides_status status;
    tides_error error;
} td_swap_portion;

struct td_swaps {
    float *extent;   /* (store.count) half-axis of the visible ellipsoid, in the object's units */
    int *group;      /* (objects) number of its body; -1: its path isn't known, or its splats are bodies by themselves */
    double *turning; /* (objects) deviation of a unit's depth from a straight line in the interval, */
    double *turned;  /* (objects) and its change at the greatest rate */
    uint8_t *may;    /* (store.count) its possible partners: splats of other bodies, or also of its own */
    td_view *view;   /* (samples x objects) */
    size_t view_capacity;
    td_swap *swap; /* (count) sorted by block, then time */
    size_t count, swap_capacity;
    int some_may, some_fade;  /* 1: in this interval splats may swap, or fade at the near plane */
    int tiles_cut;            /* of all portions */
    int32_t *first;           /* (blocks + 1) */
    td_swap_portion *portion; /* (portions) */
    size_t portions;
    int32_t *mover;     /* (store.count) number of a splat among those that motion models move, or -1 */
    int moves, rest;    /* how many; how many of them keep their places */
    uint8_t *rests;     /* (moves) 1: it keeps its place in its object */
    td_swap_move *move; /* (moves x samples) */
    double *shape;      /* (moves x TD_GEOMETRY_STRIDE) in the middle; the largest opacity */
    size_t move_capacity, shape_capacity, rests_capacity;
    double *joint; /* where curves of motions are joined within the interval [s after the epoch] */
    size_t joint_capacity;
};

/* A tile whose pairs are checked, and the status so far. */
typedef struct td_swap_tile {
    const struct td_swaps *swaps;
    td_swap_portion *portion; /* that the tile is in */
    const td_image *image;
    const td_swap_samples *at;
    int tile, corner[2]; /* corner: its first pixel */
    float most_light;    /* of all that swaps at one time: the range of its splats' Y */
    double zero;         /* the place in its part at which the last pair met */
    size_t before;       /* swaps of the portion before this tile's */
    int is_full;         /* 1: there were more pairs than are checked */
    int is_cut;          /* 1: its fainter splats are left out for that */
    tides_status status;
    tides_error *error;
} td_swap_tile;

/* Possible partners of a splat in a swap. TD_MAY_SWAP: only splats of other bodies; TD_MAY_SLOWLY: in tiles with few splats
 * also of its own body; TD_MAY_SHORTLY: also of its own body, if the swap is short; TD_MAY_ALONE: also of its own body. */
enum { TD_MAY_NOT, TD_MAY_SWAP, TD_MAY_SLOWLY, TD_MAY_SHORTLY, TD_MAY_ALONE };

/* Extent of a splat in standard deviations of its ellipsoid: there, a splat of opacity 1 has alpha 1/255. */
#define TD_SWAPS_SIGMAS 3.4

/* Two splats that overlap in the image at equal depth have centres at most the sum of their extents apart, times this factor
 * off the axis. */
#define TD_SWAPS_ASKEW 1.5

/* Distance between two points, or two rows of views. */
static inline double td_swaps_apart(const double *a, const double *b) {
    const double way[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return td_length3(way);
}

/* Depth of a point in a view. */
static inline double td_swaps_depth(const td_view *view, const double *mean) {
    return view->r[6] * mean[0] + view->r[7] * mean[1] + view->r[8] * mean[2] + view->t[2];
}

/* 1 if a splat belongs to its object's body: one that rests there, though a motion model may change its light. */
static inline int td_swaps_is_of_body(const struct td_swaps *swaps, int object, int g) {
    return swaps->group[object] >= 0 && (swaps->mover[g] < 0 || swaps->rests[swaps->mover[g]]);
}

/* Half the distance, in its object's units, between a splat at depth z and a splat that shares a pixel with it at that
 * depth. */
static inline double td_swaps_reach(const tides_renderer *renderer, const struct td_swaps *swaps, int g, double z) {
    const td_image *image = &renderer->image;
    return TD_SWAPS_ASKEW * ((double)swaps->extent[g] + TD_SWAPS_SIGMAS * sqrt(image->dilation) * fabs(z) / image->fx);
}

/* Searches a tile, and adds its swaps and fades to the portion's (swap_tile.c). */
TIDES_MUST_CHECK tides_status td_swaps_look_in(const tides_renderer *renderer, const struct td_swaps *swaps,
                                               const td_swap_samples *at, int tile, td_swap_portion *portion);

/* Works out the splats that motion models move at the samples (swap_movers.c). */
TIDES_MUST_CHECK tides_status td_swaps_move(const tides_renderer *renderer, struct td_swaps *swaps, const td_swap_samples *at,
                                            tides_error *error);

/* td_swaps_sum: the sum of a tile with many swaps to which one at this time is added; NULL: it is listed by itself.
 * td_swaps_add adds it. What swaps at once is no matter of chance, so lights are added, up to all that splats of the tile may
 * change (swap_list.c). */
td_swap_sum *td_swaps_sum(const td_swap_tile *tile, int32_t part, float wide);
void td_swaps_add(td_swap_tile *tile, const td_swap *swap, td_swap_sum *sum);

/* Adds all swaps of two splats that take no more than this share to those of the tile's blocks (swap_pair.c). */
void td_swaps_look_at(td_swap_tile *tile, const td_swap_splat *a, const td_swap_splat *b, double slow);

/* td_swaps_is_fading: 1 if splat g fades at the near plane within the interval, by its depths at the start, the middle and the
 * end. td_swaps_some_fade: 1 if any does that no motion model moves; 0 through a lens, where places aren't computed.
 * td_swaps_look_at_fade adds to those of a tile's blocks when they see such a splat pass the taper of opacity. */
int td_swaps_is_fading(const tides_renderer *renderer, const td_swap_samples *at, int g);
int td_swaps_some_fade(const tides_renderer *renderer, const struct td_swaps *swaps, const td_swap_samples *at, int first,
                       int end);
void td_swaps_look_at_fade(td_swap_tile *tile, const td_swap_splat *a);

tides_status td_swaps_create(const td_store *store, int tiles, struct td_swaps **swaps, tides_error *error);
void td_swaps_destroy(struct td_swaps *swaps);

#endif
