/* Same-ts (paper, Sec. 4.3): the fraction of events that share their timestamp with another event of the sensor, or of their
 * tile. */
#include "td_metrics.h"

#include <math.h>
#include <stdlib.h>

typedef struct tile_count {
    size_t group, count; /* number of the group of simultaneous events; their count in the tile */
} tile_count;

/* Number of events of a group that share their tile with another one. */
static size_t shared_tiles(const tides_event *events, size_t count, size_t group, int32_t tile, size_t across,
                           tile_count *tiles) {
    size_t shared = 0;
    for (size_t i = 0; i < count; i++) {
        tile_count *here = &tiles[(size_t)(events[i].y / tile) * across + (size_t)(events[i].x / tile)];
        if (here->group != group) *here = (tile_count){group, 0};
        here->count++;
        /* With the second event, the first one is shared, too. */
        shared += here->count == 2 ? 2 : here->count > 2;
    }
    return shared;
}

static void shares(const td_stream *stream, int32_t tile, size_t across, tile_count *tiles, tides_stream_metrics *out) {
    size_t sensor = 0, local = 0;
    for (size_t i = 0, end; i < stream->count; i = end) {
        for (end = i + 1; end < stream->count && stream->events[end].t == stream->events[i].t;) end++;
        if (end - i == 1) continue;
        sensor += end - i;
        local += shared_tiles(stream->events + i, end - i, i + 1, tile, across, tiles);
    }
    out->same_time = stream->count ? (double)sensor / (double)stream->count : NAN;
    out->same_time_tile = stream->count ? (double)local / (double)stream->count : NAN;
}

tides_status td_compare_same_time(td_compare *c) {
    const int32_t tile = c->options->fano_tile_px;
    const size_t across = td_tiles(c->width, tile), down = td_tiles(c->height, tile);
    const td_stream *streams[2] = {&c->reference, &c->simulated};
    tides_stream_metrics *out[2] = {&c->metrics->reference, &c->metrics->simulated};
    for (int s = 0; s < 2; s++) {
        tile_count *tiles = td_alloc(across * down, sizeof *tiles, c->error);
        if (!tiles) return TIDES_NO_MEMORY;
        shares(streams[s], tile, across, tiles, out[s]);
        free(tiles);
    }
    return TIDES_OK;
}
