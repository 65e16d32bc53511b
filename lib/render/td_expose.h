/* Internal to lib/render: the mean of light over the exposures of some rows of tiles, for exposed frames.
 *
 * For each pixel, light is a cubic from node to node in time, through values and rates. A row's mean is the mean of these
 * cubics over the row's own exposure, in closed form. A *panel* is the interval between two nodes, and has a third one in its
 * middle. The difference between its halves and the whole estimates its error. The errors of a pixel's panels are summed.
 * While a sum is above the tolerance, the panels with more than half their share of it are cut in two.
 *
 * All this is done for one *stretch* of the exposure after the other. Most exposures are one stretch; a motion or path that
 * declares short scales of time makes shorter ones. */
#ifndef TD_EXPOSE_H
#define TD_EXPOSE_H

#include "td_renderer.h"
#include "tides/exposure.h"

/* Times within the exposure of a row of tiles are multiples of 1/4096 of it, so that tiles share exactly equal times. */
enum { TD_EXPOSE_PARTS = 4096 };

/* Largest number of panels with which a tile begins. */
enum { TD_EXPOSE_PANELS = 64 };

/* A row's exposure [s after the epoch]; stop == start is an instant. */
typedef struct td_row_window {
    double start, stop;
} td_row_window;

/* The band to expose: rows of tiles [first, last). */
typedef struct td_expose_band {
    int first, last;
    const td_row_window *rows; /* (image height) */
    int planes;                /* 1: Y; 3: r, g, b */
    double tolerance;
    double *light;             /* (planes x height x width), of which the band's rows are written */
    double *sums;              /* (tiles of the band x TD_TILE_PIXELS) error estimates of all stretches so far; 0 at first */
    double error;              /* the largest estimate so far */
    uint64_t unsettled, tiles; /* counted over all bands */
    td_row_window swept;       /* the interval swept last */
    td_row_window all;         /* span of the band's exposure, */
    td_row_window stretch;     /* and the stretch of it that is integrated */
    int asked;                 /* 1: a short event may happen in the stretch, and then */
    float *asks;               /* (store.count) the panels that each Gaussian needs; else may be NULL */
    int stretches;             /* number so far */
    int by_sweeps;             /* 1: no sweep so far was too long to detect short events */
    int unknown;               /* 1: that of this stretch is */
} td_expose_band;

/* Exposure of a row of tiles: the union of its rows' exposures. */
td_row_window td_expose_tile_row(const td_expose_band *band, int height, int tile_row);

/* Exposes a band over `all`, in stretches: sets its light and sums. */
tides_status td_expose_stretches(tides_renderer *renderer, const tides_trajectory *camera, td_expose_band *band,
                                 td_row_window all, tides_error *error);

/* Panels of the interval swept last that a tile needs for short scales of time; 0: none. */
double td_expose_asked(const tides_renderer *renderer, const td_expose_band *band, int tile);

/* Exposes the band over its stretch, which has been swept: adds to its light and sums. */
tides_status td_expose_panels(tides_renderer *renderer, const tides_trajectory *camera, td_expose_band *band,
                              tides_error *error);

#endif
