/* Writes inertial measurements of a run's camera to files, with the biases that they contain. */
#include "archive/td_npy.h"
#include "camera/td_rotation.h"
#include "run/td_imu_file.h"
#include "run/td_run.h"
#include "run/td_session.h"
#include "tides/inputs.h"
#include "td_base.h"
#include "td_folder.h"
#include "td_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Measurements of a run. */
typedef struct recording {
    const tides_session_facts *facts;
    tides_imu_sample *samples;
    size_t count;
} recording;

/* Time of sample k in whole nanoseconds, as an offset from the start: so it is a multiple of the period at any epoch. */
static int64_t nanoseconds(const recording *r, size_t k) {
    const double start = r->facts->values.start, whole = floor(start);
    return (int64_t)whole * 1000000000 + llround((start - whole) * 1e9 + (double)k * 1e9 / r->facts->values.imu.rate_hz);
}

static int64_t seconds_of(int64_t ns) { return ns / 1000000000 - (ns % 1000000000 < 0); }

/* Writes seconds with nine decimals, exactly. */
static void put_seconds(td_text *text, int64_t ns) {
    const int64_t s = seconds_of(ns), rest = ns - s * 1000000000;
    if (s < 0 && rest > 0) /* -0.25 s is stored as -1 s and 0.75 s */
        td_text_put(text, NULL, "-%lld.%09lld", (long long)-(s + 1), (long long)(1000000000 - rest));
    else
        td_text_put(text, NULL, "%lld.%09lld", (long long)s, (long long)rest);
}

static void put_three(td_text *text, const double v[3], char separator) {
    for (int k = 0; k < 3; k++) td_text_put(text, NULL, "%c%.12g", separator, v[k]);
}

/* EuRoC's columns: nanoseconds, gyroscope, accelerometer. */
static void put_csv(const recording *r, td_text *text, int biases) {
    td_text_put(text, NULL,
                biases ? "#timestamp [ns],b_w_x [rad s^-1],b_w_y [rad s^-1],b_w_z [rad s^-1],b_a_x [m s^-2],b_a_y [m s^-2],"
                         "b_a_z [m s^-2]\n"
                       : "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],"
                         "a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n");
    for (size_t i = 0; i < r->count; i++) {
        const tides_imu_sample *s = &r->samples[i];
        td_text_put(text, NULL, "%lld", (long long)nanoseconds(r, i));
        put_three(text, biases ? s->gyroscope_bias : s->angular_rate, ',');
        put_three(text, biases ? s->accelerometer_bias : s->specific_force, ',');
        td_text_put(text, NULL, "\n");
    }
}

/* ECD's imu.txt: seconds, accelerometer, gyroscope. */
static void put_txt(const recording *r, td_text *text, int biases) {
    for (size_t i = 0; i < r->count; i++) {
        const tides_imu_sample *s = &r->samples[i];
        put_seconds(text, nanoseconds(r, i));
        put_three(text, biases ? s->accelerometer_bias : s->specific_force, ' ');
        put_three(text, biases ? s->gyroscope_bias : s->angular_rate, ' ');
        td_text_put(text, NULL, "\n");
    }
}

static tides_status write_text(const recording *r, const char *path, void (*put)(const recording *, td_text *, int), int biases,
                               tides_error *error) {
    td_text text;
    tides_status status = td_text_open(&text, path, error);
    if (status != TIDES_OK) return status;
    put(r, &text, biases);
    return td_text_close(&text, TIDES_OK, error);
}

/* Writes the measurements to the path, and their biases beside it: imu_bias.csv beside imu.csv. */
static tides_status write_pair(const recording *r, const char *path, void (*put)(const recording *, td_text *, int),
                               tides_error *error) {
    enum { ENDING = 4 }; /* ".csv", ".txt" */
    const int stem = (int)strlen(path) - ENDING;
    char *beside = td_format(error, "%.*s_bias%s", stem, path, path + stem);
    if (!beside) return TIDES_NO_MEMORY;
    const char *const biases = beside;
    tides_status status = tides_run_apart(r->facts->run, &biases, 1, error);
    if (status == TIDES_OK) status = write_text(r, beside, put, 1, error);
    if (status == TIDES_OK) status = write_text(r, path, put, 0, error);
    free(beside);
    return status;
}

/* Writes an array (count x 3) of the values at `offset` in each sample. */
static tides_status put_array(const recording *r, td_npy_writer *npz, const char *name, size_t offset, size_t width,
                              tides_error *error) {
    tides_status status =
        td_npy_writer_begin(npz, &(td_npy_form){name, "'<f8'", sizeof(double), width > 1 ? 2 : 1, &width}, error);
    for (size_t i = 0; i < r->count && status == TIDES_OK; i++)
        status = td_npy_writer_append(npz, (const char *)&r->samples[i] + offset, 1, error);
    return status;
}

const td_imu_column td_imu_columns[] = {
    {"t", "s", offsetof(tides_imu_sample, time), 1},
    {"angular_rate", "rad/s", offsetof(tides_imu_sample, angular_rate), 3},
    {"specific_force", "m/s^2", offsetof(tides_imu_sample, specific_force), 3},
    {"gyroscope_bias", "rad/s", offsetof(tides_imu_sample, gyroscope_bias), 3},
    {"accelerometer_bias", "m/s^2", offsetof(tides_imu_sample, accelerometer_bias), 3},
};
const size_t td_imu_columns_count = sizeof td_imu_columns / sizeof *td_imu_columns;

static tides_status write_npz(const recording *r, const char *path, tides_error *error) {
    td_npy_writer *npz = NULL;
    tides_status status = td_npy_writer_open(path, 1, &npz, error);
    if (status != TIDES_OK) return status;
    for (size_t i = 0; i < td_imu_columns_count && status == TIDES_OK; i++)
        status = put_array(r, npz, td_imu_columns[i].name, td_imu_columns[i].offset, td_imu_columns[i].width, error);
    return td_npy_writer_end(npz, status, error);
}

static tides_status write_any(const recording *r, const char *path, tides_error *error) {
    if (td_ends_in(path, ".npz")) return write_npz(r, path, error);
    if (td_ends_in(path, ".h5")) return td_imu_write_h5(path, r->samples, r->count, r->facts->values.json, error);
    return write_pair(r, path, td_ends_in(path, ".csv") ? put_csv : put_txt, error);
}

/* The IMU's path if a calibration has its pose; NULL: it is the camera's. */
static tides_status find_imu(const tides_session *session, tides_trajectory **moved, tides_error *error) {
    const double *t = session->opening.T_C_I, rotation[9] = {t[0], t[1], t[2], t[4], t[5], t[6], t[8], t[9], t[10]};
    const double position[3] = {t[3], t[7], t[11]};
    double quaternion[4];
    if (!session->opening.has_imu) return TIDES_OK;
    td_quaternion_from_rotation(rotation, quaternion);
    return tides_trajectory_create_mounted(session->facts.camera, position, quaternion, moved, error);
}

tides_status tides_session_imu(tides_session *session, const char *path, tides_session_taken *done, tides_error *error) {
    if (!session || !path) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_session_imu: session or path is NULL");
    const tides_run_values *v = &session->facts.values;
    tides_imu imu = v->imu;
    imu.metres_per_unit = v->metres_per_unit;
    if (session->facts.frames)
        return td_fail(error, TIDES_UNSUPPORTED, "%s: the run has frames.file and no camera that moves",
                       session->facts.run->origin);
    if (!td_ends_in(path, ".csv") && !td_ends_in(path, ".txt") && !td_ends_in(path, ".npz") && !td_ends_in(path, ".h5"))
        return td_fail(error, TIDES_UNSUPPORTED, "%s: inertial measurements are written as .csv, .txt, .npz or .h5", path);
    recording r = {.facts = &session->facts, .count = tides_imu_count(&imu, v->start, v->stop)};
    r.samples = td_alloc(r.count, sizeof *r.samples, error);
    tides_status status = r.samples ? td_session_apart(session, &path, 1, error) : TIDES_NO_MEMORY;
    tides_trajectory *moved = NULL;
    if (status == TIDES_OK) status = find_imu(session, &moved, error);
    if (status == TIDES_OK)
        status = tides_trajectory_imu(moved ? moved : session->facts.camera, &imu, v->start, r.count, r.samples, error);
    if (status == TIDES_OK) status = write_any(&r, path, error);
    if (status == TIDES_OK && done) *done = (tides_session_taken){.count = r.count, .at_imu = session->opening.has_imu};
    tides_trajectory_destroy(moved);
    free(r.samples);
    return status;
}
