/* tides bench calibrate: sensors drawn by chance, simulated on a scene, and measured again from their events (tides
 * calibrate), once from the light of the scene itself and once from exposed frames of it. The table compares values found with
 * the true ones, and their errors with their error bars. */
#include "bench.h"
#include "bench_calibrate.h"
#include "demo.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SENSORS_QUICK = 1, MEASURED = 6, SETS = 20, SET_CHARS = 4400, LIGHTS = 4 };
/* Frames that a sensor is measured from [Hz]; 0: the scene itself. An exposure lasts a quarter of their period. */
static const double lights[LIGHTS] = {0, 100, 50, 25};
#define EXPOSED 0.25
static const int32_t measured[MEASURED] = {TIDES_CALIBRATED_ON,   TIDES_CALIBRATED_OFF,        TIDES_CALIBRATED_EPS,
                                           TIDES_CALIBRATED_POLE, TIDES_CALIBRATED_REFRACTORY, TIDES_CALIBRATED_SIGMA};

typedef struct calibrate_row {
    char scene[64];
    double light_hz; /* 0: the scene's own light */
    int32_t sensor, law, noisy, refused, seen_law;
    double truth[MEASURED], found[MEASURED], error[MEASURED], seconds;
    uint64_t events;
} calibrate_row;

typedef struct calibrate_rows {
    calibrate_row *rows;
    size_t count;
} calibrate_rows;

/* A scene, as it was made for this benchmark: the middle of its view alone, which keeps motion in pixels as it is. */
typedef struct calibrate_scene {
    char name[64], run[4300];   /* the run file */
    char empty[4200];           /* a run file that says nothing: of what is set alone */
    char view[SETS][SET_CHARS]; /* what is set beside it */
    size_t views;
    char frames[LIGHTS][4200]; /* folders; the first is empty */
} calibrate_scene;

const char *const *bench_calibrate_names(void) {
    static const char *const names[] = {"demo", "slider_depth", "trained_srgb", NULL};
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

static void add_set(char text[SETS][SET_CHARS], size_t *n, const char *key, double value) {
    snprintf(text[(*n)++], SET_CHARS, "%s=%.17g", key, value);
}

/* The sensor as --set has it, behind what the scene sets. */
static size_t describe(const calibrate_row *row, char text[SETS][SET_CHARS], size_t n) {
    snprintf(text[n++], SET_CHARS, "sensor.preset=ideal"); /* nothing of the run's own sensor */
    add_set(text, &n, "sensor.threshold_on", row->truth[0]);
    add_set(text, &n, "sensor.threshold_off", row->truth[1]);
    add_set(text, &n, "image.log_eps", row->truth[2]);
    if (row->truth[3] > 0) add_set(text, &n, "frontend.photoreceptor_cutoff_hz", 1 / (6.283185307179586 * row->truth[3]));
    if (row->law) snprintf(text[n++], SET_CHARS, "frontend.photoreceptor_law=intensity");
    add_set(text, &n, "sensor.refractory_s", row->truth[4]);
    add_set(text, &n, "sensor.threshold_sigma", row->truth[5]);
    if (row->noisy) add_set(text, &n, "frontend.shot_noise_hz", 1);
    add_set(text, &n, "seed", row->sensor + 1); /* with one seed all sensors had the same pixels' deviations */
    return n;
}

/* -- one of them ----------------------------------------------------------------------------------------------------- */

static tides_status open_run(const bench *b, const char *run, char text[SETS][SET_CHARS], size_t count, tides_session **session,
                             tides_error *error) {
    const char *sets[SETS];
    for (size_t i = 0; i < count; i++) sets[i] = text[i];
    return tides_session_load(run, sets, count, b->common->device, session, error);
}

static tides_status record(bench *b, const calibrate_scene *scene, const char *events, calibrate_row *row, tides_error *error) {
    char text[SETS][SET_CHARS];
    memcpy(text, scene->view, sizeof text);
    const size_t count = describe(row, text, scene->views);
    tides_session *session = NULL;
    tides_recorded done = {0};
    tides_status status = open_run(b, scene->run, text, count, &session, error);
    if (status == TIDES_OK)
        status = tides_session_write(session, events, NULL, cli_progress_step, &b->progress, &done, NULL, error);
    tides_session_close(session);
    row->events = done.events;
    return status;
}

/* The light that the events are measured with: the scene's run, or one of frames. */
static tides_status open_light(const bench *b, const calibrate_scene *scene, int32_t light, tides_session **session,
                               tides_error *error) {
    char text[SETS][SET_CHARS];
    memcpy(text, scene->view, sizeof text);
    if (light == 0) return open_run(b, scene->run, text, scene->views, session, error);
    snprintf(text[0], SET_CHARS, "frames.file=%.4100s", scene->frames[light]);
    return open_run(b, scene->empty, text, 1, session, error);
}

static tides_status measure(bench *b, const calibrate_scene *scene, int32_t light, const char *events, calibrate_row *row,
                            tides_error *error) {
    tides_session *session = NULL;
    tides_calibrate_options options;
    tides_calibration found;
    tides_calibrate_options_defaults(&options);
    tides_status status = open_light(b, scene, light, &session, error);
    const double began = bench_processor_s(1);
    if (status == TIDES_OK) status = tides_calibrate(events, session, &options, cli_progress_step, &b->progress, &found, error);
    tides_session_close(session);
    if (status != TIDES_OK) return status;
    row->light_hz = lights[light];
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

static void say_row(const bench *b, const calibrate_row *row) {
    char light[32] = "its light";
    if (row->light_hz > 0) snprintf(light, sizeof light, "%g frames/s", row->light_hz);
    bench_say(b,
              "%-12s sensor %2d, %s: C_on %.3g (%.3g), C_off %.3g (%.3g), log_eps %.3g (%.3g), pole %.3g (%.3g) ms, "
              "refractory %.3g (%.3g) ms%s; %.0f s",
              row->scene, (int)row->sensor, light, row->found[0], row->truth[0], row->found[1], row->truth[1], row->found[2],
              row->truth[2], 1e3 * row->found[3], 1e3 * row->truth[3], 1e3 * row->found[4], 1e3 * row->truth[4],
              row->refused ? "; refused" : "", row->seconds);
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
    cells[n++] = (bench_cell){"frames_per_second", NULL, r->light_hz};
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

static const char *const groups[] = {"its light, no noise", "its light, noise", "100 frames/s", "50 frames/s", "25 frames/s"};
enum { GROUPS = sizeof groups / sizeof groups[0] };

static int32_t in_group(const calibrate_row *r, int32_t group) {
    return group < 2 ? r->light_hz == 0 && r->noisy == group : r->light_hz == lights[group - 1];
}

/* 1 where a pole was taken for one of the other law: time constants of two laws can't be compared. */
static int32_t is_wrong_law(const calibrate_row *r) { return r->truth[3] > 0 && r->found[3] > 0 && r->law != r->seen_law; }

/* One line: median and worst deviation of value `i`, and how often the truth is within the error bar. */
static void print_value(const calibrate_rows *all, int32_t group, int32_t i, double *off) {
    static const char *const names[MEASURED] = {"threshold_on", "threshold_off", "log_eps",
                                                "pole_s",       "refractory_s",  "threshold_sigma"};
    size_t count = 0, within = 0;
    for (size_t k = 0; k < all->count; k++) {
        const calibrate_row *r = &all->rows[k];
        const double d = fabs(r->found[i] - r->truth[i]);
        if (!in_group(r, group) || r->refused || !(d == d)) continue;
        if (measured[i] == TIDES_CALIBRATED_POLE && is_wrong_law(r)) continue;
        within += d <= r->error[i];
        off[count++] = i < 2 ? 100 * d / r->truth[i] : d;
    }
    if (count == 0) return;
    cli_sort(off, count);
    printf("%-20s %-16s %8zu %12.3g%s %12.3g%s %10.0f %%\n", groups[group], names[i], count, off[count / 2],
           i < 2 ? " %" : "  ", off[count - 1], i < 2 ? " %" : "  ", 100.0 * (double)within / (double)count);
}

static tides_status print_summary(const calibrate_rows *all, tides_error *error) {
    double *off = malloc((all->count + 1) * sizeof *off);
    if (!off) return cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    printf("%-20s %-16s %8s %14s %14s %12s\n", "light", "value", "sensors", "median off", "worst off", "within 1 sd");
    for (int32_t group = 0; group < GROUPS; group++) {
        size_t refused = 0, count = 0, wrong = 0;
        for (size_t k = 0; k < all->count; k++) {
            if (!in_group(&all->rows[k], group)) continue;
            count++;
            refused += all->rows[k].refused;
            wrong += !all->rows[k].refused && is_wrong_law(&all->rows[k]);
        }
        for (int32_t i = 0; i < MEASURED; i++) print_value(all, group, i, off);
        if (refused) printf("%-20s %zu of %zu sensors refused\n", groups[group], refused, count);
        if (wrong)
            printf("%-20s %zu poles go with light and were taken for constant ones, or the reverse\n", groups[group], wrong);
    }
    free(off);
    return TIDES_OK;
}

/* -- scenes ---------------------------------------------------------------------------------------------------------------- */

static void add_text(calibrate_scene *s, const char *text) { snprintf(s->view[s->views++], SET_CHARS, "%s", text); }

static void set_size(calibrate_scene *s, int32_t width, int32_t height) {
    add_set(s->view, &s->views, "camera.width", width);
    add_set(s->view, &s->views, "camera.height", height);
}

/* The middle of a view of that focal length; `off`: from the image's middle to the lens's, in both axes [px]. */
static void crop(calibrate_scene *s, double focal, int32_t width, int32_t height, double off) {
    set_size(s, width, height);
    add_set(s->view, &s->views, "camera.fx", focal);
    add_set(s->view, &s->views, "camera.fy", focal);
    add_set(s->view, &s->views, "camera.cx", 0.5 * width + off);
    add_set(s->view, &s->views, "camera.cy", 0.5 * height + off);
}

static tides_status make_demo(const bench *b, calibrate_scene *s, tides_error *error) {
    char folder[4200];
    tides_status status = bench_path(b, "calibrate_demo", "", folder, sizeof folder, error);
    if (status == TIDES_OK) status = cli_make_directory(folder, error);
    if (status == TIDES_OK) status = demo_scene_write(folder, error);
    snprintf(s->run, sizeof s->run, "%s/run.json", folder);
    crop(s, 300, 40, 30, 0);
    return status;
}

static tides_status write_empty(const bench *b, calibrate_scene *s, tides_error *error) {
    tides_status status = bench_path(b, "calibrate_run", ".json", s->empty, sizeof s->empty, error);
    FILE *file = status == TIDES_OK ? fopen(s->empty, "w") : NULL;
    if (status != TIDES_OK) return status;
    const int32_t written = file && fputs("{}\n", file) >= 0;
    if ((file && fclose(file) != 0) || !written) return cli_error(error, TIDES_WRITE_FAILED, "cannot write %s", s->empty);
    return TIDES_OK;
}

/* The named scene's run and view. Another name is a run file, which is taken as it is. */
static tides_status find_scene(const bench *b, const char *name, calibrate_scene *s, tides_error *error) {
    const char *slash = strrchr(name, '/'), *shared = getenv("TIDES_SHARED");
    const char *const data = shared && *shared ? shared : "../shared";
    double stop = 0.12;
    memset(s, 0, sizeof *s);
    tides_status status = write_empty(b, s, error);
    if (status != TIDES_OK) return status;
    snprintf(s->name, sizeof s->name, "%s", slash ? slash + 1 : name);
    snprintf(s->run, sizeof s->run, "%s", name);
    if (slash || strstr(name, ".json")) return TIDES_OK;
    if (strcmp(name, "demo") == 0) {
        status = make_demo(b, s, error);
    } else if (strcmp(name, "slider_depth") == 0) {
        snprintf(s->run, sizeof s->run, "%s/data/real/slider_depth/run.json", data);
        crop(s, 335, 64, 48, 10);
        stop = 0.16; /* its motion is slow */
    } else {
        snprintf(s->run, sizeof s->run, "%s", s->empty);
        snprintf(s->view[s->views++], SET_CHARS, "scene.file=%.2000s/data/playcanvas/guitar_20k_inria_sh0.ply", data);
        add_text(s, "image.transfer=srgb");
        add_set(s->view, &s->views, "camera.orbit_s", 2);
        set_size(s, 96, 72);
    }
    add_set(s->view, &s->views, "time.start", 0);
    add_set(s->view, &s->views, "time.stop", b->quick ? 0.04 : stop);
    return status;
}

/* Frames of the scene as an ordinary camera in its place takes them. */
static tides_status make_frames(bench *b, calibrate_scene *s, int32_t light, tides_error *error) {
    char text[SETS][SET_CHARS], name[64];
    size_t count = s->views;
    tides_session *session = NULL;
    snprintf(name, sizeof name, "calibrate_frames_%g", lights[light]);
    memcpy(text, s->view, sizeof text);
    add_set(text, &count, "exposure.frames_per_second", lights[light]);
    add_set(text, &count, "exposure.exposure_s", EXPOSED / lights[light]);
    tides_status status = bench_path(b, name, "", s->frames[light], sizeof s->frames[light], error);
    if (status == TIDES_OK) status = open_run(b, s->run, text, count, &session, error);
    if (status == TIDES_OK)
        status = tides_session_frames(session, s->frames[light], cli_progress_step, &b->progress, NULL, error);
    tides_session_close(session);
    return status;
}

/* -- all of it ------------------------------------------------------------------------------------------------------- */

static tides_status one(bench *b, const calibrate_scene *scene, const char *events, int32_t sensor, calibrate_rows *all,
                        tides_error *error) {
    calibrate_row drawn = {.sensor = sensor};
    snprintf(drawn.scene, sizeof drawn.scene, "%s", scene->name);
    draw_sensor(&drawn);
    tides_status status = record(b, scene, events, &drawn, error);
    for (int32_t light = 0; light < (b->quick ? 1 : LIGHTS) && status == TIDES_OK; light++) {
        calibrate_row *row = all->rows + all->count;
        *row = drawn;
        status = measure(b, scene, light, events, row, error);
        all->count += status == TIDES_OK;
        if (status == TIDES_OK) say_row(b, row);
    }
    return status;
}

/* 1 where --row has sensor `i`, or isn't given. */
static int32_t is_asked(const bench *b, int32_t i) {
    for (size_t k = 0; k < b->rows->count; k++)
        if (atoi(b->rows->items[k]) == i) return 1;
    return b->rows->count == 0;
}

static tides_status measure_scene(bench *b, const char *name, calibrate_rows *all, tides_error *error) {
    const int32_t sensors = b->quick ? SENSORS_QUICK : BENCH_CALIBRATE_SENSORS;
    char events[4300] = "";
    calibrate_scene *scene = malloc(sizeof *scene);
    calibrate_row *grown = realloc(all->rows, (all->count + (size_t)sensors * LIGHTS) * sizeof *grown);
    if (grown) all->rows = grown;
    tides_status status = scene && grown ? TIDES_OK : cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    if (status == TIDES_OK) status = bench_path(b, "calibrate_events", ".h5", events, sizeof events, error);
    if (status == TIDES_OK) status = find_scene(b, name, scene, error);
    for (int32_t i = 1; i < LIGHTS && !b->quick && status == TIDES_OK; i++) status = make_frames(b, scene, i, error);
    for (int32_t i = 0; i < sensors && status == TIDES_OK; i++) {
        if (!is_asked(b, i)) continue;
        status = one(b, scene, events, i, all, error);
        const bench_table table = {all->rows, all->count, cells_of};
        if (status == TIDES_OK) status = bench_write_csv(b, "calibrate", &table, error); /* of what there is by now */
    }
    if (scene && grown) unlink(events);
    free(scene);
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
    if (status == TIDES_OK && !b->common->quiet && !b->common->json) status = print_summary(&all, error);
    cJSON_Delete(header);
    free(all.rows);
    return status;
}
