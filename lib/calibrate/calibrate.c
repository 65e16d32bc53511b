/* Measures a sensor from its recording. The steps:
 *
 *   recording.c, bursts.c   read the events of the stretch (the part of the recording that is used), sort them by pixel, and
 *                           mark the bursts that a DAVIS makes while it reads out a frame
 *   light.c                 samples the luminance Y of pixels that have two events or more. A scene is rendered at such short
 *                           steps that ln(Y) is nearly straight between them
 *   between.c               interpolates frames by cubics in ln(Y)
 *   pairs.c, changes.c      pair successive events of a pixel, and compute the change of the low-passed ln(Y + black level)
 *                           from one to the other
 *   fit.c                   searches the front end (black level, pole, clock offset, refractory period) with which the changes
 *                           before ON events are most nearly equal, and those before OFF events; their medians are the
 *                           thresholds
 *   spread.c                measures the spread of thresholds over the pixels, and the changes by polarity of both events
 *                           (ON after ON, ON after OFF ...); finds hot and dead pixels
 *   noise.c                 measures leak and shot noise of pixels at rest
 *   correct.c               measures simulations of the values found in the same way, and removes the mean deviation of their
 *                           values; first.c tells it where the pixels' references stood when the stretch began
 *   part.c, scatter.c, doubt.c  compute error bars
 *   verdict.c               decides which values can't be trusted, and says why */
#include "td_calibrate.h"

#include "td_struct.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* -- the steps ------------------------------------------------------------------------------------------------------------- */

static void note_fit(td_calibration *c, tides_calibration *found) {
    const double raw[TIDES_CALIBRATED_VALUES] = {
        [TIDES_CALIBRATED_ON] = c->raw.on,
        [TIDES_CALIBRATED_OFF] = c->raw.off,
        [TIDES_CALIBRATED_EPS] = c->raw.front.log_eps,
        [TIDES_CALIBRATED_POLE] = c->raw.front.pole_s,
        [TIDES_CALIBRATED_REFRACTORY] = c->raw.front.refractory_s,
        [TIDES_CALIBRATED_OFFSET] = c->offset_s,
    };
    const double fitted[TIDES_CALIBRATED_VALUES] = {
        [TIDES_CALIBRATED_ON] = c->fit.on,
        [TIDES_CALIBRATED_OFF] = c->fit.off,
        [TIDES_CALIBRATED_EPS] = c->fit.front.log_eps,
        [TIDES_CALIBRATED_POLE] = c->fit.front.pole_s,
        [TIDES_CALIBRATED_REFRACTORY] = c->fit.front.refractory_s,
        [TIDES_CALIBRATED_OFFSET] = c->offset_s,
    };
    for (int32_t i = 0; i < TIDES_CALIBRATED_VALUES; i++) {
        tides_calibrated *v = &found->values[i];
        const int32_t others = i == TIDES_CALIBRATED_SIGMA || i == TIDES_CALIBRATED_LEAK || i == TIDES_CALIBRATED_SHOT;
        v->early = v->late = v->left = v->right = NAN;
        if (!others) v->value = fitted[i];
        if (!others) v->raw = raw[i];
        if (!(c->options->given[i] == c->options->given[i])) continue;
        v->value = v->raw = c->options->given[i];
        v->state = TIDES_CALIBRATED_GIVEN;
    }
    found->law = c->fit.front.law;
}

static void note_counts(const td_calibration *c, tides_calibration *found) {
    found->deviation = c->raw.deviation;
    found->agreement = c->raw.agreement;
    found->pairs = c->raw.pairs;
    found->start_ns = c->taken.start_ns;
    found->stop_ns = c->taken.stop_ns;
    found->events = c->taken.count;
    found->burst_events = c->taken.in_bursts;
    found->bursts = c->taken.bursts;
    found->pixels = c->light.count;
    found->samples = (int32_t)((c->light.samples - 1) / (size_t)c->light.finer + 1);
}

/* 1 if the fit is good enough for the bias correction and the error bars: both thresholds are above 0.005 log units, and more
 * than 70 % of the changes have the sign of their event. */
static int32_t is_sound(const td_calibration *c) { return c->fit.on > 0.005 && c->fit.off > 0.005 && c->fit.agreement > 0.7; }

static tides_status work(const char *recording, tides_session *session, td_calibration *c, tides_calibration *found,
                         tides_error *error) {
    double start, stop;
    td_light_span(&c->facts, &start, &stop);
    tides_status status = td_taken_read(recording, c, start, stop, error);
    if (status == TIDES_OK) status = td_light_sample(c, session, error);
    if (status == TIDES_OK) status = td_pairs_make(&c->taken, &c->light, &c->pairs, error);
    if (status != TIDES_OK) return status;
    c->longest_refractory_s = td_shortest_interval(&c->pairs);
    status = td_search(c, error);
    c->raw = c->fit;
    if (status == TIDES_OK) status = td_spread(c, found, error);
    if (status == TIDES_OK) status = td_noise(c, found, error);
    if (status == TIDES_OK && is_sound(c)) status = td_correct(c, found, error);
    if (status != TIDES_OK) return status;
    note_fit(c, found);
    note_counts(c, found);
    if (is_sound(c)) status = td_doubt(c, found, error);
    return status == TIDES_OK ? td_verdict(c, found, error) : status;
}

static tides_status check(const char *recording, const tides_session *session, const tides_calibrate_options *o,
                          tides_error *error) {
    if (!recording || !session) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_calibrate: recording or session is NULL");
    if (o->stop_ns <= o->start_ns) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_calibrate: stop_ns must be above start_ns");
    if (o->given[TIDES_CALIBRATED_ON] == o->given[TIDES_CALIBRATED_ON] ||
        o->given[TIDES_CALIBRATED_OFF] == o->given[TIDES_CALIBRATED_OFF])
        return td_fail(error, TIDES_BAD_ARGUMENT, "threshold_on and threshold_off can't be given, because they are measured");
    tides_calibrated_row row;
    for (int32_t i = 0; tides_calibrated_at(i, &row); i++)
        if (isinf(o->given[i]) || (i != TIDES_CALIBRATED_OFFSET && o->given[i] < 0))
            return td_fail(error, TIDES_BAD_ARGUMENT, "the given %s is %g; it must be finite%s", row.name, o->given[i],
                           i == TIDES_CALIBRATED_OFFSET ? "" : " and not negative");
    return TIDES_OK;
}

tides_status tides_calibrate(const char *recording, tides_session *session, const tides_calibrate_options *options,
                             tides_progress progress, void *user, tides_calibration *found, tides_error *error) {
    tides_calibrate_options own;
    td_calibration c = {.options = &own, .progress = progress, .user = user};
    tides_calibration made;
    tides_calibrate_options_defaults(&own);
    if (!options) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_calibrate: options is NULL");
    tides_status status = TD_TAKE_STRUCT(tides_calibrate_options, &own, options, error);
    if (status == TIDES_OK) status = check(recording, session, &own, error);
    if (status != TIDES_OK) return status;
    memset(&made, 0, sizeof made);
    tides_session_get(session, &c.facts);
    status = work(recording, session, &c, &made, error);
    td_taken_free(&c.taken);
    td_light_free(&c.light);
    td_pairs_free(&c.pairs);
    if (status == TIDES_OK)
        *found = made;
    else
        tides_calibration_free(&made);
    return status;
}

void tides_calibration_free(tides_calibration *found) {
    if (!found) return;
    free(found->map);
    free(found->rate_s);
    free(found->rate);
    free(found->rate_simulated);
    free(found->notes);
    found->map = found->rate_s = found->rate = found->rate_simulated = NULL;
    found->notes = NULL;
}
