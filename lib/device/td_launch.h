/* Internal: buffers and launches on an OpenCL device, with their time. */
#ifndef TD_LAUNCH_H
#define TD_LAUNCH_H

#include "td_device.h"

/* A buffer that grows; growing loses the contents. */
typedef struct td_buffer {
    cl_mem memory;
    size_t bytes;
    void *near; /* the contents, if the host shares the memory; NULL: it doesn't */
} td_buffer;

/* Readable bytes behind the end: a kernel reads 16 numbers at a time, and may read past the last one. */
enum { TD_BUFFER_SLACK = 16 * sizeof(cl_double) };

tides_status td_buffer_reserve(tides_device *device, td_buffer *buffer, size_t bytes, tides_error *error);
void td_buffer_release(td_buffer *buffer);

/* Grows a buffer and keeps its first `kept` bytes, or all of its contents if those are fewer. What lies behind them isn't
 * copied: that would touch pages that nothing was written to. */
tides_status td_buffer_grow(tides_device *device, td_buffer *buffer, size_t kept, size_t bytes, tides_error *error);

/* Reserves and copies `bytes` from host memory; blocking. */
tides_status td_buffer_write(tides_device *device, td_buffer *buffer, const void *data, size_t bytes, tides_error *error);
/* td_buffer_write without a copy if memory is shared: the buffer then is `data` itself. So `data` must outlive the buffer and
 * stay unchanged, with TD_BUFFER_SLACK readable bytes behind its end. Nothing may write to the buffer until it has grown. */
tides_status td_buffer_lend(tides_device *device, td_buffer *buffer, void *data, size_t bytes, tides_error *error);
tides_status td_buffer_read(tides_device *device, const td_buffer *buffer, void *data, size_t bytes, tides_error *error);
/* Writes at byte `offset` of a buffer that is large enough; waits until it is done. */
tides_status td_buffer_write_at(tides_device *device, const td_buffer *buffer, size_t offset, const void *data, size_t bytes,
                                tides_error *error);
/* Reads from byte `offset` of a buffer. */
tides_status td_buffer_read_at(tides_device *device, const td_buffer *buffer, size_t offset, void *data, size_t bytes,
                               tides_error *error);
/* Reads the bytes [offset, offset + bytes) of the buffer to the same place in `data`. */
tides_status td_buffer_read_part(tides_device *device, const td_buffer *buffer, void *data, size_t offset, size_t bytes,
                                 tides_error *error);

/* Write and read without waiting (unless memory is shared), in order with launched kernels. `data` must stay unchanged until
 * the queue has finished. td_buffer_send doesn't reserve. */
tides_status td_buffer_send(tides_device *device, const td_buffer *buffer, const void *data, size_t bytes, tides_error *error);
tides_status td_buffer_fetch(tides_device *device, const td_buffer *buffer, void *data, size_t bytes, tides_error *error);

/* Makes a buffer's first `bytes` readable, at *at, once the queue has finished: in shared memory, or else in `host`, which
 * must have room if the device shares no memory. */
tides_status td_buffer_view(tides_device *device, const td_buffer *buffer, void *host, size_t bytes, const void **at,
                            tides_error *error);

/* One kernel argument: a buffer, or `bytes` of a value. */
typedef struct td_argument {
    const td_buffer *buffer;
    const void *value;
    size_t bytes;
} td_argument;
#define TD_BUFFER_ARGUMENT(b) \
    { &(b), NULL, 0 }
#define TD_VALUE_ARGUMENT(v) \
    { NULL, &(v), sizeof(v) }

typedef struct td_arguments {
    const td_argument *of;
    cl_uint count;
} td_arguments;
#define TD_ARGUMENTS(array) ((td_arguments){(array), (cl_uint)(sizeof(array) / sizeof *(array))})

/* Sets the arguments of a kernel and enqueues it. `local` may be NULL. `event` (may be NULL) belongs to the caller. */
tides_status td_launch(tides_device *device, cl_kernel kernel, cl_uint dimensions, const size_t *global, const size_t *local,
                       td_arguments arguments, cl_event *event, tides_error *error);

/* Number of work-items, and *local of a group, for `count` equal pieces of work and kernels with `lanes` lanes. On a CPU it
 * is one per thread, and they take pieces in turn; on a GPU one per piece. */
size_t td_even_items(int lanes, int count, size_t *local);

/* Starts the enqueued commands, for drivers that would wait for more. */
tides_status td_flush(tides_device *device, tides_error *error);

/* Run time of a finished event [s]; releases it and sets it to NULL. 0 in a forked process, whose driver can't be asked. */
double td_event_seconds(cl_event *event);

/* Waits until the queue is empty. Call it, also after a failure, before host memory is freed that commands read or write.
 * Returns `status` or, if that is TIDES_OK, the failure of waiting. */
tides_status td_finish(tides_device *device, tides_status status, tides_error *error);

#endif
