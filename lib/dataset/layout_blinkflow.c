/* The layout of BlinkFlow (Li et al. 2023). Each camera has events_left/events.h5 as in DSEC, forward_flow/%06d.npy, and
 * config.yaml. Flow is float32 (height, width, 3): the displacement to the next ground truth [px], and 1 where it is known,
 * even if the point is hidden then. The loader combines flow K with the events in [K, K + 1] / fps, with fps and duration
 * from config.yaml (defaults 10 and 1 s). Its times count from the first ground truth, so earlier events are left out.
 * `start` in config.yaml is that time in the run [s]. */
#include "archive/td_npy.h"
#include "signal/td_step.h"
#include "td_dataset.h"

#include <math.h>
#include <stdlib.h>

typedef struct blinkflow {
    tides_event_writer *events;
    float *flow;
} blinkflow;

static int64_t stop_of(const td_writer *w) { return td_time_ns(w->camera->facts.values.stop) - 1000 * w->set->start_us; }

static tides_status write_config(const td_writer *w, tides_error *error) {
    const td_dataset *set = w->set;
    td_text text = {0};
    tides_status status = td_text_in_folder(&text, w->folder, "config.yaml", error);
    if (status != TIDES_OK) return status;
    td_text_put(&text, NULL, "fps: %.17g\nduration: %.17g\nstart: %.6f\n", set->truth_hz,
                (double)(set->truths - 1) / set->truth_hz, td_seconds(set->start_us));
    return td_text_close(&text, status, error);
}

/* Begins the events; the file's time 0 is the first ground truth. */
static tides_status begin_events(const td_writer *w, char *path, tides_event_writer **events, tides_error *error) {
    const tides_session_facts *f = &w->camera->facts;
    const tides_event_file facts = {.width = f->intrinsics.width,
                                    .height = f->intrinsics.height,
                                    .run = f->values.json,
                                    .seed = f->values.seed,
                                    .stop_ns = stop_of(w)};
    tides_status status = path ? td_make_parents(path, error) : TIDES_NO_MEMORY;
    if (status == TIDES_OK) status = tides_event_writer_open(path, "hdf5", &facts, events, error);
    free(path);
    return status;
}

static tides_status begin(td_writer *w, tides_error *error) {
    blinkflow *b = w->state = td_alloc(1, sizeof *b, error);
    if (!b) return TIDES_NO_MEMORY;
    b->flow = td_alloc(3 * td_pixels(w->camera), sizeof *b->flow, error);
    if (!b->flow) return TIDES_NO_MEMORY;
    tides_status status = write_config(w, error);
    if (w->camera->event < 0 || status != TIDES_OK) return status;
    return begin_events(w, td_in_folder(w->folder, error, "events_left/events.h5"), &b->events, error);
}

static tides_status events(td_writer *w, const tides_event *list, size_t count, tides_error *error) {
    enum { TAKEN = 1024 }; /* events written at once */
    tides_event moved[TAKEN];
    tides_status status = TIDES_OK;
    for (size_t i = 0, some = 0; i < count && status == TIDES_OK; i++) {
        moved[some] = list[i];
        moved[some].t -= 1000 * w->set->start_us;
        some += moved[some].t >= 0;
        if (some == 0 || (some < TAKEN && i + 1 < count)) continue;
        status = tides_event_writer_append(((blinkflow *)w->state)->events, moved, NULL, some, error);
        some = 0;
    }
    return status;
}

static tides_status write_flow(td_writer *w, const char *path, const float *flow, tides_error *error) {
    const size_t inner[2] = {(size_t)w->camera->facts.intrinsics.width, 3};
    td_npy_writer *npy = NULL;
    tides_status status = td_npy_writer_open(path, 0, &npy, error);
    if (status != TIDES_OK) return status;
    status = td_npy_writer_put(npy, &(td_npy_form){"data", "'<f4'", sizeof(float), 3, inner}, flow,
                               (size_t)w->camera->facts.intrinsics.height, error);
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
    tides_event_writer *events = b->events;
    b->events = NULL;
    const tides_status status = events ? tides_event_writer_finish(events, stop_of(w), error) : TIDES_OK;
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
