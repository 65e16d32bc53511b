/* The statistics of a run: the one table of them, and how they are put together when somebody asks.
 *
 * Counts are made where things happen (comparator, sensor, refinement, renderer); here they are collected, joined with those of
 * the parts of the run before a restore, and what follows from them is worked out. The tool's --stats, checkpoints and bindings
 * walk the table: a new statistic is a field of tides_stats, a row here, and the line of collect() that fetches it. */
#include "solver/td_simulator.h"

#define ROW(name, unit, type, joined, member) \
    { name, unit, TIDES_STAT_##type, TIDES_JOIN_##joined, offsetof(tides_stats, member) }
#define COUNT(name, joined, member) ROW(name, "", COUNT, joined, member)
#define REAL(name, unit, joined, member) ROW(name, unit, REAL, joined, member)

/* In the order of --stats. */
static const tides_stat table[] = {
    COUNT("events", DERIVED, events),
    COUNT("events_on", SUM, events_on),
    COUNT("events_off", SUM, events_off),
    COUNT("events_truncated", SUM, events_truncated),
    COUNT("events_uncertain", SUM, events_uncertain),
    COUNT("events_caught_up", SUM, events_caught_up),
    COUNT("solve", DERIVED, solve),
    COUNT("unsolved", DERIVED, unsolved),
    COUNT("unit", DERIVED, unit),
    REAL("tolerance", "thresholds", DERIVED, tolerance),
    COUNT("events_solved", SUM, events_solved),
    COUNT("points_looked_up", SUM, points_looked_up),
    COUNT("events_suppressed", SUM, events_suppressed),
    COUNT("events_refractory", SUM, events_refractory),
    COUNT("events_signal", SUM, events_by_cause[TIDES_CAUSE_SIGNAL]),
    COUNT("events_leak", SUM, events_by_cause[TIDES_CAUSE_LEAK]),
    COUNT("events_shot", SUM, events_by_cause[TIDES_CAUSE_SHOT]),
    COUNT("events_hot", SUM, events_by_cause[TIDES_CAUSE_HOT]),
    COUNT("events_written", DERIVED, events_written),
    COUNT("events_dropped", DERIVED, events_dropped),
    COUNT("events_overflowed", DERIVED, events_overflowed),
    COUNT("events_delayed", DERIVED, events_delayed),
    REAL("worst_delay_s", "s", DERIVED, worst_delay_s),
    REAL("renders_full_frame_equivalent", "full frames", DERIVED, renders_full_frame_equivalent),
    ROW("tiles", "", WHOLE, DERIVED, render.tiles),
    COUNT("tile_jobs", SUM, render.tile_jobs),
    COUNT("blocks", SUM, render.blocks),
    COUNT("tile_jobs_skipped", SUM, render.tile_jobs_skipped),
    COUNT("tile_steps_still", SUM, tile_steps_still),
    COUNT("gaussians_still", SUM, render.gaussians_still),
    COUNT("gaussians_moved", SUM, render.gaussians_moved),
    COUNT("gaussians_interpolated", SUM, render.gaussians_interpolated),
    COUNT("gaussians_total", DERIVED, render.gaussians_total),
    COUNT("gaussians_dropped", DERIVED, render.gaussians_dropped),
    COUNT("gaussians_projected", SUM, render.gaussians_projected),
    COUNT("gaussians_shared", SUM, render.gaussians_shared),
    COUNT("gaussians_culled", SUM, render.gaussians_culled),
    COUNT("sweeps", SUM, render.sweeps),
    COUNT("pairs_evaluated", SUM, render.pairs_evaluated),
    COUNT("lists_kept", SUM, render.lists_kept),
    COUNT("pixels_nonfinite", SUM, render.pixels_nonfinite),
    COUNT("steps", SUM, steps),
    COUNT("steps_rejected", SUM, steps_rejected),
    COUNT("steps_at_minimum", SUM, steps_at_minimum),
    COUNT("steps_at_rounding", SUM, steps_at_rounding),
    COUNT("steps_probed", SUM, steps_probed),
    REAL("worst_error", "thresholds", LARGEST, worst_error),
    REAL("worst_deviation", "thresholds", LARGEST, worst_deviation),
    REAL("error_p50_s", "s", DERIVED, error_p50_s),
    REAL("error_p95_s", "s", DERIVED, error_p95_s),
    REAL("error_p99_s", "s", DERIVED, error_p99_s),
    REAL("worst_residual", "thresholds", DERIVED, worst_residual),
    REAL("simulated_s", "s", DERIVED, simulated_s),
    REAL("run_time_s", "s", SUM, run_time_s),
    REAL("real_time_factor", "", DERIVED, real_time_factor),
    COUNT("peak_memory_bytes", DERIVED, peak_memory_bytes),
    REAL("time_s.build", "s", SUM, render.time_build_s),
    REAL("time_s.motion", "s", SUM, render.time_motion_s),
    REAL("time_s.sweep", "s", SUM, render.time_sweep_s),
    REAL("time_s.project", "s", SUM, render.time_project_s),
    REAL("time_s.sort", "s", SUM, render.time_sort_s),
    REAL("time_s.composite", "s", SUM, render.time_composite_s),
    REAL("time_s.transfer", "s", SUM, render.time_transfer_s),
    REAL("time_s.compare", "s", SUM, time_compare_s),
    REAL("time_s.look_up", "s", SUM, time_look_up_s),
    REAL("time_s.sink", "s", SUM, time_sink_s),
    REAL("time_s.other", "s", DERIVED, time_other_s),
};

const tides_stat *tides_stats_table(size_t *count) {
    if (count) *count = sizeof table / sizeof table[0];
    return table;
}

/* -- one value ------------------------------------------------------------------------------------------------------------- */

double td_stat_value(const tides_stats *stats, const tides_stat *row) {
    const char *at = (const char *)stats + row->offset;
    double real;
    uint64_t count;
    int32_t whole;
    memcpy(&whole, at, sizeof whole);
    if (row->type == TIDES_STAT_WHOLE) return whole;
    memcpy(&real, at, sizeof real);
    memcpy(&count, at, sizeof count);
    return row->type == TIDES_STAT_REAL ? real : (double)count;
}

void td_stat_set(tides_stats *stats, const tides_stat *row, double value) {
    char *at = (char *)stats + row->offset;
    const uint64_t count = row->type == TIDES_STAT_COUNT ? (uint64_t)value : 0;
    if (row->type == TIDES_STAT_REAL) memcpy(at, &value, sizeof value);
    if (row->type == TIDES_STAT_COUNT) memcpy(at, &count, sizeof count);
}

/* -- of a run -------------------------------------------------------------------------------------------------------------- */

/* What this simulator has counted. */
static void collect(const tides_simulator *s, tides_stats *stats) {
    *stats = s->stats;
    tides_renderer_stats(s->renderer, &stats->render);
    stats->render.pixels_nonfinite += s->work.counts.nonfinite;
    stats->events_on = s->work.counts.events_on;
    stats->events_off = s->work.counts.events_off;
    stats->events_uncertain = s->timing.uncertain;
    stats->solve = s->solve.on ? TIDES_SOLVE_DOUBLE : TIDES_SOLVE_OFF;
    stats->unsolved = (uint64_t)s->solve.unsolved;
    stats->unit = (uint64_t)s->given.unit;
    stats->tolerance = s->given.tolerance;
    stats->events_solved = s->solve.events;
    stats->points_looked_up = s->solve.lookups;
    stats->events_truncated = s->work.counts.truncated;
    stats->events_caught_up = s->work.counts.caught_up;
    for (int c = 0; c < TIDES_CAUSES; c++) stats->events_by_cause[c] = s->work.counts.cause[c];
    stats->events_suppressed = s->work.counts.suppressed;
    stats->events_refractory = s->work.counts.refractory;
}

/* And what was counted before a restore. */
static void join(tides_stats *stats, const tides_stats *before) {
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        const double own = td_stat_value(stats, &table[i]), other = td_stat_value(before, &table[i]);
        if (table[i].joined == TIDES_JOIN_SUM) td_stat_set(stats, &table[i], own + other);
        if (table[i].joined == TIDES_JOIN_LARGEST) td_stat_set(stats, &table[i], own > other ? own : other);
    }
}

/* Stages that are timed, and `other`: the rest of the run time, so that the parts sum to the whole. */
static void derive_times(const tides_simulator *s, tides_stats *stats) {
    const tides_render_stats *render = &stats->render;
    const double known = render->time_build_s + render->time_motion_s + render->time_sweep_s + render->time_project_s +
                         render->time_sort_s + render->time_composite_s + render->time_transfer_s + stats->time_compare_s +
                         stats->time_sink_s + stats->time_look_up_s;
    stats->time_other_s = stats->run_time_s - known;
    stats->simulated_s = s->started ? td_grid_time(s, s->step) : 0;
    stats->real_time_factor = stats->run_time_s > 0 ? stats->simulated_s / stats->run_time_s : 0;
}

/* Without a readout all events are given to the sink. Its own counts go through a checkpoint with its queues. */
static void derive_readout(const tides_simulator *s, tides_stats *stats) {
    tides_readout_stats readout;
    stats->events_written = stats->events;
    if (!s->readout.arbiter) return;
    tides_arbiter_stats(s->readout.arbiter, &readout);
    stats->events_written = readout.out - td_release_held(&s->readout.arbiter->out);
    stats->events_dropped = readout.dropped + readout.overflowed;
    stats->events_overflowed = readout.overflowed;
    stats->events_delayed = readout.delayed;
    stats->worst_delay_s = readout.worst_delay_s;
}

void tides_simulator_stats(const tides_simulator *simulator, tides_stats *stats) {
    collect(simulator, stats);
    join(stats, &simulator->before);
    stats->events = stats->events_on + stats->events_off;
    stats->renders_full_frame_equivalent = (double)stats->render.blocks / TD_TILE_BLOCKS / stats->render.tiles;
    derive_times(simulator, stats);
    derive_readout(simulator, stats);
    stats->error_p50_s = td_timing_percentile(&simulator->timing, 0.50);
    stats->error_p95_s = td_timing_percentile(&simulator->timing, 0.95);
    stats->error_p99_s = td_timing_percentile(&simulator->timing, 0.99);
    stats->peak_memory_bytes = td_peak_memory();
    if (simulator->started) stats->worst_residual = td_worst_residual(simulator);
}
