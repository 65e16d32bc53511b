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
enum { MOST_LOOKS = 10, FIND_BY_PLACE = 2 };

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
    int settles;                  /* all steps before are settled */
    int nodes;
    td_node node[TD_NODES_MAX];
    td_changes changes;
    worth worth[TD_CHANGES_MAX]; /* of each */
    td_trusted model;
} visit;

/* -- the step -------------------------------------------------------------------------------------------------------------- */

static uint64_t state_of(const visit *v) { return td_hash_words(0, v->state.word, (size_t)v->state.words * sizeof(uint64_t)); }

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
    const double samples = s->solve.precision == TIDES_SOLVE_DOUBLE ? s->solve.samples : 0;
    v->model.start = v->looked->known_ends & TD_KNOWS_START ? 0 : samples;
    v->model.end = v->looked->known_ends & TD_KNOWS_END ? 0 : samples;
    v->model.floor = s->solve.is_exact
                         ? TD_DOUBLE_ROUNDING * (1 + fabs(v->looked->ends.S1))
                         : td_timing_rounding(&s->timing, &s->tile[v->pixel->tile], v->now->signals.S1, v->pixel->local);
}

/* -- what is to be looked up ---------------------------------------------------------------------------------------------- */

static tides_status ask(const visit *v, double s, tides_error *error) {
    const double time = v->now->from + s * (v->now->to - v->now->from);
    const td_asked asked = {v->number, v->pixel->local, s};
    return td_solve_ask(v->s, &v->s->tile[v->pixel->tile], v->pixel->local, td_lesser(time, v->now->to), &asked, error);
}

static void weigh(visit *v) {
    const td_pieces *pieces = &v->model.pieces;
    for (int n = 0, k = 0; n < v->changes.count; n++) {
        const td_change *change = &v->changes.change[n];
        k = td_pieces_find_from(pieces, k, change->s);
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

/* How many changes are at s or before, and the reference behind so many. */
static int changes_until(const visit *v, double s) {
    int n = 0;
    while (n < v->changes.count && v->changes.change[n].s <= s) n++;
    return n;
}

static double reference_after(const visit *v, int n) { return n > 0 ? v->changes.change[n - 1].reference : v->reference; }

/* Is a refractory period on at s, behind n changes? */
static int is_held_at(const visit *v, int n, double s) {
    const td_sensor *sensor = &v->s->sensor;
    const td_step *span = &v->now->span;
    if (n == 0) return v->held_until > td_sensor_time(sensor, span->start_ns, span->start_fraction) + s * span->length_ns;
    const td_change *last = &v->changes.change[n - 1];
    return last->fired && sensor->on && (s - last->s) * span->length_ns < sensor->refractory_ns;
}

/* A place where the signal may be at a level that the model doesn't reach: what the model is off by and may be, and how far the
 * level is. */
typedef struct approach {
    double s, error, doubt, left;
} approach;

/* By how much doubt is more than what is left. */
static double excess_of(const visit *v, const approach *at) { return at->doubt + v->model.floor - at->left; }

/* The polarity of the change behind n of them, if it is in piece k still, or 0. */
static int next_polarity(const visit *v, int k, int n) {
    const td_change *next = &v->changes.change[n];
    return n < v->changes.count && next->s <= v->model.pieces.from[k + 1] ? next->polarity : 0;
}

/* At u of piece k. A level that the model reaches next in the piece counts for nothing: when it does, is looked up. */
static approach approach_at(const visit *v, int k, double u) {
    const td_sensor *sensor = &v->s->sensor;
    const td_pieces *pieces = &v->model.pieces;
    approach at = {.s = pieces->from[k] + u * (pieces->from[k + 1] - pieces->from[k]),
                   .error = td_trusted_error(&v->model, k, u),
                   .doubt = td_trusted_doubt(&v->model, k, u),
                   .left = INFINITY};
    const int n = changes_until(v, at.s), next = next_polarity(v, k, n);
    const double residual = td_model_value(&pieces->model[k], u) - reference_after(v, n);
    const double on = td_sensor_threshold_on(sensor, v->at) - residual, off = residual + td_sensor_threshold_off(sensor, v->at);
    if (on <= 0 || off <= 0 || is_held_at(v, n, at.s)) return at;
    if (next <= 0) at.left = on;
    if (next >= 0) at.left = td_lesser(at.left, off);
    return at;
}

/* May a level be within reach anywhere in piece k, for all that its control values and its doubt say? Most have none, and
 * places in them needn't be gone through. */
static int may_reach(const visit *v, int k) {
    const td_sensor *sensor = &v->s->sensor;
    const double *b = v->model.pieces.model[k].control, doubt = td_trusted_doubt(&v->model, k, 0.5);
    const double most = td_greater(td_greater(b[0], b[1]), td_greater(b[2], b[3])) + doubt + v->model.floor;
    const double least = td_lesser(td_lesser(b[0], b[1]), td_lesser(b[2], b[3])) - doubt - v->model.floor;
    if (doubt <= v->model.floor) return 0;
    for (int n = changes_until(v, v->model.pieces.from[k]);; n++) {
        const double reference = reference_after(v, n);
        const int next = next_polarity(v, k, n);
        if (next <= 0 && most - reference >= td_sensor_threshold_on(sensor, v->at)) return 1;
        if (next >= 0 && reference - least >= td_sensor_threshold_off(sensor, v->at)) return 1;
        if (n >= v->changes.count || v->changes.change[n].s > v->model.pieces.from[k + 1]) return 0;
    }
}

static void take_worse(const visit *v, const approach *at, approach *worst) {
    if (excess_of(v, at) > excess_of(v, worst)) *worst = *at;
}

/* The worst of places between turns, for the signal may turn where the model doesn't. What the step's ends are off by counts
 * for nothing there: they are looked up as such, and a signal that rests on a level would else be found there and beside it. */
static void look_between(const visit *v, int k, approach *worst) {
    enum { EIGHTHS = 8 };
    const td_pieces *pieces = &v->model.pieces;
    const double length = pieces->from[k + 1] - pieces->from[k];
    const double on = td_sensor_threshold_on(&v->s->sensor, v->at), off = td_sensor_threshold_off(&v->s->sensor, v->at);
    for (int i = 1; i < EIGHTHS; i++) {
        const double u = (double)i / EIGHTHS, doubt = td_trusted_doubt(&v->model, k, u), slack = doubt + v->model.floor;
        const double reference = reference_after(v, changes_until(v, pieces->from[k] + u * length));
        const double residual = td_model_value(&pieces->model[k], u) - reference;
        if (doubt <= v->model.floor || (on - residual > slack && residual + off > slack)) continue; /* most are */
        const approach at = approach_at(v, k, u);
        take_worse(v, &at, worst);
    }
}

/* How far beyond the level that the piece went through last its turn at s is: where the model is off by more, the signal may have
 * turned before the level. Of a kink a cubic makes such turns, whose crossings are sharp, and not there. */
static double beyond_at(const visit *v, int k, double s) {
    const td_pieces *pieces = &v->model.pieces;
    const int n = changes_until(v, s);
    if (n == 0 || v->changes.change[n - 1].polarity == 0 || v->changes.change[n - 1].s < pieces->from[k]) return INFINITY;
    const double residual = td_model_value(&pieces->model[k], td_pieces_place(pieces, k, s)) - reference_after(v, n);
    const double beyond = residual * v->changes.change[n - 1].polarity, known = td_greater(v->model.start, v->model.end);
    return beyond > known + v->model.floor ? beyond : INFINITY; /* what rests on a level to the last bit is on either side */
}

/* Where pieces may be off by more than what is left to a level: the worst place of each. */
static int find_approaches(const visit *v, approach *found, int most) {
    const td_pieces *pieces = &v->model.pieces;
    int count = 0;
    for (int k = 0; k < pieces->count && count < most; k++) {
        double places[2];
        const int turns = td_model_extrema(&pieces->model[k], places);
        approach worst = {.left = INFINITY};
        for (int i = 0; i < turns; i++) {
            approach at = approach_at(v, k, places[i]);
            at.doubt = td_greater(at.doubt, at.error);
            at.left = td_lesser(at.left, beyond_at(v, k, at.s));
            take_worse(v, &at, &worst);
        }
        if (may_reach(v, k)) look_between(v, k, &worst);
        if (excess_of(v, &worst) >= 0) found[count++] = worst;
    }
    return count;
}

/* How far the signal is from its levels at s, an end of the step, and from its reference; a held one has none. What it does at
 * the very start comes of that. */
static double left_at(const visit *v, double s, double *residual) {
    const td_sensor *sensor = &v->s->sensor;
    const td_pieces *pieces = &v->model.pieces;
    const double at = s > 0 ? s : -1; /* before what it does there */
    const int n = changes_until(v, at);
    const double S = s > 0 ? pieces->model[pieces->count - 1].control[3] : pieces->model[0].control[0];
    *residual = S - reference_after(v, n);
    const double on = td_sensor_threshold_on(sensor, v->at), off = td_sensor_threshold_off(sensor, v->at);
    return is_held_at(v, n, at) ? INFINITY : td_lesser(on - *residual, *residual + off);
}

/* Does an error of so much decide whether the signal is beyond a level there? At the step's end it may have got there just
 * before. */
static int is_in_doubt(const visit *v, double s, double error) {
    double residual;
    return left_at(v, s, &residual) <= error || (s > 0 && v->changes.count > 0 && fabs(residual) <= error);
}

/* Asks for the ends of the step where samples are too near a level. What is run ahead may ask in vain, and samples would depend
 * on how far that goes. A macro step begins with what the one before it ended with, be it a sample or not: its own record paths
 * begin elsewhere by what paths may be off by, and the pixel might be found beyond a level. */
static tides_status ask_ends(const visit *v, tides_error *error) {
    const int begins = v->s->refine.step[v->looked->step].from == 0;
    tides_status status = TIDES_OK;
    if (!v->settles) return status;
    if (v->model.start > 0 && !begins && is_in_doubt(v, 0, v->model.start + v->model.floor)) status = ask(v, 0, error);
    if (status == TIDES_OK && v->model.end > 0 && is_in_doubt(v, 1, v->model.end + v->model.floor)) status = ask(v, 1, error);
    return status;
}

/* Asks for the place of change n, and, where looks at such places have not found it so far, for the middle of its piece: of a
 * cubic that an end bends down it finds a crossing a little further on each time, and that end is where it isn't right. */
static tides_status ask_change(const visit *v, int n, tides_error *error) {
    const td_pieces *pieces = &v->model.pieces;
    const double at = v->changes.change[n].s;
    tides_status status = ask(v, at, error);
    if (status != TIDES_OK || v->looked->looks < FIND_BY_PLACE) return status;
    const int k = td_pieces_find_from(pieces, 0, at);
    const double middle = 0.5 * (pieces->from[k] + pieces->from[k + 1]);
    return fabs(middle - at) > TD_SOLVE_APART ? ask(v, middle, error) : status;
}

/* Asks for what isn't good enough; `*asked` says whether there was any. Where levels stay in doubt, they are counted. */
static tides_status judge(visit *v, int *asked, int *doubts, tides_error *error) {
    enum { MOST_APPROACHES = 16 };
    approach near[MOST_APPROACHES];
    const td_solve_batch *batch = td_solve_asking(&v->s->solve);
    const size_t before = batch->points;
    const int may_ask = v->looked->looks < MOST_LOOKS;
    const int count = find_approaches(v, near, MOST_APPROACHES);
    tides_status status = may_ask ? ask_ends(v, error) : TIDES_OK;
    *doubts = 0;
    weigh(v);
    for (int k = 0; k < v->changes.count && status == TIDES_OK && may_ask; k++)
        if (!is_good(v, k)) status = ask_change(v, k, error);
    for (int k = 0; k < count && status == TIDES_OK; k++) {
        if (may_ask && near[k].doubt > v->model.floor)
            status = ask(v, near[k].s, error);
        else
            *doubts += near[k].left <= near[k].error + v->model.floor;
    }
    *asked = batch->points > before;
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

static int ends_run(const visit *v) { return td_ends_run(v->s, &v->s->refine.step[v->looked->step]); }

/* What record paths make of the pixel's nodes. */
static td_path_law paths_of(const visit *v) {
    td_path_law law = {0};
    for (int i = 0; i < v->nodes; i++) {
        const double time = v->now->from + v->node[i].s * (v->now->to - v->now->from);
        const td_path_law own = td_renderer_points_law(v->s->renderer, time);
        law = i == 0 ? own : td_path_law_worse(&law, &own);
    }
    return law;
}

/* A share of events, which record paths put off by `paths`, and after which `left` of the step is left; what of it may be
 * undone. */
static double add_share(visit *v, const worth *at, double left, double share, double paths) {
    const double error = td_timing_together(at->error, v->model.floor + paths);
    return share > 0 ? td_timing_add_solved(&v->s->timing, share, error, at->slope, at->bend, v->now->span.length_s, left) : 0;
}

/* An event that may be undone for so much of what it may be off by is uncertain. */
static const double much = 0.25;

/* What a solved event may be off by: what is left there, and what record paths do. */
static void note_error(visit *v, int n, const td_path_law *law) {
    static const double slice[TD_PATH_SLICES] = {16.0 / 32, 13.0 / 32, 3.0 / 32}, kink[TD_PATH_KINKS] = {3.0 / 4, 1.0 / 4};
    const worth *at = &v->worth[n];
    const double late = waited(v, &v->changes.change[n]), left = ends_run(v) ? 1 - v->changes.change[n].s : INFINITY;
    double undone = 0;
    if (late > 0) {
        td_timing_add_solved(&v->s->timing, 1, late, 1, 0, v->now->span.length_s, left);
        return;
    }
    if (law->smooth[TD_PATH_SLICES - 1] > 0 || law->bent > 0) {
        for (int k = 0; k < TD_PATH_SLICES; k++) undone += add_share(v, at, left, slice[k] * (1 - law->bent), law->smooth[k]);
        for (int k = 0; k < TD_PATH_KINKS; k++) undone += add_share(v, at, left, kink[k] * law->bent, law->kink[k]);
    } else {
        undone = add_share(v, at, left, 1, 0);
    }
    v->s->timing.uncertain += (uint64_t)(undone > much);
}

/* What the events of a settled step are worth. Noise has times of its own. */
static void note_events(visit *v, int doubts) {
    tides_simulator *s = v->s;
    const int count = v->changes.count;
    int k = 0;
    double residual;
    s->timing.uncertain += (uint64_t)(doubts + (ends_run(v) && left_at(v, 1, &residual) <= v->model.end + v->model.floor));
    while (k < count && !v->changes.change[k].fired) k++;
    if (k == count) return; /* most steps: what paths are off by is nobody's then */
    const td_path_law law = paths_of(v);
    for (; k < count; k++) {
        if (!v->changes.change[k].fired) continue;
        note_error(v, k, &law);
        s->solve.events += (uint64_t)(v->nodes > 0);
    }
}

/* The pixel's next step; `*asked` where something in it is to be looked up, else it is settled if all before were. */
static tides_status pass_step(visit *v, int *asked, tides_error *error) {
    int doubts = 0;
    *asked = 0;
    if (!may_act(v)) return TIDES_OK;
    take_nodes(v);
    tides_status status = advance(v, error);
    take_rounding(v);
    if (status == TIDES_OK) status = judge(v, asked, &doubts, error);
    if (status == TIDES_OK && v->settles && !*asked) note_events(v, doubts);
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
        v.settles = unsettled == pixel->end;
        if (v.settles) {
            counts = s->sensor.counts;
            events = s->events.count;
        }
        status = pass_step(&v, &asked, error);
        if (asked && v.settles) {
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
