/* own_bench image: the value and the cost of each measure that makes 3DGS continuous in time. Each image is compared with its
 * own exact events: at equal steps, where a jump misplaces events, and under error control, where it costs renders. An image is
 * one line of the table.
 *
 *   smooth            all measures, as by default
 *   hard_*            smooth without one of them
 *   taper_* .. fade_* smooth with another size of one of them
 *   only_*            inria with one of them
 *   inria             none
 *
 * The size of a jump is J = |L1 - L0 - h (L0_dot + L1_dot) / 2| between neighbouring samples. The share of it that a measure
 * removes is the share that its absence adds to smooth. */
#include "bench_image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TOLERANCE 0.003
#define FIXED_RATE 8000.0 /* [1/s] */
#define CUT (1.0 / 255)

typedef struct variant {
    const char *name;
    tides_smoothing smoothing; /* 0: the default, -1: off */
    int32_t quick, none;       /* quick 1: measured with --quick too; none 1: only the measures that are set are on */
} variant;

enum { OFF = -1, ON = 1 };

static const variant variants[] = {
    {.name = "smooth", .quick = 1},
    {.name = "hard_cutoff", .smoothing.taper_begin = OFF, .quick = 1},
    {.name = "hard_stop", .smoothing.stop_change = OFF},
    {.name = "hard_near", .smoothing.near_fade = OFF},
    {.name = "hard_extents", .smoothing.ellipses = OFF},
    {.name = "hard_order", .smoothing.soft_depth = OFF, .quick = 1},
    {.name = "only_taper", .smoothing = {.taper_begin = 0.1 * CUT, .ellipses = ON}, .none = 1},
    {.name = "only_soft_order", .smoothing.soft_depth = 1e-4, .none = 1},
    {.name = "taper_0.03_to_1", .smoothing.taper_begin = 0.03 * CUT},
    {.name = "taper_0.3_to_1", .smoothing.taper_begin = 0.3 * CUT},
    {.name = "taper_0.1_to_1.9", .smoothing.taper_end = 1.9 * CUT}, /* passes as much light as the cut at 1 */
    {.name = "taper_0.1_to_2", .smoothing.taper_end = 2 * CUT},
    {.name = "taper_1_to_2", .smoothing = {.taper_begin = CUT, .taper_end = 2 * CUT}},
    {.name = "delta_1e-5", .smoothing.soft_depth = 1e-5},
    {.name = "delta_3e-5", .smoothing.soft_depth = 3e-5},
    {.name = "delta_3e-4", .smoothing.soft_depth = 3e-4},
    {.name = "delta_1e-3", .smoothing.soft_depth = 1e-3},
    {.name = "stop_1e-4", .smoothing.stop_change = 1e-4},
    {.name = "stop_1e-6", .smoothing.stop_change = 1e-6},
    {.name = "inria", .none = 1, .quick = 1},
};
enum { VARIANTS = sizeof variants / sizeof variants[0] };

static void choose(double *value, double wanted, double off, int32_t none) {
    if (wanted < 0 || (none && wanted == 0)) *value = off;
    if (wanted > 0) *value = wanted;
}

/* An image without any measure gets the rules of inria, whose limits of the Jacobian differ off the centre. */
static tides_image_params image_of(const variant *v, const tides_image_params *base) {
    tides_image_params image = *base;
    tides_smoothing *s = &image.smoothing;
    const tides_smoothing *w = &v->smoothing;
    choose(&s->taper_end, w->taper_end, s->taper_end, v->none);
    choose(&s->taper_begin, w->taper_begin, s->taper_end, v->none);
    choose(&s->stop_change, w->stop_change, 0, v->none);
    choose(&s->near_fade, w->near_fade, 1, v->none);
    choose(&s->soft_depth, w->soft_depth, 0, v->none);
    if (w->ellipses < 0 || (v->none && w->ellipses == 0)) s->ellipses = 0;
    return image;
}

/* Results of an image in a scene. */
typedef struct image_facts {
    char scene[64];
    const char *name;
    bench_jumps jumps;
    double frame_s;           /* run time of a frame */
    size_t equal, controlled; /* numbers of rows */
} image_facts;

typedef struct job {
    bench_rows rows;
    image_facts *facts;
    size_t count;
    cJSON *header;
} job;

static tides_status measure(bench *b, const bench_scene *scene, int32_t mode, bench_row *row, tides_error *error) {
    tides_stepping stepping;
    tides_stepping_defaults(&stepping);
    const int32_t fixed = mode == TIDES_STEPPING_FIXED;
    stepping.mode = mode;
    stepping.model = TIDES_MODEL_HERMITE;
    stepping.local = !fixed;
    stepping.step_s = fixed ? 1 / FIXED_RATE : scene->macro_step_s;
    stepping.min_step_s = 1e-6;
    stepping.tolerance = TOLERANCE;
    bench_choose_parts(&stepping, 0);
    row->method = fixed ? "hermite" : "error";
    row->unit = fixed ? "frames/s" : "tolerance";
    row->setting = fixed ? FIXED_RATE : TOLERANCE;
    row->frames = fixed ? round(FIXED_RATE * (scene->stop - scene->start)) + 1 : 0;
    return bench_measure(b, scene, TIDES_RULES_SMOOTH, &scene->sensor, &stepping, row, error);
}

/* Makes both runs of an image. The first call makes their exact stream too. */
static tides_status measure_image(bench *b, bench_scene *scene, job *j, image_facts *facts, int32_t again, tides_error *error) {
    static const int32_t modes[] = {TIDES_STEPPING_FIXED, TIDES_STEPPING_ERROR};
    tides_status status = TIDES_OK;
    if (!again) status = bench_find_truth(b, scene, TIDES_RULES_SMOOTH, error);
    if (!again && status == TIDES_OK) status = bench_find_jumps(b, scene, &scene->image, &facts->jumps, error);
    for (size_t i = 0; i < 2 && status == TIDES_OK; i++) {
        size_t *at = i == 0 ? &facts->equal : &facts->controlled;
        if (!again) {
            if (!bench_rows_add(&j->rows, error)) return TIDES_NO_MEMORY;
            *at = j->rows.count - 1;
        }
        status = measure(b, scene, modes[i], &j->rows.rows[*at], error);
    }
    return status;
}

/* Times frames of the variants in turns, and writes the results into their facts. */
static tides_status measure_costs(bench *b, const bench_scene *scene, const tides_image_params *base, image_facts *facts,
                                  tides_error *error) {
    tides_image_params images[VARIANTS];
    double seconds[VARIANTS];
    size_t count = 0;
    for (size_t i = 0; i < VARIANTS; i++)
        if (!b->quick || variants[i].quick) images[count++] = image_of(&variants[i], base);
    tides_status status = bench_frame_costs(b, scene, images, count, seconds, error);
    for (size_t i = 0; i < count && status == TIDES_OK; i++) facts[i].frame_s = seconds[i];
    return status;
}

static tides_status visit(void *user, bench *b, bench_scene *scene, tides_error *error) {
    job *j = user;
    const tides_image_params base = scene->image;
    image_facts *grown = realloc(j->facts, (j->count + VARIANTS) * sizeof *grown);
    if (!grown) return cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    j->facts = grown;
    const size_t first = j->count;
    tides_status status = TIDES_OK;
    for (int32_t again = 0; again < 2; again++) {
        size_t at = first;
        for (size_t i = 0; i < VARIANTS && status == TIDES_OK; i++) {
            if (b->quick && !variants[i].quick) continue;
            image_facts *facts = &j->facts[at++];
            if (!again) {
                memset(facts, 0, sizeof *facts);
                snprintf(facts->scene, sizeof facts->scene, "%s", scene->name);
                facts->name = variants[i].name;
                j->count++;
            }
            scene->image = image_of(&variants[i], &base);
            scene->image_name = facts->name;
            status = measure_image(b, scene, j, facts, again, error);
        }
    }
    if (status == TIDES_OK) status = measure_costs(b, scene, &base, &j->facts[first], error);
    if (status == TIDES_OK && !bench_header_scene(j->header, scene, NULL))
        status = cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    return status;
}

/* -- results ------------------------------------------------------------------------------------------------------------- */

static int32_t add_facts(cJSON *list, const image_facts *f) {
    const bench_jumps *jumps = &f->jumps;
    cJSON *json = cJSON_CreateObject();
    if (!cJSON_AddItemToArray(list, json)) return 0;
    return cJSON_AddStringToObject(json, "scene", f->scene) && cJSON_AddStringToObject(json, "image", f->name) &&
           cJSON_AddNumberToObject(json, "jumps_per_pixel_s", jumps->per_pixel_s) &&
           cJSON_AddNumberToObject(json, "jump_sum_per_pixel_s", jumps->sum_per_s) &&
           cJSON_AddNumberToObject(json, "largest_jump", jumps->largest) &&
           (isfinite(jumps->psnr) ? cJSON_AddNumberToObject(json, "psnr_db", jumps->psnr) != NULL
                                  : cJSON_AddNullToObject(json, "psnr_db") != NULL) &&
           cJSON_AddNumberToObject(json, "largest_difference", jumps->furthest) &&
           cJSON_AddNumberToObject(json, "largest_difference_x", jumps->x) &&
           cJSON_AddNumberToObject(json, "largest_difference_y", jumps->y) &&
           cJSON_AddNumberToObject(json, "largest_difference_time_s", jumps->time) &&
           cJSON_AddNumberToObject(json, "frame_time_s", f->frame_s);
}

static void print_table(const job *j) {
    printf("%-9s %-16s %8s | %-30s | %-31s | %-30s | %s\n", "", "", "", "equal steps, 8000 frames/s", "error control, 0.003",
           "jumps of L above 0.001", "colours against inria");
    printf("%-9s %-16s %8s | %8s %8s %12s | %8s %8s %13s | %9s %10s %9s | %7s %8s\n", "scene", "image", "ms/frame", "median",
           "p95 us", "mismatch %", "renders", "p95 us", "mismatch %", "1/(px s)", "sum/(px s)", "largest", "PSNR dB",
           "largest");
    for (size_t i = 0; i < j->count; i++) {
        const image_facts *f = &j->facts[i];
        const bench_row *equal = &j->rows.rows[f->equal], *controlled = &j->rows.rows[f->controlled];
        printf("%-9s %-16s %8.3g | %8.3g %8.3g %12.3g | %8.4g %8.3g %13.3g | %9.3g %10.3g %9.3g | %7.3g %8.3g at (%d, %d)\n",
               f->scene, f->name, 1e3 * f->frame_s, equal->match.dt_median_us, equal->match.dt_p95_us,
               equal->match.mismatch_percent, controlled->stats.renders_full_frame_equivalent, controlled->match.dt_p95_us,
               controlled->match.mismatch_percent, f->jumps.per_pixel_s, f->jumps.sum_per_s, f->jumps.largest, f->jumps.psnr,
               f->jumps.furthest, (int)f->jumps.x, (int)f->jumps.y);
    }
}

tides_status bench_image(bench *b, const cli_list *scenes, tides_error *error) {
    static const cli_list trained = {.items = {"trained", "playbot"}, .count = 2};
    job j = {.header = bench_header(b, "image")};
    if (!j.header) return cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    b->float_truth = 1;
    tides_status status = bench_each_scene(b, scenes->count ? scenes : &trained, visit, &j, error);
    cJSON *list = cJSON_AddArrayToObject(j.header, "images");
    int32_t ok = list != NULL;
    for (size_t i = 0; ok && i < j.count; i++) ok = add_facts(list, &j.facts[i]);
    if (status == TIDES_OK && !ok) status = cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    if (status == TIDES_OK) status = bench_write(b, "image", j.header, &j.rows, error);
    if (status == TIDES_OK && !b->common->quiet && !b->common->json) print_table(&j);
    cJSON_Delete(j.header);
    free(j.facts);
    free(j.rows.rows);
    return status;
}
