/* Renders frames by a backend: candidate lists, a job per tile, and the tiles joined. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/td_renderer.h"

#include "tests/support/render_frame.h"
#include "tests/support/scene_folder.h"

#include <stdlib.h>

/* Boxes that put every Gaussian, padding included, in every tile. */
static void box_everything(const frame_input *input, float *boxes) {
    for (int i = 0; i < input->store->count; i++) {
        boxes[4 * i] = boxes[4 * i + 1] = 0;
        boxes[4 * i + 2] = (float)input->width;
        boxes[4 * i + 3] = (float)input->height;
    }
}

/* Boxes of the sweep over an interval of length 0, at the frame's time. */
static void box_swept(td_backend *backend, const frame_input *input, float *boxes, float *travel) {
    size_t reals = (size_t)input->store->objects * TD_VIEW_REALS;
    double *views = malloc(3 * reals * sizeof *views);
    tides_error error;
    assert_non_null(views);
    for (int i = 0; i < 3; i++) memcpy(views + (size_t)i * reals, input->views, reals * sizeof *views);
    const td_sweep_request request = {.views = views, .end = input->store->count};
    scene_expect_ok(backend->type->sweep(backend, &request, boxes, travel, &error), &error);
    free(views);
}

static void find_candidates(td_backend *backend, const frame_input *input, int which, td_candidates *candidates) {
    float *boxes = malloc((size_t)input->store->count * 4 * sizeof *boxes);
    float *travel = calloc((size_t)input->store->count, sizeof *travel);
    uint8_t *moves = calloc((size_t)input->store->objects, sizeof *moves);
    tides_error error;
    assert_non_null(boxes);
    assert_non_null(travel);
    assert_non_null(moves);
    if (which == FRAME_ALL)
        box_everything(input, boxes);
    else
        box_swept(backend, input, boxes, travel);
    scene_expect_ok(td_candidates_create(input->width, input->height, candidates, &error), &error);
    /* A backend keeps its copy of candidates while their serial stays; here every frame has its own lists, so it gets a
     * serial. */
    candidates->serial = 2 * backend->stats.tile_jobs + (uint64_t)which;
    const td_boxes all = {.box = boxes, .travel = travel, .object_moves = moves};
    scene_expect_ok(td_candidates_build(candidates, input->store, &all, &error), &error);
    free(moves);
    free(travel);
    free(boxes);
}

/* Jobs for the tiles that have candidates; returns their number. */
static int make_jobs(const td_candidates *candidates, td_job *jobs, int *records) {
    int count = 0, tiles = candidates->tiles_x * candidates->tiles_y;
    *records = 0;
    for (int t = 0; t < tiles; t++) {
        int first = candidates->first[t], length = candidates->first[t + 1] - first;
        if (length == 0) continue;
        td_job job = {t % candidates->tiles_x * TD_TILE,
                      t / candidates->tiles_x * TD_TILE,
                      0,
                      first,
                      length,
                      *records,
                      t,
                      0,
                      0,
                      TD_ALL_BLOCKS,
                      0};
        jobs[count++] = job;
        *records += length;
    }
    return count;
}

/* Tiles without a job show the backdrop. */
static void fill_with_backdrop(const td_backend *backend, const frame_input *input, int tiles, double *planes) {
    double pixel[TD_OUT_COLOUR];
    backend->type->empty_pixel(backend, input->backdrop, pixel, input->outputs);
    for (size_t i = 0; i < (size_t)tiles * input->outputs * TD_TILE_PIXELS; i++)
        planes[i] = pixel[i / TD_TILE_PIXELS % (size_t)input->outputs];
}

static double *assemble(const td_candidates *candidates, const frame_input *input, const double *tiles) {
    double *image = malloc((size_t)input->outputs * input->height * input->width * sizeof *image), *at = image;
    assert_non_null(image);
    for (int plane = 0; plane < input->outputs; plane++)
        for (int y = 0; y < input->height; y++)
            for (int x = 0; x < input->width; x++) {
                int tile = y / TD_TILE * candidates->tiles_x + x / TD_TILE;
                *at++ =
                    tiles[((size_t)tile * input->outputs + plane) * TD_TILE_PIXELS + td_tile_pixel(x % TD_TILE, y % TD_TILE)];
            }
    return image;
}

double *frame_render(td_backend *backend, const frame_input *input, int which) {
    td_candidates candidates;
    td_batch batch = {0};
    tides_error error;
    find_candidates(backend, input, which, &candidates);
    int tiles = candidates.tiles_x * candidates.tiles_y;
    td_job *jobs = malloc((size_t)tiles * sizeof *jobs);
    double *planes = calloc((size_t)tiles * input->outputs * TD_TILE_PIXELS, sizeof *planes);
    assert_true(jobs && planes);
    fill_with_backdrop(backend, input, tiles, planes);
    batch.views = input->views;
    batch.backdrops = input->backdrop;
    batch.slots = 1;
    batch.jobs = jobs;
    batch.job_count = make_jobs(&candidates, jobs, &batch.records);
    batch.candidates = candidates.list;
    batch.candidate_count = candidates.first[tiles];
    batch.candidates_serial = candidates.serial;
    batch.outputs = input->outputs;
    if (batch.job_count) scene_expect_ok(backend->type->render(backend, &batch, planes, &error), &error);
    double *image = assemble(&candidates, input, planes);
    td_candidates_release(&candidates);
    free(jobs);
    free(planes);
    return image;
}
