/* Internal: the optics' blur of a renderer's log-luminance and its rate.
 *
 * The point spread function is a Gaussian of psf_sigma_px, sampled at whole pixels, cut at 4 sigma and normalised, so that a
 * uniform image stays what it is; of more than 8 px one that differs from it by 2e-5 of an edge's height, at a cost that
 * doesn't grow with its width (psf_wide.c). Beyond its borders the image goes on as its border pixels. With G for the blur:
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

/* The coarse image of a wide PSF for the slot at hand, as far as it has been asked for. Planes are L and L_dot. */
enum { TD_PSF_PLANES = 2 };
typedef struct td_psf_wide {
    int step;       /* [px] from cell to cell; 0: the direct kernel */
    double *spline; /* (4 step) what pixels weigh in a cell */
    int width, height, cells_x, cells_y, strips;
    double *line;         /* (4 step) */
    double *strip, *cell; /* (planes x strips x cells_x x TD_TILE), (planes x cells_y x cells_x) */
    unsigned char *made;  /* (planes x (cells + strips)) */
    size_t line_capacity, strip_capacity, cell_capacity, made_capacity;
} td_psf_wide;

typedef struct td_psf {
    int radius; /* of `weight`; 0: off */
    int reach;  /* [px] how far a pixel's blur looks */
    int domain; /* TIDES_PSF_* */
    double sigma;
    double *weight; /* (radius + 1) at 0, 1, ... px, or cells of wide ones */
    td_psf_wide wide;
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

/* Where the pixels of an image are: `gather` has pixels [x, x + count) of row y, those outside the image being its border's. */
typedef struct td_psf_source td_psf_source;
struct td_psf_source {
    void (*gather)(const td_psf_source *source, int x, int y, int count, double *line);
    const td_psf *psf;
    const double *image; /* whole, row by row; NULL: psf's tiles, `plane` of `outputs` */
    int width, height, tiles_x, outputs, plane;
    int which; /* of TD_PSF_PLANES */
};

/* `count` outputs along a line of inputs, whose first is `radius` before the first output: sums in the same order for each. */
void td_psf_line(const td_psf *psf, const double *line, size_t stride, int count, double *out);

/* psf_wide.c: the kernel's sigma [cells], and the step; sets that; forgets the coarse image for that of a size; one plane of
 * the tile at (x0, y0), blurred: (TD_TILE x TD_TILE), row by row. */
double td_psf_wide_sigma(double sigma_px, int *step);
TIDES_MUST_CHECK tides_status td_psf_wide_set(td_psf *psf, int step, tides_error *error);
TIDES_MUST_CHECK tides_status td_psf_wide_begin(td_psf_wide *wide, int width, int height, tides_error *error);
void td_psf_wide_tile(td_psf *psf, const td_psf_source *source, int x0, int y0, double *out);
void td_psf_wide_release(td_psf_wide *wide);

/* Spreads each tile's motion, and how far it goes, to the tiles that it is blurred into. */
tides_status td_psf_spread(td_psf *psf, struct td_candidates *candidates, tides_error *error);

#endif
