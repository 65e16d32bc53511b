/* The options of tides_metrics_compare: their defaults, and the checks that refuse bad ones before two streams are compared. */
#include "td_metrics.h"

#include <math.h>
#include <string.h>

void tides_metrics_options_defaults(tides_metrics_options *options) {
    memset(options, 0, sizeof *options);
    options->size = sizeof *options;
    options->wanted = TIDES_METRICS_DEFAULT;
    options->tick_ns = 1000;
    options->isi_floor_s = 0.5e-6; /* [s] half a tick */
    options->fano_bin_s[0] = 1e-3;
    options->fano_bin_s[1] = 0.2e-3; /* three sizes, since a bin as long as a simulator's frame hides its batches */
    options->fano_bin_s[2] = 5e-3;
    options->fano_tile_px = 16;
    options->fano_events_min = 20;
    options->fano_epsilon = 1e-3;
    options->window_s = 50e-3;
    options->cell_px = 1.0;
    options->victor_purpura_per_s = 100.0;
    options->van_rossum_s = 10e-3;
    options->difference_limit_s = 10e-3;
    options->kernel_px = 2.0;
    options->kernel_s = 5e-3;
    options->match_limit_s = 1e-3;
}

typedef struct bound {
    const char *name;
    double value, least, most;
} bound;

/* Durations are at least a nanosecond, and small enough for 64-bit nanoseconds. */
static const double least_s = 1e-9, most_s = 1e9;

static tides_status check_numbers(const tides_metrics_options *o, tides_error *error) {
    const bound bounds[] = {
        {"isi_floor_s", o->isi_floor_s, least_s, most_s},
        {"clock_s", o->clock_s, 0, most_s},
        {"fano_bin_s[0]", o->fano_bin_s[0], least_s, most_s},
        {"fano_bin_s[1]", o->fano_bin_s[1], least_s, most_s},
        {"fano_bin_s[2]", o->fano_bin_s[2], least_s, most_s},
        {"fano_tile_px", o->fano_tile_px, 1, 65536},
        {"fano_events_min", o->fano_events_min, 1, 2147483647},
        {"fano_epsilon", o->fano_epsilon, 1e-300, 1e300},
        {"speed_px_per_s", o->speed_px_per_s, 0, 1e9},
        {"window_s", o->window_s, least_s, most_s},
        {"cell_px", o->cell_px, 1e-6, 65536},
        {"victor_purpura_per_s", o->victor_purpura_per_s, 1e-9, 1e9},
        {"van_rossum_s", o->van_rossum_s, least_s, most_s},
        {"difference_limit_s", o->difference_limit_s, least_s, most_s},
        {"kernel_px", o->kernel_px, 1e-6, 65536},
        {"kernel_s", o->kernel_s, least_s, most_s},
        {"tick_ns", (double)o->tick_ns, 0, 1e9},
    };
    for (size_t i = 0; i < sizeof bounds / sizeof bounds[0]; i++)
        if (!(bounds[i].value >= bounds[i].least && bounds[i].value <= bounds[i].most))
            return td_fail(error, TIDES_BAD_ARGUMENT, "tides_metrics_options: %s is %g; it must lie between %g and %g",
                           bounds[i].name, bounds[i].value, bounds[i].least, bounds[i].most);
    return TIDES_OK;
}

tides_status td_metrics_options_check(const tides_metrics_options *o, tides_error *error) {
    const int64_t time_limit = INT64_C(2305843009213693952); /* limit of event times [ns]: differences must fit 64 bits */
    if (o->wanted & ~(uint32_t)TIDES_METRICS_ALL)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_metrics_options: wanted is %#x; the known ones are %#x",
                       (unsigned)o->wanted, (unsigned)TIDES_METRICS_ALL);
    if (o->width < 0 || o->height < 0 || o->width > 65536 || o->height > 65536 || !o->width != !o->height)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_metrics_options: the sensor has %dx%d px; both 1 to 65536, or both 0",
                       o->width, o->height);
    const int32_t *roi = o->roi;
    if (roi[0] < 0 || roi[1] < 0 || roi[0] > 65535 || roi[1] > 65535 || roi[2] < 0 || roi[3] < 0 || roi[2] > 65536 ||
        roi[3] > 65536 || !roi[2] != !roi[3] || (!roi[2] && (roi[0] || roi[1])))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "tides_metrics_options: the region %d,%d,%d,%d should be x,y,width,height, or all 0", roi[0], roi[1],
                       roi[2], roi[3]);
    if (o->start_ns > o->stop_ns || o->start_ns < -time_limit || o->stop_ns > time_limit)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_metrics_options: the interval is %lld to %lld ns: it ends first",
                       (long long)o->start_ns, (long long)o->stop_ns);
    return check_numbers(o, error);
}
