/* Internal: modes one by one, which response.c, modes.c and mode_crossing.c share. */
#ifndef TD_MODES_H
#define TD_MODES_H

#include "td_complex.h"
#include "td_response.h"

static inline td_complex td_mode_rate(const td_mode *mode) { return (td_complex){mode->rate, mode->frequency}; }

/* tail[k] = s^k phi_k(-rate s), k = 0 to 4, where phi_k(z) = sum over j of z^j / (j + k)!; the derivative of each is the one
 * before it. |rate s| <= 1. */
void td_mode_tails(td_complex rate, double s, td_complex tail[5]);

/* tail[4] and tail[3] for TD_MODE_PLACES values of s side by side, to the bit. */
enum { TD_MODE_PLACES = 8 };
typedef struct td_mode_places {
    double s[TD_MODE_PLACES];
    double value_re[TD_MODE_PLACES], value_im[TD_MODE_PLACES]; /* tail[4] */
    double slope_re[TD_MODE_PLACES], slope_im[TD_MODE_PLACES]; /* tail[3] */
} td_mode_places;
void td_mode_tails_many(td_complex rate, td_mode_places *places);

double td_mode_value(const td_mode *mode, double s);
double td_mode_slope(const td_mode *mode, double s);

/* Bounds on [0, 1]. */
void td_mode_range(const td_mode *mode, double *low, double *high);

/* td_response_crossing where there is no source, on a response that is finite. */
int td_modes_crossing(const td_response *response, double reference, double threshold_on, double threshold_off, double from,
                      double to, double *s);

#endif
