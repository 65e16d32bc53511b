/* The scalar reference renderer in double precision. Tests and `tides bench accuracy` take its results as the truth.
 *
 * A second build for processors with fused multiply-add is faster, and gives the same bits. */
#define TD_REAL_DOUBLE
#define TD_REFERENCE_CREATE td_backend_create_f64_plain
#include "reference_body.h"
#include "td_fused.h"

tides_status td_backend_create_f64(const td_store *store, const td_image_numbers *image, td_backend **backend,
                                   tides_error *error) {
#ifdef TD_FUSED
    if (td_has_fused()) return td_backend_create_f64_fused(store, image, backend, error);
#endif
    return td_backend_create_f64_plain(store, image, backend, error);
}
