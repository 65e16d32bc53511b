/* The layout of MVSEC (Zhu et al. 2018; daniilidis-group.github.io/mvsec), for one or two cameras that make both events and
 * pictures. Times are seconds.
 *
 *   NAME_data.hdf5  davis/{left,right}/events (n, 4): x, y, t, p = +-1; image_raw (n, height, width), image_raw_ts,
 *                   image_raw_event_inds (index of the last event up to the picture, or of the first);
 *                   imu (n, 6): ax ay az gx gy gz, imu_ts
 *   NAME_gt.hdf5    davis/{left,right}/depth_image_raw (n, height, width) [m], NaN: none; depth_image_raw_ts;
 *                   pose (n, 4, 4) of the camera in the world [m], pose_ts; davis/left/flow_dist (n, 2, height, width), _ts
 *   NAME_gt_flow_dist.npz  timestamps, x_flow_dist, y_flow_dist: the same displacements
 *   camchain.yaml   Kalibr's format
 *
 * flow_dist is the displacement [px] of the visible points to the next ground truth, 0 if unknown, in the raw (distorted)
 * image. MVSEC's own flow_dist was computed from rectified depth, although "dist" means distorted. */
#include "archive/td_npy.h"
#include "td_arrays.h"
#include "td_dataset.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const sides[] = {"left", "right"};

/* Files that contain both cameras. */
typedef struct mvsec_files {
    td_arrays data, truth;
    td_text chain;
} mvsec_files;

enum {
    EVENTS,
    IMAGES,
    IMAGE_TIMES,
    IMAGE_EVENTS,
    IMU,
    IMU_TIMES,
    DEPTH,
    DEPTH_TIMES,
    POSES,
    POSE_TIMES,
    FLOW,
    FLOW_TIMES,
    ARRAYS
};

/* Rows that are packed into one chunk: of events, of numbers. */
enum { EVENT_ROWS = 16384, NUMBER_ROWS = 1024 };

typedef struct mvsec {
    td_array array[ARRAYS];
    double *rows;    /* EVENT_ROWS x 4, or a pair of planes */
    int64_t *before; /* number of events up to each picture */
    int64_t seen;
    size_t passed; /* pictures that have no further events */
} mvsec;

static mvsec_files *files_of(td_writer *w) { return w->kept; }
static td_arrays *file_of(td_writer *w, int which) { return which < DEPTH ? &files_of(w)->data : &files_of(w)->truth; }

static tides_status check(const td_dataset *set, tides_error *error) {
    int both = set->count <= 2;
    for (size_t i = 0; i < set->count; i++) both = both && set->cameras[i].event >= 0 && set->cameras[i].picture >= 0;
    if (both) return td_check_lens(set, "mvsec", TIDES_LENS_EQUIDISTANT, 1, error);
    return td_fail(error, TIDES_BAD_CONFIG, "mvsec: it has one or two cameras, each of events and pictures: kind \"both\"");
}

/* -- opening --------------------------------------------------------------------------------------------------------------- */

static tides_status open_files(td_writer *w, tides_error *error) {
    mvsec_files *f = w->kept = td_alloc(1, sizeof *f, error);
    if (!f) return TIDES_NO_MEMORY;
    tides_status status = td_arrays_open(&f->data, td_in_folder(w->root, error, "%.200s_data.hdf5", w->set->name), error);
    if (status == TIDES_OK)
        status = td_arrays_open(&f->truth, td_in_folder(w->root, error, "%.200s_gt.hdf5", w->set->name), error);
    return status == TIDES_OK ? td_text_in_folder(&f->chain, w->root, "camchain.yaml", error) : status;
}

static tides_status begin_arrays(td_writer *w, tides_error *error) {
    const size_t height = (size_t)w->camera->facts.intrinsics.height, width = (size_t)w->camera->facts.intrinsics.width;
    const size_t four[2] = {4, 4}, six = 6, plane[2] = {height, width}, pair[3] = {2, height, width};
    const hid_t f64 = H5T_IEEE_F64LE, real = H5T_NATIVE_DOUBLE;
    const struct {
        const char *name;
        td_array_form form;
    } arrays[ARRAYS] = {
        [EVENTS] = {"events", {f64, real, 2, four, EVENT_ROWS}},
        [IMAGES] = {"image_raw", {H5T_STD_U8LE, H5T_NATIVE_UINT8, 3, plane, 1}},
        [IMAGE_TIMES] = {"image_raw_ts", {f64, real, 1, NULL, NUMBER_ROWS}},
        [IMAGE_EVENTS] = {"image_raw_event_inds", {H5T_STD_I64LE, H5T_NATIVE_INT64, 1, NULL, NUMBER_ROWS}},
        [IMU] = {"imu", {f64, real, 2, &six, NUMBER_ROWS}},
        [IMU_TIMES] = {"imu_ts", {f64, real, 1, NULL, NUMBER_ROWS}},
        [DEPTH] = {"depth_image_raw", {H5T_IEEE_F32LE, real, 3, plane, 1}},
        [DEPTH_TIMES] = {"depth_image_raw_ts", {f64, real, 1, NULL, NUMBER_ROWS}},
        [POSES] = {"pose", {f64, real, 3, four, NUMBER_ROWS}},
        [POSE_TIMES] = {"pose_ts", {f64, real, 1, NULL, NUMBER_ROWS}},
        [FLOW] = {"flow_dist", {f64, real, 4, pair, 1}},
        [FLOW_TIMES] = {"flow_dist_ts", {f64, real, 1, NULL, NUMBER_ROWS}},
    };
    mvsec *m = w->state;
    tides_status status = TIDES_OK;
    for (int i = 0; i < ARRAYS && status == TIDES_OK; i++) {
        if (i >= FLOW && w->camera->event != 0) break;
        if ((i == IMU || i == IMU_TIMES) && !w->set->has_imu) continue;
        char name[64];
        snprintf(name, sizeof name, "davis/%s/%s", sides[w->camera->event], arrays[i].name);
        status = td_array_begin(file_of(w, i), name, &arrays[i].form, &m->array[i], error);
    }
    return status;
}

static tides_status put_camera(td_writer *w, tides_error *error) {
    td_text *yaml = &files_of(w)->chain;
    const tides_intrinsics *k = &w->camera->facts.intrinsics;
    double l[TD_COEFFICIENTS_MAX];
    const char *model = td_lens_numbers(w->camera, l)->name;
    tides_status status =
        td_text_put(yaml, error,
                    "cam%d:\n  camera_model: pinhole\n  intrinsics: [%.17g, %.17g, %.17g, %.17g]\n"
                    "  distortion_model: %s\n  distortion_coeffs: [%.17g, %.17g, %.17g, %.17g]\n  resolution: [%d, %d]\n",
                    (int)w->camera->event, k->fx, k->fy, td_whole_cx(w->camera), td_whole_cy(w->camera), model, l[0], l[1],
                    l[2], l[3], (int)k->width, (int)k->height);
    if (w->camera->event == 0) return status;
    double t[16];
    td_between(w->set, &w->set->cameras[0], w->camera, t);
    if (status == TIDES_OK) status = td_text_put(yaml, error, "  T_cn_cnm1:\n");
    for (int i = 0; i < 4 && status == TIDES_OK; i++)
        status =
            td_text_put(yaml, error, "  - [%.17g, %.17g, %.17g, %.17g]\n", t[4 * i], t[4 * i + 1], t[4 * i + 2], t[4 * i + 3]);
    return status;
}

static tides_status begin(td_writer *w, tides_error *error) {
    mvsec *m = w->state = td_alloc(1, sizeof *m, error);
    if (!m) return TIDES_NO_MEMORY;
    const size_t pair = 2 * td_pixels(w->camera), room = pair > 4 * EVENT_ROWS ? pair : 4 * EVENT_ROWS;
    m->rows = td_alloc(room, sizeof *m->rows, error);
    m->before = m->rows ? td_alloc(w->set->pictures, sizeof *m->before, error) : NULL;
    tides_status status = m->before ? TIDES_OK : TIDES_NO_MEMORY;
    if (status == TIDES_OK && !w->kept) status = open_files(w, error);
    if (status == TIDES_OK) status = put_camera(w, error);
    return status == TIDES_OK ? begin_arrays(w, error) : status;
}

/* -- writing ------------------------------------------------------------------------------------------------------------ */

static tides_status put(td_writer *w, int which, size_t rows, const void *values, tides_error *error) {
    mvsec *m = w->state;
    return td_array_append(file_of(w, which), &m->array[which], rows, values, error);
}

/* Notes the number of events so far for all pictures before `ns`. */
static void pass_pictures(td_writer *w, int64_t ns) {
    mvsec *m = w->state;
    while (m->passed < w->set->pictures && 1000 * td_dataset_us(w->set, w->set->picture_hz, m->passed) < ns)
        m->before[m->passed++] = m->seen;
}

static tides_status events(td_writer *w, const tides_event *list, size_t count, tides_error *error) {
    mvsec *m = w->state;
    tides_status status = TIDES_OK;
    for (size_t first = 0; first < count && status == TIDES_OK; first += EVENT_ROWS) {
        const size_t rows = count - first < EVENT_ROWS ? count - first : EVENT_ROWS;
        for (size_t i = 0; i < rows; i++) {
            const tides_event *e = &list[first + i];
            const double row[4] = {e->x, e->y, td_event_seconds(e), e->polarity};
            memcpy(m->rows + 4 * i, row, sizeof row);
            pass_pictures(w, e->t);
            m->seen++;
        }
        status = put(w, EVENTS, rows, m->rows, error);
    }
    return status;
}

static tides_status picture(td_writer *w, const td_picture *p, tides_error *error) {
    mvsec *m = w->state;
    pass_pictures(w, INT64_MAX);                                                 /* all events have come */
    const int64_t index = m->before[p->index] > 0 ? m->before[p->index] - 1 : 0; /* -1 would mean the last event */
    const double t = td_seconds(p->us);
    tides_status status = put(w, IMAGES, 1, p->grey, error);
    if (status == TIDES_OK) status = put(w, IMAGE_TIMES, 1, &t, error);
    return status == TIDES_OK ? put(w, IMAGE_EVENTS, 1, &index, error) : status;
}

static tides_status put_flow(td_writer *w, const td_truth *t, tides_error *error) {
    mvsec *m = w->state;
    const size_t pixels = td_pixels(w->camera);
    const double time = td_seconds(t->us);
    for (size_t i = 0; i < pixels; i++) {
        m->rows[i] = isnan(t->next_u[i]) ? 0 : t->next_u[i];
        m->rows[pixels + i] = isnan(t->next_v[i]) ? 0 : t->next_v[i];
    }
    const tides_status status = put(w, FLOW, 1, m->rows, error);
    return status == TIDES_OK ? put(w, FLOW_TIMES, 1, &time, error) : status;
}

static tides_status truth(td_writer *w, const td_truth *t, tides_error *error) {
    mvsec *m = w->state;
    const double time = td_seconds(t->us);
    for (size_t i = 0; i < td_pixels(w->camera); i++) m->rows[i] = t->depth[i] > 0 ? t->depth[i] * w->set->metres : NAN;
    tides_status status = put(w, DEPTH, 1, m->rows, error);
    if (status == TIDES_OK) status = put(w, DEPTH_TIMES, 1, &time, error);
    return status == TIDES_OK && t->next_u && w->camera->event == 0 ? put_flow(w, t, error) : status;
}

static tides_status pose(td_writer *w, const td_place_at *at, tides_error *error) {
    double t[16] = {0}, time = td_seconds(at->us);
    for (int i = 0; i < 9; i++) t[i / 3 * 4 + i % 3] = at->rotation[i];
    for (int k = 0; k < 3; k++) t[4 * k + 3] = at->position[k] * w->set->metres;
    t[15] = 1;
    const tides_status status = put(w, POSES, 1, t, error);
    return status == TIDES_OK ? put(w, POSE_TIMES, 1, &time, error) : status;
}

static tides_status imu(td_writer *w, const tides_imu_sample *s, tides_error *error) {
    const double *a = s->specific_force, *g = s->angular_rate, row[6] = {a[0], a[1], a[2], g[0], g[1], g[2]};
    const tides_status status = put(w, IMU, 1, row, error);
    return status == TIDES_OK ? put(w, IMU_TIMES, 1, &s->time, error) : status;
}

/* -- ending ---------------------------------------------------------------------------------------------------------------- */

/* Copies u (0) or v (1) of all flow_dist to the .npz. They are read back, because an .npz takes one array at a time. */
static tides_status copy_flow(td_writer *w, td_npy_writer *npy, int which, tides_error *error) {
    mvsec *m = w->state;
    const size_t pixels = td_pixels(w->camera);
    const size_t inner[2] = {(size_t)w->camera->facts.intrinsics.height, (size_t)w->camera->facts.intrinsics.width};
    tides_status status =
        td_npy_writer_begin(npy, &(td_npy_form){which ? "y_flow_dist" : "x_flow_dist", "'<f8'", 8, 3, inner}, error);
    for (size_t k = 0; k < m->array[FLOW].rows && status == TIDES_OK; k++) {
        status = td_array_read(file_of(w, FLOW), &m->array[FLOW], k, m->rows, error);
        if (status == TIDES_OK) status = td_npy_writer_append(npy, m->rows + (size_t)which * pixels, 1, error);
    }
    return status;
}

static tides_status write_flow(td_writer *w, tides_error *error) {
    mvsec *m = w->state;
    char *path = td_in_folder(w->root, error, "%.200s_gt_flow_dist.npz", w->set->name);
    td_npy_writer *npy = NULL;
    tides_status status = path ? td_npy_writer_open(path, 1, &npy, error) : TIDES_NO_MEMORY;
    free(path);
    if (status != TIDES_OK) return status;
    status = td_npy_writer_begin(npy, &(td_npy_form){"timestamps", "'<f8'", 8, 1, NULL}, error);
    for (size_t k = 0; k < m->array[FLOW].rows && status == TIDES_OK; k++) {
        const double time = td_seconds(td_dataset_us(w->set, w->set->truth_hz, k));
        status = td_npy_writer_append(npy, &time, 1, error);
    }
    for (int which = 0; which < 2 && status == TIDES_OK; which++) status = copy_flow(w, npy, which, error);
    return td_npy_writer_end(npy, status, error);
}

static void end_camera(td_writer *w) {
    mvsec *m = w->state;
    if (!m) return;
    for (int i = 0; i < ARRAYS; i++) td_array_end(&m->array[i]);
    free(m->before);
    free(m->rows);
    free(m);
    w->state = NULL;
}

static tides_status end(td_writer *w, tides_error *error) {
    const tides_status status = w->camera->event == 0 ? write_flow(w, error) : TIDES_OK;
    end_camera(w);
    return status;
}

static tides_status complete(td_writer *w, tides_error *error) {
    tides_status status = td_arrays_close(&files_of(w)->data, error);
    if (status == TIDES_OK) status = td_arrays_close(&files_of(w)->truth, error);
    return status == TIDES_OK ? td_text_close(&files_of(w)->chain, TIDES_OK, error) : status;
}

static void drop(td_writer *w) {
    end_camera(w);
    if (!w->kept) return;
    td_arrays_drop(&files_of(w)->data);
    td_arrays_drop(&files_of(w)->truth);
    td_text_drop(&files_of(w)->chain);
    free(w->kept);
}

const td_layout td_layout_mvsec = {.name = "mvsec",
                                   .summary = "MVSEC: HDF5 of events, pictures, depth, displacement, poses",
                                   .metric = 1,
                                   .check = check,
                                   .begin = begin,
                                   .events = events,
                                   .picture = picture,
                                   .truth = truth,
                                   .pose = pose,
                                   .imu = imu,
                                   .end = end,
                                   .complete = complete,
                                   .drop = drop};
