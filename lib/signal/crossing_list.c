/* Places of many crossings at once, in loops that vectorise: all take the same number of Newton's steps. Each place is then
 * proven to have the nanosecond that a search to the last bit would give. Places without that proof, near ends of nanoseconds
 * and of pieces and where the model turns sharply, are searched for one by one. */
#include "td_crossing_list.h"

#include "td_wide.h"

static inline td_model model_of(const td_crossing_list *list, int k) {
    return (td_model){{list->control[0][k], list->control[1][k], list->control[2][k], list->control[3][k]}};
}

/* Excess of a model over a level, upwards or downwards, as a polynomial of the place. It is rounded otherwise than
 * td_level_excess, which suffices to come near a crossing. */
typedef struct beyond {
    double c0, c1, c2, c3;
} beyond;

static inline beyond beyond_of(const td_level *at, double sign) {
    const double *b = at->model->control;
    const double rise = b[1] - b[0], on = b[2] - b[1], last = b[3] - b[2];
    return (beyond){sign * (b[0] - at->reference - at->rise), sign * 3 * rise, sign * 3 * (on - rise),
                    sign * (last - on - (on - rise))};
}

static inline double excess_at(const beyond *p, double s) { return ((p->c3 * s + p->c2) * s + p->c1) * s + p->c0; }

/* A step of Halley's method from `s`, where the model is `*excess` beyond the level. */
static inline double next_place(const beyond *p, double s, double *excess) {
    const double bent = 3 * p->c3 * s + p->c2; /* half of the second derivative */
    const double slope = (bent + p->c2) * s + p->c1;
    *excess = excess_at(p, s);
    return s - *excess * slope / (slope * slope - *excess * bent);
}

/* A step of Halley's method within [*low, *high], which it narrows. A step that would leave them goes to their middle. */
static inline void go_on(const beyond *p, double *place, double *low, double *high) {
    double excess;
    const double s = *place, next = next_place(p, s, &excess);
    *high = excess > 0.0 ? s : *high;
    *low = excess > 0.0 ? *low : s;
    double best = 0.5 * (*low + *high);
    best = next <= *high ? next : best;
    *place = next >= *low ? best : 0.5 * (*low + *high);
}

/* Finds places near all crossings. Crossings of a piece don't bound each other, since levels of one direction are in order; the
 * nearer end of the piece only starts the search. Three steps are written out, or gcc 12 wouldn't vectorise. The last isn't
 * kept in its bracket, since no place outside is proven. A fourth took more time than it saved, on sharply bent pieces too. */
TD_WIDE static void solve_all(td_crossing_list *restrict list, const td_step *step) {
    const double side = TD_NEAR_ENOUGH_NS / step->length_ns, length = step->length_ns, begin = step->start_fraction;
    const int64_t start = step->start_ns, stop = step->stop_ns;
    const int count = td_whole_vectors(list->count);
    for (int k = 0; k < count; k++) {
        const td_model model = model_of(list, k);
        const td_level at = {&model, list->reference[k], list->rise[k]};
        const double sign = at.rise > 0.0 ? 1.0 : -1.0, low = list->low[k], high = list->high[k];
        const beyond p = beyond_of(&at, sign);
        double place = list->guess[k], left = low, right = high, excess;
        go_on(&p, &place, &left, &right);
        go_on(&p, &place, &left, &right);
        place = next_place(&p, place, &excess);
        const double before = place - side, after = place + side;
        const double least = 2 * td_level_rounding(&at); /* at most half of it is the polynomial's */
        double flag = before - side > low ? 1.0 : 0.0;
        flag = after + side < high ? flag : 0.0;
        const double time = td_whole(begin + place * length);
        flag = td_whole(begin + (before - side) * length) == time ? flag : 0.0;
        flag = td_whole(begin + (after + side) * length) == time ? flag : 0.0;
        flag = excess_at(&p, before) < -least ? flag : 0.0;
        flag = excess_at(&p, after) > least ? flag : 0.0;
        const int64_t t = start + td_integer(flag > 0.0 ? time : 0.0);
        list->time[k] = t < stop ? t : stop;
        list->doubtful[k] = 1.0 - flag;
    }
}

/* Searches for a crossing that wasn't proven. The search begins where the one before ended. */
static int64_t search(td_crossing_list *list, const td_step *step, int k) {
    const int first = list->first[k], from = list->searched >= first ? list->searched + 1 : first;
    double s = from > first ? list->at : list->low[k];
    for (int i = from; i <= k; i++) {
        const td_model model = model_of(list, i);
        const td_level at = {&model, list->reference[i], list->rise[i]};
        s = td_level_solve(&at, s, list->high[i], td_model_value_within(&model, list->high[i]));
    }
    list->searched = k;
    list->at = s;
    return td_step_time(step, s);
}

/* Longer steps [ns] have times that td_whole can't round down. */
#define LONGEST_NS 0x1p50

/* Fills the last vector by repeating the last crossing. */
static void fill_up(td_crossing_list *list) {
    const int last = list->count - 1;
    const double reference[TD_CROSSING_LIST_EACH] = {list->reference[last]}, guess[TD_CROSSING_LIST_EACH] = {list->guess[last]};
    td_crossing_piece piece = {.low = list->low[last], .high = list->high[last], .first = list->first[last]};
    for (int c = 0; c < 4; c++) piece.control[c] = list->control[c][last];
    for (int k = list->count; k < td_whole_vectors(list->count); k += TD_CROSSING_LIST_EACH)
        td_crossing_list_put(list, k, &piece, reference, guess, list->rise[last]);
}

void td_crossing_list_solve(td_crossing_list *list, const td_step *step) {
    const size_t count = (size_t)list->count;
    if (count == 0) return;
    fill_up(list);
    if (step->length_ns < LONGEST_NS)
        solve_all(list, step);
    else
        for (size_t k = 0; k < count; k++) list->doubtful[k] = 1;
    for (size_t k = 0; (k = td_next_mark(list->doubtful, k, count)) < count; k++) list->time[k] = search(list, step, (int)k);
}
