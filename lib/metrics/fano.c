/* Fano-factor error (paper, Sec. 4.3): how bursty each tile's events are, F = Var(N) / E[N] of the counts in equal bins of
 * time.
 *
 * Only whole bins within the interval count. Streams are in order of time, so a tile only needs its current bin. */
#include "td_metrics.h"

#include "td_math.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct tile_bins {
    uint64_t events, squares; /* of finished bins: sums of counts and of squared counts */
    int64_t bin;              /* the current one */
    uint64_t in_bin;
} tile_bins;

static void finish_bin(tile_bins *tile) {
    tile->events += tile->in_bin;
    tile->squares += tile->in_bin * tile->in_bin;
    tile->in_bin = 0;
}

static void count_bins(const td_compare *c, const td_stream *stream, int64_t bin_ns, size_t across, tile_bins *tiles,
                       size_t count) {
    const int32_t edge = c->options->fano_tile_px;
    const int64_t bins = c->span_ns / bin_ns;
    for (size_t i = 0; i < stream->count; i++) {
        const tides_event *event = &stream->events[i];
        const int64_t bin = event->t / bin_ns;
        if (bin >= bins) break;
        tile_bins *tile = &tiles[(size_t)(event->y / edge) * across + (size_t)(event->x / edge)];
        if (tile->bin != bin) finish_bin(tile);
        tile->bin = bin;
        tile->in_bin++;
    }
    for (size_t i = 0; i < count; i++) finish_bin(&tiles[i]);
}

/* Variance over n - 1 divided by the mean, with n sum(c^2) - sum(c)^2 in integers, which has no cancellation. */
static double fano_factor(const tile_bins *tile, int64_t bins) {
    const long double n = (long double)bins, sum = (long double)tile->events;
    const long double variance = (n * (long double)tile->squares - sum * sum) / (n * (n - 1));
    return (double)(variance / (sum / n));
}

/* Sums over the tiles with enough events in both streams. */
static void compare_tiles(const td_compare *c, const tile_bins *a, const tile_bins *b, size_t count, int64_t bins, int which) {
    const uint64_t least = (uint64_t)c->options->fano_events_min;
    tides_metrics *m = c->metrics;
    td_sum error = {0, 0}, sum_a = {0, 0}, sum_b = {0, 0};
    uint64_t compared = 0, wanted = 0;
    for (size_t i = 0; i < count; i++) {
        wanted += a[i].events >= least;
        if (a[i].events < least || b[i].events < least) continue;
        const double factor_a = fano_factor(&a[i], bins), factor_b = fano_factor(&b[i], bins);
        td_sum_add(&sum_a, factor_a);
        td_sum_add(&sum_b, factor_b);
        td_sum_add(&error, fabs(td_ln((factor_b + c->options->fano_epsilon) / (factor_a + c->options->fano_epsilon))));
        compared++;
    }
    m->fano_tiles[which] = compared;
    m->fano_coverage[which] = wanted ? (double)compared / (double)wanted : NAN;
    if (compared == 0) return;
    m->fano_error[which] = td_sum_of(&error) / (double)compared;
    m->reference.fano[which] = td_sum_of(&sum_a) / (double)compared;
    m->simulated.fano[which] = td_sum_of(&sum_b) / (double)compared;
}

tides_status td_compare_fano(td_compare *c) {
    const int32_t edge = c->options->fano_tile_px;
    const size_t across = td_tiles(c->width, edge), count = across * td_tiles(c->height, edge);
    tile_bins *tiles = td_alloc(2 * count, sizeof *tiles, c->error);
    if (!tiles) return TIDES_NO_MEMORY;
    for (int which = 0; which < TIDES_FANO_BINS; which++) {
        const int64_t bin_ns = llround(1e9 * c->options->fano_bin_s[which]);
        if (c->span_ns / bin_ns < 2) continue; /* too few bins for a variance */
        memset(tiles, 0, 2 * count * sizeof *tiles);
        count_bins(c, &c->reference, bin_ns, across, tiles, count);
        count_bins(c, &c->simulated, bin_ns, across, tiles + count, count);
        compare_tiles(c, tiles, tiles + count, count, c->span_ns / bin_ns, which);
    }
    free(tiles);
    return TIDES_OK;
}
