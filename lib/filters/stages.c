/* The decision of each filter about an event: pass or drop.
 *
 *   background   passes if enough of the 8 neighbours had an event within background_s before
 *   activity     passes unless the rate of the last ended period was too low, or too high
 *   erc          event rate control: passes by chance, or passes the first events of each period
 *   afk          anti-flicker: passes if the event's cell of pixels flickers, or if it doesn't
 *   trail        passes the first event after a change of polarity or a pause, or the second and later ones of a burst
 *
 * include/tides/filters.h has the exact laws. */
#include "td_filter.h"
#include "td_random.h"

/* -- by neighbours -------------------------------------------------------------------------------------------------------- */

int td_filter_background(tides_filter *f, const tides_event *event) {
    const ptrdiff_t wide = f->width + 2;
    int64_t *own = f->seen + (event->y + 1) * wide + event->x + 1;
    const int64_t *rows[3] = {own - wide - 1, own - 1, own + wide - 1};
    int support = 0;
    for (int y = 0; y < 3; y++)
        for (int x = 0; x < 3; x++)
            if (rows[y] + x != own) support += td_since(event->t, rows[y][x]) <= f->background_ns;
    *own = event->t;
    return support >= f->filters.background_support;
}

/* -- by rate -------------------------------------------------------------------------------------------------------------- */

/* The number of the period that holds t, rounded down also for times before 0. */
static int64_t period_of(int64_t t, int64_t length) { return t / length - (t % length < 0); }

/* Counts an event; returns the number of periods that have ended since the event before. */
static int64_t count_event(int64_t *period, int64_t t, int64_t length) {
    const int64_t number = period_of(t, length), last = period[TD_PERIOD_NUMBER];
    const int64_t ended = last == TD_NEVER ? 2 : number - last; /* before the first event all periods are empty */
    if (ended > 0) {
        period[TD_PERIOD_BEFORE] = ended == 1 ? period[TD_PERIOD_COUNT] : 0;
        period[TD_PERIOD_COUNT] = 0;
        period[TD_PERIOD_NUMBER] = number;
    }
    period[TD_PERIOD_COUNT]++;
    return ended;
}

/* Updates the state of the activity filter after a period with `count` events. */
static void judge(tides_filter *f, double count) {
    const tides_filters *p = &f->filters;
    const double rate = count / (1e-9 * (double)f->activity_ns);
    int64_t *low = f->state + TD_FILTER_LOW, *high = f->state + TD_FILTER_HIGH;
    if (p->activity_low_start > 0) *low = *low ? !(rate > p->activity_low_stop) : rate < p->activity_low_start;
    if (p->activity_high_start > 0) *high = *high ? !(rate < p->activity_high_stop) : rate > p->activity_high_start;
}

int td_filter_activity(tides_filter *f, const tides_event *event) {
    int64_t *period = f->state + TD_FILTER_ACTIVITY;
    const double count = (double)period[TD_PERIOD_COUNT];
    const int64_t ended = count_event(period, event->t, f->activity_ns);
    if (ended > 0) judge(f, count);
    if (ended > 1) judge(f, 0); /* the periods since then were empty; judging one of them is enough */
    return !f->state[TD_FILTER_LOW] && !f->state[TD_FILTER_HIGH];
}

int td_filter_erc(tides_filter *f, const tides_event *event) {
    int64_t *period = f->state + TD_FILTER_ERC;
    count_event(period, event->t, f->erc_ns);
    const int64_t most = f->filters.erc_events;
    if (f->filters.erc_law == TIDES_ERC_FIRST) return period[TD_PERIOD_COUNT] <= most;
    if (period[TD_PERIOD_BEFORE] <= most) return 1;
    const uint32_t pixel = (uint32_t)event->y * (uint32_t)f->width + event->x;
    td_random_bits bits = td_random(f->seed, pixel, 2 * (uint64_t)event->t + (event->polarity > 0), TD_RANDOM_ERC);
    return td_random_uniform(&bits, 0) * (double)period[TD_PERIOD_BEFORE] < (double)most;
}

/* -- by the past of a cell or pixel ---------------------------------------------------------------------------------------- */

enum { COUNTER_MAX = 7 }; /* three bits */

/* Handles a cell's change to the event's polarity. The time since the last change to it counts the cell's counter up if it is a
 * period of flicker, else down; the counter switches the cell's state. */
static void turn(const tides_filter *f, int64_t *cell, const tides_event *event) {
    int64_t *before = &cell[event->polarity > 0 ? TD_CELL_ON : TD_CELL_OFF], *counter = &cell[TD_CELL_COUNTER];
    const int64_t v = td_since(event->t, *before);
    *before = event->t;
    if (v >= f->afk_least_ns && v <= f->afk_most_ns)
        *counter += *counter < COUNTER_MAX;
    else
        *counter -= *counter > 0;
    if (*counter >= f->filters.afk_start) cell[TD_CELL_FLICKERS] = 1;
    if (*counter <= f->filters.afk_stop) cell[TD_CELL_FLICKERS] = 0;
}

int td_filter_afk(tides_filter *f, const tides_event *event) {
    const int32_t side = f->filters.afk_cell_px;
    int64_t *cell = f->cells + TD_CELL * ((ptrdiff_t)(event->y / side) * f->cells_across + event->x / side);
    if (cell[TD_CELL_POLARITY] != event->polarity) turn(f, cell, event);
    cell[TD_CELL_POLARITY] = event->polarity;
    return (cell[TD_CELL_FLICKERS] != 0) == (f->filters.afk == TIDES_AFK_BAND_PASS);
}

int td_filter_trail(tides_filter *f, const tides_event *event) {
    int64_t *pixel = f->trail + TD_TRAIL * ((ptrdiff_t)event->y * f->width + event->x);
    const int64_t gap = td_since(event->t, pixel[TD_TRAIL_LAST]);
    const int turns = pixel[TD_TRAIL_POLARITY] != event->polarity;
    int passes = 0;
    if (f->filters.trail == TIDES_TRAIL_TRAIL) {
        passes = turns || gap >= f->trail_ns;
    } else if (turns) {
        pixel[TD_TRAIL_ARMED] = 1;
    } else {
        passes = pixel[TD_TRAIL_ARMED] && gap <= f->trail_ns;
        if (passes && f->filters.trail == TIDES_TRAIL_STC_CUT) pixel[TD_TRAIL_ARMED] = 0;
    }
    pixel[TD_TRAIL_LAST] = event->t;
    pixel[TD_TRAIL_POLARITY] = event->polarity;
    return passes;
}
