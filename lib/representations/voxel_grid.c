/* Voxel grids: events are shared linearly between bins of time (Zhu et al. 2019), as for E2VID, DSEC's E-RAFT and TimeLens. */
#include "td_representation.h"

#include "td_struct.h"

#include <math.h>
#include <string.h>

void tides_voxel_options_defaults(tides_voxel_options *options, int32_t style) {
    memset(options, 0, sizeof *options);
    options->size = sizeof *options;
    options->bins = style == TIDES_VOXEL_DSEC ? 15 : 5;
    options->normalise = style == TIDES_VOXEL_DSEC       ? TIDES_NORMALISE_SAMPLE
                         : style == TIDES_VOXEL_TIMELENS ? TIDES_NORMALISE_NONE
                                                         : TIDES_NORMALISE_POPULATION;
}

static tides_status check_options(const tides_voxel_options *o, tides_error *error) {
    const int64_t limit = INT64_C(2305843009213693952); /* times of 73 years, whose differences fit 64 bits */
    if (o->bins < 1 || o->bins > 4096)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_voxel_options: there are %d bins; 1 to 4096 are possible", o->bins);
    if (o->normalise < TIDES_NORMALISE_NONE || o->normalise > TIDES_NORMALISE_SAMPLE)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_voxel_options: normalise is %d, none of TIDES_NORMALISE_*",
                       o->normalise);
    if (o->start_ns > o->stop_ns || o->start_ns < -limit || o->stop_ns > limit)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_voxel_options: the interval is %lld to %lld ns: it ends first",
                       (long long)o->start_ns, (long long)o->stop_ns);
    return TIDES_OK;
}

/* Adds the events in [start, stop] to a grid of zeros. */
static void fill(const tides_event *events, size_t count, int32_t width, size_t pixels, int32_t bins, int64_t start,
                 int64_t stop, double *grid) {
    const double span = stop > start ? (double)(stop - start) : 1.0;
    for (size_t i = 0; i < count; i++) {
        if (events[i].t < start || events[i].t > stop) continue;
        const double place = (double)(bins - 1) * (double)(events[i].t - start) / span, below = floor(place);
        const size_t bin = (size_t)below, cell = bin * pixels + td_representation_pixel(&events[i], width);
        grid[cell] += events[i].polarity * (1.0 - (place - below));
        if (bin + 1 < (size_t)bins) grid[cell + pixels] += events[i].polarity * (place - below);
    }
}

static void normalise(double *grid, size_t cells, int32_t kind) {
    double mean = 0, square = 0;
    size_t used = 0;
    for (size_t i = 0; i < cells; i++) {
        mean += grid[i];
        used += grid[i] != 0;
    }
    if (used == 0) return;
    mean /= (double)used;
    for (size_t i = 0; i < cells; i++)
        if (grid[i] != 0) square += (grid[i] - mean) * (grid[i] - mean);
    const size_t over = kind == TIDES_NORMALISE_SAMPLE ? used - 1 : used;
    const double deviation = over ? sqrt(square / (double)over) : 0.0;
    for (size_t i = 0; i < cells; i++)
        if (grid[i] != 0) grid[i] = deviation > 0 ? (grid[i] - mean) / deviation : grid[i] - mean;
}

tides_status tides_voxel_grid(const tides_event *events, size_t count, int32_t width, int32_t height,
                              const tides_voxel_options *given, double *grid, tides_error *error) {
    if (!given) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_voxel_grid: options must be given");
    tides_voxel_options own;
    const tides_voxel_options *options = &own;
    tides_voxel_options_defaults(&own, TIDES_VOXEL_E2VID);
    tides_status status = TD_TAKE_STRUCT(tides_voxel_options, &own, given, error);
    if (status == TIDES_OK) status = check_options(options, error);
    if (status == TIDES_OK) status = td_representation_check("tides_voxel_grid", events, count, width, height, error);
    if (status != TIDES_OK) return status;
    if (!grid) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_voxel_grid: grid must be given");
    const size_t pixels = (size_t)width * (size_t)height, cells = pixels * (size_t)options->bins;
    int64_t start = options->start_ns, stop = options->stop_ns;
    if (start == stop && count) {
        start = events[0].t;
        stop = events[count - 1].t;
    }
    memset(grid, 0, cells * sizeof *grid);
    fill(events, count, width, pixels, options->bins, start, stop, grid);
    if (options->normalise) normalise(grid, cells, options->normalise);
    return TIDES_OK;
}
