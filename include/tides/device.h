/* Where the arithmetic runs: an OpenCL device, or the scalar double-precision reference.
 *
 * Threads: any number may list and open devices at once. Renderers, simulators and live runs of several threads may share an
 * open device, which takes their work in turns. OpenCL's drivers are loaded when a process first asks for devices. Loaders
 * aren't thread-safe then, so the library lets in one thread at a time. A program that calls OpenCL itself must not make its
 * first call meanwhile.
 *
 * Forks: drivers have threads, which don't exist in a forked process. In a process forked from one that had listed or opened
 * devices, calls that need OpenCL would wait for ever; they fail with TIDES_NO_DEVICE instead. Closing and destroying works,
 * and so do the references, events and files. Fork first, or fork and exec (Python: multiprocessing's "spawn" or
 * "forkserver"). */
#ifndef TIDES_DEVICE_H
#define TIDES_DEVICE_H

#include "tides/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A device with its queue and its compiled kernels. Opaque. */
typedef struct tides_device tides_device;

/* Kinds of tides_device_info. */
enum { TIDES_DEVICE_CPU = 1, TIDES_DEVICE_GPU = 2, TIDES_DEVICE_OTHER = 3, TIDES_DEVICE_REFERENCE = 4 };

/* One row of `tides devices`. Plain value. */
typedef struct tides_device_info {
    int32_t kind;          /* TIDES_DEVICE_CPU, _GPU, _OTHER, _REFERENCE */
    int32_t index;         /* index that a `spec` may name; -1: the reference */
    char name[128];        /* CL_DEVICE_NAME */
    char platform[128];    /* CL_PLATFORM_NAME */
    char driver[128];      /* CL_DEVICE_VERSION and CL_DRIVER_VERSION */
    int32_t compute_units; /* CL_DEVICE_MAX_COMPUTE_UNITS */
    int32_t lanes;         /* pixels per work-item that kernels are built for */
    /* 0: fma() is slow, so products and sums are rounded separately, and events differ by some 20 ns from those of other
     * devices, which are all bit-identical; else 1 */
    int32_t fused;
    int32_t vector_bits;   /* width of the registers that numbers of kernels are in; the reference: of wide loops. 0: unknown */
    uint64_t memory_bytes; /* CL_DEVICE_GLOBAL_MEM_SIZE */
} tides_device_info;

/* Opens the device that `spec` names; NULL or "" reads the environment's TIDES_DEVICE, and "auto" where that is unset.
 *   auto           the first GPU, else the first CPU
 *   cpu, gpu       the first of that kind
 *   reference      scalar C in double precision, no OpenCL
 *   reference-f32  the same functions in single precision: equals the kernels bit for bit (tests)
 *   2              index in the list of tides_device_list
 *   pocl, nvidia   a part of the platform's or device's name, case ignored
 * If nothing matches: TIDES_NO_DEVICE, and the text lists the devices. Another device is never used instead. The caller
 * closes the device after everything that uses it. */
TIDES_MUST_CHECK TIDES_API tides_status tides_device_open(const char *spec, tides_device **device, tides_error *error);

/* NULL is fine. */
TIDES_API void tides_device_close(tides_device *device);

/* Sets how many threads of the host work for each simulator made with the device from now on, the caller's thread included. 1
 * starts none. 0 means as many as processors, and is the default unless the environment's TIDES_THREADS says otherwise.
 * Events don't depend on it.
 *
 * The threads start with the first step and end with the simulator; callbacks stay in the calling thread. In a forked
 * process, one thread is used. The driver's own threads aren't affected: PoCL reads POCL_MAX_PTHREAD_COUNT (version 3) or
 * POCL_CPU_MAX_CU_COUNT (4) when it is loaded. TIDES_BAD_ARGUMENT below 0 or above 256. */
TIDES_MUST_CHECK TIDES_API tides_status tides_device_set_threads(tides_device *device, int32_t threads, tides_error *error);
TIDES_API int32_t tides_device_threads(const tides_device *device); /* as set */

/* Fills `info` for an open device. */
TIDES_API void tides_device_describe(const tides_device *device, tides_device_info *info);

/* Writes at most `capacity` rows to `rows` (nullable if capacity is 0), and the number of devices to `count`: OpenCL's
 * devices in index order. Without an OpenCL platform, `count` is 0. */
TIDES_MUST_CHECK TIDES_API tides_status tides_device_list(tides_device_info *rows, int32_t capacity, int32_t *count,
                                                          tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
