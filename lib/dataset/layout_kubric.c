/* The layout of Kubric's point tracks, as EventKubric (Hamann et al. 2025) has them for events. Each camera has
 * annotations.npy, a dict of target_points (tracks x pictures x 2) [px] and occluded (tracks x pictures), which is 1 also
 * outside of the image. Then there is events.h5 in DSEC's format, and frames/%05d.png with timestamps.txt [s]: a picture for
 * each time of the tracks.
 * The first pixel's centre is at 0.5, as in TAP-Vid. EventKubric's data.hdf5 and its prepared representations aren't
 * written: its loader needs only the annotations of TIDES. */
#include "td_dataset.h"

#include <math.h>
#include <stdlib.h>

typedef struct kubric {
    tides_event_writer *events;
    td_text times;
} kubric;

static tides_status begin(td_writer *w, tides_error *error) {
    kubric *k = w->state = td_alloc(1, sizeof *k, error);
    if (!k) return TIDES_NO_MEMORY;
    tides_status status = td_text_in_folder(&k->times, w->folder, "timestamps.txt", error);
    if (status == TIDES_OK && w->camera->event >= 0)
        status = td_events_begin(w, td_in_folder(w->folder, error, "events.h5"), "hdf5", &k->events, error);
    return status;
}

static tides_status events(td_writer *w, const tides_event *list, size_t count, tides_error *error) {
    return tides_event_writer_append(((kubric *)w->state)->events, list, NULL, count, error);
}

static tides_status picture(td_writer *w, const td_picture *p, tides_error *error) {
    return td_plane_write(w->folder, "frames/%05u.png", (unsigned)p->index, w->camera, 8, 3, p->rgb, error);
}

/* Writes the tracks at the pictures' times, which are whole microseconds. A variation of the run begins at the first picture
 * and ends at the last one. Its tracks.rate_hz gives as many times as there are pictures. The keys' values are whole numbers
 * with an exponent, so that no locale's decimal point can change them. */
static tides_status write_tracks(td_writer *w, tides_error *error) {
    const td_dataset *set = w->set;
    char start[64], stop[64], rate[64];
    snprintf(start, sizeof start, "time.start=%llde-6", (long long)set->start_us);
    const int64_t last = td_dataset_us(set, set->picture_hz, set->pictures - 1);
    const double steps = (double)(set->pictures - 1),
                 hz = steps > 0 ? 1e6 * steps / (double)(last - set->start_us) : set->picture_hz;
    snprintf(stop, sizeof stop, "time.stop=%llde-6", (long long)(steps > 0 ? last : set->stop_us));
    /* rounded up, so that the last picture is included */
    snprintf(rate, sizeof rate, "tracks.rate_hz=%llde-9", (long long)ceil(1e9 * hz));
    const char *const sets[] = {start, stop, rate};
    tides_session *session = NULL;
    char *path = td_in_folder(w->folder, error, "annotations.npy");
    tides_status status = path ? tides_session_vary(w->camera->session, sets, 3, &session, error) : TIDES_NO_MEMORY;
    if (status == TIDES_OK) status = tides_session_tracks(session, path, NULL, NULL, NULL, error);
    tides_session_close(session);
    free(path);
    return status;
}

static tides_status write_times(td_writer *w, tides_error *error) {
    kubric *k = w->state;
    for (size_t i = 0; i < w->set->pictures; i++)
        td_text_put(&k->times, NULL, "%.6f\n", td_seconds(td_dataset_us(w->set, w->set->picture_hz, i)));
    return td_text_close(&k->times, TIDES_OK, error);
}

static void drop(td_writer *w) {
    kubric *k = w->state;
    if (!k) return;
    tides_event_writer_abandon(k->events);
    td_text_drop(&k->times);
    free(k);
    w->state = NULL;
}

static tides_status end(td_writer *w, tides_error *error) {
    kubric *k = w->state;
    tides_status status = td_events_end(w, &k->events, error);
    if (status == TIDES_OK) status = write_times(w, error);
    if (status == TIDES_OK) status = write_tracks(w, error);
    drop(w);
    return status;
}

const td_layout td_layout_kubric = {.name = "kubric",
                                    .summary = "Kubric's tracks of points: annotations.npy, events, pictures",
                                    .per_camera = 1,
                                    .begin = begin,
                                    .events = events,
                                    .picture = picture,
                                    .end = end,
                                    .drop = drop};
