/* The reference in single precision: what the OpenCL kernels equal to the bit. */
#define TD_REFERENCE_CREATE td_backend_create_f32
#include "reference_body.h"

void td_empty_pixel_f32(const td_image_numbers *image, const double *backdrop, double *planes, int outputs) {
    td_image own = unpack_image(image);
    empty_pixel_of(&own, backdrop, planes, outputs);
}
