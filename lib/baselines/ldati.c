/* LDATI, the second stage of V2CE (Zhang et al., ICRA 2024): makes events from the voxels of a frame interval. Fractions of
 * events are carried from bin to bin, and times have a density that is linear within a bin. */
#include "td_base.h"
#include "td_baseline.h"

#include "td_random.h"
#include "signal/td_event_sort.h"

#include <math.h>
#include <stdlib.h>

/* Ten planes of voxels have nine bins between them. */
enum { PLANES = TIDES_LDATI_PLANES, BINS = PLANES - 1, EVENTS_PER_BIN_MAX = 1 << 16 };

/* The bins of a pixel, for one polarity. */
typedef struct bins {
    double count[BINS];
    /* Place in the bin, in [0, 1), of its event if it has just one. It is what rounding up added to the bin. If voxels were
     * made by linear interpolation, it equals the event's weight in the next plane. */
    double first[BINS];
} bins;

/* Finds whole numbers of events for the bins. What rounding up adds to a bin is subtracted from the next one. The whole part
 * of the tenth plane goes to the last bin. An excess of 1e-6 events isn't rounded up: it comes from rounding errors. */
static bins share_out(const double *voxels, size_t stride) {
    bins made;
    double debt = 0;
    for (int k = 0; k < BINS; k++) {
        double wanted = voxels[(size_t)k * stride] - debt, count = fmax(0.0, ceil(wanted - 1e-6));
        debt = count - wanted;
        made.count[k] = count;
        made.first[k] = fmin(fmax(debt, 0.0), 1.0 - 1e-9);
    }
    double left = trunc(voxels[BINS * stride] - debt);
    if (left > 0) made.count[BINS - 1] += left;
    return made;
}

/* Slope k of the density b + k s of times s in a bin [0, 1), where b = 1 - k / 2 makes its integral 1. It is the least-squares
 * slope of the counts of the bin and its neighbours, limited so that the density isn't negative. */
static double density_slope(const bins *at, int k) {
    double before = at->count[k ? k - 1 : k], after = at->count[k + 1 < BINS ? k + 1 : k];
    double span = (k ? 1 : 0) + (k + 1 < BINS ? 1 : 0);
    double slope = (after - before) / span / at->count[k];
    return fmin(fmax(slope, -2.0), 2.0);
}

/* The place in [0, 1] with a fraction u of the density below it. */
static double place(double slope, double u) {
    double base = 1 - slope / 2;
    /* the root of the quadratic without cancellation; for slope 0 it is u */
    return 2 * u / (base + sqrt(base * base + 2 * slope * u));
}

typedef struct ldati_job {
    tides_baseline *out;
    uint64_t frame;
    double start_us, bin_us;
} ldati_job;

static tides_status fire_bin(ldati_job *job, size_t i, int polarity, const bins *at, int k, tides_error *error) {
    size_t count = (size_t)at->count[k];
    double slope = count > 1 ? density_slope(at, k) : 0;
    tides_status status = TIDES_OK;
    for (size_t n = 0; status == TIDES_OK && n < count; n++) {
        uint64_t index = (job->frame << 21 | (uint64_t)k << 17 | n) << 1 | (polarity > 0);
        td_random_bits bits = td_random(job->out->params.seed, (uint32_t)i, index, TD_RANDOM_LDATI);
        double where = count == 1 ? at->first[k] : place(slope, td_random_uniform(&bits, 0));
        int64_t us = (int64_t)floor(job->start_us + (k + where) * job->bin_us);
        status = td_baseline_fire(job->out, i, 1000 * us, polarity, TIDES_CAUSE_SIGNAL, error);
    }
    return status;
}

static tides_status fire_pixel(ldati_job *job, const double *voxels, size_t i, int polarity, tides_error *error) {
    const tides_baseline *out = job->out;
    const double *own = voxels + (polarity > 0 ? 0 : PLANES * out->pixels) + i;
    for (size_t k = 0; k < PLANES; k++)
        if (!(own[k * out->pixels] >= 0 && own[k * out->pixels] <= EVENTS_PER_BIN_MAX))
            return td_fail(error, TIDES_BAD_ARGUMENT, "LDATI: voxel %zu of pixel (%zu, %zu) is %.9g; it must lie in [0, %d]", k,
                           i % (size_t)out->width, i / (size_t)out->width, own[k * out->pixels], (int)EVENTS_PER_BIN_MAX);
    bins at = share_out(own, out->pixels);
    tides_status status = TIDES_OK;
    for (int k = 0; status == TIDES_OK && k < BINS; k++) status = fire_bin(job, i, polarity, &at, k, error);
    return status;
}

/* Makes the events of an interval, unsorted. */
static tides_status fire_interval(tides_baseline *out, const double *voxels, double start, double stop, uint64_t frame,
                                  tides_error *error) {
    ldati_job job = {out, frame, 1e6 * start, 1e6 * (stop - start) / BINS};
    tides_status status = TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && i < out->pixels; i++) {
        status = fire_pixel(&job, voxels, i, 1, error);
        if (status == TIDES_OK) status = fire_pixel(&job, voxels, i, -1, error);
    }
    return status;
}

tides_status tides_ldati(const double *voxels, int32_t width, int32_t height, double start, double stop, uint64_t seed,
                         uint64_t frame, tides_event_sink sink, void *user, tides_error *error) {
    if (!voxels || !sink) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_ldati: voxels or sink is NULL");
    if (width < 1 || height < 1 || width > 16384 || height > 16384)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_ldati: %d x %d px; each side must lie in [1, 16384]", width, height);
    if (!(fabs(start) < TD_FURTHEST_TIME && fabs(stop) < TD_FURTHEST_TIME && start < stop))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_ldati: [%.9g, %.9g) s is no interval", start, stop);
    tides_baseline out = {.width = width, .height = height, .pixels = (size_t)width * (size_t)height};
    out.params.seed = seed;
    tides_status status = fire_interval(&out, voxels, start, stop, frame, error);
    if (status == TIDES_OK && !(out.scratch = td_alloc(out.made.count, sizeof *out.scratch, error))) status = TIDES_NO_MEMORY;
    if (status == TIDES_OK) {
        td_event_sort(out.made.events, out.scratch, out.made.count);
        if (sink(user, out.made.events, out.made.count))
            status = td_fail(error, TIDES_CANCELLED, "LDATI: the receiver of the events stopped the run");
    }
    free(out.made.events);
    free(out.scratch);
    return status;
}

/* -- the method --------------------------------------------------------------------------------------------------------- */

static tides_status create(tides_baseline *b, tides_error *error) {
    return td_baseline_range(b, "fps", b->params.ldati.fps, 1e-6, 1e9, error);
}

/* Handles an interval. The key of its random numbers is its number counted from time 0. So a part of a sequence gives the
 * same events as the whole sequence gives there. */
static tides_status push(tides_baseline *b, const double *voxels, tides_error *error) {
    const double lasts = td_baseline_lasts(b);
    return fire_interval(b, voxels, b->now, b->now + lasts, (uint64_t)llround(fmax((b->epoch + b->now) / lasts, 0)), error);
}

/* The method. Times are rounded down to microseconds, so an interval's first event may be up to 1e-6 s early. */
const td_method td_ldati = {"ldati", create, push, push, NULL, NULL, 1e-6, 2 * PLANES};
