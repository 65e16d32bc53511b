/* v2e's two models of temporal noise: shot noise events, or photoreceptor noise before the comparator. */
#include "td_v2e.h"

#include "td_math.h"
#include "td_random.h"

#include <math.h>

/* v2e's shot noise factor: the share by which a pixel's noise rate falls from darkness to full intensity. */
#define SHOT_FALL 0.75
/* Number of threshold draws that v2e averages for its noise level. */
enum { LEVEL_DRAWS = 300 };

/* v2e's fit (a polynomial in log10): threshold over noise RMS at which `rate` events per second come, with corner frequency
 * `cutoff`. */
static double threshold_over_rms(double rate, double cutoff) {
    double x = td_ln(rate / cutoff / 2.0) * 0.43429448190325182765;
    return td_pow(10.0, -0.0026 * x * x * x - 0.036 * x * x - 0.1949 * x + 0.321);
}

/* Mean over pixels of the smaller of a pixel's thresholds. */
static double mean_threshold(const tides_baseline *b) {
    const tides_v2e *p = &b->params.v2e;
    if (!(p->sigma_thres > 0)) return fmin(p->pos_thres, p->neg_thres);
    double sum = 0;
    for (uint32_t k = 0; k < LEVEL_DRAWS; k++) {
        double normal[2];
        td_random_bits bits = td_random(b->params.seed, 0, k, TD_RANDOM_V2E_NOISE_LEVEL);
        td_random_normals(&bits, normal);
        sum += fmin(p->pos_thres + p->sigma_thres * normal[0], p->neg_thres + p->sigma_thres * normal[1]);
    }
    return fmax(0.0, sum / LEVEL_DRAWS);
}

void td_v2e_photoreceptor_noise(tides_baseline *b) {
    const tides_v2e *p = &b->params.v2e;
    td_v2e_state *s = b->state;
    const double two_pi = 2 * TD_PI;
    double length = b->now - b->before, part = fmin(1.0, length * two_pi * p->cutoff_hz);
    /* v2e, too, recomputes the level if the frame rate changes by 10 % */
    if (!(fabs(length - s->noise_frame_s) <= 0.1 * length)) {
        /* White noise of variance 1 leaves the low-pass with variance part / (2 - part). v2e measures that in one random run
         * of 1000 time constants: its level is off by 1.9 % (standard deviation), and its rate of noise by 18 %. */
        double rms = mean_threshold(b) / threshold_over_rms(p->shot_noise_rate_hz, p->cutoff_hz);
        s->noise_level = rms * sqrt((2.0 - part) / part);
        s->noise_frame_s = length;
    }
    for (size_t i = 0; i < b->pixels; i++) {
        double white = s->noise_level * td_baseline_normal(b, i, b->frames, TD_RANDOM_V2E_NOISE);
        s->noise[i] = (1.0 - part) * s->noise[i] + part * white;
    }
}

tides_status td_v2e_shot_noise(tides_baseline *b, const double *Y, tides_error *error) {
    const tides_v2e *p = &b->params.v2e;
    td_v2e_state *s = b->state;
    int64_t stop = td_baseline_ns(b->now);
    tides_status status = TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && i < b->pixels; i++) {
        double intensity = p->hdr ? 1.0 : fmin(1.0, (td_v2e_dn(p, Y[i]) + 20.0) / 275.0);
        double chance = 0.5 * p->shot_noise_rate_hz * (b->now - b->before) * (1.0 - SHOT_FALL * intensity);
        td_random_bits bits = td_random(b->params.seed, (uint32_t)i, b->frames, TD_RANDOM_V2E_SHOT);
        double u = td_random_uniform(&bits, 0);
        int on = u > 1.0 - chance * p->pos_thres / s->on[i], off = u < chance * p->neg_thres / s->off[i];
        if (!on && !off) continue;
        status = td_baseline_fire(b, i, stop, on ? 1 : -1, TIDES_CAUSE_SHOT, error);
        if (s->surround)
            s->reference[i] = (float)(s->level[i] - s->surround[i]);
        else
            s->reference[i] = (float)s->level[i];
    }
    return status;
}
