/* Writes arrays of representations as numpy's .npy and .npz. */
#include "archive/td_npy.h"
#include "td_array_sink.h"

#include <stdlib.h>

static tides_status create(td_array_sink *sink, int zipped, tides_error *error) {
    td_npy_writer *writer = NULL;
    const size_t inner[3] = {sink->planes, sink->height, sink->width};
    tides_status status = td_npy_writer_open(sink->path, zipped, &writer, error);
    if (status == TIDES_OK)
        status = td_npy_writer_begin(writer, &(td_npy_form){sink->name, "'<f4'", sizeof(float), 4, inner}, error);
    if (status == TIDES_OK)
        sink->state = writer;
    else
        td_npy_writer_discard(writer);
    return status;
}

static tides_status create_npy(td_array_sink *sink, tides_error *error) { return create(sink, 0, error); }
static tides_status create_npz(td_array_sink *sink, tides_error *error) { return create(sink, 1, error); }

static tides_status append(td_array_sink *sink, tides_error *error) {
    return td_npy_writer_append(sink->state, sink->values, 1, error);
}

static tides_status complete(td_array_sink *sink, tides_error *error) {
    td_npy_writer *writer = sink->state;
    sink->state = NULL; /* td_npy_writer_close frees it */
    return td_npy_writer_close(writer, error);
}

/* Appends a column of the windows: 0 start_ns, 1 stop_ns, 2 events; all have 64 bits. */
static tides_status append_column(td_array_sink *sink, int column, tides_error *error) {
    static const char *const names[] = {"start_ns", "stop_ns", "events"};
    tides_status status =
        td_npy_writer_begin(sink->state,
                            &(td_npy_form){names[column], column < 2 ? "'<i8'" : "'<u8'", sizeof(int64_t), 1, NULL}, error);
    for (size_t i = 0; i < sink->count && status == TIDES_OK; i++) {
        const td_array_window *w = &sink->windows[i];
        const uint64_t value = column == 0 ? (uint64_t)w->start_ns : column == 1 ? (uint64_t)w->stop_ns : w->events;
        status = td_npy_writer_append(sink->state, &value, 1, error);
    }
    return status;
}

static tides_status complete_npz(td_array_sink *sink, tides_error *error) {
    for (int column = 0; column < 3; column++) {
        const tides_status status = append_column(sink, column, error);
        if (status != TIDES_OK) return status;
    }
    return complete(sink, error);
}

static void discard(td_array_sink *sink) {
    td_npy_writer_discard(sink->state);
    sink->state = NULL;
}

const td_array_format td_array_npy = {".npy", create_npy, append, complete, discard};
const td_array_format td_array_npz = {".npz", create_npz, append, complete_npz, discard};
