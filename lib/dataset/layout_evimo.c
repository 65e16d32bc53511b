/* The layout of EVIMO2 v2 in npz form (Burner et al. 2022). Each camera has dataset_events_{t,xy,p}.npy [s, px, 0 or 1],
 * dataset_classical.npz (pictures), dataset_depth.npz [mm, 0: none], dataset_mask.npz (1000 (k + 1) for object k = 0, 1 ...;
 * 0: none), and dataset_flow.npz (displacement to the next ground truth [px], NaN: unknown; t, t_end). A plane is named
 * KIND_NUMBER, with the number of its ground truth: 0, 1, 2 and so on, as readers expect. Other pictures are between_NUMBER,
 * by their number among all pictures; t and t_between are the times of both kinds. dataset_info.npz has K, D and meta. Poses
 * are also in poses.txt, `t px py pz qx qy qz qw` of the camera in the world [m]. */
#include "td_evimo.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { T, XY, P, CLASSICAL, DEPTH, MASK, FLOW, FILES };
static const char *const names[FILES] = {"dataset_events_t.npy",  "dataset_events_xy.npy", "dataset_events_p.npy",
                                         "dataset_classical.npz", "dataset_depth.npz",     "dataset_mask.npz",
                                         "dataset_flow.npz"};

typedef struct evimo {
    td_npy_writer *file[FILES];
    td_text poses;
    uint16_t *plane;
    float *flow;
    double *times; /* of the flow: begin, end */
    size_t flows;
    double *taken[2]; /* times of pictures at ground truths, and of others */
    size_t pictures[2];
    td_evimo_meta meta;
} evimo;

static tides_status open_file(td_writer *w, int which, tides_error *error) {
    char *path = td_in_folder(w->folder, error, "%s", names[which]);
    const tides_status status =
        path ? td_npy_writer_open(path, which >= CLASSICAL, &((evimo *)w->state)->file[which], error) : TIDES_NO_MEMORY;
    free(path);
    return status;
}

static tides_status begin_columns(evimo *e, tides_error *error) {
    const size_t two = 2;
    tides_status status = td_npy_writer_begin(e->file[T], &(td_npy_form){"data", "'<f8'", 8, 1, NULL}, error);
    if (status == TIDES_OK) status = td_npy_writer_begin(e->file[XY], &(td_npy_form){"data", "'<u2'", 2, 2, &two}, error);
    return status == TIDES_OK ? td_npy_writer_begin(e->file[P], &(td_npy_form){"data", "'|u1'", 1, 1, NULL}, error) : status;
}

static tides_status begin(td_writer *w, tides_error *error) {
    evimo *e = w->state = td_alloc(1, sizeof *e, error);
    if (!e) return TIDES_NO_MEMORY;
    td_evimo_begin(&e->meta, error);
    e->plane = td_alloc(td_pixels(w->camera), sizeof *e->plane, error);
    e->flow = e->plane ? td_alloc(2 * td_pixels(w->camera), sizeof *e->flow, error) : NULL;
    e->times = e->flow ? td_alloc(2 * w->set->truths, sizeof *e->times, error) : NULL;
    for (int i = 0; i < 2; i++) e->taken[i] = e->times ? td_alloc(w->set->pictures, sizeof(double), error) : NULL;
    tides_status status = e->taken[0] && e->taken[1] ? TIDES_OK : TIDES_NO_MEMORY;
    if (status == TIDES_OK) status = td_text_in_folder(&e->poses, w->folder, "poses.txt", error);
    for (int i = 0; i < FILES && status == TIDES_OK; i++)
        if ((i > P || w->camera->event >= 0) && (i != CLASSICAL || w->camera->picture >= 0)) status = open_file(w, i, error);
    return status == TIDES_OK && e->file[T] ? begin_columns(e, error) : status;
}

static tides_status events(td_writer *w, const tides_event *list, size_t count, tides_error *error) {
    evimo *e = w->state;
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < count && status == TIDES_OK; i++) {
        const double t = td_event_seconds(&list[i]);
        const uint16_t xy[2] = {list[i].x, list[i].y};
        const uint8_t p = list[i].polarity > 0;
        status = td_npy_writer_append(e->file[T], &t, 1, error);
        if (status == TIDES_OK) status = td_npy_writer_append(e->file[XY], xy, 1, error);
        if (status == TIDES_OK) status = td_npy_writer_append(e->file[P], &p, 1, error);
    }
    return status;
}

/* Writes a (height x width) plane; if `last` isn't 0, with `last` values per pixel. */
static tides_status put(td_writer *w, int which, const char *kind, size_t index, size_t last, const void *values,
                        tides_error *error) {
    static const struct {
        const char *dtype;
        size_t bytes;
    } number[] = {[CLASSICAL] = {"'|u1'", 1}, [DEPTH] = {"'<u2'", 2}, [MASK] = {"'<u2'", 2}, [FLOW] = {"'<f4'", 4}};
    char name[48];
    snprintf(name, sizeof name, "%s_%010zu", kind, index);
    const size_t inner[2] = {(size_t)w->camera->facts.intrinsics.width, last};
    td_npy_writer *file = ((evimo *)w->state)->file[which];
    return td_npy_writer_put(file, &(td_npy_form){name, number[which].dtype, number[which].bytes, last ? 3 : 2, inner}, values,
                             (size_t)w->camera->facts.intrinsics.height, error);
}

static tides_status picture(td_writer *w, const td_picture *p, tides_error *error) {
    evimo *e = w->state;
    const size_t each = td_pictures_per_truth(w->set), number = p->index / each;
    const int between = p->index % each != 0 || number >= w->set->truths;
    e->taken[between][e->pictures[between]++] = td_seconds(p->us);
    return put(w, CLASSICAL, between ? "between" : "classical", between ? p->index : number, 3, p->rgb, error);
}

static tides_status put_times(evimo *e, int which, const char *name, const double *times, size_t count, tides_error *error) {
    return td_npy_writer_put(e->file[which], &(td_npy_form){name, "'<f8'", 8, 1, NULL}, times, count, error);
}

static tides_status put_flow(td_writer *w, const td_truth *t, tides_error *error) {
    evimo *e = w->state;
    for (size_t i = 0; i < td_pixels(w->camera); i++) {
        e->flow[2 * i] = (float)t->next_u[i];
        e->flow[2 * i + 1] = (float)t->next_v[i];
    }
    e->times[e->flows] = td_seconds(t->us);
    e->times[w->set->truths + e->flows++] = td_seconds(t->next_us);
    return put(w, FLOW, "flow", t->index, 2, e->flow, error);
}

static tides_status truth(td_writer *w, const td_truth *t, tides_error *error) {
    evimo *e = w->state;
    td_place_at place;
    tides_status status = td_place(w->camera, t->us, &place, error);
    if (status != TIDES_OK) return status;
    td_evimo_frame(&e->meta, w, t->index, &place, w->camera->picture >= 0);
    td_depth_16(w->set, w->camera, t->depth, 1000, e->plane);
    status = put(w, DEPTH, "depth", t->index, 0, e->plane, error);
    for (size_t i = 0; i < td_pixels(w->camera); i++)
        e->plane[i] = t->instance[i] >= 0 && t->instance[i] < 65 ? (uint16_t)(1000 * (int)(t->instance[i] + 1)) : 0;
    if (status == TIDES_OK) status = put(w, MASK, "mask", t->index, 0, e->plane, error);
    return status == TIDES_OK && t->next_u ? put_flow(w, t, error) : status;
}

static tides_status pose(td_writer *w, const td_place_at *at, tides_error *error) {
    evimo *e = w->state;
    td_evimo_pose(&e->meta, w, at);
    return td_pose_line(w->set, &e->poses, at, error);
}

static tides_status imu(td_writer *w, const tides_imu_sample *sample, tides_error *error) {
    (void)error; /* td_evimo_end reports failures */
    td_evimo_imu(&((evimo *)w->state)->meta, w, sample);
    return TIDES_OK;
}

static tides_status write_info(td_writer *w, tides_error *error) {
    const tides_intrinsics *k = &w->camera->facts.intrinsics;
    const double matrix[9] = {k->fx, 0, td_whole_cx(w->camera), 0, k->fy, td_whole_cy(w->camera), 0, 0, 1};
    double lens[TD_COEFFICIENTS_MAX];
    const int count = td_lens_numbers(w->camera, lens)->count;
    const size_t three = 3;
    char *path = td_in_folder(w->folder, error, "dataset_info.npz");
    td_npy_writer *npy = NULL;
    tides_status status = path ? td_npy_writer_open(path, 1, &npy, error) : TIDES_NO_MEMORY;
    free(path);
    if (status != TIDES_OK) return status;
    status = td_npy_writer_put(npy, &(td_npy_form){"K", "'<f8'", 8, 2, &three}, matrix, 3, error);
    if (status == TIDES_OK)
        status = td_npy_writer_put(npy, &(td_npy_form){"D", "'<f8'", 8, 1, NULL}, lens, (size_t)count, error);
    if (status == TIDES_OK) status = td_evimo_end(&((evimo *)w->state)->meta, w, npy);
    return td_npy_writer_end(npy, status, error);
}

static void drop(td_writer *w) {
    evimo *e = w->state;
    if (!e) return;
    for (int i = 0; i < FILES; i++) td_npy_writer_discard(e->file[i]);
    td_text_drop(&e->poses);
    td_pickler_drop(&e->meta.pickler);
    free(e->taken[0]);
    free(e->taken[1]);
    free(e->times);
    free(e->flow);
    free(e->plane);
    free(e);
    w->state = NULL;
}

static tides_status end(td_writer *w, tides_error *error) {
    evimo *e = w->state;
    tides_status status = put_times(e, FLOW, "t", e->times, e->flows, error);
    if (status == TIDES_OK) status = put_times(e, FLOW, "t_end", e->times + w->set->truths, e->flows, error);
    if (status == TIDES_OK && e->file[CLASSICAL]) status = put_times(e, CLASSICAL, "t", e->taken[0], e->pictures[0], error);
    if (status == TIDES_OK && e->file[CLASSICAL])
        status = put_times(e, CLASSICAL, "t_between", e->taken[1], e->pictures[1], error);
    for (int i = 0; i < FILES && status == TIDES_OK; i++) {
        if (e->file[i]) status = td_npy_writer_close(e->file[i], error);
        e->file[i] = NULL;
    }
    if (status == TIDES_OK) status = td_text_close(&e->poses, TIDES_OK, error);
    if (status == TIDES_OK) status = write_info(w, error);
    drop(w);
    return status;
}

/* Refuses scenes with more than 65 objects: the mask of the last one would exceed 16 bits. */
static tides_status check(const td_dataset *set, tides_error *error) {
    if (td_check_numbers(set, "evimo", error) != TIDES_OK) return TIDES_BAD_CONFIG;
    const int32_t objects = tides_scene_objects(set->cameras[0].facts.scene);
    if (objects <= 65) return TIDES_OK;
    return td_fail(error, TIDES_BAD_CONFIG, "evimo: masks have 16 bits, 1000 for each object: 65 at most, not %d", objects);
}

const td_layout td_layout_evimo = {.name = "evimo",
                                   .summary = "EVIMO2 v2: npz of events, depth, masks, displacement, poses",
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
