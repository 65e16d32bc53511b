/* The statistics of a run as JSON (DESIGN 6). */
#include "session.h"

/* Each stage, and `other`: the rest of the run time, so that the parts sum to the whole. */
static int32_t add_times(cJSON *root, const tides_stats *s) {
    cJSON *times = cJSON_AddObjectToObject(root, "time_s");
    const struct {
        const char *name;
        double seconds;
    } parts[] = {
        {"build", s->render.time_build_s},
        {"motion", s->render.time_motion_s},
        {"sweep", s->render.time_sweep_s},
        {"project", s->render.time_project_s},
        {"sort", s->render.time_sort_s},
        {"composite", s->render.time_composite_s},
        {"transfer", s->render.time_transfer_s},
        {"compare", s->time_compare_s},
        {"sink", s->time_sink_s},
        {"other", s->time_other_s},
    };
    int32_t ok = times != NULL;
    for (size_t i = 0; ok && i < sizeof parts / sizeof parts[0]; i++)
        ok = cJSON_AddNumberToObject(times, parts[i].name, parts[i].seconds) != NULL;
    return ok;
}

static int32_t add_counts(cJSON *root, const tides_stats *s) {
    const struct {
        const char *name;
        double count;
    } parts[] = {
        {"events", (double)s->events},
        {"events_on", (double)s->events_on},
        {"events_off", (double)s->events_off},
        {"events_truncated", (double)s->events_truncated},
        {"events_uncertain", (double)s->events_uncertain},
        {"events_caught_up", (double)s->events_caught_up},
        {"events_suppressed", (double)s->events_suppressed},
        {"events_refractory", (double)s->events_refractory},
        {"events_signal", (double)s->events_by_cause[TIDES_CAUSE_SIGNAL]},
        {"events_leak", (double)s->events_by_cause[TIDES_CAUSE_LEAK]},
        {"events_shot", (double)s->events_by_cause[TIDES_CAUSE_SHOT]},
        {"events_hot", (double)s->events_by_cause[TIDES_CAUSE_HOT]},
        {"events_written", (double)s->events_written},
        {"events_dropped", (double)s->events_dropped},
        {"events_overflowed", (double)s->events_overflowed},
        {"events_delayed", (double)s->events_delayed},
        {"worst_delay_s", s->worst_delay_s},
        {"renders_full_frame_equivalent", s->renders_full_frame_equivalent},
        {"tiles", s->render.tiles},
        {"tile_jobs", (double)s->render.tile_jobs},
        {"tile_jobs_skipped", (double)s->render.tile_jobs_skipped},
        {"tile_steps_still", (double)s->tile_steps_still},
        {"gaussians_still", (double)s->render.gaussians_still},
        {"gaussians_moved", (double)s->render.gaussians_moved},
        {"gaussians_interpolated", (double)s->render.gaussians_interpolated},
        {"gaussians_total", (double)s->render.gaussians_total},
        {"gaussians_projected", (double)s->render.gaussians_projected},
        {"gaussians_culled", (double)s->render.gaussians_culled},
        {"sweeps", (double)s->render.sweeps},
        {"pairs_evaluated", (double)s->render.pairs_evaluated},
        {"lists_kept", (double)s->render.lists_kept},
        {"pixels_nonfinite", (double)s->render.pixels_nonfinite},
        {"steps", (double)s->steps},
        {"steps_rejected", (double)s->steps_rejected},
        {"steps_over_budget", (double)s->steps_over_budget},
        {"steps_at_minimum", (double)s->steps_at_minimum},
        {"steps_at_rounding", (double)s->steps_at_rounding},
        {"steps_probed", (double)s->steps_probed},
        {"worst_error", s->worst_error},
        {"worst_deviation", s->worst_deviation},
        {"error_p50_s", s->error_p50_s},
        {"error_p95_s", s->error_p95_s},
        {"error_p99_s", s->error_p99_s},
        {"worst_residual", s->worst_residual},
        {"simulated_s", s->simulated_s},
        {"run_time_s", s->run_time_s},
        {"real_time_factor", s->real_time_factor},
        {"peak_memory_bytes", (double)s->peak_memory_bytes},
    };
    int32_t ok = 1;
    for (size_t i = 0; ok && i < sizeof parts / sizeof parts[0]; i++)
        ok = cJSON_AddNumberToObject(root, parts[i].name, parts[i].count) != NULL;
    return ok;
}

cJSON *cli_stats_json(const tides_stats *stats, const tides_session_facts *session) {
    cJSON *root = cJSON_CreateObject();
    int32_t ok = root && add_counts(root, stats) && add_times(root, stats);
    ok = ok && cJSON_AddStringToObject(root, "device", session->info.name);
    ok = ok && cJSON_AddStringToObject(root, "platform", session->info.platform);
    ok = ok && cJSON_AddNumberToObject(root, "lanes", session->info.lanes);
    ok = ok && cJSON_AddNumberToObject(root, "width", session->intrinsics.width);
    ok = ok && cJSON_AddNumberToObject(root, "height", session->intrinsics.height);
    ok = ok && cJSON_AddStringToObject(root, "version", tides_version());
    ok = ok && cJSON_AddNumberToObject(root, "numerics", TIDES_NUMERICS);
    ok = ok && cJSON_AddStringToObject(root, "seed", session->values.seed);
    if (!ok) {
        cJSON_Delete(root);
        root = NULL;
    }
    return root;
}
