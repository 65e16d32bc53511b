/* Internal: memory shared by the host and a device, so that transfers aren't needed. */
#ifndef TD_NEAR_H
#define TD_NEAR_H

#include "td_launch.h"

/* 1 if host and kernels see each other's writes without a command: on CPUs whose driver says so (fine-grained SVM buffers). */
int td_near_is_had(cl_device_id id, int32_t kind);

/* Makes a buffer in such memory, at *near. The memory is freed with the buffer, after the last command that uses it. NULL on
 * failure: out of memory, or see `code`. */
cl_mem td_near_create(cl_context context, size_t bytes, void **near, cl_int *code);

#endif
