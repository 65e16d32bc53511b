/* tides bench calibrate: random sensors are simulated on a scene, and measured again from their events by tides calibrate. It
 * shows how close the values come, and whether error bars hold. */
#include "bench.h"
#include "bench_calibrate.h"
#include "demo.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SENSORS = 40, SENSORS_QUICK = 1, MEASURED = 6, SETS = 12 };
static const int32_t measured[MEASURED] = {TIDES_CALIBRATED_ON,   TIDES_CALIBRATED_OFF,        TIDES_CALIBRATED_EPS,
                                           TIDES_CALIBRATED_POLE, TIDES_CALIBRATED_REFRACTORY, TIDES_CALIBRATED_SIGMA};

typedef struct calibrate_row {
    char scene[64];
    int32_t sensor, law, noisy, refused, seen_law;
    double truth[MEASURED], found[MEASURED], error[MEASURED], seconds;
    uint64_t events;
} calibrate_row;

typedef struct calibrate_rows {
    calibrate_row *rows;
    size_t count;
} calibrate_rows;

const char *const *bench_calibrate_names(void) {
    static const char *const names[] = {"demo", NULL};
    return names;
}

/* -- sensors --------------------------------------------------------------------------------------------------------------- */

/* Knuth's generator (MMIX), upper bits: uniform in [0, 1). */
static double draw_share(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 9007199254740992.0;
}

static void draw_sensor(calibrate_row *row) {
    uint64_t state = 1000003u * (uint64_t)(row->sensor + 1);
    for (int32_t i = 0; i < 8; i++) draw_share(&state);
    const double on = 0.08 * pow(10, draw_share(&state)), ratio = pow(2, 2 * draw_share(&state) - 1);
    row->truth[0] = on;
    row->truth[1] = fmin(fmax(on / ratio, 0.08), 0.8);
    row->truth[2] = 0.001 + 0.099 * draw_share(&state);
    row->truth[3] = draw_share(&state) < 0.25 ? 0 : 0.01 * draw_share(&state);
    row->truth[4] = draw_share(&state) < 0.5 ? 0 : 0.002 * draw_share(&state);
    row->truth[5] = 0.15 * draw_share(&state) * fmin(on, row->truth[1]);
    row->law = row->truth[3] > 0 && draw_share(&state) < 0.3;
    if (row->law) row->truth[3] *= 0.3; /* that at Y = 1: it is longer in the dark */
    row->noisy = row->sensor % 3 == 2;
}

/* The sensor's settings as --set has them; `text` holds the texts. */
static size_t describe(const bench *b, const calibrate_row *row, char text[SETS][80], const char *sets[SETS]) {
    size_t n = 0;
    snprintf(text[n++], 80, "sensor.preset=ideal"); /* without the run's own sensor */
    snprintf(text[n++], 80, "sensor.threshold_on=%.17g", row->truth[0]);
    snprintf(text[n++], 80, "sensor.threshold_off=%.17g", row->truth[1]);
    snprintf(text[n++], 80, "image.log_eps=%.17g", row->truth[2]);
    if (row->truth[3] > 0)
        snprintf(text[n++], 80, "frontend.photoreceptor_cutoff_hz=%.17g", 1 / (6.283185307179586 * row->truth[3]));
    if (row->law) snprintf(text[n++], 80, "frontend.photoreceptor_law=intensity");
    snprintf(text[n++], 80, "sensor.refractory_s=%.17g", row->truth[4]);
    snprintf(text[n++], 80, "sensor.threshold_sigma=%.17g", row->truth[5]);
    if (row->noisy) snprintf(text[n++], 80, "frontend.shot_noise_hz=1");
    if (b->quick) snprintf(text[n++], 80, "time.stop=0.04"); /* of the demo: shorter */
    for (size_t i = 0; i < n; i++) sets[i] = text[i];
    return n;
}

/* -- one of them ----------------------------------------------------------------------------------------------------- */

static tides_status record(bench *b, const char *run, const char *events, calibrate_row *row, tides_error *error) {
    char text[SETS][80];
    const char *sets[SETS];
    const size_t count = describe(b, row, text, sets);
    tides_session *session = NULL;
    tides_recorded done = {0};
    tides_status status = tides_session_load(run, sets, count, b->common->device, &session, error);
    if (status == TIDES_OK)
        status = tides_session_write(session, events, NULL, cli_progress_step, &b->progress, &done, NULL, error);
    tides_session_close(session);
    row->events = done.events;
    return status;
}

static tides_status measure(bench *b, const char *run, const char *events, calibrate_row *row, tides_error *error) {
    tides_session *session = NULL;
    tides_calibrate_options options;
    tides_calibration found;
    tides_calibrate_options_defaults(&options);
    tides_status status = tides_session_load(run, NULL, 0, b->common->device, &session, error);
    const double began = bench_processor_s(1);
    if (status == TIDES_OK) status = tides_calibrate(events, session, &options, cli_progress_step, &b->progress, &found, error);
    tides_session_close(session);
    if (status != TIDES_OK) return status;
    row->seconds = bench_processor_s(1) - began;
    row->refused = found.refused;
    row->seen_law = found.law;
    for (int32_t i = 0; i < MEASURED; i++) {
        row->found[i] = found.values[measured[i]].value;
        row->error[i] = found.values[measured[i]].error;
    }
    tides_calibration_free(&found);
    return TIDES_OK;
}

static tides_status one(bench *b, const char *run, calibrate_row *row, tides_error *error) {
    char events[4200];
    tides_status status = bench_path(b, "calibrate_events", ".h5", events, sizeof events, error);
    draw_sensor(row);
    if (status == TIDES_OK) status = record(b, run, events, row, error);
    if (status == TIDES_OK) status = measure(b, run, events, row, error);
    unlink(events);
    if (status == TIDES_OK)
        bench_say(b,
                  "%-8s sensor %2d: C_on %.3g (%.3g), C_off %.3g (%.3g), log_eps %.3g (%.3g), pole %.3g (%.3g) ms, refractory "
                  "%.3g (%.3g) ms%s",
                  row->scene, (int)row->sensor, row->found[0], row->truth[0], row->found[1], row->truth[1], row->found[2],
                  row->truth[2], 1e3 * row->found[3], 1e3 * row->truth[3], 1e3 * row->found[4], 1e3 * row->truth[4],
                  row->refused ? "; refused" : "");
    return status;
}

/* -- results -------------------------------------------------------------------------------------------------------------- */

static int32_t cells_of(const void *rows, size_t index, bench_cell cells[BENCH_CELLS_MAX]) {
    static const char *const names[MEASURED][3] = {{"threshold_on", "threshold_on_found", "threshold_on_error"},
                                                   {"threshold_off", "threshold_off_found", "threshold_off_error"},
                                                   {"log_eps", "log_eps_found", "log_eps_error"},
                                                   {"pole_s", "pole_s_found", "pole_s_error"},
                                                   {"refractory_s", "refractory_s_found", "refractory_s_error"},
                                                   {"threshold_sigma", "threshold_sigma_found", "threshold_sigma_error"}};
    const calibrate_row *r = (const calibrate_row *)rows + index;
    int32_t n = 0;
    cells[n++] = (bench_cell){"scene", r->scene, 0};
    cells[n++] = (bench_cell){"sensor", NULL, r->sensor};
    cells[n++] = (bench_cell){"law", r->law ? "intensity" : "constant", 0};
    cells[n++] = (bench_cell){"law_found", r->seen_law ? "intensity" : "constant", 0};
    cells[n++] = (bench_cell){"noisy", NULL, r->noisy};
    cells[n++] = (bench_cell){"refused", NULL, r->refused};
    cells[n++] = (bench_cell){"events", NULL, (double)r->events};
    cells[n++] = (bench_cell){"processor_s", NULL, r->seconds};
    for (int32_t i = 0; i < MEASURED; i++) {
        cells[n++] = (bench_cell){names[i][0], NULL, r->truth[i]};
        cells[n++] = (bench_cell){names[i][1], NULL, r->found[i]};
        cells[n++] = (bench_cell){names[i][2], NULL, r->error[i]};
    }
    return n;
}

/* Prints median and worst deviation of thresholds, and how often the true value is within its error bar. */
static void print_summary(const calibrate_rows *all) {
    static const char *const names[MEASURED] = {"threshold_on", "threshold_off", "log_eps",
                                                "pole_s",       "refractory_s",  "threshold_sigma"};
    printf("%-16s %8s %14s %14s %12s\n", "value", "sensors", "median off", "worst off", "within 1 sd");
    for (int32_t i = 0; i < MEASURED; i++) {
        double off[4 * SENSORS];
        int32_t count = 0, within = 0;
        for (size_t k = 0; k < all->count && count < 4 * SENSORS; k++) {
            const calibrate_row *r = &all->rows[k];
            const double d = fabs(r->found[i] - r->truth[i]);
            if (r->refused || !(d == d)) continue;
            within += d <= r->error[i];
            off[count++] = i < 2 ? 100 * d / r->truth[i] : d;
        }
        if (count == 0) continue;
        cli_sort(off, (size_t)count);
        printf("%-16s %8d %12.3g%s %12.3g%s %10.0f %%\n", names[i], (int)count, off[count / 2], i < 2 ? " %" : "  ",
               off[count - 1], i < 2 ? " %" : "  ", 100.0 * within / count);
    }
}

/* -- scenes ---------------------------------------------------------------------------------------------------------------- */

/* Makes the demo's run in the folder of results, or uses a run file. */
static tides_status find_run(const bench *b, const char *name, char run[4300], tides_error *error) {
    char folder[4200];
    snprintf(run, 4300, "%s", name);
    if (strcmp(name, "demo") != 0) return TIDES_OK;
    tides_status status = bench_path(b, "calibrate_demo", "", folder, sizeof folder, error);
    if (status == TIDES_OK) status = cli_make_directory(folder, error);
    if (status == TIDES_OK) status = demo_scene_write(folder, error);
    snprintf(run, 4300, "%s/run.json", folder);
    return status;
}

static tides_status measure_scene(bench *b, const char *name, calibrate_rows *all, tides_error *error) {
    char run[4300];
    const int32_t sensors = b->quick ? SENSORS_QUICK : SENSORS;
    tides_status status = find_run(b, name, run, error);
    for (int32_t i = 0; i < sensors && status == TIDES_OK; i++) {
        calibrate_row *grown = realloc(all->rows, (all->count + 1) * sizeof *grown);
        if (!grown) return cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
        all->rows = grown;
        calibrate_row *row = all->rows + all->count;
        memset(row, 0, sizeof *row);
        row->sensor = i;
        snprintf(row->scene, sizeof row->scene, "%s", strrchr(name, '/') ? strrchr(name, '/') + 1 : name);
        status = one(b, run, row, error);
        all->count += status == TIDES_OK;
    }
    return status;
}

tides_status bench_calibrate(bench *b, const cli_list *scenes, tides_error *error) {
    const cli_list demo = {.items = {"demo"}, .count = 1}, *asked = scenes->count ? scenes : &demo;
    calibrate_rows all = {.count = 0};
    cJSON *header = bench_header(b, "calibrate");
    tides_status status = header ? TIDES_OK : cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    for (size_t i = 0; i < asked->count && status == TIDES_OK; i++) status = measure_scene(b, asked->items[i], &all, error);
    const bench_table table = {all.rows, all.count, cells_of};
    if (status == TIDES_OK) status = bench_write_table(b, "calibrate", header, &table, error);
    if (status == TIDES_OK && !b->common->quiet && !b->common->json) print_summary(&all);
    cJSON_Delete(header);
    free(all.rows);
    return status;
}
