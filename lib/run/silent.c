/* Finds why a run fired no events, from a few pictures rendered after it. Only a run without events pays for these. The tool
 * and Python print the reason. */
#include "run/td_session.h"
#include "td_base.h"
#include "td_math.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Pictures from the run's start to its stop. With few, a motion there and back could be missed. */
enum { PICTURES = 17 };

/* A smaller change of L is rounding in single precision, of objects at rest [log units]. */
static const double at_rest = 1e-5;

/* Findings from the pictures. */
typedef struct shown {
    int pictures;
    double change;   /* largest change of a pixel's L between two pictures */
    double coverage; /* largest coverage */
} shown;

/* Planes of (pixels) numbers. */
typedef struct planes {
    double *least, *most, *L, *coverage;
} planes;

static void take_picture(const planes *p, size_t pixels, shown *seen) {
    for (size_t i = 0; i < pixels; i++) {
        p->least[i] = seen->pictures ? fmin(p->least[i], p->L[i]) : p->L[i];
        p->most[i] = seen->pictures ? fmax(p->most[i], p->L[i]) : p->L[i];
        seen->change = fmax(seen->change, p->most[i] - p->least[i]);
        if (p->coverage) seen->coverage = fmax(seen->coverage, p->coverage[i]);
    }
    seen->pictures++;
}

static tides_status look_at_scene(tides_session *session, planes *p, size_t pixels, shown *seen, tides_error *error) {
    const tides_session_facts *f = &session->facts;
    const double start = f->values.start, length = f->values.stop - start;
    tides_renderer *renderer = NULL;
    tides_frame frame = {.plane = {[TIDES_L] = p->L, [TIDES_COVERAGE] = p->coverage}};
    tides_status status = tides_session_renderer(session, NULL, NULL, &renderer, error);
    if (status == TIDES_OK)
        status = tides_renderer_set_psf(renderer, f->values.sensor.psf_sigma_px, f->values.sensor.psf_domain, error);
    for (int k = 0; k < PICTURES && status == TIDES_OK; k++) {
        const double time = k + 1 < PICTURES ? start + length * k / (PICTURES - 1) : f->values.stop;
        status = tides_renderer_frame(renderer, f->camera, time, &frame, error);
        if (status == TIDES_OK) take_picture(p, pixels, seen);
    }
    tides_renderer_destroy(renderer);
    return status;
}

/* Looks at frames; not of a pipe, which has been read already. */
static tides_status look_at_frames(const tides_session_facts *f, planes *p, size_t pixels, shown *seen, tides_error *error) {
    const size_t count = tides_frames_count(f->frames), step = count / PICTURES + 1;
    tides_status status = TIDES_OK;
    if (tides_frames_planes(f->frames) != 1) return TIDES_OK;
    for (size_t k = 0; k < count && status == TIDES_OK; k += step) {
        status = tides_frames_read(f->frames, k, p->L, error);
        for (size_t i = 0; i < pixels; i++) p->L[i] = td_ln(p->L[i] + f->values.image.log_eps);
        if (status == TIDES_OK) take_picture(p, pixels, seen);
    }
    return status;
}

static tides_status look(tides_session *session, shown *seen, tides_error *error) {
    const tides_session_facts *f = &session->facts;
    const size_t pixels = (size_t)f->intrinsics.width * (size_t)f->intrinsics.height;
    double *room = td_alloc(4 * pixels, sizeof *room, error);
    planes p = {room, room ? room + pixels : NULL, room ? room + 2 * pixels : NULL, room ? room + 3 * pixels : NULL};
    if (!room) return TIDES_NO_MEMORY;
    if (f->frames) p.coverage = NULL;
    const tides_status status =
        f->frames ? look_at_frames(f, &p, pixels, seen, error) : look_at_scene(session, &p, pixels, seen, error);
    free(room);
    return status;
}

/* -- the text ---------------------------------------------------------------------------------------------------------- */

/* The reason why no pixel can fire, for the method tides. */
static int say_pixels(const tides_run_values *v, const shown *seen, char text[TIDES_SILENCE]) {
    const int own = strcmp(v->method, "tides") == 0;
    if (own && v->sensor.dead_pixel_fraction >= 1)
        return snprintf(text, TIDES_SILENCE, "no events: all pixels are dead (sensor.dead_pixel_fraction is 1)");
    if (own && seen->pictures && v->sensor.b_min > 0 && !v->frames_file && seen->coverage < v->sensor.b_min)
        return snprintf(text, TIDES_SILENCE,
                        "no events: all pixels are masked: the largest coverage is %.2g, and sensor.b_min is %g",
                        seen->coverage, v->sensor.b_min);
    return 0;
}

static void say_change(const tides_run_values *v, const shown *seen, char text[TIDES_SILENCE]) {
    const int own = strcmp(v->method, "tides") == 0;
    const double least = fmin(v->sensor.threshold_on, v->sensor.threshold_off);
    if (seen->change < at_rest && v->frames_file)
        snprintf(text, TIDES_SILENCE, "no events: the frames are all alike");
    else if (seen->change < at_rest)
        snprintf(text, TIDES_SILENCE,
                 "no events: the image stays the same: camera and scene are at rest, or what moves can't be told from what is "
                 "behind it");
    else if (!own)
        snprintf(text, TIDES_SILENCE, "no events: no pixel's L changes by more than %.3g in %d pictures of the run",
                 seen->change, seen->pictures);
    else if (seen->change < least)
        snprintf(text, TIDES_SILENCE,
                 "no events: no pixel's L changes by more than %.3g in %d pictures of the run, %.3g %% of the threshold of %g: "
                 "lower sensor.threshold_on and threshold_off, or let more move",
                 seen->change, seen->pictures, 100 * seen->change / least, least);
    else
        snprintf(text, TIDES_SILENCE,
                 "no events, though L changes by up to %.3g, beyond the threshold of %g: look at what stands between them: "
                 "sensor.threshold_sigma, b_min, dead_pixel_fraction, frontend.*",
                 seen->change, least);
}

tides_status tides_session_silence(tides_session *session, const tides_stats *stats, char text[TIDES_SILENCE],
                                   tides_error *error) {
    if (!session || !stats || !text)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_session_silence: session, stats or text is NULL");
    const tides_session_facts *f = &session->facts;
    shown seen = {.pictures = 0};
    text[0] = '\0';
    if (!f->frames && stats->render.pairs_evaluated == 0) {
        snprintf(text, TIDES_SILENCE, "nothing of the scene was in view, at any time: look at the path, or at camera.up");
        return TIDES_OK;
    }
    if (stats->events > 0 && stats->events_written == 0)
        snprintf(text, TIDES_SILENCE,
                 "no events: readout and filters dropped all %llu that pixels fired: look at readout.*, filters.*",
                 (unsigned long long)stats->events);
    if (stats->events > 0 || (f->values.frames_file && strcmp(f->values.frames_file, "-") == 0)) return TIDES_OK;
    const tides_status status = look(session, &seen, error);
    if (status == TIDES_OK && !say_pixels(&f->values, &seen, text) && seen.pictures) say_change(&f->values, &seen, text);
    return status;
}
