/* ESIM (Rebecq, Gehrig, Scaramuzza, CoRL 2018), as rpg_esim implements it: straight lines of log luminance between frames. A
 * pixel has one polarity per interval, and a crossing counts only within its interval. */
#include "td_baseline.h"

#include "td_math.h"
#include "td_random.h"

#include <math.h>
#include <stdlib.h>

/* rpg_esim's constants [log units]: the change of L up to which a pixel is skipped, and the least randomly drawn threshold. */
#define LEAST_CHANGE 1e-6
#define LEAST_THRESHOLD 0.01

typedef struct esim_state {
    double *reference, *last; /* [log units] (pixels) */
    int64_t *fired;           /* (pixels) time of the last event [ns]; 0: none yet */
} esim_state;

static void destroy(void *state) {
    esim_state *s = state;
    free(s->reference);
    free(s->last);
    free(s->fired);
    free(s);
}

static tides_status check(const tides_baseline *b, tides_error *error) {
    const tides_esim *p = &b->params.esim;
    const struct {
        const char *name;
        double value, lower, upper;
    } rows[] = {{"contrast_threshold_pos", p->contrast_threshold_pos, 1e-4, 100},
                {"contrast_threshold_neg", p->contrast_threshold_neg, 1e-4, 100},
                {"contrast_threshold_sigma_pos", p->contrast_threshold_sigma_pos, 0, 100},
                {"contrast_threshold_sigma_neg", p->contrast_threshold_sigma_neg, 0, 100},
                {"refractory_period_ns", p->refractory_period_ns, 0, 1e12},
                {"log_eps", p->log_eps, 1e-9, 1e6},
                {"adaptive_sampling_lambda", p->adaptive_sampling_lambda, 1e-6, 1e6},
                {"minimum_framerate", p->minimum_framerate, 1e-6, 1e9}};
    tides_status status = TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && i < sizeof rows / sizeof rows[0]; i++)
        status = td_baseline_range(b, rows[i].name, rows[i].value, rows[i].lower, rows[i].upper, error);
    return status;
}

static tides_status create(tides_baseline *b, tides_error *error) {
    tides_status status = check(b, error);
    esim_state *s = status == TIDES_OK ? td_alloc(1, sizeof *s, error) : NULL;
    if (!s) return status == TIDES_OK ? TIDES_NO_MEMORY : status;
    b->state = s;
    s->reference = td_alloc(b->pixels, sizeof *s->reference, error);
    s->last = td_alloc(b->pixels, sizeof *s->last, error);
    s->fired = td_alloc(b->pixels, sizeof *s->fired, error);
    return s->reference && s->last && s->fired ? TIDES_OK : TIDES_NO_MEMORY;
}

static double signal(const tides_esim *p, double Y) { return p->use_log_image ? td_ln(p->log_eps + Y) : Y; }

static tides_status first(tides_baseline *b, const double *Y, tides_error *error) {
    (void)error;
    esim_state *s = b->state;
    for (size_t i = 0; i < b->pixels; i++) s->reference[i] = s->last[i] = signal(&b->params.esim, Y[i]);
    return TIDES_OK;
}

/* The threshold of this pixel in this interval. */
static double threshold(const tides_baseline *b, size_t i, int polarity) {
    const tides_esim *p = &b->params.esim;
    double mean = polarity > 0 ? p->contrast_threshold_pos : p->contrast_threshold_neg;
    double sigma = polarity > 0 ? p->contrast_threshold_sigma_pos : p->contrast_threshold_sigma_neg;
    if (!(sigma > 0)) return mean;
    return fmax(LEAST_THRESHOLD, mean + sigma * td_baseline_normal(b, i, b->frames, TD_RANDOM_ESIM_THRESHOLD));
}

/* Fires an event, or drops it in the refractory period. The caller has moved the reference in both cases. */
static tides_status fire(tides_baseline *b, size_t i, int64_t t, int polarity, tides_error *error) {
    esim_state *s = b->state;
    if (s->fired[i] != 0 && (double)(t - s->fired[i]) < b->params.esim.refractory_period_ns) return TIDES_OK;
    s->fired[i] = t;
    return td_baseline_fire(b, i, t, polarity, TIDES_CAUSE_SIGNAL, error);
}

static tides_status step_pixel(tides_baseline *b, size_t i, double L, int64_t start_ns, double length_ns, tides_error *error) {
    esim_state *s = b->state;
    double from = s->last[i];
    s->last[i] = L;
    if (!(fabs(from - L) > LEAST_CHANGE)) return TIDES_OK;
    int polarity = L >= from ? 1 : -1;
    double C = polarity * threshold(b, i, polarity);
    for (;;) {
        double level = s->reference[i] + C;
        int within = polarity > 0 ? level > from && level <= L : level < from && level >= L;
        if (!within) return TIDES_OK;
        int64_t t = start_ns + (int64_t)((level - from) * length_ns / (L - from));
        s->reference[i] = level;
        tides_status status = fire(b, i, t, polarity, error);
        if (status != TIDES_OK) return status;
    }
}

static tides_status step(tides_baseline *b, const double *Y, tides_error *error) {
    int64_t start_ns = td_baseline_ns(b->before);
    double length_ns = (double)(td_baseline_ns(b->now) - start_ns);
    tides_status status = TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && i < b->pixels; i++)
        status = step_pixel(b, i, signal(&b->params.esim, Y[i]), start_ns, length_ns, error);
    return status;
}

const td_method td_esim = {"esim", create, first, step, NULL, destroy, 0.0, 0};

double tides_esim_next_time(const tides_esim *esim, double time, double fastest) {
    double longest = 1.0 / esim->minimum_framerate, wanted = esim->adaptive_sampling_lambda / fastest;
    return time + (wanted < longest ? wanted : longest); /* if nothing changes, `wanted` is infinite */
}
