/* Creates and frees a simulator, for the public API: checks parameters, lays out steps and units, allocates memory. */
#include "motion/td_motion.h"
#include "sensor/td_between.h"
#include "solver/td_simulator.h"
#include "td_struct.h"

#include <math.h>
#include <stdlib.h>

enum { BATCH_TILES = 1 << 14 }; /* 64 MB of planes */

/* Steps of a run at most: beyond, k step_s and (k + 1) step_s are no longer apart in nanoseconds. */
static const double most_steps = 1e12;

void tides_stepping_defaults(tides_stepping *stepping) {
    static const tides_stepping defaults = {.size = sizeof defaults,
                                            .mode = TIDES_STEPPING_ERROR,
                                            .model = TIDES_MODEL_HERMITE,
                                            .local = 1,
                                            .step_s = 0.01,
                                            .min_step_s = 1e-6,
                                            .risk = {0.3, 0.3, 0.4},
                                            .slope = TIDES_SLOPE_EXACT,
                                            .memory_mb = 256,
                                            .solve = TIDES_SOLVE_AUTO,
                                            .unit = TIDES_UNIT_AUTO};
    memcpy(stepping, &defaults, sizeof defaults); /* padding too, so that parameters can be compared as bytes */
}

static tides_status check_arguments(const tides_stepping *stepping, double start, double stop, tides_error *error) {
    if (stepping->mode < TIDES_STEPPING_FIXED || stepping->mode > TIDES_STEPPING_ERROR)
        return td_fail(error, TIDES_UNSUPPORTED, "stepping.mode: %d is none of TIDES_STEPPING_*", (int)stepping->mode);
    if (stepping->slope != TIDES_SLOPE_EXACT && stepping->slope != TIDES_SLOPE_DIFFERENCE)
        return td_fail(error, TIDES_UNSUPPORTED, "stepping.slope: %d is none of TIDES_SLOPE_*", (int)stepping->slope);
    if (stepping->slope == TIDES_SLOPE_DIFFERENCE && stepping->mode != TIDES_STEPPING_FIXED)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "stepping.slope: differences need fixed steps; the control of the others judges exact slopes");
    if (stepping->unit < TIDES_UNIT_TILE || stepping->unit > TIDES_UNIT_AUTO)
        return td_fail(error, TIDES_UNSUPPORTED, "stepping.unit: %d is none of TIDES_UNIT_*", (int)stepping->unit);
    if (!isfinite(start) || !isfinite(stop) || !(stop > start))
        return td_fail(error, TIDES_BAD_ARGUMENT, "time: start %s s, stop %s s; stop must be a time after start",
                       TD_SHORT(start), TD_SHORT(stop));
    if (start < -TD_FURTHEST_TIME || stop > TD_FURTHEST_TIME)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "time: start %s s, stop %s s; event times are 64-bit nanoseconds: stay within +-%g s", TD_SHORT(start),
                       TD_SHORT(stop), TD_FURTHEST_TIME);
    if (!(stepping->step_s > 0) || !((stop - start) / stepping->step_s < most_steps))
        return td_fail(error, TIDES_BAD_ARGUMENT, "stepping.step_s: %g s must be above 0 and make fewer than %g steps",
                       stepping->step_s, most_steps);
    return TIDES_OK;
}

/* Checks parameters that only adaptive steps read. */
static tides_status check_adaptive(const tides_stepping *stepping, tides_error *error) {
    if (stepping->mode == TIDES_STEPPING_FIXED) return TIDES_OK;
    if (stepping->mode == TIDES_STEPPING_ERROR && stepping->model != TIDES_MODEL_HERMITE)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "stepping.model: error control estimates the error of the hermite model only; use it, or another mode");
    if (!(stepping->min_step_s > 0))
        return td_fail(error, TIDES_BAD_ARGUMENT, "stepping: min_step_s %g must be above 0", stepping->min_step_s);
    if (!(stepping->tolerance >= 0) || !(stepping->time_tolerance_s >= 0))
        return td_fail(error, TIDES_BAD_ARGUMENT, "stepping: tolerance %g and time_tolerance_s %g must not be below 0",
                       stepping->tolerance, stepping->time_tolerance_s);
    if (!(stepping->memory_mb >= 1) || !(stepping->memory_mb <= 1e9))
        return td_fail(error, TIDES_BAD_ARGUMENT, "stepping.memory_mb: %g is not from 1 to 1e9 MB", stepping->memory_mb);
    if (!(stepping->risk.w_b >= 0) || !(stepping->risk.w_c >= 0) || !(stepping->risk.w_alpha >= 0))
        return td_fail(error, TIDES_BAD_ARGUMENT, "stepping.risk: weights %g, %g and %g must not be below 0",
                       stepping->risk.w_b, stepping->risk.w_c, stepping->risk.w_alpha);
    return TIDES_OK;
}

/* Fails where a path doesn't cover the run. An open path, which is extended during the run, must only begin in time. */
static tides_status check_covers(const tides_trajectory *trajectory, const char *what, double start, double stop,
                                 tides_error *error) {
    double from, to;
    tides_trajectory_range(trajectory, &from, &to);
    if (from <= start && (to >= stop || tides_trajectory_is_open(trajectory))) return TIDES_OK;
    return td_fail(error, TIDES_OUT_OF_RANGE,
                   "%s covers %.15g to %.15g s, but the run goes from %.15g to %.15g s; change time.start and "
                   "time.stop",
                   what, from, to, start, stop);
}

static tides_status check_motion(const tides_object *object, int number, double start, double stop, tides_error *error) {
    double tau, tau_dot;
    tides_status status = td_motion_time(object->motion, object->duration_s, start, &tau, &tau_dot, error);
    if (status == TIDES_OK) status = td_motion_time(object->motion, object->duration_s, stop, &tau, &tau_dot, error);
    return status == TIDES_OK ? status : td_fail_within(error, status, "the run, at object %d", number);
}

static tides_status check_paths(const tides_scene *scene, const tides_trajectory *camera, double start, double stop,
                                tides_error *error) {
    tides_status status = check_covers(camera, "the camera's path", start, stop, error);
    for (int32_t i = 0; i < tides_scene_objects(scene) && status == TIDES_OK; i++) {
        tides_object object;
        char what[64];
        snprintf(what, sizeof what, "the path of object %d", (int)i);
        status = tides_scene_object(scene, i, &object, error);
        if (status == TIDES_OK && object.trajectory) status = check_covers(object.trajectory, what, start, stop, error);
        if (status == TIDES_OK && object.motion) status = check_motion(&object, i, start, stop, error);
    }
    return status;
}

static tides_status allocate(tides_simulator *s, size_t pixels, tides_error *error) {
    int ok = (s->unit_risk = td_alloc((size_t)s->layout.units, sizeof *s->unit_risk, error)) != NULL;
    ok = ok && (s->refine.head = td_alloc((size_t)s->layout.units, sizeof *s->refine.head, error)) != NULL;
    ok = ok && (s->moving.list = td_alloc((size_t)s->layout.units, sizeof *s->moving.list, error)) != NULL;
    for (int p = 0; ok && p < s->given.sample_planes; p++)
        ok = (s->now.plane[p] = td_alloc(pixels, sizeof *s->now.plane[p], error)) != NULL &&
             (s->next.plane[p] = td_alloc(pixels, sizeof *s->next.plane[p], error)) != NULL;
    return ok ? TIDES_OK : TIDES_NO_MEMORY;
}

/* The unit of steps. If all pixels have their steps in common, it is the tile, since blocks would only add work. */
static int unit_of(const tides_simulator *s, const tides_stepping *stepping) {
    if (stepping->mode == TIDES_STEPPING_FIXED || !s->given.local) return TIDES_UNIT_TILE;
    if (stepping->unit != TIDES_UNIT_AUTO) return stepping->unit;
    return s->solve.on ? TIDES_UNIT_BLOCK : TIDES_UNIT_TILE;
}

/* Default tolerances [thresholds]: where the steps' model gives event times, and where steps only have to find events that are
 * looked up later. */
static const double model_tolerance = 0.01, finding_tolerance = 0.1;

static double tolerance_of(const tides_simulator *s, const tides_stepping *stepping) {
    if (stepping->tolerance > 0) return stepping->tolerance;
    return s->solve.on ? finding_tolerance : model_tolerance;
}

/* Sets the parameters, once it is known whether events are looked up. */
static void take_parameters(tides_simulator *s, const tides_sensor *sensor, const tides_stepping *stepping) {
    s->given.step_s = stepping->step_s;
    s->given.mode = stepping->mode;
    s->given.coupled = sensor->surround_lambda_px != 0;
    s->given.local = stepping->local && !s->given.coupled;
    s->given.min_step_s = stepping->min_step_s;
    s->given.tolerance = tolerance_of(s, stepping);
    s->given.time_tolerance_s = stepping->time_tolerance_s;
    s->given.memory_mb = stepping->memory_mb;
    s->given.risk = stepping->risk;
    s->given.slope = stepping->slope;
    s->given.unit = unit_of(s, stepping);
    s->given.sample_planes = s->refine.samples.planes = sensor->b_min > 0 ? TD_PLANES_ALL : TD_PLANES_SIGNAL;
    s->refine.samples.pixels = s->given.unit == TIDES_UNIT_BLOCK ? TD_BLOCK_PIXELS : TD_TILE_PIXELS;
    s->given.outputs = stepping->mode == TIDES_STEPPING_RISK ? TD_OUT_DIAGNOSTICS : td_fixed_outputs(s);
    if (stepping->interpolate_motion && stepping->mode != TIDES_STEPPING_FIXED)
        s->given.interpolates =
            stepping->tolerance > 0 ? stepping->tolerance : model_tolerance; /* a given tolerance holds with look-ups too */
    s->stepping = *stepping;
    s->stepping.local = stepping->local != 0;
    s->stepping.tolerance = s->given.tolerance;
    s->stepping.unit = s->given.unit;
    s->stepping.solve = s->solve.on ? TIDES_SOLVE_DOUBLE : TIDES_SOLVE_OFF;
    td_refine_bound(s);
}

/* Lays out steps and units and allocates arrays, for the renderer. */
static tides_status lay_out(tides_simulator *s, const tides_intrinsics *intrinsics, tides_error *error) {
    td_renderer_set_epoch(s->renderer, s->epoch);
    s->done.timing.size = intrinsics->width > intrinsics->height ? intrinsics->width : intrinsics->height;
    s->done.timing.rounding = td_renderer_is_double(s->renderer) ? 0 : TD_SINGLE_ROUNDING;
    s->done.timing.epsilon = td_renderer_is_double(s->renderer) ? 0 : TD_SINGLE_EPSILON;
    tides_render_stats facts;
    tides_status status = td_lay_grid(s, error);
    if (status != TIDES_OK) return status;
    tides_renderer_stats(s->renderer, &facts);
    s->layout.width = intrinsics->width;
    s->layout.height = intrinsics->height;
    s->layout.image_tiles = facts.tiles;
    s->batch.steps = 1;
    s->batch.limit = BATCH_TILES / s->layout.image_tiles;
    if (s->batch.limit > TD_BATCH_STEPS) s->batch.limit = TD_BATCH_STEPS;
    if (s->batch.limit < 1) s->batch.limit = 1;
    status = td_units_lay(s, error);
    return status == TIDES_OK ? allocate(s, (size_t)s->layout.width * (size_t)s->layout.height, error) : status;
}

/* The backend builds the kernels for samples at step ends, then those for the controller's. Interpolation of moving rows needs
 * the first. */
static tides_status prepare(tides_simulator *s, const tides_sensor *sensor, tides_error *error) {
    tides_status status = td_renderer_prepare(s->renderer, td_fixed_outputs(s), error);
    if (status == TIDES_OK && s->given.interpolates > 0)
        status = td_renderer_interpolate(s->renderer, s->given.interpolates * td_sensor_least_threshold(sensor),
                                         s->given.time_tolerance_s, error);
    return status == TIDES_OK ? td_renderer_prepare(s->renderer, s->given.outputs, error) : status;
}

/* The caller's structs, converted to this version's. */
typedef struct given {
    tides_image_params image;
    tides_sensor sensor;
    tides_stepping stepping;
} given;

static tides_status take_given(given *own, const tides_image_params *image, const tides_sensor *sensor,
                               const tides_stepping *stepping, tides_error *error) {
    tides_image_params_defaults(&own->image);
    tides_sensor_defaults(&own->sensor);
    tides_stepping_defaults(&own->stepping);
    tides_status status = TD_TAKE_STRUCT(tides_image_params, &own->image, image, error);
    if (status == TIDES_OK) status = TD_TAKE_STRUCT(tides_sensor, &own->sensor, sensor, error);
    return status == TIDES_OK ? TD_TAKE_STRUCT(tides_stepping, &own->stepping, stepping, error) : status;
}

tides_status tides_simulator_create(tides_device *device, const tides_scene *scene, const tides_trajectory *camera,
                                    const tides_intrinsics *intrinsics, const tides_image_params *image,
                                    const tides_sensor *sensor, const tides_stepping *stepping, double start, double stop,
                                    tides_progress progress, void *user, tides_simulator **simulator, tides_error *error) {
    if (!device || !scene || !camera || !intrinsics || !image || !sensor || !stepping || !simulator)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "tides_simulator_create: every argument but progress, user and error must be given");
    given own;
    tides_status status = take_given(&own, image, sensor, stepping, error);
    image = &own.image, sensor = &own.sensor, stepping = &own.stepping;
    if (status == TIDES_OK) status = check_arguments(stepping, start, stop, error);
    if (status == TIDES_OK) status = check_adaptive(stepping, error);
    if (status == TIDES_OK) status = check_paths(scene, camera, start, stop, error);
    if (status != TIDES_OK) return status;
    double begun = td_now();
    tides_simulator *s = td_alloc(1, sizeof *s, error);
    if (!s) return TIDES_NO_MEMORY;
    s->scene = scene;
    s->camera = camera;
    s->epoch = start;
    s->length = stop - start;
    status = td_sensor_check_levels(sensor, stepping->model, error);
    if (status == TIDES_OK)
        status = tides_renderer_create(device, scene, intrinsics, image, progress, user, &s->renderer, error);
    if (status == TIDES_OK) status = tides_renderer_set_psf(s->renderer, sensor->psf_sigma_px, sensor->psf_domain, error);
    if (status == TIDES_OK) status = td_solve_choose(s, sensor, stepping, error);
    if (status == TIDES_OK) take_parameters(s, sensor, stepping);
    if (status == TIDES_OK) status = lay_out(s, intrinsics, error);
    if (status == TIDES_OK) status = prepare(s, sensor, error);
    const td_sensor_tiles tiles = {s->layout.unit, s->layout.units, s->layout.width};
    if (status == TIDES_OK) status = td_sensor_create(sensor, stepping->model, image->log_eps, 0, &tiles, &s->sensor, error);
    s->sensor.start.ns += s->grid.epoch_ns;
    if (status == TIDES_OK) status = td_kick_begin(&s->sensor.kick, sensor, s->epoch, error);
    if (status == TIDES_OK) status = td_surround_steps_create(s, sensor, intrinsics->height, error);
    if (status == TIDES_OK) status = td_solve_create(s, error);
    if (status == TIDES_OK) status = td_sharing_create(&s->sharing, tides_device_threads(device), error);
    td_renderer_share(s->renderer, s->sharing.pool);
    if (status != TIDES_OK) {
        tides_simulator_destroy(s);
        return status;
    }
    s->totals.here.run_time_s = td_now() - begun; /* building kernels is part of the run */
    *simulator = s;
    return TIDES_OK;
}

void tides_simulator_destroy(tides_simulator *simulator) {
    if (!simulator) return;
    tides_renderer_destroy(simulator->renderer);
    td_refine_release(&simulator->refine);
    td_solve_release(&simulator->solve);
    td_launch_release(&simulator->launch);
    td_grid_release(&simulator->grid);
    td_readout_release(&simulator->readout);
    tides_filter_destroy(simulator->filters.filter);
    td_sensor_release(&simulator->sensor);
    td_surround_steps_release(&simulator->surround);
    for (int p = 0; p < TD_PLANES_ALL; p++) {
        free(simulator->now.plane[p]);
        free(simulator->next.plane[p]);
    }
    free(simulator->layout.unit);
    free(simulator->layout.first_pixel);
    free(simulator->moving.list);
    free(simulator->unit_risk);
    td_work_release(&simulator->done.work);
    td_solve_portion_release(&simulator->done.solve);
    td_sharing_release(&simulator->sharing);
    free(simulator->packet.scratch);
    free(simulator->undo.bytes);
    free(simulator);
}

void tides_simulator_state(const tides_simulator *simulator, double *signal, double *reference, uint32_t *count_on,
                           uint32_t *count_off) {
    for (int t = 0; t < simulator->layout.units; t++) {
        const td_tile *tile = &simulator->layout.unit[t];
        for (int i = 0; i < tile->count; i++) {
            size_t from = simulator->layout.first_pixel[t] + (size_t)i;
            size_t to = (size_t)(tile->y0 + i / tile->width) * simulator->layout.width + (size_t)(tile->x0 + i % tile->width);
            if (signal) signal[to] = simulator->started ? td_signal_now(simulator, from) : NAN;
            if (reference) reference[to] = simulator->started ? simulator->sensor.pixels.reference[from] : NAN;
            if (count_on) count_on[to] = simulator->sensor.pixels.count_on[from];
            if (count_off) count_off[to] = simulator->sensor.pixels.count_off[from];
        }
    }
}
