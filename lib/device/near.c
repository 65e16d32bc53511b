/* Memory shared by host and device. With PoCL, a command that moves data costs 20 us of processor time if the host waits for
 * it, and 5 us if not, for any size, because threads wake each other. A run of 6 ms (playbot) had 455 such waits, a fifth of
 * its time. Shared memory is accessed in place, after the queue has finished. */
#undef CL_TARGET_OPENCL_VERSION
/* for shared virtual memory, the only feature beyond 1.2; used only on devices that have it */
#define CL_TARGET_OPENCL_VERSION 200
#include "td_near.h"

#include <stdlib.h>

int td_near_is_had(cl_device_id id, int32_t kind) {
    cl_device_svm_capabilities has = 0; /* a device of version 1.2 doesn't know this query */
    if (kind != TIDES_DEVICE_CPU) return 0;
    return clGetDeviceInfo(id, CL_DEVICE_SVM_CAPABILITIES, sizeof has, &has, NULL) == CL_SUCCESS &&
           (has & CL_DEVICE_SVM_FINE_GRAIN_BUFFER) != 0;
}

/* Objects that are freed together with a buffer. */
typedef struct shared {
    cl_context context;
    void *memory;
} shared;

static void CL_CALLBACK free_shared(cl_mem buffer, void *user) {
    shared *its = user;
    (void)buffer;
    clSVMFree(its->context, its->memory);
    free(its);
}

cl_mem td_near_create(cl_context context, size_t bytes, void **near, cl_int *code) {
    shared *its = malloc(sizeof *its);
    void *memory = its ? clSVMAlloc(context, CL_MEM_READ_WRITE | CL_MEM_SVM_FINE_GRAIN_BUFFER, bytes, 0) : NULL;
    cl_mem buffer = NULL;
    *code = CL_MEM_OBJECT_ALLOCATION_FAILURE;
    if (memory) buffer = clCreateBuffer(context, CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR, bytes, memory, code);
    if (buffer) {
        *its = (shared){context, memory};
        *code = clSetMemObjectDestructorCallback(buffer, free_shared, its);
        *near = memory;
        if (*code == CL_SUCCESS) return buffer;
        clReleaseMemObject(buffer);
    }
    if (memory) clSVMFree(context, memory);
    free(its);
    return NULL;
}
