/* Events as dense arrays, as networks take them. All arrays are the caller's, (planes x height x width) doubles, row 0 on
 * top, and are overwritten. Events must be in order of time and inside the image, else TIDES_BAD_ARGUMENT, and the array is
 * unchanged. 0 events are fine. Several threads may make arrays at once. Memory besides the array: one value per cell for
 * time surfaces, none for others. */
#ifndef TIDES_REPRESENTATIONS_H
#define TIDES_REPRESENTATIONS_H

#include "tides/events.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Normalisation of the cells of a voxel grid that aren't 0; others stay 0. If all values are equal, only the mean is
 * subtracted. */
enum {
    TIDES_NORMALISE_NONE = 0,
    TIDES_NORMALISE_POPULATION = 1, /* (value - mean) / standard deviation over n: E2VID */
    TIDES_NORMALISE_SAMPLE = 2      /* the same over n - 1: DSEC */
};

/* The method whose voxel grid is made. */
enum {
    TIDES_VOXEL_E2VID = 0,   /* 5 bins from the first event to the last, population */
    TIDES_VOXEL_DSEC = 1,    /* 15 bins from the first event to the last, sample (E-RAFT's) */
    TIDES_VOXEL_TIMELENS = 2 /* 5 bins between two images: set start_ns and stop_ns; not normalised */
};

/* Options of a voxel grid; fill with tides_voxel_options_defaults. */
typedef struct tides_voxel_options {
    uint32_t size;     /* sizeof this struct */
    int32_t bins;      /* 1 to 4096 */
    int32_t normalise; /* TIDES_NORMALISE_* */
    /* Times of the first and last bin, events outside are left out; equal: of the first and last event. */
    int64_t start_ns, stop_ns;
} tides_voxel_options;

/* Sets the options of `style` (TIDES_VOXEL_*); for other numbers those of E2VID. */
TIDES_API void tides_voxel_options_defaults(tides_voxel_options *options, int32_t style);

/* grid (bins x height x width): each event's polarity (1, -1) is shared linearly between the two bins around t* = (bins - 1)
 * (t - start) / (stop - start). If start and stop events are simultaneous, all goes to bin 0. */
TIDES_MUST_CHECK TIDES_API tides_status tides_voxel_grid(const tides_event *events, size_t count, int32_t width, int32_t height,
                                                         const tides_voxel_options *options, double *grid, tides_error *error);

/* frame (2 x height x width): numbers of OFF and of ON events. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_frame(const tides_event *events, size_t count, int32_t width,
                                                          int32_t height, double *frame, tides_error *error);

/* surface (2 x height x width), OFF and ON: exp(-(time - t) / decay_s) for the latest event at or before `time_ns`, 0 if
 * there is none (HOTS). Later events are ignored, so surfaces of successive times can come from one stream. */
TIDES_MUST_CHECK TIDES_API tides_status tides_time_surface(const tides_event *events, size_t count, int32_t width,
                                                           int32_t height, int64_t time_ns, double decay_s, double *surface,
                                                           tides_error *error);

/* The arrays of a file: their dataset's name (letters, digits and _, at most 31), their shape, and the planes' names in an EXR
 * file (NULL: name.0000 ...). Strings are copied. */
typedef struct tides_array_shape {
    const char *name;               /* of the dataset */
    int32_t planes, height, width;  /* of one array */
    const char *const *plane_names; /* (planes), or NULL */
} tides_array_shape;

/* A file of arrays that is being written. Opaque. */
typedef struct tides_array_writer tides_array_writer;

/* Starts a file of arrays of one shape, as float32 in the order of their windows, by the ending of `path`:
 *   .npy        (windows x planes x height x width)
 *   .npz, .h5   the same under `name`; start_ns and stop_ns (int64) and events (uint64) have one value for each window
 *   .exr        one window only, a channel for each plane; start_ns, stop_ns and events are attributes
 * Streamed (.npz below 4 GiB), and written beside as `path` + ".part". TIDES_UNSUPPORTED: another ending. */
TIDES_MUST_CHECK TIDES_API tides_status tides_array_writer_open(const char *path, const tides_array_shape *shape,
                                                                tides_array_writer **writer, tides_error *error);

/* Appends a window's array: `start_ns` to `stop_ns`, made from `events` events. After a failure only _abandon may be called. */
TIDES_MUST_CHECK TIDES_API tides_status tides_array_writer_append(tides_array_writer *writer, const double *array,
                                                                  int64_t start_ns, int64_t stop_ns, uint64_t events,
                                                                  tides_error *error);

/* Completes the file and renames it; the writer is gone, whatever is returned. An .exr needs its window. */
TIDES_MUST_CHECK TIDES_API tides_status tides_array_writer_finish(tides_array_writer *writer, tides_error *error);

/* Removes the unfinished file. NULL is fine. */
TIDES_API void tides_array_writer_abandon(tides_array_writer *writer);

#ifdef __cplusplus
}
#endif
#endif
