/* Reads a PNG frame with libpng: grey or colour, 8 or 16 bit, converted to numbers from 0 to 1. */
#include "td_frames.h"

#include "image/td_png.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Largest ratio of deflate (zlib's documentation): a header that claims more pixels than the file can hold is damaged. */
enum { DEFLATE_MAX = 1032 };

/* State of reading. libpng fails by longjmp, which would leave local variables of the function that calls setjmp undefined,
 * so all state is here. */
typedef struct png_job {
    FILE *file;
    size_t file_bytes;
    png_structp png;
    png_infop info;
    size_t row_bytes;
    unsigned char *bytes; /* bytes of all rows */
    png_bytepp rows;
    int width, height, depth, channels;
    td_png_message message;
} png_job;

/* Reads the header; -1 with job->message on failure. Palettes become colour, and small depths 8 bit; alpha is ignored. */
static int read_header(png_job *job) {
    if (setjmp(png_jmpbuf(job->png))) return -1;
    png_init_io(job->png, job->file);
    png_set_user_limits(job->png, TD_FRAME_SIDE_MAX, TD_FRAME_SIDE_MAX);
    png_read_info(job->png, job->info);
    png_byte colour = png_get_color_type(job->png, job->info);
    if (colour == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(job->png);
    if (!(colour & PNG_COLOR_MASK_COLOR) && png_get_bit_depth(job->png, job->info) < 8)
        png_set_expand_gray_1_2_4_to_8(job->png);
    png_set_strip_alpha(job->png);
    png_set_interlace_handling(job->png);
    png_read_update_info(job->png, job->info);
    job->width = (int)png_get_image_width(job->png, job->info);
    job->height = (int)png_get_image_height(job->png, job->info);
    job->depth = png_get_bit_depth(job->png, job->info);
    job->channels = png_get_channels(job->png, job->info);
    job->row_bytes = png_get_rowbytes(job->png, job->info);
    if (job->row_bytes / DEFLATE_MAX * (size_t)job->height <= job->file_bytes) return 0;
    snprintf(job->message.text, sizeof job->message.text, "it claims %d x %d px, more than %zu bytes can hold", job->width,
             job->height, job->file_bytes);
    return -1;
}

static int read_rows(png_job *job) {
    if (setjmp(png_jmpbuf(job->png))) return -1;
    png_read_image(job->png, job->rows);
    png_read_end(job->png, NULL);
    return 0;
}

/* Converts integers to [0, 1]; 16-bit ones have the high byte first. */
static float *to_floats(const png_job *job, tides_error *error) {
    size_t count = (size_t)job->width * (size_t)job->height * (size_t)job->channels;
    float *values = td_alloc(count, sizeof *values, error);
    for (size_t i = 0; values && i < count; i++) {
        const unsigned char *at = job->bytes + i * (size_t)(job->depth / 8);
        values[i] = job->depth == 16 ? (float)(at[0] << 8 | at[1]) / 65535.0f : (float)at[0] / 255.0f;
    }
    return values;
}

static tides_status decode(png_job *job, const char *path, td_picture_values *picture, tides_error *error) {
    if (read_header(job) != 0) return td_fail(error, TIDES_BAD_FILE, "%s: can't be read: %s", path, job->message.text);
    job->bytes = td_alloc((size_t)job->height, job->row_bytes, error);
    job->rows = td_alloc((size_t)job->height, sizeof *job->rows, error);
    if (!job->bytes || !job->rows) return TIDES_NO_MEMORY;
    for (int y = 0; y < job->height; y++) job->rows[y] = job->bytes + (size_t)y * job->row_bytes;
    if (read_rows(job) != 0) return td_fail(error, TIDES_BAD_FILE, "%s: can't be read: %s", path, job->message.text);
    *picture = (td_picture_values){job->width, job->height, job->channels, job->depth, to_floats(job, error)};
    return picture->values ? TIDES_OK : TIDES_NO_MEMORY;
}

tides_status td_frame_png(const char *path, td_picture_values *picture, tides_error *error) {
    struct stat facts;
    png_job job = {.file = fopen(path, "rb")};
    if (!job.file) return td_fail(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened: %s", path, strerror(errno));
    job.file_bytes = fstat(fileno(job.file), &facts) == 0 ? (size_t)facts.st_size : 0;
    job.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &job.message, td_png_on_error, td_png_on_warning);
    job.info = job.png ? png_create_info_struct(job.png) : NULL;
    tides_status status =
        job.info ? decode(&job, path, picture, error) : td_fail(error, TIDES_NO_MEMORY, "%s: out of memory", path);
    png_destroy_read_struct(&job.png, &job.info, NULL);
    free(job.bytes);
    free(job.rows);
    fclose(job.file);
    return status;
}
