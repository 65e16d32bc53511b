/* Internal: the residual-state comparator for the pixels of one tile over one step: signals in, events out.
 *
 * A pixel fires ON where S - S_ref >= C+ and OFF where S - S_ref <= -C-; equality fires. S_ref = S_init + n_on C+ - n_off C- always
 * comes from the integer counts, so it doesn't drift. No crossing is ever lost: see td_comparator_step. */
#ifndef TD_COMPARATOR_H
#define TD_COMPARATOR_H

#include "tides/simulate.h"

/* One step (start, stop], in whole nanoseconds plus offsets. Steps lie on a grid of double seconds, start + k step_s (a product, not
 * a running sum); a double at 1000 s resolves 1e-4 ns. An event is at floor(start_fraction + s length_ns) ns after start_ns: what is
 * rounded in that is small numbers, however long the run has lasted. */
typedef struct td_step {
    int64_t start_ns, stop_ns; /* both ends, floored [ns] */
    double start_fraction;     /* what flooring took from the start [ns], in [0, 1) */
    double length_ns;          /* [ns] > 0 */
    double length_s;           /* the same [s]: h */
} td_step;

/* The step between two times [s]. The same double always becomes the same nanosecond, so that one step's stop is the next one's
 * start; a double that is a whole nanosecond to within its own rounding is that nanosecond (0.3 s isn't 299999999 ns).
 * TIDES_OUT_OF_RANGE where they aren't finite and ascending, or beyond 292 years. */
TIDES_MUST_CHECK tides_status td_step_between(double start, double stop, td_step *step, tides_error *error);

/* Time of an event at s in [0, 1], floored [ns]; at s = 1 exactly stop_ns, never beyond it. */
int64_t td_step_time(const td_step *step, double s);

typedef struct td_comparator {
    double threshold_on, threshold_off; /* C+, C- [log units] > 0 */
    int32_t model;                      /* TIDES_MODEL_* */
    int32_t max_events_per_step;        /* per pixel, >= 1 */
    int32_t exhaustive;                 /* 1: every pixel goes to the solver (tests, and to measure what the rejection saves) */
} td_comparator;

/* Checks the above: TIDES_BAD_ARGUMENT naming the field. */
TIDES_MUST_CHECK tides_status td_comparator_check(const td_comparator *comparator, tides_error *error);

/* Where a tile's pixels lie: pixel i is at (x0 + i % width, y0 + i / width). Coordinates fit 16 bits. */
typedef struct td_tile {
    int32_t x0, y0, width;
    int32_t count; /* pixels */
} td_tile;

/* Signals of a tile's pixels at both ends of the step. The secant reads no rates, only the cubic reads S1_dot: NULL is fine then. */
typedef struct td_signals {
    const double *S0;     /* [log units]   (count) */
    const double *S0_dot; /* [log units/s] (count) */
    const double *S1;     /* [log units]   (count) */
    const double *S1_dot; /* [log units/s] (count) */
} td_signals;

/* State of a tile's pixels; arrays owned by the caller. */
typedef struct td_pixels {
    double *initial;     /* S_init (count) */
    double *reference;   /* S_ref, kept because it is read far more often than it changes (count) */
    uint32_t *count_on;  /* n_on   (count) */
    uint32_t *count_off; /* n_off  (count) */
} td_pixels;

/* Puts `count` pixels at the start: reference and initial value S, nothing fired. */
void td_pixels_reset(const td_pixels *pixels, const double *S, size_t count);

/* S_ref from the counts: S_init + n_on C+ - n_off C-, with pairs of ON and OFF taken together, so that with equal thresholds a pixel
 * that comes back to a level has the very reference that it had there before. */
static inline double td_reference(const td_comparator *comparator, double initial, uint32_t count_on, uint32_t count_off) {
    double on = comparator->threshold_on, off = comparator->threshold_off;
    uint32_t pairs = count_on < count_off ? count_on : count_off;
    double unpaired = (double)(count_on - pairs) * on - (double)(count_off - pairs) * off; /* one of them is 0 */
    return initial + ((double)pairs * (on - off) + unpaired);
}

/* Growing list of events; start from zeros; free(events) when done. */
typedef struct td_event_buffer {
    tides_event *events;
    size_t count, capacity;
} td_event_buffer;

/* What happened, added to by each call. */
typedef struct td_comparator_counts {
    uint64_t events_on, events_off;
    uint64_t truncated; /* fired at the step's end because the pixel had used up max_events_per_step */
    uint64_t caught_up; /* fired at a step's end because the model had missed or wrongly predicted crossings, or at its start
                           because the signal was beyond a level already */
    uint64_t solved;    /* pixels that the rejection couldn't settle */
    uint64_t nonfinite; /* pixels with NaN or infinite signals */
} td_comparator_counts;

/* Compares one tile over one step; appends its events pixel by pixel, each pixel's in time order (td_event_sort makes a stream).
 *
 * The step is half-open, (start, stop]: a crossing at its stop belongs to it, and so has fired when the next step begins.
 *
 * 1. Events come from the local model, at the model's times, at most max_events_per_step of them per pixel.
 * 2. Then the signal at the step's end decides: while S1 - S_ref >= C+ an ON event fires at the stop, while S1 - S_ref <= -C- an OFF
 *    event. That fires what the linear model missed, takes back with the opposite polarity what it predicted and S1 denies, and fires
 *    what was cut off in 1 (as far as it hasn't cancelled). The other models end at S1, so they need it only after a cut.
 * So -C- < S1 - S_ref < C+ holds after every step, in double arithmetic as written here.
 *
 * A pixel whose signals aren't finite fires nothing by a model; it is caught up as soon as a step ends in a finite S1. One that was
 * reset to NaN or infinity has no reference, and stays silent until it is reset again. Both are counted.
 *
 * TIDES_OUT_OF_RANGE: a pixel would fire more than TD_EVENTS_PER_PIXEL_MAX events in the step. TIDES_NO_MEMORY. Then pixels, buffer
 * and counts are as before the call. */
enum { TD_EVENTS_PER_PIXEL_MAX = 1 << 20 };
TIDES_MUST_CHECK tides_status td_comparator_step(const td_comparator *comparator, const td_step *step, const td_tile *tile,
                                                 const td_signals *signals, const td_pixels *pixels, td_event_buffer *buffer,
                                                 td_comparator_counts *counts, tides_error *error);

/* The largest (S - S_ref) / C+ or (S_ref - S) / C- of `count` pixels: below 1 after a step. NaN pixels are passed over. */
double td_comparator_worst_residual(const td_comparator *comparator, const td_pixels *pixels, const double *S, size_t count);

#endif
