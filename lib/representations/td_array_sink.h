/* Internal: a file of arrays that is being written. A format is a set of functions that write it. */
#ifndef TD_ARRAY_SINK_H
#define TD_ARRAY_SINK_H

#include "td_base.h"
#include "tides/representations.h"

/* Values of each window, kept until the file is completed. */
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
    float *values; /* array of the latest window */
    void *state;   /* owned by the format */
} td_array_sink;

/* `append` writes sink->values as window number sink->count. `complete` ends the file and renames it. `discard` removes an
 * incomplete file, and frees the state in any case (after `complete` too). */
typedef struct td_array_format {
    const char *ending;
    tides_status (*create)(td_array_sink *sink, tides_error *error);
    tides_status (*append)(td_array_sink *sink, tides_error *error);
    tides_status (*complete)(td_array_sink *sink, tides_error *error);
    void (*discard)(td_array_sink *sink);
} td_array_format;

extern const td_array_format td_array_npy, td_array_npz, td_array_h5, td_array_exr;

#endif
