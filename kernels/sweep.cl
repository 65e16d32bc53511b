/* One work-item per TD_LANES Gaussians: [begin, end), the box that each stays within over an interval, and its travel
 * (sweep.h). */
#include "sweep.h"
#include "specialise.h"

__kernel void td_sweep_gaussians(__constant const td_image *image_buffer, __global const int *object,
                                 __global const td_view *views, __global const float *geometry, __global const float *rates,
                                 float duration, int begin, int end, __global float *boxes, __global float *travel) {
    const td_image image = td_specialised(image_buffer);
    int first = begin + (int)get_global_id(0) * TD_LANES;
    if (first >= end) return;
    td_source source;
    source.geometry = geometry;
    source.rates = rates;
    source.sh = geometry;
    source.sh_rates = geometry;
    td_sweep_group(views, &image, &source, object, first, duration, boxes + 4 * first, travel + first);
}
