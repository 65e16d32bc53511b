/* Reports sizes and offsets of the shared structs on the device. A test compares them with the host's. */
#include "layout.h"

__kernel void td_layout_check(__global int *out) {
    out[0] = sizeof(td_view);
    out[1] = sizeof(td_backdrop);
    out[2] = sizeof(td_job);
    out[3] = sizeof(td_image);
    td_view view;
    td_image image;
    td_job job;
    out[4] = (int)((__private char *)&view.eye_dot[0] - (__private char *)&view);
    out[5] = (int)((__private char *)&image.width - (__private char *)&image);
    out[6] = (int)((__private char *)&image.outputs - (__private char *)&image);
    out[7] = (int)((__private char *)&job.blocks - (__private char *)&job);
}
