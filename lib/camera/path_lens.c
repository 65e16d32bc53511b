/* Makes lenses from coefficients in OpenCV's order: k1 k2 p1 p2 k3 for radtan, k1 to k4 for equidistant (OpenCV's fisheye). */
#include "camera/td_path_reader.h"

tides_lens td_radtan(const double k[5]) {
    const tides_lens lens = {TIDES_LENS_RADTAN, 0, k[0], k[1], k[4], 0, k[2], k[3]}, none = {.model = TIDES_LENS_NONE};
    for (int i = 0; i < 5; i++)
        if (k[i] < 0 || k[i] > 0) return lens;
    return none;
}

tides_lens td_equidistant(const double k[4]) { return (tides_lens){TIDES_LENS_EQUIDISTANT, 0, k[0], k[1], k[2], k[3], 0, 0}; }
