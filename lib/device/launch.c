/* Buffers, transfers and kernel launches on an OpenCL device, with their times, for the renderer's OpenCL backend. */
#include "td_launch.h"

#include "td_forked.h"
#include "td_near.h"

#include <string.h>

tides_status td_buffer_reserve(tides_device *device, td_buffer *buffer, size_t bytes, tides_error *error) {
    if (bytes <= buffer->bytes) return TIDES_OK;
    if (td_is_forked()) return td_check_forked(error);
    cl_int code = CL_SUCCESS;
    size_t grown = buffer->bytes ? bytes + bytes / 4 : bytes;
    void *near = NULL;
    cl_mem memory = device->near ? td_near_create(device->context, grown + TD_BUFFER_SLACK, &near, &code)
                                 : clCreateBuffer(device->context, CL_MEM_READ_WRITE, grown + TD_BUFFER_SLACK, NULL, &code);
    if (code != CL_SUCCESS)
        return td_fail(error, TIDES_NO_MEMORY, "device %.60s: a buffer of %zu bytes can't be had (%s)", device->info.name,
                       grown, td_cl_name(code));
    td_buffer_release(buffer);
    *buffer = (td_buffer){memory, grown, near};
    return TIDES_OK;
}

void td_buffer_release(td_buffer *buffer) {
    if (buffer->memory && !td_is_forked()) clReleaseMemObject(buffer->memory);
    *buffer = (td_buffer){NULL, 0, NULL};
}

/* Copies from or to shared memory, after all commands have finished. */
static tides_status move_near(tides_device *device, void *to, const void *from, size_t bytes, tides_error *error) {
    tides_status status = td_finish(device, TIDES_OK, error);
    if (status == TIDES_OK) memcpy(to, from, bytes);
    return status;
}

tides_status td_buffer_grow(tides_device *device, td_buffer *buffer, size_t kept, size_t bytes, tides_error *error) {
    if (bytes <= buffer->bytes) return TIDES_OK;
    if (kept > buffer->bytes) kept = buffer->bytes;
    td_buffer grown = {NULL, 0, NULL};
    tides_status status = td_buffer_reserve(device, &grown, bytes + bytes / 2, error);
    if (status == TIDES_OK && grown.near && buffer->bytes) /* waits for commands, also where nothing is kept */
        status = move_near(device, grown.near, buffer->near, kept, error);
    if (status != TIDES_OK) goto done;
    if (kept && !grown.near) TD_CL(clEnqueueCopyBuffer(device->queue, buffer->memory, grown.memory, 0, 0, kept, 0, NULL, NULL));
    td_buffer_release(buffer); /* after the copy has finished */
    *buffer = grown;
    return status;
done:
    td_buffer_release(&grown);
    return status;
}

tides_status td_buffer_write_at(tides_device *device, const td_buffer *buffer, size_t offset, const void *data, size_t bytes,
                                tides_error *error) {
    tides_status status = td_check_forked(error);
    if (status != TIDES_OK || bytes == 0) return status;
    if (buffer->near) return move_near(device, (char *)buffer->near + offset, data, bytes, error);
    TD_CL(clEnqueueWriteBuffer(device->queue, buffer->memory, CL_TRUE, offset, bytes, data, 0, NULL, NULL));
done:
    return status;
}

tides_status td_buffer_write(tides_device *device, td_buffer *buffer, const void *data, size_t bytes, tides_error *error) {
    tides_status status = td_buffer_reserve(device, buffer, bytes ? bytes : 1, error);
    return status == TIDES_OK ? td_buffer_write_at(device, buffer, 0, data, bytes, error) : status;
}

tides_status td_buffer_lend(tides_device *device, td_buffer *buffer, void *data, size_t bytes, tides_error *error) {
    tides_status status = td_check_forked(error);
    cl_int code = CL_SUCCESS;
    if (status != TIDES_OK) return status;
    if (!device->near || bytes == 0) return td_buffer_write(device, buffer, data, bytes, error);
    cl_mem memory =
        clCreateBuffer(device->context, CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR, bytes + TD_BUFFER_SLACK, data, &code);
    if (code != CL_SUCCESS) return td_cl_fail(error, code, "clCreateBuffer");
    td_buffer_release(buffer);
    *buffer = (td_buffer){memory, bytes, data};
    return status;
}

tides_status td_buffer_read_at(tides_device *device, const td_buffer *buffer, size_t offset, void *data, size_t bytes,
                               tides_error *error) {
    tides_status status = td_check_forked(error);
    if (status != TIDES_OK || bytes == 0) return status;
    if (buffer->near) return move_near(device, data, (const char *)buffer->near + offset, bytes, error);
    TD_CL(clEnqueueReadBuffer(device->queue, buffer->memory, CL_TRUE, offset, bytes, data, 0, NULL, NULL));
done:
    return status;
}

tides_status td_buffer_read_part(tides_device *device, const td_buffer *buffer, void *data, size_t offset, size_t bytes,
                                 tides_error *error) {
    return td_buffer_read_at(device, buffer, offset, (char *)data + offset, bytes, error);
}

tides_status td_buffer_read(tides_device *device, const td_buffer *buffer, void *data, size_t bytes, tides_error *error) {
    return td_buffer_read_part(device, buffer, data, 0, bytes, error);
}

tides_status td_buffer_send(tides_device *device, const td_buffer *buffer, const void *data, size_t bytes, tides_error *error) {
    tides_status status = td_check_forked(error);
    if (status != TIDES_OK) return status;
    if (buffer->near) return move_near(device, buffer->near, data, bytes, error);
    TD_CL(clEnqueueWriteBuffer(device->queue, buffer->memory, CL_FALSE, 0, bytes, data, 0, NULL, NULL));
done:
    return status;
}

tides_status td_buffer_fetch(tides_device *device, const td_buffer *buffer, void *data, size_t bytes, tides_error *error) {
    tides_status status = td_check_forked(error);
    if (status != TIDES_OK) return status;
    TD_CL(clEnqueueReadBuffer(device->queue, buffer->memory, CL_FALSE, 0, bytes, data, 0, NULL, NULL));
done:
    return status;
}

tides_status td_buffer_view(tides_device *device, const td_buffer *buffer, void *host, size_t bytes, const void **at,
                            tides_error *error) {
    *at = buffer->near ? buffer->near : host;
    return buffer->near ? td_check_forked(error) : td_buffer_fetch(device, buffer, host, bytes, error);
}

tides_status td_launch(tides_device *device, cl_kernel kernel, cl_uint dimensions, const size_t *global, const size_t *local,
                       td_arguments arguments, cl_event *event, tides_error *error) {
    tides_status status = td_check_forked(error);
    if (status != TIDES_OK) return status;
    for (cl_uint i = 0; i < arguments.count; i++) {
        const td_argument *argument = &arguments.of[i];
        if (argument->buffer)
            TD_CL(clSetKernelArg(kernel, i, sizeof argument->buffer->memory, &argument->buffer->memory));
        else
            TD_CL(clSetKernelArg(kernel, i, argument->bytes, argument->value));
    }
    TD_CL(clEnqueueNDRangeKernel(device->queue, kernel, dimensions, NULL, global, local, 0, NULL, event));
done:
    return status;
}

size_t td_even_items(int lanes, int count, size_t *local) {
    enum { CPU_ITEMS = 64, GPU_GROUP = 64 };
    *local = lanes > 1 ? 1 : GPU_GROUP;
    if (lanes > 1) return CPU_ITEMS;
    return count > GPU_GROUP ? ((size_t)count + GPU_GROUP - 1) / GPU_GROUP * GPU_GROUP : GPU_GROUP;
}

tides_status td_flush(tides_device *device, tides_error *error) {
    tides_status status = td_check_forked(error);
    if (status != TIDES_OK) return status;
    TD_CL(clFlush(device->queue));
done:
    return status;
}

double td_event_seconds(cl_event *event) {
    cl_ulong begun = 0, ended = 0;
    if (!*event || td_is_forked()) return 0;
    clGetEventProfilingInfo(*event, CL_PROFILING_COMMAND_START, sizeof begun, &begun, NULL);
    clGetEventProfilingInfo(*event, CL_PROFILING_COMMAND_END, sizeof ended, &ended, NULL);
    clReleaseEvent(*event);
    *event = NULL;
    return ended > begun ? 1e-9 * (double)(ended - begun) : 0;
}

/* Waits until the queue is empty. A call of clFinish that failed hasn't waited, and running commands would use memory that is
 * freed next (seen as rare crashes). So it is called a second time. If that fails too, the device and its commands are lost. */
tides_status td_finish(tides_device *device, tides_status status, tides_error *error) {
    if (td_is_forked()) return status == TIDES_OK ? td_check_forked(error) : status;
    cl_int finished = clFinish(device->queue);
    if (finished == CL_SUCCESS) return status;
    clFinish(device->queue);
    return status == TIDES_OK ? td_cl_fail(error, finished, "clFinish") : status;
}
