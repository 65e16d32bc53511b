/* LD_PRELOAD: makes chosen calls of OpenCL fail, one by one, and counts objects that are made and released. Environment:
 *
 *   FAULT_AT     which call fails, from 1; 0: none, they are counted only
 *   FAULT_COUNT  at the end, appends a line to this file: how many calls there were, how many objects are left, and which call
 *                failed
 *
 * A call that releases an object releases it even if it reports failure: the shim itself leaves no objects. */
#undef CL_TARGET_OPENCL_VERSION /* the sources' own, where lint reads this as one of them */
#define CL_TARGET_OPENCL_VERSION 200
#define CL_USE_DEPRECATED_OPENCL_1_2_APIS
#define _GNU_SOURCE
#include <CL/cl.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static long at, calls, live;
static const char *failed = "none";

__attribute__((constructor)) static void begin(void) { at = getenv("FAULT_AT") ? atol(getenv("FAULT_AT")) : 0; }

/* _exit and signals leave no line. */
__attribute__((destructor)) static void end(void) {
    char line[128];
    const char *path = getenv("FAULT_COUNT");
    if (!path) return;
    int file = open(path, O_WRONLY | O_CREAT | O_APPEND, 0666);
    int length = snprintf(line, sizeof line, "%ld %ld %s\n", calls, live, failed);
    if (file >= 0 && write(file, line, (size_t)length) == length) close(file);
}

static int is_turn(const char *name) {
    if (__sync_add_and_fetch(&calls, 1) != at) return 0;
    failed = name;
    return 1;
}

static void count(long change) { __sync_add_and_fetch(&live, change); }

#define NEXT(name) __typeof__(name) *next = (__typeof__(name) *)dlsym(RTLD_NEXT, #name)

/* A call that returns a status. */
#define STATUS(name, reason, parameters, arguments)      \
    cl_int CL_API_CALL name parameters {                 \
        NEXT(name);                                      \
        return is_turn(#name) ? reason : next arguments; \
    }

STATUS(clGetPlatformIDs, CL_OUT_OF_HOST_MEMORY, (cl_uint n, cl_platform_id *p, cl_uint *c), (n, p, c))
STATUS(clGetPlatformInfo, CL_OUT_OF_HOST_MEMORY, (cl_platform_id p, cl_platform_info w, size_t n, void *v, size_t *s),
       (p, w, n, v, s))
STATUS(clGetDeviceIDs, CL_OUT_OF_RESOURCES, (cl_platform_id p, cl_device_type t, cl_uint n, cl_device_id *d, cl_uint *c),
       (p, t, n, d, c))
STATUS(clGetDeviceInfo, CL_OUT_OF_RESOURCES, (cl_device_id d, cl_device_info w, size_t n, void *v, size_t *s), (d, w, n, v, s))
STATUS(clBuildProgram, CL_BUILD_PROGRAM_FAILURE,
       (cl_program p, cl_uint n, const cl_device_id *d, const char *o, void(CL_CALLBACK *f)(cl_program, void *), void *u),
       (p, n, d, o, f, u))
STATUS(clGetProgramBuildInfo, CL_OUT_OF_RESOURCES,
       (cl_program p, cl_device_id d, cl_program_build_info w, size_t n, void *v, size_t *s), (p, d, w, n, v, s))
STATUS(clSetKernelArg, CL_OUT_OF_RESOURCES, (cl_kernel k, cl_uint i, size_t n, const void *v), (k, i, n, v))
STATUS(clFinish, CL_OUT_OF_RESOURCES, (cl_command_queue q), (q))
STATUS(clGetEventProfilingInfo, CL_PROFILING_INFO_NOT_AVAILABLE,
       (cl_event e, cl_profiling_info w, size_t n, void *v, size_t *s), (e, w, n, v, s))

/* A command, which may make an event. */
#define COMMAND(name, parameters, arguments)            \
    cl_int CL_API_CALL name parameters {                \
        NEXT(name);                                     \
        if (is_turn(#name)) return CL_OUT_OF_RESOURCES; \
        const cl_int status = next arguments;           \
        if (status == CL_SUCCESS && made) count(1);     \
        return status;                                  \
    }

COMMAND(clEnqueueCopyBuffer,
        (cl_command_queue q, cl_mem a, cl_mem b, size_t from, size_t to, size_t n, cl_uint c, const cl_event *w,
         cl_event *made),
        (q, a, b, from, to, n, c, w, made))
COMMAND(clEnqueueNDRangeKernel,
        (cl_command_queue q, cl_kernel k, cl_uint d, const size_t *o, const size_t *g, const size_t *l, cl_uint c,
         const cl_event *w, cl_event *made),
        (q, k, d, o, g, l, c, w, made))
COMMAND(clEnqueueReadBuffer,
        (cl_command_queue q, cl_mem b, cl_bool wait, size_t o, size_t n, void *to, cl_uint c, const cl_event *w,
         cl_event *made),
        (q, b, wait, o, n, to, c, w, made))
COMMAND(clEnqueueWriteBuffer,
        (cl_command_queue q, cl_mem b, cl_bool wait, size_t o, size_t n, const void *from, cl_uint c, const cl_event *w,
         cl_event *made),
        (q, b, wait, o, n, from, c, w, made))

/* What makes an object. */
#define MAKER(type, name, reason, parameters, arguments) \
    type CL_API_CALL name parameters {                   \
        NEXT(name);                                      \
        if (is_turn(#name)) {                            \
            if (status) *status = reason;                \
            return NULL;                                 \
        }                                                \
        type made = next arguments;                      \
        if (made) count(1);                              \
        return made;                                     \
    }

MAKER(cl_context, clCreateContext, CL_OUT_OF_HOST_MEMORY,
      (const cl_context_properties *p, cl_uint n, const cl_device_id *d,
       void(CL_CALLBACK *f)(const char *, const void *, size_t, void *), void *u, cl_int *status),
      (p, n, d, f, u, status))
MAKER(cl_command_queue, clCreateCommandQueue, CL_OUT_OF_RESOURCES,
      (cl_context c, cl_device_id d, cl_command_queue_properties p, cl_int *status), (c, d, p, status))
MAKER(cl_mem, clCreateBuffer, CL_MEM_OBJECT_ALLOCATION_FAILURE,
      (cl_context c, cl_mem_flags f, size_t n, void *h, cl_int *status), (c, f, n, h, status))
STATUS(clSetMemObjectDestructorCallback, CL_OUT_OF_HOST_MEMORY, (cl_mem m, void(CL_CALLBACK *f)(cl_mem, void *), void *u),
       (m, f, u))

/* Memory that is shared. */
void *CL_API_CALL clSVMAlloc(cl_context c, cl_svm_mem_flags f, size_t n, cl_uint alignment) {
    NEXT(clSVMAlloc);
    void *made = is_turn("clSVMAlloc") ? NULL : next(c, f, n, alignment);
    if (made) count(1);
    return made;
}

void CL_API_CALL clSVMFree(cl_context c, void *memory) {
    NEXT(clSVMFree);
    count(-1);
    next(c, memory);
}

MAKER(cl_program, clCreateProgramWithSource, CL_OUT_OF_HOST_MEMORY,
      (cl_context c, cl_uint n, const char **s, const size_t *l, cl_int *status), (c, n, s, l, status))
MAKER(cl_kernel, clCreateKernel, CL_OUT_OF_HOST_MEMORY, (cl_program p, const char *n, cl_int *status), (p, n, status))

#define RELEASE(name, type)                          \
    cl_int CL_API_CALL name(type object) {           \
        NEXT(name);                                  \
        const int fails = is_turn(#name);            \
        const cl_int status = next(object);          \
        count(-1);                                   \
        return fails ? CL_OUT_OF_RESOURCES : status; \
    }

RELEASE(clReleaseContext, cl_context)
RELEASE(clReleaseCommandQueue, cl_command_queue)
RELEASE(clReleaseMemObject, cl_mem)
RELEASE(clReleaseProgram, cl_program)
RELEASE(clReleaseKernel, cl_kernel)
RELEASE(clReleaseEvent, cl_event)
