/* A camera's event filters behind the readout: parameters, state, and passing events through the chosen filters. */
#include "td_filter.h"
#include "td_base.h"
#include "td_struct.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Largest side of a sensor [px]; neighbours of a pixel; largest value of the anti-flicker filter's 3-bit counter. */
enum { SIDE_MAX = 65536, NEIGHBOURS = 8, COUNTER_MAX = 7 };

void tides_filters_defaults(tides_filters *filters) {
    *filters = (tides_filters){.size = sizeof *filters, .background_support = 1};
    filters->activity_period_s = 1e-3; /* the window of GenX320 */
    filters->afk_low_hz = 50;
    filters->afk_high_hz = 520;
    filters->afk_cell_px = 4;
    filters->afk_start = 6;
    filters->afk_stop = 4;
    filters->trail_s = 0.01;
    filters->erc_period_s = 2e-4; /* IMX636's */
}

int32_t tides_filters_any(const tides_filters *f) {
    return f->background_s > 0 || f->activity_low_start > 0 || f->activity_high_start > 0 || f->afk != TIDES_AFK_OFF ||
           f->trail != TIDES_TRAIL_OFF || f->erc_events > 0;
}

/* -- parameters ----------------------------------------------------------------------------------------------------------- */

static tides_status check_numbers(const tides_filters *f, tides_error *error) {
    const struct {
        const char *name;
        double value, least, most;
    } rows[] = {{"background_support", f->background_support, 1, NEIGHBOURS},
                {"background_s", f->background_s, 0, 1e3},
                {"activity_low_start", f->activity_low_start, 0, 1e12},
                {"activity_low_stop", f->activity_low_stop, 0, 1e12},
                {"activity_high_start", f->activity_high_start, 0, 1e12},
                {"activity_high_stop", f->activity_high_stop, 0, 1e12},
                {"activity_period_s", f->activity_period_s, 1e-9, 1e3},
                {"afk", f->afk, TIDES_AFK_OFF, TIDES_AFK_BAND_PASS},
                {"afk_low_hz", f->afk_low_hz, 1e-3, 1e6},
                {"afk_high_hz", f->afk_high_hz, 1e-3, 1e6},
                {"afk_cell_px", f->afk_cell_px, 1, SIDE_MAX},
                {"afk_start", f->afk_start, 1, COUNTER_MAX},
                {"afk_stop", f->afk_stop, 0, COUNTER_MAX},
                {"trail", f->trail, TIDES_TRAIL_OFF, TIDES_TRAIL_STC_KEEP},
                {"trail_s", f->trail_s, 0, 1e3},
                {"erc_events", f->erc_events, 0, 1e9},
                {"erc_law", f->erc_law, TIDES_ERC_CHANCE, TIDES_ERC_FIRST},
                {"erc_period_s", f->erc_period_s, 1e-9, 1e3}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        if (!(rows[i].value >= rows[i].least && rows[i].value <= rows[i].most))
            return td_fail(error, TIDES_BAD_ARGUMENT, "filters: %s is %g; it must lie in [%g, %g]", rows[i].name, rows[i].value,
                           rows[i].least, rows[i].most);
    return TIDES_OK;
}

/* Sets each stop of the activity filter that is 0 to its start, and checks that pairs of bounds are in order. */
static tides_status settle(tides_filters *f, tides_error *error) {
    if (f->activity_low_stop == 0) f->activity_low_stop = f->activity_low_start;
    if (f->activity_high_stop == 0) f->activity_high_stop = f->activity_high_start;
    const struct {
        const char *low, *high;
        double least, most;
    } rows[] = {{"activity_low_start", "activity_low_stop", f->activity_low_start, f->activity_low_stop},
                {"activity_high_stop", "activity_high_start", f->activity_high_stop, f->activity_high_start},
                {"afk_low_hz", "afk_high_hz", f->afk_low_hz, f->afk_high_hz},
                {"afk_stop + 1", "afk_start", f->afk_stop + 1, f->afk_start}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        if (rows[i].least > rows[i].most)
            return td_fail(error, TIDES_BAD_ARGUMENT, "filters: %s is %g, above %s, %g", rows[i].low, rows[i].least,
                           rows[i].high, rows[i].most);
    return TIDES_OK;
}

static int64_t ns_of(double seconds) { return (int64_t)llround(seconds * 1e9); }

/* -- memory --------------------------------------------------------------------------------------------------------------- */

/* Resets the state: no times, no polarities, counters at 0. */
static void forget(tides_filter *f) {
    const size_t seen = f->seen ? (size_t)(f->width + 2) * (size_t)(f->height + 2) : 0;
    const int64_t *end = f->state + f->count;
    f->state[TD_FILTER_LAST] = f->state[TD_FILTER_ACTIVITY + TD_PERIOD_NUMBER] = TD_NEVER;
    f->state[TD_FILTER_ERC + TD_PERIOD_NUMBER] = TD_NEVER;
    f->state[TD_FILTER_LOW] = f->filters.activity_low_start > 0;
    for (size_t i = 0; i < seen; i++) f->seen[i] = TD_NEVER;
    for (int64_t *cell = f->cells; cell && cell < (f->trail ? f->trail : end); cell += TD_CELL)
        cell[TD_CELL_OFF] = cell[TD_CELL_ON] = TD_NEVER;
    for (int64_t *pixel = f->trail; pixel && pixel < end; pixel += TD_TRAIL) pixel[TD_TRAIL_LAST] = TD_NEVER;
}

static tides_status allocate(tides_filter *f, tides_error *error) {
    const tides_filters *p = &f->filters;
    const size_t pixels = (size_t)f->width * (size_t)f->height;
    const int32_t down = (f->height - 1) / p->afk_cell_px + 1;
    f->cells_across = (f->width - 1) / p->afk_cell_px + 1;
    const size_t seen = p->background_s > 0 ? ((size_t)f->width + 2) * ((size_t)f->height + 2) : 0;
    const size_t cells = p->afk ? (size_t)f->cells_across * (size_t)down * TD_CELL : 0,
                 trail = p->trail ? pixels * TD_TRAIL : 0;
    f->count = TD_FILTER_HEADER + seen + cells + trail;
    f->state = td_alloc(f->count, sizeof *f->state, error);
    if (!f->state) return TIDES_NO_MEMORY;
    if (seen) f->seen = f->state + TD_FILTER_HEADER;
    if (cells) f->cells = f->state + TD_FILTER_HEADER + seen;
    if (trail) f->trail = f->state + TD_FILTER_HEADER + seen + cells;
    forget(f);
    return TIDES_OK;
}

tides_status tides_filter_create(const tides_filters *given, int32_t width, int32_t height, uint64_t seed,
                                 tides_filter **filter, tides_error *error) {
    if (!given || !filter) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_filter_create: filters or filter is NULL");
    tides_filters own;
    tides_filters_defaults(&own);
    tides_status status = TD_TAKE_STRUCT(tides_filters, &own, given, error);
    if (status == TIDES_OK) status = check_numbers(&own, error);
    if (status == TIDES_OK) status = settle(&own, error);
    if (status == TIDES_OK && (width < 1 || height < 1 || width > SIDE_MAX || height > SIDE_MAX))
        status = td_fail(error, TIDES_BAD_ARGUMENT, "filters: %d x %d pixels; sides must lie in [1, %d]", (int)width,
                         (int)height, (int)SIDE_MAX);
    if (status != TIDES_OK) return status;
    tides_filter *f = td_alloc(1, sizeof *f, error);
    if (!f) return TIDES_NO_MEMORY;
    f->filters = own;
    f->width = width;
    f->height = height;
    f->seed = seed;
    f->background_ns = ns_of(own.background_s);
    f->activity_ns = ns_of(own.activity_period_s);
    f->erc_ns = ns_of(own.erc_period_s);
    f->trail_ns = ns_of(own.trail_s);
    f->afk_least_ns = ns_of(1 / own.afk_high_hz);
    f->afk_most_ns = ns_of(1 / own.afk_low_hz);
    status = allocate(f, error);
    if (status == TIDES_OK)
        *filter = f;
    else
        tides_filter_destroy(f);
    return status;
}

void tides_filter_destroy(tides_filter *filter) {
    if (!filter) return;
    free(filter->state);
    free(filter);
}

/* -- events --------------------------------------------------------------------------------------------------------------- */

typedef struct stage {
    int (*passes)(tides_filter *filter, const tides_event *event);
    int which; /* TIDES_STAGE_* */
} stage;

/* Lists the filters that are on, in order; returns their number. */
static int list_stages(const tides_filters *p, stage stages[TIDES_STAGES]) {
    const struct {
        int on;
        stage stage;
    } all[TIDES_STAGES] = {
        {p->background_s > 0, {td_filter_background, TIDES_STAGE_BACKGROUND}},
        {p->activity_low_start > 0 || p->activity_high_start > 0, {td_filter_activity, TIDES_STAGE_ACTIVITY}},
        {p->afk != TIDES_AFK_OFF, {td_filter_afk, TIDES_STAGE_AFK}},
        {p->trail != TIDES_TRAIL_OFF, {td_filter_trail, TIDES_STAGE_TRAIL}},
        {p->erc_events > 0, {td_filter_erc, TIDES_STAGE_ERC}},
    };
    int count = 0;
    for (int i = 0; i < TIDES_STAGES; i++)
        if (all[i].on) stages[count++] = all[i].stage;
    return count;
}

static tides_status check_events(const tides_filter *f, const tides_event *events, size_t count, tides_error *error) {
    int64_t last = f->state[TD_FILTER_LAST];
    for (size_t i = 0; i < count; i++) {
        const tides_event *e = &events[i];
        if (e->t < last || e->x >= f->width || e->y >= f->height || e->polarity == 0)
            return td_fail(error, TIDES_BAD_ARGUMENT,
                           "tides_filter_apply: event %zu at %lld ns, pixel (%d, %d), is out of order, outside the sensor or "
                           "of "
                           "no polarity",
                           i, (long long)e->t, e->x, e->y);
        last = e->t;
    }
    return TIDES_OK;
}

tides_status tides_filter_apply(tides_filter *filter, tides_event *events, int64_t *fired, size_t count, size_t *kept,
                                tides_error *error) {
    stage stages[TIDES_STAGES];
    const int on = list_stages(&filter->filters, stages);
    tides_status status = check_events(filter, events, count, error);
    if (status != TIDES_OK) return status;
    size_t out = 0;
    for (size_t i = 0; i < count; i++) {
        int s = 0;
        while (s < on && stages[s].passes(filter, &events[i])) s++;
        if (s < on) {
            filter->state[TD_FILTER_DROPPED + stages[s].which]++;
            continue;
        }
        events[out] = events[i];
        if (fired) fired[out] = fired[i];
        out++;
    }
    if (count > 0) filter->state[TD_FILTER_LAST] = events[count - 1].t;
    filter->state[TD_FILTER_IN] += (int64_t)count;
    *kept = out;
    return TIDES_OK;
}

void tides_filter_stats_get(const tides_filter *filter, tides_filter_stats *stats) {
    *stats = (tides_filter_stats){.in = (uint64_t)filter->state[TD_FILTER_IN]};
    stats->out = stats->in;
    for (int i = 0; i < TIDES_STAGES; i++) {
        stats->dropped[i] = (uint64_t)filter->state[TD_FILTER_DROPPED + i];
        stats->out -= stats->dropped[i];
    }
}
