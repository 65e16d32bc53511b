/* Writes PLY files like INRIA's trainer, which every viewer reads: binary_little_endian, all float, in the order x y z nx ny
 * nz f_dc_* f_rest_* opacity scale_* rot_*, with normals 0, and f_rest channel by channel. Means far from (0, 0, 0), which
 * single precision can't hold, are double. */
#include "td_base.h"
#include "td_endian.h"
#include "td_math.h"
#include "td_scene.h"
#include "td_text.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Floats of a row at the largest degree: nx ny nz, sh, opacity, scale, rot; and x y z. */
enum { ROW_FLOATS_MAX = 6 + 3 * (TIDES_SH_DEGREE_MAX + 1) * (TIDES_SH_DEGREE_MAX + 1) + 1 + 3 + 4 };

static void write_names(FILE *out, const char *stem, size_t count) {
    for (size_t i = 0; i < count; i++) fprintf(out, "property float %s_%zu\n", stem, i);
}

static void write_header(FILE *out, const td_gaussians *g, int wide) {
    const double *up = g->up;
    fprintf(out, "ply\nformat binary_little_endian 1.0\n");
    if (up[0] != 0 || up[1] != 0 || up[2] != 0) fprintf(out, "comment up %.17g %.17g %.17g\n", up[0], up[1], up[2]);
    if (g->trained == TIDES_TRAINED_PLAIN || g->trained == TIDES_TRAINED_ANTIALIASED)
        fprintf(out, "comment SplatRenderMode: %s\n", g->trained == TIDES_TRAINED_PLAIN ? "default" : "mip");
    char transfer[TD_TRANSFER_TEXT];
    td_transfer_say(g->transfer, g->gamma, transfer);
    fprintf(out, "comment ColourTransfer: %s\n", transfer);
    fprintf(out, "element vertex %lld\n", (long long)g->count);
    static const char *const first[] = {"x", "y", "z", "nx", "ny", "nz"};
    for (size_t i = 0; i < sizeof first / sizeof first[0]; i++)
        fprintf(out, "property %s %s\n", wide && i < 3 ? "double" : "float", first[i]);
    write_names(out, "f_dc", 3);
    write_names(out, "f_rest", 3 * (td_sh_coefficients(g->sh_degree) - 1));
    fprintf(out, "property float opacity\n");
    write_names(out, "scale", 3);
    write_names(out, "rot", 4);
    fprintf(out, "end_header\n");
}

/* Fills `row` with all that follows the mean, and returns its length. A scale of 1 keeps every bit. */
static size_t fill_row(float *row, const td_gaussians *g, size_t i, double scale) {
    size_t n = 0, coefficients = td_sh_coefficients(g->sh_degree);
    const float *sh = g->sh + i * coefficients * 3;
    double log_of_scale = td_ln(scale);
    for (size_t axis = 0; axis < 3; axis++) row[n++] = 0.0f;
    for (size_t c = 0; c < 3; c++) row[n++] = sh[c];
    for (size_t c = 0; c < 3; c++)
        for (size_t k = 1; k < coefficients; k++) row[n++] = sh[3 * k + c];
    row[n++] = g->opacity_logit[i];
    for (size_t axis = 0; axis < 3; axis++) row[n++] = (float)(g->log_scale[3 * i + axis] + log_of_scale);
    for (size_t j = 0; j < 4; j++) row[n++] = g->quaternion[4 * i + j];
    return n;
}

/* store_float, store_double and store_mean return the end of the bytes that they wrote. */
static unsigned char *store_float(unsigned char *bytes, float value) {
    td_put_le_float(bytes, value);
    return bytes + sizeof value;
}

static unsigned char *store_double(unsigned char *bytes, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    td_put_le64(bytes, bits);
    return bytes + sizeof bits;
}

static unsigned char *store_mean(unsigned char *bytes, const td_gaussians *g, size_t i, double scale, int wide) {
    for (int axis = 0; axis < 3; axis++) {
        double mean = scale * td_gaussians_mean(g, (int64_t)i, axis);
        bytes = wide ? store_double(bytes, mean) : store_float(bytes, (float)mean);
    }
    return bytes;
}

/* Writes all rows; returns 0 on the first failure, with the reason in errno. */
static int write_rows(FILE *out, const td_gaussians *g, double scale, int wide) {
    float row[ROW_FLOATS_MAX];
    unsigned char bytes[4 * ROW_FLOATS_MAX + 3 * 8];
    for (size_t i = 0; i < (size_t)g->count; i++) {
        size_t n = fill_row(row, g, i, scale);
        unsigned char *end = store_mean(bytes, g, i, scale, wide);
        for (size_t k = 0; k < n; k++) end = store_float(end, row[k]);
        size_t size = (size_t)(end - bytes);
        if (fwrite(bytes, 1, size, out) != size) return 0;
    }
    return 1;
}

tides_status td_ply_write(const char *path, const td_gaussians *gaussians, double scale, tides_error *error) {
    char *part = NULL;
    td_plain_numbers numbers;
    tides_status status = td_part_name(path, 1, &part, error);
    if (status == TIDES_OK) status = td_plain_begin(&numbers, path, error);
    if (status != TIDES_OK) {
        free(part);
        return status;
    }
    FILE *out = td_part_open(part, path);
    if (!out) {
        status = td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", part, strerror(errno));
        goto done;
    }
    int wide = !td_gaussians_fit_float(gaussians);
    write_header(out, gaussians, wide);
    int written = write_rows(out, gaussians, scale, wide) && !ferror(out); /* ferror: writes of the header weren't checked */
    int reason = errno;
    if (fclose(out) != 0 && written) { /* writes the last buffer: a full disk may show only here */
        written = 0;
        reason = errno;
    }
    if (!written)
        status = td_fail(error, TIDES_WRITE_FAILED, "%s: writing failed: %s", part, strerror(reason));
    else
        status = td_commit_file(part, path, error);
    if (!written) td_remove_part(part, path);
done:
    td_plain_end(&numbers);
    free(part);
    return status;
}
