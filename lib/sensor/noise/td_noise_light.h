/* Internal: the size and the correlation time of additive noise in a pixel's light, where noise_law is PHOTOCURRENT.
 *
 * The photocurrent I = photocurrent_a Y + dark_current_a has white shot noise. That of ln I has the one-sided spectral density
 * 2 q F / I, with F = 2: in a real photoreceptor the transistor in weak inversion adds as much as the photodiode (Graca and
 * Delbruck, arXiv 2304.04019). Behind one pole of rate r it is the Ornstein-Uhlenbeck process of
 *
 *   sigma^2 = q F r / (2 I) + noise_rms^2,  tau = 1 / r
 *
 * where noise_rms doesn't depend on light. For a pole that goes with the photocurrent r / I is constant, so that sigma is the
 * same in any light, and noise is slower in the dark. Behind a fixed pole noise falls with light.
 *
 * Behind the circuit noise would be smoother. An Ornstein-Uhlenbeck process of the same variance and density at f = 0 fires
 * twice as often there (measured at levels 2 to 3 sigma away), so that the two can't be combined. */
#ifndef TD_NOISE_LIGHT_H
#define TD_NOISE_LIGHT_H

#include "sensor/response/td_frontend.h"

typedef struct td_noise_light {
    int on;
    double log_eps, photocurrent, dark; /* I = photocurrent (e^L - log_eps) + dark [A] */
    double fixed;                       /* noise_rms^2 */
    double rate, by_light, by_dark;     /* r = rate (by_light Y + by_dark) [1/s] */
} td_noise_light;

/* Makes the law of a sensor; off where it is CONSTANT. TIDES_BAD_ARGUMENT, or TIDES_UNSUPPORTED, naming the field. */
TIDES_MUST_CHECK tides_status td_noise_light_make(const tides_sensor *sensor, double log_eps, td_noise_light *light,
                                                  tides_error *error);

/* sigma [log units] and tau [ns] at log-luminance L, which is finite. */
void td_noise_light_at(const td_noise_light *light, double L, double *sigma, double *tau_ns);

#endif
