/* Internal: the optics' blur of a renderer's log-luminance and its rate.
 *
 * The point spread function is a Gaussian of psf_sigma_px, sampled at whole pixels, cut at 4 sigma and normalised, so that a
 * uniform image is unchanged. Above 8 px a coarse image is used: it differs by 2e-5 of an edge's height, and its cost doesn't
 * grow with the width. Beyond its borders the image continues with its border pixels. With G for the blur:
 *
 *   TIDES_PSF_LOG      L' = G L            L_dot' = G L_dot                    (the paper)
 *   TIDES_PSF_LINEAR   L' = ln(G e^L)      L_dot' = (G e^L L_dot) / (G e^L)    (what optics do: e^L = Y + log_eps)
 *
 * A tile needs its neighbours: they are rendered at the same time, once for all tiles that need them, so a whole frame
 * renders no tile twice. A pixel's result is the same to the bit, whichever tiles are requested together. */
#ifndef TD_PSF_H
#define TD_PSF_H

#include "tides/base.h"

#include <stddef.h>

struct td_request;
struct td_candidates;

/* The coarse image of a wide PSF for the current slot, computed as far as needed. Planes are L and L_dot. */
enum { TD_PSF_PLANES = 2 };
typedef struct td_psf_wide {
    int step;       /* [px] size of a cell; 0: direct sums */
    double *spline; /* (4 step) weights of pixels in a cell */
    int width, height, cells_x, cells_y, strips;
    double *line;         /* (4 step) */
    double *strip, *cell; /* (planes x strips x cells_x x TD_TILE), (planes x cells_y x cells_x) */
    unsigned char *made;  /* (planes x (cells + strips)) */
    size_t line_capacity, strip_capacity, cell_capacity, made_capacity;
} td_psf_wide;

typedef struct td_psf {
    int radius; /* of `weight`; 0: no blur */
    int reach;  /* [px] how far a pixel's blur reaches */
    int domain; /* TIDES_PSF_* */
    double sigma;
    double *weight; /* (radius + 1) at 0, 1, ... px, or cells of the coarse image */
    td_psf_wide wide;
    struct td_request *raw; /* tiles to render, slot by slot */
    size_t raw_capacity;
    int *slot_first, *raw_first; /* (slots + 1) into `order` and `raw` */
    size_t slot_capacity, first_capacity;
    int *order; /* (requests) sorted by slot */
    size_t order_capacity;
    int *place; /* (tiles) index in `raw` of a tile of the current slot; -1: none */
    size_t place_capacity;
    double *planes; /* (raw x outputs x TD_TILE_PIXELS) */
    size_t plane_capacity;
    double *rows; /* blurred along x: ((TD_TILE + 2 radius) x TD_TILE) of a tile, or of an image; and an unblurred row */
    size_t row_capacity;
} td_psf;

/* Sets the blur to `sigma_px`; 0: none. TIDES_BAD_ARGUMENT names what is out of range. */
TIDES_MUST_CHECK tides_status td_psf_set(td_psf *psf, double sigma_px, int32_t domain, tides_error *error);
void td_psf_release(td_psf *psf);

/* Blurs a whole image (height x width) in place by G. */
TIDES_MUST_CHECK tides_status td_psf_image(td_psf *psf, int width, int height, double *image, tides_error *error);

/* Source of pixels. `gather` reads pixels [x, x + count) of row y; outside the image they are the border's. */
typedef struct td_psf_source td_psf_source;
struct td_psf_source {
    void (*gather)(const td_psf_source *source, int x, int y, int count, double *line);
    const td_psf *psf;
    const double *image; /* whole, row by row; NULL: the tiles in td_psf, `plane` of `outputs` */
    int width, height, tiles_x, outputs, plane;
    int which; /* index of TD_PSF_PLANES */
};

/* Computes `count` outputs along a line of inputs, the first of which is `radius` before the first output. Each sum has the
 * same order. */
void td_psf_line(const td_psf *psf, const double *line, size_t stride, int count, double *out);

/* The wide blur: sigma [cells] of the coarse image's kernel, and its step; sets the step; begins a new image of a size; blurs
 * a plane of the tile at (x0, y0) to (TD_TILE x TD_TILE), row by row. */
double td_psf_wide_sigma(double sigma_px, int *step);
TIDES_MUST_CHECK tides_status td_psf_wide_set(td_psf *psf, int step, tides_error *error);
TIDES_MUST_CHECK tides_status td_psf_wide_begin(td_psf_wide *wide, int width, int height, tides_error *error);
void td_psf_wide_tile(td_psf *psf, const td_psf_source *source, int x0, int y0, double *out);
void td_psf_wide_release(td_psf_wide *wide);

/* Spreads each tile's motion and travel to the tiles into which it is blurred. */
tides_status td_psf_spread(td_psf *psf, struct td_candidates *candidates, tides_error *error);

#endif
