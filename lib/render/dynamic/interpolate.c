/* Interpolation between rows: a network or a callback costs several times what a cubic through rows at two times does.
 *
 * After each sweep the backend says for every Gaussian of an expensive model by how much the cubic through start and end
 * misses the row in the middle (its misfit, in tolerances of log_luminance and time). Samples in either half then take the
 * cubic for those within 1, and the model for the others (tile_jobs.c). Here: switching that on, asking for the misfits, and
 * the weights of a time. */
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
