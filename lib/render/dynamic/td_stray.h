/* Internal: strays of the paths of camera and objects, within an interval, from the cubics that a sweep takes them for
 * (kernels/stray.h). Compiled in double. */
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
    double *bound; /* (objects x TD_STRAY_REALS): a td_stray each */
    int *level;    /* (objects) 2^level pieces make its boxes narrow enough */
    double *px; /* (objects x TD_STRAY_LEVELS) how far its middle strays on the screen from the cubics of 2^level pieces [px] */
    double *middle; /* (objects x 4) the mean of the Gaussians' means, and their distance from it (rms) */
    double *share;  /* (samples) where a path is looked at, in units of the interval */
    td_view *view;  /* (samples) what is seen there */
    int samples;
    size_t share_capacity, view_capacity;
} td_strays;

tides_status td_strays_create(const td_store *store, td_strays *strays, tides_error *error);
void td_strays_release(td_strays *strays);

/* Bounds and levels of every object over [start, stop] after `epoch`; `moves` as tides_renderer.object_moves. */
tides_status td_strays_find(td_strays *strays, const tides_scene *scene, const td_store *store, const td_image *image,
                            const tides_trajectory *camera, double epoch, double start, double stop, const uint8_t *moves,
                            tides_error *error);

#endif
