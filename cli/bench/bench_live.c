/* tides bench live: the time that a live run takes for each pose, from getting the pose to having its events, at 346x260 and
 * a pose every millisecond. The first step also makes the first image, and is listed separately. Poses come from the scene's
 * own camera path, without velocities. If that path is shorter than the run, the camera goes along it to and fro.
 *
 * If the Python package is there, the table also has latencies over ROS 2. Packets of 1 ms are sent at 1e5, 1e6 and 5e6
 * events/s. A latency is from just before a packet is encoded until another process has read it. In these rows column `way` is
 * "ros2", and columns about steps are about packets. */
#include "bench.h"
#include "bench_worlds.h"
#include "plot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 346, HEIGHT = 260, STEPS = 1000, STEPS_QUICK = 10 };
#define STEP_S 1e-3

/* A set of stepping options that is measured: column `way`. */
typedef struct live_way {
    const char *name;
    int32_t parts;    /* BENCH_SOLVED: events are looked up; BENCH_BLOCKS: each block has its own steps, not each tile */
    double tolerance; /* [thresholds] */
} live_way;
static const live_way ways[] = {{"tiles", 0, 0.01}, {"blocks", BENCH_BLOCKS, 0.01}, {"default", BENCH_TOGETHER, 0.1}};
enum { WAYS = sizeof ways / sizeof ways[0] };

typedef struct live_row {
    char scene[64];
    const char *way;
    int32_t steps;
    double ms[STEPS]; /* (steps) run time of each step but the first, or latency of each packet; sorted at the end */
    double first_ms;  /* likewise of the first step or packet */
    double seconds;   /* [s] run time of these steps, or time in which as many packets were sent */
    double lost;      /* packets that didn't arrive */
    int32_t taken;    /* number of steps (ros2: packets) that `stats` covers, including the first */
    tides_stats stats;
} live_row;

typedef struct live_rows {
    live_row *rows;
    size_t count;
    cJSON *header;
} live_rows;

static int32_t steps_of(const bench *b) { return b->quick ? STEPS_QUICK : STEPS; }

/* -- one run -------------------------------------------------------------------------------------------------------------- */

static int count_events(void *user, const tides_event *events, size_t count) {
    (void)events;
    *(uint64_t *)user += count;
    return 0;
}

/* The camera's pose at `time` [s] of the run: along its path and back. */
static tides_status pose_at(const bench_scene *scene, double time, tides_pose_sample *sample, tides_error *error) {
    const double lasts = scene->stop - scene->start, turns = fmod(time / lasts, 2), place = turns > 1 ? 2 - turns : turns;
    tides_pose pose;
    tides_status status = tides_trajectory_at(scene->camera, scene->start + place * lasts, &pose, error);
    if (status != TIDES_OK) return status;
    const double *r = pose.rotation, trace = r[0] + r[4] + r[8];
    double *q = sample->quaternion;
    memset(sample, 0, sizeof *sample);
    sample->time = time;
    memcpy(sample->position, pose.position, sizeof sample->position);
    /* Shepperd's formulas take the quaternion's largest component from the matrix's diagonal. Each other component is a sum or
     * difference of two entries off the diagonal, divided by 4 times the largest. */
    int32_t large = r[0] > r[4] ? (r[0] > r[8] ? 0 : 2) : (r[4] > r[8] ? 1 : 2);
    if (trace > r[4 * large]) {
        q[0] = 0.5 * sqrt(1 + trace);
        q[1] = (r[7] - r[5]) / (4 * q[0]), q[2] = (r[2] - r[6]) / (4 * q[0]), q[3] = (r[3] - r[1]) / (4 * q[0]);
        return TIDES_OK;
    }
    const int32_t i = large, j = (i + 1) % 3, k = (i + 2) % 3;
    q[1 + i] = 0.5 * sqrt(1 + r[4 * i] - r[4 * j] - r[4 * k]);
    q[0] = (r[3 * k + j] - r[3 * j + k]) / (4 * q[1 + i]);
    q[1 + j] = (r[3 * j + i] + r[3 * i + j]) / (4 * q[1 + i]);
    q[1 + k] = (r[3 * k + i] + r[3 * i + k]) / (4 * q[1 + i]);
    return TIDES_OK;
}

static tides_status take_steps(bench *b, const bench_scene *scene, tides_trajectory *path, tides_simulator *simulator,
                               live_row *row, tides_error *error) {
    uint64_t events = 0;
    for (int32_t k = 0; k <= row->steps; k++) {
        tides_pose_sample pose;
        tides_status status = pose_at(scene, (k + 1) * STEP_S, &pose, error);
        if (status != TIDES_OK) return status;
        if (cli_progress_step(&b->progress, (double)k / row->steps, "live"))
            return cli_error(error, TIDES_CANCELLED, "stopped on request");
        const double began = cli_now();
        status = tides_trajectory_append(path, &pose, 1, error);
        if (status == TIDES_OK)
            status = tides_simulator_run(simulator, pose.time + 1e-10, count_events, &events, NULL, NULL, error);
        if (status != TIDES_OK) return status;
        const double ms = 1e3 * (cli_now() - began);
        if (k == 0)
            row->first_ms = ms;
        else
            row->ms[k - 1] = ms, row->seconds += 1e-3 * ms;
    }
    tides_simulator_stats(simulator, &row->stats);
    row->taken = row->steps + 1;
    cli_sort(row->ms, (size_t)row->steps);
    return TIDES_OK;
}

static tides_status measure(bench *b, const bench_scene *scene, const live_way *way, live_row *row, tides_error *error) {
    tides_stepping stepping;
    tides_pose_sample pose;
    tides_trajectory *path = NULL;
    tides_simulator *simulator = NULL;
    snprintf(row->scene, sizeof row->scene, "%s", scene->name);
    row->way = way->name;
    row->steps = steps_of(b);
    double start, stop;
    tides_scene_range(scene->scene, &start, &stop);
    stop = fmin(stop, (row->steps + 2) * STEP_S);
    if (stop < (row->steps + 2) * STEP_S) row->steps = (int32_t)(stop / STEP_S) - 2; /* before paths of objects end */
    if (row->steps < 1)
        return cli_error(error, TIDES_OUT_OF_RANGE, "%s: its objects' paths end after %g s, too early for a live run",
                         scene->name, stop);
    tides_stepping_defaults(&stepping);
    stepping.step_s = STEP_S;
    stepping.tolerance = way->tolerance;
    bench_choose_parts(&stepping, way->parts);
    tides_status status = pose_at(scene, 0, &pose, error);
    if (status == TIDES_OK) status = tides_trajectory_create_open(&pose, 1, &path, error);
    if (status == TIDES_OK)
        status = tides_simulator_create(b->device, scene->scene, path, &scene->intrinsics, &scene->image, &scene->sensor,
                                        &stepping, 0, stop, NULL, NULL, &simulator, error);
    if (status == TIDES_OK) status = take_steps(b, scene, path, simulator, row, error);
    tides_simulator_destroy(simulator);
    tides_trajectory_destroy(path);
    return status;
}

/* The time [ms] that `percent` % of the steps don't exceed. */
static double percentile(const live_row *row, double percent) {
    const int32_t at = (int32_t)ceil(percent / 100 * row->steps) - 1;
    return row->ms[at < 0 ? 0 : at];
}

/* -- scenes --------------------------------------------------------------------------------------------------------------- */

/* Makes the scene. The demo's is made as long as the run. */
static tides_status make_scene(const bench *b, const char *name, bench_scene *scene, tides_error *error) {
    if (strcmp(name, "demo") != 0) return bench_world_make(name, b->quick, scene, error);
    return bench_make_demo((STEPS + 2) * STEP_S, scene, error); /* quick runs use its beginning */
}

static live_row *add_row(live_rows *all, tides_error *error) {
    live_row *grown = realloc(all->rows, (all->count + 1) * sizeof *grown);
    if (!grown) {
        cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
        return NULL;
    }
    all->rows = grown;
    return memset(grown + all->count, 0, sizeof *grown);
}

static tides_status measure_scene(bench *b, const char *name, live_rows *all, tides_error *error) {
    bench_scene scene;
    tides_status status = make_scene(b, name, &scene, error);
    if (status != TIDES_OK) return status;
    if (scene.intrinsics.width != WIDTH || scene.intrinsics.height != HEIGHT) bench_resize(&scene, WIDTH, HEIGHT);
    for (int32_t i = 0; i < WAYS && status == TIDES_OK; i++) {
        live_row *row = add_row(all, error);
        status = row ? measure(b, &scene, &ways[i], row, error) : TIDES_NO_MEMORY;
        if (status != TIDES_OK) break;
        all->count++;
        bench_say(b, "%-9s %-14s median %.3g ms, p99 %.3g ms", row->scene, row->way, percentile(row, 50), percentile(row, 99));
    }
    if (status == TIDES_OK && !bench_header_scene(all->header, &scene, NULL))
        status = cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    bench_scene_free(&scene);
    return status;
}

/* -- ROS 2 ---------------------------------------------------------------------------------------------------------------- */

static double number(const cJSON *row, const char *key) {
    return cJSON_GetNumberValue(cJSON_GetObjectItemCaseSensitive(row, key));
}

static tides_status measure_feed(bench *b, live_rows *all, tides_error *error) {
    cJSON *rows;
    tides_status status = bench_feed(b, b->quick ? STEPS_QUICK : STEPS, &rows, error);
    const cJSON *of, *ms;
    cJSON_ArrayForEach(of, rows) {
        live_row *row = add_row(all, error);
        if (!row) status = TIDES_NO_MEMORY;
        if (!row) break;
        cJSON_ArrayForEach(ms, cJSON_GetObjectItemCaseSensitive(of, "ms")) {
            if (row->steps < STEPS) row->ms[row->steps++] = ms->valuedouble;
        }
        if (row->steps == 0) continue; /* no packet arrived */
        snprintf(row->scene, sizeof row->scene, "%g kev/s", 1e-3 * number(of, "rate"));
        row->way = "ros2";
        row->first_ms = number(of, "first_ms");
        row->seconds = number(of, "seconds") * row->steps / number(of, "packets");
        row->lost = number(of, "lost");
        row->taken = (int32_t)number(of, "packets");
        row->stats.events_written = (uint64_t)number(of, "events");
        all->count++;
    }
    cJSON_Delete(rows);
    return status;
}

/* -- results -------------------------------------------------------------------------------------------------------------- */

static int32_t cells_of(const void *rows, size_t index, bench_cell cells[BENCH_CELLS_MAX]) {
    const live_row *r = (const live_row *)rows + index;
    const bench_cell made[] = {
        {"scene", r->scene, 0},
        {"way", r->way, 0},
        {"steps", NULL, r->steps},
        {"step_s", NULL, STEP_S},
        {"median_ms", NULL, percentile(r, 50)},
        {"p90_ms", NULL, percentile(r, 90)},
        {"p99_ms", NULL, percentile(r, 99)},
        {"worst_ms", NULL, percentile(r, 100)},
        {"first_ms", NULL, r->first_ms},
        {"real_time_factor", NULL, r->steps * STEP_S / r->seconds},
        {"events", NULL, (double)r->stats.events_written},
        {"events_per_step", NULL, (double)r->stats.events_written / r->taken},
        {"renders", NULL, r->stats.renders_full_frame_equivalent},
        {"lost", NULL, r->lost},
    };
    memcpy(cells, made, sizeof made);
    return sizeof made / sizeof made[0];
}

static void print_table(const live_rows *all) {
    printf("%-10s %-14s %6s %10s %8s %8s %9s %9s %11s %12s\n", "scene", "way", "steps", "median ms", "p90 ms", "p99 ms",
           "worst ms", "first ms", "x real time", "events/step");
    for (size_t i = 0; i < all->count; i++) {
        const live_row *r = &all->rows[i];
        printf("%-10s %-14s %6d %10.3g %8.3g %8.3g %9.3g %9.3g %11.3g %12.4g\n", r->scene, r->way, (int)r->steps,
               percentile(r, 50), percentile(r, 90), percentile(r, 99), percentile(r, 100), r->first_ms,
               r->steps * STEP_S / r->seconds, (double)r->stats.events_written / r->taken);
    }
}

/* Draws the share [%] of steps or packets within each latency, with a point every 2 %. */
static tides_status draw(const bench *b, const live_rows *all, tides_error *error) {
    enum { CURVES_MAX = CANVAS_SERIES, POINTS = 50 };
    double ms[CURVES_MAX][POINTS], percent[POINTS];
    cli_canvas canvas = bench_canvas(b, 1000, 720, "live runs, 346x260, a pose every millisecond; ROS 2, packets of 1 ms");
    plot_panel panel = {.left = 120, .top = 110, .right = 960, .bottom = 560, .y_high = 100, .y_linear = 1};
    plot_curve curves[CURVES_MAX];
    char labels[CURVES_MAX][96];
    const int32_t count = all->count < CURVES_MAX ? (int32_t)all->count : CURVES_MAX;
    panel.title = "latency of a step or packet", panel.x_label = "latency [ms]",
    panel.y_label = "steps or packets within it [%]";
    panel.x_low = INFINITY;
    for (int32_t i = 0; i < count; i++) {
        const live_row *r = &all->rows[i];
        for (int32_t k = 0; k < POINTS; k++) {
            percent[k] = 100.0 * (k + 1) / POINTS;
            ms[i][k] = percentile(r, percent[k]);
        }
        snprintf(labels[i], sizeof labels[i], "%s: %s", r->scene, r->way);
        curves[i] = (plot_curve){labels[i], ms[i], percent, POINTS, i};
        panel.x_low = fmin(panel.x_low, ms[i][0]);
        panel.x_high = fmax(panel.x_high, ms[i][POINTS - 1]);
    }
    plot_round_range(&panel.x_low, &panel.x_high);
    plot_axes(&canvas, &panel, 1);
    for (int32_t i = 0; i < count; i++) plot_draw(&canvas, &panel, &curves[i]);
    plot_legend(&canvas, panel.left, panel.bottom + 80, panel.right, curves, count);
    return bench_write_canvas(b, &canvas, "live", error);
}

tides_status bench_live(bench *b, const cli_list *scenes, tides_error *error) {
    const cli_list demo = {.items = {"demo"}, .count = 1}, *asked = scenes->count ? scenes : &demo;
    live_rows all = {.header = bench_header(b, "live")};
    tides_status status = all.header ? TIDES_OK : cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    for (size_t i = 0; i < asked->count && status == TIDES_OK; i++) status = measure_scene(b, asked->items[i], &all, error);
    if (status == TIDES_OK) status = measure_feed(b, &all, error);
    const bench_table table = {all.rows, all.count, cells_of};
    if (status == TIDES_OK) status = bench_write_table(b, "live", all.header, &table, error);
    if (status == TIDES_OK) status = draw(b, &all, error);
    if (status == TIDES_OK && !b->common->quiet && !b->common->json) print_table(&all);
    cJSON_Delete(all.header);
    free(all.rows);
    return status;
}
