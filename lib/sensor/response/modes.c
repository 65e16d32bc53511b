/* Modes of a response, one by one: values, slopes and bounds. */
#include "td_modes.h"
#include "td_extremes.h"
#include "td_math.h"
#include "td_tail.h"

#include <math.h>

static int terms_for(double size) { return size <= 0.03 ? 9 : size <= 0.25 ? 13 : TD_TAIL_TERMS; }

static double real_series(double z) { return td_tail_series(z, terms_for(fabs(z))); }

static td_complex series(td_complex z) {
    if (z.im == 0) return (td_complex){real_series(z.re), 0};
    const int terms = terms_for(fabs(z.re) + fabs(z.im));
    td_complex sum = {td_tail_term[terms - 1], 0};
    for (int k = terms - 2; k >= 0; k--) {
        sum = td_times(z, sum);
        sum.re += td_tail_term[k];
    }
    return sum;
}

void td_mode_tails(td_complex rate, double s, td_complex tail[5]) {
    td_complex z = td_scaled(rate, -s), sum = series(z);
    /* phi_k = 1 / k! + z phi_(k+1) */
    const double inverse_factorial[5] = {1, 1, 1.0 / 2, 1.0 / 6, 1.0 / 24}, power[5] = {1, s, s * s, s * s * s, s * s * s * s};
    td_complex phi = td_scaled(sum, inverse_factorial[4]);
    for (int k = 4; k >= 0; k--) {
        tail[k] = td_scaled(phi, power[k]);
        phi = td_times(z, phi);
        if (k > 0) phi.re += inverse_factorial[k - 1];
    }
}

/* Sums start at the last of all terms, but terms beyond a place's own count as 0, so that each sum is that of `series`. */
TD_WIDE static void sum_series(double re, double im, td_mode_places *at) {
    double z_re[TD_MODE_PLACES], z_im[TD_MODE_PLACES], last[TD_MODE_PLACES];
    double sum_re[TD_MODE_PLACES] = {0}, sum_im[TD_MODE_PLACES] = {0};
    for (int i = 0; i < TD_MODE_PLACES; i++) {
        z_re[i] = re * -at->s[i];
        z_im[i] = im * -at->s[i];
        const double size = fabs(z_re[i]) + fabs(z_im[i]), more = size <= 0.25 ? 13.0 : TD_TAIL_TERMS;
        last[i] = size <= 0.03 ? 9.0 : more;
    }
    for (int k = TD_TAIL_TERMS - 1; k >= 0; k--)
        for (int i = 0; i < TD_MODE_PLACES; i++) {
            const double product_re = z_re[i] * sum_re[i] - z_im[i] * sum_im[i];
            const double product_im = z_re[i] * sum_im[i] + z_im[i] * sum_re[i];
            sum_re[i] = product_re + (k < last[i] ? td_tail_term[k] : 0.0);
            sum_im[i] = product_im;
        }
    for (int i = 0; i < TD_MODE_PLACES; i++) {
        const double s = at->s[i], s3 = s * s * s, s4 = s * s * s * s;
        const double phi_re = sum_re[i] * (1.0 / 24), phi_im = sum_im[i] * (1.0 / 24);
        at->value_re[i] = phi_re * s4;
        at->value_im[i] = phi_im * s4;
        at->slope_re[i] = (z_re[i] * phi_re - z_im[i] * phi_im + 1.0 / 6) * s3;
        at->slope_im[i] = (z_re[i] * phi_im + z_im[i] * phi_re) * s3;
    }
}

/* tail[4] and tail[3] of a real rate: the complex operations without imaginary parts. */
static double real_tail(double rate, double s) { return real_series(rate * -s) * (1.0 / 24) * (s * s * s * s); }

static double real_tail_slope(double rate, double s) {
    const double z = rate * -s;
    return (z * (real_series(z) * (1.0 / 24)) + 1.0 / 6) * (s * s * s);
}

void td_mode_tails_many(td_complex rate, td_mode_places *at) {
    if (rate.im != 0) {
        sum_series(rate.re, rate.im, at);
        return;
    }
    for (int i = 0; i < TD_MODE_PLACES; i++) {
        at->value_re[i] = real_tail(rate.re, at->s[i]);
        at->slope_re[i] = real_tail_slope(rate.re, at->s[i]);
        at->value_im[i] = at->slope_im[i] = 0;
    }
}

static double real_part(const td_mode *mode, td_complex basis) { return mode->cosine * basis.re - mode->sine * basis.im; }

double td_mode_value(const td_mode *mode, double s) {
    td_complex rate = td_mode_rate(mode), tail[5];
    if (mode->frequency == 0) return mode->cosine * (mode->tail ? real_tail(rate.re, s) : td_exp(-rate.re * s));
    if (!mode->tail) return real_part(mode, td_decay(rate, s));
    td_mode_tails(rate, s, tail);
    return real_part(mode, tail[4]);
}

double td_mode_slope(const td_mode *mode, double s) {
    td_complex rate = td_mode_rate(mode), tail[5];
    if (mode->frequency == 0)
        return mode->cosine * (mode->tail ? real_tail_slope(rate.re, s) : -(rate.re * td_exp(-rate.re * s)));
    if (!mode->tail) return -real_part(mode, td_times(rate, td_decay(rate, s)));
    td_mode_tails(rate, s, tail);
    return real_part(mode, tail[3]);
}

/* A mode that doesn't swing is monotone. Others stay within their size; a tail's is at most 1 / 24. */
void td_mode_range(const td_mode *mode, double *low, double *high) {
    double begin = mode->tail ? 0 : mode->cosine, end;
    if (mode->frequency == 0) {
        end = td_mode_value(mode, 1);
    } else {
        end = td_hypot(mode->cosine, mode->sine) / (mode->tail ? 24 : 1);
        begin = -end;
    }
    *low = td_lesser(end, begin); /* the end may be NaN where the beginning isn't */
    *high = td_greater(end, begin);
}
