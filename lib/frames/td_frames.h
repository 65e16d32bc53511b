/* Internal: a frame sequence and its sources. A source (folder, .npy, HDF5) has two functions, read and close; times and
 * luminance are the same for all. */
#ifndef TD_FRAMES_H
#define TD_FRAMES_H

#include "td_base.h"
#include "tides/frames.h"

/* A side in pixels is at most this: events have 16 bits, and cameras are smaller. */
enum { TD_FRAME_SIDE_MAX = 16384, TD_FRAME_PLANES_MAX = 4096, TD_FRAME_DIMS_MAX = 6 };

/* Facts about the stored values of the frames that were read since it was cleared. */
typedef struct td_frame_seen {
    double largest;
    int32_t whole; /* 1: all were whole numbers */
} td_frame_seen;

/* Where pixels come from. */
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
    double *times;  /* [s] (count); as they are stored until td_frames_times */
    int32_t stored; /* 1: they are a file's own numbers, whose unit is to be found */
    int32_t digits; /* 10^digits [ns] are that unit, where the file says it; -1: it doesn't */
    double most;    /* largest value of the stored type; 0: floats; negative: the format itself says what 1 is */
    double full;    /* the stored value that is light 1; 0: the type's largest, floats' 1 */
    double bound;   /* a stored value beyond it contradicts what was decided */
    td_frame_seen seen;
    char note[400];
};

/* One file's values, as stored but for their scale: integers in [0, 1]. */
typedef struct td_picture_values {
    int32_t width, height, channels; /* 1 or 3 */
    int32_t bits;                    /* as stored: 8, 16; 0: floats */
    float *values;                   /* (height x width x channels), the caller's to free */
} td_picture_values;

/* frame_png.c */
tides_status td_frame_png(const char *path, td_picture_values *picture, tides_error *error);

/* frames_kind.c: 1 where a path, given alone, is one of frames by what is there: a video's name, a folder of pictures, an array
 * of three dimensions, an HDF5 file with a dataset of frames. */
int td_frames_is(const char *path);
int td_frames_is_video(const char *path); /* .y4m, or "-" for one from a pipe */

/* frame_values.c: one value as stored, and with 1 at its type's largest, to linear light; the same of a picture (count x
 * channels), whose type's largest is `unit`, to luminance. */
double td_frame_light(tides_frames *frames, double stored, double value);
void td_frame_luminance(tides_frames *frames, const float *values, double unit, int32_t channels, size_t count, double *Y);

/* frame_range.c: decides what full scale is, by frames all over the sequence; and whether a frame that was read agrees. */
tides_status td_frames_range(tides_frames *frames, tides_error *error);
tides_status td_frames_in_range(const tides_frames *frames, size_t index, tides_error *error);

/* The sources fill count, size and state of `frames`, and times where the file has them; each checks what it reads. */
tides_status td_frames_folder(tides_frames *frames, tides_error *error); /* frames_folder.c */
tides_status td_frames_npy(tides_frames *frames, tides_error *error);    /* frames_npy.c */
tides_status td_frames_hdf5(tides_frames *frames, tides_error *error);   /* frames_hdf5.c */
tides_status td_frames_y4m(tides_frames *frames, tides_error *error);    /* frames_y4m.c */
tides_status td_frames_aedat4(tides_frames *frames, tides_error *error); /* frames_aedat4.c */

/* frame_times.c: fills frames->times, by the order that tides_frames_open tells, and checks them. */
tides_status td_frames_times(tides_frames *frames, tides_error *error);

/* `names` of arrays that hold frames, and times; both end in NULL. */
extern const char *const td_frame_arrays[], *const td_frame_time_arrays[];

/* "(frames, height, width)" as sizes: TIDES_BAD_FILE where a side is 0 or too long. */
tides_status td_frames_take_shape(tides_frames *frames, const char *what, size_t count, size_t height, size_t width,
                                  tides_error *error);
/* Like td_frames_take_shape, from an array's `rank` dimensions, which may include its planes. */
tides_status td_frames_take_dims(tides_frames *frames, const char *what, const size_t *dims, int rank, tides_error *error);

/* Values of one frame: planes x height x width. */
size_t td_frames_values(const tides_frames *frames);

#endif
