/* Files of arrays (tides_array_writer): checks shapes and order, chooses the format by the path's ending, writes a .part and
 * renames it. A format is a td_array_format. */
#include "td_array_sink.h"

#include <stdlib.h>
#include <string.h>

struct tides_array_writer {
    const td_array_format *format;
    td_array_sink sink;
};

static const td_array_format *const formats[] = {&td_array_npy, &td_array_npz, &td_array_h5, &td_array_exr};

static const td_array_format *format_of(const char *path) {
    const size_t length = strlen(path);
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        const size_t ending = strlen(formats[i]->ending);
        if (length > ending && strcmp(path + length - ending, formats[i]->ending) == 0) return formats[i];
    }
    return NULL;
}

static int is_name(const char *name) {
    const size_t length = name ? strlen(name) : 0;
    return length > 0 && length < sizeof((td_array_sink *)0)->name &&
           strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") == length;
}

static tides_status check(const char *path, const tides_array_shape *shape, tides_error *error) {
    if (!path || !shape || !is_name(shape->name))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "tides_array_writer_open: a path and a name of 1 to 31 letters, digits and _ must be given");
    /* The limits keep a window below 2^48 bytes. */
    if (shape->planes < 1 || shape->height < 1 || shape->width < 1 || shape->planes > 4096 || shape->height > 65536 ||
        shape->width > 65536)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "%s: an array of %d x %d x %d isn't written: 1 to 4096 planes of 1 to 65536 px", path, shape->planes,
                       shape->height, shape->width);
    if (!format_of(path)) return td_fail(error, TIDES_UNSUPPORTED, "%s: arrays are written as .npy, .npz, .h5 or .exr", path);
    return TIDES_OK;
}

static char *plane_name(const tides_array_shape *shape, int32_t plane, tides_error *error) {
    if (shape->plane_names) return td_strdup(shape->plane_names[plane], error);
    return td_format(error, "%s.%04d", shape->name, plane);
}

static tides_status fill_sink(td_array_sink *sink, const char *path, const tides_array_shape *shape, tides_error *error) {
    sink->planes = (size_t)shape->planes;
    sink->height = (size_t)shape->height;
    sink->width = (size_t)shape->width;
    sink->cells = sink->planes * sink->height * sink->width;
    snprintf(sink->name, sizeof sink->name, "%s", shape->name);
    sink->path = td_strdup(path, error);
    tides_status status = sink->path ? td_part_name(path, 0, &sink->part, error) : TIDES_NO_MEMORY;
    if (status != TIDES_OK) return status;
    sink->values = td_alloc(sink->cells, sizeof *sink->values, error);
    sink->plane_names = sink->values ? td_alloc(sink->planes, sizeof *sink->plane_names, error) : NULL;
    if (!sink->plane_names) return TIDES_NO_MEMORY;
    for (int32_t i = 0; i < shape->planes; i++)
        if (!(sink->plane_names[i] = plane_name(shape, i, error))) return TIDES_NO_MEMORY;
    return TIDES_OK;
}

static void free_writer(tides_array_writer *writer) {
    td_array_sink *sink = &writer->sink;
    for (size_t i = 0; sink->plane_names && i < sink->planes; i++) free(sink->plane_names[i]);
    free(sink->plane_names);
    free(sink->windows);
    free(sink->values);
    free(sink->part);
    free(sink->path);
    free(writer);
}

tides_status tides_array_writer_open(const char *path, const tides_array_shape *shape, tides_array_writer **writer,
                                     tides_error *error) {
    if (!writer) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_array_writer_open: writer is NULL");
    *writer = NULL;
    tides_status status = check(path, shape, error);
    if (status != TIDES_OK) return status;
    tides_array_writer *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    made->format = format_of(path);
    status = fill_sink(&made->sink, path, shape, error);
    if (status == TIDES_OK) status = made->format->create(&made->sink, error);
    if (status == TIDES_OK)
        *writer = made;
    else
        free_writer(made);
    return status;
}

tides_status tides_array_writer_append(tides_array_writer *writer, const double *array, int64_t start_ns, int64_t stop_ns,
                                       uint64_t events, tides_error *error) {
    if (!writer || !array) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_array_writer_append: an argument is NULL");
    td_array_sink *sink = &writer->sink;
    for (size_t i = 0; i < sink->cells; i++) sink->values[i] = (float)array[i];
    tides_status status = td_reserve((void **)&sink->windows, &sink->capacity, sink->count + 1, sizeof *sink->windows, error);
    if (status != TIDES_OK) return status;
    sink->windows[sink->count] = (td_array_window){start_ns, stop_ns, events};
    status = writer->format->append(sink, error);
    if (status == TIDES_OK) sink->count++;
    return status;
}

tides_status tides_array_writer_finish(tides_array_writer *writer, tides_error *error) {
    if (!writer) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_array_writer_finish: writer is NULL");
    const tides_status status = writer->format->complete(&writer->sink, error);
    writer->format->discard(&writer->sink);
    free_writer(writer);
    return status;
}

void tides_array_writer_abandon(tides_array_writer *writer) {
    if (!writer) return;
    writer->format->discard(&writer->sink);
    free_writer(writer);
}
