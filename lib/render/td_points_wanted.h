/* Internal to lib/render: which Gaussians points ask for, so that only these get paths (td_point_nodes.h), and which tiles'
 * lists lack what has got one since. */
#ifndef TD_POINTS_WANTED_H
#define TD_POINTS_WANTED_H

#include "td_point_nodes.h"
#include "td_render.h"

/* Pixels that may see a splat: columns [x0, x1) and rows [y0, y1) of the image. It is one rule for all: which splats get paths
 * because a pixel is asked about, which a point on curves sees, and which points are too near to a bent one. So a point's value
 * doesn't depend on what others have asked for. */
typedef struct td_sight {
    int x0, y0, x1, y1;
} td_sight;

td_sight td_sight_of(const td_image *image, const float *box);

typedef struct td_points_wanted {
    uint8_t *asked; /* (height x width) 1: all that the pixel may see in the interval has a path */
    uint16_t *rows; /* (tiles x TD_TILE) pixels that are asked about for the first time, a bit each, row by row */
    int *fresh;     /* (fresh_count) the tiles that have such */
    int fresh_count;
    int *listed; /* (tiles) 0: it has no list; else one more than the groups that had paths when that was made */
    int groups;
    int *sights;      /* of td_points_wanted_sights */
    uint8_t *touched; /* (candidates) 1 for those of fresh tiles' lists that such a pixel may see */
    size_t sight_capacity, touched_capacity;
} td_points_wanted;

tides_status td_points_wanted_create(const struct tides_renderer *renderer, td_points_wanted *wanted, tides_error *error);
void td_points_wanted_release(td_points_wanted *wanted);

/* Another interval: nobody has asked, no tile has a list. */
void td_points_wanted_clear(const struct tides_renderer *renderer, td_points_wanted *wanted);

/* Fills nodes->wanted with the Gaussians without a path that the points numbered which[0 .. count) may see. */
tides_status td_points_wanted_find(const struct tides_renderer *renderer, td_points_wanted *wanted, td_point_nodes *nodes,
                                   const td_point_span *span, const td_point *points, const int *which, int count,
                                   tides_error *error);

/* To be called when all of them have got their paths: older lists of these points' tiles are void, since they lack them. */
void td_points_wanted_found(td_points_wanted *wanted);

/* The pixels that may see a group's splats, for an engine: borrowed until the next. */
tides_status td_points_wanted_sights(const struct tides_renderer *renderer, td_points_wanted *wanted, const td_point_span *span,
                                     td_points_group *group, tides_error *error);

/* A list is asked for: 1 where the tile has none, which it has then. */
static inline int td_points_wanted_list(td_points_wanted *wanted, int tile) {
    const int lacks = wanted->listed[tile] == 0;
    if (lacks) wanted->listed[tile] = wanted->groups + 1;
    return lacks;
}

#endif
