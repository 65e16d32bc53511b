/* Internal: memory that the host and a device share. */
#ifndef TD_NEAR_H
#define TD_NEAR_H

#include "td_launch.h"

/* 1 where a device's kernels see what the host writes, and the host what they write, without a command: on processors, whose
 * driver says so (fine-grained SVM buffers). */
int td_near_is_had(cl_device_id id, int32_t kind);

/* A buffer in such memory, at *near; both go with the buffer's release, after the last command that uses it. NULL: no memory,
 * or what else `code` says. */
cl_mem td_near_create(cl_context context, size_t bytes, void **near, cl_int *code);

#endif
