/* Puts neighbours in space next to each other in memory, along the curve that interleaves the bits of x, y and z (Morton, IBM
 * 1966), in a cube of 2048^3 cells. The cube holds most Gaussians: if it held a few far ones, too, all others would share a
 * handful of cells. */
#include "td_space_order.h"

#include "td_base.h"
#include "td_sort.h"

#include <math.h>
#include <stdlib.h>

enum { CELLS_BITS = 11, CELLS = 1 << CELLS_BITS, SAMPLES = 1024 };

typedef struct item {
    uint64_t key;
    int64_t index;
} item;

typedef struct cube {
    double low[3], per_side; /* cells per unit of length */
} cube;

static uint64_t key_of(const void *context, const void *one) {
    (void)context;
    return ((const item *)one)->key;
}

/* Spreads the bits of a cell's coordinate three places apart. */
static uint64_t spread(uint64_t x) {
    x = (x | x << 16) & 0x1f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    return (x | x << 2) & 0x1249249249249249;
}

/* The cube from the second to the 98th percentile of samples along each axis, enlarged to twice the size. */
static cube find_cube(const float *mean, int64_t count) {
    double sample[SAMPLES] = {0}, side = 0;
    cube made = {{0}, 0};
    for (int k = 0; k < 3; k++) {
        const int64_t samples = count < SAMPLES ? count : SAMPLES;
        size_t taken = 0;
        for (int64_t i = 0; i < samples; i++) {
            const double x = mean[3 * (i * count / samples) + k];
            if (isfinite(x)) sample[taken++] = x;
        }
        if (taken == 0) return made;
        qsort(sample, taken, sizeof *sample, td_ascending);
        const double low = sample[taken / 50], high = sample[taken - 1 - taken / 50];
        made.low[k] = low - 0.5 * (high - low);
        side = fmax(side, 2 * (high - low));
    }
    made.per_side = side > 0 ? CELLS / side : 0;
    return made;
}

static uint64_t cell_of(const cube *in, const float *mean) {
    uint64_t cell = 0;
    for (int k = 0; k < 3; k++) {
        const double at = (mean[k] - in->low[k]) * in->per_side; /* NaN goes to cell 0 */
        cell |= spread((uint64_t)(at > 0 ? fmin(at, CELLS - 1) : 0)) << k;
    }
    return cell;
}

tides_status td_space_order(const float *mean, const uint8_t *left_out, int64_t count, int64_t *order, tides_error *error) {
    const cube in = find_cube(mean, count);
    item *items = td_alloc(2 * (size_t)count + 1, sizeof *items, error);
    if (!items) return TIDES_NO_MEMORY;
    item *from = items, *to = items + count;
    size_t kept = 0;
    for (int64_t i = 0; i < count; i++)
        if (!left_out[i]) from[kept++] = (item){cell_of(&in, mean + 3 * i), i};
    for (int shift = 0; shift < 3 * CELLS_BITS; shift += TD_RADIX_BITS) {
        td_radix_pass(key_of, NULL, shift, from, to, kept, sizeof *from);
        item *other = from;
        from = to, to = other;
    }
    for (size_t i = 0; i < kept; i++) order[i] = from[i].index;
    free(items);
    return TIDES_OK;
}
