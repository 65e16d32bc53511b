/* Light of the pixels that have events, sampled so often that ln(Y) is nearly straight between samples. It is rendered where
 * the run has a scene, else read from its frames. */
#include "td_calibrate.h"
#include "td_math.h"
#include "td_random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    PIXELS_MOST = 12000,    /* whose light is kept: they give some 50 000 pairs, which are enough */
    VALUES_MOST = 60000000, /* pixels x samples: 240 MB, twice while they are transposed */
    LEVELS = 4,             /* greatest number of halvings of a step of STEP_S: down to 0.125 ms */
    PURPOSE = 200           /* of td_random: to choose pixels */
};
#define STEP_S 2e-3
/* [log units] A step is halved where its middle is farther off a straight line. Lines cut extremes off, so changes are too
 * small: at 0.008 and 0.25 ms, thresholds of 0.77 on the demo's fast scene by 0.7 %, at 0.004 and 0.125 ms by 0.25 %. */
#define BENT 0.004
#define SHARE 0.02 /* the step is halved where this is so in more than this share of the pixels */
#define DARK 0.02  /* black level assumed for that: it isn't known yet */

/* Samples in order of time, each with the chosen pixels in their order. */
typedef struct rows {
    td_calibration *c;
    tides_renderer *renderer;
    double *Y; /* one frame */
    float **row;
    double *time;
    size_t count, capacity, times_capacity;
    double from, to; /* for progress reports */
} rows;

static tides_status told(const rows *r, double time, tides_error *error) {
    return td_calibrate_told(r->c, 0.04 + 0.46 * (time - r->from) / (r->to - r->from), "looking at the light", error);
}

/* Makes a row of the chosen pixels from the frame in r->Y, and updates the range of all pixels within the stretch. */
static float *row_of(rows *r, double time, tides_error *error) {
    td_light *light = &r->c->light;
    float *row = td_alloc(light->count, sizeof *row, error);
    const size_t pixels = (size_t)r->c->taken.width * (size_t)r->c->taken.height;
    const double length = 1e-9 * (double)(r->c->taken.stop_ns - r->c->taken.start_ns);
    for (size_t i = 0; row && i < light->count; i++) row[i] = (float)r->Y[light->pixel[i]];
    for (size_t p = 0; p < pixels && time >= -0.01 && time <= length; p++) {
        const float Y = (float)r->Y[p];
        if (Y < light->lowest[p]) light->lowest[p] = Y;
        if (Y > light->highest[p]) light->highest[p] = Y;
    }
    return row;
}

static tides_status render(rows *r, double time, float **row, tides_error *error) {
    const tides_frame frame = {.plane = {r->Y}};
    const double at = 1e-9 * (double)r->c->taken.start_ns + time;
    tides_status status = tides_renderer_frame(r->renderer, r->c->facts.camera, at, &frame, error);
    if (status == TIDES_OK) status = told(r, time, error);
    if (status != TIDES_OK) return status;
    *row = row_of(r, time, error);
    return *row ? TIDES_OK : TIDES_NO_MEMORY;
}

/* Keeps a row as the next sample, and owns it from then on. */
static tides_status keep(rows *r, double time, float *row, tides_error *error) {
    tides_status status = td_reserve((void **)&r->row, &r->capacity, r->count + 1, sizeof *r->row, error);
    if (status == TIDES_OK) status = td_reserve((void **)&r->time, &r->times_capacity, r->count + 1, sizeof *r->time, error);
    if (status != TIDES_OK) {
        free(row);
        return status;
    }
    r->row[r->count] = row;
    r->time[r->count++] = time;
    return TIDES_OK;
}

static int32_t is_bent(const rows *r, const float *a, const float *mid, const float *b) {
    const size_t n = r->c->light.count;
    size_t bent = 0;
    for (size_t i = 0; i < n; i++) {
        const float off = (a[i] + (float)DARK) * (b[i] + (float)DARK) / ((mid[i] + (float)DARK) * (mid[i] + (float)DARK));
        bent += fabs(0.5 * td_ln((double)off)) > BENT; /* the middle against the mean of the ends' logarithms */
    }
    return (double)bent > SHARE * (double)n;
}

/* Keeps the rows needed within (t0, t1); the caller keeps both ends. `a` and `b` are the ends' rows. */
static tides_status between(rows *r, const float *a, double t0, const float *b, double t1, int32_t level, tides_error *error) {
    const double mid = 0.5 * (t0 + t1);
    float *row = NULL;
    tides_status status = render(r, mid, &row, error);
    if (status != TIDES_OK) return status;
    const int32_t finer = level < LEVELS && is_bent(r, a, row, b);
    if (finer) status = between(r, a, t0, row, mid, level + 1, error);
    if (status != TIDES_OK) {
        free(row);
        return status;
    }
    status = keep(r, mid, row, error);
    return finer && status == TIDES_OK ? between(r, row, mid, b, t1, level + 1, error) : status;
}

static tides_status sample_scene(rows *r, tides_error *error) {
    const int32_t steps = (int32_t)ceil((r->to - r->from) / STEP_S);
    float *row = NULL;
    tides_status status = render(r, r->from, &row, error);
    if (status == TIDES_OK) status = keep(r, r->from, row, error);
    for (int32_t i = 0; i < steps && status == TIDES_OK; i++) {
        const double t0 = r->time[r->count - 1], t1 = r->from + (r->to - r->from) * (i + 1) / steps;
        const float *before = r->row[r->count - 1];
        float *next = NULL;
        status = render(r, t1, &next, error);
        if (status == TIDES_OK) status = between(r, before, t0, next, t1, 1, error);
        if (status == TIDES_OK)
            status = keep(r, t1, next, error);
        else
            free(next);
    }
    return status;
}

static tides_status sample_frames(rows *r, tides_error *error) {
    tides_frames *frames = r->c->facts.frames;
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < tides_frames_count(frames) && status == TIDES_OK; i++) {
        const double time = tides_frames_time(frames, i) - 1e-9 * (double)r->c->taken.start_ns;
        const int32_t last = i + 1 == tides_frames_count(frames);
        if (time > r->to || (!last && tides_frames_time(frames, i + 1) - 1e-9 * (double)r->c->taken.start_ns < r->from))
            continue;
        status = tides_frames_read(frames, i, r->Y, error);
        float *row = status == TIDES_OK ? row_of(r, time, error) : NULL;
        if (status == TIDES_OK) status = row ? keep(r, time, row, error) : TIDES_NO_MEMORY;
        if (status == TIDES_OK) status = told(r, fmin(time, r->to), error);
    }
    return status;
}

/* -- which pixels ---------------------------------------------------------------------------------------- */

/* Chooses pixels with two events outside of bursts, at random where there are too many. */
static tides_status choose(td_calibration *c, size_t most, tides_error *error) {
    const td_taken *t = &c->taken;
    const size_t pixels = (size_t)t->width * (size_t)t->height;
    uint8_t *good = td_alloc(pixels, 1, error);
    size_t count = 0, kept = 0;
    if (!good) return TIDES_NO_MEMORY;
    for (size_t p = 0; p < pixels; p++) {
        size_t quiet = 0;
        for (size_t i = t->first[p]; i < t->first[p + 1]; i++) quiet += !t->events[i].cause;
        count += good[p] = quiet >= 2;
    }
    c->light.pixel = td_alloc(count < most ? count : most, sizeof *c->light.pixel, error);
    for (size_t p = 0; c->light.pixel && p < pixels; p++) {
        if (!good[p]) continue;
        const td_random_bits bits = td_random(c->options->seed, (uint32_t)p, 0, PURPOSE);
        const double u = td_random_uniform(&bits, 0);
        if (u * (double)count < (double)(most - kept)) c->light.pixel[kept++] = (uint32_t)p; /* sampling without replacement */
        count--;
    }
    c->light.count = kept;
    free(good);
    return c->light.pixel ? TIDES_OK : TIDES_NO_MEMORY;
}

/* -- all of it ---------------------------------------------------------------------------------------- */

void td_light_span(const tides_session_facts *facts, double *start, double *stop) {
    if (facts->frames) {
        *start = tides_frames_time(facts->frames, 0);
        *stop = tides_frames_time(facts->frames, tides_frames_count(facts->frames) - 1);
        return;
    }
    tides_trajectory_range(facts->camera, start, stop);
}

static tides_status room(td_calibration *c, tides_error *error) {
    const size_t pixels = (size_t)c->taken.width * (size_t)c->taken.height;
    c->light.lowest = td_alloc(pixels, sizeof *c->light.lowest, error);
    c->light.highest = td_alloc(pixels, sizeof *c->light.highest, error);
    if (!c->light.lowest || !c->light.highest) return TIDES_NO_MEMORY;
    for (size_t p = 0; p < pixels; p++) {
        c->light.lowest[p] = INFINITY;
        c->light.highest[p] = -INFINITY;
    }
    return TIDES_OK;
}

/* Transposes rows: the samples of a pixel become neighbours. */
static tides_status turn(rows *r, tides_error *error) {
    td_light *light = &r->c->light;
    light->samples = r->count;
    light->finer = 1;
    light->time = r->time;
    r->time = NULL;
    light->Y = td_alloc(light->count * light->samples, sizeof *light->Y, error);
    light->line = td_alloc(light->samples, sizeof *light->line, error);
    light->decay = td_alloc(light->samples, sizeof *light->decay, error);
    if (!light->Y || !light->line || !light->decay) return TIDES_NO_MEMORY;
    for (size_t k = 0; k < r->count; k++) {
        for (size_t i = 0; i < light->count; i++) light->Y[i * light->samples + k] = r->row[k][i];
        free(r->row[k]);
        r->row[k] = NULL;
    }
    return TIDES_OK;
}

/* Light from frames gets its cubics. */
static tides_status bend(td_calibration *c, tides_error *error) {
    td_light fine, *light = &c->light;
    if (!c->facts.frames) return TIDES_OK;
    const tides_status status = td_light_between(light, 1, TD_CUBICS, &fine, error);
    fine.lowest = light->lowest;
    fine.highest = light->highest;
    light->pixel = NULL;
    light->lowest = light->highest = NULL;
    td_light_free(light);
    *light = fine;
    return status;
}

tides_status td_light_sample(td_calibration *c, tides_session *session, tides_error *error) {
    rows r = {.c = c};
    double start, stop;
    const double zero = 1e-9 * (double)c->taken.start_ns, length = 1e-9 * (double)(c->taken.stop_ns - c->taken.start_ns);
    td_light_span(&c->facts, &start, &stop);
    r.from = fmax(start - zero, -TD_SETTLE_S);
    r.to = fmin(stop - zero, length + TD_SETTLE_S);
    const size_t samples = (size_t)(8 * (r.to - r.from) / STEP_S) + 2; /* half of what the finest steps take: few scenes do */
    tides_status status = choose(c, VALUES_MOST / samples < PIXELS_MOST ? VALUES_MOST / samples : PIXELS_MOST, error);
    if (status == TIDES_OK) status = room(c, error);
    r.Y = td_alloc((size_t)c->taken.width * (size_t)c->taken.height, sizeof *r.Y, error);
    if (status == TIDES_OK && !r.Y) status = TIDES_NO_MEMORY;
    if (status == TIDES_OK && !c->facts.frames) {
        status = tides_session_renderer(session, NULL, NULL, &r.renderer, error);
        if (status == TIDES_OK) status = sample_scene(&r, error);
    } else if (status == TIDES_OK) {
        status = sample_frames(&r, error);
    }
    if (status == TIDES_OK && r.count < 2)
        status = td_fail(error, TIDES_BAD_ARGUMENT, "light is known at fewer than two times of the recording");
    if (status == TIDES_OK) status = turn(&r, error);
    if (status == TIDES_OK) status = bend(c, error);
    tides_renderer_destroy(r.renderer);
    for (size_t k = 0; k < r.count; k++) free(r.row[k]);
    free(r.row);
    free(r.time);
    free(r.Y);
    return status;
}

void td_light_free(td_light *light) {
    free(light->pixel);
    free(light->time);
    free(light->Y);
    free(light->line);
    free(light->decay);
    free(light->lowest);
    free(light->highest);
    memset(light, 0, sizeof *light);
}
