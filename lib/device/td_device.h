/* Internal: an open device, its kernels, and the one place that includes OpenCL. */
#ifndef TD_DEVICE_H
#define TD_DEVICE_H

#include "td_base.h"
#include "tides/device.h"

#include <CL/cl.h>
#include <pthread.h>

typedef struct td_program_entry td_program_entry;

struct tides_device {
    tides_device_info info;
    int single_precision;  /* reference only: 1 for reference-f32 */
    int correctly_rounded; /* divide and sqrt can be asked to round correctly */
    int has_double;        /* OpenCL only: it has cl_khr_fp64 */
    int double_lanes;      /* OpenCL only: at most so many lanes in double precision */
    int near;              /* OpenCL only: the host shares its buffers (td_near.h) */
    int32_t threads;       /* of the host, for simulators; 0: as many as there are processors */
    int own_builtins;      /* programs declare what they call of OpenCL C themselves (kernels/builtins.h) */
    cl_platform_id platform;
    cl_device_id id;
    cl_context context;
    cl_command_queue queue;
    td_program_entry *programs; /* built so far, newest first */
    pthread_mutex_t building;   /* held while `programs` is read: simulators of several threads share a device */
};

/* 1 where it computes in double precision: the reference. Results agree to the bit among those of one precision. */
int td_device_is_double(const tides_device *device);

/* 1 where kernels can be built in double precision. Elsewhere (the references, OpenCL without cl_khr_fp64) what is wanted in
 * double is worked out in C, to the same bits. */
static inline int td_device_has_double(const tides_device *device) {
    return device->info.kind != TIDES_DEVICE_REFERENCE && device->has_double;
}

/* "CL_OUT_OF_RESOURCES"; "CL error -9999" style numbers come out as "unknown OpenCL error". */
const char *td_cl_name(cl_int code);

/* Fills the error with the call that failed and the code's name. */
tides_status td_cl_fail(tides_error *error, cl_int code, const char *call);

/* Runs an OpenCL call; on failure fills the error, sets `status` and goes to `done`. */
#define TD_CL(call)                                     \
    do {                                                \
        cl_int td_code = (call);                        \
        if (td_code != CL_SUCCESS) {                    \
            status = td_cl_fail(error, td_code, #call); \
            goto done;                                  \
        }                                               \
    } while (0)

/* The kernel `name` of the program of `files` (one kernel file, or several with spaces between), built with `defines`
 * ("#define A 1\n..."), from the device's table or newly. The caller releases the kernel. */
tides_status td_kernel_create(tides_device *device, const char *files, const char *defines, const char *name, cl_kernel *kernel,
                              tides_error *error);

/* td_kernel_create in double precision (TD_REAL_DOUBLE, td_double_lanes). TIDES_UNSUPPORTED where the device has none. */
tides_status td_kernel_create_double(tides_device *device, const char *files, const char *defines, const char *name,
                                     cl_kernel *kernel, tides_error *error);

/* TD_LANES of kernels in double precision. */
int td_double_lanes(const tides_device *device);

/* Releases every program of the table. */
void td_programs_release(tides_device *device);

/* A kernel file's text with its includes put in (each once), as the pieces that clCreateProgramWithSource takes. From
 * $TIDES_KERNEL_DIR where set, else from the library. */
typedef struct td_source_text {
    char **piece;
    size_t count, capacity;
} td_source_text;
tides_status td_source_gather(td_source_text *text, const char *file, tides_error *error);
void td_source_release(td_source_text *text);

#endif
