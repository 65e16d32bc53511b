/* The statistics of a run: the table that lists them all, and tides_simulator_stats, which fills in their values.
 *
 * Comparator, sensor, refinement of steps, and renderer count their own work. tides_simulator_stats collects these counts. It
 * joins them with the counts from before the run was restored from a checkpoint. From the result it derives the other values.
 *
 * The tool's --stats, checkpoints, language bindings and the undoing of a step all walk the table. So a new statistic needs
 * a field of tides_stats and a row of the table. If the simulator doesn't count it in that field of `totals.here`, the
 * row says where the counter is. */
#include "solver/td_simulator.h"

#include <pthread.h>

/* A row of the table: its public part, and the place of its counter, which is a uint64_t or a double. */
typedef struct counted {
    tides_stat stat;
    size_t source; /* offset of the counter in tides_simulator; IN_STATS: in `totals.here` or the renderer's, or derived */
} counted;
#define IN_STATS ((size_t)-1)

#define ROW(name, unit, type, joined, member, source) \
    { {name, unit, TIDES_STAT_##type, TIDES_JOIN_##joined, offsetof(tides_stats, member)}, source }
#define COUNT(name, joined, member) ROW(name, "", COUNT, joined, member, IN_STATS)
#define COUNTED(name, member, source) ROW(name, "", COUNT, SUM, member, offsetof(tides_simulator, source))
#define WORST(name, member, source) ROW(name, "thresholds", REAL, LARGEST, member, offsetof(tides_simulator, source))
#define REAL(name, unit, joined, member) ROW(name, unit, REAL, joined, member, IN_STATS)

/* In the order of --stats. In a name with a point, the part before the point names the group. */
static const counted table[] = {
    COUNT("events", DERIVED, events),
    COUNTED("events_on", events_on, done.work.counts.events_on),
    COUNTED("events_off", events_off, done.work.counts.events_off),
    COUNTED("events_truncated", events_truncated, done.work.counts.truncated),
    COUNTED("events_uncertain", events_uncertain, done.timing.uncertain),
    COUNTED("events_caught_up", events_caught_up, done.work.counts.caught_up),
    COUNT("settings.solve", DERIVED, solve),
    COUNT("settings.unsolved", DERIVED, unsolved),
    COUNT("settings.unit", DERIVED, unit),
    REAL("settings.tolerance", "thresholds", DERIVED, tolerance),
    COUNTED("events_solved", events_solved, done.solve.events),
    COUNTED("points_looked_up", points_looked_up, solve.lookups),
    COUNTED("events_suppressed", events_suppressed, done.work.counts.suppressed),
    COUNTED("events_refractory", events_refractory, done.work.counts.refractory),
    COUNTED("events_signal", events_by_cause[TIDES_CAUSE_SIGNAL], done.work.counts.cause[TIDES_CAUSE_SIGNAL]),
    COUNTED("events_leak", events_by_cause[TIDES_CAUSE_LEAK], done.work.counts.cause[TIDES_CAUSE_LEAK]),
    COUNTED("events_shot", events_by_cause[TIDES_CAUSE_SHOT], done.work.counts.cause[TIDES_CAUSE_SHOT]),
    COUNTED("events_hot", events_by_cause[TIDES_CAUSE_HOT], done.work.counts.cause[TIDES_CAUSE_HOT]),
    COUNT("events_written", DERIVED, events_written),
    COUNT("events_dropped", DERIVED, events_dropped),
    COUNT("events_overflowed", DERIVED, events_overflowed),
    COUNT("events_delayed", DERIVED, events_delayed),
    COUNT("filtered.background", DERIVED, events_filtered[TIDES_STAGE_BACKGROUND]),
    COUNT("filtered.activity", DERIVED, events_filtered[TIDES_STAGE_ACTIVITY]),
    COUNT("filtered.afk", DERIVED, events_filtered[TIDES_STAGE_AFK]),
    COUNT("filtered.trail", DERIVED, events_filtered[TIDES_STAGE_TRAIL]),
    COUNT("filtered.erc", DERIVED, events_filtered[TIDES_STAGE_ERC]),
    REAL("worst_delay_s", "s", DERIVED, worst_delay_s),
    REAL("renders_full_frame_equivalent", "full frames", DERIVED, renders_full_frame_equivalent),
    ROW("tiles", "", WHOLE, DERIVED, render.tiles, IN_STATS),
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
    COUNTED("steps", steps, done.steps.steps),
    COUNT("steps_rejected", SUM, steps_rejected),
    COUNTED("steps_at_minimum", steps_at_minimum, done.steps.at_minimum),
    COUNTED("steps_at_rounding", steps_at_rounding, done.steps.at_rounding),
    COUNTED("steps_probed", steps_probed, done.steps.probed),
    WORST("worst_error", worst_error, done.steps.worst_error),
    WORST("worst_deviation", worst_deviation, done.steps.worst_deviation),
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
    REAL("time_alone_s", "s", SUM, time_alone_s),
};

enum { ROWS = sizeof table / sizeof table[0] };

static tides_stat shown[ROWS];
static pthread_once_t made = PTHREAD_ONCE_INIT;

static void show(void) {
    for (size_t i = 0; i < ROWS; i++) shown[i] = table[i].stat;
}

const tides_stat *tides_stats_table(size_t *count) {
    pthread_once(&made, show);
    if (count) *count = ROWS;
    return shown;
}

/* -- one value ------------------------------------------------------------------------------------------------------------- */

double tides_stat_value(const tides_stats *stats, const tides_stat *row) {
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
    const int32_t whole = row->type == TIDES_STAT_WHOLE ? (int32_t)value : 0;
    if (row->type == TIDES_STAT_REAL) memcpy(at, &value, sizeof value);
    if (row->type == TIDES_STAT_COUNT) memcpy(at, &count, sizeof count);
    if (row->type == TIDES_STAT_WHOLE) memcpy(at, &whole, sizeof whole);
}

/* -- of a run -------------------------------------------------------------------------------------------------------------- */

void td_stats_take(const tides_simulator *s, tides_stats *stats) {
    *stats = s->totals.here;
    for (size_t i = 0; i < ROWS; i++)
        if (table[i].source != IN_STATS)
            memcpy((char *)stats + table[i].stat.offset, (const char *)s + table[i].source, sizeof(uint64_t));
}

/* 1 for sums of time. td_stats_put, which undoes a step, leaves them as they are: the time of an undone step has been spent all
 * the same. */
static int is_spent(const tides_stat *row) { return row->joined == TIDES_JOIN_SUM && strcmp(row->unit, "s") == 0; }

void td_stats_put(tides_simulator *s, const tides_stats *stats) {
    const tides_stats now = s->totals.here;
    s->totals.here = *stats;
    for (size_t i = 0; i < ROWS; i++) {
        const tides_stat *row = &table[i].stat;
        if (table[i].source != IN_STATS)
            memcpy((char *)s + table[i].source, (const char *)stats + row->offset, sizeof(uint64_t));
        if (is_spent(row)) td_stat_set(&s->totals.here, row, tides_stat_value(&now, row));
    }
}

/* Collects the counts since the start or the last restore, and the settings that the run file left to the simulator. */
static void collect(const tides_simulator *s, tides_stats *stats) {
    td_stats_take(s, stats);
    tides_renderer_stats(s->renderer, &stats->render);
    stats->render.pixels_nonfinite += s->done.work.counts.nonfinite;
    stats->solve = s->solve.on ? TIDES_SOLVE_DOUBLE : TIDES_SOLVE_OFF;
    stats->unsolved = (uint64_t)s->solve.unsolved;
    stats->unit = (uint64_t)s->given.unit;
    stats->tolerance = s->given.tolerance;
}

/* Joins `before`, the counts from before a restore, to those after it: adds sums, and keeps the larger of two maxima. */
static void join(tides_stats *stats, const tides_stats *before) {
    for (size_t i = 0; i < ROWS; i++) {
        const tides_stat *row = &table[i].stat;
        const double own = tides_stat_value(stats, row), other = tides_stat_value(before, row);
        if (row->joined == TIDES_JOIN_SUM) td_stat_set(stats, row, own + other);
        if (row->joined == TIDES_JOIN_LARGEST) td_stat_set(stats, row, own > other ? own : other);
    }
}

/* Derives time_other_s, the run time outside all timed stages, so that the times of all stages sum to the run time. Derives the
 * simulated time and the real-time factor, too. */
static void derive_times(const tides_simulator *s, tides_stats *stats) {
    const tides_render_stats *render = &stats->render;
    const double known = render->time_build_s + render->time_motion_s + render->time_sweep_s + render->time_project_s +
                         render->time_sort_s + render->time_composite_s + render->time_transfer_s + stats->time_compare_s +
                         stats->time_sink_s + stats->time_look_up_s;
    stats->time_other_s = stats->run_time_s - known;
    stats->simulated_s = s->started ? td_grid_time(s, s->step) : 0;
    stats->real_time_factor = stats->run_time_s > 0 ? stats->simulated_s / stats->run_time_s : 0;
}

/* Without a readout, all events count as written, unless filters drop them. With one, its arbiter's counts already
 * include the run before a restore, since a checkpoint holds them together with the queues. */
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

/* The filters' counts already include the run before a restore: they are part of the state that a checkpoint holds. */
static void derive_filters(const tides_simulator *s, tides_stats *stats) {
    tides_filter_stats filters;
    if (!s->filters.filter) return;
    tides_filter_stats_get(s->filters.filter, &filters);
    memcpy(stats->events_filtered, filters.dropped, sizeof stats->events_filtered);
    stats->events_written = filters.out;
}

void tides_simulator_stats(const tides_simulator *simulator, tides_stats *stats) {
    collect(simulator, stats);
    join(stats, &simulator->totals.before);
    stats->events = stats->events_on + stats->events_off;
    stats->renders_full_frame_equivalent = (double)stats->render.blocks / TD_TILE_BLOCKS / stats->render.tiles;
    derive_times(simulator, stats);
    derive_readout(simulator, stats);
    derive_filters(simulator, stats);
    stats->error_p50_s = td_timing_percentile(&simulator->done.timing, 0.50);
    stats->error_p95_s = td_timing_percentile(&simulator->done.timing, 0.95);
    stats->error_p99_s = td_timing_percentile(&simulator->done.timing, 0.99);
    stats->peak_memory_bytes = td_peak_memory();
    if (simulator->started) stats->worst_residual = td_worst_residual(simulator);
}
