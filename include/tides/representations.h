/* Events as dense arrays, the way that networks take them. All arrays are the caller's, (planes x height x width) doubles,
 * row 0 on top, and are overwritten. Events must be in order of time and inside the image, else TIDES_BAD_ARGUMENT and the
 * array is left as it was; 0 events are fine. The calls touch nothing else: several threads may make arrays at once. Memory
 * beside the array: one value per cell for time surfaces, none for the others. */
#ifndef TIDES_REPRESENTATIONS_H
#define TIDES_REPRESENTATIONS_H

#include "tides/events.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What is done to a voxel grid's cells that aren't 0; those that are stay 0. Where all are equal, only the mean is taken
 * away. */
enum {
    TIDES_NORMALISE_NONE = 0,
    TIDES_NORMALISE_POPULATION = 1, /* (value - mean) / standard deviation over n: E2VID */
    TIDES_NORMALISE_SAMPLE = 2      /* the same over n - 1: DSEC */
};

/* Whose grid. */
enum {
    TIDES_VOXEL_E2VID = 0,   /* 5 bins from the first event to the last, population */
    TIDES_VOXEL_DSEC = 1,    /* 15 bins from the first event to the last, sample (E-RAFT's) */
    TIDES_VOXEL_TIMELENS = 2 /* 5 bins between two images: set start_ns and stop_ns; not normalised */
};

typedef struct tides_voxel_options {
    uint32_t size;     /* sizeof this struct */
    int32_t bins;      /* 1 to 4096 */
    int32_t normalise; /* TIDES_NORMALISE_* */
    int64_t start_ns,
        stop_ns; /* times of the first and last bin, events outside are left out; equal: of the first and last event */
} tides_voxel_options;

/* The options of TIDES_VOXEL_*; those of E2VID for anything else. */
TIDES_API void tides_voxel_options_defaults(tides_voxel_options *options, int32_t style);

/* grid (bins x height x width): each event's polarity (1, -1) is shared linearly between the two bins around
 * t* = (bins - 1) (t - start) / (stop - start). Where start and stop events are simultaneous all goes to bin 0. */
TIDES_MUST_CHECK TIDES_API tides_status tides_voxel_grid(const tides_event *events, size_t count, int32_t width, int32_t height,
                                                         const tides_voxel_options *options, double *grid, tides_error *error);

/* frame (2 x height x width): numbers of OFF and of ON events. */
TIDES_MUST_CHECK TIDES_API tides_status tides_event_frame(const tides_event *events, size_t count, int32_t width,
                                                          int32_t height, double *frame, tides_error *error);

/* surface (2 x height x width), OFF and ON: exp(-(time - t) / decay_s) for the latest event at or before `time_ns`, 0 where
 * there is none (HOTS). Later events are left out, so that the surfaces of successive times come from one stream. */
TIDES_MUST_CHECK TIDES_API tides_status tides_time_surface(const tides_event *events, size_t count, int32_t width,
                                                           int32_t height, int64_t time_ns, double decay_s, double *surface,
                                                           tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
