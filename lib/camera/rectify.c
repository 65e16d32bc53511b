/* Rectification maps: for each pixel of a pinhole image, the place of its ray in a camera's (distorted) image. */
#include "archive/td_npy.h"
#include "camera/td_lens.h"
#include "td_math.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Largest deviation of R R^T from the identity. */
static const double orthonormal = 1e-6;
/* If a ray projects farther than this from its pixel [px], the pixel is outside the range of the lens. */
static const double missed_px = 1e-5;

static tides_status check_rotation(const double r[9], tides_error *error) {
    double det = 0, off = 0;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            off = fmax(off, fabs(r[3 * i] * r[3 * j] + r[3 * i + 1] * r[3 * j + 1] + r[3 * i + 2] * r[3 * j + 2] - (i == j)));
        det += r[i] * (r[3 + (i + 1) % 3] * r[6 + (i + 2) % 3] - r[3 + (i + 2) % 3] * r[6 + (i + 1) % 3]);
    }
    if (off < orthonormal && det > 0) return TIDES_OK;
    return td_fail(error, TIDES_BAD_ARGUMENT, "rectification: its 3x3 matrix isn't a rotation: rows are off by %g, det %g", off,
                   det);
}

static tides_status check_images(const tides_intrinsics *raw, const tides_intrinsics *rectified, const double rotation[9],
                                 td_image *image, tides_error *error) {
    td_image flat;
    tides_status status = td_camera_resolve(raw, image, error);
    if (status == TIDES_OK) status = td_camera_resolve(rectified, &flat, error);
    if (status == TIDES_OK && rectified->lens.model != TIDES_LENS_NONE)
        return td_fail(error, TIDES_BAD_ARGUMENT, "rectification: the rectified camera has a lens: it must be a pinhole");
    return status == TIDES_OK && rotation ? check_rotation(rotation, error) : status;
}

/* Writes NaN if the direction isn't in front of both cameras. */
static void place(const td_image *image, const tides_intrinsics *to, const double r[9], double u, double v, float out[2]) {
    double a, b;
    td_ray_of(image, u, v, &a, &b);
    const td_bent bent = td_bend(image, td_still(a), td_still(b));
    const double off = td_hypot(bent.x.v * image->fx + image->cx - u, bent.y.v * image->fy + image->cy - v);
    const double x = r[0] * a + r[1] * b + r[2], y = r[3] * a + r[4] * b + r[5], z = r[6] * a + r[7] * b + r[8];
    const int seen = (image->lens_model == TD_LENS_NONE || off < missed_px) && z > 0;
    out[0] = seen ? (float)(to->fx * x / z + to->cx - 0.5) : NAN;
    out[1] = seen ? (float)(to->fy * y / z + to->cy - 0.5) : NAN;
}

tides_status tides_rectify_map(const tides_intrinsics *raw, const tides_intrinsics *rectified, const double rotation[9],
                               float *map, tides_error *error) {
    static const double same[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    td_image image = {.width = 0};
    if (!raw || !rectified || !map)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_rectify_map: raw, rectified and map must be given");
    tides_status status = check_images(raw, rectified, rotation, &image, error);
    if (status != TIDES_OK) return status;
    for (int y = 0; y < raw->height; y++)
        for (int x = 0; x < raw->width; x++)
            place(&image, rectified, rotation ? rotation : same, x + 0.5, y + 0.5,
                  map + 2 * ((size_t)y * (size_t)raw->width + (size_t)x));
    return TIDES_OK;
}

tides_status tides_rectify_save(const char *file, const tides_intrinsics *raw, const tides_intrinsics *rectified,
                                const double rotation[9], tides_error *error) {
    td_image image = {.width = 0};
    td_npy_writer *writer = NULL;
    if (!file || !raw || !rectified)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_rectify_save: file, raw and rectified must be given");
    tides_status status = check_images(raw, rectified, rotation, &image, error);
    if (status != TIDES_OK) return status;
    const size_t width = (size_t)raw->width, height = (size_t)raw->height, inner[2] = {width, 2};
    float *map = td_alloc(2 * width * height, sizeof *map, error);
    status = map ? tides_rectify_map(raw, rectified, rotation, map, error) : TIDES_NO_MEMORY;
    if (status == TIDES_OK) status = td_npy_writer_open(file, 0, &writer, error);
    if (status == TIDES_OK)
        status = td_npy_writer_put(writer, &(td_npy_form){"rectify_map", "'<f4'", sizeof *map, 3, inner}, map, height, error);
    free(map);
    return td_npy_writer_end(writer, status, error);
}
