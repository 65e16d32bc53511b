/* What a run file says of frames and of the baselines, as the structs that the library takes. */
#include "td_run.h"

#include <stdlib.h>
#include <string.h>

/* A number of the table and where it goes. */
typedef struct number_row {
    const char *key;
    double *field;
} number_row;

static void get_numbers(const tides_run *run, const number_row *rows, size_t count) {
    for (size_t i = 0; i < count; i++) *rows[i].field = td_run_number(run, rows[i].key);
}

/* The place of a choice's value in `names`; the table has checked that it is one of them. */
static int32_t get_choice(const tides_run *run, const char *key, const char *const *names) {
    int32_t place = 0;
    while (names[place] && strcmp(names[place], td_run_value(run, key)->valuestring) != 0) place++;
    return place;
}

static int32_t get_boolean(const tides_run *run, const char *key) { return cJSON_IsTrue(td_run_value(run, key)) ? 1 : 0; }

static void get_esim(const tides_run *run, tides_esim *p) {
    static const char *const sampling[] = {"none", "brightness", "motion", NULL}; /* TIDES_ESIM_* */
    const number_row rows[] = {{"esim.contrast_threshold_pos", &p->contrast_threshold_pos},
                               {"esim.contrast_threshold_neg", &p->contrast_threshold_neg},
                               {"esim.contrast_threshold_sigma_pos", &p->contrast_threshold_sigma_pos},
                               {"esim.contrast_threshold_sigma_neg", &p->contrast_threshold_sigma_neg},
                               {"esim.refractory_period_ns", &p->refractory_period_ns},
                               {"esim.log_eps", &p->log_eps},
                               {"esim.simulation_adaptive_sampling_lambda", &p->adaptive_sampling_lambda},
                               {"esim.simulation_minimum_framerate", &p->minimum_framerate}};
    get_numbers(run, rows, sizeof rows / sizeof *rows);
    p->use_log_image = get_boolean(run, "esim.use_log_image");
    p->adaptive_sampling = get_choice(run, "esim.simulation_adaptive_sampling_method", sampling);
}

static void get_v2e(const tides_run *run, tides_v2e *p) {
    const number_row rows[] = {{"v2e.pos_thres", &p->pos_thres},
                               {"v2e.neg_thres", &p->neg_thres},
                               {"v2e.sigma_thres", &p->sigma_thres},
                               {"v2e.cutoff_hz", &p->cutoff_hz},
                               {"v2e.leak_rate_hz", &p->leak_rate_hz},
                               {"v2e.leak_jitter_fraction", &p->leak_jitter_fraction},
                               {"v2e.noise_rate_cov_decades", &p->noise_rate_cov_decades},
                               {"v2e.shot_noise_rate_hz", &p->shot_noise_rate_hz},
                               {"v2e.refractory_period", &p->refractory_period},
                               {"v2e.cs_lambda_pixels", &p->cs_lambda_pixels},
                               {"v2e.cs_tau_p_ms", &p->cs_tau_p_ms}};
    get_numbers(run, rows, sizeof rows / sizeof *rows);
    p->photoreceptor_noise = get_boolean(run, "v2e.photoreceptor_noise");
    p->hdr = get_boolean(run, "v2e.hdr");
    p->float32_timestamps = get_boolean(run, "v2e.float32_timestamps");
}

static void get_iebcs(const tides_run *run, tides_iebcs *p) {
    static const char *const arbiters[] = {"none", "bottleneck", "row", "synchronous", NULL}; /* TIDES_ARBITER_* */
    const number_row rows[] = {{"iebcs.th_pos", &p->th_pos},
                               {"iebcs.th_neg", &p->th_neg},
                               {"iebcs.th_noise", &p->th_noise},
                               {"iebcs.lat", &p->lat},
                               {"iebcs.jit", &p->jit},
                               {"iebcs.ref", &p->ref},
                               {"iebcs.tau", &p->tau},
                               {"iebcs.bgnp", &p->bgnp},
                               {"iebcs.bgnn", &p->bgnn},
                               {"iebcs.scale", &p->scale},
                               {"iebcs.arbiter_us", &p->arbiter_us}};
    get_numbers(run, rows, sizeof rows / sizeof *rows);
    p->noise_pos = run->noise_files[0];
    p->noise_neg = run->noise_files[1];
    p->arbiter = get_choice(run, "iebcs.arbiter", arbiters);
}

static void get_voltmeter(const tides_run *run, tides_voltmeter *p) {
    const number_row rows[] = {{"voltmeter.k1", &p->k1}, {"voltmeter.k2", &p->k2}, {"voltmeter.k3", &p->k3},
                               {"voltmeter.k4", &p->k4}, {"voltmeter.k5", &p->k5}, {"voltmeter.k6", &p->k6}};
    get_numbers(run, rows, sizeof rows / sizeof *rows);
}

void td_run_get_frames(const tides_run *run, tides_run_values *values) {
    static const char *const methods[] = {"tides", "esim", "v2e", "iebcs", "dvs-voltmeter", "ldati", NULL}; /* TIDES_METHOD_* */
    static const char *const transfers[] = {"linear", "srgb", NULL};          /* TIDES_TRANSFER_* */
    static const char *const units[] = {"auto", "s", "ms", "us", "ns", NULL}; /* TIDES_TIME_* */
    tides_baseline_params *baseline = &values->baseline;
    tides_baseline_params_defaults(baseline);
    baseline->method = get_choice(run, "method", methods);
    baseline->seed = strtoull(td_run_value(run, "seed")->valuestring, NULL, 10); /* the table has checked it */
    baseline->sensor = values->sensor;
    baseline->log_eps = values->image.log_eps;
    get_esim(run, &baseline->esim);
    get_v2e(run, &baseline->v2e);
    get_voltmeter(run, &baseline->voltmeter);
    get_iebcs(run, &baseline->iebcs);
    baseline->ldati.fps = td_run_number(run, "ldati.fps");
    tides_frames_options *frames = &values->frames;
    tides_frames_options_defaults(frames);
    frames->transfer = get_choice(run, "frames.transfer", transfers);
    frames->unit = get_choice(run, "frames.timestamps_unit", units);
    frames->rebase = get_boolean(run, "frames.rebase");
    frames->timestamps = run->timestamps_file;
    frames->frames_per_second = td_run_number(run, "frames.frames_per_second"); /* 0 where null: not given */
    if (baseline->method == TIDES_METHOD_LDATI) {
        frames->planes = 2 * TIDES_LDATI_PLANES;
        /* Grid k begins at k / fps unless frames.* has times. */
        if (!(frames->frames_per_second > 0) && !frames->timestamps) frames->frames_per_second = baseline->ldati.fps;
    }
    memcpy(frames->luminance, values->image.luminance, sizeof frames->luminance);
    values->frames_file = run->frames_file;
    values->frames_per_second = td_run_number(run, "frames_per_second");
}

/* A file that a row names, against the run's directory; `*file` stays NULL where the row is null. */
static tides_status resolve(const tides_run *run, const char *key, char **file, tides_error *error) {
    const cJSON *value = td_run_value(run, key);
    if (!cJSON_IsString(value)) return TIDES_OK;
    *file = td_run_resolve(run, value->valuestring, error);
    return *file ? TIDES_OK : TIDES_NO_MEMORY;
}

tides_status td_run_derive_frames(tides_run *run, tides_error *error) {
    tides_status status = resolve(run, "frames.file", &run->frames_file, error);
    if (status == TIDES_OK) status = resolve(run, "frames.timestamps", &run->timestamps_file, error);
    if (status == TIDES_OK) status = resolve(run, "iebcs.noise_pos", &run->noise_files[0], error);
    return status == TIDES_OK ? resolve(run, "iebcs.noise_neg", &run->noise_files[1], error) : status;
}

void td_run_free_frames(tides_run *run) {
    free(run->frames_file);
    free(run->timestamps_file);
    free(run->noise_files[0]);
    free(run->noise_files[1]);
}

tides_status tides_run_open_frames(const tides_run *run, tides_frames **frames, tides_error *error) {
    if (!run || !frames) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_run_open_frames: run or frames is NULL");
    if (!run->frames_file)
        return td_fail(error, TIDES_BAD_CONFIG, "%s: frames.file is missing: name a folder of pictures or an array file",
                       run->origin);
    tides_run_values values;
    tides_run_get(run, &values);
    return tides_frames_open(run->frames_file, &values.frames, frames, error);
}
