/* Launches motions on an OpenCL device. Aborts if the device fails. */
#include "tests/support/motion_device.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

static void expect(tides_status status, const char *what, const tides_error *error) {
    if (status == TIDES_OK) return;
    fprintf(stderr, "motion_device: %s: %s\n", what, error->text);
    abort();
}

static void send_reals(tides_device *device, td_buffer *buffer, const double *from, size_t count) {
    tides_error error = {0};
    float *to = malloc((count ? count : 1) * sizeof *to);
    if (!to) abort();
    for (size_t i = 0; i < count; i++) to[i] = (float)from[i];
    expect(td_buffer_write(device, buffer, to, (count ? count : 1) * sizeof *to, &error), "write", &error);
    free(to);
}

static void send_mover(motion_device *on) {
    tides_error error = {0};
    move_job job = motion_rows_job(on->packed, NULL, NULL, 0);
    void *mover = calloc(1, move_mover_bytes());
    if (!mover) abort();
    move_mover_f32(&job, mover);
    expect(td_buffer_write(on->device, &on->mover, mover, move_mover_bytes(), &error), "write", &error);
    free(mover);
}

motion_device motion_device_make(tides_device *device, const packed_motion *packed, int capacity, int sh_stride) {
    motion_device on;
    tides_error error = {0};
    char defines[320];
    size_t rows = (size_t)capacity, sh = packed->numbers.moves_sh ? rows * (size_t)sh_stride : 16;
    memset(&on, 0, sizeof on);
    on.device = device, on.packed = packed, on.capacity = capacity, on.sh_stride = sh_stride;
    snprintf(defines, sizeof defines, "#define TD_BUILD_MODEL %d\n%s", packed->motion->type->code, packed->numbers.defines);
    expect(td_kernel_create(device, "motion.cl", defines, "td_move_gaussians", &on.kernel, &error), "build", &error);
    send_mover(&on);
    send_reals(device, &on.data, packed->numbers.data, packed->numbers.data_count);
    expect(td_buffer_reserve(device, &on.geometry, rows * TD_GEOMETRY_STRIDE * sizeof(float), &error), "reserve", &error);
    expect(td_buffer_reserve(device, &on.rates, rows * TD_GEOMETRY_STRIDE * sizeof(float), &error), "reserve", &error);
    expect(td_buffer_reserve(device, &on.sh, sh * sizeof(float), &error), "reserve", &error);
    expect(td_buffer_reserve(device, &on.sh_rates, sh * sizeof(float), &error), "reserve", &error);
    return on;
}

void motion_device_free(motion_device *on) {
    td_buffer *buffers[] = {&on->mover,    &on->data,  &on->moment, &on->jobs,    &on->index,
                            &on->geometry, &on->rates, &on->sh,     &on->sh_rates};
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) td_buffer_release(buffers[i]);
    clReleaseKernel(on->kernel);
}

void motion_device_set(motion_device *on, const int *index, int count, int job_size) {
    tides_error error = {0};
    int padded = (count + TD_PAD - 1) / TD_PAD * TD_PAD, jobs = (padded + job_size - 1) / job_size;
    int *list = malloc((size_t)padded * sizeof *list);
    td_move_job *job = calloc((size_t)jobs, sizeof *job);
    if (!list || !job || padded > on->capacity) abort();
    for (int i = 0; i < padded; i++) {
        int at = i < count ? i : count - 1;
        list[i] = index ? index[at] : at;
    }
    for (int j = 0; j < jobs; j++) {
        job[j].first = job[j].row = j * job_size;
        job[j].count = padded - job[j].first < job_size ? padded - job[j].first : job_size;
    }
    expect(td_buffer_write(on->device, &on->index, list, (size_t)padded * sizeof *list, &error), "write", &error);
    expect(td_buffer_write(on->device, &on->jobs, job, (size_t)jobs * sizeof *job, &error), "write", &error);
    on->jobs_count = jobs;
    free(list);
    free(job);
}

motion_time motion_time_now(void) {
    struct timespec processor = {0};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &processor);
    return (motion_time){td_now(), (double)processor.tv_sec + 1e-9 * (double)processor.tv_nsec};
}

motion_time motion_time_since(motion_time begun) {
    motion_time now = motion_time_now();
    return (motion_time){now.elapsed - begun.elapsed, now.processor - begun.processor};
}

motion_time motion_device_run(motion_device *on, double tau, int side) {
    tides_error error = {0};
    double moment[TD_MOMENT_REALS];
    size_t local = 1, global = (size_t)on->jobs_count;
    int first = 0;
    td_motion_moment(on->packed->motion, tau, 1, side, moment);
    send_reals(on->device, &on->moment, moment, TD_MOMENT_REALS);
    const td_argument arguments[] = {TD_BUFFER_ARGUMENT(on->mover),    TD_BUFFER_ARGUMENT(on->data),
                                     TD_BUFFER_ARGUMENT(on->moment),   TD_BUFFER_ARGUMENT(on->jobs),
                                     TD_BUFFER_ARGUMENT(on->index),    TD_VALUE_ARGUMENT(first),
                                     TD_VALUE_ARGUMENT(on->sh_stride), TD_VALUE_ARGUMENT(first),
                                     TD_BUFFER_ARGUMENT(on->geometry), TD_BUFFER_ARGUMENT(on->rates),
                                     TD_BUFFER_ARGUMENT(on->sh),       TD_BUFFER_ARGUMENT(on->sh_rates)};
    clFinish(on->device->queue);
    motion_time begun = motion_time_now();
    expect(td_launch(on->device, on->kernel, 1, &global, &local, TD_ARGUMENTS(arguments), NULL, &error), "launch", &error);
    clFinish(on->device->queue);
    return motion_time_since(begun);
}

static void read_reals(motion_device *on, const td_buffer *buffer, double *to, size_t count) {
    tides_error error = {0};
    float *from = malloc((count ? count : 1) * sizeof *from);
    if (!from) abort();
    expect(td_buffer_read(on->device, buffer, from, count * sizeof *from, &error), "read", &error);
    for (size_t i = 0; i < count; i++) to[i] = from[i];
    free(from);
}

motion_rows motion_device_read(motion_device *on, int count) {
    motion_rows rows = motion_rows_make(on->packed, count, on->sh_stride);
    read_reals(on, &on->geometry, rows.geometry, (size_t)count * TD_GEOMETRY_STRIDE);
    read_reals(on, &on->rates, rows.rates, (size_t)count * TD_GEOMETRY_STRIDE);
    if (!rows.sh) return rows;
    read_reals(on, &on->sh, rows.sh, (size_t)count * (size_t)on->sh_stride);
    read_reals(on, &on->sh_rates, rows.sh_rates, (size_t)count * (size_t)on->sh_stride);
    return rows;
}
