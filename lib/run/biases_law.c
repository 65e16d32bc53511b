/* Converts bias currents to units of a pixel, by the formulas of jAER's DavisConfig and DVS128 (SensorsINI/jaer @a1db449):
 *
 *   theta_on|off = (kappa_n / kappa_p^2) / (C1 / C2) ln(I_on|off / I_diff), kappa 0.7, C1 / C2 = 20
 *   T_refr       = 20 fF 0.8 V / I_refr (DAVIS), 32 fF 2.6 V / (0.545 I_refr) (DVS128)
 *   f3dB         = I_sf / (2 pi 25 mV C), C 131.17 fF (DAVIS), 467 fF (DVS128), where I_sf < I_pr / 2
 *
 * The formulas don't depend on light: if the photoreceptor is slower than the source follower, there is no formula. */
#include "td_biases.h"

#include "td_math.h"

#include <math.h>

static const double two_pi = 6.28318530717958647692, thermal_v = 0.025, per_ln = 1 / (0.7 * 20);

static double current(const td_biases *biases, const char *name) {
    const td_bias *bias = td_biases_find(biases, name);
    return bias ? bias->current_a : 0;
}

td_bias_units td_biases_units(const td_biases *biases) {
    static const char *const names[2][6] = {{"DiffBn", "OnBn", "OffBn", "PrBp", "PrSFBp", "RefrBp"},
                                            {"diff", "diffOn", "diffOff", "Pr", "foll", "refr"}};
    td_bias_units units = {0, 0, 0, 0, 0, 0};
    if (biases->kind != TD_BIASES_DAVIS && biases->kind != TD_BIASES_DVS128) return units;
    const int davis = biases->kind == TD_BIASES_DAVIS;
    const char *const *name = names[!davis];
    const double diff = current(biases, name[0]), on = current(biases, name[1]), off = current(biases, name[2]);
    const double pr = current(biases, name[3]), sf = current(biases, name[4]), refr = current(biases, name[5]);
    const td_bias *off_bias = td_biases_find(biases, name[2]);
    if (diff > 0 && on > diff) units.threshold_on = per_ln * td_ln(on / diff);
    if (diff > 0 && off > 0 && off < diff) units.threshold_off = per_ln * td_ln(diff / off);
    units.off = off_bias && off_bias->value == 0;
    if (refr > 0) units.refractory_s = davis ? 20e-15 * 0.8 / refr : 32e-15 * 2.6 / (0.545 * refr);
    units.limited = pr > 0 && sf >= 0.5 * pr;
    if (sf > 0 && pr > 0 && !units.limited) units.cutoff_hz = sf / (two_pi * thermal_v * (davis ? 131.17e-15 : 467e-15));
    return units;
}
