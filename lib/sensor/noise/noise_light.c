/* The noise_law `photocurrent`: standard deviation and correlation time of a pixel's noise at a log-luminance. The shot
 * noise of the photocurrent is low-passed by the photoreceptor's single pole; noise_rms is added for noise that doesn't
 * depend on light. */
#include "td_noise_light.h"
#include "td_base.h"
#include "td_math.h"

#include <math.h>

static const double electron_a_s = 1.602176634e-19; /* the elementary charge, exact in the SI */
static const double excess = 2; /* F: the photodiode's shot noise, and as much from the photoreceptor (arXiv 2304.04019) */

static tides_status check_currents(const tides_circuit *circuit, tides_error *error) {
    if (!(circuit->photocurrent_a >= 0 && circuit->photocurrent_a <= 1))
        return td_fail(error, TIDES_BAD_ARGUMENT, "circuit.photocurrent_a is %g; noise_law photocurrent wants it in [0, 1]",
                       circuit->photocurrent_a);
    if (!(circuit->dark_current_a >= 1e-19 && circuit->dark_current_a <= 1))
        return td_fail(error, TIDES_BAD_ARGUMENT, "circuit.dark_current_a is %g; noise_law photocurrent wants it in [1e-19, 1]",
                       circuit->dark_current_a);
    return TIDES_OK;
}

static tides_status check_front_end(const td_frontend *frontend, tides_error *error) {
    if (frontend->kind == TD_FRONTEND_CONSTANT || frontend->kind == TD_FRONTEND_INTENSITY) return TIDES_OK;
    if (frontend->kind == TD_FRONTEND_OFF)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "noise_law photocurrent wants the photoreceptor's bandwidth: set photoreceptor_cutoff_hz above 0");
    return td_fail(error, TIDES_UNSUPPORTED, "noise_law photocurrent isn't available with %s: set %s, or noise_law to constant",
                   frontend->kind == TD_FRONTEND_CIRCUIT ? "the circuit" : "a high-pass",
                   frontend->kind == TD_FRONTEND_CIRCUIT ? "bandwidth to first_order" : "highpass_hz to 0");
}

tides_status td_noise_light_make(const tides_sensor *sensor, double log_eps, td_noise_light *light, tides_error *error) {
    td_frontend frontend;
    *light = (td_noise_light){.on = sensor->noise_law == TIDES_NOISE_PHOTOCURRENT};
    if (sensor->noise_law < TIDES_NOISE_CONSTANT || sensor->noise_law > TIDES_NOISE_PHOTOCURRENT)
        return td_fail(error, TIDES_BAD_ARGUMENT, "noise_law is %d; it must be one of TIDES_NOISE_*", (int)sensor->noise_law);
    if (!light->on) return TIDES_OK;
    tides_status status = check_currents(&sensor->circuit, error);
    if (status == TIDES_OK) status = td_frontend_make(sensor, &frontend, error);
    if (status == TIDES_OK) status = check_front_end(&frontend, error);
    if (status != TIDES_OK) return status;
    const int goes = frontend.kind == TD_FRONTEND_INTENSITY;
    light->log_eps = log_eps;
    light->photocurrent = sensor->circuit.photocurrent_a;
    light->dark = sensor->circuit.dark_current_a;
    light->fixed = sensor->noise_rms * sensor->noise_rms;
    light->rate = frontend.rate;
    light->by_light = goes ? frontend.light : 0;
    light->by_dark = goes ? frontend.dark : 1;
    return TIDES_OK;
}

void td_noise_light_at(const td_noise_light *light, double L, double *sigma, double *tau_ns) {
    const double Y = fmax(td_exp(L) - light->log_eps, 0), I = light->photocurrent * Y + light->dark;
    const double rate = light->rate * (light->by_light * Y + light->by_dark);
    *sigma = sqrt(electron_a_s * excess * rate / (2 * I) + light->fixed);
    *tau_ns = 1e9 / rate;
}
