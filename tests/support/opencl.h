/* Test support: skips tests, or parts of them, that need OpenCL. */
#ifndef TESTS_SUPPORT_OPENCL_H
#define TESTS_SUPPORT_OPENCL_H

#include "tides/device.h"

/* For the end of a test whose other parts have run: without an OpenCL device it counts as skipped, not as passed. */
static inline void skip_without_opencl(void) {
    tides_device *device = NULL;
    tides_error error;
    if (tides_device_open("cpu", &device, &error) == TIDES_OK) {
        tides_device_close(device);
        return;
    }
    print_message("skipped in part: %s\n", error.text);
    skip();
}

#endif
