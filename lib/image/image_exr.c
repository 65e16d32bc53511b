/* Writes float images as scan-line OpenEXR through OpenEXRCore, the C library inside OpenEXR.
 *
 * It works around a defect of the encoder up to 3.4.7 (Debian 12 has 3.1.5). If a chunk deflates to exactly its own size, the
 * deflated bytes are written. But readers take a chunk of that size as stored raw, so its scan lines become noise, without an
 * error. 3.4.8 stores such a chunk raw (its CHANGES.md, PR 2307), and so does compress_or_store. */
#include "td_base.h"
#include "td_exr.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* State of a write. */
typedef struct exr_job {
    const char *path, *part;
    int32_t width, height, count;
    tides_channel *channels; /* sorted by name, as in the file */
    exr_compression_t compression;
    const char *const *attributes;
    td_exr_trace *trace; /* lets a test see the work-around, or leave it out; NULL otherwise */
    td_exr_stream stream;
    exr_context_t context;
    exr_encode_pipeline_t encoder;
    exr_result_t (*compress)(exr_encode_pipeline_t *);
    tides_error *error;
} exr_job;

static tides_status write_failed(exr_job *job, exr_result_t result) {
    tides_status status = result == EXR_ERR_OUT_OF_MEMORY ? TIDES_NO_MEMORY : TIDES_WRITE_FAILED;
    return td_fail(job->error, status, "%s: can't be written: %s", job->path, td_exr_reason(&job->stream, result));
}

/* ---- the work-around ---- */

static exr_result_t compress_or_store(exr_encode_pipeline_t *encoder) {
    exr_job *job = encoder->encoding_user_data;
    exr_result_t result = job->compress(encoder);
    if (result != EXR_ERR_SUCCESS || encoder->compressed_bytes != encoder->packed_bytes) return result;
    /* A chunk that deflate can't shrink has been copied raw, so both buffers are equal. */
    if (memcmp(encoder->compressed_buffer, encoder->packed_buffer, encoder->packed_bytes) == 0) return result;
    if (job->trace) job->trace->equal_chunks++;
    if (!job->trace || !job->trace->leave_defect)
        memcpy(encoder->compressed_buffer, encoder->packed_buffer, encoder->packed_bytes);
    return result;
}

/* ---- the header ---- */

static exr_result_t add_channels(exr_job *job) {
    for (int32_t c = 0; c < job->count; c++) {
        exr_result_t result =
            exr_add_channel(job->context, 0, job->channels[c].name, EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LINEAR, 1, 1);
        if (result != EXR_ERR_SUCCESS) return result;
    }
    return EXR_ERR_SUCCESS;
}

static tides_status add_attributes(exr_job *job) {
    for (const char *const *pair = job->attributes; pair && pair[0]; pair += 2) {
        exr_result_t result = pair[1] ? exr_attr_set_string(job->context, 0, pair[0], pair[1]) : EXR_ERR_INVALID_ARGUMENT;
        if (result != EXR_ERR_SUCCESS)
            return td_fail(job->error, TIDES_BAD_ARGUMENT, "%s: attribute '%s' can't be set: %s", job->path, pair[0],
                           pair[1] ? td_exr_reason(&job->stream, result) : "its value is NULL");
    }
    return TIDES_OK;
}

static tides_status write_header(exr_job *job) {
    int part;
    /* Names beyond 31 characters need a flag in the file that old readers refuse, so it is set only if needed. */
    int long_names = 0;
    for (int32_t c = 0; c < job->count; c++) long_names |= strlen(job->channels[c].name) > 31;
    for (const char *const *pair = job->attributes; pair && pair[0]; pair += 2) long_names |= strlen(pair[0]) > 31;
    exr_result_t result = exr_set_longname_support(job->context, long_names);
    if (result == EXR_ERR_SUCCESS) result = exr_add_part(job->context, NULL, EXR_STORAGE_SCANLINE, &part);
    if (result == EXR_ERR_SUCCESS)
        result = exr_initialize_required_attr_simple(job->context, 0, job->width, job->height, job->compression);
    if (result == EXR_ERR_SUCCESS) result = add_channels(job);
    if (result != EXR_ERR_SUCCESS) return write_failed(job, result);
    tides_status status = add_attributes(job);
    if (status != TIDES_OK) return status;
    result = exr_write_header(job->context);
    return result == EXR_ERR_SUCCESS ? TIDES_OK : write_failed(job, result);
}

/* ---- the pixels ---- */

static exr_result_t start_encoder(exr_job *job, const exr_chunk_info_t *chunk) {
    exr_encode_pipeline_t *encoder = &job->encoder;
    exr_result_t result = exr_encoding_initialize(job->context, 0, chunk, encoder);
    if (result != EXR_ERR_SUCCESS) return result;
    if (encoder->channel_count != job->count) return EXR_ERR_UNKNOWN;
    for (int32_t c = 0; c < job->count; c++)
        if (strcmp(encoder->channels[c].channel_name, job->channels[c].name) != 0) return EXR_ERR_UNKNOWN;
    return EXR_ERR_SUCCESS;
}

static void point_to_rows(exr_job *job, int64_t y) {
    for (int32_t c = 0; c < job->count; c++) {
        exr_coding_channel_info_t *channel = &job->encoder.channels[c];
        channel->user_pixel_stride = (int32_t)sizeof(float);
        channel->user_line_stride = job->width * (int32_t)sizeof(float);
        channel->encode_from_ptr = (const uint8_t *)(job->channels[c].pixels + (size_t)y * (size_t)job->width);
    }
}

/* Chooses the encoder's routines, which needs the first rows; later chunks reuse them. */
static exr_result_t choose_routines(exr_job *job) {
    exr_result_t result = exr_encoding_choose_default_routines(job->context, 0, &job->encoder);
    job->compress = job->encoder.compress_fn;
    if (result == EXR_ERR_SUCCESS && job->compress) {
        job->encoder.encoding_user_data = job;
        job->encoder.compress_fn = compress_or_store;
    }
    return result;
}

static tides_status write_pixels(exr_job *job) {
    int32_t lines = 0;
    exr_result_t result = exr_get_scanlines_per_chunk(job->context, 0, &lines);
    for (int64_t y = 0; result == EXR_ERR_SUCCESS && y < job->height; y += lines) {
        exr_chunk_info_t chunk;
        result = exr_write_scanline_chunk_info(job->context, 0, (int)y, &chunk);
        if (result != EXR_ERR_SUCCESS) break;
        result = y == 0 ? start_encoder(job, &chunk) : exr_encoding_update(job->context, 0, &chunk, &job->encoder);
        if (result != EXR_ERR_SUCCESS) break;
        point_to_rows(job, y);
        if (y == 0) result = choose_routines(job);
        if (result == EXR_ERR_SUCCESS) result = exr_encoding_run(job->context, 0, &job->encoder);
    }
    tides_status status = result == EXR_ERR_SUCCESS ? TIDES_OK : write_failed(job, result);
    exr_encoding_destroy(job->context, &job->encoder);
    return status;
}

/* ---- the file ---- */

static tides_status write_context(exr_job *job) {
    exr_context_initializer_t initializer = td_exr_writing(&job->stream);
    exr_result_t result = exr_start_write(&job->context, job->part, EXR_WRITE_FILE_DIRECTLY, &initializer);
    if (result != EXR_ERR_SUCCESS) return write_failed(job, result);
    tides_status status = write_header(job);
    if (status == TIDES_OK) status = write_pixels(job);
    result = exr_finish(&job->context); /* also writes the table of chunks */
    if (status == TIDES_OK && result != EXR_ERR_SUCCESS) status = write_failed(job, result);
    return status;
}

static tides_status write_part(exr_job *job) {
    job->stream.descriptor = td_claim_file(job->part);
    if (job->stream.descriptor < 0)
        return td_fail(job->error, TIDES_WRITE_FAILED, "%s: can't be created: %s", job->path, strerror(errno));
    tides_status status = write_context(job);
    if (close(job->stream.descriptor) != 0 && status == TIDES_OK)
        status = td_fail(job->error, TIDES_WRITE_FAILED, "%s: can't be written: %s", job->path, strerror(errno));
    if (status == TIDES_OK) return td_commit_file(job->part, job->path, job->error);
    td_remove_part(job->part, job->path);
    return status;
}

/* ---- arguments ---- */

static int by_name(const void *a, const void *b) {
    return strcmp(((const tides_channel *)a)->name, ((const tides_channel *)b)->name);
}

static tides_status check_size(const exr_job *job, tides_error *error) {
    if (job->width < 1 || job->height < 1 || job->count < 1 || job->count > INT16_MAX)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: can't hold %d channels of %d x %d px: give at least 1 of each",
                       job->path, job->count, job->width, job->height);
    /* The size of a chunk (16 lines for ZIP) must fit a 32-bit integer. */
    if ((int64_t)job->width * job->count > INT32_MAX / (16 * (int32_t)sizeof(float)))
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: %d channels of %d px in a row are more than OpenEXR can hold", job->path,
                       job->count, job->width);
    if (job->compression != EXR_COMPRESSION_NONE && job->compression != EXR_COMPRESSION_ZIPS &&
        job->compression != EXR_COMPRESSION_ZIP)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: compression %d isn't TIDES_EXR_NONE, _ZIPS or _ZIP", job->path,
                       (int)job->compression);
    return TIDES_OK;
}

static tides_status sort_channels(exr_job *job, const tides_channel *channels, tides_error *error) {
    for (int32_t c = 0; c < job->count; c++)
        if (!channels[c].name || !channels[c].pixels || !channels[c].name[0] || strlen(channels[c].name) > 255)
            return td_fail(error, TIDES_BAD_ARGUMENT, "%s: channel %d needs pixels and a name of 1 to 255 characters",
                           job->path, c);
    job->channels = td_alloc((size_t)job->count, sizeof *job->channels, error);
    if (!job->channels) return TIDES_NO_MEMORY;
    memcpy(job->channels, channels, (size_t)job->count * sizeof *channels);
    qsort(job->channels, (size_t)job->count, sizeof *job->channels, by_name);
    for (int32_t c = 1; c < job->count; c++)
        if (by_name(&job->channels[c - 1], &job->channels[c]) == 0)
            return td_fail(error, TIDES_BAD_ARGUMENT, "%s: two channels are called '%s'", job->path, job->channels[c].name);
    return TIDES_OK;
}

static tides_status write_channels(exr_job *job, const tides_channel *channels, tides_error *error) {
    if (!job->path || !channels) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_exr_write: an argument is NULL");
    char *part = NULL;
    tides_status status = tides_file_named(job->path, ".exr", error);
    job->error = error;
    if (status == TIDES_OK) status = check_size(job, error);
    if (status == TIDES_OK) status = sort_channels(job, channels, error);
    if (status != TIDES_OK) goto done;
    status = td_part_name(job->path, 0, &part, error);
    job->part = part;
    if (status == TIDES_OK) status = write_part(job);
done:
    free(part);
    free(job->channels);
    return status;
}

tides_status td_exr_write_traced(const char *path, int32_t width, int32_t height, const tides_channel *channels, int32_t count,
                                 int32_t compression, td_exr_trace *trace, tides_error *error) {
    exr_job job = {.path = path, .width = width, .height = height, .count = count, .trace = trace};
    job.compression = (exr_compression_t)compression;
    return write_channels(&job, channels, error);
}

tides_status tides_exr_write(const char *path, int32_t width, int32_t height, const tides_channel *channels, int32_t count,
                             int32_t compression, const char *const *attributes, tides_error *error) {
    exr_job job = {.path = path, .width = width, .height = height, .count = count, .attributes = attributes};
    job.compression = (exr_compression_t)compression;
    return write_channels(&job, channels, error);
}
