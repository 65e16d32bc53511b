/* Renders a camera at the dataset's times: pictures, and ground truth with the displacements to the neighbouring times. If a
 * layout needs a rectified view that differs from the camera's own, that is rendered, too. */
#include "td_dataset.h"

#include <stdlib.h>
#include <string.h>

/* Planes of an image, in one block of memory. */
enum { R, G, B, Y, FLOW_U, FLOW_V, DEPTH, INSTANCE, NEXT_U, NEXT_V, NEXT_SEEN, BEFORE_U, BEFORE_V, PLANES };

typedef struct scenes {
    const td_scenes *to;
    const td_dataset *set;
    const td_member *camera;
    const td_view *view; /* given to the layouts that use this view */
    tides_renderer *renderer;
    td_share share; /* progress of the current picture or ground truth */
    size_t pixels;
    double *values;
    uint8_t *grey, *rgb;
    uint16_t *numbers; /* of an exposed picture */
    tides_error *error;
} scenes;

static double *plane(const scenes *s, int which) { return s->values + (size_t)which * s->pixels; }

static tides_status open_scenes(scenes *s) {
    s->pixels = td_pixels(s->camera);
    s->values = td_alloc(PLANES * s->pixels, sizeof *s->values, s->error);
    s->rgb = s->values ? td_alloc(6 * s->pixels, 1, s->error) : NULL;
    s->numbers = s->rgb ? td_alloc(3 * s->pixels, sizeof *s->numbers, s->error) : NULL;
    if (!s->numbers) return TIDES_NO_MEMORY;
    s->grey = s->rgb + 3 * s->pixels;
    const tides_session_facts *f = &s->camera->facts;
    return tides_renderer_create(f->device, f->scene, &s->view->intrinsics, &f->values.image, NULL, NULL, &s->renderer,
                                 s->error);
}

static void close_scenes(scenes *s) {
    tides_renderer_destroy(s->renderer);
    free(s->numbers);
    free(s->rgb);
    free(s->values);
}

/* 1 if a layout's pictures (or ground truth) are of this view. */
static int shows(const scenes *s, const td_writer *w, int kind) {
    return (w->layout->rectified && s->camera->rectified[kind].differs) == s->view->differs;
}

/* -- pictures -------------------------------------------------------------------------------------------------------------- */

/* Renders a picture of an instant. */
static tides_status render(scenes *s, int64_t us) {
    tides_frame frame = {{NULL}};
    frame.plane[TIDES_R] = plane(s, R), frame.plane[TIDES_G] = plane(s, G), frame.plane[TIDES_B] = plane(s, B);
    frame.plane[TIDES_Y] = plane(s, Y);
    tides_status status = tides_renderer_frame(s->renderer, s->view->path, td_seconds(us), &frame, s->error);
    if (status != TIDES_OK) return status;
    const int32_t width = s->camera->facts.intrinsics.width, height = s->camera->facts.intrinsics.height;
    tides_picture_grey(plane(s, Y), width, height, 1.0, s->rgb);
    for (size_t i = 0; i < s->pixels; i++) s->grey[i] = s->rgb[3 * i];
    tides_picture_rgb(plane(s, R), plane(s, G), plane(s, B), width, height, s->rgb);
    return TIDES_OK;
}

static tides_status picture(scenes *s, size_t index) {
    const int64_t us = td_dataset_us(s->set, s->set->picture_hz, index);
    td_picture made = {index, us, us, us, s->grey, s->rgb};
    tides_status status;
    if (s->set->exposed) {
        const td_exposed to = {plane(s, R), s->numbers, s->rgb, s->grey};
        td_exposed_between(s->camera, us, &made.from_us, &made.to_us);
        status = td_exposed_make(s->camera, s->view->path, s->renderer, &made, &to, s->error);
    } else {
        status = render(s, us);
    }
    for (td_writer *w = s->to->writers; w < s->to->writers + s->to->count && status == TIDES_OK; w++)
        if (w->layout->picture && shows(s, w, TD_PICTURE)) status = w->layout->picture(w, &made, s->error);
    return status;
}

/* -- ground truth ---------------------------------------------------------------------------------------------------------- */

static tides_status displacement(scenes *s, int64_t from, int64_t to, int which, double *seen) {
    return tides_renderer_displacement(s->renderer, s->view->path, td_seconds(from), td_seconds(to), plane(s, which),
                                       plane(s, which + 1), seen, s->error);
}

static tides_status planes_at(scenes *s, double time) {
    tides_truth truth = {{NULL}};
    truth.plane[TIDES_TRUTH_FLOW_U] = plane(s, FLOW_U);
    truth.plane[TIDES_TRUTH_FLOW_V] = plane(s, FLOW_V);
    truth.plane[TIDES_TRUTH_DEPTH_MEDIAN] = plane(s, DEPTH);
    truth.plane[TIDES_TRUTH_INSTANCE] = plane(s, INSTANCE);
    return tides_renderer_truth(s->renderer, s->view->path, time, &truth, s->error);
}

static tides_status truth(scenes *s, size_t index) {
    const double hz = s->set->truth_hz;
    const int first = index == 0, last = index + 1 == s->set->truths;
    td_truth made = {.index = index, .us = td_dataset_us(s->set, hz, index)};
    made.next_us = td_dataset_us(s->set, hz, index + 1);
    made.before_us = first ? made.us : td_dataset_us(s->set, hz, index - 1);
    tides_status status = planes_at(s, td_seconds(made.us));
    if (status == TIDES_OK && !last) status = displacement(s, made.us, made.next_us, NEXT_U, plane(s, NEXT_SEEN));
    if (status == TIDES_OK && !first) status = displacement(s, made.us, made.before_us, BEFORE_U, NULL);
    made.flow_u = plane(s, FLOW_U), made.flow_v = plane(s, FLOW_V);
    made.depth = plane(s, DEPTH), made.instance = plane(s, INSTANCE);
    if (!last) made.next_u = plane(s, NEXT_U), made.next_v = plane(s, NEXT_V), made.next_seen = plane(s, NEXT_SEEN);
    if (!first) made.before_u = plane(s, BEFORE_U), made.before_v = plane(s, BEFORE_V);
    for (td_writer *w = s->to->writers; w < s->to->writers + s->to->count && status == TIDES_OK; w++)
        if (w->layout->truth && shows(s, w, TD_TRUTH)) status = w->layout->truth(w, &made, s->error);
    return status;
}

/* A view, and the numbers of its pictures and ground truths to render. */
typedef struct pass {
    const td_view *view;
    size_t pictures, truths;
} pass;

/* Renders a pass; `done` of `all` images were given before. */
static tides_status give(scenes *s, const pass *p, size_t done, size_t all) {
    tides_status status = tides_renderer_set_progress(s->renderer, td_share_step, &s->share, s->error);
    for (size_t i = 0; i < p->pictures + p->truths && status == TIDES_OK; i++) {
        const int is_picture = i < p->pictures;
        s->share = (td_share){s->to->step, s->to->user, (double)(done + i) / (double)all, 1 / (double)all,
                              is_picture ? "pictures" : "ground truth"};
        status = is_picture ? picture(s, i) : truth(s, i - p->pictures);
    }
    return status;
}

/* Renders all of a camera. Its own view is always needed, for the overview picture; a rectified one only where it differs.
 * Rectified ground truth is only that of the left event camera. */
tides_status td_scenes_give(const td_scenes *to, const td_dataset *set, const td_member *camera, tides_error *error) {
    const td_view raw = {.intrinsics = camera->facts.intrinsics, .path = camera->facts.camera}, *const flat = camera->rectified;
    const pass passes[] = {{&raw, camera->picture >= 0 ? set->pictures : 0, set->truths},
                           {&flat[TD_PICTURE], flat[TD_PICTURE].differs ? set->pictures : 0, 0},
                           {&flat[TD_TRUTH], 0, flat[TD_TRUTH].differs && camera->event == 0 ? set->truths : 0}};
    enum { PASSES = sizeof passes / sizeof *passes };
    size_t all = 0, done = 0;
    for (int i = 0; i < PASSES; i++) all += passes[i].pictures + passes[i].truths;
    tides_status status = TIDES_OK;
    for (int i = 0; i < PASSES && status == TIDES_OK; i++) {
        const size_t count = passes[i].pictures + passes[i].truths;
        if (count == 0) continue;
        scenes s = {.to = to, .set = set, .camera = camera, .view = passes[i].view, .error = error};
        status = open_scenes(&s);
        if (status == TIDES_OK) status = give(&s, &passes[i], done, all);
        close_scenes(&s);
        done += count;
    }
    return status;
}
