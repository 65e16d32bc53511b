/* Animated PNG (PNG, third edition, 11.3.6): the first picture is an ordinary PNG, and the others follow in chunks. libpng
 * encodes each picture into memory. Its chunks are copied; after the first picture, IDAT becomes fdAT. */
#include "td_animation.h"
#include "td_png.h"
#include "td_endian.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { SIGNATURE = 8, CHUNK_OVERHEAD = 12 /* length, type, CRC */ };

/* Writes a chunk with `extra` bytes, then `size` bytes of `data`. */
static tides_status put_chunk(tides_animation *a, const char *type, const uint8_t *extra, size_t extra_size,
                              const uint8_t *data, size_t size, tides_error *error) {
    uint8_t head[8], tail[4];
    td_put_be32(head, (uint32_t)(extra_size + size));
    memcpy(head + 4, type, 4);
    uLong crc = crc32(crc32(0, NULL, 0), head + 4, 4);
    if (extra_size) crc = crc32(crc, extra, (uInt)extra_size);
    if (size) crc = crc32(crc, data, (uInt)size);
    td_put_be32(tail, (uint32_t)crc);
    tides_status status = td_animation_put(a, head, sizeof head, error);
    if (status == TIDES_OK && extra_size) status = td_animation_put(a, extra, extra_size, error);
    if (status == TIDES_OK && size) status = td_animation_put(a, data, size, error);
    return status == TIDES_OK ? td_animation_put(a, tail, sizeof tail, error) : status;
}

/* Writes the animation control: number of pictures, and number of plays (0: for ever). */
static tides_status put_control(tides_animation *a, tides_error *error) {
    uint8_t control[8] = {0};
    td_put_be32(control, (uint32_t)a->count);
    return put_chunk(a, "acTL", NULL, 0, control, sizeof control, error);
}

/* Writes a frame control: the whole picture, replacing the one before. */
static tides_status put_frame_control(tides_animation *a, tides_error *error) {
    uint8_t control[26] = {0};
    td_put_be32(control, a->sequence++);
    td_put_be32(control + 4, (uint32_t)a->width);
    td_put_be32(control + 8, (uint32_t)a->height);
    td_put_be16(control + 20, a->rate_scale);
    td_put_be16(control + 22, a->rate);
    return put_chunk(a, "fcTL", NULL, 0, control, sizeof control, error);
}

static tides_status put_data(tides_animation *a, const uint8_t *data, size_t size, tides_error *error) {
    uint8_t number[4];
    if (a->count == 0) return put_chunk(a, "IDAT", NULL, 0, data, size, error);
    td_put_be32(number, a->sequence++);
    return put_chunk(a, "fdAT", number, sizeof number, data, size, error);
}

/* Writes the chunks in front of the first picture's data, and leaves room for the animation control. */
static tides_status put_opening(tides_animation *a, const uint8_t *png, size_t size, tides_error *error) {
    tides_status status = td_animation_put(a, png, size, error);
    a->counter_at = (long)size;
    return status == TIDES_OK ? put_control(a, error) : status;
}

/* Copies the picture's data from a PNG that libpng encoded; from the first picture also all chunks before them. */
static tides_status copy(tides_animation *a, const uint8_t *png, size_t size, tides_error *error) {
    tides_status status = TIDES_OK;
    int begun = 0;
    for (size_t at = SIGNATURE; at + CHUNK_OVERHEAD <= size && status == TIDES_OK;) {
        const size_t length = td_be32(png + at);
        if (memcmp(png + at + 4, "IDAT", 4) == 0) {
            if (!begun && a->count == 0) status = put_opening(a, png, at, error);
            if (!begun && status == TIDES_OK) status = put_frame_control(a, error);
            begun = 1;
            if (status == TIDES_OK) status = put_data(a, png + at + 8, length, error);
        }
        at += length + CHUNK_OVERHEAD;
    }
    return status;
}

static tides_status append(tides_animation *a, const uint8_t *rgb, tides_error *error) {
    char *bytes = NULL;
    size_t size = 0;
    FILE *memory = open_memstream(&bytes, &size);
    if (!memory) return td_fail(error, TIDES_NO_MEMORY, "%s: out of memory", a->path);
    tides_status status = td_png_encode(a->path, memory, a->width, a->height, rgb, error);
    if (fclose(memory) != 0 && status == TIDES_OK) status = td_fail(error, TIDES_NO_MEMORY, "%s: out of memory", a->path);
    if (status == TIDES_OK) status = copy(a, (const uint8_t *)bytes, size, error);
    free(bytes);
    return status;
}

static tides_status end(tides_animation *a, tides_error *error) {
    tides_status status = put_chunk(a, "IEND", NULL, 0, NULL, 0, error);
    if (status != TIDES_OK) return status;
    if (fseek(a->file, a->counter_at, SEEK_SET) != 0)
        return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", a->path, strerror(errno));
    return put_control(a, error);
}

const td_animation_format td_animation_apng = {NULL, append, end};
