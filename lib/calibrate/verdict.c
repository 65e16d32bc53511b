/* Judges a calibration: its faults, and which of its values are known. */
#include "td_calibrate.h"

#include "td_math.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FEW_PAIRS = 300, FEW_OF_ONE = 50, TILE = 8 };
#define AGREES 0.85   /* share of changes with their event's sign; below, the light isn't the recording's */
#define DEVIATES 0.45 /* mean deviation that unrelated changes would have */
#define ALIKE 0.4     /* correlation of where light moves and where events are */
#define DEAD 0.2      /* share of dead pixels among those that should fire */
#define LATE_S 3e-3   /* [s] a greater offset is the clocks', not the pixels' delay */
#define FAR_APART 0.2 /* relative difference of halves that is too large */
/* Least relative errors: light is taken to be straight between samples. */
#define LEAST_SHARE 0.003
#define LEAST_EPS 2e-4
#define LEAST_S 3e-5
#define SHORT_S 3e-4 /* [s] poles below, beyond 530 Hz, can't be told from none */
#define MOVES 0.15   /* log units by which a pixel's light moves where something happens */
#define REVERSAL 0.1 /* relative excess of changes after the other polarity */

/* -- where light moves and where events are -------------------------------------------------------------------------------- */

typedef struct activity {
    double *light, *events; /* light's movement and events, by tiles of TILE px */
    int32_t width, height;
} activity;

static tides_status look(const td_calibration *c, activity *a, double *moving, tides_error *error) {
    const td_taken *t = &c->taken;
    size_t moved = 0;
    a->width = (t->width + TILE - 1) / TILE;
    a->height = (t->height + TILE - 1) / TILE;
    a->light = td_alloc((size_t)a->width * (size_t)a->height, sizeof *a->light, error);
    a->events = td_alloc((size_t)a->width * (size_t)a->height, sizeof *a->events, error);
    if (!a->light || !a->events) return TIDES_NO_MEMORY;
    for (int32_t y = 0; y < t->height; y++) {
        for (int32_t x = 0; x < t->width; x++) {
            const size_t p = (size_t)y * (size_t)t->width + (size_t)x,
                         tile = (size_t)(y / TILE) * (size_t)a->width + (size_t)(x / TILE);
            const double range = td_ln((c->light.highest[p] + 0.02) / (c->light.lowest[p] + 0.02));
            if (range == range && range > 0) a->light[tile] += range;
            moved += range > MOVES;
            a->events[tile] += td_ln(1 + (double)(t->first[p + 1] - t->first[p]));
        }
    }
    *moving = (double)moved / ((double)t->width * (double)t->height);
    return TIDES_OK;
}

/* Correlation of light's movement and events, with the light mirrored by `flip` (1: left and right, 2: up and down). */
static double correlation(const activity *a, int32_t flip) {
    double n = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
    for (int32_t v = 0; v < a->height; v++) {
        for (int32_t u = 0; u < a->width; u++) {
            const int32_t mu = flip & 1 ? a->width - 1 - u : u, mv = flip & 2 ? a->height - 1 - v : v;
            const double l = a->light[mv * a->width + mu], e = a->events[v * a->width + u];
            n++;
            x += l;
            y += e;
            xx += l * l;
            yy += e * e;
            xy += l * e;
        }
    }
    const double both = sqrt((xx - x * x / n) * (yy - y * y / n));
    return both > 0 ? (xy - x * y / n) / both : 0;
}

/* -- refusals -------------------------------------------------------------------------------------------------------------- */

static tides_status refuse(tides_calibration *found, tides_error *error, const char *why) {
    found->refused = 1;
    return td_note(&found->notes, error, "%s", why);
}

/* 1 where polarities are exchanged, by the signs of changes before any fit. */
static int32_t is_exchanged(td_calibration *c) {
    const td_front plain = {.log_eps = 0.02, .pole_s = 2e-3};
    td_fit fit;
    td_try(&c->light, &c->pairs, &plain, NULL, &fit);
    return fit.agreement < 1 - AGREES;
}

/* Notes why a recording may not match the light: mirrored, polarities exchanged, another clock, another scene. */
static tides_status why_unlike(td_calibration *c, const activity *a, char **notes, tides_error *error) {
    static const char *const mirrored[] = {"", "left and right", "up and down", "both ways"};
    const double as_is = correlation(a, 0);
    int32_t best = 0;
    for (int32_t flip = 1; flip < 4; flip++)
        if (correlation(a, flip) > correlation(a, best)) best = flip;
    if (is_exchanged(c))
        return td_note(notes, error, "ON and OFF look exchanged: light moves the other way at nearly every event");
    if (correlation(a, best) > fmax(as_is + 0.1, ALIKE))
        return td_note(notes, error,
                       "the recording looks mirrored (%s): events are where the mirrored light moves (%.2f, as it is %.2f)",
                       mirrored[best], correlation(a, best), as_is);
    if (as_is > ALIKE)
        return td_note(notes, error,
                       "events are where light moves (%.2f), but their polarities or times aren't its own: another clock by "
                       "more than 60 ms, polarities that are lost, or another scene with edges in the same places",
                       as_is);
    return td_note(notes, error, "events aren't where light moves (%.2f): another scene, path, lens or stretch of time", as_is);
}

/* Notes changes that have the events' signs but are too large or too small. */
static tides_status too_coarse(const td_calibration *c, tides_calibration *found, tides_error *error) {
    const double every = c->light.samples > 1 ? (c->light.time[c->light.samples - 1] - c->light.time[0]) * c->light.finer /
                                                    (double)(c->light.samples - 1)
                                              : 0;
    found->refused = 1;
    if (c->facts.frames)
        return td_note(&found->notes, error,
                       "changes of light differ by %.0f %%: frames that are %.3g ms apart don't say what light did between "
                       "them: "
                       "faster ones would, or a scene that was trained on them, with the camera's path",
                       100 * found->deviation, 1e3 * every);
    return td_note(&found->notes, error,
                   "changes of light have the events' signs, and differ by %.0f %%: the scene's light isn't the recording's, "
                   "as where "
                   "its colours are coded otherwise (image.transfer), or it is blurred",
                   100 * found->deviation);
}

static tides_status unlike(td_calibration *c, const activity *a, tides_calibration *found, tides_error *error) {
    if (found->agreement >= AGREES && !is_exchanged(c)) return too_coarse(c, found, error);
    found->refused = 1;
    const tides_status status =
        td_note(&found->notes, error,
                "%.0f %% of the changes of light go the way that their event says, and they differ by %.0f %%: "
                "light and recording don't belong together",
                100 * found->agreement, 100 * found->deviation);
    return status == TIDES_OK ? why_unlike(c, a, &found->notes, error) : status;
}

static tides_status judge(td_calibration *c, tides_calibration *found, tides_error *error) {
    activity a = {0};
    double moving = 0;
    uint64_t on = found->transition_pairs[0] + found->transition_pairs[1],
             off = found->transition_pairs[2] + found->transition_pairs[3];
    char text[256];
    tides_status status = look(c, &a, &moving, error);
    snprintf(text, sizeof text,
             "only %llu pairs of events (%llu end ON, %llu OFF) have known light: a longer stretch, or more motion, would do",
             (unsigned long long)found->pairs, (unsigned long long)on, (unsigned long long)off);
    if (status != TIDES_OK)
        ;
    else if (moving < 0.002)
        status = refuse(found, error,
                        "nothing moves in the light: a recording of motion says thresholds, a still one only noise (--static)");
    else if (found->pairs < FEW_PAIRS || on < FEW_OF_ONE || off < FEW_OF_ONE)
        status = refuse(found, error, text);
    else if (found->agreement < AGREES || found->deviation > DEVIATES)
        status = unlike(c, &a, found, error);
    free(a.light);
    free(a.events);
    return status;
}

/* -- what is to be said ---------------------------------------------------------------------------------------------------- */

static tides_status say_clocks(const td_calibration *c, tides_calibration *found, tides_error *error) {
    if (fabs(c->offset_s) < LATE_S) return TIDES_OK;
    return td_note(&found->notes, error,
                   "events are %.4g ms %s than their light: another clock; values are with that taken off (--offset %.6g)",
                   1e3 * fabs(c->offset_s), c->offset_s > 0 ? "later" : "earlier", -c->offset_s);
}

static tides_status say_pixels(const tides_calibration *found, char **notes, tides_error *error) {
    tides_status status = TIDES_OK;
    if (found->dead_share > DEAD)
        status = td_note(notes, error,
                         "%.0f %% of the pixels whose light moves by three thresholds have no event: dead, masked, or cut out",
                         100 * found->dead_share);
    if (status == TIDES_OK && found->hot_count)
        status = td_note(notes, error, "%d pixels fire far more often than their light says", found->hot_count);
    if (status == TIDES_OK && found->bursts)
        status = td_note(notes, error, "%d bursts of frames' readout were cut, %llu events", found->bursts,
                         (unsigned long long)found->burst_events);
    return status;
}

static tides_status say_reversals(const tides_calibration *found, char **notes, tides_error *error) {
    const double on = found->transitions[1] / found->transitions[0] - 1,
                 off = found->transitions[3] / found->transitions[2] - 1;
    if (!(fabs(on) > REVERSAL || fabs(off) > REVERSAL)) return TIDES_OK;
    return td_note(notes, error,
                   "changes after an event of the other polarity differ by %.0f %% (ON) and %.0f %% (OFF): no preset says that",
                   100 * on, 100 * off);
}

/* -- values ---------------------------------------------------------------------------------------------------------------- */

/* Half the difference of two halves' values; 0 where one isn't known. In settle_value, a value below `none` can't be told from
 * none; for 0 every value can. */
static double half_difference(double a, double b) { return a == a && b == b ? 0.5 * fabs(a - b) : 0; }

static void settle_value(tides_calibrated *v, double none, double least) {
    if (v->state == TIDES_CALIBRATED_GIVEN) return;
    if (!(v->value == v->value)) {
        v->state = TIDES_CALIBRATED_UNKNOWN;
        return;
    }
    const double apart = fmax(half_difference(v->early, v->late), half_difference(v->left, v->right));
    v->error = fmax(fmax(v->error, apart), least);
    v->state = none > 0 && v->value < fmax(2 * v->error, none) ? TIDES_CALIBRATED_BOUND
               : 2 * apart > FAR_APART * fabs(v->value)        ? TIDES_CALIBRATED_UNCERTAIN
                                                               : TIDES_CALIBRATED_MEASURED;
}

static tides_status say_uncertain(const tides_calibration *found, char **notes, tides_error *error) {
    tides_status status = TIDES_OK;
    for (int32_t i = 0; i < TIDES_CALIBRATED_VALUES && status == TIDES_OK; i++) {
        const tides_calibrated *v = &found->values[i];
        tides_calibrated_row row;
        if (!tides_calibrated_at(i, &row)) break;
        if (v->state == TIDES_CALIBRATED_UNCERTAIN)
            status = td_note(notes, error, "%s is uncertain: halves of the time say %.4g and %.4g, of the image %.4g and %.4g",
                             row.name, v->early, v->late, v->left, v->right);
    }
    return status;
}

tides_status td_verdict(td_calibration *c, tides_calibration *found, tides_error *error) {
    tides_calibrated *v = found->values;
    settle_value(&v[TIDES_CALIBRATED_ON], 0, LEAST_SHARE * c->fit.on);
    settle_value(&v[TIDES_CALIBRATED_OFF], 0, LEAST_SHARE * c->fit.off);
    settle_value(&v[TIDES_CALIBRATED_EPS], 1e-4, LEAST_EPS + LEAST_SHARE * c->fit.front.log_eps);
    settle_value(&v[TIDES_CALIBRATED_POLE], SHORT_S, 3 * LEAST_S + LEAST_SHARE * c->fit.front.pole_s);
    settle_value(&v[TIDES_CALIBRATED_REFRACTORY], 5e-5, LEAST_S);
    settle_value(&v[TIDES_CALIBRATED_OFFSET], LATE_S, LEAST_S);
    tides_status status = judge(c, found, error);
    if (status == TIDES_OK && !found->refused) status = say_clocks(c, found, error);
    if (status == TIDES_OK && !found->refused) status = say_pixels(found, &found->notes, error);
    if (status == TIDES_OK && !found->refused) status = say_reversals(found, &found->notes, error);
    if (status == TIDES_OK && !found->refused) status = say_uncertain(found, &found->notes, error);
    if (status == TIDES_OK && !found->notes) found->notes = td_strdup("", error);
    return status == TIDES_OK && !found->notes ? TIDES_NO_MEMORY : status;
}
