/* The renderer's stages as plain loops over the functions of kernels/. In double precision this is the reference; in single
 * precision, the OpenCL kernels equal it to the bit. Included once per precision: the includer defines TD_REFERENCE_CREATE
 * (the name of the constructor) and, for double, TD_REAL_DOUBLE. */
#include "kernels/block.h"
#include "kernels/interpolate.h"
#include "kernels/movers.h"
#include "kernels/path_node.h"
#include "kernels/record.h"
#include "kernels/sweep.h"
#include "kernels/truth.h"
#include "td_backend.h"

#include <stdlib.h>

/* A splat's place in the front-to-back order. */
typedef struct reference_key {
    td_real depth;
    int candidate;
} reference_key;

/* Gaussians that a motion moves: where their rows come from (reference_moves.h). */
typedef struct reference_moved {
    td_mover *movers;
    td_real *data, *moments, *decoder;
    size_t moment_capacity;
    int *owners; /* (2 x rows) object and Gaussian of each row */
    int moves_sh, kinds;
} reference_moved;

/* A sweep's arguments in this precision. */
typedef struct reference_interval {
    td_stray *strays; /* (objects) */
    int *rows;        /* (td_sweep_times) the first row at each time */
    size_t stray_capacity, row_capacity;
} reference_interval;

/* A tile under way: its records, in the list's order and then front to back. */
typedef struct reference_sorted {
    td_real *records, *colours, *depths, *lights, *planes;
    reference_key *keys;
    int *masks, *order, *sorted_masks, *words, *hints;
    size_t capacity[10], hint_capacity;
    int last_count; /* of the last job, for inspect */
    td_real last_brightest;
} reference_sorted;

typedef struct reference {
    td_backend base;
    td_image image;
    td_source source;
    int *object;
    td_real *arrays[4]; /* geometry, rates, sh, sh_rates: the arrays of `source` */
    int count, rows;    /* of the store; room for moved ones behind it */
    reference_moved moved;
    td_view *views; /* (slots x objects) */
    td_backdrop *backdrops;
    size_t view_capacity, backdrop_capacity;
    reference_interval interval;
    reference_sorted sorted;
    td_real *path_rows, *path_beside; /* record paths (reference_paths.h) */
    size_t path_row_capacity, path_beside_capacity;
    td_real *surfaces; /* ground truth */
    size_t surface_capacity;
    int *object_numbers, scene_objects;
} reference;

typedef char td_view_has_these_reals[sizeof(td_view) == TD_VIEW_REALS * sizeof(td_real) ? 1 : -1];
typedef char td_stray_has_these_reals[sizeof(td_stray) == TD_STRAY_REALS * sizeof(td_real) ? 1 : -1];
typedef char td_backdrop_has_these_reals[sizeof(td_backdrop) == TD_BACKDROP_REALS * sizeof(td_real) ? 1 : -1];
typedef char
    td_mover_has_these_numbers[sizeof(td_mover) == TD_MOVER_REALS * sizeof(td_real) + TD_MOVER_WHOLE * sizeof(int) ? 1 : -1];
typedef char
    td_image_has_these_numbers[sizeof(td_image) == TD_IMAGE_REALS * sizeof(td_real) + TD_IMAGE_INTS * sizeof(int) ? 1 : -1];

static void narrow(const double *from, td_real *to, size_t count) {
    for (size_t i = 0; i < count; i++) to[i] = (td_real)from[i];
}

static td_image unpack_image(const td_image_numbers *numbers) {
    td_image image;
    td_real reals[TD_IMAGE_REALS];
    narrow(numbers->real, reals, TD_IMAGE_REALS);
    memcpy(&image, reals, sizeof reals);
    memcpy((char *)&image + sizeof reals, numbers->whole, sizeof numbers->whole);
    return image;
}

/* Copies an array in this precision; NULL stays NULL. */
static tides_status copy_array(const double *from, size_t count, td_real **to, tides_error *error) {
    if (!from) return TIDES_OK;
    *to = td_alloc(count, sizeof **to, error);
    if (!*to) return TIDES_NO_MEMORY;
    narrow(from, *to, count);
    return TIDES_OK;
}

static tides_status copy_views(reference *r, const double *views, int slots, tides_error *error) {
    size_t count = (size_t)slots * r->image.objects;
    tides_status status = td_reserve((void **)&r->views, &r->view_capacity, count, sizeof *r->views, error);
    if (status == TIDES_OK) narrow(views, (td_real *)r->views, count * TD_VIEW_REALS);
    return status;
}

/* Copies views, strays and rows of a sweep in this precision. */
static tides_status copy_interval(reference *r, const td_sweep_request *request, td_interval *interval, tides_error *error) {
    int times = td_sweep_times(request->level);
    size_t strays = (size_t)r->image.objects * TD_STRAY_REALS;
    tides_status status = copy_views(r, request->views, times, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&r->interval.strays, &r->interval.stray_capacity, strays, sizeof(td_real), error);
    if (status == TIDES_OK)
        status =
            td_reserve((void **)&r->interval.rows, &r->interval.row_capacity, (size_t)times, sizeof *r->interval.rows, error);
    if (status != TIDES_OK) return status;
    if (request->strays)
        narrow(request->strays, (td_real *)r->interval.strays, strays);
    else
        memset(r->interval.strays, 0, strays * sizeof(td_real));
    for (int i = 0; i < times; i++) r->interval.rows[i] = request->rows ? request->rows[i] : request->begin;
    const td_interval made = {r->views,         r->interval.strays,         r->object,
                              r->interval.rows, (td_real)request->duration, request->level};
    *interval = made;
    return TIDES_OK;
}

static tides_status sweep(td_backend *backend, const td_sweep_request *request, float *boxes, float *travel,
                          tides_error *error) {
    reference *r = (reference *)backend;
    double begun = td_now();
    td_interval interval;
    tides_status status = copy_interval(r, request, &interval, error);
    if (status != TIDES_OK) return status;
    const int count = request->groups ? request->groups->count * TD_PAD : request->end - request->begin;
    for (int at = 0; at < count; at++) {
        const int i = request->groups ? request->groups->number[at / TD_PAD] * TD_PAD + at % TD_PAD : request->begin + at;
        td_real box[4], way;
        td_sweep_group(&interval, &r->image, &r->source, i - request->begin, box, &way);
        for (int k = 0; k < 4; k++) boxes[4 * (size_t)i + k] = (float)box[k];
        travel[i] = (float)way;
    }
    backend->stats.sweeps++;
    backend->stats.time_sweep_s += td_now() - begun;
    return TIDES_OK;
}

#include "reference_moves.h"
#include "reference_paths.h"

/* -- jobs ---------------------------------------------------------------------------------------------------------- */

/* Makes room for the stages of one job. */
static tides_status reserve_records(reference *r, size_t count, int outputs, tides_error *error) {
    size_t *capacity = r->sorted.capacity;
    tides_status status =
        td_reserve((void **)&r->sorted.records, &capacity[0], count * TD_RECORD_STRIDE, sizeof *r->sorted.records, error);
    if (status == TIDES_OK)
        status =
            td_reserve((void **)&r->sorted.colours, &capacity[1], count * TD_FEATURE_STRIDE, sizeof *r->sorted.colours, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&r->sorted.depths, &capacity[8], count, sizeof *r->sorted.depths, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&r->sorted.lights, &capacity[9], count, sizeof *r->sorted.lights, error);
    if (status == TIDES_OK) status = td_reserve((void **)&r->sorted.masks, &capacity[2], count, sizeof *r->sorted.masks, error);
    if (status == TIDES_OK) status = td_reserve((void **)&r->sorted.keys, &capacity[3], count, sizeof *r->sorted.keys, error);
    if (status == TIDES_OK) status = td_reserve((void **)&r->sorted.order, &capacity[4], count, sizeof *r->sorted.order, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&r->sorted.sorted_masks, &capacity[5], count, sizeof *r->sorted.sorted_masks, error);
    if (status == TIDES_OK)
        status =
            td_reserve((void **)&r->sorted.words, &capacity[7], count / 2 + 2 * TD_TILE_BLOCKS, sizeof *r->sorted.words, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&r->sorted.planes, &capacity[6], (size_t)outputs * TD_BLOCK_PIXELS,
                            sizeof *r->sorted.planes, error);
    return status;
}

static int compare_keys(const void *a, const void *b) {
    const reference_key *x = a, *y = b;
    if (x->depth != y->depth) return x->depth < y->depth ? -1 : 1;
    return x->candidate < y->candidate ? -1 : x->candidate > y->candidate;
}

static void project_job(reference *r, const td_job *job, const td_batch *batch, const td_image *image) {
    td_job local = *job; /* records are reused by each job */
    td_sink sink;
    local.records = 0;
    sink.records = r->sorted.records;
    sink.colours = r->sorted.colours;
    sink.depths = r->sorted.depths;
    sink.lights = r->sorted.lights;
    sink.masks = r->sorted.masks;
    for (int i = 0; i < job->count; i++)
        td_project_group(&local, i, batch->candidates, r->object, r->views, image, &r->source, &sink);
}

/* Appends a candidate to the list, front to back. */
static void add_splat(reference *r, int candidate, td_list *list) {
    r->sorted.order[list->count] = candidate;
    r->sorted.sorted_masks[list->count++] = r->sorted.masks[candidate];
}

/* The brightest of all the tile's splats and the backdrop. All splats count, so that a block stops at the same place
 * whichever blocks are requested. */
static td_real brightest_of(const reference *r, const td_job *job) {
    td_real most = r->backdrops[job->slot].luminance;
    for (int i = 0; i < job->count; i++) most = r->sorted.lights[i] > most ? r->sorted.lights[i] : most;
    return most;
}

static td_list sort_job(reference *r, const td_job *job, int *kept) {
    const int *hint = job->hint ? r->sorted.hints + job->hint : NULL;
    const td_view *view = r->views + job->slot * r->image.objects;
    td_list list = {r->sorted.records,    r->sorted.colours,
                    r->sorted.order,      r->sorted.sorted_masks,
                    r->sorted.words,      0,
                    brightest_of(r, job), view,
                    r->moved.decoder};
    int sorted = 0;
    *kept = 1;
    for (int i = 0; i < job->count; i++) {
        int candidate = hint ? hint[i] : i;
        if (!job->new_hint && !(r->sorted.masks[candidate] & job->blocks)) continue;
        reference_key key = {r->sorted.depths[candidate], candidate};
        if (sorted > 0 && compare_keys(&r->sorted.keys[sorted - 1], &key) > 0) *kept = 0;
        r->sorted.keys[sorted++] = key;
    }
    if (!*kept) qsort(r->sorted.keys, (size_t)sorted, sizeof *r->sorted.keys, compare_keys);
    for (int i = 0; i < sorted; i++) {
        int candidate = r->sorted.keys[i].candidate;
        if (job->new_hint) r->sorted.hints[job->new_hint + i] = candidate;
        if (r->sorted.masks[candidate] & job->blocks) add_splat(r, candidate, &list);
    }
    td_lay_words(r->sorted.sorted_masks, list.count, 0, 1, r->sorted.words);
    r->sorted.last_count = list.count;
    r->sorted.last_brightest = list.brightest;
    return list;
}

static void composite_job(reference *r, const td_job *job, const td_list *list, const td_image *image, double *planes) {
    const td_backdrop *backdrop = &r->backdrops[job->slot];
    size_t pairs = 0;
    for (int block = 0; block < TD_TILE_BLOCKS; block++) {
        if (!(job->blocks >> block & 1)) continue;
        for (int pixel = 0; pixel < TD_BLOCK_PIXELS; pixel++)
            pairs += (size_t)td_composite_block(job, list, image, backdrop, block, pixel, r->sorted.planes + pixel);
        for (int i = 0; i < image->outputs * TD_BLOCK_PIXELS; i++)
            planes[i / TD_BLOCK_PIXELS * TD_TILE_PIXELS + block * TD_BLOCK_PIXELS + i % TD_BLOCK_PIXELS] = r->sorted.planes[i];
        r->base.stats.blocks++;
    }
    r->base.stats.pairs_evaluated += pairs;
}

#include "reference_truth.h"

static void count_job(td_backend *backend, const td_job *job, int splats) {
    backend->stats.tile_jobs++;
    backend->stats.gaussians_projected += (uint64_t)job->count;
    backend->stats.gaussians_culled += (uint64_t)(job->count - splats);
}

static tides_status render(td_backend *backend, const td_batch *batch, double *planes, tides_error *error) {
    reference *r = (reference *)backend;
    td_image image = r->image;
    image.outputs = batch->outputs;
    tides_status status = copy_views(r, batch->views, batch->slots, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&r->backdrops, &r->backdrop_capacity, (size_t)batch->slots, sizeof *r->backdrops, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&r->sorted.hints, &r->sorted.hint_capacity, (size_t)batch->hint_count,
                            sizeof *r->sorted.hints, error);
    if (status != TIDES_OK) return status;
    narrow(batch->backdrops, (td_real *)r->backdrops, (size_t)batch->slots * TD_BACKDROP_REALS);
    for (int i = 0; i < batch->job_count; i++) {
        const td_job *job = &batch->jobs[i];
        double begun = td_now();
        status = reserve_records(r, (size_t)job->count, batch->outputs, error);
        if (status != TIDES_OK) return status;
        project_job(r, job, batch, &image);
        double projected = td_now();
        int kept;
        td_list list = sort_job(r, job, &kept);
        if (batch->in_order) batch->in_order[job->out] = (uint8_t)kept;
        backend->stats.lists_kept += (uint64_t)kept;
        double sorted = td_now();
        double *out = planes + (size_t)job->out * batch->outputs * TD_TILE_PIXELS;
        if (batch->outputs == TD_OUT_TRUTH)
            status = truth_job(r, job, batch, &image, &list, out, error);
        else
            composite_job(r, job, &list, &image, out);
        if (status != TIDES_OK) return status;
        backend->stats.time_project_s += projected - begun;
        backend->stats.time_sort_s += sorted - projected;
        backend->stats.time_composite_s += td_now() - sorted;
        count_job(backend, job, list.count);
    }
    return TIDES_OK;
}

/* Computes a pixel with an empty list, in this precision. */
static void empty_pixel_of(const td_image *image, const double *wide_backdrop, double *planes, int outputs) {
    static const int no_list[1] = {0};
    td_real out[TD_OUT_COLOUR * TD_BLOCK_PIXELS] = {0};
    td_backdrop backdrop;
    narrow(wide_backdrop, (td_real *)&backdrop, TD_BACKDROP_REALS);
    td_image own = *image;
    own.outputs = outputs;
    own.decoder = 0; /* without a decoder the result doesn't depend on the pixel */
    td_job job = {0};
    td_list list = {out, out, no_list, no_list, no_list, 0, backdrop.luminance, NULL, NULL};
    td_composite_block(&job, &list, &own, &backdrop, 0, 0, out);
    for (int k = 0; k < outputs; k++) planes[k] = out[k * TD_BLOCK_PIXELS];
}

static void empty_pixel(const td_backend *backend, const double *backdrop, double *planes, int outputs) {
    empty_pixel_of(&((const reference *)backend)->image, backdrop, planes, outputs);
}

static tides_status prepare(td_backend *backend, int outputs, tides_error *error) {
    (void)backend, (void)outputs, (void)error; /* nothing has to be built */
    return TIDES_OK;
}

static tides_status inspect(td_backend *backend, td_stages *stages, tides_error *error) {
    const reference *r = (const reference *)backend;
    size_t records = (size_t)stages->records;
    (void)error;
    for (size_t i = 0; i < records * TD_RECORD_STRIDE; i++) stages->record[i] = r->sorted.records[i];
    memcpy(stages->mask, r->sorted.masks, records * sizeof *r->sorted.masks);
    memcpy(stages->order, r->sorted.order, records * sizeof *r->sorted.order);
    memcpy(stages->sorted_mask, r->sorted.sorted_masks, records * sizeof *r->sorted.sorted_masks);
    stages->count = r->sorted.last_count;
    stages->brightest = r->sorted.last_brightest;
    return TIDES_OK;
}

static void destroy(td_backend *backend) {
    reference *r = (reference *)backend;
    for (int i = 0; i < 4; i++) free(r->arrays[i]);
    free(r->object);
    free(r->moved.movers);
    free(r->moved.data);
    free(r->moved.moments);
    free(r->moved.decoder);
    free(r->moved.owners);
    free(r->views);
    free(r->interval.strays);
    free(r->interval.rows);
    free(r->backdrops);
    free(r->sorted.records);
    free(r->sorted.colours);
    free(r->sorted.depths);
    free(r->sorted.lights);
    free(r->sorted.planes);
    free(r->sorted.keys);
    free(r->sorted.masks);
    free(r->sorted.order);
    free(r->sorted.sorted_masks);
    free(r->sorted.words);
    free(r->sorted.hints);
    free(r->surfaces);
    free(r->object_numbers);
    free(r->path_rows);
    free(r->path_beside);
    free(r);
}

static const td_backend_class reference_class = {.sweep = sweep,
                                                 .render = render,
                                                 .empty_pixel = empty_pixel,
                                                 .prepare = prepare,
                                                 .inspect = inspect,
                                                 .destroy = destroy,
                                                 .move = move,
                                                 .prepare_cubics = prepare_cubics,
                                                 .misfits = misfits,
                                                 .moved_rows = moved_rows,
#ifdef TD_REAL_DOUBLE
                                                 .nodes = nodes,
                                                 .halve_paths = halve_paths,
                                                 .path_rows = path_rows
#endif
};

/* Copies the store's arrays in this precision; SH are floats or doubles there. */
static tides_status copy_store(reference *r, const td_store *store, tides_error *error) {
    size_t geometry = (size_t)store->count * TD_GEOMETRY_STRIDE, sh = (size_t)store->count * store->sh_stride;
    r->object = td_alloc((size_t)store->count, sizeof *r->object, error);
    if (!r->object) return TIDES_NO_MEMORY;
    memcpy(r->object, store->object, (size_t)store->count * sizeof *r->object);
    tides_status status = copy_array(store->geometry, geometry, &r->arrays[0], error);
    if (status == TIDES_OK) status = copy_array(store->rates, geometry, &r->arrays[1], error);
    if (status == TIDES_OK) status = copy_array(store->sh_wide, sh, &r->arrays[2], error);
    if (status == TIDES_OK) status = copy_array(store->sh_rates, sh, &r->arrays[3], error);
    if (status != TIDES_OK || store->sh_wide) return status;
    r->arrays[2] = td_alloc(sh, sizeof *r->arrays[2], error);
    if (!r->arrays[2]) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < sh; i++) r->arrays[2][i] = store->sh[i];
    return TIDES_OK;
}

static tides_status copy_movers(reference *r, const td_movers *movers, tides_error *error) {
    if (movers->count == 0) return TIDES_OK;
    r->moved.kinds = movers->kinds;
    r->moved.moves_sh = movers->moves_sh;
    r->moved.movers = td_alloc((size_t)movers->count, sizeof *r->moved.movers, error);
    if (!r->moved.movers) return TIDES_NO_MEMORY;
    for (int i = 0; i < movers->count; i++) {
        td_real reals[TD_MOVER_REALS];
        narrow(movers->row[i].real, reals, TD_MOVER_REALS);
        memcpy(&r->moved.movers[i], reals, sizeof reals);
        memcpy((char *)&r->moved.movers[i] + sizeof reals, movers->row[i].whole, sizeof movers->row[i].whole);
    }
    return copy_array(movers->data, movers->data_count, &r->moved.data, error);
}

tides_status TD_REFERENCE_CREATE(const td_store *store, const td_image_numbers *image, td_backend **backend,
                                 tides_error *error) {
    reference *r = td_alloc(1, sizeof *r, error);
    if (!r) return TIDES_NO_MEMORY;
    r->base.type = &reference_class;
    r->image = unpack_image(image);
    r->image.objects = store->objects;
    r->image.moving = store->rates != NULL || store->movers.count > 0;
    r->count = store->count;
    tides_status status = copy_store(r, store, error);
    if (status == TIDES_OK) status = copy_numbers(r, store, error);
    if (status == TIDES_OK) status = copy_movers(r, &store->movers, error);
    if (status == TIDES_OK) status = copy_array(store->decoder, TD_DECODER_REALS, &r->moved.decoder, error);
    if (status != TIDES_OK) {
        destroy(&r->base);
        return status;
    }
    r->source.geometry = r->arrays[0];
    r->source.rates = r->arrays[1];
    r->source.sh = r->arrays[2];
    r->source.sh_rates = r->arrays[3];
    r->source.first_rate = store->rates ? 0 : store->count;
    r->source.first_moved = store->count;
    *backend = &r->base;
    return TIDES_OK;
}
