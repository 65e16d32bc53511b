/* Strays: how far an object's path deviates from the cubic through an interval's ends. The host bounds them path by path
 * (lib/render/dynamic/stray.c); here they become errors on the screen.
 *
 * A view maps a point p of the object to R p + t. A sweep treats each entry of R and t as the cubic through both ends and
 * their rates. Where the path deviates in between, such as a vibration that begins and ends at rest, a point is off by |(dt
 * + dR origin) + dR (p - origin)|. That is at most position + rotation |p - origin|. */
#ifndef TD_STRAY_H
#define TD_STRAY_H

#include "projection.h"

/* Up to 4096 parts: for a step of 10 ms they are 2.4 us, about the shortest step. */
enum { TD_STRAY_LEVELS = 13 };

/* Bounds for an object, with the interval cut into 1, 2, 4 .. equal parts and a cubic for each. Reals only, 32 of them. */
typedef struct td_stray {
    td_real origin[3];                 /* in the object's coordinates */
    td_real position[TD_STRAY_LEVELS]; /* [scene units], camera coordinates */
    td_real rotation[TD_STRAY_LEVELS]; /* length of dR [1], which contains the object's scale */
    td_real padding[3];
} td_stray;

/* Lengths in the object's coordinates: the greatest of several rows of the same Gaussians. */
typedef struct td_reach {
    td_lanes mean;   /* distance of the mean from the stray's origin */
    td_lanes factor; /* length of the factor: no axis is longer */
} td_reach;

TD_INLINE td_reach td_reach_at(TD_GLOBAL const td_stray *stray, const td_source *source, td_index row) {
    td_index index = row * TD_GEOMETRY_STRIDE;
    td_lanes mean = td_splat(0.0f), factor = td_splat(0.0f);
    td_reach reach;
    for (int k = 0; k < 3; k++) {
        td_lanes x = td_gather(source->geometry, index + TD_G_MEAN + k) - stray->origin[k];
        mean = td_fma(x, x, mean);
    }
    for (int k = 0; k < 9; k++) {
        td_lanes m = td_gather(source->geometry, index + TD_G_FACTOR + k);
        factor = td_fma(m, m, factor);
    }
    reach.mean = td_sqrt(mean);
    reach.factor = td_sqrt(factor);
    return reach;
}

/* Greatest error of points of the Gaussians [scene units], out to `sigmas` standard deviations. */
TD_INLINE td_lanes td_stray_of(TD_GLOBAL const td_stray *stray, int level, const td_reach *reach, td_lanes sigmas) {
    return td_fma(td_fma(sigmas, reach->factor, reach->mean), stray->rotation[level], td_splat(stray->position[level]));
}

#endif
