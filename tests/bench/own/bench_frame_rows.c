/* Makes rows from the times of frames: medians over rounds, rates, and ratios of each round. It makes the targets for frames
 * too. */
#include "bench_targets.h"
#include "bench_throughput.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* -- ratios --------------------------------------------------------------------------------------------------------------- */

/* The ratio of a to b is taken in each round; results are its median and quartiles. */
static void ratio_of(const double *a, const double *b, int32_t rounds, double *low, double *median, double *high) {
    double ratio[FRAME_ROUNDS];
    for (int32_t i = 0; i < rounds; i++) ratio[i] = a[i] / b[i];
    bench_quartiles(ratio, rounds, low, median, high);
}

static double median_ratio(const double *a, const double *b, int32_t rounds) {
    double low, median, high;
    ratio_of(a, b, rounds, &low, &median, &high);
    return median;
}

static double median_of(const double *values, int32_t rounds) {
    double sorted[FRAME_ROUNDS], low, median, high;
    memcpy(sorted, values, (size_t)rounds * sizeof *sorted);
    bench_quartiles(sorted, rounds, &low, &median, &high);
    return median;
}

/* -- the work of a stage ----------------------------------------------------------------------------------------------- */

enum { GAUSSIAN = 64, RECORD = 64, KEY = 8, BOX = 16 }; /* bytes */

/* The work of a stage in one frame: its number of items, and the bytes that it must read and write at least. */
static void count_renderer(const bench_scene *scene, const frame_times *t, int32_t maker, frame_stage stage, bench_stage *row) {
    const tides_render_stats *d = &t->done[maker];
    const double frames = (double)t->frames, projected = (double)d->gaussians_projected / frames;
    const double listed = projected - (double)d->gaussians_culled / frames, pairs = (double)d->pairs_evaluated / frames;
    const double pixels = (double)scene->intrinsics.width * scene->intrinsics.height, planes = maker & 1 ? 1 : 2;
    const int32_t degree = tides_scene_sh_degree(scene->scene);
    row->unit = "frame";
    row->calls = row->items = 1;
    if (stage == STAGE_SWEEP) {
        row->calls = (double)d->sweeps / frames;
        row->items = row->gaussians, row->unit = "Gaussian", row->bytes = row->items * (GAUSSIAN + BOX);
    } else if (stage == STAGE_PROJECT) {
        row->calls = (double)d->tile_jobs / frames;
        row->items = projected, row->unit = "Gaussian in a tile";
        row->bytes = projected * (GAUSSIAN + 12.0 * (degree + 1) * (degree + 1)) + listed * RECORD;
    } else if (stage == STAGE_SORT) {
        row->calls = (double)d->tile_jobs / frames;
        row->items = listed, row->unit = "splat in a tile", row->bytes = 2 * KEY * listed;
    } else if (stage == STAGE_COMPOSITE) {
        row->calls = (double)d->blocks / frames;
        row->items = row->pairs = pairs, row->unit = "pair", row->bytes = pairs / 16 * RECORD + pixels * planes * 4;
    } else if (stage == STAGE_TRANSFER) {
        row->items = pixels, row->unit = "pixel", row->bytes = pixels * planes * (4 + 8);
    }
}

static void count_limit(const bench_scene *scene, const limit_counts *c, int32_t maker, frame_stage stage, bench_stage *row) {
    const double pixels = (double)scene->intrinsics.width * scene->intrinsics.height, planes = maker & 1 ? 1 : 2;
    const int32_t degree = tides_scene_sh_degree(scene->scene);
    row->unit = "frame";
    row->calls = row->items = 1;
    if (stage == STAGE_PROJECT) {
        row->items = (double)c->gaussians, row->unit = "Gaussian";
        row->bytes = row->items * (GAUSSIAN + 12.0 * (degree + 1) * (degree + 1)) + (double)c->splats * RECORD;
    } else if (stage == STAGE_SORT) {
        row->items = (double)c->splats, row->unit = "splat", row->bytes = 2 * KEY * row->items;
    } else if (stage == STAGE_SWEEP) {
        row->items = (double)c->entries, row->unit = "splat in a tile";
        row->bytes = 2 * RECORD * (double)c->splats + 6 * row->items;
    } else if (stage == STAGE_COMPOSITE) {
        row->items = row->pairs = (double)c->pairs, row->unit = "pair";
        row->bytes = row->pairs / 16 * RECORD + pixels * planes * 4;
    }
}

/* -- rows ----------------------------------------------------------------------------------------------------------------- */

static tides_status add_row(bench_stages *stages, const bench_scene *scene, const frame_times *t, int32_t maker,
                            frame_stage stage, tides_error *error) {
    const double *s = t->s[maker][stage];
    const char *name = maker < INRIA && stage == STAGE_SWEEP ? "lists" : frame_stage_name(stage);
    bench_stage *row = bench_stages_add(stages, scene, frame_maker_name(maker), name, error);
    if (!row) return TIDES_NO_MEMORY;
    double sorted[FRAME_ROUNDS];
    memcpy(sorted, s, (size_t)t->rounds * sizeof *sorted);
    bench_quartiles(sorted, t->rounds, &row->low_s, &row->time_s, &row->high_s);
    row->runs = (int32_t)t->frames;
    row->of_frame = 1;
    row->share = median_ratio(s, t->s[maker][STAGE_FRAME], t->rounds);
    if (maker < INRIA)
        count_limit(scene, &t->counted[maker - LIMIT], maker, stage, row);
    else
        count_renderer(scene, t, maker, stage, row);
    const int32_t ours = maker == INRIA || maker == INRIA + 1, with_rates = maker & ~1;
    const double *floor_s = t->s[LIMIT + (maker & 1)][stage];
    if (ours && t->limited && stage != STAGE_MOTION && stage != STAGE_TRANSFER && stage != STAGE_OTHER) {
        row->limit_s = median_of(floor_s, t->rounds);
        ratio_of(s, floor_s, t->rounds, &row->over_limit_low, &row->over_limit, &row->over_limit_high);
    }
    if (maker >= INRIA) row->over_inria = median_ratio(s, t->s[INRIA + (maker & 1)][stage], t->rounds);
    if (!(maker & 1)) row->over_without_rates = median_ratio(s, t->s[with_rates + 1][stage], t->rounds);
    return TIDES_OK;
}

/* -- targets (docs/DESIGN.md, section 3.5) -------------------------------------------------------------------------------- */

typedef struct frame_aim {
    const char *name;
    frame_maker of, over;
    frame_stage stage;
    double most;
} frame_aim;
static const frame_aim aims[] = {
    {"frame under inria over the limit", INRIA, LIMIT, STAGE_FRAME, 1.5},
    {"composite under inria over the limit", INRIA, LIMIT, STAGE_COMPOSITE, 1.2},
    {"frame under smooth over inria", SMOOTH, INRIA, STAGE_FRAME, 1.5},
    {"frame with L_dot over one without, smooth", SMOOTH, SMOOTH + 1, STAGE_FRAME, 1.35},
};
enum { AIMS = sizeof aims / sizeof aims[0] };
#define LARGE_SCENE 400000     /* a scene of so many Gaussians has the following bounds */
#define NS_PER_PROJECTION 60.0 /* [ns] of a (Gaussian, tile) pair */
#define NS_PER_PAIR 0.6        /* [ns] */

static tides_status add_costs(bench_stages *stages, const bench_scene *scene, const frame_times *t, const char *subject,
                              tides_error *error) {
    const tides_render_stats *d = &t->done[SMOOTH];
    const double frames = (double)t->frames;
    bench_target target = {"a projected Gaussian of a large scene, smooth", subject, "ns", NULL, 0, NS_PER_PROJECTION, 0};
    target.measured = 1e9 * median_of(t->s[SMOOTH][STAGE_PROJECT], t->rounds) * frames / (double)d->gaussians_projected;
    if (tides_scene_count(scene->scene) < LARGE_SCENE) return TIDES_OK;
    tides_status status = bench_add_target(stages->targets, &target, error);
    target.name = "a pair of a large scene, smooth";
    target.bound = NS_PER_PAIR;
    target.measured = 1e9 * median_of(t->s[SMOOTH][STAGE_COMPOSITE], t->rounds) * frames / (double)d->pairs_evaluated;
    return status == TIDES_OK ? bench_add_target(stages->targets, &target, error) : status;
}

/* The note has the processor time of both: other load hardly affects it. */
static tides_status add_targets(bench_stages *stages, const bench_scene *scene, const frame_times *t, tides_error *error) {
    char subject[128], note[64];
    tides_status status = TIDES_OK;
    snprintf(subject, sizeof subject, "%s %dx%d", scene->name, (int)scene->intrinsics.width, (int)scene->intrinsics.height);
    for (int k = 0; k < AIMS && status == TIDES_OK; k++) {
        const frame_aim *aim = &aims[k];
        bench_target target = {aim->name, subject, "times", NULL, NAN, aim->most, 0};
        if (aim->over == LIMIT && !t->limited) {
            target.note = t->why;
        } else {
            target.measured = median_ratio(t->s[aim->of][aim->stage], t->s[aim->over][aim->stage], t->rounds);
            snprintf(note, sizeof note, "(%.3g in processor time)",
                     median_ratio(t->s[aim->of][STAGE_PROCESSOR], t->s[aim->over][STAGE_PROCESSOR], t->rounds));
            if (aim->stage == STAGE_FRAME) target.note = note;
        }
        status = bench_add_target(stages->targets, &target, error);
    }
    return status == TIDES_OK ? add_costs(stages, scene, t, subject, error) : status;
}

tides_status bench_frame_rows(bench_stages *stages, const bench_scene *scene, const frame_times *t, tides_error *error) {
    tides_status status = TIDES_OK;
    for (int32_t maker = t->limited ? LIMIT : INRIA; maker < MAKERS; maker++)
        for (int k = 0; k < STAGES && status == TIDES_OK; k++) {
            if (k == STAGE_MOTION && t->done[maker].gaussians_moved == 0) continue;
            if (maker < INRIA && (k == STAGE_TRANSFER || k == STAGE_MOTION)) continue;
            status = add_row(stages, scene, t, maker, (frame_stage)k, error);
        }
    return status == TIDES_OK ? add_targets(stages, scene, t, error) : status;
}
