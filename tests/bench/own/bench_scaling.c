/* own_bench scaling: growth of cost with the size of a scene. Points are measured in processes of their own. Exponents are
 * fitted to processor time, which other load hardly affects, and targets are about exponents and about shares of time. */
#include "bench_scaling.h"
#include "bench_stability.h"
#include "bench_targets.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LIMIT_S 900.0 /* longest time of a point [s] */
enum { STARTS = 4 };  /* starts with cached kernels; the first may have to fill the cache, and the least time counts */

/* -- fits ----------------------------------------------------------------------------------------------------------------- */

/* Slope of ln cost over ln x, by least squares, of the points from `first` on; NaN with fewer than two. */
static double slope_of(const scaling_result *points, int32_t first, int32_t count) {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (int32_t i = first; i < count; i++) {
        if (!(points[i].x > 0) || !(points[i].processor_s > 0)) continue;
        const double a = log(points[i].x), c = log(points[i].processor_s);
        n++, x += a, y += c, xx += a * a, xy += a * c;
    }
    const double width = n * xx - x * x;
    return n > 1 && width > 0 ? (n * xy - x * y) / width : NAN;
}

static void fit(scaling_line *line) {
    if (line->axis->work == WORK_START) return;
    line->exponent = slope_of(line->points, 0, line->count);
    line->exponent_end = slope_of(line->points, line->count > 3 ? line->count - 3 : 0, line->count);
}

/* -- points --------------------------------------------------------------------------------------------------------------- */

/* The work of a child process. */
typedef struct errand {
    bench *b;
    const scaling_axis *axis;
    double x;
} errand;

static void do_errand(void *user, void *result) {
    const errand *e = user;
    scaling_measure(e->b, e->axis, e->x, result);
}

static tides_status measure_point(bench *b, const scaling_axis *axis, double x, scaling_result *r, tides_error *error) {
    errand e = {b, axis, x};
    bench_ending ending;
    tides_status status = bench_child(b, do_errand, &e, r, sizeof *r, LIMIT_S, &ending, error);
    if (status != TIDES_OK) return status;
    if (ending.how == BENCH_STOPPED) return cli_error(error, TIDES_CANCELLED, "stopped on request");
    if (ending.how == BENCH_LATE)
        return cli_error(error, TIDES_CANCELLED, "%s %g: took longer than %g s", axis->name, x, LIMIT_S);
    if (ending.how != BENCH_RAN) {
        char death[BENCH_DEATH];
        bench_say_death(ending.died, death);
        return cli_error(error, TIDES_BAD_ARGUMENT, "%s %g: %s", axis->name, x, death);
    }
    if (r->failed) return cli_error(error, TIDES_BAD_ARGUMENT, "%s %g: %s", axis->name, x, r->said);
    bench_say(b, "%-13s %9.6g %-14s %9.4g s %9.4g s of processors  %9.6g events %8.4g renders  %6.4g MB", axis->name, r->x,
              axis->unit, r->time_s, r->processor_s, (double)r->stats.events, r->stats.renders_full_frame_equivalent,
              1e-6 * (double)r->peak_bytes);
    return status;
}

static int32_t wanted(const bench *b, const scaling_axis *axis, int32_t i) {
    if (i >= POINTS_MAX || (b->quick && i >= axis->in_quick)) return 0;
    if (i > 0 && !(axis->points[i] > 0)) return 0;
    return strcmp(axis->name, "threads") != 0 || axis->points[i] <= (double)sysconf(_SC_NPROCESSORS_ONLN);
}

static tides_status measure_line(bench *b, const scaling_axis *axis, scaling_line *line, tides_error *error) {
    tides_status status = TIDES_OK;
    *line = (scaling_line){.axis = axis, .exponent = NAN, .exponent_end = NAN};
    for (int32_t i = 0; wanted(b, axis, i) && status == TIDES_OK; i++, line->count++)
        status = measure_point(b, axis, axis->points[i], &line->points[line->count], error);
    for (int32_t i = 1; axis->work == WORK_START && i < STARTS && line->count && status == TIDES_OK; i++) {
        scaling_result again;
        status = measure_point(b, axis, axis->points[0], &again, error);
        if (status == TIDES_OK && again.time_s < line->points[0].time_s) line->points[0] = again;
    }
    fit(line);
    return status;
}

/* -- targets -------------------------------------------------------------------------------------------------------------- */

static const scaling_line *find_line(const scaling_line *lines, size_t count, const char *name) {
    for (size_t i = 0; i < count; i++)
        if (strcmp(lines[i].axis->name, name) == 0) return &lines[i];
    return NULL;
}

/* Returns NULL if there is no such point. */
static const scaling_result *find_point(const scaling_line *line, double x) {
    for (int32_t i = 0; line && i < line->count; i++)
        if (line->points[i].x == x) return &line->points[i];
    return NULL;
}

enum { OF_PROCESSOR, OF_WALL, OF_RENDERS };

static double quantity(const scaling_result *r, int32_t what) {
    if (what == OF_RENDERS) return r->stats.renders_full_frame_equivalent;
    return what == OF_PROCESSOR ? r->processor_s : r->time_s;
}

/* A target for the ratio of two points. */
typedef struct share_aim {
    const char *name, *axis, *subject, *unit;
    double of, over, bound;
    int32_t what, least;
} share_aim;
static const share_aim share_aims[] = {
    {"run in which 2 % of the view moves, over all", "moving share", "patches", "times", 2, 100, 0.05, OF_PROCESSOR, 0},
    {"static run, over one in which all moves", "moving share", "patches", "times", 0, 100, 0.005, OF_PROCESSOR, 0},
    {"renders of a dense plane, over a quarter of it", "coplanar", "12 and 3 splats a pixel", "times", 12, 3, 1.5, OF_RENDERS,
     0},
    {"two threads against one", "threads", "random run, wall time", "times", 1, 2, 1.8, OF_WALL, 1},
};

/* The gain of a second thread, from processor time, which other load hardly affects. Host and device wait for each other. */
static const char *host_note(const scaling_result *one, char *note, size_t size) {
    const double device = one->processor_s - one->host_s;
    snprintf(note, size, "(%.3g by processors' time: of %.3g s %.3g are the host's)",
             one->processor_s / (one->host_s + 0.5 * device), one->processor_s, one->host_s);
    return note;
}

static tides_status add_shares(cJSON *targets, const scaling_line *lines, size_t count, tides_error *error) {
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < sizeof share_aims / sizeof *share_aims && status == TIDES_OK; i++) {
        const share_aim *aim = &share_aims[i];
        const scaling_line *line = find_line(lines, count, aim->axis);
        const scaling_result *of = find_point(line, aim->of), *over = find_point(line, aim->over);
        if (!of || !over) continue;
        char note[80];
        const bench_target target = {.name = aim->name,
                                     .subject = aim->subject,
                                     .unit = aim->unit,
                                     .note = aim->what == OF_WALL ? host_note(of, note, sizeof note) : NULL,
                                     .measured = quantity(of, aim->what) / quantity(over, aim->what),
                                     .bound = aim->bound,
                                     .least = aim->least};
        status = bench_add_target(targets, &target, error);
    }
    return status;
}

/* Other load hardly affects this number. */
static const char *processor_note(const scaling_result *r, char *note, size_t size) {
    snprintf(note, size, "(%.3g s of processors)", r->processor_s);
    return note;
}

static tides_status add_special(cJSON *targets, const scaling_line *lines, size_t count, tides_error *error) {
    tides_status status = TIDES_OK;
    char note[64];
    const scaling_line *line = find_line(lines, count, "out of view");
    const scaling_result *alone = find_point(line, 0), *all = find_point(line, 900000);
    bench_target target = {"share of a run that 90 % out of view cost", "a million Gaussians", "", NULL, 0, 0.05, 0};
    if (alone && all) target.measured = 1 - alone->processor_s / all->processor_s;
    if (alone && all) status = bench_add_target(targets, &target, error);
    const scaling_line *starts = find_line(lines, count, "start");
    const scaling_result *cached = find_point(starts, 1), *fresh = find_point(starts, 2);
    target = (bench_target){"start to the first event, kernels cached", "2 000 Gaussians", "s", NULL, 0, 0.3, 0};
    if (cached) target.measured = cached->time_s, target.note = processor_note(cached, note, sizeof note);
    if (cached && status == TIDES_OK) status = bench_add_target(targets, &target, error);
    target.name = "start to the first event, no kernel cached", target.bound = 5;
    if (fresh) target.measured = fresh->time_s, target.note = processor_note(fresh, note, sizeof note);
    if (fresh && status == TIDES_OK) status = bench_add_target(targets, &target, error);
    const scaling_result *million = find_point(find_line(lines, count, "memory"), 1e6);
    target = (bench_target){"memory of a million Gaussians of SH 3", "1280x720", "GB", NULL, 0, 1.5, 0};
    if (million) target.measured = 1e-9 * (double)million->peak_bytes;
    return million && status == TIDES_OK ? bench_add_target(targets, &target, error) : status;
}

static tides_status add_targets(cJSON *targets, const scaling_line *lines, size_t count, tides_error *error) {
    tides_status status = TIDES_OK;
    char note[64];
    for (size_t i = 0; i < count && status == TIDES_OK; i++) {
        const scaling_axis *axis = lines[i].axis;
        if (!(axis->most > 0)) continue;
        note[0] = 0;
        if (isfinite(lines[i].exponent_end)) snprintf(note, sizeof note, "(%.3g at the last points)", lines[i].exponent_end);
        const bench_target target = {.name = "exponent of cost",
                                     .subject = axis->name,
                                     .unit = "",
                                     .note = note,
                                     .measured = lines[i].exponent,
                                     .bound = axis->most};
        status = bench_add_target(targets, &target, error);
    }
    if (status == TIDES_OK) status = add_shares(targets, lines, count, error);
    return status == TIDES_OK ? add_special(targets, lines, count, error) : status;
}

/* -- results -------------------------------------------------------------------------------------------------------------- */

typedef struct row {
    const scaling_line *line;
    const scaling_result *point;
} row;

static int32_t cells_of(const void *rows, size_t index, bench_cell cells[BENCH_CELLS_MAX]) {
    const row *r = (const row *)rows + index;
    const tides_render_stats *render = &r->point->stats.render;
    const bench_cell made[] = {
        {"axis", r->line->axis->name, 0},
        {"x", NULL, r->point->x},
        {"unit", r->line->axis->unit, 0},
        {"what", r->line->axis->sentence, 0},
        {"runs", NULL, r->point->runs},
        {"time_s", NULL, r->point->time_s},
        {"processor_time_s", NULL, r->point->processor_s},
        {"host_time_s", NULL, r->point->host_s},
        {"exponent", NULL, r->line->exponent},
        {"exponent_at_end", NULL, r->line->exponent_end},
        {"events", NULL, (double)r->point->stats.events},
        {"renders", NULL, r->point->stats.renders_full_frame_equivalent},
        {"gaussians_projected", NULL, (double)render->gaussians_projected},
        {"pairs_evaluated", NULL, (double)render->pairs_evaluated},
        {"peak_memory_mb", NULL, 1e-6 * (double)r->point->peak_bytes},
    };
    memcpy(cells, made, sizeof made);
    return sizeof made / sizeof made[0];
}

static void print_table(const row *rows, size_t count) {
    printf("%-13s %10s %-14s %10s %12s %9s %9s %9s\n", "axis", "x", "unit", "time s", "processor s", "exponent", "at end",
           "MB");
    for (size_t i = 0; i < count; i++) {
        const scaling_result *p = rows[i].point;
        printf("%-13s %10.6g %-14s %10.4g %12.4g %9.3f %9.3f %9.4g\n", rows[i].line->axis->name, p->x, rows[i].line->axis->unit,
               p->time_s, p->processor_s, rows[i].line->exponent, rows[i].line->exponent_end, 1e-6 * (double)p->peak_bytes);
    }
}

static tides_status write_results(bench *b, const scaling_line *lines, size_t count, tides_error *error) {
    row rows[AXES_MAX * POINTS_MAX];
    size_t rows_count = 0;
    for (size_t i = 0; i < count; i++)
        for (int32_t k = 0; k < lines[i].count; k++) rows[rows_count++] = (row){&lines[i], &lines[i].points[k]};
    cJSON *header = bench_header(b, "scaling"), *targets = header ? cJSON_AddArrayToObject(header, "targets") : NULL;
    tides_status status =
        targets ? add_targets(targets, lines, count, error) : cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    const bench_table table = {rows, rows_count, cells_of};
    if (status == TIDES_OK) status = bench_write_table(b, "scaling", header, &table, error);
    if (status == TIDES_OK) status = scaling_figure(b, lines, count, error);
    if (status == TIDES_OK && !b->common->quiet && !b->common->json) {
        print_table(rows, rows_count);
        bench_print_targets(targets, stdout);
    }
    cJSON_Delete(header);
    return status;
}

/* Adds the device to the header. */
typedef struct described {
    tides_device_info info;
    tides_error error;
} described;

static void describe_device(void *user, void *result) {
    const bench *b = user;
    described *d = result;
    tides_device *device = NULL;
    *d = (described){.error = {TIDES_OK, ""}};
    if (tides_device_open(b->common->device, &device, &d->error) == TIDES_OK) tides_device_describe(device, &d->info);
    tides_device_close(device);
}

/* A child process asks for the device, too, because a process that opened a device can't start children that open one. */
static tides_status ask_device(bench *b, tides_error *error) {
    described d;
    bench_ending ending;
    tides_status status = bench_child(b, describe_device, b, &d, sizeof d, LIMIT_S, &ending, error);
    if (status != TIDES_OK) return status;
    if (ending.how != BENCH_RAN)
        return cli_error(error, TIDES_NO_DEVICE, "the process that asks for the device didn't end well");
    b->info = d.info;
    if (d.error.status != TIDES_OK) *error = d.error;
    return d.error.status;
}

static int32_t asked(const cli_list *names, const char *name) {
    for (size_t i = 0; i < names->count; i++)
        if (strcmp(names->items[i], name) == 0) return 1;
    return names->count == 0;
}

const char *const *scaling_names(void) {
    static const char *names[AXES_MAX + 1];
    size_t count;
    const scaling_axis *axes = scaling_axes(&count);
    for (size_t i = 0; i < count; i++) names[i] = axes[i].name;
    return names;
}

tides_status bench_scaling(bench *b, const cli_list *names, tides_error *error) {
    size_t count, measured = 0;
    const scaling_axis *axes = scaling_axes(&count);
    scaling_line lines[AXES_MAX];
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < count && status == TIDES_OK; i++)
        if (asked(names, axes[i].name) && wanted(b, &axes[i], 0)) status = measure_line(b, &axes[i], &lines[measured++], error);
    if (status == TIDES_OK) status = ask_device(b, error);
    return status == TIDES_OK ? write_results(b, lines, measured, error) : status;
}
