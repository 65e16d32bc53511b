/* Reads scan-line OpenEXR files as float planes: half or float, with any compression that OpenEXRCore decodes. */
#include "td_base.h"
#include "td_exr.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct exr_source {
    const char *path;
    td_exr_stream stream;
    exr_context_t context;
    exr_attr_box2i_t window;
    tides_exr *image;
    size_t pixel_bytes; /* bytes per pixel in the file, over all channels */
    exr_decode_pipeline_t decoder;
    tides_error *error;
} exr_source;

static tides_status read_failed(exr_source *source, exr_result_t result) {
    tides_status status = TIDES_BAD_FILE;
    if (result == EXR_ERR_OUT_OF_MEMORY) status = TIDES_NO_MEMORY;
    if (result == EXR_ERR_FEATURE_NOT_IMPLEMENTED) status = TIDES_UNSUPPORTED;
    return td_fail(source->error, status, "%s: isn't a readable OpenEXR file: %s", source->path,
                   td_exr_reason(&source->stream, result));
}

static tides_status unsupported(exr_source *source, const char *what) {
    return td_fail(source->error, TIDES_UNSUPPORTED, "%s: %s: convert it to one part of half or float scan lines", source->path,
                   what);
}

/* ---- the header ---- */

static tides_status check_kind(exr_source *source) {
    int parts = 0;
    exr_storage_t storage = EXR_STORAGE_SCANLINE;
    exr_result_t result = exr_get_count(source->context, &parts);
    if (result == EXR_ERR_SUCCESS) result = exr_get_storage(source->context, 0, &storage);
    if (result != EXR_ERR_SUCCESS) return read_failed(source, result);
    if (parts != 1) return unsupported(source, "has several parts");
    if (storage != EXR_STORAGE_SCANLINE) return unsupported(source, "is tiled or deep");
    return TIDES_OK;
}

static tides_status copy_names(exr_source *source, const exr_attr_chlist_t *channels) {
    tides_exr *image = source->image;
    image->names = td_alloc((size_t)channels->num_channels, sizeof *image->names, source->error);
    if (!image->names) return TIDES_NO_MEMORY;
    image->count = channels->num_channels;
    for (int32_t c = 0; c < image->count; c++) {
        const exr_attr_chlist_entry_t *entry = &channels->entries[c];
        if (entry->pixel_type != EXR_PIXEL_HALF && entry->pixel_type != EXR_PIXEL_FLOAT)
            return unsupported(source, "has a channel of integers");
        if (entry->x_sampling != 1 || entry->y_sampling != 1) return unsupported(source, "has a subsampled channel");
        source->pixel_bytes += entry->pixel_type == EXR_PIXEL_HALF ? 2 : 4;
        image->names[c] = td_strdup(entry->name.str, source->error);
        if (!image->names[c]) return TIDES_NO_MEMORY;
    }
    return TIDES_OK;
}

/* Largest factor by which a compression shrinks. Runs of 128 bytes become 2; deflate has 1032 (zlib's documentation), after
 * PXR24 has dropped a quarter. Others have no bound, but nothing packs 64 kB into less than a byte. */
static size_t shrinks_by(exr_compression_t compression) {
    switch (compression) {
        case EXR_COMPRESSION_NONE: return 1;
        case EXR_COMPRESSION_RLE: return 64;
        case EXR_COMPRESSION_ZIPS:
        case EXR_COMPRESSION_ZIP: return 1032;
        case EXR_COMPRESSION_PXR24: return 1376;
        default: return 65536;
    }
}

/* Checks the size in the header before memory is allocated: each chunk has an 8-byte entry in the file, and the pixels must
 * fit into the file's bytes. */
static tides_status check_size(exr_source *source) {
    int32_t chunks = 0;
    exr_compression_t compression = EXR_COMPRESSION_NONE;
    const tides_exr *image = source->image;
    off_t bytes = lseek(source->stream.descriptor, 0, SEEK_END);
    exr_result_t result = exr_get_chunk_count(source->context, 0, &chunks);
    if (result == EXR_ERR_SUCCESS) result = exr_get_compression(source->context, 0, &compression);
    if (result != EXR_ERR_SUCCESS) return read_failed(source, result);
    double pixels = (double)image->width * (double)image->height * (double)source->pixel_bytes;
    if (chunks >= 1 && (int64_t)chunks * 8 <= (int64_t)bytes && pixels <= (double)bytes * (double)shrinks_by(compression))
        return TIDES_OK;
    return td_fail(source->error, TIDES_BAD_FILE, "%s: claims %d x %d px, but has only %lld bytes", source->path, image->width,
                   image->height, (long long)bytes);
}

static tides_status allocate(exr_source *source) {
    tides_exr *image = source->image;
    int64_t width = (int64_t)source->window.max.x - source->window.min.x + 1;
    int64_t height = (int64_t)source->window.max.y - source->window.min.y + 1;
    if (width < 1 || height < 1 || width > INT32_MAX / (int32_t)sizeof(float) || height > INT32_MAX)
        return td_fail(source->error, TIDES_BAD_FILE, "%s: has no usable data window", source->path);
    image->width = (int32_t)width;
    image->height = (int32_t)height;
    tides_status status = check_size(source);
    if (status != TIDES_OK) return status;
    size_t row = (size_t)width * (size_t)image->count * sizeof(float);
    image->pixels = td_alloc((size_t)height, row, source->error);
    return image->pixels ? TIDES_OK : TIDES_NO_MEMORY;
}

static tides_status read_header(exr_source *source) {
    const exr_attr_chlist_t *channels = NULL;
    tides_status status = check_kind(source);
    if (status != TIDES_OK) return status;
    exr_result_t result = exr_get_channels(source->context, 0, &channels);
    if (result == EXR_ERR_SUCCESS) result = exr_get_data_window(source->context, 0, &source->window);
    if (result != EXR_ERR_SUCCESS) return read_failed(source, result);
    if (channels->num_channels < 1) return td_fail(source->error, TIDES_BAD_FILE, "%s: has no channels", source->path);
    status = copy_names(source, channels);
    return status == TIDES_OK ? allocate(source) : status;
}

/* ---- the pixels ---- */

/* Points the decoder to the rows from `y` on, counted from the top of the data window. */
static void point_to_rows(exr_source *source, int32_t y) {
    const tides_exr *image = source->image;
    size_t plane = (size_t)image->width * (size_t)image->height;
    for (int16_t c = 0; c < source->decoder.channel_count; c++) {
        exr_coding_channel_info_t *channel = &source->decoder.channels[c];
        channel->user_bytes_per_element = (int16_t)sizeof(float);
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_pixel_stride = (int32_t)sizeof(float);
        channel->user_line_stride = image->width * (int32_t)sizeof(float);
        channel->decode_to_ptr = (uint8_t *)(image->pixels + (size_t)c * plane + (size_t)y * (size_t)image->width);
    }
}

static exr_result_t read_chunk(exr_source *source, int32_t y) {
    exr_chunk_info_t chunk;
    exr_decode_pipeline_t *decoder = &source->decoder;
    exr_result_t result = exr_read_scanline_chunk_info(source->context, 0, source->window.min.y + y, &chunk);
    if (result != EXR_ERR_SUCCESS) return result;
    result = y == 0 ? exr_decoding_initialize(source->context, 0, &chunk, decoder)
                    : exr_decoding_update(source->context, 0, &chunk, decoder);
    if (result != EXR_ERR_SUCCESS) return result;
    if (decoder->channel_count != source->image->count) return EXR_ERR_CORRUPT_CHUNK;
    point_to_rows(source, y);
    if (y == 0) result = exr_decoding_choose_default_routines(source->context, 0, decoder);
    return result == EXR_ERR_SUCCESS ? exr_decoding_run(source->context, 0, decoder) : result;
}

static tides_status read_pixels(exr_source *source) {
    int32_t lines = 0;
    exr_result_t result = exr_get_scanlines_per_chunk(source->context, 0, &lines);
    if (result == EXR_ERR_SUCCESS && lines < 1) result = EXR_ERR_INVALID_ATTR;
    for (int64_t y = 0; result == EXR_ERR_SUCCESS && y < source->image->height; y += lines)
        result = read_chunk(source, (int32_t)y);
    tides_status status = result == EXR_ERR_SUCCESS ? TIDES_OK : read_failed(source, result);
    exr_decoding_destroy(source->context, &source->decoder);
    return status;
}

/* ---- public ---- */

static tides_status read_context(exr_source *source) {
    exr_context_initializer_t initializer = td_exr_reading(&source->stream);
    exr_result_t result = exr_start_read(&source->context, source->path, &initializer);
    if (result != EXR_ERR_SUCCESS) return read_failed(source, result);
    tides_status status = read_header(source);
    if (status == TIDES_OK) status = read_pixels(source);
    exr_finish(&source->context);
    return status;
}

tides_status tides_exr_read(const char *path, tides_exr **exr, tides_error *error) {
    if (!path || !exr) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_exr_read: an argument is NULL");
    exr_source source = {.path = path, .error = error};
    source.stream.descriptor = open(path, O_RDONLY);
    if (source.stream.descriptor < 0)
        return td_fail(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened: %s", path, strerror(errno));
    tides_status status = TIDES_NO_MEMORY;
    source.image = td_alloc(1, sizeof *source.image, error);
    if (source.image) status = read_context(&source);
    close(source.stream.descriptor);
    if (status == TIDES_OK)
        *exr = source.image;
    else
        tides_exr_destroy(source.image);
    return status;
}

void tides_exr_destroy(tides_exr *exr) {
    if (!exr) return;
    for (int32_t c = 0; exr->names && c < exr->count; c++) free(exr->names[c]);
    free(exr->names);
    free(exr->pixels);
    free(exr);
}

void tides_exr_size(const tides_exr *exr, int32_t *width, int32_t *height, int32_t *channels) {
    if (width) *width = exr->width;
    if (height) *height = exr->height;
    if (channels) *channels = exr->count;
}

const char *tides_exr_name(const tides_exr *exr, int32_t channel) {
    return channel >= 0 && channel < exr->count ? exr->names[channel] : NULL;
}

const float *tides_exr_pixels(const tides_exr *exr, int32_t channel) {
    if (channel < 0 || channel >= exr->count) return NULL;
    return exr->pixels + (size_t)channel * (size_t)exr->width * (size_t)exr->height;
}
