/* BlinkFlow (Li et al. 2023), of each camera: events_left/events.h5 as DSEC has it, and forward_flow/%06d.npy, float32
 * (height, width, 3): the displacement to the next ground truth [px], and 1 where it is known. A point that is hidden there has
 * one, too. */
#include "archive/td_npy.h"
#include "td_dataset.h"

#include <math.h>
#include <stdlib.h>

typedef struct blinkflow {
    tides_event_writer *events;
    float *flow;
} blinkflow;

static tides_status begin(td_writer *w, tides_error *error) {
    blinkflow *b = w->state = td_alloc(1, sizeof *b, error);
    if (!b) return TIDES_NO_MEMORY;
    b->flow = td_alloc(3 * td_pixels(w->camera), sizeof *b->flow, error);
    if (!b->flow) return TIDES_NO_MEMORY;
    if (w->camera->event < 0) return TIDES_OK;
    return td_events_begin(w, td_in_folder(w->folder, error, "events_left/events.h5"), "hdf5", &b->events, error);
}

static tides_status events(td_writer *w, const tides_event *list, size_t count, tides_error *error) {
    return tides_event_writer_append(((blinkflow *)w->state)->events, list, count, error);
}

static tides_status write_flow(td_writer *w, const char *path, const float *flow, tides_error *error) {
    const size_t inner[2] = {(size_t)w->camera->facts.intrinsics.width, 3};
    td_npy_writer *npy = NULL;
    tides_status status = td_npy_writer_open(path, 0, &npy, error);
    if (status != TIDES_OK) return status;
    status = td_npy_writer_put(npy, "data", "'<f4'", sizeof(float), 3, inner, flow, (size_t)w->camera->facts.intrinsics.height,
                               error);
    return td_npy_writer_end(npy, status, error);
}

static tides_status truth(td_writer *w, const td_truth *t, tides_error *error) {
    float *flow = ((blinkflow *)w->state)->flow;
    if (!t->next_u) return TIDES_OK;
    for (size_t i = 0; i < td_pixels(w->camera); i++) {
        const int known = !isnan(t->next_u[i]);
        flow[3 * i] = known ? (float)t->next_u[i] : 0;
        flow[3 * i + 1] = known ? (float)t->next_v[i] : 0;
        flow[3 * i + 2] = known ? 1 : 0;
    }
    char *path = td_in_folder(w->folder, error, "forward_flow/%06zu.npy", t->index);
    tides_status status = path ? td_make_parents(path, error) : TIDES_NO_MEMORY;
    if (status == TIDES_OK) status = write_flow(w, path, flow, error);
    free(path);
    return status;
}

static void drop(td_writer *w) {
    blinkflow *b = w->state;
    if (!b) return;
    tides_event_writer_abandon(b->events);
    free(b->flow);
    free(b);
    w->state = NULL;
}

static tides_status end(td_writer *w, tides_error *error) {
    blinkflow *b = w->state;
    const tides_status status = td_events_end(w, &b->events, error);
    drop(w);
    return status;
}

const td_layout td_layout_blinkflow = {.name = "blinkflow",
                                       .summary = "BlinkFlow: events and displacement",
                                       .per_camera = 1,
                                       .begin = begin,
                                       .events = events,
                                       .truth = truth,
                                       .end = end,
                                       .drop = drop};
