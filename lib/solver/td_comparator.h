/* Internal: the residual-state comparator for the pixels of one tile over one step: signals in, events out.
 *
 * A pixel fires ON where S - S_ref >= C+ and OFF where S - S_ref <= -C-; equality fires. S_ref = S_init + n_on C+ - n_off C-
 * always comes from the integer counts, so it doesn't drift. No crossing is ever lost: see td_comparator_step. */
#ifndef TD_COMPARATOR_H
#define TD_COMPARATOR_H

#include "signal/td_event_buffer.h"
#include "signal/td_step.h"
#include "tides/simulate.h"

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

/* Signals of a tile's pixels at both ends of the step. What a model doesn't read may be NULL: the secant reads no rates, only
 * the cubic reads S1_dot. */
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

/* S_ref from the counts: S_init + n_on C+ - n_off C-, with pairs of ON and OFF taken together, so that with equal thresholds
 * a pixel that comes back to a level has the very reference that it had there before. */
static inline double td_reference_of(double on, double off, double initial, uint32_t count_on, uint32_t count_off) {
    uint32_t pairs = count_on < count_off ? count_on : count_off;
    double unpaired = (double)(count_on - pairs) * on - (double)(count_off - pairs) * off; /* one of them is 0 */
    return initial + ((double)pairs * (on - off) + unpaired);
}

static inline double td_reference(const td_comparator *comparator, double initial, uint32_t count_on, uint32_t count_off) {
    return td_reference_of(comparator->threshold_on, comparator->threshold_off, initial, count_on, count_off);
}

/* What happened, added to by each call. */
typedef struct td_comparator_counts {
    uint64_t events_on, events_off;
    uint64_t truncated; /* fired at the step's end because the pixel had used up max_events_per_step */
    uint64_t caught_up; /* fired at a step's end because the model had missed or wrongly predicted crossings, or at its start
                           because the signal was beyond a level already */
    uint64_t solved;    /* pixels that the rejection couldn't settle */
    uint64_t nonfinite; /* pixels with NaN or infinite signals */
} td_comparator_counts;

/* A pixel that wants more events in one step has a signal that is no log luminance; without a limit it would fill memory. */
enum { TD_EVENTS_PER_PIXEL_MAX = 1 << 20 };

/* Compares one tile over one step; appends its events pixel by pixel, each pixel's in time order (td_event_sort makes a
 * stream). The step is half-open, (start, stop]: a crossing at its stop belongs to it, and has fired when the next one begins.
 *
 * First, events come from the local model, at the model's times, at most max_events_per_step of them per pixel. Then the signal
 * at the step's end decides: while S1 - S_ref >= C+ an ON event fires at the stop, while S1 - S_ref <= -C- an OFF event. That
 * fires what the linear model missed, takes back with the opposite polarity what it predicted and S1 denies, and fires what the
 * limit cut off (as far as it hasn't cancelled). The other models end at S1, so only a cut leaves them anything to catch up.
 * So -C- < S1 - S_ref < C+ holds after every step, in double arithmetic as written here.
 *
 * Where signals aren't finite the model fires nothing; the pixel is caught up as soon as a step ends in a finite S1. One that
 * was reset to NaN or infinity has no reference, and stays silent until it is reset again. Both are counted.
 *
 * TIDES_OUT_OF_RANGE: a pixel would fire more than TD_EVENTS_PER_PIXEL_MAX events in the step. TIDES_NO_MEMORY. Then pixels,
 * counts and the events in the buffer are as before the call. */
TIDES_MUST_CHECK tides_status td_comparator_step(const td_comparator *comparator, const td_step *step, const td_tile *tile,
                                                 const td_signals *signals, const td_pixels *pixels, td_event_buffer *buffer,
                                                 td_comparator_counts *counts, tides_error *error);

/* The largest (S - S_ref) / C+ or (S_ref - S) / C- of `count` pixels: below 1 after a step. NaN pixels are passed over. */
double td_comparator_worst_residual(const td_comparator *comparator, const td_pixels *pixels, const double *S, size_t count);

#endif
