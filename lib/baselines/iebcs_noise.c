/* IEBCS's noise events: strictly periodic with a random phase, or with periods drawn from measured histograms, one per
 * pixel. */
#include "td_iebcs.h"

#include "archive/td_npy.h"
#include "td_random.h"
#include "td_math.h"

#include <math.h>
#include <stdlib.h>

void td_iebcs_noise_free(td_iebcs_noise *noise) {
    free(noise->next);
    free(noise->chance);
    free(noise->draws);
}

/* The rate of a bin [Hz]: 1 to 9 times 10^-3 in the first nine bins, then those times 10^-2, and so on. */
static double bin_rate(int bin) {
    int decade = bin / 9 - 3;
    return (bin % 9 + 1) * td_pow(10.0, decade);
}

/* Converts counts to cumulative probabilities, row by row. A row without counts stays 0: a pixel without noise. */
static tides_status accumulate(const char *file, const td_npy_array *array, td_iebcs_noise *noise, tides_error *error) {
    for (size_t row = 0; row < noise->rows; row++) {
        double sum = 0, *chance = noise->chance + row * TD_IEBCS_BINS;
        for (size_t bin = 0; bin < TD_IEBCS_BINS; bin++) {
            double count = -1;
            if (!td_npy_number(array, td_npy_find_field(array, ""), row * TD_IEBCS_BINS + bin, &count) || !(count >= 0) ||
                isinf(count))
                return td_fail(error, TIDES_BAD_FILE, "%s: row %zu, bin %zu isn't a count", file, row, bin);
            chance[bin] = sum += count;
        }
        for (size_t bin = 0; sum > 0 && bin < TD_IEBCS_BINS; bin++) chance[bin] /= sum;
    }
    return TIDES_OK;
}

static tides_status load(const char *file, td_iebcs_noise *noise, tides_error *error) {
    td_npz *npz = NULL;
    const td_npy_array *array = NULL;
    tides_status status = td_npz_open(file, &npz, error);
    if (status != TIDES_OK) return status;
    status = td_npz_get(npz, td_npz_count(npz) ? td_npz_name(npz, 0) : "data", &array, error);
    if (status == TIDES_OK && (array->ndim != 3 || array->shape[2] != TD_IEBCS_BINS || !array->count))
        status =
            td_fail(error, TIDES_BAD_FILE, "%s: noise histograms have the shape (rows, columns, %d)", file, (int)TD_IEBCS_BINS);
    if (status == TIDES_OK) {
        noise->rows = array->count / TD_IEBCS_BINS;
        noise->chance = td_alloc(array->count, sizeof *noise->chance, error);
        status = noise->chance ? accumulate(file, array, noise, error) : TIDES_NO_MEMORY;
    }
    td_npz_close(npz);
    return status;
}

static td_random_bits draw(const tides_baseline *b, td_iebcs_noise *noise, size_t i) {
    return td_random(b->params.seed, (uint32_t)i, noise->purpose | noise->draws[i]++, TD_RANDOM_IEBCS_NOISE);
}

double td_iebcs_noise_period(const tides_baseline *b, td_iebcs_noise *noise, size_t i) {
    if (!noise->chance) return noise->period;
    /* The pixel's row never changes: its number depends only on seed and pixel. */
    td_random_bits which = td_random(b->params.seed, (uint32_t)i, noise->purpose | UINT32_MAX, TD_RANDOM_IEBCS_NOISE);
    size_t row = (size_t)(td_random_uniform(&which, 0) * (double)noise->rows);
    const double *chance = noise->chance + row * TD_IEBCS_BINS;
    if (!(chance[TD_IEBCS_BINS - 1] > 0)) return INFINITY;
    td_random_bits bits = draw(b, noise, i);
    double u = td_random_uniform(&bits, 0);
    int bin = 0;
    while (bin + 1 < TD_IEBCS_BINS && chance[bin] < u) bin++;
    return floor(1e6 / bin_rate(bin));
}

tides_status td_iebcs_noise_make(const tides_baseline *b, const char *file, double rate, int polarity, td_iebcs_noise *noise,
                                 tides_error *error) {
    noise->purpose = polarity > 0 ? 0 : (uint64_t)1 << 63;
    noise->period = rate > 0 ? floor(1e6 / rate) : INFINITY;
    noise->next = td_alloc(b->pixels, sizeof *noise->next, error);
    noise->draws = td_alloc(b->pixels, sizeof *noise->draws, error);
    if (!noise->next || !noise->draws) return TIDES_NO_MEMORY;
    tides_status status = file ? load(file, noise, error) : TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && i < b->pixels; i++) {
        double period = td_iebcs_noise_period(b, noise, i);
        td_random_bits bits = draw(b, noise, i);
        noise->next[i] = isinf(period) ? INFINITY : floor(period * td_random_uniform(&bits, 1));
    }
    return status;
}
