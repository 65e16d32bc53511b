/* Internal: strays: how far the paths of camera and objects stray, in an interval, from the cubics that a sweep assumes.
 * Compiled in double. */
#ifndef TD_STRAYS_H
#define TD_STRAYS_H

#ifndef TD_REAL_DOUBLE
#define TD_REAL_DOUBLE
#endif
#include "kernels/stray.h"
#include "render/td_backend.h"
#include "tides/scene.h"

typedef struct td_strays {
    int objects;
    double *bound;  /* (objects x TD_STRAY_REALS): a td_stray each */
    int *level;     /* (objects) 2^level pieces make boxes narrow enough */
    double *px;     /* (objects x TD_STRAY_LEVELS) stray of the object's middle from the cubics of 2^level pieces [px] */
    double *middle; /* (objects x 4) mean of its Gaussians' means, and their rms distance from it */
    double *share;  /* (samples) places of samples, in units of the interval */
    td_view *view;  /* (samples) views there */
    int samples;
    size_t share_capacity, view_capacity;
} td_strays;

tides_status td_strays_create(const td_store *store, td_strays *strays, tides_error *error);
void td_strays_release(td_strays *strays);

/* The paths of camera and objects over an interval. */
typedef struct td_stray_interval {
    const tides_scene *scene;
    const tides_trajectory *camera;
    double epoch, start, stop; /* [s], start and stop after the epoch */
    const uint8_t *moves;      /* (objects of the store) 1: it moves relative to the camera */
} td_stray_interval;

/* Finds bounds and levels of every object of the store over the interval. */
tides_status td_strays_find(td_strays *strays, const td_store *store, const td_image *image, const td_stray_interval *interval,
                            tides_error *error);

#endif
