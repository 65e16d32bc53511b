/* One pixel through the steps of a macro step, as far as it is settled: what its comparator does, which of the places are good
 * enough, and which are to be looked up. For solve.c, which looks them up. */
#include "signal/td_model_error.h"
#include "td_extremes.h"
#include "td_hash.h"
#include "td_probe.h"
#include "td_simulator.h"

#include <math.h>

/* Rounds of looking up that a pixel may take in a step: each squares what is left of a smooth signal's error, and halves what a
 * kink may be in. What isn't settled then is reported as it stands. */
enum { MOST_LOOKS = 10 };

/* References that are taken from the signal: so good that no event which follows feels it [thresholds]. */
static const double enough_of_threshold = 1e-7;

/* What a change is worth: slope and curvature there towards its polarity, per step, and what the signal may be off by. */
typedef struct worth {
    double slope, bend, error;
} worth;

/* A pixel in a step. */
typedef struct visit {
    tides_simulator *s;
    const td_solving *pixel;
    size_t at;      /* the sensor's */
    int32_t number; /* of what is known of the pixel in this step, */
    td_looked *looked;
    const td_solve_step *now;
    double reference, held_until; /* that the step begins with, */
    td_kept_pixel state;          /* and all else */
    int nodes;
    td_node node[TD_NODES_MAX];
    td_changes changes;
    worth worth[TD_CHANGES_MAX]; /* of each */
    td_trusted model;
} visit;

/* -- the step -------------------------------------------------------------------------------------------------------------- */

/* Of ideal pixels counts are all: the rest follows from them. */
static uint64_t state_of(const visit *v) {
    return v->state.words <= 2 ? v->state.word[0] : td_hash_words(0, v->state.word, (size_t)v->state.words * sizeof(uint64_t));
}

/* What was found for another state is forgotten. */
static void enter(visit *v, int32_t number) {
    const td_sensor *sensor = &v->s->sensor;
    v->number = number;
    v->looked = &v->s->solve.looked[number];
    v->now = &v->s->solve.step[v->looked->step];
    v->reference = sensor->pixels.reference[v->at];
    v->held_until = sensor->on ? sensor->held_until[v->at] : -INFINITY;
    td_sensor_keep(sensor, v->at, &v->state);
    if (v->looked->looks == 0 || v->looked->state == state_of(v)) return;
    td_solve_first_trust(v->s, &v->s->refine.step[v->looked->step], v->looked->ends.h, v->pixel->local, 1, &v->looked->trust);
    v->looked->first = -1;
    v->looked->nodes = v->looked->looks = 0;
}

/* With nothing found and nothing near, the pixel is at the step's end. */
static int may_act(const visit *v) {
    static const td_tile one = {0, 0, 1, 1};
    const td_ends *at = &v->looked->ends;
    const td_signals own = {&at->S0, &at->S0_dot, &at->S1, &at->S1_dot};
    const double widen = v->looked->trust.error + v->s->solve.samples;
    uint8_t active = 0;
    if (v->looked->looks > 0) return 1;
    td_sensor_find(&v->s->sensor, &v->now->span, &one, v->at, &own, &widen, &active);
    return active;
}

static void take_nodes(visit *v) {
    v->nodes = td_solve_nodes(&v->s->solve, v->looked, v->node, v->model.trust);
    td_pieces_make(&v->model.pieces, &v->looked->ends, v->node, v->nodes);
}

/* What else the model is off by. */
static void take_rounding(visit *v) {
    const tides_simulator *s = v->s;
    v->model.ends = s->solve.precision == TIDES_SOLVE_DOUBLE ? s->solve.samples : 0;
    v->model.floor = s->solve.is_exact
                         ? TD_SOLVE_DOUBLE_ROUNDING * (1 + fabs(v->looked->ends.S1))
                         : td_timing_rounding(&s->timing, &s->tile[v->pixel->tile], v->now->signals.S1, v->pixel->local);
}

/* -- what is to be looked up ---------------------------------------------------------------------------------------------- */

static tides_status ask(const visit *v, double s, tides_error *error) {
    const double time = v->now->from + s * (v->now->to - v->now->from);
    const td_asked asked = {v->number, s};
    return td_solve_ask(v->s, &v->s->tile[v->pixel->tile], v->pixel->local, td_lesser(time, v->now->to), &asked, error);
}

static void weigh(visit *v) {
    const td_pieces *pieces = &v->model.pieces;
    for (int n = 0; n < v->changes.count; n++) {
        const td_change *change = &v->changes.change[n];
        const int k = td_pieces_find(pieces, change->s);
        const double sign = change->polarity ? change->polarity : 1, per = 1 / (pieces->from[k + 1] - pieces->from[k]);
        const double u = td_pieces_place(pieces, k, change->s);
        v->worth[n].slope = sign * per * td_model_slope(&pieces->model[k], u);
        v->worth[n].bend = sign * per * per * td_model_curvature(&pieces->model[k], u);
        v->worth[n].error = td_trusted_error(&v->model, k, u);
    }
}

/* Is what happens at change n as good as asked for? */
static int is_good(const visit *v, int n) {
    int touches;
    const td_change *change = &v->changes.change[n];
    const worth *at = &v->worth[n];
    if (!(change->s > 0 && change->s < 1) || at->error <= v->model.floor) return 1;
    if (change->polarity == 0) return at->error <= enough_of_threshold * td_sensor_least_threshold(&v->s->sensor.sensor);
    return td_timing_reach(at->slope, at->bend, at->error, &touches) * v->now->span.length_s <= v->s->solve.target_s;
}

/* The reference at s, and whether a refractory period is on. */
static double reference_at(const visit *v, double s, int *is_held) {
    const td_sensor *sensor = &v->s->sensor;
    const double start = td_sensor_time(sensor, v->now->span.start_ns, v->now->span.start_fraction);
    double reference = v->reference;
    *is_held = v->held_until > start + s * v->now->span.length_ns;
    for (int k = 0; k < v->changes.count && v->changes.change[k].s <= s; k++) {
        const td_change *change = &v->changes.change[k];
        reference = change->reference;
        *is_held = change->fired && sensor->on && (s - change->s) * v->now->span.length_ns < sensor->refractory_ns;
    }
    return reference;
}

/* A turn of the signal that the error may take to a level which it hasn't reached. */
typedef struct turn {
    double s, error;
} turn;

static int near_turns(const visit *v, turn *found, int most) {
    const td_sensor *sensor = &v->s->sensor;
    const double on = sensor->on ? sensor->threshold_on[v->at] : sensor->sensor.threshold_on;
    const double off = sensor->on ? sensor->threshold_off[v->at] : sensor->sensor.threshold_off;
    const td_pieces *pieces = &v->model.pieces;
    int count = 0;
    for (int k = 0; k < pieces->count; k++) {
        const td_model *model = &pieces->model[k];
        double places[2];
        const int turns = td_model_extrema(model, places);
        for (int t = 0; t < turns && count < most; t++) {
            const double s = pieces->from[k] + places[t] * (pieces->from[k + 1] - pieces->from[k]);
            int is_held;
            const double residual = td_model_value(model, places[t]) - reference_at(v, s, &is_held);
            const double left = td_model_curvature(model, places[t]) < 0 ? on - residual : residual + off;
            const double error = td_trusted_error(&v->model, k, places[t]);
            if (!is_held && left > 0 && left <= error + v->model.floor) found[count++] = (turn){s, error};
        }
    }
    return count;
}

/* Asks for what isn't good enough; `*asked` says whether there was any. Where turns stay in doubt, they are counted. */
static tides_status judge(visit *v, int *asked, int *doubts, tides_error *error) {
    enum { MOST_TURNS = 16 };
    turn turns[MOST_TURNS];
    const td_solve *solve = &v->s->solve;
    const size_t before = solve->points;
    const int may_ask = v->looked->looks < MOST_LOOKS;
    const int count = near_turns(v, turns, MOST_TURNS);
    tides_status status = TIDES_OK;
    *doubts = 0;
    weigh(v);
    for (int k = 0; k < v->changes.count && status == TIDES_OK && may_ask; k++)
        if (!is_good(v, k)) status = ask(v, v->changes.change[k].s, error);
    for (int k = 0; k < count && status == TIDES_OK; k++) {
        if (may_ask && turns[k].error > v->model.floor)
            status = ask(v, turns[k].s, error);
        else
            ++*doubts;
    }
    *asked = solve->points > before;
    if (!*asked) return status;
    v->looked->looks++;
    v->looked->state = state_of(v);
    return status;
}

/* -- the pixel ------------------------------------------------------------------------------------------------------------- */

static tides_status advance(visit *v, tides_error *error) {
    const td_tile *tile = &v->s->tile[v->pixel->tile];
    const int32_t i = v->pixel->local;
    td_sensor_single single = {.step = &v->now->span,
                               .pixel = v->at,
                               .x = tile->x0 + i % tile->width,
                               .y = tile->y0 + i / tile->width,
                               .ends = &v->looked->ends,
                               .pieces = &v->model.pieces,
                               .changes = &v->changes};
    if (v->now->coverage.begin) single.coverage = (td_coverage){v->now->coverage.begin + i, v->now->coverage.end + i};
    return td_sensor_advance(&v->s->sensor, &single, &v->s->events, error);
}

/* Of an event that waited for its pixel to become visible coverage decides when, which the comparator takes to be linear: by
 * how much its rates at the ends say that it bows [steps]; 0 of others. */
static double waited(const visit *v, const td_change *change) {
    const td_coverage *at = &v->now->coverage, *rate = &v->now->alpha_dot;
    const int32_t i = v->pixel->local;
    if (!at->begin || at->begin[i] >= v->s->sensor.sensor.b_min) return 0;
    const double rise = at->end[i] - at->begin[i], visible = (v->s->sensor.sensor.b_min - at->begin[i]) / rise;
    if (change->s > visible + TD_SOLVE_APART) return 0;
    const double bow =
        td_greater(fabs(v->looked->ends.h * rate->begin[i] - rise), fabs(v->looked->ends.h * rate->end[i] - rise));
    return td_lesser(0.25 * bow / fabs(rise), 1);
}

/* What the worst splat's record path makes of the pixel's nodes, and the share of events which that is reported for. */
static double paths_of(const visit *v, double *share) {
    double worst = 0, most = 0;
    for (int i = 0; i < v->nodes; i++) {
        double bent;
        const double time = v->now->from + v->node[i].s * (v->now->to - v->now->from);
        worst = td_greater(worst, td_renderer_points_error(v->s->renderer, time, &bent));
        most = td_greater(most, bent);
    }
    *share = worst > TD_SOLVE_LOST ? td_lesser(td_greater(TD_SOLVE_BENT, TD_SOLVE_SPLATS * most), 1) : TD_SOLVE_BENT;
    return worst;
}

/* What a solved event may be off by: what is left there, and what most record paths do, and in a share of all events the
 * worst. */
static void note_error(visit *v, int n) {
    td_timing *timing = &v->s->timing;
    const worth *at = &v->worth[n];
    const double h = v->now->span.length_s, late = waited(v, &v->changes.change[n]);
    double share;
    const double worst = paths_of(v, &share), most = td_lesser(worst, v->s->solve.usual_paths), bent = worst > most ? share : 0;
    if (late > 0) {
        td_timing_add_solved(timing, 1, late, 1, 0, h);
        return;
    }
    td_timing_add_solved(timing, 1 - bent, td_timing_together(at->error, v->model.floor + most), at->slope, at->bend, h);
    if (bent > 0)
        td_timing_add_solved(timing, bent, td_timing_together(at->error, v->model.floor + worst), at->slope, at->bend, h);
}

/* What the events of a settled step are worth. Noise has times of its own. */
static void note_events(visit *v, int doubts) {
    tides_simulator *s = v->s;
    s->timing.uncertain += (uint64_t)doubts;
    for (int k = 0; k < v->changes.count; k++) {
        if (!v->changes.change[k].fired) continue;
        note_error(v, k);
        s->solve.events += (uint64_t)(v->nodes > 0);
    }
}

/* The pixel's next step; `*asked` where something in it is to be looked up, else it is settled if all before were. */
static tides_status pass_step(visit *v, int settles, int *asked, tides_error *error) {
    int doubts = 0;
    *asked = 0;
    if (!may_act(v)) return TIDES_OK;
    take_nodes(v);
    tides_status status = advance(v, error);
    take_rounding(v);
    if (status == TIDES_OK) status = judge(v, asked, &doubts, error);
    if (status == TIDES_OK && settles && !*asked) note_events(v, doubts);
    return status;
}

tides_status td_solve_run(tides_simulator *s, td_solving *pixel, tides_error *error) {
    visit v; /* large: what a step has no use for isn't set */
    td_kept_pixel settled = {.words = 0};
    td_sensor_counts counts = s->sensor.counts;
    size_t events = s->events.count;
    int32_t unsettled = pixel->end;
    tides_status status = TIDES_OK;
    v.s = s;
    v.pixel = pixel;
    v.at = s->first_pixel[pixel->tile] + (size_t)pixel->local;
    for (int32_t k = pixel->next; k < pixel->end && status == TIDES_OK; k++) {
        int asked = 0;
        enter(&v, k);
        if (unsettled == pixel->end) {
            counts = s->sensor.counts;
            events = s->events.count;
        }
        status = pass_step(&v, unsettled == pixel->end, &asked, error);
        if (asked && unsettled == pixel->end) {
            unsettled = k;
            settled = v.state;
        }
        if (asked && s->sensor.on) break; /* what follows depends on when this was: it would be looked up in vain */
    }
    pixel->next = unsettled;
    if (unsettled == pixel->end) return status;
    s->sensor.counts = counts;
    s->events.count = events;
    td_sensor_put_back(&s->sensor, v.at, &settled);
    return status;
}
