/* Lets OpenEXRCore read and write through our own file descriptor, so that the first error is kept, and files are renamed
 * when they are complete. */
#include "td_exr.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void note(td_exr_stream *stream, const char *message) {
    if (!stream->message[0]) snprintf(stream->message, sizeof stream->message, "%s", message);
}

/* Stores the first message: later ones are consequences of it. This handler can't be used for writing: OpenEXRCore calls it
 * with the context's lock held, and exr_get_user_data would wait for that lock for ever. */
static void on_read_error(exr_const_context_t context, exr_result_t code, const char *message) {
    void *stream = NULL;
    (void)code;
    if (context && exr_get_user_data(context, &stream) == EXR_ERR_SUCCESS && stream) note(stream, message);
}

/* Does nothing: a failed write has already stored the system's reason, and other failures have a text by their code. */
static void on_write_error(exr_const_context_t context, exr_result_t code, const char *message) {
    (void)context;
    (void)code;
    (void)message;
}

static int64_t read_at(exr_const_context_t context, void *user, void *buffer, uint64_t bytes, uint64_t offset,
                       exr_stream_error_func_ptr_t failed) {
    td_exr_stream *stream = user;
    uint64_t done = 0;
    while (done < bytes) {
        ssize_t got = pread(stream->descriptor, (char *)buffer + done, bytes - done, (off_t)(offset + done));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) {
            note(stream, strerror(errno));
            failed(context, EXR_ERR_READ_IO, "reading failed");
            return -1;
        }
        if (got == 0) break; /* the caller decides about a short read */
        done += (uint64_t)got;
    }
    return (int64_t)done;
}

static int64_t size_of(exr_const_context_t context, void *user) {
    struct stat facts;
    (void)context;
    return fstat(((td_exr_stream *)user)->descriptor, &facts) == 0 ? (int64_t)facts.st_size : -1;
}

static int64_t write_at(exr_const_context_t context, void *user, const void *buffer, uint64_t bytes, uint64_t offset,
                        exr_stream_error_func_ptr_t failed) {
    td_exr_stream *stream = user;
    uint64_t done = 0;
    while (done < bytes) {
        ssize_t put = pwrite(stream->descriptor, (const char *)buffer + done, bytes - done, (off_t)(offset + done));
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) {
            note(stream, put < 0 ? strerror(errno) : "nothing more can be written");
            failed(context, EXR_ERR_WRITE_IO, "writing failed");
            return -1;
        }
        done += (uint64_t)put;
    }
    return (int64_t)done;
}

exr_context_initializer_t td_exr_reading(td_exr_stream *stream) {
    exr_context_initializer_t initializer = EXR_DEFAULT_CONTEXT_INITIALIZER;
    initializer.error_handler_fn = on_read_error;
    initializer.user_data = stream;
    initializer.read_fn = read_at;
    initializer.size_fn = size_of;
    /* refuses a file without a table of chunks, which was never completed */
    initializer.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    return initializer;
}

exr_context_initializer_t td_exr_writing(td_exr_stream *stream) {
    exr_context_initializer_t initializer = EXR_DEFAULT_CONTEXT_INITIALIZER;
    initializer.error_handler_fn = on_write_error;
    initializer.user_data = stream;
    initializer.write_fn = write_at;
    return initializer;
}

const char *td_exr_reason(const td_exr_stream *stream, exr_result_t result) {
    return stream->message[0] ? stream->message : exr_get_default_error_message(result);
}
