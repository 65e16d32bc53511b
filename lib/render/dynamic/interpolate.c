/* Interpolation of rows: which Gaussians may have it in an interval, and the weights of a time. */
#include "render/dynamic/td_dynamic.h"

#include <stdlib.h>

tides_status td_moved_interpolate(td_moved *moved, td_backend *backend, double tolerance, double time_tolerance_s,
                                  tides_error *error) {
    int dear = 0;
    for (int p = 0; p < moved->parts; p++) dear |= moved->part[p].dear;
    if (!dear || !moved->kept_rows) return TIDES_OK;
    moved->misfit = td_alloc((size_t)moved->moving, sizeof *moved->misfit, error);
    if (!moved->misfit) return TIDES_NO_MEMORY;
    moved->tolerance = tolerance;
    moved->time_tolerance_s = time_tolerance_s;
    return backend->type->prepare_cubics(backend, error);
}

void td_cubic_weights(double start, double stop, double time, double weights[TD_CUBIC_REALS]) {
    const double h = stop - start, s = (time - start) / h, rest = 1 - s;
    weights[0] = s * s * (3 - 2 * s);
    weights[1] = h * s * rest * rest;
    weights[2] = -h * s * s * rest;
    weights[3] = 6 * s * rest / h;
    weights[4] = rest * (1 - 3 * s);
    weights[5] = s * (3 * s - 2);
}

tides_status td_moved_measure(td_moved *moved, td_backend *backend, const double *views, const td_kept *const kept[3],
                              tides_error *error) {
    tides_status status = TIDES_OK;
    memset(moved->halves, 0, sizeof moved->halves);
    if (!(moved->tolerance > 0) || !(kept[0]->time < kept[1]->time && kept[1]->time < kept[2]->time)) return TIDES_OK;
    if (td_moved_knot_within(moved, kept[0]->time, kept[2]->time)) return TIDES_OK;
    for (int p = 0; p < moved->parts && status == TIDES_OK; p++) {
        const td_moved_part *part = &moved->part[p];
        td_misfit_request request = {.views = views,
                                     .duration = kept[2]->time - kept[0]->time,
                                     .count = (part->count + TD_PAD - 1) / TD_PAD * TD_PAD,
                                     .moves_sh = part->moves_sh,
                                     .tolerance = moved->tolerance,
                                     .time_tolerance_s = moved->time_tolerance_s};
        for (int i = 0; i < 3; i++) request.row[i] = kept[i]->row + part->base;
        td_cubic_weights(kept[0]->time, kept[2]->time, kept[1]->time, request.middle);
        if (part->dear) status = backend->type->misfits(backend, &request, moved->misfit + part->base, error);
    }
    if (status != TIDES_OK) return status;
    for (int i = 0; i < 2; i++) moved->halves[i] = (td_span){kept[i], kept[i + 1]};
    return TIDES_OK;
}

const td_span *td_moved_span(const td_moved *moved, double time) {
    for (int i = 0; i < 2; i++) {
        const td_span *half = &moved->halves[i];
        if (half->from && half->from->time < time && time < half->to->time) return half;
    }
    return NULL;
}
