/* Writes PNG pictures with libpng, for previews, figures and datasets, and converts libpng's failures to errors. */
#include "td_png.h"

#include "td_base.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* State of writing. libpng fails by longjmp, which would leave local variables of the function that calls setjmp undefined,
 * so all state is here. */
typedef struct png_job {
    FILE *file;
    td_png_form form;
    const uint8_t *values;
    png_structp png;
    png_infop info;
    int32_t y;
    td_png_message message;
} png_job;

void td_png_on_error(png_structp png, png_const_charp text) {
    td_png_message *message = png_get_error_ptr(png);
    snprintf(message->text, sizeof message->text, "%s", text);
    png_longjmp(png, 1);
}

void td_png_on_warning(png_structp png, png_const_charp text) {
    (void)png;
    (void)text;
}

/* 1 on a little-endian host, whose values must be swapped: PNG is big-endian. */
static int lowest_byte_first(void) {
    const uint16_t one = 1;
    return *(const uint8_t *)&one == 1;
}

/* Writes the picture; -1 with job->message on failure. */
static int write_picture(png_job *job) {
    if (setjmp(png_jmpbuf(job->png))) return -1;
    png_init_io(job->png, job->file);
    png_set_user_limits(job->png, INT32_MAX, INT32_MAX); /* libpng's default limit is a million pixels per side */
    const td_png_form *form = &job->form;
    const size_t row = (size_t)form->width * (size_t)form->channels * (size_t)(form->bits / 8);
    png_set_IHDR(job->png, job->info, (png_uint_32)form->width, (png_uint_32)form->height, form->bits,
                 form->channels == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (form->bits == 8) png_set_sRGB(job->png, job->info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(job->png, job->info);
    if (form->bits == 16 && lowest_byte_first()) png_set_swap(job->png);
    for (job->y = 0; job->y < form->height; job->y++) png_write_row(job->png, job->values + (size_t)job->y * row);
    png_write_end(job->png, NULL);
    return 0;
}

static tides_status encode(png_job *job, const char *path, tides_error *error) {
    job->png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &job->message, td_png_on_error, td_png_on_warning);
    if (!job->png) return td_fail(error, TIDES_NO_MEMORY, "%s: out of memory", path);
    tides_status status = TIDES_OK;
    job->info = png_create_info_struct(job->png);
    if (!job->info)
        status = td_fail(error, TIDES_NO_MEMORY, "%s: out of memory", path);
    else if (write_picture(job) != 0)
        status = td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", path, job->message.text);
    png_destroy_write_struct(&job->png, &job->info);
    return status;
}

tides_status td_png_encode(const char *path, FILE *file, int32_t width, int32_t height, const uint8_t *rgb,
                           tides_error *error) {
    png_job job = {.file = file, .form = {width, height, 8, 3}, .values = rgb};
    return encode(&job, path, error);
}

static tides_status write_part(png_job *job, const char *path, const char *part, tides_error *error) {
    job->file = td_part_open(part, path);
    if (!job->file) return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be created: %s", path, strerror(errno));
    tides_status status = encode(job, path, error);
    if (fclose(job->file) != 0 && status == TIDES_OK) /* with a full disk the error may come only here */
        status = td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", path, strerror(errno));
    if (status == TIDES_OK) return td_commit_file(part, path, error);
    td_remove_part(part, path);
    return status;
}

tides_status tides_png_write(const char *path, int32_t width, int32_t height, const uint8_t *rgb, tides_error *error) {
    if (!path || !rgb) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_png_write: an argument is NULL");
    if (width < 1 || height < 1)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: a picture can't be %d x %d px", path, width, height);
    const td_png_form form = {width, height, 8, 3};
    return td_png_write(path, &form, rgb, error);
}

tides_status td_png_write(const char *path, const td_png_form *form, const void *values, tides_error *error) {
    char *part = NULL;
    tides_status status = tides_file_named(path, ".png", error);
    if (status == TIDES_OK) status = td_part_name(path, 1, &part, error);
    if (status != TIDES_OK) return status;
    png_job job = {.form = *form, .values = values};
    status = write_part(&job, path, part, error);
    free(part);
    return status;
}

tides_status tides_png_write_values(const char *path, int32_t width, int32_t height, int32_t planes, int32_t bits,
                                    const uint16_t *values, tides_error *error) {
    if (!path || !values) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_png_write_values: an argument is NULL");
    if (width < 1 || height < 1 || (planes != 1 && planes != 3) || (bits != 8 && bits != 16))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "%s: %d x %d px of %d planes of %d bits can't be written: 1 or 3 planes, 8 or 16 bits", path, width,
                       height, planes, bits);
    const td_png_form form = {width, height, bits, planes};
    if (bits == 16) return td_png_write(path, &form, values, error);
    const size_t count = (size_t)width * (size_t)height * (size_t)planes;
    uint8_t *bytes = td_alloc(count, 1, error);
    tides_status status = bytes ? TIDES_OK : TIDES_NO_MEMORY;
    for (size_t i = 0; i < count && status == TIDES_OK; i++) bytes[i] = (uint8_t)values[i];
    if (status == TIDES_OK) status = td_png_write(path, &form, bytes, error);
    free(bytes);
    return status;
}
