/* Reads .splatv (antimatter15's splaTV, and converters to it): SpacetimeGaussians, lite model, as a texture. Little-endian:
 *     uint32 0x674b ("Kg"), uint32 bytes of JSON, JSON, and the chunks that it lists, one after the other
 *     [{"type": "splat", "size": bytes, "texwidth": 4096, "texheight": rows, "cameras": [...]}, ...]
 * The splat chunk has 64 bytes per Gaussian, 1024 to a row, zeros after the last. `motion` is the coefficients of dt, dt^2 and
 * dt^3, `omega` the quaternion's rate, `trbf` the bell of opacity's centre and width:
 *     float x y z; half rotation w x y z; half scale x y z (linear) and 0; uint8 r g b a (colour and opacity, of 255);
 *     half motion_0..8 and 0; half omega_0..3; half trbf_center, e^trbf_scale
 * Time runs from 0 to 1. Its viewer's cameras aren't read. */
#include "archive/td_numbers.h"
#include "td_base.h"
#include "td_endian.h"
#include "td_splat.h"
#include "td_splat_json.h"

#include <stdlib.h>
#include <string.h>

/* HEAD: bytes before the JSON. ROW, TEXEL: bytes of a Gaussian, and of a texel; a texture is WIDTH texels wide. The others are
 * byte offsets in a row. */
enum { MAGIC = 0x674b, HEAD = 8, ROW = 64, WIDTH = 4096, TEXEL = 16, ROTATION = 12, SCALE = 20, COLOUR = 28, MOTION = 32 };
enum { OMEGA = 52, CENTRE = 60, SPREAD = 62 };

int td_splatv_is(const void *start, size_t size) {
    const unsigned char *b = start;
    return size > HEAD && td_le32(b) == MAGIC && b[HEAD] == '[';
}

static float half(const unsigned char *at) { return (float)td_float_bits(td_le16(at), 2); }

/* Finds the chunk of splats: its bytes, and the number of rows before the zeros at its end. */
static tides_status find_splats(const char *path, const cJSON *chunks, const unsigned char **rows, size_t left, size_t *count,
                                tides_error *error) {
    const cJSON *chunk;
    cJSON_ArrayForEach(chunk, chunks) {
        const int64_t size = td_json_whole(chunk, "size", 0, INT32_MAX), width = td_json_whole(chunk, "texwidth", 1, WIDTH);
        const char *type = td_json_text(chunk, "type");
        if (size < 0 || (uint64_t)size > left)
            return td_fail(error, TIDES_BAD_FILE, "%s: a chunk's size isn't one of bytes that follow: %zu are left: truncated?",
                           path, left);
        if (type && strcmp(type, "splat") == 0) {
            const int64_t height = td_json_whole(chunk, "texheight", 1, INT32_MAX / WIDTH / TEXEL);
            if (width != WIDTH || height < 0 || size != width * height * TEXEL)
                return td_fail(error, TIDES_BAD_FILE, "%s: its splats aren't a texture %d wide of the chunk's size", path,
                               WIDTH);
            *count = (size_t)size / ROW;
            static const unsigned char nothing[ROW];
            while (*count > 0 && memcmp(*rows + ROW * (*count - 1), nothing, ROW) == 0) --*count;
            return *count ? TIDES_OK : td_fail(error, TIDES_BAD_FILE, "%s: holds no splats", path);
        }
        *rows += size;
        left -= (size_t)size;
    }
    return td_fail(error, TIDES_BAD_FILE, "%s: its JSON lists no chunk of splats", path);
}

static tides_status find_rows(const char *path, const unsigned char *file, size_t size, const unsigned char **rows,
                              size_t *count, tides_error *error) {
    cJSON *chunks = NULL;
    const size_t json = td_splatv_is(file, size) ? td_le32(file + 4) : 0;
    if (json == 0 || json > size - HEAD)
        return td_fail(error, TIDES_BAD_FILE, "%s: isn't a .splatv, or ends within its JSON: truncated?", path);
    tides_status status = td_splat_json(path, NULL, file + HEAD, json, &chunks, error);
    *rows = file + HEAD + json;
    if (!status) status = find_splats(path, chunks, rows, size - HEAD - json, count, error);
    cJSON_Delete(chunks);
    return status;
}

static void take_gaussians(const unsigned char *row, td_gaussians *g) {
    for (size_t i = 0; i < (size_t)g->count; i++, row += ROW) {
        for (size_t k = 0; k < 3; k++) {
            g->mean[3 * i + k] = td_le_float(row + 4 * k);
            g->log_scale[3 * i + k] = td_splat_log_scale((double)half(row + SCALE + 2 * k));
            g->sh[3 * i + k] = td_splat_dc(row[COLOUR + k] / 255.0);
        }
        g->opacity_logit[i] = td_splat_logit(row[COLOUR + 3] / 255.0);
        for (size_t k = 0; k < 4; k++) g->quaternion[4 * i + k] = half(row + ROTATION + 2 * k);
    }
}

/* Makes the motion. `values` has room for 15 numbers per Gaussian: centre, ln width, 9 coefficients, 4 rates, array by
 * array. */
static tides_status make_motion(const unsigned char *row, size_t n, float *values, tides_motion **motion, tides_error *error) {
    float *const centre = values, *const width = centre + n, *const coefficient = width + n, *const rate = coefficient + 9 * n;
    for (size_t i = 0; i < n; i++, row += ROW) {
        centre[i] = half(row + CENTRE);
        width[i] = td_splat_log_scale((double)half(row + SPREAD));
        for (size_t k = 0; k < 9; k++) coefficient[9 * i + k] = half(row + MOTION + 2 * k);
        for (size_t k = 0; k < 4; k++) rate[4 * i + k] = half(row + OMEGA + 2 * k);
    }
    const tides_polynomial_motion arrays = {.count = (int64_t)n,
                                            .stop = 1,
                                            .opacity_centre = centre,
                                            .opacity_log_width = width,
                                            .mean_coefficient = coefficient,
                                            .quaternion_dot = rate,
                                            .plain_colour = 1};
    return tides_motion_create_polynomial(&arrays, motion, error);
}

tides_status td_splatv_parse(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_motion **motion,
                             tides_error *error) {
    const unsigned char *rows = NULL;
    size_t count = 0;
    td_gaussians made;
    tides_status status = find_rows(path, data, size, &rows, &count, error);
    if (!status) status = td_gaussians_create(&made, (int64_t)count, 0, error);
    if (status) return status;
    take_gaussians(rows, &made);
    float *values = td_alloc(count, 15 * sizeof *values, error);
    status = values ? make_motion(rows, count, values, motion, error) : TIDES_NO_MEMORY;
    free(values);
    if (status)
        td_gaussians_free(&made);
    else
        *gaussians = made;
    return status ? td_fail_within(error, status, "%s", path) : TIDES_OK;
}
