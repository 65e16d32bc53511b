/* Test support: motions on an OpenCL device, launched directly. */
#ifndef TESTS_SUPPORT_MOTION_DEVICE_H
#define TESTS_SUPPORT_MOTION_DEVICE_H

#include "td_launch.h"
#include "tests/support/motion_rows.h"

/* A motion's numbers on a device, with room for `capacity` rows (a multiple of TD_PAD). */
typedef struct motion_device {
    tides_device *device;
    const packed_motion *packed;
    cl_kernel kernel;
    int capacity, sh_stride, jobs_count;
    td_buffer mover, data, moment, jobs, index, geometry, rates, sh, sh_rates;
} motion_device;

/* Puts a motion on an open device; aborts if that fails. */
motion_device motion_device_make(tides_device *device, const packed_motion *packed, int capacity, int sh_stride);
void motion_device_free(motion_device *on);

/* Sets the Gaussians of the next launches: index[0 .. count), or all in order if NULL, in jobs of at most `job_size`. */
void motion_device_set(motion_device *on, const int *index, int count, int job_size);

/* Time of a launch [s]: elapsed, and used by all threads of the process together. On a busy machine only the second is the
 * work's own. */
typedef struct motion_time {
    double elapsed, processor;
} motion_time;
motion_time motion_time_now(void);
motion_time motion_time_since(motion_time begun);

/* Launches once at the motion's own time tau, and waits. */
motion_time motion_device_run(motion_device *on, double tau, int side);

/* The rows of the last launch. */
motion_rows motion_device_read(motion_device *on, int count);

#endif
