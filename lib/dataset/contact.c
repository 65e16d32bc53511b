/* contact.png: an overview, with a row for each camera, so that a glance tells if the dataset is as intended. A row has the
 * picture in the middle of the sequence, the events around that time, flow, depth and instances. */
#include "image/td_truth_range.h"
#include "td_dataset.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Panels of a row from left to right, and sizes [px]: gap between panels, height of a label, width of a letter. */
enum { PICTURE, EVENTS, FLOW, DEPTH, INSTANCE, PANELS, GAP = 4, LABEL = 14, LETTER = 6 };
static const char *const labels[PANELS] = {"picture", "events", "flow", "depth", "instance"};

/* Events are drawn that are less than this time [us] away from the middle. */
enum { HALF_WINDOW = 10000 };

/* All panels have the size of the largest camera. Panels that a camera lacks stay dark. */
typedef struct contact {
    uint8_t *rgb, *panel;
    int32_t width, height, cell_width, cell_height;
    tides_event *events;
    size_t count, capacity;
    int32_t row;
} contact;

static size_t middle(size_t count) { return count / 2; }
static int64_t middle_us(const td_dataset *set) { return td_dataset_us(set, set->truth_hz, middle(set->truths)); }

static tides_status open_sheet(td_writer *w, tides_error *error) {
    contact *c = w->kept = td_alloc(1, sizeof *c, error);
    if (!c) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < w->set->count; i++) {
        const tides_intrinsics *k = &w->set->cameras[i].facts.intrinsics;
        if (k->width > c->cell_width) c->cell_width = k->width;
        if (k->height > c->cell_height) c->cell_height = k->height;
    }
    c->row = -1;
    c->width = PANELS * (c->cell_width + GAP) + GAP;
    c->height = (int32_t)w->set->count * (c->cell_height + GAP + LABEL) + GAP;
    c->rgb = td_alloc(3 * (size_t)c->width, (size_t)c->height, error);
    c->panel = c->rgb ? td_alloc(3 * (size_t)c->cell_width, (size_t)c->cell_height, error) : NULL;
    if (!c->panel) return TIDES_NO_MEMORY;
    memset(c->rgb, 24, 3 * (size_t)c->width * (size_t)c->height);
    return TIDES_OK;
}

static tides_status begin(td_writer *w, tides_error *error) {
    const tides_status status = w->kept ? TIDES_OK : open_sheet(w, error);
    if (status != TIDES_OK) return status;
    contact *c = w->kept;
    c->row++;
    c->count = 0;
    return TIDES_OK;
}

/* Puts a camera's panel in its place, with a label above it. */
static void place(td_writer *w, int panel, const uint8_t *rgb, const char *scale) {
    static const uint8_t light[3] = {230, 230, 230};
    contact *c = w->kept;
    const tides_intrinsics *k = &w->camera->facts.intrinsics;
    const int32_t left = GAP + panel * (c->cell_width + GAP), top = c->row * (c->cell_height + GAP + LABEL) + LABEL;
    char text[80];
    snprintf(text, sizeof text, "%s %s%s", panel == 0 ? w->camera->name : "", labels[panel], scale);
    /* the label ends before that of the next panel */
    if (c->cell_width / LETTER + 1 < (int32_t)sizeof text) text[c->cell_width / LETTER + 1] = '\0';
    tides_picture_text(c->rgb, c->width, c->height, left, top - LABEL + 3, 1, light, text + (panel != 0));
    for (int32_t y = 0; y < k->height; y++)
        memcpy(c->rgb + 3 * ((size_t)(top + y) * (size_t)c->width + (size_t)left), rgb + 3 * (size_t)y * (size_t)k->width,
               3 * (size_t)k->width);
}

static tides_status events(td_writer *w, const tides_event *list, size_t count, tides_error *error) {
    contact *c = w->kept;
    const int64_t from = 1000 * (middle_us(w->set) - HALF_WINDOW), to = 1000 * (middle_us(w->set) + HALF_WINDOW);
    for (size_t i = 0; i < count; i++) {
        if (list[i].t < from || list[i].t >= to) continue;
        void *all = c->events;
        const tides_status status = td_reserve(&all, &c->capacity, c->count + 1, sizeof *list, error);
        c->events = all;
        if (status != TIDES_OK) return status;
        c->events[c->count++] = list[i];
    }
    return TIDES_OK;
}

static tides_status picture(td_writer *w, const td_picture *p, tides_error *error) {
    (void)error;
    if (p->index == middle(w->set->pictures)) place(w, PICTURE, p->rgb, "");
    return TIDES_OK;
}

static tides_status truth(td_writer *w, const td_truth *t, tides_error *error) {
    (void)error;
    contact *c = w->kept;
    if (t->index != middle(w->set->truths)) return TIDES_OK;
    const int32_t width = w->camera->facts.intrinsics.width, height = w->camera->facts.intrinsics.height;
    const size_t pixels = (size_t)width * (size_t)height;
    const double most = td_fastest(t->flow_u, t->flow_v, pixels);
    char scale[48];
    double near, far;
    td_depth_range(t->depth, pixels, &near, &far);
    tides_picture_flow(t->flow_u, t->flow_v, width, height, most, c->panel);
    tides_picture_flow_key(c->panel, width, height);
    snprintf(scale, sizeof scale, ", up to %.4g px/s", most);
    place(w, FLOW, c->panel, scale);
    tides_picture_depth(t->depth, width, height, near, far, c->panel);
    tides_picture_depth_key(c->panel, width, height);
    const double unit = w->set->metres > 0 ? w->set->metres : 1;
    snprintf(scale, sizeof scale, ", %.3g to %.3g %s", unit * fmin(near, far), unit * far, w->set->metres > 0 ? "m" : "units");
    place(w, DEPTH, c->panel, scale);
    tides_picture_labels(t->instance, width, height, c->panel);
    place(w, INSTANCE, c->panel, "");
    return TIDES_OK;
}

static tides_status end(td_writer *w, tides_error *error) {
    (void)error;
    contact *c = w->kept;
    if (w->camera->event < 0) return TIDES_OK;
    tides_picture_events(c->events, c->count, NULL, w->camera->facts.intrinsics.width, w->camera->facts.intrinsics.height,
                         c->panel);
    place(w, EVENTS, c->panel, ", 20 ms");
    return TIDES_OK;
}

static tides_status complete(td_writer *w, tides_error *error) {
    contact *c = w->kept;
    char *path = td_in_folder(w->root, error, "contact.png");
    const tides_status status = path ? tides_png_write(path, c->width, c->height, c->rgb, error) : TIDES_NO_MEMORY;
    free(path);
    return status;
}

static void drop(td_writer *w) {
    contact *c = w->kept;
    if (!c) return;
    free(c->events);
    free(c->panel);
    free(c->rgb);
    free(c);
}

const td_layout td_layout_contact = {.name = "contact",
                                     .summary = "a picture of the dataset",
                                     .begin = begin,
                                     .events = events,
                                     .picture = picture,
                                     .truth = truth,
                                     .end = end,
                                     .complete = complete,
                                     .drop = drop};
