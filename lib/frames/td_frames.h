/* Internal: a sequence of frames and its sources. A source (folder, .npy, HDF5 ...) is two functions, read and close; times
 * and luminance are handled for all alike. */
#ifndef TD_FRAMES_H
#define TD_FRAMES_H

#include "td_base.h"
#include "tides/frames.h"

/* Limits of frames: a side [px], planes, and an array's dimensions. Events have 16-bit coordinates, and cameras are smaller. */
enum { TD_FRAME_SIDE_MAX = 16384, TD_FRAME_PLANES_MAX = 4096, TD_FRAME_DIMS_MAX = 6 };

/* Facts about the stored values of the frames read since it was cleared. */
typedef struct td_frame_seen {
    double largest;
    int32_t whole; /* 1: all values were whole numbers */
} td_frame_seen;

/* Source of the pixels. */
typedef struct td_frame_source {
    tides_status (*read)(tides_frames *frames, size_t index, double *Y, tides_error *error);
    void (*close)(void *state);
} td_frame_source;

struct tides_frames {
    const td_frame_source *source;
    void *state;
    char *path; /* for messages */
    tides_frames_options options;
    size_t count;
    int32_t width, height;
    double *times;  /* [s] (count); until td_frames_times, as stored */
    int32_t stored; /* 1: numbers from a file, whose unit has to be found */
    int32_t digits; /* 10^digits [ns] is that unit; -1: the file doesn't say */
    double most;    /* largest value of the stored type; 0: floats; negative: the format defines it */
    double full;    /* stored value of light 1; 0: the type's largest, or 1 for floats */
    double bound;   /* a larger stored value contradicts the chosen range */
    td_frame_seen seen;
    char note[400];
};

/* The values of one picture; integers are scaled to [0, 1]. */
typedef struct td_picture_values {
    int32_t width, height, channels; /* 1 or 3 */
    int32_t bits;                    /* bits per stored value: 8, 16; 0: floats */
    float *values;                   /* (height x width x channels), the caller frees it */
} td_picture_values;

/* Reads a PNG. */
tides_status td_frame_png(const char *path, td_picture_values *picture, tides_error *error);

/* 1 if a path without further options is one of frames. It may be a video, a folder of pictures, an array of three dimensions,
 * or an HDF5 file with a dataset of frames. */
int td_frames_is(const char *path);
int td_frames_is_video(const char *path); /* .y4m, or "-" for a pipe */

/* td_frame_light converts a value to linear light. It is given twice: as `stored`, and as `value`, its share of the type's
 * largest value. td_frame_luminance converts a picture of such shares (count x channels) to luminance; `unit` is the type's
 * largest value. */
double td_frame_light(tides_frames *frames, double stored, double value);
void td_frame_luminance(tides_frames *frames, const float *values, double unit, int32_t channels, size_t count, double *Y);

/* Finds full scale from frames all over the sequence; td_frames_in_range fails if a frame that was read contradicts it. */
tides_status td_frames_range(tides_frames *frames, tides_error *error);
tides_status td_frames_in_range(const tides_frames *frames, size_t index, tides_error *error);

/* Sources: each checks the file, and fills count, size and state of `frames`, and times if the file has them. */
tides_status td_frames_folder(tides_frames *frames, tides_error *error);
tides_status td_frames_npy(tides_frames *frames, tides_error *error);
tides_status td_frames_hdf5(tides_frames *frames, tides_error *error);
tides_status td_frames_y4m(tides_frames *frames, tides_error *error);
tides_status td_frames_aedat4(tides_frames *frames, tides_error *error);

/* Fills frames->times from the options or the file, and checks them. */
tides_status td_frames_times(tides_frames *frames, tides_error *error);

/* Names of arrays that hold frames, and of arrays that hold times; NULL-terminated. */
extern const char *const td_frame_arrays[], *const td_frame_time_arrays[];

/* Sets sizes from (frames, height, width); TIDES_BAD_FILE if a side is 0 or too long. */
tides_status td_frames_take_shape(tides_frames *frames, const char *what, size_t count, size_t height, size_t width,
                                  tides_error *error);
/* Sets sizes from an array's `rank` dimensions, which may include planes. */
tides_status td_frames_take_dims(tides_frames *frames, const char *what, const size_t *dims, int rank, tides_error *error);

/* Number of values in a frame: planes x height x width. */
size_t td_frames_values(const tides_frames *frames);

#endif
