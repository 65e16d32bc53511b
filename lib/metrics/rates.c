/* Compares the numbers of events of two streams in each bin of time, and in each tile of the image. */
#include "td_metrics.h"

#include <math.h>
#include <stdlib.h>

/* Counts the stream's events in `bin`, from *next on. */
static int64_t in_bin(const td_stream *stream, size_t *next, int64_t bin, int64_t bin_ns) {
    const size_t first = *next;
    while (*next < stream->count && stream->events[*next].t / bin_ns == bin) ++*next;
    return (int64_t)(*next - first);
}

/* Sum of the differences over bins. Streams are in order of time, so bins without events are skipped. */
static double rate_error(const td_compare *c, int64_t bin_ns) {
    const td_stream *a = &c->reference, *b = &c->simulated;
    int64_t sum = 0;
    for (size_t i = 0, j = 0; i < a->count || j < b->count;) {
        const int64_t of_a = i < a->count ? a->events[i].t / bin_ns : INT64_MAX;
        const int64_t of_b = j < b->count ? b->events[j].t / bin_ns : INT64_MAX, bin = of_a < of_b ? of_a : of_b;
        sum += llabs(in_bin(a, &i, bin, bin_ns) - in_bin(b, &j, bin, bin_ns));
    }
    return (double)sum / (double)a->count;
}

static void count_tiles(const td_compare *c, const td_stream *stream, size_t across, int64_t sign, int64_t *tiles) {
    const int32_t edge = c->options->fano_tile_px;
    for (size_t i = 0; i < stream->count; i++) {
        const tides_event *e = &stream->events[i];
        tiles[(size_t)(e->y / edge) * across + (size_t)(e->x / edge)] += sign;
    }
}

tides_status td_compare_rates(td_compare *c) {
    const size_t across = td_tiles(c->width, c->options->fano_tile_px);
    const size_t count = across * td_tiles(c->height, c->options->fano_tile_px);
    int64_t sum = 0;
    if (c->reference.count == 0) return TIDES_OK;
    int64_t *tiles = td_alloc(count, sizeof *tiles, c->error);
    if (!tiles) return TIDES_NO_MEMORY;
    count_tiles(c, &c->reference, across, -1, tiles);
    count_tiles(c, &c->simulated, across, 1, tiles);
    for (size_t i = 0; i < count; i++) sum += llabs(tiles[i]);
    free(tiles);
    c->metrics->region_error = (double)sum / (double)c->reference.count;
    for (int i = 0; i < TIDES_FANO_BINS; i++)
        c->metrics->rate_error[i] = rate_error(c, llround(1e9 * c->options->fano_bin_s[i]));
    return TIDES_OK;
}
