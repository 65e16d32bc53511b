/* Internal: reading and writing OpenEXR through our own file descriptor, and access to a work-around for its test. */
#ifndef TD_EXR_H
#define TD_EXR_H

#include "tides/image.h"

#include <openexr.h>

/* Named planes in memory, from an OpenEXR file or from another kind of file with ground truth. */
struct tides_exr {
    int32_t width, height, count;
    char **names;
    float *pixels; /* (count x height x width) */
};

/* A stream for OpenEXRCore. With our own stream, messages come to us instead of stderr, and the system's reason for a failed
 * write is kept. */
typedef struct td_exr_stream {
    int descriptor;
    char message[300]; /* the first failure, in OpenEXR's or the system's words, or "" */
} td_exr_stream;

/* The initializers for exr_start_read and exr_start_write; `stream` must outlive the context. */
exr_context_initializer_t td_exr_reading(td_exr_stream *stream);
exr_context_initializer_t td_exr_writing(td_exr_stream *stream);

/* The reason of `result`: the stream's message, or else OpenEXR's text for the code. */
const char *td_exr_reason(const td_exr_stream *stream, exr_result_t result);

/* Observes, or switches off, the work-around for a defect of OpenEXR's encoder: for the test that it is needed. */
typedef struct td_exr_trace {
    int32_t leave_defect; /* in: 1: write as OpenEXR alone would */
    int32_t equal_chunks; /* out: number of chunks that deflated to exactly their own size */
} td_exr_trace;

/* tides_exr_write of a picture without attributes, with a trace (may be NULL). */
tides_status td_exr_write_traced(const char *path, int32_t width, int32_t height, const tides_channel *channels, int32_t count,
                                 int32_t compression, td_exr_trace *trace, tides_error *error);

#endif
