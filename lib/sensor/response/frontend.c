/* The photoreceptor's filters: parameters, rest, and a step of one pixel or of many. */
#include "td_frontend.h"
#include "td_extremes.h"
#include "td_base.h"
#include "td_highpass.h"
#include "td_lowpass.h"
#include "td_math.h"
#include "td_substeps.h"

#include <float.h>
#include <math.h>

/* -- parameters ------------------------------------------------------------------------------------------------------------ */

static tides_status check_positive(const char *field, double value, tides_error *error) {
    if (value > 0 && value <= DBL_MAX) return TIDES_OK;
    return td_fail(error, TIDES_BAD_ARGUMENT, "%s is %g; it must be finite and above 0", field, value);
}

static tides_status check_not_negative(const char *field, double value, tides_error *error) {
    if (value >= 0 && value <= DBL_MAX) return TIDES_OK;
    return td_fail(error, TIDES_BAD_ARGUMENT, "%s is %g; it must be finite and at least 0", field, value);
}

static tides_status check_choice(const char *field, int value, const char *choices, tides_error *error) {
    if (value == 0 || value == 1) return TIDES_OK;
    return td_fail(error, TIDES_BAD_ARGUMENT, "%s is %d; it must be one of %s", field, value, choices);
}

/* Greatest A_loop + 1. The least damping of the photoreceptor at any light is about 1 / sqrt(A_loop + 1). Above 0.01 a swing
 * dies within a few thousand parts of the crossing search. */
static const double loop_gain_max = 1e4;

static tides_status check_circuit(const tides_circuit *circuit, tides_error *error) {
    tides_status status = TIDES_OK;
    const struct {
        const char *name;
        double value;
        int positive;
    } field[] = {{"circuit.photocurrent_a", circuit->photocurrent_a, 0},
                 {"circuit.dark_current_a", circuit->dark_current_a, 1},
                 {"circuit.gain", circuit->gain, 1},
                 {"circuit.kappa", circuit->kappa, 1},
                 {"circuit.thermal_v", circuit->thermal_v, 1},
                 {"circuit.photodiode_f", circuit->photodiode_f, 1},
                 {"circuit.miller_f", circuit->miller_f, 0},
                 {"circuit.output_s", circuit->output_s, 1},
                 {"circuit.source_follower_hz", circuit->source_follower_hz, 0},
                 {"circuit.difference_hz", circuit->difference_hz, 0}};
    for (size_t i = 0; i < sizeof field / sizeof *field && status == TIDES_OK; i++)
        status = (field[i].positive ? check_positive : check_not_negative)(field[i].name, field[i].value, error);
    if (status == TIDES_OK && !(circuit->gain * circuit->kappa <= loop_gain_max))
        return td_fail(error, TIDES_BAD_ARGUMENT, "circuit.gain x circuit.kappa is %g; it must be at most %g",
                       circuit->gain * circuit->kappa, loop_gain_max);
    return status;
}

/* Moves two equal poles apart about their mean, which changes the response in second order only. */
static void part_equal_poles(td_frontend *frontend) {
    double mean = 0.5 * (frontend->source_follower + frontend->difference);
    double apart = 0.5 * TD_POLES_APART * mean;
    if (!(fabs(frontend->source_follower - frontend->difference) < 2 * apart)) return;
    frontend->source_follower = mean - apart;
    frontend->difference = mean + apart;
}

static void make_circuit(const tides_circuit *circuit, td_frontend *frontend) {
    frontend->kind = TD_FRONTEND_CIRCUIT;
    frontend->light = circuit->photocurrent_a;
    frontend->dark = circuit->dark_current_a;
    frontend->input_s = circuit->photodiode_f * circuit->thermal_v;
    frontend->miller_s = circuit->miller_f * circuit->thermal_v;
    frontend->loop = circuit->gain * circuit->kappa + 1;
    frontend->source_follower = 2 * TD_PI * circuit->source_follower_hz;
    frontend->difference = 2 * TD_PI * circuit->difference_hz;
    if (frontend->source_follower > 0 && frontend->difference > 0) part_equal_poles(frontend);
}

static void make_first_order(const tides_sensor *sensor, td_frontend *frontend) {
    int follows_light = sensor->photoreceptor_law == TIDES_PHOTORECEPTOR_INTENSITY;
    frontend->kind = follows_light ? TD_FRONTEND_INTENSITY : TD_FRONTEND_CONSTANT;
    frontend->rate = 2 * TD_PI * sensor->photoreceptor_cutoff_hz;
    if (sensor->photoreceptor_half_a > 0) {
        const double I = td_middle_current(&sensor->circuit);
        frontend->rate *= I / (I + sensor->photoreceptor_half_a);
    }
    frontend->light = 255.0 / 275; /* v2e: (DN + 20) / 275, DN = 255 Y */
    frontend->dark = 20.0 / 275;
}

tides_status td_frontend_make(const tides_sensor *sensor, td_frontend *frontend, tides_error *error) {
    *frontend = (td_frontend){.sensor = sensor};
    tides_status status = check_not_negative("photoreceptor_cutoff_hz", sensor->photoreceptor_cutoff_hz, error);
    if (status == TIDES_OK)
        status = check_choice("photoreceptor_law", sensor->photoreceptor_law, "TIDES_PHOTORECEPTOR_*", error);
    if (status == TIDES_OK) status = check_not_negative("photoreceptor_half_a", sensor->photoreceptor_half_a, error);
    if (status == TIDES_OK && sensor->photoreceptor_half_a > 0 && !(td_middle_current(&sensor->circuit) > 0))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "photoreceptor_half_a is %g, of a photocurrent that isn't above 0: set circuit.photocurrent_a, or "
                       "camera.lux in a run file",
                       sensor->photoreceptor_half_a);
    if (status == TIDES_OK) status = check_choice("bandwidth", sensor->bandwidth, "TIDES_BANDWIDTH_*", error);
    if (status != TIDES_OK) return status;
    if (sensor->bandwidth == TIDES_BANDWIDTH_CIRCUIT) {
        status = check_circuit(&sensor->circuit, error);
        if (status == TIDES_OK) make_circuit(&sensor->circuit, frontend);
    } else if (sensor->photoreceptor_cutoff_hz > 0) {
        make_first_order(sensor, frontend);
    }
    if (status == TIDES_OK) status = td_highpass_make(sensor, frontend, error);
    frontend->tolerance = TD_FRONTEND_TOLERANCE / 2;
    frontend->on = frontend->kind != TD_FRONTEND_OFF;
    return status;
}

/* -- steps ----------------------------------------------------------------------------------------------------------------- */

/* At rest. state: S, the second-order photoreceptor's output and its slope [1/s], the source follower's output. */
double td_frontend_rest(const td_frontend *frontend, double L, double log_eps, double state[TD_FRONTEND_STATE]) {
    (void)log_eps; /* at rest a low-pass is at its input, whatever its rate is */
    state[0] = state[1] = state[3] = L;
    state[2] = 0;
    if (frontend->kind == TD_FRONTEND_HIGHPASS) state[0] = 0;
    return state[0];
}

/* Walks over the substeps of a step; `source` gets a segment for each eighth of it. If there is one substep in the step's own
 * time, its response is returned directly. */
static void step_in_substeps(td_filter_input *source, double state[TD_FRONTEND_STATE], td_response *response,
                             td_kept_substeps *kept) {
    td_substeps substeps;
    double low, high;
    int count = 0;
    td_substeps_begin(&substeps, source, 0);
    for (td_segment *at = source->segment; td_substeps_next(&substeps); count++) {
        td_response_range(&substeps.response, &low, &high);
        at->low = td_lesser(low, at->low);
        at->high = td_greater(high, at->high);
        if (kept) td_substeps_keep(&substeps, kept);
        if (substeps.to >= 1 || substeps.to < source->segments / (double)TD_SEGMENTS_MAX) continue;
        at = &source->segment[source->segments++];
        td_substeps_mark(&substeps, at);
    }
    for (int i = 0; i < TD_FRONTEND_STATE; i++) state[i] = substeps.state[i];
    if (count == 1 && !substeps.map.on) {
        *response = substeps.response;
        return;
    }
    td_response_set(response, &(td_model){{0, 0, 0, 0}});
    response->source = *source;
    if (count <= TD_SUBSTEPS_KEPT) response->source.kept = kept;
}

void td_frontend_step(const td_frontend *frontend, double h, const td_model *input, double log_eps,
                      double state[TD_FRONTEND_STATE], td_response *response, td_kept_substeps *kept) {
    td_response_set(response, input);
    if (!frontend->on) return;
    if (!td_model_is_finite(input)) {
        response->cubic = (td_model){{NAN, NAN, NAN, NAN}};
        return;
    }
    if (!isfinite(state[0])) td_frontend_rest(frontend, input->control[0], log_eps, state);
    if (frontend->kind == TD_FRONTEND_CONSTANT) {
        td_poles poles = td_poles_first_order(frontend->rate * h, state[0], input->control[0]);
        td_poles_respond(&poles, input, response);
        state[0] = td_response_value(response, 1);
        return;
    }
    if (frontend->kind == TD_FRONTEND_HIGHPASS) {
        td_highpass_step(frontend, h, input, state, response);
        return;
    }
    td_filter_input source;
    source.frontend = frontend;
    source.kept = NULL;
    source.input = *input;
    source.h = h;
    source.log_eps = log_eps;
    source.dark_L = td_ln(log_eps);
    source.segments = 1;
    source.segment[0] = (td_segment){0, 1, {state[0], state[1], state[2], state[3]}, INFINITY, -INFINITY, 0, 0};
    step_in_substeps(&source, state, response, kept);
}
