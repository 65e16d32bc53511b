/* An open path's curve: a cubic from each knot to the next, for paths whose knots are appended during a run.
 *
 * A knot without a rate gets the rate of the parabola through it and the two knots before, because a later knot must change
 * nothing that was already used. The second knot gets the slope of the line from the first, and so does a first knot without a
 * rate. A rate from both neighbours would be more accurate, but known one knot late. A rate from the parabola through the
 * previous knot, its rate and the new knot would keep the curve C1, too. But its error would return with the other sign at
 * every knot, for ever. */
#include "camera/td_open.h"

#include "td_base.h"

#include <math.h>
#include <string.h>

enum { WIDTH = TD_CURVE_WIDTH };

static double chord(const td_knot *from, const td_knot *to, int k) {
    return (to->value[k] - from->value[k]) / (to->time - from->time);
}

/* Sets the rate of the last of `count` knots from the knots before it. */
static void find_rates(td_knot *last, size_t count) {
    if (count < 2) return;
    for (int k = 0; k < WIDTH; k++) {
        const double along = chord(last - 1, last, k);
        last->rate[k] = along;
        if (count == 2) continue;
        const double share = (last->time - last[-1].time) / (last->time - last[-2].time);
        last->rate[k] += share * (along - chord(last - 2, last - 1, k));
    }
}

tides_status td_open_append(td_open *open, const td_knot *knot, int32_t with_rate, int32_t first_has_rate, tides_error *error) {
    tides_status status = td_reserve((void **)&open->knot, &open->capacity, open->count + 1, sizeof *open->knot, error);
    if (status != TIDES_OK) return status;
    td_knot *last = open->knot + open->count;
    *last = *knot;
    if (open->count == 1 && !first_has_rate) /* the first knot's rate comes from the second knot */
        for (int k = 0; k < WIDTH; k++) last[-1].rate[k] = chord(last - 1, last, k);
    if (!with_rate) memset(last->rate, 0, sizeof last->rate);
    if (!with_rate) find_rates(last, open->count + 1);
    open->count++;
    return TIDES_OK;
}

size_t td_open_find(const td_open *open, double time) {
    size_t low = 0, high = open->count > 1 ? open->count - 1 : 1;
    /* For times within the path, knot[low].time <= time < knot[high].time, except at the path's end. */
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (open->knot[middle].time <= time)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* The knot at `time` (number `from` or the next), or NULL. At most one matches: tides_trajectory_append refuses samples that
 * are up to 4 slacks apart. */
static const td_knot *knot_at(const td_open *open, size_t from, double time, double slack) {
    for (size_t i = from; i < open->count && i <= from + 1; i++)
        if (fabs(time - open->knot[i].time) <= slack) return &open->knot[i];
    return NULL;
}

void td_open_at(const td_open *open, double time, double slack, double value[WIDTH], double rate[WIDTH]) {
    const size_t i = td_open_find(open, time);
    const td_knot *from = open->knot + i, *to = from + 1, *at = open->count > 1 ? knot_at(open, i, time, slack) : from;
    if (at) {
        memcpy(value, at->value, sizeof at->value);
        memcpy(rate, at->rate, sizeof at->rate);
        return;
    }
    /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): an open path has at least one knot */
    const double span = to->time - from->time, u = (time - from->time) / span;
    for (int k = 0; k < WIDTH; k++) {
        const double rise = to->value[k] - from->value[k], start = span * from->rate[k], stop = span * to->rate[k];
        const double c2 = 3 * rise - 2 * start - stop, c3 = start + stop - 2 * rise;
        value[k] = from->value[k] + u * (start + u * (c2 + u * c3));
        rate[k] = (start + u * (2 * c2 + u * (3 * c3))) / span;
    }
}

size_t td_open_forget(td_open *open, double time) {
    const size_t kept = td_open_find(open, time), needed = open->count < 3 ? 0 : open->count - 3;
    const size_t gone = kept < needed ? kept : needed;
    if (2 * gone < open->count) return 0; /* moves memory only once per knot on average */
    open->count -= gone;
    memmove(open->knot, open->knot + gone, open->count * sizeof *open->knot);
    return gone;
}
