/* Interpolation of rows. A row of an expensive motion model (a network or a callback) takes several times as long as a row from
 * the cubic through two other rows.
 *
 * A sweep computes rows at the start, the middle and the end of its interval. Then the backend measures a misfit for each
 * Gaussian of an expensive model: the distance of the middle row from the cubic through start and end, in units of the
 * tolerance (of log_luminance, and of time). A later sample in one half of the interval takes its row from the cubic through
 * that half's two rows if the misfit is at most 1, and from the model otherwise. This file switches interpolation on,
 * requests the misfits, and computes the weights of the cubic at a time. */
#include "render/dynamic/td_dynamic.h"

#include <stdlib.h>

tides_status td_dynamic_interpolate(td_dynamic *dynamic, td_backend *backend, double tolerance, double time_tolerance_s,
                                    tides_error *error) {
    if (!td_dynamic_has_expensive(dynamic) || !dynamic->cached_rows) return TIDES_OK;
    dynamic->misfit = td_alloc((size_t)dynamic->gaussians, sizeof *dynamic->misfit, error);
    if (!dynamic->misfit) return TIDES_NO_MEMORY;
    dynamic->tolerance = tolerance;
    dynamic->time_tolerance_s = time_tolerance_s;
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

tides_status td_dynamic_measure(td_dynamic *dynamic, td_backend *backend, const double *views,
                                const td_row_cache *const cached[3], tides_error *error) {
    tides_status status = TIDES_OK;
    memset(dynamic->halves, 0, sizeof dynamic->halves);
    if (!(dynamic->tolerance > 0) || !(cached[0]->time < cached[1]->time && cached[1]->time < cached[2]->time)) return TIDES_OK;
    if (td_dynamic_knot_within(dynamic, cached[0]->time, cached[2]->time)) return TIDES_OK;
    for (int p = 0; p < dynamic->objects && status == TIDES_OK; p++) {
        const td_dynamic_object *object = &dynamic->object[p];
        td_misfit_request request = {.views = views,
                                     .duration = cached[2]->time - cached[0]->time,
                                     .count = (object->count + TD_PAD - 1) / TD_PAD * TD_PAD,
                                     .moves_sh = object->moves_sh,
                                     .tolerance = dynamic->tolerance,
                                     .time_tolerance_s = dynamic->time_tolerance_s};
        for (int i = 0; i < 3; i++) request.row[i] = cached[i]->row + object->base;
        td_cubic_weights(cached[0]->time, cached[2]->time, cached[1]->time, request.middle);
        if (object->expensive) status = backend->type->misfits(backend, &request, dynamic->misfit + object->base, error);
    }
    if (status != TIDES_OK) return status;
    for (int i = 0; i < 2; i++) dynamic->halves[i] = (td_span){cached[i], cached[i + 1]};
    return TIDES_OK;
}

const td_span *td_dynamic_span(const td_dynamic *dynamic, double time) {
    for (int i = 0; i < 2; i++) {
        const td_span *half = &dynamic->halves[i];
        if (half->from && half->from->time < time && time < half->to->time) return half;
    }
    return NULL;
}
