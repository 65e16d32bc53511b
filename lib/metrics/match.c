/* Matches a stream of events with the exact one, separately for each pixel and polarity, in order of time. */
#include "td_align.h"
#include "tides/metrics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Times beyond this [ns], 146 years, are refused: their differences might not fit an int64. */
static const int64_t time_limit = INT64_C(4611686018427387904);

/* Sorts by pixel and polarity, then by time. */
static int by_place(const void *left, const void *right) {
    const tides_event *a = left, *b = right;
    if (a->y != b->y) return a->y < b->y ? -1 : 1;
    if (a->x != b->x) return a->x < b->x ? -1 : 1;
    if (a->polarity != b->polarity) return a->polarity < b->polarity ? -1 : 1;
    return (a->t > b->t) - (a->t < b->t);
}

static int compare_place(const tides_event *a, const tides_event *b) {
    tides_event x = *a, y = *b;
    x.t = y.t = 0;
    return by_place(&x, &y);
}

/* A checked copy, sorted by pixel and polarity. NULL: *status tells why. */
static tides_event *sorted_copy(const tides_event *events, size_t count, const char *name, tides_status *status,
                                tides_error *error) {
    for (size_t i = 0; i < count; i++) {
        const tides_event *event = &events[i];
        if ((event->polarity == 1 || event->polarity == -1) && event->t < time_limit && event->t > -time_limit) continue;
        *status =
            td_fail(error, TIDES_BAD_ARGUMENT,
                    "tides_match_events: event %zu of the %s stream has polarity %d and time %lld ns; polarities are 1 or "
                    "-1, and times within 146 years of 0",
                    i, name, event->polarity, (long long)event->t);
        return NULL;
    }
    tides_event *copy = td_alloc(count, sizeof *copy, error);
    *status = copy ? TIDES_OK : TIDES_NO_MEMORY;
    if (!copy || count == 0) return copy;
    memcpy(copy, events, count * sizeof *copy);
    qsort(copy, count, sizeof *copy, by_place);
    return copy;
}

/* Counts the events from the first on with its pixel and polarity, and copies their times. */
static size_t group(const tides_event *events, size_t count, int64_t *times) {
    size_t length = 0;
    while (length < count && compare_place(&events[0], &events[length]) == 0) {
        times[length] = events[length].t;
        length++;
    }
    return length;
}

/* Goes through both streams together, one pixel and polarity after the other. */
static tides_status align_places(td_align *align, const tides_event *a, size_t count_a, const tides_event *b, size_t count_b,
                                 int64_t limit, tides_error *error) {
    int64_t *times_a = td_alloc(count_a, sizeof *times_a, error), *times_b = td_alloc(count_b, sizeof *times_b, error);
    tides_status status = times_a && times_b ? TIDES_OK : TIDES_NO_MEMORY;
    size_t i = 0, j = 0;
    while (status == TIDES_OK && i < count_a && j < count_b) {
        int order = compare_place(&a[i], &b[j]);
        size_t length_a = order <= 0 ? group(a + i, count_a - i, times_a) : 0;
        size_t length_b = order >= 0 ? group(b + j, count_b - j, times_b) : 0;
        status = td_align_times(align, times_a, length_a, times_b, length_b, limit, error);
        i += length_a;
        j += length_b;
    }
    free(times_a);
    free(times_b);
    return status;
}

static int ascending(const void *left, const void *right) {
    int64_t a = *(const int64_t *)left, b = *(const int64_t *)right;
    return (a > b) - (a < b);
}

/* Percentile: interpolated between the two neighbours of rank share (count - 1). */
static double percentile_us(const int64_t *sorted, size_t count, double share) {
    if (count == 0) return NAN;
    double rank = share * (double)(count - 1), below = floor(rank);
    size_t i = (size_t)below, next = i + 1 < count ? i + 1 : i;
    return 1e-3 * ((double)sorted[i] + (rank - below) * (double)(sorted[next] - sorted[i]));
}

static void summarise(td_align *align, size_t reference, size_t simulated, tides_match *match) {
    int64_t *dt = align->dt;
    size_t pairs = align->pairs;
    double sum = 0;
    for (size_t i = 0; i < pairs; i++) {
        sum += (double)dt[i];
        if (dt[i] < 0) dt[i] = -dt[i];
    }
    if (pairs) qsort(dt, pairs, sizeof *dt, ascending);
    match->reference = reference;
    match->simulated = simulated;
    match->matched = pairs;
    match->missing = reference - pairs;
    match->spurious = simulated - pairs;
    double mismatched = (double)(match->missing + match->spurious);
    match->mismatch_percent = mismatched > 0 ? 100.0 * mismatched / (double)reference : 0.0;
    match->dt_median_us = percentile_us(dt, pairs, 0.5);
    match->dt_p95_us = percentile_us(dt, pairs, 0.95);
    match->dt_p99_us = percentile_us(dt, pairs, 0.99);
    match->dt_max_us = percentile_us(dt, pairs, 1.0);
    match->dt_mean_us = pairs ? 1e-3 * sum / (double)pairs : NAN;
}

tides_status tides_match_events(const tides_event *reference, size_t reference_count, const tides_event *simulated,
                                size_t simulated_count, double limit_s, tides_match *match, tides_error *error) {
    if ((!reference && reference_count) || (!simulated && simulated_count) || !match)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_match_events: both streams and match must be given");
    double limit = 1e9 * limit_s;
    if (!(limit >= 1 && limit <= TD_ALIGN_LIMIT_MAX))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_match_events: limit_s is %g s; it must lie between 1e-9 and 10 s",
                       limit_s);
    td_align align = {.score = NULL};
    tides_event *a = NULL, *b = NULL;
    tides_status status = TIDES_OK;
    a = sorted_copy(reference, reference_count, "reference", &status, error);
    if (status == TIDES_OK) b = sorted_copy(simulated, simulated_count, "simulated", &status, error);
    if (status == TIDES_OK) status = align_places(&align, a, reference_count, b, simulated_count, (int64_t)limit, error);
    if (status == TIDES_OK) summarise(&align, reference_count, simulated_count, match);
    td_align_release(&align);
    free(a);
    free(b);
    return status;
}
