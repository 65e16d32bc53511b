/* Internal: buffers and launches on an OpenCL device, with their time. */
#ifndef TD_LAUNCH_H
#define TD_LAUNCH_H

#include "td_device.h"

/* A buffer that grows; contents are lost when it does. */
typedef struct td_buffer {
    cl_mem memory;
    size_t bytes;
    void *near; /* its contents, where the host shares them (td_near.h); NULL: it doesn't */
} td_buffer;

/* Bytes behind the end that may be read: a kernel that takes 16 numbers at a time ends where the last ones do. */
enum { TD_BUFFER_SLACK = 16 * sizeof(cl_double) };

tides_status td_buffer_reserve(tides_device *device, td_buffer *buffer, size_t bytes, tides_error *error);
void td_buffer_release(td_buffer *buffer);

/* As td_buffer_reserve, but what the buffer holds stays. */
tides_status td_buffer_grow(tides_device *device, td_buffer *buffer, size_t bytes, tides_error *error);

/* Reserves and copies `bytes` from host memory; blocking. */
tides_status td_buffer_write(tides_device *device, td_buffer *buffer, const void *data, size_t bytes, tides_error *error);
/* td_buffer_write, but memory that is shared is `data` itself: it must outlive the buffer and stay unchanged, and
 * TD_BUFFER_SLACK bytes behind its end may be read. Nothing may write to the buffer before it has grown. */
tides_status td_buffer_lend(tides_device *device, td_buffer *buffer, void *data, size_t bytes, tides_error *error);
tides_status td_buffer_read(tides_device *device, const td_buffer *buffer, void *data, size_t bytes, tides_error *error);
/* To `offset` bytes into a buffer that is large enough; blocking. */
tides_status td_buffer_write_at(tides_device *device, const td_buffer *buffer, size_t offset, const void *data, size_t bytes,
                                tides_error *error);
/* From `offset` bytes into a buffer. */
tides_status td_buffer_read_at(tides_device *device, const td_buffer *buffer, size_t offset, void *data, size_t bytes,
                               tides_error *error);
/* The bytes [offset, offset + bytes) of the buffer, to the same place in `data`. */
tides_status td_buffer_read_part(tides_device *device, const td_buffer *buffer, void *data, size_t offset, size_t bytes,
                                 tides_error *error);

/* Write and read without waiting, but where memory is shared, for kernels launched before: `data` must stay unchanged until the
 * queue has finished, and td_buffer_send doesn't reserve. */
tides_status td_buffer_send(tides_device *device, const td_buffer *buffer, const void *data, size_t bytes, tides_error *error);
tides_status td_buffer_fetch(tides_device *device, const td_buffer *buffer, void *data, size_t bytes, tides_error *error);

/* Where a buffer's first `bytes` are to be read once the queue has finished, at *at: in memory that is shared, else in `host`,
 * which is needed where the device has none. */
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

/* An array of them, and how many they are. */
#define TD_ARGUMENTS(array) (array), (cl_uint)(sizeof(array) / sizeof *(array))

/* Sets the arguments and enqueues: the only place that does. `local` may be NULL. `event` (nullable) is the caller's. */
tides_status td_launch(tides_device *device, cl_kernel kernel, cl_uint dimensions, const size_t *global, const size_t *local,
                       const td_argument *arguments, cl_uint count, cl_event *event, tides_error *error);

/* Work-items that share out `count` of what is even, for kernels of so many lanes; and of a group: on a CPU one for each of its
 * threads, which take turns, on a GPU one for each. */
size_t td_even_items(int lanes, int count, size_t *local);

/* Has what was enqueued begin, where a driver would wait for more of it. */
tides_status td_flush(tides_device *device, tides_error *error);

/* Seconds that a finished event ran; releases it and sets it to NULL. */
double td_event_seconds(cl_event *event);

/* Waits until nothing is under way: before host memory is freed that was sent, or is fetched into, also after a failure.
 * Returns `status`, or what went wrong with waiting where that is TIDES_OK. */
tides_status td_finish(tides_device *device, tides_status status, tides_error *error);

#endif
