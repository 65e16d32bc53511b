/* Lenses of path files. OpenCV's names: k1 k2 p1 p2 k3 of radtan, k1 to k4 of equidistant (its fisheye). */
#include "camera/td_path_reader.h"

tides_lens td_radtan(const double k[5]) {
    const tides_lens lens = {TIDES_LENS_RADTAN, 0, k[0], k[1], k[4], 0, k[2], k[3]}, none = {.model = TIDES_LENS_NONE};
    for (int i = 0; i < 5; i++)
        if (k[i] < 0 || k[i] > 0) return lens;
    return none;
}

tides_lens td_equidistant(const double k[4]) { return (tides_lens){TIDES_LENS_EQUIDISTANT, 0, k[0], k[1], k[2], k[3], 0, 0}; }

static int differs(double a, double b) { return a < b || a > b; }

static int same_lens(const tides_lens *a, const tides_lens *b) {
    return a->model == b->model && !differs(a->k1, b->k1) && !differs(a->k2, b->k2) && !differs(a->k3, b->k3) &&
           !differs(a->k4, b->k4) && !differs(a->p1, b->p1) && !differs(a->p2, b->p2);
}

void td_path_share_intrinsics(tides_path *path, const tides_intrinsics *other, int first) {
    tides_intrinsics *common = &path->intrinsics;
    if (first) {
        *common = *other;
        return;
    }
    if (common->width != other->width) common->width = 0;
    if (common->height != other->height) common->height = 0;
    if (differs(common->fx, other->fx)) common->fx = 0.0;
    if (differs(common->fy, other->fy)) common->fy = 0.0;
    if (differs(common->cx, other->cx)) common->cx = 0.0;
    if (differs(common->cy, other->cy)) common->cy = 0.0;
    if (same_lens(&common->lens, &other->lens)) return;
    common->lens = (tides_lens){.model = TIDES_LENS_NONE};
    path->distorted = 1;
}
