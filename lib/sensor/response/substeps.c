/* Filters whose rates go with the light: the first-order filter S' = r (L - S), and the circuit's first stage
 * a2 y'' + a1 y' + y = L. Both have rates that are linear in J = light Y + dark.
 *
 * The first-order filter is constant in a time v that goes as the integral of J (td_warp.h), where L becomes the cubic through
 * its ends. The error is what that cubic misses of L, which no past of S enlarges: pieces are long.
 *
 * The circuit, and the first-order filter where Y is cut off at 0: with J frozen at J_m in the middle of a piece, and
 * e = J / J_m - 1, they are exactly
 *
 *   A2 y'' + A1 y' + y = L + g,   g = e (L - y - k y')      A at J_m; k = output_s / (A_loop + 1), first order: A2 = 0, k = 0
 *
 * so that a piece is the constant filter's exact response to L + g. g is taken as the cubic through its values at 0, 1/3, 2/3
 * and 1, found by repeated substitution: e is small and so is the lag. What the cubic misses of g, seen between its nodes, is
 * an error of the input; a piece is cut shorter until it is within frontend->tolerance. Errors don't add up from piece to
 * piece: the response to an input error is bound by the largest one, times coth(pi z / (2 sqrt(1 - z^2))) for a swing of
 * damping z (3.5 for the defaults in full light) should the error swing along with it. It changes sign at four places of each
 * piece instead, and measured against integration S stays within half of TD_FRONTEND_TOLERANCE (property tests). */
#include "td_substeps.h"
#include "td_lowpass.h"
#include "td_modes.h"

#include <math.h>

/* Sweeps of substitution in a piece, each better by the factor e; pieces tried in a step before any error is taken (steps that
 * an image makes need 1 to 10). */
enum { SWEEPS = 8, TRIED_MAX = 1 << 14, NODES = 4, BETWEEN = 3 };

static const double node[NODES + BETWEEN] = {0, 1.0 / 3, 2.0 / 3, 1, 1.0 / 6, 1.0 / 2, 5.0 / 6};

/* A piece while it is being solved. */
typedef struct attempt {
    const td_frontend *frontend;
    double seconds, log_eps;
    const double *state;
    td_model input;
    double middle;                                                   /* J_m */
    double surplus[NODES + BETWEEN];                                 /* e at the nodes */
    double lead;                                                     /* k [s] */
    int is_still;                                                    /* J doesn't change */
    td_path stage;                                                   /* y */
    td_complex value[2][NODES + BETWEEN], slope[2][NODES + BETWEEN]; /* its modes at the nodes, but for their size */
} attempt;

static double light_at(const attempt *at, double u) {
    double Y = exp(fmin(td_model_value(&at->input, u), 60)) - at->log_eps; /* an HDR image ends far below e^60 */
    return at->frontend->light * fmax(Y, 0) + at->frontend->dark;
}

/* The photoreceptor: y of the circuit, or S of the first-order filter; y' is kept per second. */
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
    for (int i = 0; i < NODES + BETWEEN; i++) {
        td_complex tail[5];
        td_mode_tails(rate, node[i], tail);
        at->value[mode][i] = tail[4];
        at->slope[mode][i] = tail[3];
    }
}

/* The nodes are sixths: one exponential will do. */
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

/* NaN is the largest of all. */
static double larger(double a, double b) { return b <= a || isnan(a) ? a : b; }

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
            worst = larger(worst, fabs(g[i] - before[i]));
        }
        if (!(worst > 0.25 * at->frontend->tolerance)) break;
        cubic = through(g);
    }
    for (int i = NODES; i < NODES + BETWEEN; i++) worst = larger(worst, fabs(missing(at, i) - td_model_value(&cubic, node[i])));
    return worst;
}

/* What follows the photoreceptor, and the state at the piece's end. */
static void finish(const attempt *at, const td_poles *stage, const td_model *input, double state[TD_FRONTEND_STATE],
                   td_path *path) {
    const td_frontend *f = at->frontend;
    td_poles poles = *stage;
    double next[TD_FRONTEND_STATE] = {0};
    next[1] = td_path_value(&at->stage, 1);
    next[2] = td_path_slope(&at->stage, 1) / at->seconds;
    *path = at->stage;
    next[3] = next[1];
    if (f->source_follower > 0) {
        poles = td_poles_then(&poles, f->source_follower * at->seconds, at->state[3]);
        td_poles_respond(&poles, input, path);
        next[3] = td_path_value(path, 1);
    }
    if (f->difference > 0) {
        poles = td_poles_then(&poles, f->difference * at->seconds, at->state[0]);
        td_poles_respond(&poles, input, path);
    }
    next[0] = f->difference > 0 ? td_path_value(path, 1) : next[3];
    for (int i = 0; i < TD_FRONTEND_STATE; i++) state[i] = next[i];
}

static int is_flat(const td_model *model) {
    const double *b = model->control;
    return b[0] == b[1] && b[0] == b[2] && b[0] == b[3];
}

/* The piece from pieces->from to `to`, rates frozen; its error in g. */
static double solve_frozen(const td_pieces *pieces, const td_model *piece, double to, double state[TD_FRONTEND_STATE],
                           td_path *path) {
    const td_drive *drive = pieces->drive;
    attempt at;
    at.frontend = drive->frontend;
    at.log_eps = drive->log_eps;
    at.state = pieces->state;
    at.seconds = drive->h * (to - pieces->from);
    at.input = *piece;
    at.middle = light_at(&at, 0.5);
    at.lead =
        drive->frontend->kind == TD_FRONTEND_CIRCUIT ? drive->frontend->sensor->circuit.output_s / drive->frontend->loop : 0;
    at.is_still = is_flat(piece) || at.frontend->light == 0;
    for (int i = 0; i < NODES + BETWEEN && !at.is_still; i++) at.surplus[i] = light_at(&at, node[i]) / at.middle - 1;
    td_poles stage = photoreceptor(&at);
    td_model input;
    double error = substitute(&at, &stage, &input);
    finish(&at, &stage, &input, state, path);
    return error;
}

/* Where the light changes and Y isn't cut off at 0. */
static int can_warp(const td_drive *drive, const td_model *input) {
    double cut = log(drive->log_eps), least = INFINITY, most = -INFINITY;
    for (int i = 0; i < 4; i++) {
        least = fmin(least, input->control[i]);
        most = fmax(most, input->control[i]);
    }
    return drive->frontend->kind == TD_FRONTEND_INTENSITY && least >= cut && least < most && most < 60;
}

/* The same piece in its own time: S within the error returned. */
static double solve_warped(const td_pieces *pieces, const td_model *input, double to, td_warp *warp,
                           double state[TD_FRONTEND_STATE], td_path *path) {
    const td_drive *drive = pieces->drive;
    const td_frontend *f = drive->frontend;
    double rate_error, error = 0, lag = 0, S = pieces->state[0];
    double rate = f->rate * drive->h * (to - pieces->from);
    rate *= td_warp_make(warp, input, drive->log_eps, f->light, f->dark, &rate_error);
    td_model warped = td_warp_model(warp, input);
    td_poles poles = td_poles_first_order(rate, S, input->control[0]);
    td_poles_respond(&poles, &warped, path);
    state[0] = state[1] = state[3] = td_path_value(path, 1);
    state[2] = 0;
    for (int i = 1; i < 4; i++) {
        double L = td_model_value(input, 0.25 * i);
        error = larger(error, fabs(td_model_value(&warped, td_warp_place(warp, 0.25 * i)) - L));
        lag = larger(lag, fabs(L - S) + fabs(input->control[i] - input->control[0]));
    }
    return error + rate_error * lag;
}

static double solve(const td_pieces *pieces, double to, td_warp *warp, double state[TD_FRONTEND_STATE], td_path *path) {
    td_model input = td_model_part(&pieces->drive->input, pieces->from, to);
    warp->on = 0;
    if (can_warp(pieces->drive, &input)) return solve_warped(pieces, &input, to, warp, state, path);
    return solve_frozen(pieces, &input, to, state, path);
}

/* -- the walk -------------------------------------------------------------------------------------------------------------- */

void td_pieces_begin(td_pieces *pieces, const td_drive *drive, int stretch) {
    const td_stretch *begin = &drive->stretch[stretch];
    pieces->drive = drive;
    pieces->from = pieces->to = begin->from;
    pieces->length = begin->length;
    pieces->tried = begin->tried;
    for (int i = 0; i < TD_FRONTEND_STATE; i++) pieces->state[i] = begin->state[i];
}

void td_pieces_mark(const td_pieces *pieces, td_stretch *stretch) {
    *stretch = (td_stretch){pieces->to, pieces->length, {0}, INFINITY, -INFINITY, pieces->tried};
    for (int i = 0; i < TD_FRONTEND_STATE; i++) stretch->state[i] = pieces->state[i];
}

/* The error of the cubic goes with the fourth power of the length. */
static double better_length(double length, double tolerance, double error, double least, double most) {
    double factor = 0.8 * sqrt(sqrt(tolerance / error));
    return length * (factor < most ? fmax(factor, least) : most); /* NaN: most */
}

int td_pieces_next(td_pieces *pieces) {
    double tolerance = pieces->drive->frontend->tolerance, state[TD_FRONTEND_STATE], error;
    if (!(pieces->to < 1)) return 0;
    pieces->from = pieces->to;
    for (;;) {
        double left = 1 - pieces->from;
        pieces->to = pieces->length < left ? pieces->from + pieces->length : 1;
        error = solve(pieces, pieces->to, &pieces->warp, state, &pieces->path);
        if (++pieces->tried > TRIED_MAX || error <= tolerance) break;
        if (!(pieces->from + 0.1 * pieces->length > pieces->from)) break; /* no shorter piece can be told from none */
        pieces->length = better_length(pieces->to - pieces->from, tolerance, error, 0.05, 0.6);
    }
    for (int i = 0; i < TD_FRONTEND_STATE; i++) pieces->state[i] = state[i];
    pieces->length = better_length(pieces->to - pieces->from, tolerance, error, 0.5, 4);
    if (pieces->tried > TRIED_MAX) pieces->length = 1;
    return 1;
}

static double local(const td_pieces *pieces, double s) { return (s - pieces->from) / (pieces->to - pieces->from); }

double td_pieces_place(const td_pieces *pieces, double s) { return td_warp_place(&pieces->warp, local(pieces, s)); }

double td_pieces_time(const td_pieces *pieces, double v) {
    return pieces->from + td_warp_time(&pieces->warp, v) * (pieces->to - pieces->from);
}

double td_pieces_speed(const td_pieces *pieces, double s) {
    return td_warp_speed(&pieces->warp, local(pieces, s)) / (pieces->to - pieces->from);
}

void td_pieces_with(const td_pieces *pieces, const td_model *cubic, td_path *path) {
    td_model part = td_model_part(cubic, pieces->from, pieces->to), more = td_warp_model(&pieces->warp, &part);
    td_path_set(path, &pieces->path.cubic);
    for (int i = 0; i < 4; i++) path->cubic.control[i] += more.control[i];
    path->modes = pieces->path.modes;
    for (int k = 0; k < path->modes; k++) path->mode[k] = pieces->path.mode[k];
}
