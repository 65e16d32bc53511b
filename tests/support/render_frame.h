/* Test support: whole frames through a td_backend, without tides_renderer: any store, any views, any backdrop. */
#ifndef TESTS_SUPPORT_RENDER_FRAME_H
#define TESTS_SUPPORT_RENDER_FRAME_H

#include "render/td_backend.h"

/* Candidates of the tiles: the Gaussians that the backend's sweep finds, or all. */
enum { FRAME_SWEPT, FRAME_ALL };

/* One frame. */
typedef struct frame_input {
    const td_store *store;
    const td_image_numbers *image;
    const double *views;    /* (objects x TD_VIEW_REALS) */
    const double *backdrop; /* (TD_BACKDROP_REALS) */
    int width, height, outputs;
} frame_input;

/* Planes (outputs x height x width), row 0 on top, freed by the caller; fails the cmocka test where the backend fails. */
double *frame_render(td_backend *backend, const frame_input *input, int candidates);

#endif
