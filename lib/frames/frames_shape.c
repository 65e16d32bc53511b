/* Checks the dimensions of a source's array, and sets count and size of the frames, or fails with the reason. */
#include "td_frames.h"

tides_status td_frames_take_shape(tides_frames *frames, const char *what, size_t count, size_t height, size_t width,
                                  tides_error *error) {
    if (count < 1 || height < 1 || width < 1 || height > TD_FRAME_SIDE_MAX || width > TD_FRAME_SIDE_MAX)
        return td_fail(error, TIDES_BAD_FILE, "%s: %zu frames of %zu x %zu px; a side must lie in [1, %d]", what, count, width,
                       height, (int)TD_FRAME_SIDE_MAX);
    frames->count = count;
    frames->width = (int32_t)width;
    frames->height = (int32_t)height;
    return TIDES_OK;
}

/* The product of dimensions; a number above the limit of planes if it overflows. */
static size_t planes_of(const size_t *dims, int count) {
    size_t planes = 1;
    for (int i = 0; i < count; i++)
        planes = dims[i] > TD_FRAME_PLANES_MAX || planes > TD_FRAME_PLANES_MAX ? TD_FRAME_PLANES_MAX + 1 : planes * dims[i];
    return planes;
}

tides_status td_frames_take_dims(tides_frames *frames, const char *what, const size_t *dims, int rank, tides_error *error) {
    const size_t planes = (size_t)frames->options.planes;
    const int inner = rank - 3; /* dimensions of planes, if the first one counts frames */
    if (planes == 1 && rank != 3)
        return td_fail(error, TIDES_BAD_FILE, "%s: has %d dimensions; frames have the shape (frames, height, width)", what,
                       rank);
    if (inner >= 0 && planes_of(dims + 1, inner) == planes)
        return td_frames_take_shape(frames, what, dims[0], dims[rank - 2], dims[rank - 1], error);
    if (inner >= 0 && planes_of(dims, inner + 1) == planes)
        return td_frames_take_shape(frames, what, 1, dims[rank - 2], dims[rank - 1], error);
    return td_fail(error, TIDES_BAD_FILE,
                   "%s: its dimensions don't make %zu values per pixel; voxel grids have the shape (intervals, 2, 10, height, "
                   "width)",
                   what, planes);
}

size_t td_frames_values(const tides_frames *frames) {
    return (size_t)frames->options.planes * (size_t)frames->width * (size_t)frames->height;
}
