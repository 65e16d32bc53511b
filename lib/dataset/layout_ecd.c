/* The layout of the Event Camera Dataset (Mueggler et al. 2017; rpg.ifi.uzh.ch/davis_data). Each camera has these files, whose
 * times are in seconds:
 *
 *   events.txt                  `t x y p`, if the camera makes events
 *   images.txt, images/         `t FILE`, and the pictures, if the camera makes pictures
 *   groundtruth.txt             `t px py pz qx qy qz qw`, the camera's pose in the world [m]
 *   calib.txt                   `fx fy cx cy k1 k2 p1 p2 k3`
 *   imu.txt                     `t ax ay az gx gy gz` [m/s^2, rad/s], if the sequence has an IMU
 *   depthmaps.txt, depthmaps/   `t FILE`, and the depth [m]; the original has these in its synthetic sequences only */
#include "td_dataset.h"

#include <stdlib.h>

typedef struct ecd {
    tides_event_writer *events;
    td_text images, poses, depths, imu;
    float *depth;
} ecd;

static tides_status write_calibration(const td_writer *w, tides_error *error) {
    const tides_intrinsics *k = &w->camera->facts.intrinsics;
    td_text lines = {0};
    double l[TD_COEFFICIENTS_MAX];
    td_lens_numbers(w->camera, l);
    tides_status status = td_text_in_folder(&lines, w->folder, "calib.txt", error);
    if (status == TIDES_OK)
        status = td_text_put(&lines, error, "%.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", k->fx, k->fy,
                             td_whole_cx(w->camera), td_whole_cy(w->camera), l[0], l[1], l[2], l[3], l[4]);
    return td_text_close(&lines, status, error);
}

static tides_status check(const td_dataset *set, tides_error *error) {
    return td_check_lens(set, "ecd", TIDES_LENS_RADTAN, 0, error);
}

static tides_status begin(td_writer *w, tides_error *error) {
    ecd *e = w->state = td_alloc(1, sizeof *e, error);
    if (!e) return TIDES_NO_MEMORY;
    e->depth = td_alloc(td_pixels(w->camera), sizeof *e->depth, error);
    tides_status status = e->depth ? TIDES_OK : TIDES_NO_MEMORY;
    if (status == TIDES_OK && w->camera->event >= 0)
        status = td_events_begin(w, td_in_folder(w->folder, error, "events.txt"), "ecd", &e->events, error);
    if (status == TIDES_OK && w->camera->picture >= 0) status = td_text_in_folder(&e->images, w->folder, "images.txt", error);
    if (status == TIDES_OK) status = td_text_in_folder(&e->poses, w->folder, "groundtruth.txt", error);
    if (status == TIDES_OK) status = td_text_in_folder(&e->depths, w->folder, "depthmaps.txt", error);
    if (status == TIDES_OK && w->set->has_imu) status = td_text_in_folder(&e->imu, w->folder, "imu.txt", error);
    return status == TIDES_OK ? write_calibration(w, error) : status;
}

static tides_status events(td_writer *w, const tides_event *list, size_t count, tides_error *error) {
    return tides_event_writer_append(((ecd *)w->state)->events, list, NULL, count, error);
}

static tides_status picture(td_writer *w, const td_picture *p, tides_error *error) {
    ecd *e = w->state;
    const tides_status status = td_text_put(&e->images, error, "%.6f images/frame_%08zu.png\n", td_seconds(p->us), p->index);
    return status == TIDES_OK
               ? td_plane_write(w->folder, "images/frame_%08u.png", (unsigned)p->index, w->camera, 8, 1, p->grey, error)
               : status;
}

/* Writes the depth [m] as OpenEXR. Pixels without a depth have 0. */
static tides_status truth(td_writer *w, const td_truth *t, tides_error *error) {
    ecd *e = w->state;
    const tides_intrinsics *k = &w->camera->facts.intrinsics;
    for (size_t i = 0; i < td_pixels(w->camera); i++) e->depth[i] = (float)(t->depth[i] * w->set->metres);
    const tides_channel channel = {"Z", e->depth};
    const char *const unit[] = {"depth_unit", "m", NULL};
    tides_status status = td_text_put(&e->depths, error, "%.6f depthmaps/frame_%08zu.exr\n", td_seconds(t->us), t->index);
    if (status != TIDES_OK) return status;
    char *path = td_in_folder(w->folder, error, "depthmaps/frame_%08zu.exr", t->index);
    status = path ? td_make_parents(path, error) : TIDES_NO_MEMORY;
    if (status == TIDES_OK) status = tides_exr_write(path, k->width, k->height, &channel, 1, TIDES_EXR_ZIP, unit, error);
    free(path);
    return status;
}

static tides_status imu(td_writer *w, const tides_imu_sample *sample, tides_error *error) {
    return td_imu_line(&((ecd *)w->state)->imu, sample, error);
}

static tides_status pose(td_writer *w, const td_place_at *at, tides_error *error) {
    return td_pose_line(w->set, &((ecd *)w->state)->poses, at, error);
}

static void drop(td_writer *w) {
    ecd *e = w->state;
    if (!e) return;
    tides_event_writer_abandon(e->events);
    td_text_drop(&e->images);
    td_text_drop(&e->poses);
    td_text_drop(&e->depths);
    td_text_drop(&e->imu);
    free(e->depth);
    free(e);
    w->state = NULL;
}

static tides_status end(td_writer *w, tides_error *error) {
    ecd *e = w->state;
    tides_status status = td_events_end(w, &e->events, error);
    if (status == TIDES_OK) status = td_text_close(&e->images, TIDES_OK, error);
    if (status == TIDES_OK) status = td_text_close(&e->poses, TIDES_OK, error);
    if (status == TIDES_OK) status = td_text_close(&e->depths, TIDES_OK, error);
    if (status == TIDES_OK) status = td_text_close(&e->imu, TIDES_OK, error);
    drop(w);
    return status;
}

const td_layout td_layout_ecd = {.name = "ecd",
                                 .summary = "Event Camera Dataset, text and pictures",
                                 .metric = 1,
                                 .per_camera = 1,
                                 .check = check,
                                 .begin = begin,
                                 .events = events,
                                 .picture = picture,
                                 .truth = truth,
                                 .pose = pose,
                                 .imu = imu,
                                 .end = end,
                                 .drop = drop};
