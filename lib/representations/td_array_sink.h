/* Internal: a file of arrays being written; each format is a set of functions over one sink. */
#ifndef TD_ARRAY_SINK_H
#define TD_ARRAY_SINK_H

#include "td_base.h"
#include "tides/representations.h"

/* Facts of each window that are kept until the file ends. */
typedef struct td_array_window {
    int64_t start_ns, stop_ns;
    uint64_t events;
} td_array_window;

typedef struct td_array_sink {
    char *path, *part;
    char name[32], **plane_names;
    size_t planes, height, width, cells;
    td_array_window *windows;
    size_t count, capacity;
    float *values; /* the latest array */
    void *state;   /* the format's */
} td_array_sink;

/* `append` writes sink->values, window number sink->count; `complete` ends the file and puts it in place; `discard` removes
 * what is there, and frees the state in any case (after `complete` too). */
typedef struct td_array_format {
    const char *ending;
    tides_status (*create)(td_array_sink *sink, tides_error *error);
    tides_status (*append)(td_array_sink *sink, tides_error *error);
    tides_status (*complete)(td_array_sink *sink, tides_error *error);
    void (*discard)(td_array_sink *sink);
} td_array_format;

extern const td_array_format td_array_npy, td_array_npz, td_array_h5, td_array_exr;

#endif
