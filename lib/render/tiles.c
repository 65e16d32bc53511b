/* Tiles at times: turns requests into jobs for the backend, in launches that fit into memory. The candidates of a job are the
 * sweep's. In scenes with dynamic Gaussians, the rows for the requested times are computed first. */
#include "td_renderer.h"

#include <stdlib.h>

int td_job_by_falling_count(const void *a, const void *b) {
    const td_job *x = a, *y = b;
    if (x->count != y->count) return x->count > y->count ? -1 : 1;
    return x->out < y->out ? -1 : x->out > y->out;
}

static td_job job_of(const tides_renderer *renderer, const td_request *request, int out) {
    const int tiles_x = renderer->candidates.tiles_x;
    return (td_job){.x = request->tile % tiles_x * TD_TILE,
                    .y = request->tile / tiles_x * TD_TILE,
                    .slot = request->slot,
                    .out = out,
                    .blocks = td_request_blocks(request)};
}

/* Makes jobs from requests, longest first, and lists requests without candidates; returns the number of jobs. */
static int make_jobs(tides_renderer *renderer, const td_request *requests, int count, int *empty_count) {
    const td_candidates *candidates = &renderer->candidates;
    int jobs = 0;
    *empty_count = 0;
    for (int i = 0; i < count; i++) {
        int tile = requests[i].tile, first = candidates->first[tile];
        int length = candidates->first[tile + 1] - first;
        if (length == 0) {
            renderer->scratch.empty[(*empty_count)++] = i;
            continue;
        }
        td_job job = job_of(renderer, &requests[i], i);
        job.candidates = first;
        job.count = length;
        td_candidates_give_hint(&renderer->candidates, tile, &job);
        renderer->scratch.jobs[jobs++] = job;
    }
    qsort(renderer->scratch.jobs, (size_t)jobs, sizeof *renderer->scratch.jobs, td_job_by_falling_count);
    return jobs;
}

/* Runs the jobs, in launches with limited records (a single job may need more). */
static tides_status run_jobs(tides_renderer *renderer, td_batch *batch, td_job *jobs, int count, double *planes,
                             tides_error *error) {
    tides_status status = TIDES_OK;
    const int limit = td_renderer_record_limit(renderer);
    for (int from = 0, to = 0; from < count && status == TIDES_OK; from = to) {
        int records = 0;
        for (to = from; to < count && (to == from || records + jobs[to].count <= limit); to++) {
            jobs[to].records = records;
            records += jobs[to].count;
        }
        batch->jobs = jobs + from;
        batch->job_count = to - from;
        batch->records = records;
        status = td_renderer_check_stop(renderer, (double)from / count, error);
        if (status == TIDES_OK) status = renderer->backend->type->render(renderer->backend, batch, planes, error);
    }
    return status;
}

/* Fills tiles without candidates with the backdrop. */
static void fill_empty(tides_renderer *renderer, const td_request *requests, int empty_count, int outputs, double *planes) {
    double pixel[TD_OUT_COLOUR];
    for (int i = 0; i < empty_count; i++) {
        int request = renderer->scratch.empty[i];
        const double *backdrop = (const double *)&renderer->scratch.backdrops[requests[request].slot];
        if (outputs == TD_OUT_TRUTH)
            td_truth_of_nothing(pixel);
        else
            renderer->backend->type->empty_pixel(renderer->backend, backdrop, pixel, outputs);
        double *tile = planes + (size_t)request * outputs * TD_TILE_PIXELS;
        for (int k = 0; k < outputs * TD_TILE_PIXELS; k++) tile[k] = pixel[k / TD_TILE_PIXELS];
    }
    renderer->stats.tile_jobs_skipped += (uint64_t)empty_count;
}

/* Draws the backdrop into the images, for tiles without candidates. */
static void draw_empty(tides_renderer *renderer, const td_request *requests, int empty_count, int outputs,
                       const td_pictures *to) {
    double pixel[TD_OUT_COLOUR];
    renderer->backend->type->empty_pixel(renderer->backend, (const double *)renderer->scratch.backdrops, pixel, outputs);
    for (int i = 0; i < empty_count; i++) {
        const td_job at = job_of(renderer, &requests[renderer->scratch.empty[i]], 0);
        const int right = at.x + TD_TILE < to->width ? at.x + TD_TILE : to->width;
        const int bottom = at.y + TD_TILE < to->height ? at.y + TD_TILE : to->height;
        for (int k = 0; k < outputs; k++)
            for (int y = at.y; y < bottom && to->plane[k]; y++)
                for (int x = at.x; x < right; x++) to->plane[k][(size_t)y * (size_t)to->width + (size_t)x] = pixel[k];
    }
    renderer->stats.tile_jobs_skipped += (uint64_t)empty_count;
}

/* Runs empty tiles as jobs, for a decoder: its output without splats depends on the ray. */
static tides_status run_empty(tides_renderer *renderer, td_batch *batch, const td_request *requests, int count, double *planes,
                              tides_error *error) {
    if (count == 0) return TIDES_OK;
    for (int i = 0; i < count; i++) {
        int request = renderer->scratch.empty[i];
        renderer->scratch.jobs[i] = job_of(renderer, &requests[request], request);
    }
    return run_jobs(renderer, batch, renderer->scratch.jobs, count, planes, error);
}

/* Makes room for `count` requests. */
static tides_status reserve(tides_renderer *renderer, size_t count, tides_error *error) {
    tides_status status = td_reserve((void **)&renderer->scratch.jobs, &renderer->scratch.job_capacity, count,
                                     sizeof *renderer->scratch.jobs, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&renderer->scratch.empty, &renderer->scratch.empty_capacity, count,
                            sizeof *renderer->scratch.empty, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&renderer->scratch.in_order, &renderer->scratch.in_order_capacity, count,
                            sizeof *renderer->scratch.in_order, error);
    return status;
}

tides_status td_renderer_raw_tiles(tides_renderer *renderer, const tides_trajectory *camera, const td_tile_batch *asked,
                                   double *planes, td_pictures *pictures, tides_error *error) {
    const td_request *requests = asked->requests;
    const int outputs = asked->outputs;
    tides_status status = td_renderer_views(renderer, camera, asked->times, asked->slots, error);
    if (status == TIDES_OK) status = reserve(renderer, (size_t)asked->count, error);
    if (status != TIDES_OK) return status;
    int empty_count;
    int jobs = make_jobs(renderer, requests, asked->count, &empty_count);
    td_batch batch = {0};
    batch.views = (const double *)renderer->scratch.views;
    batch.backdrops = (const double *)renderer->scratch.backdrops;
    batch.slots = asked->slots;
    batch.candidates = renderer->candidates.list;
    batch.candidate_count = renderer->candidates.first[renderer->stats.tiles];
    batch.candidates_serial = renderer->candidates.serial;
    batch.outputs = outputs;
    batch.hint_count = td_candidates_hint_count(&renderer->candidates);
    batch.in_order = renderer->scratch.in_order;
    batch.pictures = pictures;
    batch.pool = renderer->pool;
    const td_groups groups = {renderer->candidates.groups, renderer->candidates.group_count};
    const int moves = renderer->dynamic.gaussians > 0; /* their rows have to be computed for the batch's times */
    if (!moves) batch.groups = &groups;
    status = moves ? td_dynamic_run_jobs(renderer, &batch, asked, renderer->scratch.jobs, jobs, planes, error)
                   : run_jobs(renderer, &batch, renderer->scratch.jobs, jobs, planes, error);
    td_candidates_take_hints(&renderer->candidates, renderer->scratch.jobs, jobs,
                             status == TIDES_OK ? renderer->scratch.in_order : NULL);
    if (status == TIDES_OK && renderer->image.decoder) return run_empty(renderer, &batch, requests, empty_count, planes, error);
    if (status == TIDES_OK && pictures) draw_empty(renderer, requests, empty_count, outputs, pictures);
    if (status == TIDES_OK && !pictures) fill_empty(renderer, requests, empty_count, outputs, planes);
    return status;
}

tides_status td_renderer_sharp_tiles(tides_renderer *renderer, const tides_trajectory *camera, const td_tile_batch *batch,
                                     double *planes, tides_error *error) {
    tides_status status = td_renderer_raw_tiles(renderer, camera, batch, planes, NULL, error);
    return status == TIDES_OK ? td_renderer_check_finite(renderer, camera, batch, planes, error) : status;
}
