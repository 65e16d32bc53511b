/* Filters whose rates go with the light: the first-order filter S' = r (L - S), and the circuit's first stage a2 y'' + a1
 * y' + y = L. Their rates are linear in J = light Y + dark.
 *
 * The first-order filter has a constant rate in a time v that is proportional to the integral of J. In v, L is replaced by the
 * cubic through its ends. The error is the difference of L and that cubic, which the filter doesn't amplify, so that substeps
 * are long.
 *
 * For the circuit, and for the first-order filter where Y is cut off at 0, J is kept at its value J_m in a substep's middle.
 * With e = J / J_m - 1 the equations are exactly
 *
 *   A2 y'' + A1 y' + y = L + g,   g = e (L - y - k y')      A at J_m; k = output_s / (A_loop + 1), first order: A2 = 0, k = 0.
 *
 * So a substep is the constant filter's exact response to L + g. g is taken as the cubic through its values at 0, 1/3, 2/3 and
 * 1, found by repeated substitution: e and the lag are small. The cubic's error, seen between these places, is an error of the
 * input. A substep is shortened until it is within frontend->tolerance. Errors don't add up from substep to substep. The
 * response to an input error is at most the largest one, times coth(pi z / (2 sqrt(1 - z^2))) for a swing of damping z (3.5 for
 * the defaults in full light) if the error swung along with it. It changes sign at four places of each substep instead.
 * Measured against integration, S is within half of TD_FRONTEND_TOLERANCE (property tests). */
#include "td_substeps.h"
#include "td_extremes.h"
#include "td_light_step.h"
#include "td_lowpass.h"
#include "td_math.h"
#include "td_modes.h"

#include <math.h>

/* SWEEPS: substitutions in a substep, each better by the factor e. TRIED_MAX: substeps tried in a step before any error is
 * accepted (images need 1 to 10). */
enum { SWEEPS = 8, TRIED_MAX = 1 << 14, NODES = 4, BETWEEN = 3 };

/* Share of the tolerance by which the last sweep may still change g. The rest is for the error of the cubic. */
static const double settled = 0.25;

static const double node[NODES + BETWEEN] = {0, 1.0 / 3, 2.0 / 3, 1, 1.0 / 6, 1.0 / 2, 5.0 / 6};

/* A substep while it is being solved. */
typedef struct attempt {
    const td_frontend *frontend;
    double seconds, log_eps;
    const double *state;
    td_model input;
    double middle;                                                   /* J_m */
    double surplus[NODES + BETWEEN];                                 /* e at the nodes */
    double lead;                                                     /* k [s] */
    int is_still;                                                    /* J doesn't change */
    td_response stage;                                               /* y */
    td_complex value[2][NODES + BETWEEN], slope[2][NODES + BETWEEN]; /* its modes at the nodes, for size 1 */
} attempt;

static double light_at(const attempt *at, double u) {
    double Y = td_exp(fmin(td_model_value(&at->input, u), TD_LIGHT_MOST)) - at->log_eps;
    return at->frontend->light * fmax(Y, 0) + at->frontend->dark;
}

/* The poles of the photoreceptor: y of the circuit, or S of the first-order filter. y' is stored per second. */
static td_poles photoreceptor(const attempt *at) {
    const td_frontend *f = at->frontend;
    double origin = at->input.control[0];
    if (f->kind == TD_FRONTEND_INTENSITY) return td_poles_first_order(f->rate * at->middle * at->seconds, at->state[0], origin);
    double in = f->input_s / at->middle, miller = f->miller_s / at->middle, out = f->sensor->circuit.output_s;
    double product = f->loop / ((in + miller) * out),
           sum = (in + out + (f->sensor->circuit.gain + 1) * miller) / ((in + miller) * out);
    return td_poles_second_order(sum * at->seconds, product * at->seconds * at->seconds, at->state[1],
                                 at->state[2] * at->seconds, origin);
}

static void tabulate_tail(attempt *at, int mode, td_complex rate) {
    td_mode_places places = {.s = {0}};
    for (int i = 0; i < NODES + BETWEEN; i++) places.s[i] = node[i];
    td_mode_tails_many(rate, &places);
    for (int i = 0; i < NODES + BETWEEN; i++) {
        at->value[mode][i] = (td_complex){places.value_re[i], places.value_im[i]};
        at->slope[mode][i] = (td_complex){places.slope_re[i], places.slope_im[i]};
    }
}

/* Decays at the nodes, which are sixths of the substep: one exponential and its powers. */
static void tabulate_decay(attempt *at, int mode, td_complex rate) {
    static const int sixths[NODES + BETWEEN] = {0, 2, 4, 6, 1, 3, 5};
    td_complex power[7] = {{1, 0}}, sixth = td_decay(rate, 1.0 / 6);
    for (int i = 1; i <= 6; i++) power[i] = td_times(power[i - 1], sixth);
    for (int i = 0; i < NODES + BETWEEN; i++) {
        at->value[mode][i] = power[sixths[i]];
        at->slope[mode][i] = td_scaled(td_times(rate, power[sixths[i]]), -1);
    }
}

static void tabulate(attempt *at) {
    for (int k = 0; k < at->stage.modes; k++) {
        const td_mode *mode = &at->stage.mode[k];
        if (mode->tail)
            tabulate_tail(at, k, td_mode_rate(mode));
        else
            tabulate_decay(at, k, td_mode_rate(mode));
    }
}

static double missing(const attempt *at, int i) {
    double lag = td_model_value(&at->input, node[i]) - td_model_value(&at->stage.cubic, node[i]);
    double slope = td_model_slope(&at->stage.cubic, node[i]);
    for (int k = 0; k < at->stage.modes; k++) {
        td_complex size = {at->stage.mode[k].cosine, at->stage.mode[k].sine};
        lag -= td_times(size, at->value[k][i]).re;
        slope += td_times(size, at->slope[k][i]).re;
    }
    return at->surplus[i] * (lag - at->lead / at->seconds * slope);
}

/* The cubic through g at the four nodes. */
static td_model through(const double g[NODES]) {
    return (td_model){
        {g[0], (-5 * g[0] + 18 * g[1] - 9 * g[2] + 2 * g[3]) / 6, (2 * g[0] - 9 * g[1] + 18 * g[2] - 5 * g[3]) / 6, g[3]}};
}

/* The greater of two errors; NaN is the greatest. */
static double worse(double a, double b) { return b <= a || isnan(a) ? a : b; }

/* Solves the photoreceptor; `input` becomes L + g. Returns the largest error of g. */
static double substitute(attempt *at, const td_poles *stage, td_model *input) {
    double g[NODES] = {0}, worst = 0;
    td_model cubic = through(g);
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        for (int i = 0; i < 4; i++) input->control[i] = at->input.control[i] + cubic.control[i];
        td_poles_respond(stage, input, &at->stage);
        if (at->is_still) return 0;
        if (sweep == 0) tabulate(at);
        double before[NODES];
        worst = 0;
        for (int i = 0; i < NODES; i++) {
            before[i] = g[i];
            g[i] = missing(at, i);
            worst = worse(worst, fabs(g[i] - before[i]));
        }
        if (!(worst > settled * at->frontend->tolerance)) break;
        cubic = through(g);
    }
    for (int i = NODES; i < NODES + BETWEEN; i++) worst = worse(worst, fabs(missing(at, i) - td_model_value(&cubic, node[i])));
    return worst;
}

/* Computes the filters behind the photoreceptor, and the state at the substep's end. */
static void finish(const attempt *at, const td_poles *stage, const td_model *input, double state[TD_FRONTEND_STATE],
                   td_response *response) {
    const td_frontend *f = at->frontend;
    td_poles poles = *stage;
    double next[TD_FRONTEND_STATE] = {0};
    next[1] = td_response_value(&at->stage, 1);
    next[2] = td_response_slope(&at->stage, 1) / at->seconds;
    *response = at->stage;
    next[3] = next[1];
    if (f->source_follower > 0) {
        poles = td_poles_then(&poles, f->source_follower * at->seconds, at->state[3]);
        td_poles_respond(&poles, input, response);
        next[3] = td_response_value(response, 1);
    }
    if (f->difference > 0) {
        poles = td_poles_then(&poles, f->difference * at->seconds, at->state[0]);
        td_poles_respond(&poles, input, response);
    }
    next[0] = f->difference > 0 ? td_response_value(response, 1) : next[3];
    for (int i = 0; i < TD_FRONTEND_STATE; i++) state[i] = next[i];
}

static int is_flat(const td_model *model) {
    const double *b = model->control;
    return b[0] == b[1] && b[0] == b[2] && b[0] == b[3];
}

/* Solves the substep from substeps->from to `to` with constant rates. Returns the error of g. */
static double solve_frozen(const td_substeps *substeps, const td_model *substep, double to, double state[TD_FRONTEND_STATE],
                           td_response *response) {
    const td_filter_input *source = substeps->source;
    attempt at;
    at.frontend = source->frontend;
    at.log_eps = source->log_eps;
    at.state = substeps->state;
    at.seconds = source->h * (to - substeps->from);
    at.input = *substep;
    at.middle = light_at(&at, 0.5);
    at.lead =
        source->frontend->kind == TD_FRONTEND_CIRCUIT ? source->frontend->sensor->circuit.output_s / source->frontend->loop : 0;
    at.is_still = is_flat(substep) || at.frontend->light == 0;
    for (int i = 0; i < NODES + BETWEEN && !at.is_still; i++) at.surplus[i] = light_at(&at, node[i]) / at.middle - 1;
    td_poles stage = photoreceptor(&at);
    td_model input;
    double error = substitute(&at, &stage, &input);
    finish(&at, &stage, &input, state, response);
    return error;
}

/* 1 where a time exists in which the filter's rate is constant: Y isn't cut off at 0. */
static int can_map(const td_filter_input *source, const td_model *input) {
    double least = INFINITY, most = -INFINITY;
    for (int i = 0; i < 4; i++) {
        least = td_lesser(input->control[i], least);
        most = td_greater(input->control[i], most);
    }
    return source->frontend->kind == TD_FRONTEND_INTENSITY && least >= source->dark_L && most < TD_LIGHT_MOST;
}

/* Solves a substep in the time in which its rate is constant. Returns a bound on the error of S. Where the light rests, that
 * time is the step's. */
static double solve_mapped(const td_substeps *substeps, const td_model *input, double to, td_time_map *map,
                           double state[TD_FRONTEND_STATE], td_response *response) {
    const td_filter_input *source = substeps->source;
    const td_frontend *f = source->frontend;
    const td_light_law law = {source->log_eps, f->light, f->dark};
    const double S = substeps->state[0], seconds = f->rate * source->h * (to - substeps->from);
    const td_light_answer answer = td_light_step(input->control, S, seconds, law, map->term);
    const td_model mapped = {{answer.mapped[0], answer.mapped[1], answer.mapped[2], answer.mapped[3]}};
    td_pole_respond(answer.rate, S, &mapped, response);
    map->on = !is_flat(input);
    state[0] = state[1] = state[3] = answer.end;
    state[2] = 0;
    return answer.error;
}

static double solve(const td_substeps *substeps, double to, td_time_map *map, double state[TD_FRONTEND_STATE],
                    td_response *response) {
    td_model input = td_model_part(&substeps->source->input, substeps->from, to);
    map->on = 0;
    if (can_map(substeps->source, &input)) return solve_mapped(substeps, &input, to, map, state, response);
    return solve_frozen(substeps, &input, to, state, response);
}

/* -- the walk -------------------------------------------------------------------------------------------------------------- */

void td_substeps_begin(td_substeps *substeps, const td_filter_input *source, int segment) {
    const td_segment *begin = &source->segment[segment];
    substeps->source = source;
    substeps->from = substeps->to = begin->from;
    substeps->length = begin->length;
    substeps->tried = begin->tried;
    substeps->number = begin->number;
    for (int i = 0; i < TD_FRONTEND_STATE; i++) substeps->state[i] = begin->state[i];
}

void td_substeps_mark(const td_substeps *substeps, td_segment *segment) {
    *segment = (td_segment){substeps->to, substeps->length, {0}, INFINITY, -INFINITY, substeps->tried, substeps->number};
    for (int i = 0; i < TD_FRONTEND_STATE; i++) segment->state[i] = substeps->state[i];
}

void td_substeps_keep(const td_substeps *substeps, td_kept_substeps *kept) {
    if (substeps->number > TD_SUBSTEPS_KEPT) return;
    td_kept_substep *to = &kept->at[substeps->number - 1];
    to->from = substeps->from;
    to->to = substeps->to;
    to->map.on = substeps->map.on;
    if (to->map.on) to->map = substeps->map;
    to->cubic = substeps->response.cubic;
    to->modes = substeps->response.modes;
    for (int k = 0; k < to->modes; k++) to->mode[k] = substeps->response.mode[k];
}

static void take_kept(td_substeps *substeps, const td_kept_substep *kept) {
    substeps->from = kept->from;
    substeps->to = kept->to;
    substeps->map.on = kept->map.on;
    if (kept->map.on) substeps->map = kept->map;
    td_response_set(&substeps->response, &kept->cubic);
    substeps->response.modes = kept->modes;
    for (int k = 0; k < kept->modes; k++) substeps->response.mode[k] = kept->mode[k];
}

int td_substeps_next(td_substeps *substeps) {
    double tolerance = substeps->source->frontend->tolerance, state[TD_FRONTEND_STATE], error;
    if (!(substeps->to < 1)) return 0;
    substeps->number++;
    if (substeps->source->kept) {
        take_kept(substeps, &substeps->source->kept->at[substeps->number - 1]);
        return 1;
    }
    substeps->from = substeps->to;
    for (;;) {
        double left = 1 - substeps->from;
        substeps->to = substeps->length < left ? substeps->from + substeps->length : 1;
        error = solve(substeps, substeps->to, &substeps->map, state, &substeps->response);
        if (++substeps->tried > TRIED_MAX || error <= tolerance) break;
        if (!td_substep_is_told(substeps->from, substeps->length)) break;
        substeps->length = td_substep_again(substeps->to - substeps->from, tolerance, error);
    }
    for (int i = 0; i < TD_FRONTEND_STATE; i++) substeps->state[i] = state[i];
    substeps->length = td_substep_after(substeps->to - substeps->from, tolerance, error);
    if (substeps->tried > TRIED_MAX) substeps->length = 1;
    return 1;
}

static double local(const td_substeps *substeps, double s) { return (s - substeps->from) / (substeps->to - substeps->from); }

double td_substeps_place(const td_substeps *substeps, double s) {
    return td_time_map_place(&substeps->map, local(substeps, s));
}

double td_substeps_time(const td_substeps *substeps, double v) {
    return substeps->from + td_time_map_time(&substeps->map, v) * (substeps->to - substeps->from);
}

double td_substeps_speed(const td_substeps *substeps, double s) {
    return td_time_map_speed(&substeps->map, local(substeps, s)) / (substeps->to - substeps->from);
}

void td_substeps_with(const td_substeps *substeps, const td_model *cubic, td_response *response) {
    td_model part = td_model_part(cubic, substeps->from, substeps->to), more = td_time_map_model(&substeps->map, &part);
    td_response_set(response, &substeps->response.cubic);
    for (int i = 0; i < 4; i++) response->cubic.control[i] += more.control[i];
    response->modes = substeps->response.modes;
    for (int k = 0; k < response->modes; k++) response->mode[k] = substeps->response.mode[k];
}
