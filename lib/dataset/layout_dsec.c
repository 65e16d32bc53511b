/* The layout of DSEC (Gehrig et al. 2021; dsec.ifi.uzh.ch/data-format): a rig with event cameras left and right, and cameras
 * for pictures left and right. Times are microseconds. Events are raw; pictures are rectified, and so are flow and disparity,
 * which are those of the left event camera.
 *
 *   events/{left,right}/events.h5, rectify_map.h5 (rectified coordinates of each raw pixel)
 *   images/timestamps.txt, images/{left,right}/exposure_timestamps.txt, images/{left,right}/rectified/%06d.png
 *   flow/{forward,backward}/%06d.png, 16 bits: (I - 32768) / 128 in R and G [px], B = 1: known; numbered as the picture at
 *     from_timestamp; flow/{forward,backward}_timestamps.txt
 *   disparity/event/%06d.png, 16 bits: I / 256 [px], 0: unknown; disparity/timestamps.txt
 *   calibration/cam_to_cam.yaml: cam0 and cam3 make events, cam1 and cam2 pictures, left and right
 *   poses.txt: `t px py pz qx qy qz qw` of the left event camera [s, m]; DSEC itself has no such file */
#include "td_arrays.h"
#include "td_dataset.h"

#include <math.h>
#include <stdlib.h>

static const char *const sides[] = {"left", "right"};

typedef struct dsec {
    tides_event_writer *events;
    td_text times, exposures, forward, backward, disparity, poses;
    uint16_t *rgb;
} dsec;

/* -- checks ---------------------------------------------------------------------------------------------- */

static tides_status check(const td_dataset *set, tides_error *error) {
    if (set->event_cameras < 1 || set->event_cameras > 2 || set->picture_cameras > 2)
        return td_fail(error, TIDES_BAD_CONFIG,
                       "dsec: it has one or two cameras that make events and up to two that make pictures, not %zu and %zu",
                       set->event_cameras, set->picture_cameras);
    if (td_check_lens(set, "dsec", TIDES_LENS_EQUIDISTANT, 1, error) != TIDES_OK) return TIDES_BAD_CONFIG;
    return td_check_numbers(set, "dsec", error);
}

/* -- a camera -------------------------------------------------------------------------------------------------------------- */

static tides_status write_rectify_map(const td_writer *w, tides_error *error) {
    const td_view *view = &w->camera->rectified[TD_TRUTH];
    const size_t width = (size_t)view->intrinsics.width, height = (size_t)view->intrinsics.height, inner[2] = {width, 2};
    float *map = td_alloc(2 * width, height * sizeof *map, error);
    if (!map) return TIDES_NO_MEMORY;
    td_arrays file = {.path = NULL};
    td_array array = {.dataset = 0};
    tides_status status = tides_rectify_map(&w->camera->facts.intrinsics, &view->intrinsics, view->rotation, map, error);
    if (status == TIDES_OK)
        status =
            td_arrays_open(&file, td_in_folder(w->folder, error, "events/%s/rectify_map.h5", sides[w->camera->event]), error);
    if (status == TIDES_OK)
        status = td_array_begin(&file, "rectify_map", &(td_array_form){H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, 3, inner, height},
                                &array, error);
    if (status == TIDES_OK) status = td_array_append(&file, &array, height, map, error);
    td_array_end(&array);
    const tides_status closed = td_arrays_close(&file, error);
    free(map);
    return status == TIDES_OK ? closed : status;
}

static tides_status begin_events(td_writer *w, dsec *d, tides_error *error) {
    char *path = td_in_folder(w->folder, error, "events/%s/events.h5", sides[w->camera->event]);
    const tides_status status = td_events_begin(w, path, "hdf5", &d->events, error);
    return status == TIDES_OK ? write_rectify_map(w, error) : status;
}

/* Begins the files of ground truth, which is that of the left event camera. */
static tides_status begin_truth(td_writer *w, dsec *d, tides_error *error) {
    static const char head[] = "# from_timestamp_us, to_timestamp_us\n";
    tides_status status = td_text_in_folder(&d->forward, w->folder, "flow/forward_timestamps.txt", error);
    if (status == TIDES_OK) status = td_text_put(&d->forward, error, "%s", head);
    if (status == TIDES_OK) status = td_text_in_folder(&d->backward, w->folder, "flow/backward_timestamps.txt", error);
    if (status == TIDES_OK) status = td_text_put(&d->backward, error, "%s", head);
    if (status == TIDES_OK) status = td_text_in_folder(&d->poses, w->folder, "poses.txt", error);
    if (status == TIDES_OK && td_find_camera(w->set, TD_TRUTH, 1))
        status = td_text_in_folder(&d->disparity, w->folder, "disparity/timestamps.txt", error);
    return status;
}

static tides_status begin_pictures(td_writer *w, dsec *d, tides_error *error) {
    char name[64];
    snprintf(name, sizeof name, "images/%s/exposure_timestamps.txt", sides[w->camera->picture]);
    tides_status status = td_text_in_folder(&d->exposures, w->folder, name, error);
    if (status == TIDES_OK)
        status = td_text_put(&d->exposures, error, "# exposure_start_timestamp_us, exposure_end_timestamp_us\n");
    if (status == TIDES_OK && w->camera->picture == 0)
        status = td_text_in_folder(&d->times, w->folder, "images/timestamps.txt", error);
    return status;
}

static tides_status begin(td_writer *w, tides_error *error) {
    dsec *d = w->state = td_alloc(1, sizeof *d, error);
    if (!d) return TIDES_NO_MEMORY;
    d->rgb = td_alloc(3 * td_pixels(w->camera), sizeof *d->rgb, error);
    tides_status status = d->rgb ? TIDES_OK : TIDES_NO_MEMORY;
    if (status == TIDES_OK && w->camera->event >= 0) status = begin_events(w, d, error);
    if (status == TIDES_OK && w->camera->event == 0) status = begin_truth(w, d, error);
    if (status == TIDES_OK && w->camera->picture >= 0) status = begin_pictures(w, d, error);
    return status;
}

static tides_status events(td_writer *w, const tides_event *list, size_t count, tides_error *error) {
    return tides_event_writer_append(((dsec *)w->state)->events, list, NULL, count, error);
}

static tides_status picture(td_writer *w, const td_picture *p, tides_error *error) {
    dsec *d = w->state;
    const long long us = p->us, from = p->from_us, to = p->to_us;
    tides_status status = d->times.file ? td_text_put(&d->times, error, "%lld\n", us) : TIDES_OK;
    if (status == TIDES_OK) status = td_text_put(&d->exposures, error, "%lld, %lld\n", from, to);
    char format[48];
    snprintf(format, sizeof format, "images/%s/rectified/%%06u.png", sides[w->camera->picture]);
    return status == TIDES_OK ? td_plane_write(w->folder, format, (unsigned)p->index, w->camera, 8, 3, p->rgb, error) : status;
}

/* -- ground truth ---------------------------------------------------------------------------------------------------------- */

/* A component of flow [px] as DSEC's 16 bits: 32768 + 128 times its value; -1 if it doesn't fit. */
static int32_t flow_16(double px) {
    const double value = rint(128 * px) + 32768;
    return value >= 0 && value <= 65535 ? (int32_t)value : -1;
}

static tides_status write_flow(td_writer *w, const char *format, unsigned number, const double *u, const double *v,
                               tides_error *error) {
    uint16_t *rgb = ((dsec *)w->state)->rgb;
    for (size_t i = 0; i < td_pixels(w->camera); i++) {
        const int32_t right = isnan(u[i]) ? -1 : flow_16(u[i]), down = isnan(v[i]) ? -1 : flow_16(v[i]);
        const int known = right >= 0 && down >= 0;
        rgb[3 * i] = (uint16_t)(known ? right : 32768);
        rgb[3 * i + 1] = (uint16_t)(known ? down : 32768);
        rgb[3 * i + 2] = (uint16_t)known;
    }
    return td_plane_write(w->folder, format, number, w->camera, 16, 3, rgb, error);
}

static tides_status write_disparity(td_writer *w, const td_truth *t, unsigned number, tides_error *error) {
    dsec *d = w->state;
    const double fx = w->camera->rectified[TD_TRUTH].intrinsics.fx;
    /* disparity at a depth of 1 m [px / 256] */
    const double pixels = 256 * fx * td_baseline(w->set, w->camera, td_find_camera(w->set, TD_TRUTH, 1));
    for (size_t i = 0; i < td_pixels(w->camera); i++) {
        const double value = t->depth[i] > 0 ? rint(pixels / (t->depth[i] * w->set->metres)) : 0;
        d->rgb[i] = value >= 1 && value <= 65535 ? (uint16_t)value : 0;
    }
    const tides_status status = td_text_put(&d->disparity, error, "%lld\n", (long long)t->us);
    return status == TIDES_OK ? td_plane_write(w->folder, "disparity/event/%06u.png", number, w->camera, 16, 1, d->rgb, error)
                              : status;
}

static tides_status truth(td_writer *w, const td_truth *t, tides_error *error) {
    dsec *d = w->state;
    if (w->camera->event != 0) return TIDES_OK;
    const unsigned number = (unsigned)(t->index * td_pictures_per_truth(w->set));
    tides_status status = TIDES_OK;
    if (t->next_u) {
        status = td_text_put(&d->forward, error, "%lld, %lld\n", (long long)t->us, (long long)t->next_us);
        if (status == TIDES_OK) status = write_flow(w, "flow/forward/%06u.png", number, t->next_u, t->next_v, error);
    }
    if (status == TIDES_OK && t->before_u) {
        status = td_text_put(&d->backward, error, "%lld, %lld\n", (long long)t->us, (long long)t->before_us);
        if (status == TIDES_OK) status = write_flow(w, "flow/backward/%06u.png", number, t->before_u, t->before_v, error);
    }
    return status == TIDES_OK && d->disparity.file ? write_disparity(w, t, number, error) : status;
}

static tides_status pose(td_writer *w, const td_place_at *at, tides_error *error) {
    dsec *d = w->state;
    return d->poses.file ? td_pose_line(w->set, &d->poses, at, error) : TIDES_OK;
}

static void drop(td_writer *w) {
    dsec *d = w->state;
    if (!d) return;
    tides_event_writer_abandon(d->events);
    td_text *const lines[] = {&d->times, &d->exposures, &d->forward, &d->backward, &d->disparity, &d->poses};
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) td_text_drop(lines[i]);
    free(d->rgb);
    free(d);
    w->state = NULL;
}

static tides_status end(td_writer *w, tides_error *error) {
    dsec *d = w->state;
    tides_status status = td_events_end(w, &d->events, error);
    td_text *const lines[] = {&d->times, &d->exposures, &d->forward, &d->backward, &d->disparity, &d->poses};
    for (size_t i = 0; i < sizeof lines / sizeof *lines && status == TIDES_OK; i++)
        status = td_text_close(lines[i], TIDES_OK, error);
    drop(w);
    return status;
}

static tides_status complete(td_writer *w, tides_error *error) { return td_dsec_calibration(w, error); }

const td_layout td_layout_dsec = {.name = "dsec",
                                  .summary = "DSEC: stereo events, pictures, flow, disparity",
                                  .metric = 1,
                                  .rectified = 1,
                                  .check = check,
                                  .begin = begin,
                                  .events = events,
                                  .picture = picture,
                                  .truth = truth,
                                  .pose = pose,
                                  .end = end,
                                  .complete = complete,
                                  .drop = drop};
