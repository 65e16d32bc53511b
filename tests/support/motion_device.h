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

/* Fails the test (abort) where that fails. `device` is open and set to its width. */
motion_device motion_device_make(tides_device *device, const packed_motion *packed, int capacity, int sh_stride);
void motion_device_free(motion_device *on);

/* Sets what the next launches work out: Gaussians index[0 .. count) (NULL: all in order) in jobs of at most `job_size`. */
void motion_device_set(motion_device *on, const int *index, int count, int job_size);

/* Seconds of a launch: on the clock, and of all the process's threads together (a machine with other work to do shows there
 * what the work takes). */
typedef struct motion_time {
    double elapsed, processor;
} motion_time;
motion_time motion_time_now(void);
motion_time motion_time_since(motion_time begun);

/* One launch at own time tau, finished. */
motion_time motion_device_run(motion_device *on, double tau, int side);

/* The rows of the last launch. */
motion_rows motion_device_read(motion_device *on, int count);

#endif
