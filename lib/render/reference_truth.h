/* Ground truth of a job as a plain loop, after its records and depth order. Included by reference_body.h. */

/* Makes a job's surfaces, and the planes of its blocks. */
static tides_status truth_job(reference *r, const td_job *job, const td_batch *batch, const td_image *image,
                              const td_list *list, double *planes, tides_error *error) {
    size_t reals = (size_t)job->count * TD_RECORD_STRIDE, pairs = 0;
    tides_status status = td_reserve((void **)&r->surfaces, &r->surface_capacity, 2 * reals, sizeof *r->surfaces, error);
    if (status != TIDES_OK) return status;
    const td_surfaces surfaces = {r->surfaces, r->surfaces + reals};
    td_job local = *job; /* records are reused by each job */
    local.records = 0;
    for (int i = 0; i < job->count; i++)
        td_surface_group(&local, i, batch->candidates, r->object, r->object_numbers, r->views, image, &r->source,
                         r->sorted.records, r->sorted.masks, &surfaces);
    for (int block = 0; block < TD_TILE_BLOCKS; block++) {
        if (!(job->blocks >> block & 1)) continue;
        for (int pixel = 0; pixel < TD_BLOCK_PIXELS; pixel++)
            pairs +=
                (size_t)td_truth_block(job, list, &surfaces, image, r->scene_objects, block, pixel, r->sorted.planes + pixel);
        for (int i = 0; i < TD_OUT_TRUTH * TD_BLOCK_PIXELS; i++)
            planes[i / TD_BLOCK_PIXELS * TD_TILE_PIXELS + block * TD_BLOCK_PIXELS + i % TD_BLOCK_PIXELS] = r->sorted.planes[i];
        r->base.stats.blocks++;
    }
    r->base.stats.pairs_evaluated += pairs;
    return TIDES_OK;
}

static tides_status copy_numbers(reference *r, const td_store *store, tides_error *error) {
    r->scene_objects = td_store_scene_objects(store);
    r->object_numbers = td_alloc((size_t)store->objects, sizeof *r->object_numbers, error);
    if (!r->object_numbers) return TIDES_NO_MEMORY;
    memcpy(r->object_numbers, store->scene_object, (size_t)store->objects * sizeof *r->object_numbers);
    return TIDES_OK;
}
