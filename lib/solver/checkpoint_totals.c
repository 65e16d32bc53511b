/* A checkpoint's totals: what the statistics of both parts of a run are added up from. */
#include "td_checkpoint.h"

#include <math.h>

/* Where a total is kept. */
enum { SIMULATOR, RENDERER, BACKEND, PLACES };

typedef struct total {
    const char *name;
    int place, is_real, is_largest; /* of both parts; else their sum */
    size_t offset;
} total;

#define COUNT(name, place, owner, member) \
    { name, place, 0, 0, offsetof(owner, member) }
#define REAL(name, place, owner, member) \
    { name, place, 1, 0, offsetof(owner, member) }
#define LARGEST(name, place, owner, member) \
    { name, place, 1, 1, offsetof(owner, member) }

static const total totals[TD_TOTALS] = {
    COUNT("events_on", SIMULATOR, tides_simulator, sensor.counts.events_on),
    COUNT("events_off", SIMULATOR, tides_simulator, sensor.counts.events_off),
    COUNT("events_truncated", SIMULATOR, tides_simulator, sensor.counts.truncated),
    COUNT("events_caught_up", SIMULATOR, tides_simulator, sensor.counts.caught_up),
    COUNT("pixels_solved", SIMULATOR, tides_simulator, sensor.counts.solved),
    COUNT("pixels_nonfinite", SIMULATOR, tides_simulator, sensor.counts.nonfinite),
    COUNT("events_signal", SIMULATOR, tides_simulator, sensor.counts.cause[TIDES_CAUSE_SIGNAL]),
    COUNT("events_leak", SIMULATOR, tides_simulator, sensor.counts.cause[TIDES_CAUSE_LEAK]),
    COUNT("events_shot", SIMULATOR, tides_simulator, sensor.counts.cause[TIDES_CAUSE_SHOT]),
    COUNT("events_hot", SIMULATOR, tides_simulator, sensor.counts.cause[TIDES_CAUSE_HOT]),
    COUNT("events_suppressed", SIMULATOR, tides_simulator, sensor.counts.suppressed),
    COUNT("events_refractory", SIMULATOR, tides_simulator, sensor.counts.refractory),
    COUNT("steps", SIMULATOR, tides_simulator, stats.steps),
    COUNT("steps_rejected", SIMULATOR, tides_simulator, stats.steps_rejected),
    COUNT("steps_at_minimum", SIMULATOR, tides_simulator, stats.steps_at_minimum),
    COUNT("steps_over_budget", SIMULATOR, tides_simulator, stats.steps_over_budget),
    COUNT("steps_probed", SIMULATOR, tides_simulator, stats.steps_probed),
    COUNT("steps_at_rounding", SIMULATOR, tides_simulator, stats.steps_at_rounding),
    COUNT("events_uncertain", SIMULATOR, tides_simulator, timing.uncertain),
    COUNT("tile_steps_still", SIMULATOR, tides_simulator, stats.tile_steps_still),
    LARGEST("worst_error", SIMULATOR, tides_simulator, stats.worst_error),
    LARGEST("worst_deviation", SIMULATOR, tides_simulator, stats.worst_deviation),
    REAL("run_time_s", SIMULATOR, tides_simulator, stats.run_time_s),
    REAL("time_compare_s", SIMULATOR, tides_simulator, stats.time_compare_s),
    REAL("time_sink_s", SIMULATOR, tides_simulator, stats.time_sink_s),
    COUNT("tile_jobs", BACKEND, tides_render_stats, tile_jobs),
    COUNT("tile_jobs_skipped", RENDERER, tides_render_stats, tile_jobs_skipped),
    COUNT("gaussians_projected", BACKEND, tides_render_stats, gaussians_projected),
    COUNT("gaussians_culled", BACKEND, tides_render_stats, gaussians_culled),
    COUNT("gaussians_still", RENDERER, tides_render_stats, gaussians_still),
    COUNT("gaussians_moved", BACKEND, tides_render_stats, gaussians_moved),
    COUNT("gaussians_interpolated", BACKEND, tides_render_stats, gaussians_interpolated),
    COUNT("sweeps", BACKEND, tides_render_stats, sweeps),
    COUNT("pairs_evaluated", BACKEND, tides_render_stats, pairs_evaluated),
    COUNT("lists_kept", BACKEND, tides_render_stats, lists_kept),
    REAL("time_build_s", BACKEND, tides_render_stats, time_build_s),
    REAL("time_motion_s", BACKEND, tides_render_stats, time_motion_s),
    REAL("time_sweep_s", BACKEND, tides_render_stats, time_sweep_s),
    REAL("time_sweep_host_s", RENDERER, tides_render_stats, time_sweep_s), /* the two are added up when asked for */
    REAL("time_project_s", BACKEND, tides_render_stats, time_project_s),
    REAL("time_sort_s", BACKEND, tides_render_stats, time_sort_s),
    REAL("time_composite_s", BACKEND, tides_render_stats, time_composite_s),
    REAL("time_transfer_s", BACKEND, tides_render_stats, time_transfer_s),
};

static double value_of(const char *member, int is_real) {
    double real;
    uint64_t count;
    memcpy(&real, member, sizeof real);
    memcpy(&count, member, sizeof count);
    return is_real ? real : (double)count;
}

static void set_value(char *member, int is_real, double value) {
    uint64_t count = (uint64_t)value;
    if (is_real)
        memcpy(member, &value, sizeof value);
    else
        memcpy(member, &count, sizeof count);
}

tides_status td_totals_write(const tides_simulator *s, const td_place *place) {
    const char *const owners[PLACES] = {(const char *)s, (const char *)&s->renderer->stats,
                                        (const char *)&s->renderer->backend->stats};
    tides_status status = TIDES_OK;
    for (int i = 0; i < TD_TOTALS && status == TIDES_OK; i++)
        status = td_place_write_double(place, totals[i].name,
                                       value_of(owners[totals[i].place] + totals[i].offset, totals[i].is_real));
    return status;
}

tides_status td_totals_read(const td_place *place, double values[TD_TOTALS]) {
    tides_status status = TIDES_OK;
    for (int i = 0; i < TD_TOTALS && status == TIDES_OK; i++) {
        status = td_place_read_double(place, totals[i].name, &values[i]);
        double least = totals[i].is_real ? -0x1p53 : 0; /* times are differences, and may round to just below 0 */
        if (status == TIDES_OK && !(values[i] >= least && values[i] < 0x1p53))
            status = td_fail(place->error, TIDES_BAD_FILE, "%s: %s is %g, no total", place->file, totals[i].name, values[i]);
    }
    return status;
}

void td_totals_add(tides_simulator *s, const double values[TD_TOTALS]) {
    char *const owners[PLACES] = {(char *)s, (char *)&s->renderer->stats, (char *)&s->renderer->backend->stats};
    for (int i = 0; i < TD_TOTALS; i++) {
        char *member = owners[totals[i].place] + totals[i].offset;
        double own = value_of(member, totals[i].is_real);
        set_value(member, totals[i].is_real, totals[i].is_largest ? fmax(own, values[i]) : own + values[i]);
    }
}
