/* Rows interpolated between other rows on an OpenCL device, and misfits, the errors of interpolation. */
#include "td_opencl.h"

enum { TERM_REALS = 3 + TD_CUBIC_REALS };

/* td_misfit_terms in the device's precision. */
typedef struct device_terms {
    cl_float real[TERM_REALS]; /* duration, tolerance, time_tolerance, middle */
    cl_int moves_sh;
} device_terms;

static tides_status launch_cubics(opencl_backend *b, size_t jobs, tides_error *error) {
    size_t local = td_opencl_group_size(b), global = jobs * local;
    cl_int first_row = b->gaussians, sh_stride = b->image.sh_stride;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(b->cubics.cubic_jobs),
                                     TD_BUFFER_ARGUMENT(b->cubics.cubics),
                                     TD_BUFFER_ARGUMENT(b->motion.move_gaussians),
                                     TD_VALUE_ARGUMENT(first_row),
                                     TD_VALUE_ARGUMENT(sh_stride),
                                     TD_BUFFER_ARGUMENT(b->scene.geometry),
                                     TD_BUFFER_ARGUMENT(b->scene.rates),
                                     TD_BUFFER_ARGUMENT(b->scene.sh),
                                     TD_BUFFER_ARGUMENT(b->scene.sh_rates)};
    return td_launch(b->device, b->cubics.cubic_kernel, 1, &global, &local, TD_ARGUMENTS(arguments), NULL, error);
}

tides_status td_opencl_run_cubics(opencl_backend *b, const td_move_batch *moves, tides_error *error) {
    size_t jobs = (size_t)moves->cubic_job_count;
    if (jobs == 0) return TIDES_OK;
    tides_status status =
        td_opencl_write_reals(b, &b->cubics.cubics, moves->cubics, (size_t)moves->cubic_count * TD_CUBIC_REALS, error);
    if (status == TIDES_OK)
        status = td_buffer_write(b->device, &b->cubics.cubic_jobs, moves->cubic_jobs, jobs * sizeof *moves->cubic_jobs, error);
    return status == TIDES_OK ? launch_cubics(b, jobs, error) : status;
}

static tides_status launch_misfits(opencl_backend *b, const td_misfit_request *request, tides_error *error) {
    size_t local = td_opencl_group_size(b), lanes = (size_t)b->device->info.lanes;
    size_t groups = ((size_t)request->count + lanes - 1) / lanes, global = (groups + local - 1) / local * local;
    cl_int sh_stride = b->image.sh_stride, count = request->count;
    cl_int row0 = request->row[0], row1 = request->row[1], row2 = request->row[2];
    if (global == 0) global = local;
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(b->scene.image_buffer),
                                     TD_SOURCE_ARGUMENTS(b),
                                     TD_VALUE_ARGUMENT(sh_stride),
                                     TD_VALUE_ARGUMENT(count),
                                     TD_VALUE_ARGUMENT(row0),
                                     TD_VALUE_ARGUMENT(row1),
                                     TD_VALUE_ARGUMENT(row2),
                                     TD_BUFFER_ARGUMENT(b->cubics.misfit_terms),
                                     TD_BUFFER_ARGUMENT(b->cubics.misfits)};
    return td_launch(b->device, b->cubics.misfit_kernel, 1, &global, &local, TD_ARGUMENTS(arguments), NULL, error);
}

static tides_status send_terms(opencl_backend *b, const td_misfit_request *request, tides_error *error) {
    device_terms terms = {.real = {(float)request->duration, (float)request->tolerance, (float)request->time_tolerance_s},
                          .moves_sh = request->moves_sh};
    for (int i = 0; i < TD_CUBIC_REALS; i++) terms.real[3 + i] = (float)request->middle[i];
    return td_buffer_write(b->device, &b->cubics.misfit_terms, &terms, sizeof terms, error);
}

tides_status td_opencl_misfits(td_backend *backend, const td_misfit_request *request, float *misfits, tides_error *error) {
    opencl_backend *b = (opencl_backend *)backend;
    double begun = td_now();
    size_t bytes = (size_t)request->count * sizeof *misfits;
    tides_status status =
        td_opencl_write_reals(b, &b->work.views, request->views, (size_t)3 * b->objects * TD_VIEW_REALS, error);
    if (status == TIDES_OK) status = send_terms(b, request, error);
    if (status == TIDES_OK) status = td_buffer_reserve(b->device, &b->cubics.misfits, bytes, error);
    if (status == TIDES_OK) status = launch_misfits(b, request, error);
    if (status == TIDES_OK) status = td_buffer_read(b->device, &b->cubics.misfits, misfits, bytes, error);
    backend->stats.time_motion_s += td_now() - begun;
    return status;
}

/* Runs a job and a request without Gaussians: drivers such as PoCL compile when a kernel first runs. */
static tides_status warm_up(opencl_backend *b, tides_error *error) {
    static const td_cubic_job nothing = {0, 0, 0, 0, 0, 0, 0, 0};
    static const double zeros[TD_CUBIC_REALS] = {0};
    td_misfit_request none;
    memset(&none, 0, sizeof none);
    tides_status status = td_buffer_write(b->device, &b->cubics.cubic_jobs, &nothing, sizeof nothing, error);
    if (status == TIDES_OK) status = td_opencl_write_reals(b, &b->cubics.cubics, zeros, TD_CUBIC_REALS, error);
    if (status == TIDES_OK) status = launch_cubics(b, 1, error);
    if (status == TIDES_OK) status = send_terms(b, &none, error);
    if (status == TIDES_OK) status = td_buffer_reserve(b->device, &b->cubics.misfits, TD_PAD * sizeof(cl_float), error);
    if (status == TIDES_OK)
        status = td_buffer_reserve(b->device, &b->work.views, (size_t)3 * b->objects * TD_VIEW_REALS * sizeof(cl_float), error);
    if (status == TIDES_OK) status = launch_misfits(b, &none, error);
    return td_finish(b->device, status, error);
}

tides_status td_opencl_prepare_cubics(td_backend *backend, tides_error *error) {
    opencl_backend *b = (opencl_backend *)backend;
    tides_status status =
        td_opencl_make_kernel(b, "interpolate.cl", "td_interpolate_rows", TD_OUT_SIGNAL, &b->cubics.cubic_kernel, error);
    if (status == TIDES_OK)
        status = td_opencl_make_kernel(b, "misfit.cl", "td_measure_misfits", TD_OUT_SIGNAL, &b->cubics.misfit_kernel, error);
    double begun = td_now();
    if (status == TIDES_OK) status = warm_up(b, error);
    backend->stats.time_build_s += td_now() - begun;
    return status;
}

void td_opencl_cubics_release(opencl_backend *b) {
    td_buffer *buffers[] = {&b->cubics.cubics, &b->cubics.cubic_jobs, &b->cubics.misfit_terms, &b->cubics.misfits};
    if (b->cubics.cubic_kernel) clReleaseKernel(b->cubics.cubic_kernel);
    if (b->cubics.misfit_kernel) clReleaseKernel(b->cubics.misfit_kernel);
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) td_buffer_release(buffers[i]);
}
