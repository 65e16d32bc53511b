/* The table of statistics: every field of tides_stats, once, under the name that --stats and Python's callers know. For whoever
 * writes them down; what each means stands at its field (tides/simulate.h, tides/render.h). */
#include "tides/run.h"

#define ROW(key, kind, label, member) \
    { key, label, TIDES_STAT_##kind, 0, offsetof(tides_stats, member) }
#define COUNT(member) ROW(#member, COUNT, "", member)
#define OF_RENDERS(member) ROW(#member, COUNT, "", render.member)
#define REAL(member, unit) ROW(#member, REAL, unit, member)
#define CAUSE(name, cause) ROW(name, COUNT, "", events_by_cause[cause])
#define TIME(name, member) ROW("time_s." name, REAL, "s", member)

/* clang-format off */
static const tides_stat table[] = {
    COUNT(events), COUNT(events_on), COUNT(events_off), COUNT(events_truncated), COUNT(events_uncertain),
    COUNT(events_caught_up), COUNT(events_suppressed), COUNT(events_refractory),
    CAUSE("events_signal", TIDES_CAUSE_SIGNAL), CAUSE("events_leak", TIDES_CAUSE_LEAK),
    CAUSE("events_shot", TIDES_CAUSE_SHOT), CAUSE("events_hot", TIDES_CAUSE_HOT),
    COUNT(events_written), COUNT(events_dropped), COUNT(events_overflowed), COUNT(events_delayed),
    REAL(worst_delay_s, "s"), REAL(renders_full_frame_equivalent, "full frames"),
    ROW("tiles", WHOLE, "", render.tiles), OF_RENDERS(tile_jobs), OF_RENDERS(tile_jobs_skipped), COUNT(tile_steps_still),
    OF_RENDERS(gaussians_still), OF_RENDERS(gaussians_moved), OF_RENDERS(gaussians_interpolated),
    OF_RENDERS(gaussians_total), OF_RENDERS(gaussians_projected), OF_RENDERS(gaussians_culled), OF_RENDERS(sweeps),
    OF_RENDERS(pairs_evaluated), OF_RENDERS(lists_kept), OF_RENDERS(pixels_nonfinite),
    COUNT(steps), COUNT(steps_rejected), COUNT(steps_over_budget), COUNT(steps_at_minimum), COUNT(steps_at_rounding),
    COUNT(steps_probed), REAL(worst_error, "thresholds"), REAL(worst_deviation, "thresholds"),
    REAL(error_p50_s, "s"), REAL(error_p95_s, "s"), REAL(error_p99_s, "s"), REAL(worst_residual, "thresholds"),
    REAL(simulated_s, "s"), REAL(run_time_s, "s"), REAL(real_time_factor, ""), COUNT(peak_memory_bytes),
    TIME("build", render.time_build_s), TIME("motion", render.time_motion_s), TIME("sweep", render.time_sweep_s),
    TIME("project", render.time_project_s), TIME("sort", render.time_sort_s),
    TIME("composite", render.time_composite_s), TIME("transfer", render.time_transfer_s),
    TIME("compare", time_compare_s), TIME("sink", time_sink_s), TIME("other", time_other_s),
};
/* clang-format on */

const tides_stat *tides_stats_table(size_t *count) {
    if (count) *count = sizeof table / sizeof table[0];
    return table;
}
