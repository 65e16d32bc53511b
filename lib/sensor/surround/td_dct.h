/* Internal: the orthonormal cosine transform of an image (DCT-II in both directions), of any size, by matrices: one for
 * patterns that are even about the middle, one for odd ones. It takes height x width x (height + width) / 2 multiplications
 * each way. Modes of a direction are ordered even ones first, then odd ones, and so are `mu_x` and `mu_y`. The transform
 * diagonalises the 5-point Laplacian whose border pixels repeat:
 *
 *   lap4 of mode (j, k) is -(mu_j + mu_k) times the mode,  mu_k = 2 - 2 cos(pi k / size) */
#ifndef TD_DCT_H
#define TD_DCT_H

#include "tides/base.h"

typedef struct td_dct {
    int width, height;
    double *along_x[2], *along_x_back[2]; /* of even and odd modes (n x n), n half of the width: from pixel to mode, and back */
    double *along_y[2], *along_y_back[2]; /* along y: from mode to pixel, and back */
    double *mu_x, *mu_y;                  /* (width), (height) */
    double *half, *folded, *panel;        /* scratch: (height x width) each, and a panel of a matrix */
} td_dct;

tides_status td_dct_create(int width, int height, td_dct *cosine, tides_error *error);
void td_dct_release(td_dct *cosine);

/* Both arrays are (height x width), and must differ. */
void td_dct_forward(const td_dct *cosine, const double *image, double *modes);
void td_dct_back(const td_dct *cosine, const double *modes, double *image);

#endif
