/* Where the arithmetic runs: an OpenCL device, or the scalar double-precision reference.
 *
 * Threads: any number may list and open devices at once, and renderers, simulators and live runs of several may share an open
 * one, which takes their work in turns. OpenCL's drivers are loaded when a process first asks for devices, and the library
 * lets one thread at a time do that (loaders aren't ready for two); a program that calls OpenCL by itself too makes its own
 * first call before or after, not meanwhile.
 *
 * Forks: drivers have threads, which a fork leaves behind. In a process forked from one that had listed or opened devices,
 * calls that need OpenCL fail with TIDES_NO_DEVICE and say so, rather than wait for ever; closing and destroying works, and so
 * do the references, events and files. Fork first, or fork and exec (Python: multiprocessing's "spawn" or "forkserver"). */
#ifndef TIDES_DEVICE_H
#define TIDES_DEVICE_H

#include "tides/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A device with its queue and its built kernels. Opaque. */
typedef struct tides_device tides_device;

/* Kinds of tides_device_info. */
enum { TIDES_DEVICE_CPU = 1, TIDES_DEVICE_GPU = 2, TIDES_DEVICE_OTHER = 3, TIDES_DEVICE_REFERENCE = 4 };

/* One row of `tides devices`. Plain value. */
typedef struct tides_device_info {
    int32_t kind;          /* TIDES_DEVICE_CPU, _GPU, _OTHER, _REFERENCE */
    int32_t index;         /* what SPEC may name; -1 for the reference */
    char name[128];        /* CL_DEVICE_NAME */
    char platform[128];    /* CL_PLATFORM_NAME */
    char driver[128];      /* CL_DEVICE_VERSION and CL_DRIVER_VERSION */
    int32_t compute_units; /* CL_DEVICE_MAX_COMPUTE_UNITS */
    int32_t lanes;         /* pixels per work-item that kernels are built for */
    int32_t fused;         /* 0: fma() would be a long function there, so products and sums are rounded apart: events are near
                              those of other devices (some 20 ns), where all others give the same to the bit; 1 elsewhere */
    int32_t reserved;
    uint64_t memory_bytes; /* CL_DEVICE_GLOBAL_MEM_SIZE */
} tides_device_info;

/* Opens the device that `spec` names; NULL or "" reads the environment's TIDES_DEVICE, and "auto" where that is unset.
 *   auto           the first GPU, else the first CPU
 *   cpu, gpu       the first of that kind
 *   reference      scalar C in double precision, no OpenCL
 *   reference-f32  the same functions in single precision: equals the kernels bit for bit (tests)
 *   2              index in the list of tides_device_list
 *   pocl, nvidia   a part of the platform's or device's name, case ignored
 * Nothing matches: TIDES_NO_DEVICE, and the text lists what exists. Never falls back to another device by itself.
 * The caller closes it after everything made from it. */
TIDES_MUST_CHECK TIDES_API tides_status tides_device_open(const char *spec, tides_device **device, tides_error *error);

/* NULL is fine. */
TIDES_API void tides_device_close(tides_device *device);

/* How many threads of the host work for each simulator that is made with the device from then on, the caller's included: 1
 * starts none, 0 (as opened, unless the environment's TIDES_THREADS says otherwise) is as many as there are processors. They
 * begin with the first step, wait between steps, and end with the simulator; callbacks stay in the thread that called. Events
 * don't depend on it. The driver's own threads are its own: PoCL takes POCL_MAX_PTHREAD_COUNT (version 3) or
 * POCL_CPU_MAX_CU_COUNT (4) from the environment when it is loaded, which the library leaves alone and the tool's --threads
 * sets. In a process that was forked from that of a simulator it works on with one. TIDES_BAD_ARGUMENT below 0 or above 256. */
TIDES_MUST_CHECK TIDES_API tides_status tides_device_set_threads(tides_device *device, int32_t threads, tides_error *error);
TIDES_API int32_t tides_device_threads(const tides_device *device); /* as set */

/* Fills `info` for an open device. */
TIDES_API void tides_device_describe(const tides_device *device, tides_device_info *info);

/* Writes at most `capacity` rows to `rows` (nullable when capacity is 0) and the number that exists to `count`: the OpenCL
 * devices in index order; no OpenCL platform at all is success with count 0. */
TIDES_MUST_CHECK TIDES_API tides_status tides_device_list(tides_device_info *rows, int32_t capacity, int32_t *count,
                                                          tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
