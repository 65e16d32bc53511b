/* Reads SOG versions 1 and 2 (PlayCanvas's "spatially ordered Gaussians"): meta.json with lossless WebP pictures, in a folder
 * or in a .sog, which is a ZIP. Pixel i, row by row, belongs to Gaussian i:
 *
 *     means    two pictures, the low and the high byte of r g b: v / 65535 between mins and maxs is sign(x) ln(1 + |x|)
 *     quats    r g b: the three components but the largest, (v / 255 - 1/2) sqrt(2); alpha: 252 + the largest's number, wxyz
 *     scales   r g b: into a codebook of 256 natural logarithms
 *     sh0      r g b: into a codebook of 256 constant coefficients; alpha: opacity, of 255
 *     shN      optional, a palette: the second picture has the label, low byte r, high byte g; label n's coefficient k is at
 *              x = (n mod 64) K' + k, y = n / 64 of the first one (K' = 3, 8, 15 for 1, 2, 3 bands), r g b into a codebook
 *
 * Version 1 has no "version" and no codebooks. There a byte v stands for mins + v / 255 (maxs - mins), with one number each
 * for shN. The byte of the opacity gives its logit in this way. The count is means.shape[0].
 *
 * "model" is "antialiased" or "2dgs" for splats that aren't plain (version 2, since 2026). */
#include "archive/td_zip.h"
#include "td_base.h"
#include "td_math.h"
#include "td_splat.h"
#include "td_splat_json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <webp/decode.h>

enum { CODEBOOK = 256, PALETTE_COLUMNS = 64, MOST_ENTRIES = 65536, LARGEST = 16383 /* pixels along a WebP picture's edge */ };

typedef struct sog {
    const char *path;
    const char *folder; /* NULL: the files are in `zip` */
    td_zip zip;
    cJSON *meta;
    size_t count;
    int32_t degree, version, trained;
    tides_error *error;
} sog;

typedef struct picture {
    unsigned char *rgba;
    size_t width, height;
} picture;

static tides_status fail(const sog *s, const char *where, const char *text) {
    return td_fail(s->error, TIDES_BAD_FILE, "%s: %s: %s", s->path, where, text);
}

/* -- files -- */

/* Reads a file. `*data` is valid until `*owned` is freed or `s` is closed. */
static tides_status read_member(const sog *s, const char *name, const unsigned char **data, size_t *size, void **owned) {
    *owned = NULL;
    if (s->folder) {
        char *file = td_format(s->error, "%s%s", s->folder, name), *text = NULL;
        tides_status status = file ? td_read_file(file, SIZE_MAX - 1, &text, size, s->error) : TIDES_NO_MEMORY;
        free(file);
        *owned = text;
        *data = (const unsigned char *)text;
        return status;
    }
    const td_zip_member *member = td_zip_find(&s->zip, name);
    if (!member) return td_fail(s->error, TIDES_BAD_FILE, "%s: holds no %.80s, which a .sog needs", s->path, name);
    *size = member->size;
    return td_zip_read(&s->zip, member, data, owned, s->error);
}

/* The name of the entry's file `number`. It must lie beside meta.json: nothing outside of the folder is read. */
static tides_status file_name(const sog *s, const char *entry, int number, const char **name) {
    const cJSON *files = cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(s->meta, entry), "files");
    const cJSON *file = cJSON_GetArrayItem(files, number);
    if (!cJSON_IsString(file) || !*file->valuestring || strchr(file->valuestring, '/') || strchr(file->valuestring, '\\'))
        return fail(s, entry, "needs a list \"files\" of names without folders");
    *name = file->valuestring;
    return TIDES_OK;
}

/* Reads a picture with `pixels` to `most` pixels. Its size is checked before memory is allocated. */
static tides_status read_some(const sog *s, const char *entry, int number, size_t pixels, size_t most, picture *out) {
    const char *name = NULL;
    const unsigned char *data = NULL;
    void *owned = NULL;
    size_t size = 0;
    int width = 0, height = 0;
    tides_status status = file_name(s, entry, number, &name);
    if (!status) status = read_member(s, name, &data, &size, &owned);
    if (!status && !WebPGetInfo(data, size, &width, &height)) status = fail(s, name, "isn't a WebP picture");
    if (status) goto done;
    if ((size_t)width * (size_t)height < pixels || (size_t)width * (size_t)height > most) {
        status = td_fail(s->error, TIDES_BAD_FILE, "%s: %.80s has %dx%d pixels where meta.json asks for %zu", s->path, name,
                         width, height, pixels);
        goto done;
    }
    *out = (picture){WebPDecodeRGBA(data, size, &width, &height), (size_t)width, (size_t)height};
    if (!out->rgba) status = fail(s, name, "can't be decoded: truncated or damaged");
done:
    free(owned);
    return status;
}

/* Reads a picture with a pixel for each of `pixels` Gaussians, and few more. */
static tides_status read_picture(const sog *s, const char *entry, int number, size_t pixels, picture *out) {
    return read_some(s, entry, number, pixels, 4 * (pixels + LARGEST), out);
}

/* -- meta.json -- */

/* Reads `count` finite numbers from entry.key. */
static tides_status read_numbers(const sog *s, const char *entry, const char *key, double *values, int count) {
    if (td_json_numbers(cJSON_GetObjectItemCaseSensitive(s->meta, entry), key, values, count)) return TIDES_OK;
    return td_fail(s->error, TIDES_BAD_FILE, "%s: %s.%s must be a list of %d numbers", s->path, entry, key, count);
}

/* A whole number from 1 to `most`; 0 if it isn't one. */
static size_t whole(const cJSON *object, const char *key, int64_t most) {
    const int64_t value = td_json_whole(object, key, 1, most);
    return value < 1 ? 0 : (size_t)value;
}

/* Element `index` of `entry`.shape as a whole number; 0 if it isn't one. */
static size_t shape(const sog *s, const char *entry, int index) {
    const cJSON *list = cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(s->meta, entry), "shape");
    const cJSON *item = cJSON_GetArrayItem(list, index);
    const double value = cJSON_IsNumber(item) ? item->valuedouble : 0;
    return value >= 1 && value <= (double)LARGEST * LARGEST && value == floor(value) ? (size_t)value : 0;
}

/* Number of bands of the palette; in version 1 it follows from the number of coefficients. */
static size_t bands_of(const sog *s, const cJSON *palette) {
    if (s->version == 2) return whole(palette, "bands", 3);
    for (size_t bands = 1; bands <= 3; bands++)
        if (shape(s, "shN", 1) == 3 * (td_sh_coefficients((int32_t)bands) - 1)) return bands;
    return 0;
}

static tides_status count_and_degree(sog *s) {
    const cJSON *palette = cJSON_GetObjectItemCaseSensitive(s->meta, "shN");
    const size_t bands = palette ? bands_of(s, palette) : 0;
    s->count = s->version == 2 ? whole(s->meta, "count", (int64_t)LARGEST * LARGEST) : shape(s, "means", 0);
    if (s->count == 0) return fail(s, "count", "must be a whole number from 1 on that fits in a picture");
    if (palette && bands == 0) return fail(s, "shN", "must have 1, 2 or 3 bands");
    s->degree = (int32_t)bands;
    return TIDES_OK;
}

static tides_status read_model(sog *s) {
    const char *model = td_json_text(s->meta, "model");
    if (!model) return TIDES_OK;
    if (strcmp(model, "2dgs") == 0) return td_splat_refuse_discs(s->path, s->error);
    s->trained = strcmp(model, "antialiased") == 0 ? TIDES_TRAINED_ANTIALIASED
                 : strcmp(model, "default") == 0   ? TIDES_TRAINED_PLAIN
                                                   : TIDES_TRAINED_UNKNOWN;
    if (s->trained != TIDES_TRAINED_UNKNOWN) return TIDES_OK;
    return td_fail(s->error, TIDES_UNSUPPORTED, "%s: its model is \"%.40s\": default and antialiased are read", s->path, model);
}

static tides_status parse_meta(sog *s) {
    const unsigned char *text = NULL;
    void *owned = NULL;
    size_t size = 0;
    tides_status status = read_member(s, "meta.json", &text, &size, &owned);
    if (!status) status = td_splat_json(s->path, "meta.json", text, size, &s->meta, s->error);
    free(owned);
    if (status) return status;
    const cJSON *version = cJSON_GetObjectItemCaseSensitive(s->meta, "version");
    s->version = version ? (int32_t)whole(s->meta, "version", INT32_MAX) : 1;
    if (s->version == 1 && !cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(s->meta, "means"), "shape"))
        return fail(s, "meta.json", "is no SOG's: it has neither a \"version\" nor means.shape");
    if (s->version != 1 && s->version != 2)
        return td_fail(s->error, TIDES_UNSUPPORTED, "%s: is no SOG of version 1 or 2: convert it with splat-transform",
                       s->path);
    status = read_model(s);
    return status ? status : count_and_degree(s);
}

/* -- pictures into Gaussians -- */

static tides_status unpack_means(const sog *s, const td_gaussians *g) {
    double low[3] = {0}, high[3] = {0};
    picture bytes[2] = {{0}, {0}};
    tides_status status = read_numbers(s, "means", "mins", low, 3);
    if (!status) status = read_numbers(s, "means", "maxs", high, 3);
    for (int b = 0; b < 2 && !status; b++) status = read_picture(s, "means", b, s->count, &bytes[b]);
    for (size_t i = 0; i < s->count && !status; i++)
        for (size_t c = 0; c < 3; c++) {
            double t = (bytes[0].rgba[4 * i + c] | bytes[1].rgba[4 * i + c] << 8) / 65535.0;
            double value = low[c] + (high[c] - low[c]) * t, size = td_expm1(fabs(value));
            g->mean[3 * i + c] = (float)(value < 0 ? -size : size);
        }
    for (int b = 0; b < 2; b++) WebPFree(bytes[b].rgba);
    return status;
}

static tides_status unpack_quaternions(const sog *s, const td_gaussians *g) {
    picture quats = {0};
    tides_status status = read_picture(s, "quats", 0, s->count, &quats);
    for (size_t i = 0; i < s->count && !status; i++) {
        const unsigned char *pixel = quats.rgba + 4 * i;
        double others[3];
        for (size_t c = 0; c < 3; c++) others[c] = (pixel[c] / 255.0 - 0.5) * sqrt(2.0);
        if (pixel[3] >= 252)
            td_splat_rebuild(others, pixel[3] - 252u, g->quaternion + 4 * i);
        else
            status = td_fail(s->error, TIDES_BAD_FILE, "%s: Gaussian %zu: alpha of its rotation is %d: must be 252 to 255",
                             s->path, i, pixel[3]);
    }
    WebPFree(quats.rgba);
    return status;
}

/* The values of the bytes of `channels` in `entry`; version 2 has one codebook for all channels. */
static tides_status read_codes(const sog *s, const char *entry, int channels, double codes[4][CODEBOOK]) {
    double low[4] = {0}, high[4] = {0};
    tides_status status = s->version == 2 ? read_numbers(s, entry, "codebook", codes[0], CODEBOOK)
                                          : read_numbers(s, entry, "mins", low, channels);
    if (!status && s->version == 1) status = read_numbers(s, entry, "maxs", high, channels);
    for (int c = 0; c < channels && !status; c++) {
        if (s->version == 2 && c > 0) memcpy(codes[c], codes[0], sizeof codes[0]);
        for (int k = 0; k < CODEBOOK && s->version == 1; k++) codes[c][k] = low[c] + (high[c] - low[c]) * (k / 255.0);
    }
    return status;
}

/* Decodes r g b of `entry`'s picture; alpha becomes logits if `opacity` isn't NULL. */
static tides_status unpack_codes(const sog *s, const char *entry, float *out, size_t stride, float *opacity) {
    double codes[4][CODEBOOK];
    picture indices = {0};
    tides_status status = read_codes(s, entry, opacity ? 4 : 3, codes);
    if (!status) status = read_picture(s, entry, 0, s->count, &indices);
    for (size_t i = 0; i < s->count && !status; i++) {
        const unsigned char *pixel = indices.rgba + 4 * i;
        for (size_t c = 0; c < 3; c++) out[stride * i + c] = (float)codes[c][pixel[c]];
        if (opacity) opacity[i] = s->version == 2 ? td_splat_logit(pixel[3] / 255.0) : (float)codes[3][pixel[3]];
    }
    WebPFree(indices.rgba);
    return status;
}

/* Reads the palette's codebook. Version 1 has only two numbers, the bounds. */
static tides_status read_palette_codes(const sog *s, double codes[CODEBOOK]) {
    if (s->version == 2) return read_numbers(s, "shN", "codebook", codes, CODEBOOK);
    const cJSON *entry = cJSON_GetObjectItemCaseSensitive(s->meta, "shN");
    const cJSON *low = cJSON_GetObjectItemCaseSensitive(entry, "mins"), *high = cJSON_GetObjectItemCaseSensitive(entry, "maxs");
    if (!cJSON_IsNumber(low) || !cJSON_IsNumber(high)) return fail(s, "shN.mins, shN.maxs", "must be numbers");
    for (int k = 0; k < CODEBOOK; k++) codes[k] = low->valuedouble + (high->valuedouble - low->valuedouble) * (k / 255.0);
    return TIDES_OK;
}

/* Reads the palette's picture, and its number of entries: in version 1 as many as fit. */
static tides_status read_palette(const sog *s, size_t rest, size_t *entries, picture *palette) {
    *entries = s->version == 2 ? whole(cJSON_GetObjectItemCaseSensitive(s->meta, "shN"), "count", MOST_ENTRIES) : MOST_ENTRIES;
    if (*entries == 0) return fail(s, "shN.count", "must be a whole number from 1 to 65536");
    const size_t rows = s->version == 2 ? (*entries + PALETTE_COLUMNS - 1) / PALETTE_COLUMNS : 1;
    tides_status status = read_some(s, "shN", 0, rows * PALETTE_COLUMNS * rest, MOST_ENTRIES * rest, palette);
    if (!status && palette->width != PALETTE_COLUMNS * rest)
        status = fail(s, "shN", "its palette must have 64 entries in a row");
    if (!status && s->version == 1) *entries = PALETTE_COLUMNS * palette->height;
    return status;
}

static tides_status unpack_palette(const sog *s, const td_gaussians *g) {
    size_t coefficients = td_sh_coefficients(s->degree), rest = coefficients - 1;
    double codes[CODEBOOK];
    size_t entries = 0;
    picture palette = {0}, labels = {0};
    tides_status status = read_palette_codes(s, codes);
    if (!status) status = read_palette(s, rest, &entries, &palette);
    if (!status) status = read_picture(s, "shN", 1, s->count, &labels);
    for (size_t i = 0; i < s->count && !status; i++) {
        size_t label = labels.rgba[4 * i] | (size_t)labels.rgba[4 * i + 1] << 8;
        if (label >= entries) {
            status = td_fail(s->error, TIDES_BAD_FILE, "%s: Gaussian %zu: SH label %zu of a palette of %zu", s->path, i, label,
                             entries);
            break;
        }
        size_t at = label / PALETTE_COLUMNS * palette.width + label % PALETTE_COLUMNS * rest;
        for (size_t k = 0; k < rest; k++)
            for (size_t c = 0; c < 3; c++)
                g->sh[3 * (coefficients * i + k + 1) + c] = (float)codes[palette.rgba[4 * (at + k) + c]];
    }
    WebPFree(palette.rgba);
    WebPFree(labels.rgba);
    return status;
}

static tides_status unpack(const sog *s, const td_gaussians *g) {
    tides_status status = unpack_means(s, g);
    if (!status) status = unpack_quaternions(s, g);
    if (!status) status = unpack_codes(s, "scales", g->log_scale, 3, NULL);
    if (!status) status = unpack_codes(s, "sh0", g->sh, 3 * td_sh_coefficients(s->degree), g->opacity_logit);
    if (!status && s->degree > 0) status = unpack_palette(s, g);
    return status;
}

static tides_status read_sog(sog *s, td_gaussians *gaussians) {
    td_gaussians made = {0};
    picture probe = {0}; /* read first, so that a wrong count allocates nothing */
    tides_status status = parse_meta(s);
    if (!status) status = read_picture(s, "quats", 0, s->count, &probe);
    WebPFree(probe.rgba);
    if (!status) status = td_gaussians_create(&made, (int64_t)s->count, s->degree, s->error);
    if (!status) {
        made.trained = s->trained;
        status = unpack(s, &made);
        if (status)
            td_gaussians_free(&made);
        else
            *gaussians = made;
    }
    cJSON_Delete(s->meta);
    return status;
}

tides_status td_sog_parse(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error) {
    sog s = {.path = path, .error = error};
    tides_status status = td_zip_open(&s.zip, path, data, size, error);
    if (!status) status = read_sog(&s, gaussians);
    td_zip_close(&s.zip);
    return status;
}

tides_status td_sog_read_folder(const char *path, td_gaussians *gaussians, tides_error *error) {
    char *folder = td_sog_is_meta(path) ? td_folder_prefix(path, error) : td_format(error, "%s/", path);
    if (!folder) return TIDES_NO_MEMORY;
    sog s = {.path = path, .folder = folder, .error = error};
    tides_status status = read_sog(&s, gaussians);
    free(folder);
    return status;
}

int td_sog_is_meta(const char *path) { return strcmp(td_base_name(path), "meta.json") == 0; }

int td_sog_is_zip(const char *path) {
    char *data = NULL;
    size_t size = 0;
    td_zip zip;
    memset(&zip, 0, sizeof zip);
    int found = td_read_file(path, SIZE_MAX - 1, &data, &size, NULL) == TIDES_OK && td_zip_is(data, size) &&
                td_zip_open(&zip, path, data, size, NULL) == TIDES_OK && td_zip_find(&zip, "meta.json") != NULL;
    td_zip_close(&zip);
    free(data);
    return found;
}
