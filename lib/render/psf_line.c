/* Weighted sums of a line of pixels (or of several lines side by side) with the PSF's one-dimensional profile. */
#include "td_psf.h"

void td_psf_line(const td_psf *psf, const double *line, size_t stride, int count, double *out) {
    const double *centre = line + (size_t)psf->radius * stride;
    for (int c = 0; c < count; c++) out[c] = psf->weight[0] * centre[c];
    for (int k = 1; k <= psf->radius; k++) {
        const double *before = centre - (size_t)k * stride, *after = centre + (size_t)k * stride;
        for (int c = 0; c < count; c++) out[c] += psf->weight[k] * (before[c] + after[c]);
    }
}
