/* tides_frames, a sequence of frames from a file, a folder or memory: opens it, stores size and times of the frames, and
 * reads single frames. Each kind of file has a source, which reads its pixels. */
#include "td_frames.h"

#include "td_folder.h"
#include "td_kinds.h"
#include "td_struct.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

const char *const td_frame_arrays[] = {"Y", "frames", "images", "voxels", NULL};
const char *const td_frame_time_arrays[] = {"t", "timestamps", NULL};

void tides_frames_options_defaults(tides_frames_options *options) {
    *options = (tides_frames_options){.size = sizeof *options, .luminance = {0.2126, 0.7152, 0.0722}, .planes = 1};
}

/* -- opening --------------------------------------------------------------------------------------------------------------- */

static tides_status open_source(tides_frames *frames, tides_error *error) {
    struct stat facts;
    const char *path = frames->path;
    const int32_t is_pipe = strcmp(path, "-") == 0;
    if (!is_pipe && stat(path, &facts) != 0)
        return td_fail(error, TIDES_FILE_NOT_FOUND, "%s: there is no such file or folder", path);
    if (!is_pipe && S_ISCHR(facts.st_mode))
        return td_fail(error, TIDES_BAD_FILE, "%s: is a device, which has no end: give a file, a folder, or a pipe (-)", path);
    if (is_pipe || td_ends_in(path, ".y4m") || S_ISFIFO(facts.st_mode)) {
        if (frames->options.planes == 1) return td_frames_y4m(frames, error);
        return td_fail(error, TIDES_BAD_FILE, "%s: is a video; voxel grids come from .npy, .npz, .h5 or .hdf5", path);
    }
    if (td_is_folder(path) && frames->options.planes > 1)
        return td_fail(error, TIDES_BAD_FILE, "%s: is a folder; voxel grids come from .npy, .npz, .h5 or .hdf5", path);
    if (td_is_folder(path)) return td_frames_folder(frames, error);
    if (td_ends_in(path, ".npy") || td_ends_in(path, ".npz")) return td_frames_npy(frames, error);
    if (td_ends_in(path, ".h5") || td_ends_in(path, ".hdf5")) return td_frames_hdf5(frames, error);
    if (td_ends_in(path, ".aedat4") && frames->options.planes == 1) return td_frames_aedat4(frames, error);
    return td_fail(error, TIDES_BAD_FILE,
                   "%s: frames come from a folder of .png or .exr, or from .y4m, .npy, .npz, .h5, .hdf5 or .aedat4", path);
}

static tides_status check_options(const tides_frames_options *o, tides_error *error) {
    if (o->transfer < TIDES_TRANSFER_LINEAR || o->transfer > TIDES_TRANSFER_SRGB || o->unit < TIDES_TIME_AUTO ||
        o->unit > TIDES_TIME_NS)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "tides_frames_open: options.transfer or options.unit is no value of its list");
    if (o->planes < 1 || o->planes > TD_FRAME_PLANES_MAX)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_frames_open: options.planes = %d; it must lie in [1, %d]", o->planes,
                       (int)TD_FRAME_PLANES_MAX);
    if (!(o->frames_per_second >= 0 && o->frames_per_second <= 1e9))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_frames_open: frames_per_second = %.9g; it must lie in [0, 1e9]",
                       o->frames_per_second);
    if (!(o->full_scale >= 0 && o->full_scale <= 1e19))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_frames_open: full_scale = %.9g; it must lie in [0, 1e19]",
                       o->full_scale);
    return TIDES_OK;
}

tides_status tides_frames_open(const char *path, const tides_frames_options *options, tides_frames **frames,
                               tides_error *error) {
    if (!path || !options || !frames)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_frames_open: path, options or frames is NULL");
    tides_frames_options own;
    tides_frames_options_defaults(&own);
    tides_status status = TD_TAKE_STRUCT(tides_frames_options, &own, options, error);
    if (status == TIDES_OK) status = check_options(&own, error);
    if (status != TIDES_OK) return status;
    tides_frames *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    made->options = own;
    made->path = td_strdup(path, error);
    status = made->path ? open_source(made, error) : TIDES_NO_MEMORY;
    /* If a source can't read the file, td_kind_judge checks if the file is of a known kind without frames; its error then
     * replaces the source's. */
    if (made->path) status = td_kind_judge(path, TD_WANTS_FRAMES, status, error);
    if (status == TIDES_OK) status = td_frames_times(made, error);
    if (status == TIDES_OK) status = td_frames_range(made, error);
    made->options.timestamps = NULL; /* the string is the caller's, and its file has been read */
    if (status == TIDES_OK)
        *frames = made;
    else
        tides_frames_close(made);
    return status;
}

void tides_frames_close(tides_frames *frames) {
    if (!frames) return;
    if (frames->source && frames->state) frames->source->close(frames->state);
    free(frames->times);
    free(frames->path);
    free(frames);
}

/* -- memory ---------------------------------------------------------------------------------------------------------------- */

static tides_status read_memory(tides_frames *frames, size_t index, double *Y, tides_error *error) {
    (void)error;
    const double *const *all = frames->state;
    size_t pixels = (size_t)frames->width * (size_t)frames->height;
    memcpy(Y, *all + index * pixels, pixels * sizeof *Y);
    return TIDES_OK;
}

tides_status tides_frames_from_memory(const double *Y, const double *times, size_t count, int32_t width, int32_t height,
                                      tides_frames **frames, tides_error *error) {
    static const td_frame_source memory = {read_memory, free};
    if (!Y || !times || !frames)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_frames_from_memory: Y, times or frames is NULL");
    if (width < 1 || height < 1)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_frames_from_memory: %d x %d px is no size", width, height);
    tides_frames *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    tides_frames_options_defaults(&made->options);
    made->source = &memory;
    made->bound = INFINITY;
    made->path = td_strdup("frames in memory", error);
    made->times = td_alloc(count, sizeof *made->times, error);
    const double **state = td_alloc(1, sizeof *state, error);
    made->state = state;
    tides_status status = made->path && made->times && state ? TIDES_OK : TIDES_NO_MEMORY;
    if (status == TIDES_OK) {
        *state = Y;
        status = td_frames_take_shape(made, made->path, count, (size_t)height, (size_t)width, error);
    }
    if (status == TIDES_OK) {
        memcpy(made->times, times, count * sizeof *times);
        status = td_frames_times(made, error);
    }
    if (status == TIDES_OK)
        *frames = made;
    else
        tides_frames_close(made);
    return status;
}

/* -- reading --------------------------------------------------------------------------------------------------------------- */

size_t tides_frames_count(const tides_frames *frames) { return frames->count; }

void tides_frames_size(const tides_frames *frames, int32_t *width, int32_t *height) {
    if (width) *width = frames->width;
    if (height) *height = frames->height;
}

int32_t tides_frames_planes(const tides_frames *frames) { return frames->options.planes; }

double tides_frames_time(const tides_frames *frames, size_t index) {
    return index < frames->count ? frames->times[index] : NAN;
}

tides_status tides_frames_read(tides_frames *frames, size_t index, double *Y, tides_error *error) {
    if (!frames || !Y) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_frames_read: frames or Y is NULL");
    if (index >= frames->count)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: there is no frame %zu; it has %zu, from 0 on", frames->path, index,
                       frames->count);
    frames->seen = (td_frame_seen){0, 0};
    tides_status status = frames->source->read(frames, index, Y, error);
    if (status == TIDES_OK) status = td_frames_in_range(frames, index, error);
    size_t pixels = (size_t)frames->width * (size_t)frames->height, values = td_frames_values(frames);
    for (size_t i = 0; status == TIDES_OK && i < values; i++)
        if (!(Y[i] >= 0) || isinf(Y[i]))
            status =
                td_fail(error, TIDES_BAD_FILE, "%s: frame %zu: pixel (%zu, %zu) is %.9g; values are finite and not negative",
                        frames->path, index, i % (size_t)frames->width, i % pixels / (size_t)frames->width, Y[i]);
    return status;
}
