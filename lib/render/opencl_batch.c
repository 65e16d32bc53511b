/* Copies a batch to an OpenCL device and its results back. All transfers are queued, and only the end is waited for. */
#include "td_opencl.h"
#include "td_wide.h"

static size_t count_blocks(const td_batch *batch) {
    size_t count = 0;
    for (int i = 0; i < batch->job_count; i++)
        for (int block = 0; block < TD_TILE_BLOCKS; block++) count += (size_t)(batch->jobs[i].blocks >> block & 1);
    return count;
}

/* Sets the places of sort keys, two for each candidate. On a CPU each work-group that takes jobs has its own, with room for
 * the longest list. */
static void lay_keys(const opencl_backend *b, const td_batch *batch, td_staging *s) {
    size_t longest = 0;
    for (int i = 0; i < batch->job_count; i++)
        if ((size_t)batch->jobs[i].count > longest) longest = (size_t)batch->jobs[i].count;
    const size_t groups = td_opencl_takers(b, batch->job_count);
    s->key_room = b->device->info.lanes > 1 ? 2 * longest : 0;
    s->keys = s->key_room ? groups * s->key_room : 2 * (size_t)batch->records;
    if (s->keys == 0) s->keys = 1;
}

static tides_status lay_staging(opencl_backend *b, const td_batch *batch, td_staging *s, tides_error *error) {
    size_t jobs = (size_t)batch->job_count;
    s->view_reals = (size_t)batch->slots * b->objects * TD_VIEW_REALS;
    s->backdrop_reals = (size_t)batch->slots * TD_BACKDROP_REALS;
    s->asked_count = count_blocks(batch);
    s->plane_reals = s->asked_count * batch->outputs * TD_BLOCK_PIXELS;
    s->blended_count = s->asked_count * (size_t)(TD_BLOCK_PIXELS / b->device->info.lanes);
    lay_keys(b, batch, s);
    size_t fetched = b->device->near ? 0 : s->plane_reals, reals = s->view_reals + s->backdrop_reals + fetched;
    size_t ints = jobs * TD_JOB_INTS + s->asked_count + s->blended_count + 2 * jobs;
    tides_status status = td_reserve((void **)&b->host, &b->host_capacity, reals, sizeof *b->host, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&b->host_ints, &b->host_ints_capacity, ints, sizeof *b->host_ints, error);
    if (status != TIDES_OK) return status;
    s->views = b->host;
    s->backdrops = s->views + s->view_reals;
    s->fetched = s->backdrops + s->backdrop_reals;
    s->jobs = (td_job *)(void *)b->host_ints; /* a td_job is TD_JOB_INTS ints */
    s->asked = b->host_ints + jobs * TD_JOB_INTS;
    s->blended = s->asked + s->asked_count;
    s->counts = s->blended + s->blended_count;
    return TIDES_OK;
}

tides_status td_opencl_reserve_batch(opencl_backend *b, const td_batch *batch, td_staging *s, tides_error *error) {
    tides_status laid = lay_staging(b, batch, s, error);
    if (laid != TIDES_OK) return laid;
    size_t records = (size_t)(batch->records > 0 ? batch->records : 1), jobs = (size_t)batch->job_count;
    td_image image = b->image;
    image.outputs = batch->outputs;
    const size_t lanes = (size_t)b->device->info.lanes;
    size_t colours = td_has_colours(&image) ? records * (size_t)td_colour_stride(&image) : 1;
    struct {
        td_buffer *buffer;
        size_t bytes;
    } wanted[] = {
        {&b->work.records, records * TD_RECORD_STRIDE * sizeof(cl_float)},
        {&b->work.colours, colours * sizeof(cl_float)},
        {&b->work.depths, records * sizeof(cl_float)},
        {&b->work.lights, (records / lanes + 1) * sizeof(cl_float)},
        {&b->work.masks, records * sizeof(cl_int)},
        {&b->work.keys, s->keys * sizeof(cl_long)},
        {&b->work.order, records * sizeof(cl_int)},
        {&b->work.sorted_masks, records * sizeof(cl_int)},
        {&b->work.words, (records / 2 + 2 * TD_TILE_BLOCKS * jobs) * sizeof(cl_int)},
        {&b->work.counts, 2 * jobs * sizeof(cl_int)},
        {&b->work.hints, (size_t)(batch->hint_count > 0 ? batch->hint_count : 1) * sizeof(cl_int)},
        {&b->work.brightest, jobs * sizeof(cl_float)},
        {&b->work.planes, s->plane_reals * sizeof(cl_float)},
        {&b->work.blended, s->blended_count * sizeof(cl_int)},
        {&b->work.views, s->view_reals * sizeof(cl_float)},
        {&b->work.backdrops, s->backdrop_reals * sizeof(cl_float)},
        {&b->work.jobs, jobs * sizeof(td_job)},
        {&b->work.asked, s->asked_count * sizeof(cl_int)},
    };
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        tides_status status = td_buffer_reserve(b->device, wanted[i].buffer, wanted[i].bytes, error);
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}

/* Sends a batch. Jobs are renumbered, so that output k of this launch is job k. */
tides_status td_opencl_send_batch(opencl_backend *b, const td_batch *batch, td_staging *s, tides_error *error) {
    size_t jobs = (size_t)batch->job_count;
    for (size_t i = 0; i < s->view_reals; i++) s->views[i] = (float)batch->views[i];
    for (size_t i = 0; i < s->backdrop_reals; i++) s->backdrops[i] = (float)batch->backdrops[i];
    size_t asked = 0;
    for (size_t i = 0; i < jobs; i++) {
        s->jobs[i] = batch->jobs[i];
        s->jobs[i].out = (int)i;
        for (int block = 0; block < TD_TILE_BLOCKS; block++)
            if (batch->jobs[i].blocks >> block & 1) s->asked[asked++] = (int)i * TD_TILE_BLOCKS + block;
    }
    tides_status status = td_opencl_choose_shared(b, batch, s, error);
    if (status == TIDES_OK && b->candidates_serial != batch->candidates_serial) {
        status = td_buffer_write(b->device, &b->work.candidates, batch->candidates,
                                 (size_t)batch->candidate_count * sizeof *batch->candidates, error);
        b->candidates_serial = batch->candidates_serial;
    }
    if (status == TIDES_OK)
        status = td_buffer_send(b->device, &b->work.views, s->views, s->view_reals * sizeof *s->views, error);
    if (status == TIDES_OK)
        status = td_buffer_send(b->device, &b->work.backdrops, s->backdrops, s->backdrop_reals * sizeof *s->backdrops, error);
    if (status == TIDES_OK) status = td_buffer_send(b->device, &b->work.jobs, s->jobs, jobs * sizeof *s->jobs, error);
    if (status == TIDES_OK) status = td_buffer_send(b->device, &b->work.asked, s->asked, asked * sizeof *s->asked, error);
    return status == TIDES_OK ? td_opencl_begin_turns(b, error) : status;
}

tides_status td_opencl_fetch_batch(opencl_backend *b, const td_batch *batch, td_staging *s, tides_error *error) {
    const size_t counts = 2 * (size_t)batch->job_count;
    tides_status status = td_buffer_view(b->device, &b->work.planes, s->fetched, s->plane_reals * sizeof *s->planes,
                                         (const void **)&s->planes, error);
    if (status == TIDES_OK)
        status = td_buffer_fetch(b->device, &b->work.blended, s->blended, s->blended_count * sizeof *s->blended, error);
    if (status == TIDES_OK) status = td_buffer_fetch(b->device, &b->work.counts, s->counts, counts * sizeof *s->counts, error);
    return status;
}

/* Copies blocks [first, end) to their places in their tiles' planes, as doubles. */
TD_WIDE static void place_blocks(const td_batch *batch, const td_staging *s, double *planes, size_t first, size_t end) {
    size_t outputs = (size_t)batch->outputs;
    for (size_t i = first; i < end; i++) {
        size_t job = (size_t)s->asked[i] / TD_TILE_BLOCKS, block = (size_t)s->asked[i] % TD_TILE_BLOCKS;
        const float *from = s->planes + i * outputs * TD_BLOCK_PIXELS;
        double *to = planes + (size_t)batch->jobs[job].out * outputs * TD_TILE_PIXELS + block * TD_BLOCK_PIXELS;
        for (size_t k = 0; k < outputs; k++, from += TD_BLOCK_PIXELS, to += TD_TILE_PIXELS)
            for (size_t p = 0; p < TD_BLOCK_PIXELS; p++) to[p] = from[p];
    }
}

/* Fewest blocks that are worth a thread of their own. */
enum { FEWEST_BLOCKS = 512 };

/* Arguments that the pool's threads share. */
typedef struct placing {
    const td_batch *batch;
    const td_staging *s;
    double *planes;
    int portions;
} placing;

static void place_some(void *user, int k) {
    const placing *of = user;
    const int count = (int)of->s->asked_count;
    place_blocks(of->batch, of->s, of->planes, (size_t)td_pool_begin(count, of->portions, k),
                 (size_t)td_pool_begin(count, of->portions, k + 1));
}

static void place_planes(const td_batch *batch, const td_staging *s, double *planes) {
    placing of = {batch, s, planes, td_pool_portions(batch->pool, (int)s->asked_count, FEWEST_BLOCKS)};
    td_pool_run(batch->pool, of.portions, place_some, &of);
}

/* Draws a plane of the block at (x, y), as far as it is within the image. */
static inline void draw_block(const td_pictures *to, double *plane, int x, int y, const float *from) {
    const int across = to->width - x < TD_BLOCK ? to->width - x : TD_BLOCK;
    const int down = to->height - y < TD_BLOCK ? to->height - y : TD_BLOCK;
    for (int row = 0; row < down; row++, from += TD_BLOCK) {
        double *at = plane + (size_t)(y + row) * (size_t)to->width + (size_t)x;
        if (across == TD_BLOCK)
            for (int i = 0; i < TD_BLOCK; i++) at[i] = from[i];
        else
            for (int i = 0; i < across; i++) at[i] = from[i];
    }
}

/* Draws each block into images. Returns 0 if all values are finite. */
TD_WIDE static float draw_planes(const td_batch *batch, const td_staging *s, const td_pictures *to) {
    float wrong[TD_BLOCK_PIXELS] = {0}, all = 0;
    const float *from = s->planes;
    for (size_t i = 0; i < s->asked_count; i++) {
        const td_job *job = &batch->jobs[s->asked[i] / TD_TILE_BLOCKS];
        const int block = s->asked[i] % TD_TILE_BLOCKS, blocks = TD_TILE / TD_BLOCK;
        const int x = job->x + block % blocks * TD_BLOCK, y = job->y + block / blocks * TD_BLOCK;
        for (int k = 0; k < batch->outputs; k++, from += TD_BLOCK_PIXELS) {
            for (size_t p = 0; p < TD_BLOCK_PIXELS; p++) wrong[p] += from[p] - from[p];
            if (to->plane[k]) draw_block(to, to->plane[k], x, y, from);
        }
    }
    for (size_t p = 0; p < TD_BLOCK_PIXELS; p++) all += wrong[p];
    return all;
}

void td_opencl_place_batch(const td_batch *batch, const td_staging *s, double *planes) {
    if (!batch->pictures)
        place_planes(batch, s, planes);
    else if (!(draw_planes(batch, s, batch->pictures) == 0))
        batch->pictures->nonfinite = 1;
}

/* Adds to the statistics: splats per job, whether lists were in order, pairs per work-item. */
void td_opencl_add_counts(opencl_backend *b, const td_batch *batch, const td_staging *s) {
    tides_render_stats *stats = &b->base.stats;
    for (size_t i = 0; i < s->blended_count; i++)
        stats->pairs_evaluated += (uint64_t)b->device->info.lanes * (uint64_t)s->blended[i];
    stats->tile_jobs += (uint64_t)batch->job_count;
    stats->blocks += s->asked_count;
    for (int i = 0; i < batch->job_count; i++) {
        stats->gaussians_projected += (uint64_t)batch->jobs[i].count;
        stats->gaussians_culled += (uint64_t)(batch->jobs[i].count - s->counts[i]);
        int kept = s->counts[batch->job_count + i];
        stats->lists_kept += (uint64_t)kept;
        if (batch->in_order) batch->in_order[batch->jobs[i].out] = (uint8_t)kept;
    }
}
