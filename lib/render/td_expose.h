/* Internal to lib/render: the mean of light over the exposures of some rows of tiles (expose_panels.c), for whole frames
 * (expose.c).
 *
 * Pixel by pixel light is a cubic from node to node in time, through values and rates: a row's mean is that cubic's, over the
 * row's own exposure, in closed form. A *panel* is what lies between two nodes, and has a third one in its middle: what its
 * two halves say against the whole tells how wrong they are (error_of). The errors of a pixel's panels add up; while a sum is
 * above the tolerance the panels that have more than half their share of it are cut in two.
 *
 * All of that is done for one *stretch* of the exposure after the other, most often one: stretches are as short as what motions
 * and paths say that they do asks for (expose_stretches.c). */
#ifndef TD_EXPOSE_H
#define TD_EXPOSE_H

#include "td_renderer.h"
#include "tides/exposure.h"

/* Times of a row of tiles are counted in these parts of its exposure, so that tiles share them to the bit. */
enum { TD_EXPOSE_PARTS = 4096 };

/* Panels that a tile begins with, at most. */
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
    double *sums;              /* (tiles of the band x TD_TILE_PIXELS) estimates of all stretches so far; 0 to begin with */
    double error;              /* the largest estimate so far */
    uint64_t unsettled, tiles; /* counted on */
    td_row_window swept;       /* the interval swept last */
    td_row_window all;         /* when rows of it are exposed, */
    td_row_window stretch;     /* and the part of that which is gone through (expose_stretches.c) */
    int asked;                 /* 1: something short may happen in it, which */
    float *asks;               /* (store.count) each Gaussian asks panels for; else may be NULL */
    int stretches;             /* so far, */
    int by_sweeps;             /* 1: none is too long for its sweep to see what motions may do */
    int unknown;               /* 1: this one is */
} td_expose_band;

/* When a row of tiles is exposed: the union of its rows' windows. */
td_row_window td_expose_tile_row(const td_expose_band *band, int height, int tile_row);

/* All of a band over `all`: its light, and sums. */
tides_status td_expose_stretches(tides_renderer *renderer, const tides_trajectory *camera, td_expose_band *band,
                                 td_row_window all, tides_error *error);

/* Panels of the interval swept last that what a tile may see asks for by its scales of time; 0: by none. */
double td_expose_asked(const tides_renderer *renderer, const td_expose_band *band, int tile);

/* The band over its stretch, which is swept: adds to its light, and sums. */
tides_status td_expose_panels(tides_renderer *renderer, const tides_trajectory *camera, td_expose_band *band,
                              tides_error *error);

#endif
