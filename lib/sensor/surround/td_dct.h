/* Internal: the orthonormal cosine transform of an image (DCT-II in both directions), of any size, by its matrices: height x
 * width x (height + width) multiplications each way. It diagonalises the 5-point Laplacian whose border pixels repeat:
 *
 *   lap4 of mode (j, k) is -(mu_j + mu_k) times the mode,  mu_k = 2 - 2 cos(pi k / size) */
#ifndef TD_DCT_H
#define TD_DCT_H

#include "tides/base.h"

typedef struct td_dct {
    int width, height;
    double *along_x, *along_x_back; /* (width x width) from pixel to mode, and back */
    double *along_y, *along_y_back; /* (height x height) from mode to pixel, and back */
    double *mu_x, *mu_y;            /* (width), (height) */
    double *half, *panel;           /* scratch: (height x width), and a few columns of a matrix */
} td_dct;

tides_status td_dct_create(int width, int height, td_dct *cosine, tides_error *error);
void td_dct_release(td_dct *cosine);

/* (height x width) each, and not the same. */
void td_dct_forward(const td_dct *cosine, const double *image, double *modes);
void td_dct_back(const td_dct *cosine, const double *modes, double *image);

#endif
