/* Memory that the host and a device share. A command that moves data costs PoCL 20 us of processor time where the host waits
 * for it, 5 where it doesn't, whatever its size: a thread is woken, and wakes the host. A run of 6 ms (playbot, solved, blocks,
 * paths) had 455 such waits, a fifth of its time. Shared memory is written and read in place, once the queue has finished. */
#undef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 200 /* shared virtual memory: the only thing beyond 1.2, and only for devices that have it */
#include "td_near.h"

#include <stdlib.h>

int td_near_is_had(cl_device_id id, int32_t kind) {
    cl_device_svm_capabilities has = 0; /* a device of 1.2 knows no such question */
    if (kind != TIDES_DEVICE_CPU) return 0;
    return clGetDeviceInfo(id, CL_DEVICE_SVM_CAPABILITIES, sizeof has, &has, NULL) == CL_SUCCESS &&
           (has & CL_DEVICE_SVM_FINE_GRAIN_BUFFER) != 0;
}

/* Objects that are freed with a buffer. */
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
