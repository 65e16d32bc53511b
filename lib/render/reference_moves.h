/* Rows of Gaussians that move by themselves: computed by their motion, or interpolated, and the errors of interpolation.
 * Included by reference_body.h, in its precision. */

/* Grows an array to `count` numbers, and keeps its contents. */
static tides_status grow(td_real **array, size_t count, tides_error *error) {
    td_real *grown = realloc(*array, count * sizeof *grown);
    if (!grown) return td_fail(error, TIDES_NO_MEMORY, "out of memory: %zu numbers for moving Gaussians", count);
    *array = grown;
    return TIDES_OK;
}

/* Makes room for `rows` moved rows behind the store's. */
static tides_status grow_rows(reference *r, int rows, tides_error *error) {
    if (rows <= r->rows) return TIDES_OK;
    size_t all = (size_t)r->count + (size_t)rows, sh = r->moved.moves_sh ? (size_t)r->image.sh_stride : 0;
    int *owners = realloc(r->moved.owners, 2 * (size_t)rows * sizeof *owners);
    if (!owners) return td_fail(error, TIDES_NO_MEMORY, "out of memory: %d rows of moving Gaussians", rows);
    r->source.owners = r->moved.owners = owners;
    tides_status status = grow(&r->arrays[0], all * TD_GEOMETRY_STRIDE, error);
    if (status == TIDES_OK) status = grow(&r->arrays[1], (size_t)rows * TD_GEOMETRY_STRIDE, error);
    if (status == TIDES_OK && sh) status = grow(&r->arrays[2], all * sh, error);
    if (status == TIDES_OK && sh) status = grow(&r->arrays[3], (size_t)rows * sh, error);
    r->source.geometry = r->arrays[0];
    r->source.rates = r->arrays[1];
    r->source.sh = r->arrays[2];
    r->source.sh_rates = r->arrays[3];
    if (status == TIDES_OK) r->rows = rows;
    return status;
}

static td_theta_sink sink_of(const reference *r, int row) {
    size_t rate = (size_t)(row - r->count), sh = r->moved.moves_sh ? (size_t)r->image.sh_stride : 0;
    td_theta_sink sink = {r->arrays[0] + (size_t)row * TD_GEOMETRY_STRIDE,
                          r->arrays[1] + rate * TD_GEOMETRY_STRIDE,
                          r->arrays[2] + (size_t)row * sh,
                          sh ? r->arrays[3] + rate * sh : NULL,
                          r->image.sh_stride,
                          0};
    return sink;
}

static void run_move_job(reference *r, const td_move_job *job, const td_move_batch *moves) {
    const td_mover *mover = r->moved.movers + job->mover;
    const td_real *moment = r->moved.moments + (size_t)job->moment * TD_MOMENT_REALS;
    for (int i = 0; i < job->count; i++) {
        td_theta_sink sink = sink_of(r, job->row + i);
        sink.tau_dot = moment[TD_MOMENT_TAU_DOT];
        td_move_group(mover, r->moved.data + mover->data, moment, moves->gaussians[job->first + i], &sink);
    }
}

static void take_host_rows(reference *r, const td_host_rows *run, const td_move_batch *moves) {
    td_theta_sink sink = sink_of(r, run->row);
    size_t count = (size_t)run->count, from = (size_t)run->from, sh = (size_t)r->image.sh_stride;
    narrow(moves->host_geometry + from * TD_GEOMETRY_STRIDE, sink.geometry, count * TD_GEOMETRY_STRIDE);
    narrow(moves->host_rates + from * TD_GEOMETRY_STRIDE, sink.rates, count * TD_GEOMETRY_STRIDE);
    if (!moves->host_sh) return;
    narrow(moves->host_sh + from * sh, sink.sh, count * sh);
    narrow(moves->host_sh_rates + from * sh, sink.sh_rates, count * sh);
}

static td_row_arrays rows_of(const reference *r) {
    td_row_arrays rows = {r->arrays[0], r->arrays[1], r->arrays[2], r->arrays[3], r->source.first_rate, r->image.sh_stride};
    return rows;
}

static void run_cubic_job(reference *r, const td_cubic_job *job, const td_move_batch *moves) {
    td_row_arrays rows = rows_of(r);
    td_cubic cubic;
    narrow(moves->cubics + (size_t)job->cubic * TD_CUBIC_REALS, (td_real *)&cubic, TD_CUBIC_REALS);
    for (int i = 0; i < job->count; i++) td_cubic_group(&cubic, moves->gaussians, job, i, &rows);
}

static tides_status move(td_backend *backend, const td_move_batch *moves, tides_error *error) {
    reference *r = (reference *)backend;
    double begun = td_now();
    size_t reals = (size_t)moves->moment_count * TD_MOMENT_REALS;
    tides_status status = grow_rows(r, moves->row + moves->row_count - r->count, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&r->moved.moments, &r->moved.moment_capacity, reals, sizeof *r->moved.moments, error);
    if (status != TIDES_OK) return status;
    narrow(moves->moments, r->moved.moments, reals);
    memcpy(r->moved.owners + 2 * (size_t)(moves->row - r->count), moves->owners,
           2 * (size_t)moves->row_count * sizeof *r->moved.owners);
    for (int i = 0; i < moves->kind_first[r->moved.kinds]; i++) run_move_job(r, &moves->jobs[i], moves);
    for (int i = 0; i < moves->host_runs; i++) take_host_rows(r, &moves->host[i], moves);
    for (int i = 0; i < moves->cubic_job_count; i++) run_cubic_job(r, &moves->cubic_jobs[i], moves);
    backend->stats.time_motion_s += td_now() - begun;
    return status;
}

static tides_status prepare_cubics(td_backend *backend, tides_error *error) {
    (void)backend, (void)error; /* nothing has to be built */
    return TIDES_OK;
}

static tides_status misfits(td_backend *backend, const td_misfit_request *request, float *misfit, tides_error *error) {
    reference *r = (reference *)backend;
    td_row_arrays rows = rows_of(r);
    td_misfit_terms terms;
    double begun = td_now();
    tides_status status = copy_views(r, request->views, 3, error);
    if (status != TIDES_OK) return status;
    terms.duration = (td_real)request->duration;
    terms.tolerance = (td_real)request->tolerance;
    terms.time_tolerance = (td_real)request->time_tolerance_s;
    narrow(request->middle, (td_real *)&terms.middle, TD_CUBIC_REALS);
    terms.moves_sh = request->moves_sh;
    for (int i = 0; i < request->count; i++) {
        const int row[3] = {request->row[0] + i, request->row[1] + i, request->row[2] + i};
        misfit[i] = (float)td_misfit_group(r->views, &r->image, &r->source, r->object, &rows, row, &terms);
    }
    backend->stats.time_motion_s += td_now() - begun;
    return TIDES_OK;
}
