/* Takes one pixel through the steps of a macro step, as far as it is settled: runs its comparator, decides which places are
 * known well enough, and requests look-ups at the others. */
#include "signal/td_model_error.h"
#include "sensor/td_single.h"
#include "solver/td_swapped.h"
#include "td_extremes.h"
#include "td_hash.h"
#include "solver/td_probe.h"
#include "solver/td_visit.h"

#include <math.h>

/* Rounds of look-ups that a pixel may take in a step. Each squares the remaining error of a smooth signal, and halves the range
 * in which a kink may be. A pixel that isn't settled then is reported as it stands. */
enum { MOST_LOOKS = 10, FIND_BY_PLACE = 2 };

/* -- the step -------------------------------------------------------------------------------------------------------------- */

/* The pixel's state as one number. For an ideal pixel it is made of the event counts, from which the rest follows. */
static uint64_t state_of(const td_visit *v) {
    return v->state.words <= 2 ? v->state.word[0] : td_hash_words(0, v->state.word, (size_t)v->state.words * sizeof(uint64_t));
}

/* Enters a step. Nodes that were found for another state are dropped. */
static void enter(td_visit *v, td_looked *looked, int32_t number) {
    const td_sensor *sensor = &v->s->sensor;
    v->number = number;
    v->looked = &looked[number];
    v->now = &v->s->solve.step[v->looked->step];
    v->reference = sensor->pixels.reference[v->at];
    v->held_until = sensor->on ? sensor->held_until[v->at] : -INFINITY;
    td_sensor_keep(sensor, v->at, &v->state);
    v->swap = td_solve_swaps(v->s, &v->s->refine.step[v->looked->step], v->pixel->local, &v->swaps);
    if (v->looked->looks == 0 || v->looked->state == state_of(v)) return;
    td_solve_first_trust(v->s, &v->s->refine.step[v->looked->step], v->looked->ends.h, v->pixel->local, 1, &v->looked->trust);
    v->looked->first = -1;
    v->looked->nodes = v->looked->looks = 0;
}

/* 1 where the pixel may do something in the step. A pixel with nothing found and nothing near goes to the step's end. */
static int may_act(const td_visit *v) {
    static const td_tile one = {0, 0, 1, 1};
    const td_ends *at = &v->looked->ends;
    const td_signals own = {&at->S0, &at->S0_dot, &at->S1, &at->S1_dot};
    if (v->looked->looks > 0) return 1;
    const double light = td_solve_unseen_light(v->s, &v->s->refine.step[v->looked->step], v->swap, v->swaps);
    const double S = td_lesser(at->S0, at->S1), swapped = td_solve_moved_by(v->s, light, S);
    const double widen = td_solve_first_widen(&v->s->solve, &v->looked->trust, S) + swapped;
    uint8_t active = 0;
    td_sensor_find(&v->s->sensor, &v->now->span, &one, v->at, &own, &widen, &active);
    return active;
}

static void take_nodes(td_visit *v) {
    v->nodes = td_solve_nodes(&v->s->solve, v->looked, v->node, v->model.trust);
    td_pieces_make(&v->model.pieces, &v->looked->ends, v->node, v->nodes);
    td_find_swapped(v);
}

/* Adds the errors of the model beside its pieces: of samples at the step's ends, and of rounding. */
static void take_rounding(td_visit *v) {
    const tides_simulator *s = v->s;
    const td_ends *at = &v->looked->ends;
    v->model.start = v->looked->known_ends & TD_KNOWS_START ? 0 : td_solve_sample_error(&s->solve, at->S0);
    v->model.end = v->looked->known_ends & TD_KNOWS_END ? 0 : td_solve_sample_error(&s->solve, at->S1);
    v->model.floor = s->solve.is_exact ? TD_DOUBLE_ROUNDING * (1 + fabs(v->looked->ends.S1))
                                       : td_timing_rounding(&s->done.timing, &s->layout.unit[v->pixel->unit],
                                                            v->now->signals.S1, v->pixel->local);
}

/* -- what is to be looked up ---------------------------------------------------------------------------------------------- */

static tides_status ask(const td_visit *v, double s, tides_error *error) {
    const double time = v->now->from + s * (v->now->to - v->now->from);
    const td_asked asked = {v->number, v->pixel->local, s};
    return td_solve_ask(v->portion->solve.asks, &v->s->layout.unit[v->pixel->unit], v->pixel->local,
                        td_lesser(time, v->now->to), &asked, error);
}

static void weigh(td_visit *v) {
    const td_pieces *pieces = &v->model.pieces;
    for (int n = 0, k = 0; n < v->changes.count; n++) {
        const td_change *change = &v->changes.change[n];
        k = td_pieces_find_from(pieces, k, change->s);
        const double sign = change->polarity ? change->polarity : 1, per = 1 / (pieces->from[k + 1] - pieces->from[k]);
        const double u = td_pieces_place(pieces, k, change->s), *b = pieces->model[k].control;
        const double first = 3 * (b[1] - b[0]), turned = 3 * (b[3] - b[2]) - first;
        const int is_blurred = td_is_blurred(v, k);
        v->worth[n].slope = sign * per * (is_blurred ? first + u * turned : td_model_slope(&pieces->model[k], u));
        v->worth[n].bend = sign * per * per * (is_blurred ? turned : td_model_curvature(&pieces->model[k], u));
        v->worth[n].error = td_trusted_error(&v->model, k, u);
    }
}

/* Distance of the signal from its levels at s, an end of the step; infinite for a pixel in a hold. *residual is its distance
 * from the reference. Changes at the very start happen after that. */
static double left_at(const td_visit *v, double s, double *residual) {
    const td_pieces *pieces = &v->model.pieces;
    const double at = s > 0 ? s : -1; /* before changes at the start */
    const int n = td_changes_until(v, at);
    const double S = s > 0 ? pieces->model[pieces->count - 1].control[3] : pieces->model[0].control[0];
    *residual = S - td_reference_after(v, n);
    return td_left_at(v, n, at, S);
}

/* 1 where an error decides whether the signal at s is beyond a level. At the step's end, also where it may have reached the
 * level just before. */
static int is_in_doubt(const td_visit *v, double s, double error) {
    double residual;
    return left_at(v, s, &residual) <= error || (s > 0 && v->changes.count > 0 && fabs(residual) <= error);
}

/* Requests look-ups at the ends of the step, where samples are too near a level. Only settled pixels do: a pixel that is run
 * ahead may ask in vain, and samples would then depend on how far it was run. The start of a macro step isn't looked up, but
 * keeps the value with which the macro step before it ended. The record paths of the two macro steps differ there by their
 * errors, and the pixel might be found beyond a level. */
static tides_status ask_ends(const td_visit *v, tides_error *error) {
    const int begins = v->s->refine.step[v->looked->step].from == 0;
    tides_status status = TIDES_OK;
    if (!v->settles) return status;
    if (v->model.start > 0 && !begins && is_in_doubt(v, 0, v->model.start + v->model.floor)) status = ask(v, 0, error);
    if (status == TIDES_OK && v->model.end > 0 && is_in_doubt(v, 1, v->model.end + v->model.floor)) status = ask(v, 1, error);
    return status;
}

/* Requests the place of change n. If looks at such places haven't settled it, the middle of its piece is requested too. Where
 * the value at an end is off, the cubic bends towards that end, and each look there finds the crossing only a little further
 * on: the step's end is requested itself, by settled pixels alone (ask_ends). */
static tides_status ask_change(const td_visit *v, int n, tides_error *error) {
    const td_pieces *pieces = &v->model.pieces;
    const double at = v->changes.change[n].s;
    tides_status status = ask(v, at, error);
    if (status != TIDES_OK || v->looked->looks < FIND_BY_PLACE) return status;
    const int k = td_pieces_find_from(pieces, 0, at);
    const double middle = 0.5 * (pieces->from[k] + pieces->from[k + 1]);
    if (k + 1 == pieces->count && v->model.end > 0 && v->settles) status = ask(v, 1, error);
    return status == TIDES_OK && fabs(middle - at) > TD_SOLVE_APART ? ask(v, middle, error) : status;
}

/* Requests the places of all changes that aren't known. A cubic that overshoots a steep part passes many levels which the
 * signal doesn't reach. Looks at each of them would take all nodes, so that none is left where the signal bends (check_lost,
 * leap 2012: 96 crossings in 0.3 us before a swap of depth). Where they would take more than half of the free nodes, a piece
 * with several is halved instead. */
static tides_status ask_changes(const td_visit *v, tides_error *error) {
    const td_pieces *pieces = &v->model.pieces;
    int unknown = 0, place[TD_CHANGES_MAX], end;
    tides_status status = TIDES_OK;
    for (int n = 0; n < v->changes.count; n++)
        if (!td_is_known(v, n)) place[unknown++] = n;
    const int halves = 2 * unknown > TD_NODES_MAX - v->nodes;
    for (int i = 0, k = 0; i < unknown && status == TIDES_OK; i = end) {
        k = td_pieces_find_from(pieces, k, v->changes.change[place[i]].s);
        for (end = i + 1; halves && end < unknown && v->changes.change[place[end]].s < pieces->from[k + 1];) end++;
        status = end > i + 1 ? ask(v, 0.5 * (pieces->from[k] + pieces->from[k + 1]), error) : ask_change(v, place[i], error);
    }
    return status;
}

/* Requests places within swaps of depth. Points from `before` on are requested already in this round, and show swaps as well.
 * Where no more looks are allowed, swaps count as doubts. */
static tides_status ask_swaps(const td_visit *v, size_t before, int may_ask, int *doubts, tides_error *error) {
    const td_solve_batch *batch = v->portion->solve.asks;
    double places[2 * TD_NODES_MAX];
    int asked = 0;
    const int may = may_ask && v->nodes < TD_NODES_MAX;
    for (size_t k = before; may && k < batch->points && asked < TD_NODES_MAX; k++)
        if (batch->asked[k].s > 0 && batch->asked[k].s < 1) places[asked++] = batch->asked[k].s;
    const int count = td_find_swaps(v, places, asked, asked + TD_NODES_MAX);
    tides_status status = TIDES_OK;
    if (!may) *doubts += count > asked;
    for (int k = asked; may && k < count && status == TIDES_OK; k++) status = ask(v, places[k], error);
    return status;
}

/* The number of levels that approaches leave in doubt if none is looked up. A signal that stays beside a level over several
 * pieces is one doubt. */
static int count_doubts(const td_visit *v, const td_approach *near, int count) {
    int doubts = 0, passed = -1, piece = -1;
    for (int k = 0; k < count; k++) {
        if (near[k].left > near[k].error + v->model.floor) continue;
        const int changes = td_changes_until(v, near[k].s);
        doubts += changes != passed || near[k].piece != piece + 1;
        passed = changes;
        piece = near[k].piece;
    }
    return doubts;
}

/* Requests look-ups at all places that aren't known well enough. `*asked` is 1 if there were any, `*doubts` the number of
 * levels that stay in doubt. */
static tides_status judge(td_visit *v, int *asked, int *doubts, tides_error *error) {
    enum { MOST_APPROACHES = 16 };
    td_approach near[MOST_APPROACHES];
    const td_solve_batch *batch = v->portion->solve.asks;
    const size_t before = batch->points;
    const int may_ask = v->looked->looks < MOST_LOOKS;
    weigh(v);
    const int count = td_find_approaches(v, near, MOST_APPROACHES, doubts);
    tides_status status = may_ask ? ask_ends(v, error) : TIDES_OK;
    if (status == TIDES_OK && may_ask) status = ask_changes(v, error);
    for (int k = 0; k < count && may_ask && status == TIDES_OK; k++)
        if (near[k].doubt > v->model.floor) status = ask(v, near[k].s, error);
    *doubts += count_doubts(v, near, count);
    if (status == TIDES_OK) status = ask_swaps(v, before, may_ask, doubts, error);
    *asked = batch->points > before;
    if (!*asked) return status;
    v->looked->looks++;
    v->looked->state = state_of(v);
    return status;
}

/* -- the pixel ------------------------------------------------------------------------------------------------------------- */

static tides_status advance(td_visit *v, tides_error *error) {
    const td_tile *tile = &v->s->layout.unit[v->pixel->unit];
    const int32_t i = v->pixel->local;
    td_sensor_single single = {.step = &v->now->span,
                               .pixel = v->at,
                               .x = tile->x0 + i % tile->width,
                               .y = tile->y0 + i / tile->width,
                               .ends = &v->looked->ends,
                               .pieces = &v->model.pieces,
                               .changes = &v->changes};
    if (v->now->coverage.begin) single.coverage = (td_coverage){v->now->coverage.begin + i, v->now->coverage.end + i};
    return td_sensor_advance(&v->s->sensor, &single, &v->portion->solve.ahead, error);
}

/* Lateness of an event that waited for its pixel to become visible [steps]; 0 for other events. The comparator takes coverage
 * to be linear in time. The lateness is the possible bow of coverage, from its rates at the ends. */
static double waited(const td_visit *v, const td_change *change) {
    const td_coverage *at = &v->now->coverage, *rate = &v->now->alpha_dot;
    const int32_t i = v->pixel->local;
    if (!at->begin || at->begin[i] >= v->s->sensor.sensor.b_min) return 0;
    const double rise = at->end[i] - at->begin[i], visible = (v->s->sensor.sensor.b_min - at->begin[i]) / rise;
    if (change->s > visible + TD_SOLVE_APART) return 0;
    const double bow =
        td_greater(fabs(v->looked->ends.h * rate->begin[i] - rise), fabs(v->looked->ends.h * rate->end[i] - rise));
    return td_lesser(0.25 * bow / fabs(rise), 1);
}

static int ends_run(const td_visit *v) { return td_refine_ends_run(v->s, &v->s->refine.step[v->looked->step]); }

/* The leak's ramp at s, a part of the model. */
static double ramp_at(const td_visit *v, double s) {
    const td_sensor *sensor = &v->s->sensor;
    const td_step *span = &v->now->span;
    if (!sensor->on) return 0;
    return sensor->leak[v->at] * (td_sensor_time(sensor, span->start_ns, span->start_fraction) + s * span->length_ns);
}

/* Offers an event to the sample of events whose errors are measured at the macro step's end. */
static tides_status sample(const td_visit *v, int n, double late, tides_error *error) {
    const td_tile *tile = &v->s->layout.unit[v->pixel->unit];
    const td_change *change = &v->changes.change[n];
    const double time = v->now->from + change->s * (v->now->to - v->now->from);
    const td_sampled one = {.point = {td_lesser(time, v->now->to), tile->x0 + v->pixel->local % tile->width,
                                      tile->y0 + v->pixel->local / tile->width},
                            .L = td_pieces_value(&v->model.pieces, change->s) - ramp_at(v, change->s),
                            .slope = v->worth[n].slope,
                            .bend = v->worth[n].bend,
                            .floor = v->model.floor,
                            .late = late,
                            .length_s = v->now->span.length_s,
                            .rise = change->polarity * (ramp_at(v, 1) - ramp_at(v, 0)),
                            .polarity = change->polarity};
    return td_solve_sample(&v->portion->solve, &one, error);
}

/* Where a level is in doubt, one event too many or too few takes the pixel's next event with it: the signal comes back to the
 * level, or goes on to another from the wrong reference. */
enum { WITH_NEXT = 2 };

/* The number of events that are in doubt where an error of the model may undo event n: none, itself, or the next one too. */
static int doubts_of(const td_visit *v, int n) {
    int touches;
    const td_worth *at = &v->worth[n];
    const double error = td_timing_together(at->error, v->model.floor);
    const double reach = td_timing_reach(at->slope, at->bend, error, &touches);
    return touches ? WITH_NEXT : ends_run(v) && reach >= 1 - v->changes.change[n].s;
}

/* Notes the events of a settled step: how many are uncertain, and candidates for the sample. Events of noise have times of
 * their own, and aren't noted. */
static tides_status note_events(td_visit *v, int doubts, tides_error *error) {
    td_portion *portion = v->portion;
    tides_status status = TIDES_OK;
    double residual;
    portion->timing.uncertain +=
        (uint64_t)(WITH_NEXT * doubts + (ends_run(v) && left_at(v, 1, &residual) <= v->model.end + v->model.floor));
    for (int k = 0; k < v->changes.count && status == TIDES_OK; k++) {
        if (!v->changes.change[k].fired) continue;
        const double late = waited(v, &v->changes.change[k]);
        portion->timing.uncertain += late > 0 ? 0 : (uint64_t)doubts_of(v, k);
        portion->solve.events += (uint64_t)(v->nodes > 0);
        status = sample(v, k, late, error);
    }
    return status;
}

/* Runs the pixel's next step. `*asked` is 1 if something in it must be looked up. Otherwise the step is settled, if all steps
 * before it are: its events have their final times, and are joined to the portion's. */
static tides_status pass_step(td_visit *v, int *asked, tides_error *error) {
    int doubts = 0;
    *asked = 0;
    if (!may_act(v)) return TIDES_OK;
    take_nodes(v);
    td_work_clear(&v->portion->solve.ahead);
    tides_status status = advance(v, error);
    take_rounding(v);
    if (status == TIDES_OK) status = judge(v, asked, &doubts, error);
    if (status != TIDES_OK || !v->settles || *asked) return status;
    status = note_events(v, doubts, error);
    return status != TIDES_OK ? status : td_work_join(&v->portion->work, &v->portion->solve.ahead, error);
}

tides_status td_solve_run(const tides_simulator *s, td_portion *portion, td_looked *looked, td_solving *pixel,
                          tides_error *error) {
    td_visit v; /* large: only members that are used are set */
    td_kept_pixel settled = {.words = 0};
    int32_t unsettled = pixel->end;
    tides_status status = TIDES_OK;
    v.s = s;
    v.portion = portion;
    v.pixel = pixel;
    v.at = s->layout.first_pixel[pixel->unit] + (size_t)pixel->local;
    for (int32_t k = pixel->next; k < pixel->end && status == TIDES_OK; k++) {
        int asked = 0;
        enter(&v, looked, k);
        v.settles = unsettled == pixel->end;
        status = pass_step(&v, &asked, error);
        if (asked && v.settles) {
            unsettled = k;
            settled = v.state;
        }
        if (asked && s->sensor.on) break; /* later steps depend on when this event was */
    }
    pixel->next = unsettled;
    if (unsettled == pixel->end) return status;
    td_sensor_put_back(&s->sensor, v.at, &settled);
    return status;
}
