/* Writes an array of a representation as an OpenEXR image, with a channel for each plane. */
#include "td_array_sink.h"
#include "tides/image.h"

#include <stdlib.h>

static tides_status create(td_array_sink *sink, tides_error *error) {
    (void)sink, (void)error;
    return TIDES_OK;
}

static tides_status append(td_array_sink *sink, tides_error *error) {
    if (sink->count == 0) return TIDES_OK; /* the image is written when the file is completed */
    return td_fail(error, TIDES_UNSUPPORTED, "%s: an .exr holds one window: write .npy, .npz or .h5, or fewer windows",
                   sink->path);
}

static tides_status write(const td_array_sink *sink, tides_channel *channels, tides_error *error) {
    const td_array_window *window = &sink->windows[0];
    const size_t pixels = sink->height * sink->width;
    char start[32], stop[32], events[32];
    snprintf(start, sizeof start, "%lld", (long long)window->start_ns);
    snprintf(stop, sizeof stop, "%lld", (long long)window->stop_ns);
    snprintf(events, sizeof events, "%llu", (unsigned long long)window->events);
    const char *const attributes[] = {"start_ns", start, "stop_ns", stop, "events", events, NULL};
    for (size_t i = 0; i < sink->planes; i++) channels[i] = (tides_channel){sink->plane_names[i], sink->values + i * pixels};
    return tides_exr_write(sink->path, (int32_t)sink->width, (int32_t)sink->height, channels, (int32_t)sink->planes,
                           TIDES_EXR_ZIP, attributes, error);
}

static tides_status complete(td_array_sink *sink, tides_error *error) {
    if (sink->count == 0) return td_fail(error, TIDES_BAD_ARGUMENT, "%s: there is no window to write", sink->path);
    tides_channel *channels = td_alloc(sink->planes, sizeof *channels, error);
    if (!channels) return TIDES_NO_MEMORY;
    const tides_status status = write(sink, channels, error);
    free(channels);
    return status;
}

static void discard(td_array_sink *sink) { (void)sink; }

const td_array_format td_array_exr = {".exr", create, append, complete, discard};
