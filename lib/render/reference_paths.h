/* Rows of record paths in the double reference, and (in both precisions) rows that a motion has moved. Included by
 * reference_body.h, in its precision. */

static void widen(const td_real *from, double *to, size_t count) {
    for (size_t i = 0; i < count; i++) to[i] = from[i];
}

static tides_status moved_rows(td_backend *backend, const td_moved_rows *rows, tides_error *error) {
    const reference *r = (const reference *)backend;
    size_t row = (size_t)rows->row, rate = row - (size_t)r->source.first_rate, first = row - (size_t)r->count;
    size_t count = (size_t)rows->count, sh = r->moved.moves_sh ? (size_t)r->image.sh_stride : 0, stride = TD_GEOMETRY_STRIDE;
    (void)error;
    widen(r->arrays[0] + row * stride, rows->geometry, count * stride);
    widen(r->arrays[1] + rate * stride, rows->rates, count * stride);
    memcpy(rows->owners, r->moved.owners + 2 * first, 2 * count * sizeof *rows->owners);
    if (!sh) return TIDES_OK;
    widen(r->arrays[2] + row * sh, rows->sh, count * sh);
    widen(r->arrays[3] + rate * sh, rows->sh_rates, count * sh);
    return TIDES_OK;
}

#ifdef TD_REAL_DOUBLE
/* Grows an array to at least `count` numbers, and keeps its contents. */
static tides_status grow_rows_of_paths(td_real **array, size_t *capacity, size_t count, tides_error *error) {
    if (count <= *capacity) return TIDES_OK;
    size_t more = count > 2 * *capacity ? count : 2 * *capacity;
    tides_status status = grow(array, more, error);
    if (status == TIDES_OK) *capacity = more;
    return status;
}

/* Makes room for green and blue of `rows` rows, if paths have them. */
static tides_status grow_beside(reference *r, size_t rows, tides_error *error) {
    if (!td_paths_by_channels(&r->image)) return TIDES_OK;
    return grow_rows_of_paths(&r->path_beside, &r->path_beside_capacity, rows * TD_BESIDE_STRIDE, error);
}

static tides_status nodes(td_backend *backend, const td_node_request *request, tides_error *error) {
    reference *r = (reference *)backend;
    double begun = td_now();
    size_t rows = (size_t)request->row_count;
    td_image image = r->image;
    image.outputs = TD_OUT_SIGNAL;
    tides_status status = grow_rows_of_paths(&r->path_rows, &r->path_row_capacity, rows * TD_PATH_STRIDE, error);
    if (status == TIDES_OK) status = grow_beside(r, rows, error);
    if (status == TIDES_OK) status = copy_views(r, request->views, request->slots, error);
    if (status != TIDES_OK) return status;
    const td_node_sink sink = {r->path_rows, r->path_beside};
    for (int k = 0; k < request->job_count; k++) {
        const td_node_job *job = &request->jobs[k];
        for (int i = 0; i < job->count; i++)
            td_node_group(job, i, request->gaussians, request->rows, r->object, r->views, &image, &r->source, &sink);
    }
    backend->stats.time_project_s += td_now() - begun;
    return TIDES_OK;
}

static tides_status halve_paths(td_backend *backend, const td_halve_request *request, tides_error *error) {
    reference *r = (reference *)backend;
    const size_t reals = (size_t)request->row_count * TD_PATH_STRIDE;
    td_real *lengths = NULL;
    tides_status status = grow_rows_of_paths(&r->path_rows, &r->path_row_capacity, reals, error);
    if (status == TIDES_OK) status = grow_beside(r, (size_t)request->row_count, error);
    if (status == TIDES_OK) status = copy_array(request->lengths, (size_t)request->pieces, &lengths, error);
    for (int i = 0; i < request->count && status == TIDES_OK; i++) {
        const int from = request->from[i], to = request->to[i];
        td_path_halve(r->path_rows, TD_PATH_NUMBERS, from, to, request->level, request->pieces, lengths);
        if (td_paths_by_channels(&r->image))
            td_path_halve(r->path_beside, TD_BESIDE_NUMBERS, from, to, request->level, request->pieces, lengths);
    }
    free(lengths);
    return status;
}

static tides_status path_rows(td_backend *backend, int count, double *rows, double *beside, tides_error *error) {
    const reference *r = (const reference *)backend;
    (void)error;
    memcpy(rows, r->path_rows, (size_t)count * TD_PATH_STRIDE * sizeof *rows);
    if (beside) memcpy(beside, r->path_beside, (size_t)count * TD_BESIDE_STRIDE * sizeof *beside);
    return TIDES_OK;
}
#endif
