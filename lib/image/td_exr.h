/* Internal: OpenEXRCore over our own file descriptor, and the encoder with its work-around exposed to the test of it. */
#ifndef TD_EXR_H
#define TD_EXR_H

#include "tides/image.h"

#include <openexr.h>

/* Named planes in memory, as they are read; also those that other files are turned to (lib/frames/truth_file.c). */
struct tides_exr {
    int32_t width, height, count;
    char **names;
    float *pixels; /* (count x height x width) */
};

/* The stream that OpenEXRCore reads or writes through. With our own stream its messages reach us instead of stderr, and the
 * system's reason for a failed write isn't lost. */
typedef struct td_exr_stream {
    int descriptor;
    char message[300]; /* the first thing that went wrong, in OpenEXR's or the system's words; "" */
} td_exr_stream;

/* The initializers for exr_start_read and exr_start_write; `stream` must outlive the context. */
exr_context_initializer_t td_exr_reading(td_exr_stream *stream);
exr_context_initializer_t td_exr_writing(td_exr_stream *stream);

/* Why `result` happened: the stream's message, else OpenEXR's text for the code. */
const char *td_exr_reason(const td_exr_stream *stream, exr_result_t result);

/* Watches, or switches off, the work-around for the encoder's defect (image_exr.c). For the test that proves it necessary. */
typedef struct td_exr_trace {
    int32_t leave_defect; /* in: 1 writes what OpenEXR alone would */
    int32_t equal_chunks; /* out: chunks that deflated to exactly their own size */
} td_exr_trace;

/* tides_exr_write with a nullable trace. */
tides_status td_exr_write_traced(const char *path, int32_t width, int32_t height, const tides_channel *channels, int32_t count,
                                 int32_t compression, const char *const *attributes, td_exr_trace *trace, tides_error *error);

#endif
