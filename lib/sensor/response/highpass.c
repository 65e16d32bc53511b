/* The high-pass: y = S - z, where z is a low-pass of S. S and z are sums of poles, and have the low-pass' pole in common. So y
 * is a sum of poles too, whose weights add up to 0. It is exact for a cubic input. */
#include "td_highpass.h"
#include "td_base.h"
#include "td_lowpass.h"
#include "td_math.h"

#include <float.h>
#include <math.h>

tides_status td_highpass_make(const tides_sensor *sensor, td_frontend *frontend, tides_error *error) {
    const double corner = sensor->highpass_hz;
    if (!(corner >= 0 && corner <= DBL_MAX))
        return td_fail(error, TIDES_BAD_ARGUMENT, "highpass_hz is %g; it must be finite and at least 0", corner);
    if (corner == 0) return TIDES_OK;
    if (frontend->kind != TD_FRONTEND_OFF && frontend->kind != TD_FRONTEND_CONSTANT)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "highpass_hz is %g Hz behind a filter whose rates go with the light: set photoreceptor_law to constant "
                       "and bandwidth to first_order, or highpass_hz to 0",
                       corner);
    frontend->kind = TD_FRONTEND_HIGHPASS; /* rate 0: no low-pass before it */
    frontend->highpass = 2 * TD_PI * corner;
    return TIDES_OK;
}

/* The response without a low-pass before it: the input less its low-pass, whose state is `z`. */
static void respond_alone(double rate, double z, const td_model *input, td_response *response) {
    td_response low;
    td_pole_respond(rate, z, input, &low);
    td_response_set(response, input);
    for (int c = 0; c < 4; c++) response->cubic.control[c] = input->control[c] - low.cubic.control[c];
    response->mode[0] = low.mode[0];
    response->mode[0].cosine = -low.mode[0].cosine;
    response->modes = 1;
}

/* The response behind a low-pass: S less its low-pass, whose state is `z`. */
static void respond_behind(const td_poles *poles, double rate, double z, const td_model *input, td_response *response) {
    td_poles y = td_poles_then(poles, rate, z);
    y.pole[0].weight = td_minus(poles->pole[0].weight, y.pole[0].weight);
    y.pole[0].offset = td_minus(poles->pole[0].offset, y.pole[0].offset);
    y.pole[1].weight = td_minus((td_complex){0, 0}, y.pole[1].weight);
    y.pole[1].offset = td_minus((td_complex){0, 0}, y.pole[1].offset);
    y.start = poles->start - z;
    td_poles_respond(&y, input, response);
}

void td_highpass_step(const td_frontend *frontend, double h, const td_model *input, double state[TD_FRONTEND_STATE],
                      td_response *response) {
    const double y = state[0], rate = frontend->highpass * h;
    if (frontend->rate > 0) {
        const double S = state[1];
        const td_poles poles = td_poles_first_order(frontend->rate * h, S, input->control[0]);
        td_response low;
        td_poles_respond(&poles, input, &low);
        respond_behind(&poles, rate, S - y, input, response);
        state[1] = td_response_value(&low, 1);
    } else {
        respond_alone(rate, input->control[0] - y, input, response);
        state[1] = input->control[3];
    }
    state[0] = td_response_value(response, 1);
}
