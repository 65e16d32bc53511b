/* Test support: one scene on two backends, the OpenCL kernels and the single-precision reference, compared bit for bit stage by
 * stage: swept boxes, splat records, masks, order, and planes. */
#ifndef TESTS_KERNELS_BACKEND_PAIR_H
#define TESTS_KERNELS_BACKEND_PAIR_H

#include "render/td_renderer.h"
#include "td_device.h"
#include "tests/support/random_scene.h"
#include "tests/support/scene_folder.h"

#include <stdlib.h>

enum { PAIR_SLOTS = 3, PAIR_DEVICE = 0, PAIR_REFERENCE = 1 };

/* The interval that boxes are swept over, and its slots. */
static const double pair_times[PAIR_SLOTS] = {0.400, 0.405, 0.410};

/* Every kind of scene: no side of the images is a multiple of 16. */
static inline random_recipe pair_ordinary(uint64_t seed) {
    random_recipe recipe = random_recipe_defaults(seed);
    recipe.count = 150;
    recipe.objects = 3;
    recipe.width = 75;
    recipe.height = 45;
    return recipe;
}

/* What a scene is rendered with. */
typedef struct pair_setting {
    int rules, antialias;
    int sh_degree; /* evaluated, at most the scene's */
    int transfer;  /* TIDES_TRANSFER_*, of gamma 2.2 */
} pair_setting;

typedef struct backend_pair {
    const char *name; /* for messages */
    random_scene scene;
    td_store store;
    td_image_numbers image;
    td_backend *backend[2];
    double *views, *backdrops; /* of pair_times */
    td_candidates candidates;
    td_groups groups;       /* of them */
    int alone;              /* 1: batches don't say them, so that each job projects its own */
    td_job *jobs;           /* every tile that has candidates, at every slot */
    int job_count, records; /* of all jobs together; `out` is a permutation of 0 .. job_count - 1 */
} backend_pair;

/* Opens the OpenCL CPU device, for kernels of `lanes` pixels per item; skips the test where there's no such device. */
static inline tides_device *pair_device(int lanes) {
    tides_device *device = NULL;
    tides_error error;
    tides_status status = tides_device_open("cpu", &device, &error);
    if (status == TIDES_NO_DEVICE) {
        print_message("skipped: %s\n", error.text);
        skip();
    }
    scene_expect_ok(status, &error);
    device->info.lanes = lanes;
    return device;
}

static inline void pair_make_jobs(backend_pair *pair) {
    const td_candidates *lists = &pair->candidates;
    int tiles = lists->tiles_x * lists->tiles_y;
    pair->jobs = calloc((size_t)tiles * PAIR_SLOTS, sizeof *pair->jobs);
    assert_non_null(pair->jobs);
    for (int i = 0; i < tiles * PAIR_SLOTS; i++) {
        int tile = (i * 7 + 3) % tiles, slot = i / tiles; /* not in order, so that a mix-up of places shows */
        int first = lists->first[tile], count = lists->first[tile + 1] - first;
        if (count == 0) continue;
        td_job job = {tile % lists->tiles_x * TD_TILE,
                      tile / lists->tiles_x * TD_TILE,
                      slot,
                      first,
                      count,
                      pair->records,
                      0,
                      0,
                      0,
                      TD_ALL_BLOCKS,
                      0};
        pair->jobs[pair->job_count++] = job;
        pair->records += count;
    }
    for (int i = 0; i < pair->job_count; i++) pair->jobs[i].out = pair->job_count - 1 - i;
}

/* What a sweep leaves of each Gaussian. */
typedef struct pair_boxes {
    float *box, *travel;
} pair_boxes;

static inline void pair_boxes_free(pair_boxes *boxes) {
    free(boxes->box);
    free(boxes->travel);
}

/* Boxes from both backends, equal: of the first moment where `duration` is 0. */
static inline pair_boxes pair_boxes_of(backend_pair *pair, double duration) {
    const size_t count = (size_t)pair->store.count;
    const td_sweep_request request = {.views = pair->views, .duration = duration, .end = pair->store.count};
    pair_boxes made[2];
    tides_error error;
    for (int k = 0; k < 2; k++) {
        made[k].travel = calloc(count, sizeof *made[k].travel);
        made[k].box = calloc(4 * count, sizeof *made[k].box);
        assert_true(made[k].travel && made[k].box);
        td_backend *backend = pair->backend[k];
        scene_expect_ok(backend->type->sweep(backend, &request, made[k].box, made[k].travel, &error), &error);
    }
    assert_memory_equal(made[0].travel, made[1].travel, count * sizeof *made[0].travel);
    for (size_t i = 0; i < 4 * count; i++)
        if (memcmp(&made[0].box[i], &made[1].box[i], sizeof(float)) != 0)
            fail_msg("%s: box entry %d of Gaussian %d: %.9g on the device, %.9g in the reference", pair->name, (int)(i % 4),
                     (int)(i / 4), (double)made[0].box[i], (double)made[1].box[i]);
    pair_boxes_free(&made[1]);
    return made[0];
}

/* Boxes of a moment, which are made in a way of their own, lie in those of an interval that begins with it, to rounding, as far
 * as they are in the image: beside it, what crosses the near plane in the interval has none. */
static inline void pair_check_instant(backend_pair *pair, const pair_boxes *interval) {
    pair_boxes instant = pair_boxes_of(pair, 0);
    int seen = 0;
    for (size_t i = 0; i < (size_t)pair->store.count; i++) {
        const float *part = instant.box + 4 * i, *whole = interval->box + 4 * i;
        const float right = (float)pair->scene.camera.width, bottom = (float)pair->scene.camera.height;
        if (part[0] > part[2] || part[0] >= right || part[1] >= bottom || part[2] <= 0 || part[3] <= 0) continue;
        seen++;
        for (int k = 0; k < 2; k++) {
            const float from = part[k] > -1e4f ? part[k] : -1e4f, to = part[2 + k] < 1e4f ? part[2 + k] : 1e4f;
            assert_true(whole[0] <= whole[2] && (whole[k] <= from + 0.01f || whole[k] <= 0));
            const int32_t size = k ? pair->scene.camera.height : pair->scene.camera.width;
            assert_true(whole[2 + k] >= to - 0.01f || whole[2 + k] >= (float)size);
        }
    }
    assert_true(seen > 0);
    pair_boxes_free(&instant);
}

/* Candidate lists of the whole interval. */
static inline void pair_sweep(backend_pair *pair) {
    tides_error error;
    uint8_t *moves = calloc((size_t)pair->store.objects, sizeof *moves);
    assert_non_null(moves);
    pair_boxes boxes = pair_boxes_of(pair, pair_times[PAIR_SLOTS - 1] - pair_times[0]);
    pair_check_instant(pair, &boxes);
    scene_expect_ok(td_candidates_create(pair->scene.camera.width, pair->scene.camera.height, &pair->candidates, &error),
                    &error);
    const td_boxes all = {.box = boxes.box, .travel = boxes.travel, .object_moves = moves};
    scene_expect_ok(td_candidates_build(&pair->candidates, &pair->store, &all, &error), &error);
    pair->groups = (td_groups){pair->candidates.groups, pair->candidates.group_count};
    free(moves);
    pair_boxes_free(&boxes);
}

/* A scene without backends. `edit` (nullable) changes the store first. */
static inline backend_pair pair_begin(const char *name, const random_recipe *recipe, const pair_setting *setting,
                                      void (*edit)(td_store *store)) {
    backend_pair pair = {0};
    pair.name = name;
    pair.scene = random_scene_make(recipe);
    pair.store = random_scene_store(&pair.scene, pair_times[0]);
    if (edit) edit(&pair.store);
    pair.image = random_scene_image(&pair.scene, setting->rules, setting->antialias, TD_OUT_SIGNAL);
    if (setting->transfer) pair.image = random_scene_coded(&pair.image, setting->transfer, 2.2);
    pair.image.whole[3] = setting->sh_degree; /* width, height, objects, sh_degree (layout.h) */
    pair.views = random_scene_views(&pair.scene, pair_times, PAIR_SLOTS);
    pair.backdrops = random_scene_backdrops(&pair.scene, pair_times, PAIR_SLOTS);
    return pair;
}

/* The same on both backends, swept, with its jobs. */
static inline backend_pair pair_make(const char *name, tides_device *device, const random_recipe *recipe,
                                     const pair_setting *setting, void (*edit)(td_store *store)) {
    backend_pair pair = pair_begin(name, recipe, setting, edit);
    tides_error error;
    scene_expect_ok(td_backend_create_opencl(device, &pair.store, &pair.image, &pair.backend[PAIR_DEVICE], &error), &error);
    scene_expect_ok(td_backend_create_f32(&pair.store, &pair.image, &pair.backend[PAIR_REFERENCE], &error), &error);
    pair_sweep(&pair);
    pair_make_jobs(&pair);
    return pair;
}

static inline void pair_free(backend_pair *pair) {
    for (int k = 0; k < 2; k++)
        if (pair->backend[k]) pair->backend[k]->type->destroy(pair->backend[k]);
    td_candidates_release(&pair->candidates);
    td_store_release(&pair->store);
    random_scene_free(&pair->scene);
    free(pair->views);
    free(pair->backdrops);
    free(pair->jobs);
    memset(pair, 0, sizeof *pair);
}

static inline td_batch pair_batch(const backend_pair *pair, const td_job *jobs, int job_count, int records, int outputs) {
    td_batch batch = {pair->views,
                      pair->backdrops,
                      PAIR_SLOTS,
                      jobs,
                      job_count,
                      pair->candidates.list,
                      pair->candidates.first[pair->candidates.tiles_x * pair->candidates.tiles_y],
                      pair->candidates.serial,
                      records,
                      outputs,
                      0,
                      NULL,
                      pair->alone ? NULL : &pair->groups,
                      NULL,
                      NULL};
    return batch;
}

/* All jobs in one batch on both; planes must agree in every bit. Returns the reference's planes, freed by the caller. */
static inline double *pair_compare_planes(backend_pair *pair, int outputs) {
    size_t tile = (size_t)outputs * TD_TILE_PIXELS, reals = tile * (size_t)pair->job_count;
    double *planes[2];
    tides_error error;
    for (int k = 0; k < 2; k++) {
        td_batch batch = pair_batch(pair, pair->jobs, pair->job_count, pair->records, outputs);
        planes[k] = malloc((reals ? reals : 1) * sizeof *planes[k]);
        assert_non_null(planes[k]);
        for (size_t i = 0; i < reals; i++) planes[k][i] = -7.0 - k; /* so that what isn't written differs */
        scene_expect_ok(pair->backend[k]->type->render(pair->backend[k], &batch, planes[k], &error), &error);
    }
    for (size_t i = 0; i < reals; i++)
        if (memcmp(&planes[0][i], &planes[1][i], sizeof(double)) != 0)
            fail_msg("%s, %d planes: job with out %d, plane %d, pixel %d: %.9g on the device, %.9g in the reference",
                     pair->name, outputs, (int)(i / tile), (int)(i % tile / TD_TILE_PIXELS), (int)(i % TD_TILE_PIXELS),
                     planes[0][i], planes[1][i]);
    free(planes[PAIR_DEVICE]);
    return planes[PAIR_REFERENCE];
}

/* -- the stages of one job ----------------------------------------------------------------------------------------- */

static inline td_stages pair_stages_make(int records) {
    size_t count = (size_t)records;
    td_stages stages = {records,
                        calloc(count * TD_RECORD_STRIDE, sizeof(double)),
                        calloc(count, sizeof(int)),
                        calloc(count, sizeof(int)),
                        calloc(count, sizeof(int)),
                        -1,
                        -1};
    assert_true(stages.record && stages.mask && stages.order && stages.sorted_mask);
    return stages;
}

static inline void pair_stages_free(td_stages *stages) {
    free(stages->record);
    free(stages->mask);
    free(stages->order);
    free(stages->sorted_mask);
}

/* Runs one job alone and takes its stages. With colour, as the most there is: other outputs would be other kernels to build. */
static inline td_stages pair_stages_of(backend_pair *pair, int which, const td_job *job) {
    td_job alone = *job;
    td_stages stages = pair_stages_make(job->count);
    double planes[TD_OUT_COLOUR * TD_TILE_PIXELS];
    tides_error error;
    alone.records = alone.out = 0;
    td_batch batch = pair_batch(pair, &alone, 1, alone.count, TD_OUT_COLOUR);
    scene_expect_ok(pair->backend[which]->type->render(pair->backend[which], &batch, planes, &error), &error);
    scene_expect_ok(pair->backend[which]->type->inspect(pair->backend[which], &stages, &error), &error);
    return stages;
}

/* Records where there is a splat. */
static inline void pair_compare_records(const char *name, const td_stages *device, const td_stages *reference) {
    for (int i = 0; i < reference->records; i++) {
        if (device->mask[i] != reference->mask[i])
            fail_msg("%s: candidate %d touches blocks %x on the device, %x in the reference", name, i,
                     (unsigned)device->mask[i], (unsigned)reference->mask[i]);
        if (!reference->mask[i]) continue;
        for (int k = i * TD_RECORD_STRIDE; k < (i + 1) * TD_RECORD_STRIDE; k++)
            if (memcmp(&device->record[k], &reference->record[k], sizeof(double)) != 0)
                fail_msg("%s: record %d, entry %d: %.9g on the device, %.9g in the reference", name, i, k % TD_RECORD_STRIDE,
                         device->record[k], reference->record[k]);
    }
}

/* The reference's order is one: every splat once, by depth and then by place in the list. */
static inline void pair_check_order(const char *name, const td_stages *stages) {
    int splats = 0;
    for (int i = 0; i < stages->records; i++) splats += stages->mask[i] != 0;
    assert_int_equal(stages->count, splats);
    for (int i = 0; i < stages->count; i++) {
        assert_int_equal(stages->sorted_mask[i], stages->mask[stages->order[i]]);
        if (i == 0) continue;
        double before = stages->record[stages->order[i - 1] * TD_RECORD_STRIDE + TD_R_DEPTH];
        double depth = stages->record[stages->order[i] * TD_RECORD_STRIDE + TD_R_DEPTH];
        if (!(before < depth || (before == depth && stages->order[i - 1] < stages->order[i])))
            fail_msg("%s: splat %d of the order lies behind its successor", name, i - 1);
    }
}

/* Both backends' stages of one job; returns the number of splats. */
static inline int pair_compare_stages(backend_pair *pair, const td_job *job) {
    td_stages device = pair_stages_of(pair, PAIR_DEVICE, job), reference = pair_stages_of(pair, PAIR_REFERENCE, job);
    pair_compare_records(pair->name, &device, &reference);
    pair_check_order(pair->name, &reference);
    assert_int_equal(device.count, reference.count);
    assert_memory_equal(device.order, reference.order, (size_t)reference.count * sizeof *reference.order);
    assert_memory_equal(device.sorted_mask, reference.sorted_mask, (size_t)reference.count * sizeof *reference.sorted_mask);
    assert_memory_equal(&device.brightest, &reference.brightest, sizeof reference.brightest);
    int count = reference.count;
    pair_stages_free(&device);
    pair_stages_free(&reference);
    return count;
}

/* A pixel of nothing but backdrop: by formula on either backend. */
static inline void pair_compare_empty_pixel(backend_pair *pair) {
    static const int outputs[] = {TD_OUT_SIGNAL, TD_OUT_DIAGNOSTICS, TD_OUT_COLOUR};
    for (int i = 0; i < 3; i++)
        for (int slot = 0; slot < PAIR_SLOTS; slot++) {
            double planes[2][TD_OUT_COLOUR];
            for (int k = 0; k < 2; k++)
                pair->backend[k]->type->empty_pixel(pair->backend[k], pair->backdrops + slot * TD_BACKDROP_REALS, planes[k],
                                                    outputs[i]);
            assert_memory_equal(planes[0], planes[1], (size_t)outputs[i] * sizeof(double));
        }
}

#endif
