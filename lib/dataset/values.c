/* Conversions for layouts, from TIDES's conventions of pixels, frames and depths to theirs. */
#include "camera/td_rotation.h"
#include "image/td_png.h"
#include "signal/td_step.h"
#include "td_dataset.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int64_t td_dataset_us(const td_dataset *set, double hz, size_t k) {
    return set->start_us + (int64_t)llround(1e6 * (double)k / hz);
}

size_t td_pixels(const td_member *camera) {
    return (size_t)camera->facts.intrinsics.width * (size_t)camera->facts.intrinsics.height;
}

double td_whole_cx(const td_member *camera) { return camera->facts.intrinsics.cx - 0.5; }
double td_whole_cy(const td_member *camera) { return camera->facts.intrinsics.cy - 0.5; }

tides_status td_events_begin(const td_writer *w, char *path, const char *format, tides_event_writer **events,
                             tides_error *error) {
    const tides_session_facts *f = &w->camera->facts;
    const tides_event_file facts = {.width = f->intrinsics.width,
                                    .height = f->intrinsics.height,
                                    .run = f->values.json,
                                    .seed = f->values.seed,
                                    .start_ns = td_time_ns(f->values.start),
                                    .stop_ns = td_time_ns(f->values.stop)};
    tides_status status = path ? td_make_parents(path, error) : TIDES_NO_MEMORY;
    if (status == TIDES_OK) status = tides_event_writer_open(path, format, &facts, events, error);
    free(path);
    return status;
}

tides_status td_events_end(const td_writer *w, tides_event_writer **events, tides_error *error) {
    tides_event_writer *writer = *events;
    *events = NULL;
    return writer ? tides_event_writer_finish(writer, td_time_ns(w->camera->facts.values.stop), error) : TIDES_OK;
}

const td_lens_model *td_lens_numbers(const td_member *camera, double numbers[TD_COEFFICIENTS_MAX]) {
    tides_lens lens = camera->facts.intrinsics.lens;
    if (lens.model == TIDES_LENS_NONE) lens.model = TIDES_LENS_RADTAN;
    td_lens_list(&lens, numbers);
    return td_lens_model_of(lens.model);
}

tides_status td_check_lens(const td_dataset *set, const char *layout, int32_t most, int least, tides_error *error) {
    for (size_t i = 0; i < set->count; i++) {
        const tides_lens *l = &set->cameras[i].facts.intrinsics.lens;
        if (l->model == TIDES_LENS_NONE) continue;
        if (l->model <= most && !(least && l->model == TIDES_LENS_RADTAN && fabs(l->k3) > 0)) continue;
        return td_fail(error, TIDES_BAD_CONFIG, "%s: %s has a lens that the layout has no place for: set camera.lens to %s",
                       layout, set->cameras[i].name, least ? "radtan without k3" : "radtan");
    }
    return TIDES_OK;
}

/* Computes R_1^T R_0 and R_1^T (t_0 - t_1) from both cameras' poses on the body. */
void td_between(const td_dataset *set, const td_member *zero, const td_member *one, double transform[16]) {
    const double *a = zero->T_B_C, *b = one->T_B_C;
    memset(transform, 0, 16 * sizeof *transform);
    transform[15] = 1;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            for (int j = 0; j < 3; j++) transform[4 * i + j] += b[4 * k + i] * a[4 * k + j];
            transform[4 * i + 3] += b[4 * k + i] * (a[4 * k + 3] - b[4 * k + 3]) * set->metres;
        }
}

size_t td_pictures_per_truth(const td_dataset *set) { return (size_t)llround(set->picture_hz / set->truth_hz); }

tides_status td_check_numbers(const td_dataset *set, const char *layout, tides_error *error) {
    const double ratio = set->picture_hz / set->truth_hz;
    if (fabs(ratio - rint(ratio)) <= 1e-9 && ratio >= 1) return TIDES_OK;
    return td_fail(error, TIDES_BAD_CONFIG,
                   "%s: ground truth has the numbers of pictures: dataset.picture_hz must be a whole multiple of "
                   "dataset.truth_hz",
                   layout);
}

tides_status td_place(const td_member *camera, int64_t us, td_place_at *place, tides_error *error) {
    tides_pose pose;
    const tides_status status = tides_trajectory_at(camera->facts.camera, td_seconds(us), &pose, error);
    if (status != TIDES_OK) return status;
    *place = (td_place_at){.us = us};
    memcpy(place->position, pose.position, sizeof place->position);
    memcpy(place->rotation, pose.rotation, sizeof place->rotation);
    td_quaternion_from_rotation(pose.rotation, place->quaternion);
    return TIDES_OK;
}

double td_baseline(const td_dataset *set, const td_member *zero, const td_member *one) {
    double t[16];
    td_between(set, zero, one, t);
    return sqrt(t[3] * t[3] + t[7] * t[7] + t[11] * t[11]);
}

void td_depth_16(const td_dataset *set, const td_member *camera, const double *depth, double scale, uint16_t *out) {
    for (size_t i = 0; i < td_pixels(camera); i++) {
        const double value = rint(depth[i] * set->metres * scale);
        out[i] = value >= 1 && value <= 65535 ? (uint16_t)value : 0;
    }
}

tides_status td_imu_line(td_text *lines, const tides_imu_sample *sample, tides_error *error) {
    const double *a = sample->specific_force, *g = sample->angular_rate;
    return td_text_put(lines, error, "%.9f %.17g %.17g %.17g %.17g %.17g %.17g\n", sample->time, a[0], a[1], a[2], g[0], g[1],
                       g[2]);
}

tides_status td_pose_line(const td_dataset *set, td_text *lines, const td_place_at *at, tides_error *error) {
    const double m = set->metres, *p = at->position, *q = at->quaternion;
    return td_text_put(lines, error, "%.6f %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", td_seconds(at->us), m * p[0], m * p[1],
                       m * p[2], q[1], q[2], q[3], q[0]);
}

tides_status td_plane_write(const char *folder, const char *format, unsigned number, const td_member *camera, int32_t bits,
                            int32_t channels, const void *values, tides_error *error) {
    char *path = td_in_folder(folder, error, format, number);
    const td_png_form form = {camera->facts.intrinsics.width, camera->facts.intrinsics.height, bits, channels};
    tides_status status = path ? td_make_parents(path, error) : TIDES_NO_MEMORY;
    if (status == TIDES_OK) status = td_png_write(path, &form, values, error);
    free(path);
    return status;
}
