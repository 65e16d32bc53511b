/* Writes animations (APNG, Y4M, numbered PNGs): finds the format from the file's ending, checks sizes, writes PATH.part and
 * renames it. */
#include "td_animation.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

tides_status td_animation_put(tides_animation *animation, const void *bytes, size_t size, tides_error *error) {
    if (fwrite(bytes, 1, size, animation->file) == size) return TIDES_OK;
    return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", animation->path, strerror(errno));
}

static int ends_with(const char *path, const char *ending) {
    const size_t length = strlen(path), tail = strlen(ending);
    return length > tail && strcmp(path + length - tail, ending) == 0;
}

static const td_animation_format *format_of(const char *path) {
    if (ends_with(path, ".y4m")) return &td_animation_y4m;
    if (ends_with(path, ".apng")) return &td_animation_apng;
    if (!ends_with(path, ".png")) return NULL;
    return td_animation_is_numbered(path) ? &td_animation_numbered : &td_animation_apng;
}

/* Sets the rate as a fraction of 16-bit numbers, as APNG has it: in thousandths if they fit, else coarser. */
static void set_rate(tides_animation *a, double pictures_per_second) {
    a->rate_scale = 1000;
    while (pictures_per_second * a->rate_scale > 65535.0) a->rate_scale /= 10;
    a->rate = (uint32_t)lround(pictures_per_second * a->rate_scale);
    for (uint32_t divisor = 1000; divisor > 1; divisor--)
        if (a->rate % divisor == 0 && a->rate_scale % divisor == 0) a->rate /= divisor, a->rate_scale /= divisor;
}

static void free_animation(tides_animation *a) {
    free(a->bytes);
    free(a->part);
    free(a->path);
    free(a);
}

/* Allocates an animation; NULL with the reason in `status`. */
static tides_animation *create(const char *name, const td_animation_format *format, int32_t width, int32_t height, double rate,
                               tides_status *status, tides_error *error) {
    *status = TIDES_OK;
    if (width < 1 || height < 1 || width > 65536 || height > 65536)
        *status = td_fail(error, TIDES_BAD_ARGUMENT, "%s: an animation can't be %d x %d px", name, width, height);
    else if (!(rate >= 0.02 && rate <= 1000))
        *status = td_fail(error, TIDES_BAD_ARGUMENT, "%s: %g pictures a second aren't possible: give 0.02 to 1000", name, rate);
    if (*status != TIDES_OK) return NULL;
    tides_animation *made = td_alloc(1, sizeof *made, error);
    if (!made || !(made->path = td_strdup(name, error))) {
        free(made);
        *status = TIDES_NO_MEMORY;
        return NULL;
    }
    made->format = format;
    made->width = width;
    made->height = height;
    set_rate(made, rate);
    return made;
}

/* Writes the beginning, unless opening failed already. Gives the animation to the caller, or frees it on failure. */
static tides_status begin(tides_animation *a, tides_status opened, tides_animation **animation, tides_error *error) {
    const tides_status status = opened == TIDES_OK && a->format->begin ? a->format->begin(a, error) : opened;
    if (status == TIDES_OK)
        *animation = a;
    else
        tides_animation_abandon(a);
    return status;
}

static tides_status open_part(tides_animation *a, tides_error *error) {
    char *part = NULL;
    /* Y4M may go to a pipe. An APNG may not: its number of pictures is written into the beginning at the end. */
    const tides_status named = td_part_name(a->path, a->format == &td_animation_y4m, &part, error);
    if (named != TIDES_OK) return named;
    a->file = td_part_open(part, a->path);
    if (a->file) {
        a->part = part;
        return TIDES_OK;
    }
    const tides_status status = td_fail(error, TIDES_WRITE_FAILED, "%s: can't be created: %s", a->path, strerror(errno));
    free(part);
    return status;
}

tides_status tides_animation_open(const char *path, int32_t width, int32_t height, double pictures_per_second,
                                  tides_animation **animation, tides_error *error) {
    if (!path || !animation) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_animation_open: an argument is NULL");
    const td_animation_format *format = format_of(path);
    *animation = NULL;
    if (!format)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: animations are written as .png, .apng, .y4m or numbered frame%%04d.png",
                       path);
    tides_status status;
    tides_animation *made = create(path, format, width, height, pictures_per_second, &status, error);
    if (!made) return status;
    return begin(made, format == &td_animation_numbered ? TIDES_OK : open_part(made, error), animation, error);
}

/* Opens a copy of the descriptor, so that closing it leaves the caller's open. */
static tides_status open_stream(tides_animation *a, int32_t descriptor, tides_error *error) {
    const int copy = dup(descriptor);
    a->file = copy < 0 ? NULL : fdopen(copy, "wb");
    if (a->file) return TIDES_OK;
    const tides_status status = td_fail(error, TIDES_WRITE_FAILED, "the stream can't be written: %s", strerror(errno));
    if (copy >= 0) close(copy);
    return status;
}

tides_status tides_animation_stream(int32_t descriptor, int32_t width, int32_t height, double pictures_per_second,
                                    tides_animation **animation, tides_error *error) {
    if (!animation) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_animation_stream: animation is NULL");
    tides_status status;
    *animation = NULL;
    tides_animation *made = create("the stream", &td_animation_y4m, width, height, pictures_per_second, &status, error);
    return made ? begin(made, open_stream(made, descriptor, error), animation, error) : status;
}

tides_status tides_animation_append(tides_animation *animation, const uint8_t *rgb, tides_error *error) {
    if (!animation || !rgb) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_animation_append: an argument is NULL");
    const tides_status status = animation->format->append(animation, rgb, error);
    animation->count++;
    return status;
}

/* Closes the file, which also flushes a stream. */
static tides_status close_file(tides_animation *a, tides_error *error) {
    FILE *file = a->file;
    a->file = NULL;
    if (!file || fclose(file) == 0) return TIDES_OK;
    return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", a->path, strerror(errno));
}

tides_status tides_animation_finish(tides_animation *animation, tides_error *error) {
    if (!animation) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_animation_finish: animation is NULL");
    tides_status status = TIDES_OK;
    if (animation->count == 0) status = td_fail(error, TIDES_BAD_ARGUMENT, "%s: an animation needs a picture", animation->path);
    if (status == TIDES_OK && animation->format->end) status = animation->format->end(animation, error);
    if (status == TIDES_OK) status = close_file(animation, error);
    if (status == TIDES_OK && animation->part) {
        status = td_commit_file(animation->part, animation->path, error);
        free_animation(animation);
    } else if (status == TIDES_OK) {
        free_animation(animation);
    } else {
        tides_animation_abandon(animation);
    }
    return status;
}

void tides_animation_abandon(tides_animation *animation) {
    if (!animation) return;
    if (animation->file) fclose(animation->file);
    if (animation->part) td_remove_part(animation->part, animation->path);
    free_animation(animation);
}
