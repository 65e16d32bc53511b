/* One pixel over one step: crossings, ends of refractory periods, noise and mask, in time order.
 *
 * The place in the step is s: 0 at its start, 1 at its end, and 2 for "not in this step". A pixel is held during its refractory
 * period, and masked where it isn't visible. The walk passes over held and masked parts, each in its own way. Between them, the
 * first crossing fires, or the next noise event if that comes first.
 *
 * The response is the signal on the step with the leak's ramp: a cubic, and modes, the exponential decays of the front end.
 * Additive noise and kicks come on top. A kick is the jump of a row's signal when the sensor reads the row for a frame. */
#include "td_pixel.h"
#include "td_between.h"
#include "td_extremes.h"
#include "td_half.h"
#include "td_base.h"
#include "td_math.h"
#include "sensor/noise/td_noise_bridge.h"
#include "td_sensor_parts.h"

#include <math.h>

/* A pixel on its way through the step. */
typedef struct walk {
    td_pixel_job *job;
    const td_pixel_step *pixel;
    double on, off, initial, reference;
    uint32_t count_on, count_off;
    int32_t fired;   /* in this step */
    int32_t crossed; /* of these, crossings, not noise events: at most max_events_per_step */
    int cut;         /* 1: there were more crossings than that */
    double s;
    td_noise_segment segment; /* additive noise: the segment that contains the walk's s */
    td_noise_path path;
    double segment_until;            /* s of the segment's end, or of the row's next kick if that is earlier */
    double noise_until, kick_until;  /* s of either; beyond 1: not in this step */
    double kick, kick_rate, kick_ns; /* the kicks' sum is kick e^(-kick_rate s) [log units]; time of the next kick */
    double low, high;                /* bounds of response and kicks on the step, without noise */
    td_response noisy;               /* a response with noise added, for the search */
    td_response kicked;              /* the response with the kicks up to now */
} walk;

static double time_at(const walk *w, double s) { return w->job->start + s * w->job->step->length_ns; }

static double place_of(const walk *w, double time) { return td_place_of(time, w->job->start, w->job->step->length_ns); }

static double *held_until(const walk *w) { return &w->job->sensor->held_until[w->pixel->i]; }

static double *since(const walk *w) { return &w->job->sensor->since[w->pixel->i]; }

/* -- kicks ----------------------------------------------------------------------------------------------------------------- */

/* Puts the kicks' decay into the response, as one more mode. */
static void put_kick(walk *w) {
    w->kicked.mode[w->pixel->response.modes].cosine = w->kick;
    if (w->job->sensor->additive.on) w->noisy = w->kicked;
}

static void begin_kicks(walk *w) {
    const td_kick *kick = &w->job->sensor->kick;
    double low, high;
    w->kick_until = 2;
    if (!kick->on) return;
    w->kick_rate = w->job->step->length_ns / kick->recovery_ns;
    w->kick = td_kick_at(kick, w->pixel->y, w->job->start);
    w->kick_ns = td_kick_next(kick, w->pixel->y, w->job->start);
    w->kick_until = place_of(w, w->kick_ns);
    w->kicked = w->pixel->response;
    w->kicked.mode[w->kicked.modes++] = (td_mode){.rate = w->kick_rate};
    put_kick(w);
    td_kick_bounds(kick, w->pixel->y, w->job->start, w->job->start + w->job->step->length_ns, &low, &high);
    w->low += low;
    w->high += high;
}

/* Adds the row's kicks up to s. A kick at the step's end belongs to the next step. */
static void seek_kick(walk *w, double s) {
    const td_kick *kick = &w->job->sensor->kick;
    while (w->kick_until <= s && w->kick_until < 1) {
        w->kick += kick->size * td_exp(w->kick_rate * w->kick_until);
        w->kick_ns = td_kick_next(kick, w->pixel->y, nextafter(w->kick_ns, INFINITY));
        w->kick_until = place_of(w, w->kick_ns);
        put_kick(w);
    }
}

static double kick_at(const walk *w, double s) { return w->job->sensor->kick.on ? w->kick * td_exp(-w->kick_rate * s) : 0; }

/* -- additive noise -------------------------------------------------------------------------------------------------------- */

/* Advances noise and kicks to the segment that contains s. */
static void seek_segment(walk *w, double s) {
    const td_sensor *sensor = w->job->sensor;
    if (w->segment_until > s) return;
    while (sensor->additive.on && w->noise_until <= s && w->noise_until < 1) {
        td_additive_noise_next_along(&sensor->additive, sensor->segment.pixel[w->pixel->i],
                                     td_noise_light_of(&w->pixel->input, w->noise_until), &w->path, &w->segment);
        w->noise_until = place_of(w, w->segment.to_ns);
    }
    if (sensor->kick.on) seek_kick(w, s);
    w->segment_until = fmin(w->noise_until, w->kick_until);
}

static void begin_segments(walk *w) {
    const td_sensor *sensor = w->job->sensor;
    size_t i = w->pixel->i;
    w->segment_until = w->noise_until = w->kick_until = 2;
    if (!sensor->additive.on && !sensor->kick.on) return;
    w->noisy = w->pixel->response;
    td_response_range(&w->pixel->response, &w->low, &w->high);
    if (sensor->additive.on) {
        w->low = td_greater(w->low, w->pixel->low);
        w->high = td_lesser(w->high, w->pixel->high);
    }
    begin_kicks(w);
    if (sensor->additive.on) {
        w->path = w->pixel->noise;
        w->segment = sensor->additive.varies
                         ? td_sensor_noise_segment(sensor, i)
                         : td_additive_noise_along(&sensor->additive, sensor->segment.pixel[i],
                                                   (uint64_t)sensor->segment.number[i], sensor->segment.value[i], 0, &w->path);
        w->noise_until = place_of(w, w->segment.to_ns);
    }
    w->segment_until = fmin(w->noise_until, w->kick_until);
    seek_segment(w, 0);
}

/* The noise and the kicks at s, which lies within the current segment; 0 without them. */
static double noise_at(const walk *w, double s) {
    const td_sensor *sensor = w->job->sensor;
    const double kick = kick_at(w, s);
    if (!sensor->additive.on) return kick;
    return kick + td_noise_value(&sensor->additive, sensor->segment.pixel[w->pixel->i], &w->segment, time_at(w, s));
}

/* 1: with any noise of the current segment, a response within [low, high] is between the levels. */
static int stays_between(const walk *w, double low, double high) {
    const td_noise_segment *segment = &w->segment;
    const double least = td_lesser(segment->begin, segment->end) - segment->reach;
    const double most = td_greater(segment->begin, segment->end) + segment->reach;
    return low + least > w->reference - w->off && high + most < w->reference + w->on;
}

/* The first crossing on [from, until], which lies within the current segment. */
static int cross(walk *w, double from, double until, double *at) {
    const td_sensor *sensor = w->job->sensor;
    const td_response *response = sensor->kick.on ? &w->kicked : &w->pixel->response;
    *at = from;
    if (!sensor->additive.on) return td_response_crossing(response, w->reference, w->on, w->off, from, until, at);
    if (stays_between(w, w->low, w->high)) return 0;
    const td_noise_search search = {&sensor->additive,
                                    sensor->segment.pixel[w->pixel->i],
                                    w->job->start,
                                    w->job->step->length_ns,
                                    response,
                                    w->low,
                                    w->high,
                                    &w->noisy,
                                    w->reference,
                                    w->on,
                                    w->off};
    return td_noise_crossing(&search, &w->segment, from, until, at);
}

/* Stores the segment that contains the step's end as the pixel's state. */
static void end_segments(walk *w) {
    const td_sensor *sensor = w->job->sensor;
    if (!sensor->additive.on) return;
    seek_segment(w, 1);
    td_sensor_put_segment(sensor, w->pixel->i, &w->segment);
}

/* The signal at the step's end, with noise and kicks. pixel->end is exact; the response may miss it by rounding. */
static double end_of(walk *w) {
    seek_segment(w, 1);
    return w->pixel->end + noise_at(w, 1);
}

/* -- events and references ------------------------------------------------------------------------------------------------- */

/* The front end's contribution to the signal of an event at s [log units], as a half float. It is noise and kicks, and the
 * response less the log-luminance and the leak's ramp. */
static uint16_t added_at(walk *w, double s) {
    const td_sensor *sensor = w->job->sensor;
    const td_pixel_step *p = w->pixel;
    if (!sensor->labels) return 0;
    seek_segment(w, s);
    double added = noise_at(w, s);
    if (sensor->frontend.on || w->job->light) {
        double S = s < 1 ? td_response_value(&p->response, s) : p->end, ramp = sensor->leak[p->i] * time_at(w, s);
        added += S - ramp - td_model_value(&p->input, s);
    }
    return td_half_bits(added);
}

/* The slope of an event whose time doesn't depend on the light. */
static td_slope free_of_light(int polarity) { return (td_slope){(float)polarity * INFINITY, 0}; }

static const td_slope unknown_slope = {NAN, NAN};

/* How steeply the signal crosses at s, where the search from `from` on has found it beyond a level. Of a signal that was there
 * at `from` and comes back, the time is that of a kick, or of a mask's end. */
static td_slope slope_at(const walk *w, double from, double s, int polarity) {
    const int noisy = w->job->sensor->additive.on;
    if (!w->job->slopes || (!noisy && !w->job->sensor->kick.on)) return unknown_slope;
    const double light = td_response_slope(&w->pixel->response, s);
    const double signal = td_response_slope(noisy ? &w->noisy : &w->kicked, s);
    if (s <= from && !(polarity * signal > 0)) return free_of_light(polarity);
    return (td_slope){(float)signal, (float)light};
}

/* Keeps the slope of the buffer's last event. */
static tides_status keep_slope(const td_pixel_job *job, const td_slope *slope) {
    td_slopes *slopes = job->slopes;
    const size_t count = job->buffer->count;
    if (!slopes) return TIDES_OK;
    tides_status status =
        td_reserve((void **)&slopes->slope, &slopes->capacity, job->buffer->capacity, sizeof *slopes->slope, job->error);
    if (status == TIDES_OK) slopes->slope[count - 1] = *slope;
    return status;
}

static tides_status emit(walk *w, double s, int64_t t, int polarity, int cause, const td_slope *slope) {
    const td_pixel_step *p = w->pixel;
    tides_event event = {.t = t, .x = p->x, .y = p->y, .polarity = (int8_t)polarity, .cause = (uint8_t)cause};
    event.frontend = added_at(w, s);
    w->job->counts.cause[cause]++;
    tides_status status = td_pixel_emit(w->job, &event, &w->fired);
    return status == TIDES_OK ? keep_slope(w->job, slope) : status;
}

/* The reference becomes the signal at s. */
static void rereference(walk *w, double s) {
    seek_segment(w, s);
    w->initial = w->reference = s < 1 ? td_response_value(&w->pixel->response, s) + noise_at(w, s) : end_of(w);
    w->count_on = w->count_off = 0;
    *since(w) = time_at(w, s);
    td_pixel_note(w->job, s, w->reference, 0, 0);
}

/* Moves the reference by a threshold at s: for an event (`fired`), or for a crossing that is consumed. */
static void move_reference(walk *w, double s, int polarity, int fired) {
    if (polarity > 0)
        w->count_on++;
    else
        w->count_off++;
    w->reference = td_reference_at(w->on, w->off, w->initial, w->count_on, w->count_off);
    *since(w) = time_at(w, s);
    td_pixel_note(w->job, s, w->reference, polarity, fired);
}

static void begin_refractory(walk *w, double s) {
    double length = w->job->sensor->refractory_ns;
    if (length > 0) *held_until(w) = time_at(w, s) + length;
}

static int is_held(const walk *w, double s) { return *held_until(w) > time_at(w, s); }

/* The cause of a crossing: the leak, if its ramp made over half of the way from the last reference to the level. If `since` is
 * before the run (negative), the leak until the run's start counts neither as ramp nor as way. */
static int cause_of(const walk *w, double s, int polarity) {
    const double leak = w->job->sensor->leak[w->pixel->i], begun = fmax(-*since(w), 0);
    const double ramp = leak * (time_at(w, s) - fmax(*since(w), 0)), way = w->on - leak * begun;
    return polarity > 0 && ramp > 0.5 * way ? TIDES_CAUSE_LEAK : TIDES_CAUSE_SIGNAL;
}

/* A crossing at s fires at time t. */
static tides_status fire(walk *w, double s, int64_t t, int polarity, const td_slope *slope) {
    tides_status status = emit(w, s, t, polarity, cause_of(w, s, polarity), slope);
    if (status != TIDES_OK) return status;
    move_reference(w, s, polarity, 1);
    begin_refractory(w, s);
    return TIDES_OK;
}

/* -- noise --------------------------------------------------------------------------------------------------------------- */

/* Place of the next noise candidate, at or after the walk's s; `never` where there is none within the step. A candidate is an
 * event of shot noise or of a hot pixel, drawn at its rate in the dark. */
static const double never = 2;
static double next_noise(const walk *w, int *source) {
    const td_sensor *sensor = w->job->sensor;
    const td_step *step = w->job->step;
    double due;
    *source = td_shot_noise_next(&sensor->noise, w->pixel->i, &due);
    if (*source < 0 || !(due <= (double)(step->stop_ns - sensor->start.ns))) return never;
    double s = place_of(w, due - sensor->start.fraction);
    return s < w->s ? w->s : s > 1 ? 1 : s;
}

/* 1 if the candidate at s fires: the brighter the pixel, the fewer candidates of shot noise do. */
static int take_noise(const walk *w, int source, double s) {
    const td_pixel_step *p = w->pixel;
    uint32_t number = (uint32_t)p->y * (uint32_t)w->job->sensor->image_width + p->x;
    return td_shot_noise_take(&w->job->sensor->noise, source, p->i, number, td_model_value(&p->input, s),
                              w->job->sensor->log_eps);
}

static tides_status fire_noise(walk *w, int source, double s) {
    double due = w->job->sensor->noise.due[source][w->pixel->i];
    if (!take_noise(w, source, s)) return TIDES_OK;
    int polarity = source == TD_NOISE_SHOT_OFF ? -1 : 1, cause = source == TD_NOISE_HOT ? TIDES_CAUSE_HOT : TIDES_CAUSE_SHOT;
    const td_slope slope = free_of_light(polarity);
    tides_status status = emit(w, s, w->job->sensor->start.ns + (int64_t)due, polarity, cause, &slope);
    if (status != TIDES_OK) return status;
    rereference(w, s);
    begin_refractory(w, s);
    return TIDES_OK;
}

/* Drops the noise candidates before `until`; those that would have fired are added to `lost`. */
static void lose_noise(walk *w, double until, uint64_t *lost) {
    int source;
    double s;
    while ((s = next_noise(w, &source)) < fmin(until, never)) *lost += (uint64_t)take_noise(w, source, s);
}

/* -- held and masked parts of the step --------------------------------------------------------------------------------- */

/* Crossings before `until` move the reference without an event. */
static void consume(walk *w, double until) {
    double at = w->s, end = fmin(until, 1);
    for (int32_t n = 0; n < TD_EVENTS_PER_PIXEL_MAX;) {
        seek_segment(w, at);
        double stop = fmin(end, w->segment_until);
        int polarity = cross(w, at, stop, &at);
        if (polarity == 0 && stop < end) {
            at = stop; /* continues in the noise's next segment */
            continue;
        }
        if (polarity == 0 || at >= until) return;
        n++;
        move_reference(w, at, polarity, 0);
        w->job->counts.refractory++;
    }
}

/* Passes over the rest of the refractory period, or of the step. */
static void pass_held(walk *w) {
    double end = fmax(place_of(w, *held_until(w)), w->s);
    int law = w->job->sensor->sensor.refractory_law;
    lose_noise(w, end, &w->job->counts.refractory);
    if (law == TIDES_REFRACTORY_DROP_CONSUME) consume(w, end);
    if (end > 1) {
        w->s = 2;
        return;
    }
    if (law == TIDES_REFRACTORY_HOLD) rereference(w, end);
    *held_until(w) = -INFINITY;
    w->s = end;
}

static int is_masked(const walk *w) { return w->s < w->pixel->visible_from || w->s > w->pixel->visible_to; }

/* Passes over the part in which the pixel isn't visible, or the rest of the step. */
static void pass_masked(walk *w) {
    double end = w->s < w->pixel->visible_from ? w->pixel->visible_from : 2;
    lose_noise(w, end, &w->job->counts.suppressed);
    w->s = end;
}

/* -- the step -------------------------------------------------------------------------------------------------------------- */

/* 1: the comparator found the segment's noise quiet, and the reference is the one that it knew. */
static int is_quiet(const walk *w) {
    return w->segment.k < w->pixel->quiet_before && w->reference == w->job->sensor->pixels.reference[w->pixel->i];
}

/* Passes over segments of the noise that can't reach a level, up to `end`. Returns where the walk's segment ends, or `end` if
 * that is earlier. */
static double pass_quiet(walk *w, double end) {
    while (w->segment_until < end && (is_quiet(w) || stays_between(w, w->low, w->high))) {
        w->s = w->segment_until;
        seek_segment(w, w->s);
    }
    return fmin(end, w->segment_until);
}

/* Advances through a visible part of the step: to the first crossing or noise event, or to the part's end. */
static tides_status look(walk *w) {
    const td_pixel_step *p = w->pixel;
    td_pixel_job *job = w->job;
    int source;
    seek_segment(w, w->s);
    const double noise = next_noise(w, &source), last = fmin(p->visible_to, 1), end = fmin(noise, last);
    const double until = job->sensor->additive.on ? pass_quiet(w, end) : fmin(end, w->segment_until);
    double at = w->s;
    int polarity = w->cut ? 0 : cross(w, w->s, until, &at);
    if (polarity && w->crossed == job->sensor->sensor.max_events_per_step) {
        w->cut = 1;
        return TIDES_OK;
    }
    if (polarity) {
        if (at <= p->visible_from && at > 0) job->counts.suppressed++; /* the crossing was put off until here */
        const td_slope slope = slope_at(w, w->s, at, polarity);
        w->crossed++;
        w->s = at;
        return fire(w, at, td_step_time(job->step, at), polarity, &slope);
    }
    w->s = until;
    if (noise <= until) return fire_noise(w, source, noise);
    if (until < last) return TIDES_OK;          /* continues in the noise's next segment */
    w->s = until < 1 ? nextafter(until, 2) : 2; /* beyond the visible part, or the step */
    return TIDES_OK;
}

static tides_status follow(walk *w) {
    tides_status status = TIDES_OK;
    while (w->s <= 1 && status == TIDES_OK) {
        if (*held_until(w) > -INFINITY)
            pass_held(w);
        else if (is_masked(w))
            pass_masked(w);
        else
            status = look(w);
    }
    return status;
}

/* Fires at the step's end until the signal there is between the levels. These are crossings that the search in the response
 * missed, or that max_events_per_step cut off. A held or masked pixel fires none; with a refractory period, one at most. */
static tides_status catch_up(walk *w) {
    const td_pixel_step *p = w->pixel;
    uint64_t *late = w->cut ? &w->job->counts.truncated : &w->job->counts.caught_up;
    tides_status status = TIDES_OK;
    if (!(p->visible_from <= 1 && p->visible_to >= 1)) return TIDES_OK;
    seek_segment(w, 1);
    while (status == TIDES_OK && !is_held(w, 1)) {
        const double end = p->end + kick_at(w, 1);
        if (w->job->sensor->additive.on && stays_between(w, end, end)) return TIDES_OK;
        double residual = end_of(w) - w->reference;
        int polarity = residual >= w->on ? 1 : residual <= -w->off ? -1 : 0;
        if (polarity == 0) return TIDES_OK;
        status = fire(w, 1, w->job->step->stop_ns, polarity, &unknown_slope);
        ++*late;
    }
    return status;
}

tides_status td_pixel_advance(td_pixel_job *job, const td_pixel_step *pixel) {
    const td_sensor *sensor = job->sensor;
    const td_pixels *pixels = &sensor->pixels;
    walk w = {.job = job, .pixel = pixel, .initial = pixels->initial[pixel->i]};
    w.reference = pixels->reference[pixel->i];
    w.count_on = pixels->count_on[pixel->i];
    w.count_off = pixels->count_off[pixel->i];
    w.on = sensor->threshold_on[pixel->i];
    w.off = sensor->threshold_off[pixel->i];
    tides_status status = TIDES_OK;
    begin_segments(&w);
    int can_end = isfinite(pixel->end) && isfinite(w.reference);
    job->counts.solved++;
    if (can_end && td_model_is_finite(&pixel->response.cubic)) {
        status = follow(&w);
    } else { /* no crossings, and the step's noise candidates are dropped */
        uint64_t lost = 0;
        lose_noise(&w, 2, &lost);
        job->counts.nonfinite++;
    }
    if (status == TIDES_OK && can_end) status = catch_up(&w);
    end_segments(&w);
    pixels->initial[pixel->i] = w.initial;
    pixels->reference[pixel->i] = w.reference;
    pixels->count_on[pixel->i] = w.count_on;
    pixels->count_off[pixel->i] = w.count_off;
    td_sensor_set_wake(sensor, pixel->i);
    return status;
}
