/* One work-item per TD_LANES Gaussians of [begin, end): the box that each stays within over an interval, and its travel
 * (sweep.h). Their rows begin at row0, row1 and row2 at the interval's start, middle and end; for Gaussians that don't move by
 * themselves all three are `begin`. */
#include "sweep.h"
#include "specialise.h"

__kernel void td_sweep_gaussians(__constant const td_image *image_buffer, __global const int *object,
                                 __global const td_view *views, __global const float *geometry, __global const float *rates,
                                 __global const int *owners, int first_rate, int first_moved, float duration, int begin,
                                 int end, int row0, int row1, int row2, __global float *boxes, __global float *travel) {
    const td_image image = td_specialised(image_buffer);
    int offset = (int)get_global_id(0) * TD_LANES, first = begin + offset;
    if (first >= end) return;
    const int row[3] = {row0 + offset, row1 + offset, row2 + offset};
    const td_source source = td_source_make(geometry, rates, geometry, geometry, owners, first_rate, first_moved);
    td_sweep_group(views, &image, &source, object, row, duration, boxes + 4 * first, travel + first);
}
