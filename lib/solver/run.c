/* The run: render, compare, advance.
 *
 *   sweep      candidate lists of every tile for a batch of steps
 *   render     each tile at each step's end, in one launch: S and S_dot
 *   compare    each tile over each step: events
 *   emit       the batch's events, sorted, as one packet
 *
 * Times count from the run's start. Steps lie on the grid k step_s, joined by the knots of motions. Fixed steps are rendered
 * several to a launch; how many changes the cost, never the events. Under error control each of them is a macro step, which
 * refine.c halves where a tile needs it. */
#include "signal/td_event_sort.h"
#include "td_simulator.h"

#include <stdlib.h>

/* A longer batch has wider swept boxes, so more candidates that miss their tile: above the first share the batch is halved,
 * below the second it is doubled. */
static const double too_many_culled = 0.5, few_culled = 0.3;

/* One rendered tile to its place in a sample. */
static void store_tile(const tides_simulator *s, int t, const double *planes, td_sample *sample) {
    size_t first = s->first_pixel[t], bytes = (size_t)s->tile[t].count * sizeof(double);
    td_unpack_tile(&s->tile[t], planes, sample->plane[TD_KEPT_S] + first, sample->plane[TD_KEPT_S_DOT] + first);
    if (s->planes_kept == TD_KEPT_SIGNAL) return;
    double kept[TD_KEPT_ALL * TD_TILE_PIXELS];
    td_unpack_diagnostics(&s->tile[t], planes, kept);
    for (int k = TD_KEPT_SIGNAL; k < TD_KEPT_ALL; k++) memcpy(sample->plane[k] + first, kept + k * TD_TILE_PIXELS, bytes);
}

void td_list_moving(tides_simulator *s) {
    s->moving_count = 0;
    for (int t = 0; t < s->tiles; t++)
        if (!s->local || !s->started || td_renderer_tile_moves(s->renderer, t)) s->moving[s->moving_count++] = t;
}

tides_status td_turn_knot(tides_simulator *s, tides_error *error) {
    const double time = td_grid_time(s, s->step);
    if (!s->started || s->moving_count == 0 || !td_grid_is_knot(&s->grid, s->step)) return TIDES_OK;
    for (int i = 0; i < s->moving_count; i++) s->requests[i] = (td_request){s->moving[i], 0};
    const td_tile_batch batch = {&time, 1, TD_SIDE_BEGINS, s->requests, s->moving_count, TD_OUT_SIGNAL};
    tides_status status = td_renderer_tiles(s->renderer, s->camera, &batch, s->planes, error);
    for (int i = 0; i < s->moving_count && status == TIDES_OK; i++) {
        int t = s->moving[i];
        double S[TD_TILE_PIXELS]; /* is the same on both sides */
        td_unpack_tile(&s->tile[t], s->planes + (size_t)i * TD_OUT_SIGNAL * TD_TILE_PIXELS, S,
                       s->now.plane[TD_KEPT_S_DOT] + s->first_pixel[t]);
    }
    return status;
}

/* Renders what moves between grid point `from` and the last of [first, first + count), at these, into s->planes. */
static tides_status render_steps(tides_simulator *s, int64_t from, int64_t first, int count, int side, tides_error *error) {
    double times[TD_BATCH_STEPS];
    for (int k = 0; k < count; k++) times[k] = td_grid_time(s, first + k);
    tides_status status = td_renderer_sweep(s->renderer, s->camera, td_grid_time(s, from), times[count - 1], error);
    if (status != TIDES_OK) return status;
    td_list_moving(s);
    status = td_turn_knot(s, error);
    if (status != TIDES_OK) return status;
    int requests = count * s->moving_count;
    for (int i = 0; i < requests; i++) {
        s->requests[i].tile = s->moving[i % s->moving_count];
        s->requests[i].slot = i / s->moving_count;
    }
    if (requests == 0) return TIDES_OK;
    const td_tile_batch batch = {times, count, side, s->requests, requests, td_fixed_outputs(s)};
    return td_renderer_tiles(s->renderer, s->camera, &batch, s->planes, error);
}

/* Step k of the batch into a sample; tiles at rest stay as they are now. */
static void store_step(tides_simulator *s, int k, td_sample *sample) {
    size_t tile_reals = (size_t)td_fixed_outputs(s) * TD_TILE_PIXELS, bytes = s->first_pixel[s->tiles] * sizeof(double);
    if (s->moving_count < s->tiles)
        for (int p = 0; p < s->planes_kept; p++) memcpy(sample->plane[p], s->now.plane[p], bytes);
    for (int i = 0; i < s->moving_count; i++)
        store_tile(s, s->moving[i], s->planes + ((size_t)k * s->moving_count + i) * tile_reals, sample);
}

/* The first sample, of all tiles: every pixel's reference is the signal there. */
static tides_status begin(tides_simulator *s, tides_error *error) {
    tides_status status = render_steps(s, 0, 0, 1, TD_SIDE_BEGINS, error);
    if (status != TIDES_OK) return status;
    store_step(s, 0, &s->now);
    if (s->surround.surround.on) td_surround_steps_begin(s);
    const double *S = s->surround.surround.on ? s->surround.S : s->now.plane[TD_KEPT_S];
    td_sensor_begin(&s->sensor, S);
    s->started = 1;
    return TIDES_OK;
}

tides_status td_step_of_run(const tides_simulator *s, double start, double stop, td_step *step, tides_error *error) {
    tides_status status = td_step_between(start, stop, step, error);
    if (status != TIDES_OK) return status;
    step->start_ns += s->epoch_ns;
    step->stop_ns += s->epoch_ns;
    if (stop < s->length && step->stop_ns > step->start_ns) step->stop_ns--;
    return TIDES_OK;
}

/* The comparator over one step of every tile that moves, from now to next. */
static tides_status compare_tiles(tides_simulator *s, tides_error *error) {
    td_step step;
    double start = td_grid_time(s, s->step), stop = td_grid_time(s, s->step + 1);
    if (s->slope == TIDES_SLOPE_DIFFERENCE) td_difference_slopes(s, stop - start);
    if (s->surround.surround.on) return td_surround_compare(s, start, stop, error);
    tides_status status = td_step_of_run(s, start, stop, &step, error);
    for (int i = 0; i < s->moving_count && status == TIDES_OK; i++) {
        int t = s->moving[i];
        const double *begin_planes[TD_KEPT_ALL], *end_planes[TD_KEPT_ALL];
        for (int p = 0; p < s->planes_kept; p++) {
            begin_planes[p] = s->now.plane[p] + s->first_pixel[t];
            end_planes[p] = s->next.plane[p] + s->first_pixel[t];
        }
        status = td_compare_tile(s, t, &step, begin_planes, end_planes, error);
    }
    return status == TIDES_OK ? td_compare_still(s, &step, error) : status;
}

/* Afterwards the step's end is now. */
static tides_status compare_step(tides_simulator *s, tides_error *error) {
    tides_status status = compare_tiles(s, error);
    if (status != TIDES_OK) return status;
    td_turn_samples(s);
    s->step++;
    if (s->scan.arbiter) status = td_scan_step(s, error);
    s->stats.steps += (uint64_t)s->moving_count;
    s->stats.tile_steps_still += (uint64_t)(s->tiles - s->moving_count);
    return status;
}

/* Sorts the packet and gives it away. */
static tides_status emit(tides_simulator *s, tides_event_sink sink, void *user, tides_error *error) {
    tides_status status = td_reserve((void **)&s->scratch, &s->scratch_capacity, s->events.count, sizeof *s->scratch, error);
    if (status != TIDES_OK) return status;
    double begun = td_now();
    td_event_sort(s->events.events, s->scratch, s->events.count);
    s->stats.time_compare_s += td_now() - begun;
    begun = td_now();
    int left = s->scan.arbiter != NULL; /* or from the pixels */
    int stopped = sink && sink(user, left ? s->scan.events : s->events.events, left ? s->scan.count : s->events.count);
    s->stats.time_sink_s += td_now() - begun;
    s->events.count = s->scan.count = 0;
    return stopped ? td_fail(error, TIDES_CANCELLED, "stopped by the event sink at %.9g s", td_time_reached(s)) : TIDES_OK;
}

/* Longer batches while few candidates miss their tiles, shorter ones when many do. */
static void adapt_batch(tides_simulator *s, const tides_render_stats *before) {
    tides_render_stats after;
    tides_renderer_stats(s->renderer, &after);
    double projected = (double)(after.gaussians_projected - before->gaussians_projected);
    double culled = (double)(after.gaussians_culled - before->gaussians_culled);
    if (culled > too_many_culled * projected && s->batch > 1)
        s->batch /= 2;
    else if (culled < few_culled * projected || projected == 0)
        s->batch = 2 * s->batch < s->batch_limit ? 2 * s->batch : s->batch_limit;
}

/* As many of the next `count` steps as there are until a knot: only a batch may begin at one. */
static int steps_to_knot(const tides_simulator *s, int count) {
    for (int k = 1; k < count; k++)
        if (td_grid_is_knot(&s->grid, s->step + k)) return k;
    return count;
}

/* One batch of at most `count` steps. */
static tides_status advance(tides_simulator *s, int64_t count, tides_event_sink sink, void *user, tides_error *error) {
    tides_render_stats before;
    tides_renderer_stats(s->renderer, &before);
    int steps = steps_to_knot(s, count < s->batch ? (int)count : s->batch);
    tides_status status = render_steps(s, s->step, s->step + 1, steps, TD_SIDE_ENDS, error);
    if (status != TIDES_OK) return status;
    double begun = td_now();
    for (int k = 0; k < steps && status == TIDES_OK; k++) {
        store_step(s, k, &s->next);
        status = compare_step(s, error);
    }
    s->stats.time_compare_s += td_now() - begun;
    s->broken = status != TIDES_OK;
    adapt_batch(s, &before);
    tides_status emitted = emit(s, sink, user, status == TIDES_OK ? error : NULL);
    return status == TIDES_OK ? emitted : status;
}

/* One macro step, refined tile by tile. */
static tides_status advance_refined(tides_simulator *s, tides_event_sink sink, void *user, tides_error *error) {
    double start = td_grid_time(s, s->step), stop = td_grid_time(s, s->step + 1);
    tides_status status = td_refine_macro_step(s, start, stop, error);
    if (status != TIDES_OK) return status;
    double begun = td_now();
    td_step whole;
    status = td_step_of_run(s, start, stop, &whole, error);
    if (status == TIDES_OK) status = td_compare_still(s, &whole, error);
    s->stats.tile_steps_still += (uint64_t)(s->tiles - s->moving_count);
    s->stats.time_compare_s += td_now() - begun;
    if (status != TIDES_OK) {
        s->broken = 1;
        return status;
    }
    s->step++;
    if (s->scan.arbiter) status = td_scan_step(s, error);
    s->broken = status != TIDES_OK;
    return status == TIDES_OK ? emit(s, sink, user, error) : status;
}

tides_status tides_simulator_run(tides_simulator *simulator, double until, tides_event_sink sink, void *sink_user,
                                 tides_progress progress, void *user, tides_error *error) {
    if (!simulator) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_simulator_run: simulator must be given");
    if (simulator->broken)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "tides_simulator_run: an earlier error left a step half done; make a new simulator");
    if (!(until >= simulator->epoch))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_simulator_run: until %.17g s is before the start, %.17g s", until,
                       simulator->epoch);
    double begun = td_now();
    tides_status status = TIDES_OK;
    int64_t last = until - simulator->epoch >= simulator->length
                       ? simulator->steps
                       : td_grid_last_until(&simulator->grid, simulator->epoch, until);
    if (!simulator->started) status = begin(simulator, error);
    while (status == TIDES_OK && simulator->step < last) {
        status = simulator->mode == TIDES_STEPPING_FIXED ? advance(simulator, last - simulator->step, sink, sink_user, error)
                                                         : advance_refined(simulator, sink, sink_user, error);
        if (status == TIDES_OK && progress && progress(user, (double)simulator->step / (double)simulator->steps, "simulating"))
            status = td_fail(error, TIDES_CANCELLED, "stopped on request at %.9g s", td_time_reached(simulator));
    }
    simulator->stats.run_time_s += td_now() - begun;
    return status;
}
