/* Converts light to a camera's values: electrons with noise, clipped at full scale, coded and rounded. Each value's noise
 * depends on (seed, pixel and plane, frame) only. */
#include "td_base.h"
#include "td_math.h"
#include "td_random.h"
#include "td_struct.h"
#include "tides/exposure.h"
#include "tides/frames.h"

#include <math.h>

/* [electrons] From this mean on, the number of electrons is drawn from the normal distribution with equal mean and variance,
 * rounded. This loses only Poisson's skewness, 1 / sqrt(mean): 1/10 or less. Below this mean the draw is exact. */
static const double normal_from = 100;

/* The smallest k at which Poisson's cumulative distribution reaches u, by summing from 0. */
static double poisson_at(double mean, double u) {
    double term = td_exp(-mean), sum = term, k = 0;
    while (sum < u && term > 0) { /* rounding may keep the sum below u for ever */
        k++;
        term *= mean / k;
        sum += term;
    }
    return k;
}

/* Electrons read from a value with the expectation `mean`, with shot and read noise. */
static double electrons(const tides_exposure *e, double mean, uint32_t pixel, uint64_t index) {
    const td_random_bits shot = td_random(e->seed, pixel, index, TD_RANDOM_FRAME_SHOT);
    double normal[2] = {0, 0}, count = mean;
    if (mean >= normal_from) {
        td_random_normals(&shot, normal);
        count = round(mean + sqrt(mean) * normal[0]);
    } else if (mean > 0) {
        count = poisson_at(mean, td_random_uniform(&shot, 0));
    }
    if (e->read_noise_e > 0) {
        const td_random_bits read = td_random(e->seed, pixel, index, TD_RANDOM_FRAME_READ);
        td_random_normals(&read, normal);
        count += e->read_noise_e * normal[0];
    }
    return count;
}

/* The sRGB curve (IEC 61966-2-1). */
static double to_srgb(double v) { return v <= 0.0031308 ? 12.92 * v : 1.055 * td_pow(v, 1 / 2.4) - 0.055; }

static uint16_t value_of(const tides_exposure *e, double light, uint32_t pixel, uint64_t index) {
    double v = light > 0 ? light * e->gain : 0;
    if (e->full_well_e > 0) v = electrons(e, v * e->full_well_e, pixel, index) / e->full_well_e;
    v = v > 0 ? v < 1 ? v : 1 : 0;
    if (e->transfer == TIDES_TRANSFER_SRGB)
        v = to_srgb(v);
    else if (e->gamma != 1)
        v = td_pow(v, 1 / e->gamma);
    return (uint16_t)(v * (e->bits == 16 ? 65535 : 255) + 0.5);
}

static tides_status check(const tides_exposure *e, tides_error *error) {
    if (e->bits != 8 && e->bits != 16)
        return td_fail(error, TIDES_BAD_ARGUMENT, "exposure.bits: %d must be 8 or 16", (int)e->bits);
    if (e->transfer != TIDES_TRANSFER_LINEAR && e->transfer != TIDES_TRANSFER_SRGB)
        return td_fail(error, TIDES_BAD_ARGUMENT, "exposure.transfer: %d is none of TIDES_TRANSFER_*", (int)e->transfer);
    if (!(e->gamma >= 0.1 && e->gamma <= 10))
        return td_fail(error, TIDES_BAD_ARGUMENT, "exposure.gamma: %g must lie in [0.1, 10]", e->gamma);
    if (e->transfer == TIDES_TRANSFER_SRGB && e->gamma != 1)
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "exposure.gamma: %g, and exposure.transfer is srgb, a curve of its own; leave gamma at 1, or take "
                       "linear",
                       e->gamma);
    if (!(e->gain > 0 && e->gain <= 1e9))
        return td_fail(error, TIDES_BAD_ARGUMENT, "exposure.gain: %g must lie in (0, 1e9]", e->gain);
    if (!(e->full_well_e >= 0 && e->full_well_e <= 1e9) || !(e->read_noise_e >= 0 && e->read_noise_e <= 1e9))
        return td_fail(error, TIDES_BAD_ARGUMENT, "exposure.full_well_e and read_noise_e: %g and %g must lie in [0, 1e9]",
                       e->full_well_e, e->read_noise_e);
    if (e->read_noise_e > 0 && !(e->full_well_e > 0))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "exposure.read_noise_e: %g electrons, but not of how many at full scale: set exposure.full_well_e",
                       e->read_noise_e);
    return TIDES_OK;
}

tides_status tides_exposure_values(const tides_exposure *exposure, int32_t width, int32_t height, size_t index,
                                   const double *light, uint16_t *values, tides_error *error) {
    if (!exposure || !light || !values || width < 1 || height < 1)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_exposure_values: exposure, size, light and values must be given");
    tides_exposure own;
    tides_exposure_defaults(&own);
    tides_status status = TD_TAKE_STRUCT(tides_exposure, &own, exposure, error);
    if (status == TIDES_OK) status = check(&own, error);
    if (status != TIDES_OK) return status;
    const size_t pixels = (size_t)width * (size_t)height, planes = (size_t)tides_exposure_planes(&own);
    for (size_t i = 0; i < pixels; i++)
        for (size_t c = 0; c < planes; c++)
            values[i * planes + c] = value_of(&own, light[c * pixels + i], (uint32_t)(i * planes + c), index);
    return TIDES_OK;
}
