/* Internal: the optics' blur of a renderer's log-luminance and its rate.
 *
 * The point spread function is a Gaussian of psf_sigma_px, sampled at whole pixels, cut at 4 sigma and normalised, so that a
 * uniform image stays what it is. Beyond its borders the image goes on as its border pixels. With G for the blur:
 *
 *   TIDES_PSF_LOG      L' = G L            L_dot' = G L_dot                    (the paper)
 *   TIDES_PSF_LINEAR   L' = ln(G e^L)      L_dot' = (G e^L L_dot) / (G e^L)    (what optics do: e^L = Y + log_eps)
 *
 * A tile takes what it needs of its neighbours from these, rendered at the same time, once for all that ask: a whole frame
 * renders no tile twice. A pixel's result is the same to the bit whichever tiles are asked for together. */
#ifndef TD_PSF_H
#define TD_PSF_H

#include "tides/base.h"

#include <stddef.h>

struct td_request;
struct td_candidates;

typedef struct td_psf {
    int radius; /* [px]; 0: off */
    int domain; /* TIDES_PSF_* */
    double sigma;
    double *weight;         /* (radius + 1) at 0, 1, ... px */
    struct td_request *raw; /* the tiles to render, slot by slot */
    size_t raw_capacity;
    int *slot_first, *raw_first; /* (slots + 1) into `order` and `raw` */
    size_t slot_capacity, first_capacity;
    int *order; /* (requests) slot by slot */
    size_t order_capacity;
    int *place; /* (tiles) where a tile of the slot at hand is in `raw`; -1: nowhere */
    size_t place_capacity;
    double *planes; /* (raw x outputs x TD_TILE_PIXELS) */
    size_t plane_capacity;
    double *rows; /* of a tile, ((TD_TILE + 2 radius) x TD_TILE), or of an image: blurred along x, and one row before that */
    size_t row_capacity;
} td_psf;

/* The blur of `sigma_px` from now on; 0: none. TIDES_BAD_ARGUMENT naming what is out of range. */
TIDES_MUST_CHECK tides_status td_psf_set(td_psf *psf, double sigma_px, int32_t domain, tides_error *error);
void td_psf_release(td_psf *psf);

/* Blurs a whole image (height x width), in place, as tiles are: G of the above. */
TIDES_MUST_CHECK tides_status td_psf_image(td_psf *psf, int width, int height, double *image, tides_error *error);

/* What moves in a tile, and how far, also counts in those that it is blurred into. */
tides_status td_psf_spread(td_psf *psf, struct td_candidates *candidates, tides_error *error);

#endif
