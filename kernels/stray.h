/* How far an object's path strays from the cubic that a sweep takes it for: the bounds that the host finds, path by path
 * (lib/render/dynamic/stray.c), and what they come to on the screen.
 *
 * A view maps a point p of the object to R p + t. Between two times a sweep takes each entry of R and t for the cubic through
 * both and their rates. Where the path does something else in between, a vibration that begins and ends at rest above all, a
 * point is off by |(dt + dR origin) + dR (p - origin)|, at most position + rotation |p - origin|. */
#ifndef TD_STRAY_H
#define TD_STRAY_H

#include "projection.h"

/* Up to 4096 pieces: of a step of 10 ms, 2.4 us each, about the shortest step that there is. */
enum { TD_STRAY_LEVELS = 13 };

/* An object's bounds with the interval cut into 1, 2, 4 .. equal pieces and a cubic for each. Reals only, 32 of them. */
typedef struct td_stray {
    td_real origin[3];                 /* in the object's coordinates */
    td_real position[TD_STRAY_LEVELS]; /* in the camera's */
    td_real rotation[TD_STRAY_LEVELS]; /* length of dR, an object's scale included */
    td_real padding[3];
} td_stray;

/* Lengths in the object's coordinates, the most that rows of the same Gaussians have. */
typedef struct td_reach {
    td_lanes mean;   /* of the mean from the stray's origin */
    td_lanes factor; /* of the factor: no axis is longer */
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

/* Greatest error of points of the Gaussians, out to `sigmas` standard deviations [scene units]. */
TD_INLINE td_lanes td_stray_of(TD_GLOBAL const td_stray *stray, int level, const td_reach *reach, td_lanes sigmas) {
    return td_fma(td_fma(sigmas, reach->factor, reach->mean), stray->rotation[level], td_splat(stray->position[level]));
}

#endif
