/* A folder of pictures (.png, .exr) as frames, in natural order of their names. A picture is read when it is requested. */
#include "td_frames.h"

#include "td_folder.h"
#include "tides/image.h"

#include <stdlib.h>
#include <string.h>

typedef struct folder {
    td_folder list;
    int exr;
} folder;

static void close_folder(void *state) {
    folder *f = state;
    td_folder_free(&f->list);
    free(f);
}

/* Refuses a folder with other pictures, and tells how to convert them to a video. */
static tides_status refuse_folder(const char *path, tides_error *error) {
    static const char *const others[] = {".jpg", ".jpeg", ".webp", ".tif", ".tiff", ".bmp"};
    size_t count = 0, kind = 0;
    for (; kind < sizeof others / sizeof others[0] && !count; kind++) {
        td_folder found = {NULL, 0, 0};
        const tides_status status = td_folder_list(&found, path, others[kind], error);
        count = found.count;
        td_folder_free(&found);
        if (status != TIDES_OK) return status;
    }
    if (!count) return td_fail(error, TIDES_BAD_FILE, "%s: there is no .png or .exr in this folder", path);
    return td_fail(error, TIDES_BAD_FILE,
                   "%s: holds %zu %s pictures, where .png or .exr are read: ffmpeg -pattern_type glob -i '%s/*%s' -f "
                   "yuv4mpegpipe - "
                   "| tides simulate - -o events.h5 makes events of them",
                   path, count, others[kind - 1], path, others[kind - 1]);
}

static tides_status scan(folder *f, const char *path, tides_error *error) {
    tides_status status = td_folder_list(&f->list, path, ".png", error);
    const size_t png = f->list.count;
    if (status == TIDES_OK) status = td_folder_list(&f->list, path, ".exr", error);
    if (status != TIDES_OK) return status;
    if (!f->list.count) return refuse_folder(path, error);
    if (png && png < f->list.count)
        return td_fail(error, TIDES_BAD_FILE, "%s: holds .png and .exr; keep the frames of one kind in a folder of their own",
                       path);
    f->exr = !png;
    return TIDES_OK;
}

/* -- EXR ------------------------------------------------------------------------------------------------------------------- */

static const float *find_channel(const tides_exr *exr, int32_t count, const char *name) {
    for (int32_t i = 0; i < count; i++)
        if (strcmp(tides_exr_name(exr, i), name) == 0) return tides_exr_pixels(exr, i);
    return NULL;
}

/* Takes channel Y, or else R, G and B, or else the only channel. */
static tides_status take_channels(const tides_exr *exr, const char *path, td_picture_values *picture, tides_error *error) {
    int32_t width, height, count;
    tides_exr_size(exr, &width, &height, &count);
    size_t pixels = (size_t)width * (size_t)height;
    const float *planes[3] = {find_channel(exr, count, "Y"), NULL, NULL};
    int32_t channels = 1;
    if (!planes[0] && count == 1) planes[0] = tides_exr_pixels(exr, 0);
    if (!planes[0]) {
        static const char *const names[3] = {"R", "G", "B"};
        channels = 3;
        for (int c = 0; c < 3; c++)
            if (!(planes[c] = find_channel(exr, count, names[c])))
                return td_fail(error, TIDES_BAD_FILE, "%s: has neither a channel Y nor R, G and B", path);
    }
    float *values = td_alloc(pixels * (size_t)channels, sizeof *values, error);
    if (!values) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < pixels; i++)
        for (int32_t c = 0; c < channels; c++) values[i * (size_t)channels + (size_t)c] = planes[c][i];
    *picture = (td_picture_values){width, height, channels, 0, values};
    return TIDES_OK;
}

static tides_status read_exr(const char *path, td_picture_values *picture, tides_error *error) {
    tides_exr *exr = NULL;
    tides_status status = tides_exr_read(path, &exr, error);
    if (status == TIDES_OK) status = take_channels(exr, path, picture, error);
    tides_exr_destroy(exr);
    return status;
}

/* -- the source ------------------------------------------------------------------------------------------------------------ */

static tides_status read_picture(const folder *f, size_t index, td_picture_values *picture, tides_error *error) {
    return f->exr ? read_exr(f->list.files[index], picture, error) : td_frame_png(f->list.files[index], picture, error);
}

/* The largest value of the stored type; 1 for floats. */
static double most_of(const td_picture_values *picture) { return picture->bits == 16 ? 65535 : picture->bits ? 255 : 1; }

static tides_status read_frame(tides_frames *frames, size_t index, double *Y, tides_error *error) {
    const folder *f = frames->state;
    td_picture_values picture = {.values = NULL};
    tides_status status = read_picture(f, index, &picture, error);
    if (status != TIDES_OK) return status;
    if (picture.width == frames->width && picture.height == frames->height)
        td_frame_luminance(frames, picture.values, most_of(&picture), picture.channels,
                           (size_t)picture.width * (size_t)picture.height, Y);
    else
        status = td_fail(error, TIDES_BAD_FILE, "%s: is %d x %d px, but the first frame is %d x %d", f->list.files[index],
                         picture.width, picture.height, frames->width, frames->height);
    free(picture.values);
    return status;
}

tides_status td_frames_folder(tides_frames *frames, tides_error *error) {
    static const td_frame_source source = {read_frame, close_folder};
    folder *f = td_alloc(1, sizeof *f, error);
    if (!f) return TIDES_NO_MEMORY;
    frames->source = &source;
    frames->state = f;
    td_picture_values first = {.values = NULL};
    tides_status status = scan(f, frames->path, error);
    if (status == TIDES_OK) status = read_picture(f, 0, &first, error);
    if (status == TIDES_OK)
        status =
            td_frames_take_shape(frames, f->list.files[0], f->list.count, (size_t)first.height, (size_t)first.width, error);
    if (status == TIDES_OK && first.bits) frames->most = most_of(&first);
    free(first.values);
    return status;
}
