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

/* Finds bounds and levels of every object over [start, stop] after `epoch`; `moves` (objects): 1 if it moves relative to the
 * camera. */
tides_status td_strays_find(td_strays *strays, const tides_scene *scene, const td_store *store, const td_image *image,
                            const tides_trajectory *camera, double epoch, double start, double stop, const uint8_t *moves,
                            tides_error *error);

#endif
