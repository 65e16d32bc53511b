/* Test support: the simulator on signals in closed form. Functions of pixel and time replace a backend's renders, so that the
 * signal is known to the last bit, and only step control and comparator are tested. */
#ifndef TESTS_PROPERTY_SIGNAL_WORLD_H
#define TESTS_PROPERTY_SIGNAL_WORLD_H

#include "tests/property/simulator_run.h"
#include "tests/support/scene_make.h"

/* S and S_dot of pixel (x, y) at `time` [s]. */
typedef void (*signal_of)(const void *about, int x, int y, double time, double *S, double *S_dot);

/* The class in the backend's place: first, so that the one points at the other. */
typedef struct signal_class {
    td_backend_class type;
    const td_backend_class *own;
    signal_of signal;
    const void *about;
    int width, height;
    double noise;  /* uniform, of so much to either side, on S: what rounding does */
    double travel; /* what the sweep says */
    size_t most;   /* samples at once in the last macro step, set by a run */
    size_t limit;  /* and how many were allowed */
    int early;     /* steps were compared before all were refined */
} signal_class;

/* The camera goes along x by its speed of 1 a second: where it is says when. */
static inline double time_of_slot(const td_batch *batch, int slot) {
    const double *view = batch->views + (size_t)slot * TD_VIEW_REALS;
    return -view[18]; /* t of td_view: r, r_dot are 9 each */
}

static inline double noise_at(double time, int x, int y) {
    uint64_t seed;
    memcpy(&seed, &time, sizeof seed);
    seed ^= (uint64_t)(y * 4096 + x + 1) * 0x9e3779b97f4a7c15u;
    for (int i = 0; i < 3; i++) scene_next(&seed);
    return 2 * ((double)(scene_next(&seed) >> 11) * 0x1p-53) - 1;
}

static inline tides_status render_signals(td_backend *backend, const td_batch *batch, double *planes, tides_error *error) {
    const signal_class *world = (const void *)backend->type;
    (void)error;
    for (int k = 0; k < batch->job_count; k++) {
        const td_job *tile_job = &batch->jobs[k];
        double time = time_of_slot(batch, tile_job->slot),
               *tile = planes + (size_t)tile_job->out * batch->outputs * TD_TILE_PIXELS;
        memset(tile, 0, (size_t)batch->outputs * TD_TILE_PIXELS * sizeof *tile);
        for (int y = 0; y < TD_TILE && tile_job->y + y < world->height; y++)
            for (int x = 0; x < TD_TILE && tile_job->x + x < world->width; x++) {
                double S, S_dot;
                int at = td_tile_pixel(x, y);
                world->signal(world->about, tile_job->x + x, tile_job->y + y, time, &S, &S_dot);
                if (world->noise > 0) S += world->noise * noise_at(time, tile_job->x + x, tile_job->y + y);
                tile[TD_OUT_L * TD_TILE_PIXELS + at] = S;
                tile[TD_OUT_L_DOT * TD_TILE_PIXELS + at] = S_dot;
                if (batch->outputs > TD_OUT_SIGNAL) tile[TD_OUT_ALPHA * TD_TILE_PIXELS + at] = 1;
            }
        if (batch->in_order) batch->in_order[tile_job->out] = 0;
    }
    backend->stats.tile_jobs += (uint64_t)batch->job_count;
    for (int k = 0; k < batch->job_count; k++)
        for (int block = 0; block < TD_TILE_BLOCKS; block++)
            backend->stats.blocks += (uint64_t)(batch->jobs[k].blocks >> block & 1);
    return TIDES_OK;
}

static inline tides_status sweep_signals(td_backend *backend, const td_sweep_request *request, float *boxes, float *travel,
                                         tides_error *error) {
    const signal_class *world = (const void *)backend->type;
    (void)error;
    for (int i = request->begin; i < request->end; i++) {
        const float all[4] = {0, 0, (float)world->width, (float)world->height}, none[4] = {0, 0, -1, -1};
        memcpy(boxes + 4 * (size_t)i, i == 0 ? all : none, sizeof all);
        travel[i] = (float)world->travel;
    }
    return TIDES_OK;
}

/* A splat for the candidate lists, and the path that tells the time, good for [0, 10 s]. */
static inline void make_signal_scene(tides_scene **scene, tides_trajectory **path) {
    const float mean[3] = {0, 0, 5}, quaternion[4] = {1, 0, 0, 0}, log_scale[3] = {0, 0, 0}, logit = 1, sh[3] = {0};
    const tides_gaussians gaussian =
        {.count = 1, .mean = mean, .log_scale = log_scale, .quaternion = quaternion, .opacity_logit = &logit, .sh = sh};
    tides_pose_sample samples[3] = {{0}};
    tides_error error;
    for (int i = 0; i < 3; i++) {
        samples[i].time = samples[i].position[0] = 5 * i;
        samples[i].quaternion[0] = 1;
    }
    scene_expect_ok(tides_scene_create(scene, &error), &error);
    scene_expect_ok(tides_scene_add(*scene, &gaussian, NULL, 1, NULL, NULL, &error), &error);
    scene_expect_ok(tides_trajectory_create(samples, 3, path, &error), &error);
}

/* One macro step after the other of 10 ms each, of width x height pixels. */
static inline job signal_job(const tides_scene *scene, const tides_trajectory *path, int width, int height) {
    job j = {.device = "reference", .scene = scene, .path = path, .camera = {width, height, 100, 100, 0, 0, {0}}, .stop = 0.01};
    tides_sensor_defaults(&j.sensor);
    model_steps(&j.stepping);
    return j;
}

/* A run in calls that end at the shares `cuts` of the run (count of them; the rest in one more). */
static inline outcome run_signal_in(const job *j, signal_class *world, const double *cuts, size_t count) {
    tides_device *device = open_device(j->device);
    tides_simulator *s = make_simulator(j, device);
    tides_error error;
    outcome o = {0};
    world->own = s->renderer->backend->type;
    world->type = *world->own;
    world->type.render = render_signals;
    world->type.sweep = sweep_signals;
    world->width = j->camera.width;
    world->height = j->camera.height;
    s->renderer->backend->type = &world->type;
    begin(j, s, &o);
    for (size_t i = 0; i < count; i++)
        scene_expect_ok(tides_simulator_run(s, j->start + cuts[i] * (j->stop - j->start), collect, &o, NULL, NULL, &error),
                        &error);
    scene_expect_ok(tides_simulator_run(s, j->stop, collect, &o, NULL, NULL, &error), &error);
    finish(s, &o);
    world->most = s->refine.samples.made;
    world->limit = s->refine.limit;
    world->early = s->refine.early;
    tides_simulator_destroy(s);
    tides_device_close(device);
    return o;
}

static inline outcome run_signal(const job *j, signal_class *world) { return run_signal_in(j, world, NULL, 0); }

/* The same in steps 100 times shorter, none longer: what the signal's events are. */
static inline outcome truth_of_signal(const job *j, const signal_class *world) {
    job fine = *j;
    signal_class exact = *world;
    exact.noise = 0;
    fine.stepping.mode = TIDES_STEPPING_FIXED;
    fine.stepping.step_s = j->stepping.step_s / 1000;
    return run_signal(&fine, &exact);
}

#endif
