/* Internal: an open device and its kernels. Only here are OpenCL's headers included. */
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
    int correctly_rounded; /* divide and sqrt can be rounded correctly, by a build option */
    int has_double;        /* OpenCL only: it has cl_khr_fp64 */
    int double_lanes;      /* OpenCL only: largest number of lanes in double precision */
    int near;              /* OpenCL only: 1: its buffers are in memory shared with the host */
    int32_t threads;       /* of the host, for simulators; 0: one for each processor */
    int own_builtins;      /* 1: programs declare OpenCL's functions themselves, which is faster to build */
    cl_platform_id platform;
    cl_device_id id;
    cl_context context;
    cl_command_queue queue;
    td_program_entry *programs; /* programs built so far, newest first */
    pthread_mutex_t building;   /* locks `programs`, since several threads' simulators may share a device */
};

/* 1 if it computes in double precision, as only a reference does. Devices of equal precision give equal bits. */
int td_device_is_double(const tides_device *device);

/* 1 if kernels can be built in double precision. Otherwise (references, OpenCL without cl_khr_fp64), what is needed in double
 * is computed in C, with the same bits. */
static inline int td_device_has_double(const tides_device *device) {
    return device->info.kind != TIDES_DEVICE_REFERENCE && device->has_double;
}

/* The name of an OpenCL error, such as "CL_OUT_OF_RESOURCES"; "unknown OpenCL error" for others. */
const char *td_cl_name(cl_int code);

/* Fills the error with the call that failed and the name of its code. */
tides_status td_cl_fail(tides_error *error, cl_int code, const char *call);

/* Makes an OpenCL call. On failure it fills the error, sets `status` and jumps to `done`. */
#define TD_CL(call)                                     \
    do {                                                \
        cl_int td_code = (call);                        \
        if (td_code != CL_SUCCESS) {                    \
            status = td_cl_fail(error, td_code, #call); \
            goto done;                                  \
        }                                               \
    } while (0)

/* Makes kernel `name` of the program of `files` (a kernel file, or several separated by spaces), built with `defines`
 * ("#define A 1\n..."). The program comes from the device's table, or is built. The caller releases the kernel. */
tides_status td_kernel_create(tides_device *device, const char *files, const char *defines, const char *name, cl_kernel *kernel,
                              tides_error *error);

/* td_kernel_create for double precision (TD_REAL_DOUBLE, td_double_lanes). TIDES_UNSUPPORTED if the device lacks it. */
tides_status td_kernel_create_double(tides_device *device, const char *files, const char *defines, const char *name,
                                     cl_kernel *kernel, tides_error *error);

/* Number of lanes (TD_LANES) of kernels in double precision. */
int td_double_lanes(const tides_device *device);

/* Releases every program of the table. */
void td_programs_release(tides_device *device);

/* The text of a kernel file with its includes (each once), in pieces for clCreateProgramWithSource. Files come from
 * $TIDES_KERNEL_DIR if it is set, otherwise from the library. */
typedef struct td_source_text {
    char **piece;
    size_t count, capacity;
} td_source_text;
tides_status td_source_gather(td_source_text *text, const char *file, tides_error *error);
void td_source_release(td_source_text *text);

#endif
