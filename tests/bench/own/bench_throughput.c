/* own_bench throughput: the time of each stage, beside the least time on this machine. All image rules render frames of each
 * scene at two sizes, with rates and without. The limit takes turns with them: it renders the same image in plain C, compiled
 * for this machine. */
#include "bench_throughput.h"
#include "bench_targets.h"
#include "bench_worlds.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct image_size {
    int32_t width, height;
} image_size;
static const image_size sizes[] = {{346, 260}, {1280, 720}}, quick_sizes[] = {{96, 72}};

/* Greatest mean |difference| between the images of the limit and of inria: of L, and of L_dot as a share. They differ only by
 * splats that a threshold of alpha or of T drops in one of them. */
#define LIMIT_L_MOST 1e-3
#define LIMIT_L_DOT_MOST 0.02

/* -- rows ------------------------------------------------------------------------------------------------------------------ */

bench_stage *bench_stages_add(bench_stages *stages, const bench_scene *scene, const char *maker, const char *stage,
                              tides_error *error) {
    bench_stage *grown = realloc(stages->rows, (stages->count + 1) * sizeof *grown);
    if (!grown) {
        cli_error(error, TIDES_NO_MEMORY, "out of memory: rows of results");
        return NULL;
    }
    stages->rows = grown;
    bench_stage *row = &grown[stages->count++];
    *row = (bench_stage){.maker = maker, .stage = stage, .unit = "", .runs = 1};
    snprintf(row->scene, sizeof row->scene, "%s", scene->name);
    row->width = scene->intrinsics.width;
    row->height = scene->intrinsics.height;
    row->gaussians = (double)tides_scene_count(scene->scene);
    row->time_s = row->low_s = row->high_s = row->share = row->calls = row->items = row->pairs = row->bytes = NAN;
    row->limit_s = row->over_limit = row->over_limit_low = row->over_limit_high = NAN;
    row->over_inria = row->over_without_rates = NAN;
    return row;
}

static int32_t cells_of(const void *rows, size_t index, bench_cell cells[BENCH_CELLS_MAX]) {
    const bench_stage *r = (const bench_stage *)rows + index;
    const bench_cell made[] = {
        {"scene", r->scene, 0},
        {"width", NULL, r->width},
        {"height", NULL, r->height},
        {"gaussians", NULL, r->gaussians},
        {"maker", r->maker, 0},
        {"stage", r->stage, 0},
        {"runs", NULL, r->runs},
        {"time_s", NULL, r->time_s},
        {"time_low_s", NULL, r->low_s},
        {"time_high_s", NULL, r->high_s},
        {"share", NULL, r->share},
        {"calls", NULL, r->calls},
        {"items", NULL, r->items},
        {"unit", r->unit, 0},
        {"items_per_s", NULL, r->items / r->time_s},
        {"pairs_per_s", NULL, r->pairs / r->time_s},
        {"bytes_per_s", NULL, r->bytes / r->time_s},
        {"limit_s", NULL, r->limit_s},
        {"over_limit", NULL, r->over_limit},
        {"over_limit_low", NULL, r->over_limit_low},
        {"over_limit_high", NULL, r->over_limit_high},
        {"over_inria", NULL, r->over_inria},
        {"over_without_rates", NULL, r->over_without_rates},
    };
    memcpy(cells, made, sizeof made);
    return sizeof made / sizeof made[0];
}

/* -- scenes --------------------------------------------------------------------------------------------------------------- */

static tides_status check_limit(const bench *b, const bench_scene *scene, const frame_times *t, tides_error *error) {
    if (!t->limited) {
        bench_say(b, "%-9s no limit: %s", scene->name, t->why);
        return TIDES_OK;
    }
    if (t->L_apart <= LIMIT_L_MOST && t->L_dot_apart <= LIMIT_L_DOT_MOST) return TIDES_OK;
    return cli_error(error, TIDES_BAD_ARGUMENT, "%s: the limit's image isn't inria's: L is off by %.3g, L_dot by %.3g of it",
                     scene->name, t->L_apart, t->L_dot_apart);
}

static void say_frames(const bench *b, const bench_scene *scene, const frame_times *t) {
    for (int32_t maker = t->limited ? LIMIT : INRIA; maker < MAKERS; maker++) {
        double ms[STAGES], low, high;
        for (int k = 0; k < STAGES; k++) {
            double sorted[FRAME_ROUNDS];
            memcpy(sorted, t->s[maker][k], (size_t)t->rounds * sizeof *sorted);
            bench_quartiles(sorted, t->rounds, &low, &ms[k], &high);
            ms[k] *= 1e3;
        }
        bench_say(
            b, "%-9s %4dx%-4d %-9s %8.3f ms | sweep %7.3f project %7.3f sort %7.3f composite %7.3f transfer %6.3f other %6.3f",
            scene->name, (int)scene->intrinsics.width, (int)scene->intrinsics.height, frame_maker_name(maker), ms[STAGE_FRAME],
            ms[STAGE_SWEEP], ms[STAGE_PROJECT], ms[STAGE_SORT], ms[STAGE_COMPOSITE], ms[STAGE_TRANSFER], ms[STAGE_OTHER]);
    }
}

static tides_status measure_scene(bench *b, const char *name, bench_stages *stages, tides_error *error) {
    const image_size *all = b->quick ? quick_sizes : sizes;
    const size_t count = b->quick ? sizeof quick_sizes / sizeof *quick_sizes : sizeof sizes / sizeof *sizes;
    bench_scene scene;
    tides_status status = bench_world_make(name, b->quick, &scene, error);
    if (status != TIDES_OK) return status;
    bench_say(b, "%s: %s; %lld Gaussians", scene.name, scene.sentence, (long long)tides_scene_count(scene.scene));
    for (size_t i = 0; i < count && status == TIDES_OK; i++) {
        frame_times times;
        bench_resize(&scene, all[i].width, all[i].height);
        status = frames_measure(b, &scene, &times, error);
        if (status == TIDES_OK) say_frames(b, &scene, &times);
        if (status == TIDES_OK) status = check_limit(b, &scene, &times, error);
        if (status == TIDES_OK) status = bench_frame_rows(stages, &scene, &times, error);
        if (status == TIDES_OK && i == 0) status = bench_run_rows(b, stages, &scene, error);
    }
    if (status == TIDES_OK && !bench_header_scene(stages->header, &scene, NULL))
        status = cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    bench_scene_free(&scene);
    return status;
}

static int32_t is_world(const char *name) {
    for (const char *const *known = bench_world_names(); *known; known++)
        if (strcmp(*known, name) == 0) return 1;
    return 0;
}

static tides_status measure_scenes(bench *b, const cli_list *asked, bench_stages *stages, tides_error *error) {
    static const char *const quick_names[] = {"random", "demo", NULL};
    const char *const *names = b->quick ? quick_names : bench_world_names();
    tides_status status = TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && (asked->count ? i < asked->count : names[i] != NULL); i++) {
        const char *name = asked->count ? asked->items[i] : names[i];
        status = measure_scene(b, name, stages, error);
        if (status != TIDES_FILE_NOT_FOUND || !is_world(name)) continue;
        bench_say(b, "%s: skipped: %s", name, error->text);
        status = TIDES_OK;
    }
    return status;
}

/* -- results -------------------------------------------------------------------------------------------------------------- */

/* Writes nothing for NaN. */
static void put_number(const char *format, int width, double number) {
    char text[32] = "";
    if (isfinite(number)) snprintf(text, sizeof text, format, number);
    printf(" %*s", width, text);
}

static void print_table(const bench_stages *stages) {
    printf("%-9s %-9s %-9s %-10s %9s %6s %9s %9s %7s %9s %7s %7s\n", "scene", "size", "maker", "stage", "ms", "share",
           "M items/s", "Gpairs/s", "GB/s", "limit ms", "over it", "x inria");
    for (size_t i = 0; i < stages->count; i++) {
        const bench_stage *r = &stages->rows[i];
        if (strcmp(r->stage, "processor") == 0) continue;
        printf("%-9s %4dx%-4d %-9s %-10s %9.3f", r->scene, (int)r->width, (int)r->height, r->maker, r->stage, 1e3 * r->time_s);
        put_number("%.1f%%", 6, 100 * r->share);
        put_number("%.4g", 9, 1e-6 * r->items / r->time_s);
        put_number("%.3g", 9, 1e-9 * r->pairs / r->time_s);
        put_number("%.3g", 7, 1e-9 * r->bytes / r->time_s);
        put_number("%.3f", 9, 1e3 * r->limit_s);
        put_number("%.2f", 7, r->over_limit);
        put_number("%.2f", 7, r->over_inria);
        putchar('\n');
    }
}

tides_status bench_throughput(bench *b, const cli_list *scenes, tides_error *error) {
    bench_stages stages = {.header = bench_header(b, "throughput")};
    stages.targets = stages.header ? cJSON_AddArrayToObject(stages.header, "targets") : NULL;
    tides_status status = stages.targets ? measure_scenes(b, scenes, &stages, error)
                                         : cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    if (status == TIDES_OK) status = bench_sink_rows(b, &stages, error);
    const bench_table table = {stages.rows, stages.count, cells_of};
    if (status == TIDES_OK) status = bench_write_table(b, "throughput", stages.header, &table, error);
    if (status == TIDES_OK) status = bench_figure_stages(b, &stages, error);
    if (status == TIDES_OK && !b->common->quiet && !b->common->json) {
        print_table(&stages);
        bench_print_targets(stages.targets, stdout);
    }
    cJSON_Delete(stages.header);
    free(stages.rows);
    return status;
}
