/* Modes of a path, and parts of its cubic. */
#include "td_path_parts.h"

#include <math.h>

static double between(double a, double b, double t) { return (1 - t) * a + t * b; }

/* The polar form of the cubic: its value where all three places are one. */
static double blossom(const double b[4], double x, double y, double z) {
    double one[3] = {between(b[0], b[1], x), between(b[1], b[2], x), between(b[2], b[3], x)};
    return between(between(one[0], one[1], y), between(one[1], one[2], y), z);
}

td_model td_model_part(const td_model *model, double from, double to) {
    const double *b = model->control;
    return (td_model){
        {blossom(b, from, from, from), blossom(b, from, from, to), blossom(b, from, to, to), blossom(b, to, to, to)}};
}

void td_mode_tails(td_complex rate, double s, td_complex tail[5]) {
    enum { TERMS = 16 }; /* 24 / 20! is 1e-17 */
    td_complex z = td_scaled(rate, -s), sum = {1, 0};
    for (int j = TERMS; j >= 1; j--) {
        sum = td_scaled(td_times(z, sum), 1.0 / (j + 4));
        sum.re += 1;
    }
    /* phi_k = 1 / k! + z phi_(k+1) */
    const double inverse_factorial[5] = {1, 1, 1.0 / 2, 1.0 / 6, 1.0 / 24}, power[5] = {1, s, s * s, s * s * s, s * s * s * s};
    td_complex phi = td_scaled(sum, inverse_factorial[4]);
    for (int k = 4; k >= 0; k--) {
        tail[k] = td_scaled(phi, power[k]);
        phi = td_times(z, phi);
        if (k > 0) phi.re += inverse_factorial[k - 1];
    }
}

static double real_part(const td_mode *mode, td_complex basis) { return mode->cosine * basis.re - mode->sine * basis.im; }

double td_mode_value(const td_mode *mode, double s) {
    td_complex rate = td_mode_rate(mode), tail[5];
    if (!mode->tail) return real_part(mode, td_decay(rate, s));
    td_mode_tails(rate, s, tail);
    return real_part(mode, tail[4]);
}

double td_mode_slope(const td_mode *mode, double s) {
    td_complex rate = td_mode_rate(mode), tail[5];
    if (!mode->tail) return -real_part(mode, td_times(rate, td_decay(rate, s)));
    td_mode_tails(rate, s, tail);
    return real_part(mode, tail[3]);
}

/* A mode that doesn't swing is monotone; else it stays within its size, which a tail's is 1 / 24 of at most. */
void td_mode_range(const td_mode *mode, double *low, double *high) {
    double size = hypot(mode->cosine, mode->sine), begin = mode->tail ? 0 : mode->cosine, end;
    if (mode->frequency == 0) {
        end = td_mode_value(mode, 1);
    } else {
        end = mode->tail ? size / 24 : size;
        begin = -end;
    }
    *low = fmin(begin, end);
    *high = fmax(begin, end);
}
