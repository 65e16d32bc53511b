/* Internal: the photoreceptor's response to a pixel's log-luminance L on a step. It is exact for a cubic input, so that nothing
 * depends on the length of steps. The filter's state is TD_FRONTEND_STATE doubles per pixel, S the first of them.
 *
 *   first order, constant   S' = rate (L - S), rate = 2 pi cutoff
 *   first order, intensity  the same, rate = 2 pi cutoff (255 Y + 20) / 275, Y = max(e^L - log_eps, 0)
 *   high-pass               y = S - z, z' = 2 pi highpass_hz (S - z), behind the constant law or none, where S is L; then y
 *                           is in S's place, and is 0 at rest
 *   circuit                 a2 y'' + a1 y' + y = L, with I = photocurrent_a Y + dark_current_a, tau_in = photodiode_f V_T / I,
 *                           tau_mil = miller_f V_T / I, A_loop = gain kappa:
 *                             a2 = (tau_in + tau_mil) output_s / (A_loop + 1)
 *                             a1 = (tau_in + output_s + (gain + 1) tau_mil) / (A_loop + 1)
 *                           then the low-passes of source_follower_hz and difference_hz: the chain of wengflow's simulator
 *
 * Accuracy. The constant law: S to about 1e-15. Rates that go with the light: S within TD_FRONTEND_TOLERANCE of the solution,
 * whatever the steps, and measured within a tenth of that. L from a float render has an error of about 1e-6, and so has S,
 * since a low-pass doesn't amplify it (the circuit by its overshoot at most). A crossing is then off by 1e-6 / |S_dot|, which
 * is 100 ns at 10 / s. Errors of L that differ from step to step are averaged over a time constant. */
#ifndef TD_FRONTEND_H
#define TD_FRONTEND_H

#include "td_response.h"
#include "tides/sensor.h"

#include <stddef.h>

/* Greatest error of S where rates go with the light [log units]. */
#define TD_FRONTEND_TOLERANCE 1e-8

enum {
    TD_FRONTEND_OFF = 0,
    TD_FRONTEND_CONSTANT = 1,
    TD_FRONTEND_INTENSITY = 2,
    TD_FRONTEND_CIRCUIT = 3,
    TD_FRONTEND_HIGHPASS = 4
};

typedef struct td_frontend {
    const tides_sensor *sensor;
    int on;             /* 0: the response is the input itself, without state */
    int kind;           /* TD_FRONTEND_* */
    double light, dark; /* rates are proportional to light Y + dark: to (255 Y + 20) / 275, or to the photocurrent [A] */
    double highpass;    /* of the high-pass [1/s] */
    double rate;        /* of the first-order filter, where light Y + dark is 1 [1/s] */
    double input_s, miller_s, loop;     /* circuit: tau_in I and tau_mil I [A s]; A_loop + 1 */
    double source_follower, difference; /* [1/s]; 0: left out */
    double tolerance;                   /* of the input's error in a substep [log units] */
} td_frontend;

/* The photocurrent in the middle of the light, Y = 0.5 [A]. */
static inline double td_middle_current(const tides_circuit *circuit) {
    return 0.5 * circuit->photocurrent_a + circuit->dark_current_a;
}

/* Makes the front end of `sensor`, which must outlive it. Off where bandwidth is FIRST_ORDER and photoreceptor_cutoff_hz is 0.
 * TIDES_BAD_ARGUMENT naming the field. */
TIDES_MUST_CHECK tides_status td_frontend_make(const tides_sensor *sensor, td_frontend *frontend, tides_error *error);

/* Sets the state of a pixel that has rested at log-luminance L for ever. Returns its signal S. */
double td_frontend_rest(const td_frontend *frontend, double L, double log_eps, double state[TD_FRONTEND_STATE]);

/* One step of h > 0 seconds with the input `input` (log-luminance). `response` is the output S, and `state` goes to the step's
 * end. state[0] is td_response_value(response, 1), to 1e-13 where rates go with the light. Cutting a step in two changes the
 * output by rounding with constant rates, and by TD_FRONTEND_TOLERANCE where they go with the light. An input that isn't finite
 * leaves the state unchanged and makes the response NaN. A state that isn't finite is replaced by that of rest at the input's
 * beginning. The response may refer to `frontend`, and to `kept` (nullable) where its substeps fit there. It then solves none
 * again, to the same bits. */
struct td_kept_substeps;
void td_frontend_step(const td_frontend *frontend, double h, const td_model *input, double log_eps,
                      double state[TD_FRONTEND_STATE], td_response *response, struct td_kept_substeps *kept);

/* Pixels whose filters are stepped together. For pixel i, control[k][i] are the input's control values, and state[s][i] is its
 * state. Results: its state at the step's end in after[s][i], and bounds of the response, rounding included, in low[i] and
 * high[i]. Filters of one state use state[0] and after[0]. */
typedef struct td_filter_block {
    size_t count;
    const double *control[4], *state[TD_FRONTEND_STATE];
    double *after[TD_FRONTEND_STATE], *low, *high;
} td_filter_block;

/* At most `most` of the pixels, from number `first` on. */
static inline td_filter_block td_filter_part(const td_filter_block *all, size_t first, size_t most) {
    td_filter_block part = *all;
    part.count = all->count - first < most ? all->count - first : most;
    for (int k = 0; k < 4; k++) part.control[k] += first;
    for (int s = 0; s < TD_FRONTEND_STATE; s++) {
        if (part.state[s]) part.state[s] += first;
        if (part.after[s]) part.after[s] += first;
    }
    part.low += first;
    part.high += first;
    return part;
}

/* Steps of many pixels without their responses, in a loop that vectorises; for TD_FRONTEND_CONSTANT only. States become those
 * of td_frontend_step, to the bit. Pixels whose bounds could reach a level need td_frontend_step, from their old state. For an
 * input that isn't finite the bounds are NaN. */
void td_frontend_step_many(const td_frontend *frontend, double h, const td_filter_block *of);

/* td_frontend_step_many for TD_FRONTEND_INTENSITY alone. States are within TD_FRONTEND_TOLERANCE of the solution, however many
 * steps there were. Pixels whose step isn't solved have NaN as bounds, and nothing of use in `after`: they need
 * td_frontend_step, too. A pixel's result depends on no other pixel. */
void td_frontend_step_light(const td_frontend *frontend, double h, double log_eps, const td_filter_block *pixels);

/* td_frontend_step_light for pixels that are solved without substeps, with a proven bound on the error. The others have NaN as
 * bounds. */
void td_light_whole(const td_frontend *frontend, double h, double log_eps, const td_filter_block *pixels);

/* For TD_FRONTEND_CIRCUIT only: states within a tenth of the input's error that td_frontend_step may leave, proven. Pixels
 * without an answer have NaN as bounds and need td_frontend_step. A pixel's result depends on no other pixel. */
void td_circuit_step_many(const td_frontend *frontend, double h, double log_eps, const td_filter_block *pixels);

#endif
