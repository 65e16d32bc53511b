/* The run as a pipeline. Each pass, over one step of the grid (or several, where steps are fixed):
 *
 *   sweep      which units can change, and what tiles may see                 td_sweep (sweep.c; renderer)
 *   render     units at times: S and S_dot                                   td_fixed_render; td_refine_begin, td_refine_level
 *   estimate   how far each step may be off                                  td_control_judge, _steps (control.c, in steps)
 *   refine     those that are too coarse are cut in two, and rendered         td_window_take, td_refine_level (refine.c)
 *   look up    by default: events on the image itself, pixel by pixel         td_settle -> td_solve_steps (solve.c, in lookup)
 *   compare    else each unit over each step: events of the model             td_settle -> td_compare_unit (unit_step.c)
 *   at rest    units in which nothing moves, where they may fire              td_solve_still, td_compare_still
 *   read out   the step's events through the arbiter, where there is one      td_readout_step (readout.c)
 *   emit       the events, sorted, through filters to the sink as a packet   emit
 *
 * In a default run an event gets its time three jumps from refine_group: td_settle (settle.c) hands accepted steps to
 * td_solve_steps (solve.c, in lookup), which runs each pixel that may do something through td_solve_run (solve_run.c). There
 * the comparator runs on a model whose nodes are looked up. Pixels whose values are back run again (td_solve_turn), until no
 * time changes; pass_step then adds the step's events to the run's.
 *
 * Fixed steps skip estimates and refinement. Times count from the run's start; steps lie on the grid k step_s, joined by the
 * knots of motions (grid.c). Stages have files of their own; this one has their order, and the handling of failures. */
#include "camera/td_trajectory.h"
#include "signal/td_event_sort.h"
#include "solver/td_reached.h"
#include "solver/td_simulator.h"

#include <stdlib.h>

/* -- one step of the grid -------------------------------------------------------------------------------------------------- */

/* The comparator over a step of some of the units that move. */
static tides_status compare_some(const tides_simulator *s, td_portion *portion, int first, int end, const void *step,
                                 tides_error *error) {
    tides_status status = TIDES_OK;
    for (int i = first; i < end && status == TIDES_OK; i++) {
        int t = s->moving.list[i];
        const double *begin_planes[TD_PLANES_ALL], *end_planes[TD_PLANES_ALL];
        for (int p = 0; p < s->given.sample_planes; p++) {
            begin_planes[p] = s->now.plane[p] + s->layout.first_pixel[t];
            end_planes[p] = s->next.plane[p] + s->layout.first_pixel[t];
        }
        const td_compared unit = {t, step, begin_planes, end_planes, NULL};
        status = td_compare_unit(s, portion, &unit, error);
    }
    return status;
}

/* The comparator over one step of every unit that moves, from s->now to s->next. */
static tides_status compare_units(tides_simulator *s, tides_error *error) {
    td_step step;
    double start = td_grid_time(s, s->step), stop = td_grid_time(s, s->step + 1);
    if (s->given.slope == TIDES_SLOPE_DIFFERENCE) td_difference_slopes(s, stop - start);
    if (s->given.coupled) return td_surround_compare(s, start, stop, NULL, error);
    tides_status status = td_grid_step(&s->grid, start, stop, &step, error);
    if (status == TIDES_OK) status = td_share_out(s, s->moving.count, TD_FEWEST_UNITS, compare_some, &step, error);
    return status == TIDES_OK ? td_compare_still(s, &step, error) : status;
}

/* Ends a compared step: the simulator has reached its end, and its events go through the readout. */
static tides_status reach(tides_simulator *s, tides_error *error) {
    s->step++;
    s->totals.here.tile_steps_still += (uint64_t)(s->layout.image_tiles - s->moving.tiles);
    return s->readout.arbiter ? td_readout_step(s, error) : TIDES_OK;
}

/* Sorts the events from number `first` on. */
static tides_status sort_from(tides_simulator *s, size_t first, tides_error *error) {
    const size_t count = s->done.work.events.count - first;
    if (count == 0) return TIDES_OK; /* there may be no list yet */
    tides_status status =
        td_renew((void **)&s->packet.scratch, &s->packet.scratch_capacity, count, sizeof *s->packet.scratch, error);
    if (status == TIDES_OK) td_event_sort(s->done.work.events.events + first, s->packet.scratch, count);
    return status;
}

/* Gives the packet away. */
static tides_status emit(tides_simulator *s, tides_event_sink sink, void *user, tides_error *error) {
    const double begun = td_now();
    const int left = s->readout.arbiter != NULL; /* 1: from the readout, 0: from the pixels */
    tides_event *events = left ? s->readout.events : s->done.work.events.events;
    size_t count = left ? s->readout.count : s->done.work.events.count;
    if (s->filters.filter) {
        tides_status status =
            tides_filter_apply(s->filters.filter, events, left ? s->readout.fired : NULL, count, &count, error);
        if (status != TIDES_OK) return status;
    }
    if (count > 0) s->packet.last = events[count - 1];
    const int stopped = sink && sink(user, events, count);
    s->totals.here.time_sink_s += td_now() - begun;
    s->done.work.events.count = s->readout.count = 0;
    return stopped ? td_fail(error, TIDES_CANCELLED, "stopped by the event sink at %.9g s", td_time_reached(s)) : TIDES_OK;
}

/* -- the two kinds of steps ------------------------------------------------------------------------------------------------ */

/* Compares one of the rendered steps, and sorts its events while they are in the cache: no two steps share a nanosecond. That
 * takes a fifth of the time of sorting all together. */
static tides_status compare_fixed(tides_simulator *s, int k, tides_error *error) {
    const double begun = td_now();
    const size_t first = s->done.work.events.count;
    tides_status status = td_fixed_take(s, k, &s->next, error);
    if (status == TIDES_OK) status = compare_units(s, error);
    if (status == TIDES_OK) status = sort_from(s, first, error);
    if (status == TIDES_OK) {
        td_turn_samples(s);
        s->done.steps.steps += (uint64_t)s->moving.count;
        status = reach(s, error);
    }
    s->totals.here.time_compare_s += td_now() - begun;
    return status;
}

/* A packet is handed over once it has so many events. The sink then reads events that are still in the cache, and memory
 * doesn't grow with the events of a launch. */
enum { PACKET_FULL = 1 << 14 };

/* Fixed steps: at most `most`, rendered in one launch and compared one after the other. */
static tides_status advance_fixed(tides_simulator *s, int64_t most, tides_event_sink sink, void *user, tides_error *error) {
    tides_render_stats before;
    tides_renderer_stats(s->renderer, &before);
    const int steps = td_fixed_batch(s, most);
    const td_render_counts counted = td_renderer_counts(s->renderer);
    tides_status status = td_sweep(s, td_grid_time(s, s->step), td_grid_time(s, s->step + steps), error);
    if (status == TIDES_OK) status = td_fixed_render(s, steps, error);
    if (status == TIDES_CANCELLED) td_renderer_put_counts(s->renderer, &counted);
    if (status != TIDES_OK) return status; /* the pixels haven't changed */
    tides_status emitted = TIDES_OK;
    for (int k = 0; k < steps && status == TIDES_OK && emitted == TIDES_OK; k++) {
        status = compare_fixed(s, k, error);
        if (status == TIDES_OK && s->done.work.events.count >= PACKET_FULL) emitted = emit(s, sink, user, error);
    }
    s->broken = status != TIDES_OK;
    td_fixed_adapt(s, &before);
    if (emitted == TIDES_OK) emitted = emit(s, sink, user, status == TIDES_OK ? error : NULL); /* the first error is reported */
    return status == TIDES_OK ? emitted : status;
}

/* Refines the steps of the units refine.unit until none asks for a shorter one. Then compares all that weren't compared on the
 * way. */
static tides_status refine_group(tides_simulator *s, double start, double stop, tides_error *error) {
    tides_status status = td_refine_begin(s, start, stop, error);
    while (status == TIDES_OK) {
        status = td_control_steps(s, error);
        if (status != TIDES_OK || s->refine.open_count == 0) break;
        const int is_short = td_window_is_short(s);
        if (is_short) status = td_settle(s, start, stop, 1, error);
        if (status == TIDES_OK) status = td_window_take(s, is_short, error);
        if (status == TIDES_OK) status = td_refine_level(s, start, stop, error);
    }
    return status == TIDES_OK ? td_settle(s, start, stop, 0, error) : status;
}

/* Refines all units that move in a macro step, as many at a time as memory allows. A failure before the first comparison leaves
 * the pixels as they were. */
static tides_status refine(tides_simulator *s, double start, double stop, tides_error *error) {
    const int count = s->moving.count, most = td_window_units(s);
    tides_status status = TIDES_OK;
    for (int first = 0; first < count && status == TIDES_OK; first += most) {
        s->refine.unit = s->moving.list + first;
        s->refine.units = count - first < most ? count - first : most;
        status = refine_group(s, start, stop, error);
        s->broken |= status != TIDES_OK && (first > 0 || s->refine.early);
    }
    return status;
}

/* Fires events in units where nothing moves, over the macro step as a whole. */
static tides_status compare_still(tides_simulator *s, double start, double stop, tides_error *error) {
    td_step whole;
    double begun = td_now();
    tides_status status = td_grid_step(&s->grid, start, stop, &whole, error);
    if (status == TIDES_OK) status = td_solve_still(s, &whole, start, error);
    if (status == TIDES_OK) status = td_compare_still(s, &whole, error);
    s->totals.here.time_compare_s += td_now() - begun;
    return status;
}

/* Measures the errors of the events' times. The pixels have reached the step's end. */
static tides_status measure(tides_simulator *s, tides_error *error) {
    const double begun = td_now();
    const tides_status status = td_solve_measure(s, error);
    s->totals.here.time_compare_s += td_now() - begun; /* without the time of look-ups */
    s->broken |= status != TIDES_OK;
    return status;
}

/* The comparator over one macro step, refined unit by unit. */
static tides_status compare_refined(tides_simulator *s, tides_error *error) {
    const double start = td_grid_time(s, s->step), stop = td_grid_time(s, s->step + 1);
    s->done.solve.sampled_count = s->done.solve.fired = 0; /* of the step before, or of a stopped one */
    s->done.solve.is_cut = 0;
    tides_status status = td_solve_keep_start(s, error);
    if (status == TIDES_OK) status = td_sweep(s, start, stop, error);
    if (status == TIDES_OK && s->moving.count > 0) status = td_renderer_find_swaps(s->renderer, s->camera, error);
    if (status == TIDES_OK && s->moving.count > 0) status = refine(s, start, stop, error);
    if (status == TIDES_OK) status = measure(s, error);
    if (status != TIDES_OK) return status; /* s->broken says whether the pixels agree on the time */
    if (s->moving.count > 0) s->done.timing.uncertain += (uint64_t)td_renderer_swaps_cut(s->renderer);
    status = compare_still(s, start, stop, error);
    s->broken = status != TIDES_OK;
    return status;
}

/* Advances by one macro step. If it is stopped, the state stays as before it. */
static tides_status advance_refined(tides_simulator *s, tides_event_sink sink, void *user, tides_error *error) {
    tides_status status = td_undo_keep(s, error);
    if (status != TIDES_OK) return status;
    status = compare_refined(s, error);
    td_undo_stopped(s, status);
    if (status != TIDES_OK) return status;
    status = reach(s, error);
    const double begun = td_now();
    if (status == TIDES_OK) status = sort_from(s, 0, error);
    s->totals.here.time_compare_s += td_now() - begun;
    s->broken = status != TIDES_OK;
    return status == TIDES_OK ? emit(s, sink, user, error) : status;
}

/* -- the run --------------------------------------------------------------------------------------------------------------- */

/* Advances to grid point `last`. */
static tides_status advance_to(tides_simulator *s, int64_t last, tides_event_sink sink, void *sink_user, tides_error *error) {
    const td_run_progress *progress = &s->progress;
    tides_status status = TIDES_OK;
    while (status == TIDES_OK && s->step < last) {
        td_progress_step(s);
        status = s->given.mode == TIDES_STEPPING_FIXED ? advance_fixed(s, last - s->step, sink, sink_user, error)
                                                       : advance_refined(s, sink, sink_user, error);
        if (!progress->call || (status != TIDES_OK && !progress->stopped)) continue;
        if (progress->stopped || progress->call(progress->user, (double)s->step / (double)s->grid.steps, "simulating"))
            status = td_fail(error, TIDES_CANCELLED, "stopped on request at %.9g s", td_time_reached(s));
    }
    return status;
}

static tides_status fail_untold(const tides_simulator *s, const char *path, double until, tides_error *error) {
    return td_fail(error, TIDES_OUT_OF_RANGE, "%s is open, and its poses end before %.15g s: append poses first", path,
                   s->epoch + until);
}

/* Fails where an open path hasn't been extended as far as grid point `last`. */
static tides_status check_told(const tides_simulator *s, int64_t last, tides_error *error) {
    const double until = td_grid_time(s, last);
    if (!td_trajectory_reaches(s->camera, s->epoch, until)) return fail_untold(s, "the camera's path", until, error);
    for (int32_t i = 0; i < tides_scene_objects(s->scene); i++) {
        tides_object object;
        char named[128];
        tides_status status = tides_scene_object(s->scene, i, &object, error);
        if (status != TIDES_OK) return status;
        if (td_trajectory_reaches(object.trajectory, s->epoch, until)) continue;
        snprintf(named, sizeof named, "the path of object %d ('%.80s')", (int)i, object.name);
        return fail_untold(s, named, until, error);
    }
    return TIDES_OK;
}

/* The last grid point of a run that is asked for up to `until`. */
static int64_t last_point(const tides_simulator *s, double until) {
    return until - s->epoch >= s->length ? s->grid.steps : td_grid_last_until(&s->grid, s->epoch, until);
}

double td_simulator_extends_from(const tides_simulator *s, double until) {
    const int64_t last = last_point(s, until);
    return s->epoch + td_grid_time(s, last < s->grid.steps ? last : s->grid.steps - 1);
}

tides_status tides_simulator_run(tides_simulator *simulator, double until, tides_event_sink sink, void *sink_user,
                                 tides_progress progress, void *user, tides_error *error) {
    if (!simulator) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_simulator_run: simulator must be given");
    if (simulator->broken)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "tides_simulator_run: an earlier error left a step half done; make a new simulator");
    if (!td_grid_reaches(&simulator->grid, 0, simulator->epoch, until))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_simulator_run: until %s s is before the start, %s s", TD_SHORT(until),
                       TD_SHORT(simulator->epoch));
    const double begun = td_now(), alone = td_alone_time(simulator);
    tides_status status = TIDES_OK;
    const int64_t last = last_point(simulator, until);
    if (last > simulator->step) status = check_told(simulator, last, error);
    /* An open path with one pose has no rates yet, so that the first sample waits for the second pose. */
    const int32_t begins = !simulator->started && (last > 0 || check_told(simulator, 1, NULL) == TIDES_OK);
    if (begins && status == TIDES_OK) status = td_begin(simulator, error);
    td_progress_begin(simulator, progress, user);
    if (status == TIDES_OK) status = advance_to(simulator, last, sink, sink_user, error);
    td_progress_end(simulator);
    simulator->totals.here.run_time_s += td_now() - begun;
    simulator->totals.here.time_alone_s += td_alone_time(simulator) - alone;
    return status;
}

tides_status td_simulator_finish(tides_simulator *s, tides_event_sink sink, void *user, tides_error *error) {
    if (!s->readout.arbiter || s->step == s->grid.steps) return TIDES_OK; /* the readout holds nothing */
    const tides_status status = td_readout_finish(s, error);
    return status == TIDES_OK ? emit(s, sink, user, error) : status;
}
