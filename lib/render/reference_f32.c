/* The reference in single precision, which the OpenCL kernels equal to the bit. */
#define TD_REFERENCE_CREATE td_backend_create_f32_plain
#include "reference_body.h"
#include "td_fused.h"

tides_status td_backend_create_f32(const td_store *store, const td_image_numbers *image, td_backend **backend,
                                   tides_error *error) {
#ifdef TD_FUSED
    if (td_has_fused()) return td_backend_create_f32_fused(store, image, backend, error);
#endif
    return td_backend_create_f32_plain(store, image, backend, error);
}

void td_empty_pixel_f32(const td_image_numbers *image, const double *backdrop, double *planes, int outputs) {
    td_image own = unpack_image(image);
    empty_pixel_of(&own, backdrop, planes, outputs);
}
