/* .splat (antimatter15's viewer and many after it): no header, 32 bytes per Gaussian, little-endian:
 *     float x y z, float scale x y z (linear), uint8 r g b a (colour 1/2 + C0 dc and opacity, of 255),
 *     uint8 rotation w x y z, (v - 128) / 128
 * C0 is 1 / (2 sqrt(pi)), and dc the constant SH coefficient, beyond which there are none. Axes are those of the 3DGS .ply
 * from which it was made. */
#include "td_base.h"
#include "td_endian.h"
#include "td_splat.h"

enum { ROW = 32 }; /* bytes of a Gaussian */

tides_status td_splat_parse(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error) {
    if (size == 0 || size % ROW != 0)
        return td_fail(error, TIDES_BAD_FILE, "%s: a .splat has %d bytes per Gaussian and no header, but %zu isn't a multiple",
                       path, ROW, size);
    td_gaussians made;
    tides_status status = td_gaussians_create(&made, (int64_t)(size / ROW), 0, error);
    if (status) return status;
    const unsigned char *row = data;
    for (size_t i = 0; i < size / ROW; i++, row += ROW) {
        for (size_t k = 0; k < 3; k++) {
            made.mean[3 * i + k] = td_le_float(row + 4 * k);
            made.log_scale[3 * i + k] = td_splat_log_scale((double)td_le_float(row + 12 + 4 * k));
            made.sh[3 * i + k] = td_splat_dc(row[24 + k] / 255.0);
        }
        made.opacity_logit[i] = td_splat_logit(row[27] / 255.0);
        for (size_t k = 0; k < 4; k++) made.quaternion[4 * i + k] = (float)(row[28 + k] - 128) / 128.0f;
    }
    *gaussians = made;
    return TIDES_OK;
}
