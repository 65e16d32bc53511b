/* Test support: frames and event streams of the shared golden files, and a method's events from these frames. */
#ifndef TESTS_SUPPORT_GOLDEN_EVENTS_H
#define TESTS_SUPPORT_GOLDEN_EVENTS_H

#include "tests/support/npz.h"
#include "tides/baselines.h"

#include <cjson/cJSON.h>

/* Zeroed memory; running out of it ends the test program. */
void *golden_allocate(size_t count, size_t size);

typedef struct golden_movie {
    char path[1024];
    double *Y, *t; /* luminance (frames x height x width), seconds (frames) */
    size_t frames, pixels;
    int32_t width, height;
} golden_movie;

/* Reads the frames of `path`, unless `movie` (zeroed at first) has them already; returns 0, or -1 if they can't be read. */
int golden_movie_load(golden_movie *movie, const char *path);
void golden_movie_free(golden_movie *movie);

/* Events by (t, y, x, polarity). */
typedef struct golden_stream {
    tides_event *events;
    size_t count, capacity;
} golden_stream;

/* A sink that appends events to a golden_stream. */
int golden_keep(void *stream, const tides_event *events, size_t count);

/* The events of a file, sorted; its times are in units of `unit` nanoseconds. */
golden_stream golden_stream_read(npz *file, double unit);

/* Compares two events by pixel, then time, then polarity; for qsort. */
int golden_compare_places(const void *a, const void *b);

/* The events of a method for all frames; a failure ends the test. */
golden_stream golden_simulate(const tides_baseline_params *params, const golden_movie *movie);

/* One file, its frames and its parameters. */
typedef struct golden_file {
    const char *name;
    const golden_movie *movie;
    npz *file;
    const cJSON *params;
    int compared; /* output: number of comparisons that `visit` made */
} golden_file;

/* A parameter, or `otherwise`. */
double golden_number(const cJSON *params, const char *key, double otherwise);

/* Calls `visit` for each .npz below golden/ of the shared data whose name holds `part` and that has frames; returns the sum
 * of their `compared`. Scene A is left out: its signal returns to levels exactly, so that rounding decides whether a pixel
 * fires. */
size_t golden_visit(const char *part, void (*visit)(golden_file *file));

#endif
