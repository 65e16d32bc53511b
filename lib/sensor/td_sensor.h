/* Internal: the sensor: signals of a tile's pixels on a step in, events out. It is the comparator (paper, "Comparator and
 * sensor model"; DESIGN 3.2 to 3.4) with blocks behind the photoreceptor's filters: mismatch, leak, refractory period, coverage
 * mask, shot noise, hot and dead pixels, additive noise. Where none of them is on, all pixels are ideal, and a faster branch of
 * the same comparator is used. The solver uses it, and the baselines on frames. These add PSF and centre-surround before it,
 * and the readout after it.
 *
 * A pixel fires ON where S_eff - S_ref >= C+ and OFF where S_eff - S_ref <= -C-; equality fires. S_ref = S_init + n_on
 * C+ - n_off C- always comes from the integer counts, so it doesn't drift. No crossing is ever lost: see td_sensor_step.
 * S_eff = S + ramp, where ramp = leak x (time since the run's start). A pixel is re-referenced (S_init = S_eff, counts 0) where
 * a HOLD ends and at each noise event. Times of pixels are nanoseconds since the run's start, in double: 1e-4 ns at 1000 s.
 *
 * Held pixels. HOLD: nothing fires, and the reference is S_eff at the end. DROP_KEEP: nothing fires; if S_eff is beyond levels
 * at the end, events fire then, one per refractory period. DROP_CONSUME: crossings move the reference and fire nothing; one at
 * the very end fires. Noise events in the period are lost.
 *
 * Masked pixels have a coverage below b_min, where coverage between two samples is taken to be linear. Crossings are put off,
 * and noise events are lost. The reference stays. Where the pixel becomes visible again, events fire for the levels that S_eff
 * is beyond at that moment. A signal that went there and back in the dark isn't seen.
 *
 * Cause of a crossing. It is LEAK where without the ramp the signal hadn't come half the way: the ramp since the pixel's last
 * event, re-reference or consumed crossing is more than half of the threshold that was crossed upwards. Else it is SIGNAL. Leak
 * from before the run (STEADY) has set where the pixel began, and is no cause: half is then of the way that was left. */
#ifndef TD_SENSOR_H
#define TD_SENSOR_H

#include "signal/td_event_buffer.h"
#include "signal/td_pieces.h"
#include "signal/td_signals.h"
#include "signal/td_step.h"
#include "sensor/noise/td_additive_noise.h"
#include "sensor/noise/td_kick.h"
#include "sensor/response/td_frontend.h"
#include "sensor/noise/td_shot_noise.h"
#include "td_state.h"
#include "tides/sensor.h"

/* A dead pixel's thresholds: out of reach, and finite, so that 0 times them is 0. */
#define TD_OUT_OF_REACH 1e300

/* Rates of passage of additive noise, tabulated by the level's distance in sigma, from 0 on. */
enum { TD_PASSAGES = 97, TD_PASSAGES_PER_SIGMA = 12 };

/* Greatest number of events of a pixel in a step: a signal that asks for more is no log-luminance, and would fill the
 * memory. */
enum { TD_EVENTS_PER_PIXEL_MAX = 1 << 20 };

/* The comparator's state of each pixel, in the simulator's order. */
typedef struct td_pixels {
    double *initial;     /* S_init (count) */
    double *reference;   /* S_ref (count): derived, but read far more often than it changes */
    uint32_t *count_on;  /* n_on   (count) */
    uint32_t *count_off; /* n_off  (count) */
} td_pixels;

/* Counts since the run's start. */
typedef struct td_sensor_counts {
    uint64_t events_on, events_off;
    uint64_t cause[TIDES_CAUSES]; /* events by TIDES_CAUSE_* */
    uint64_t truncated;           /* fired at the step's end because max_events_per_step was reached */
    uint64_t caught_up;           /* fired at a step's end because the model's crossings were wrong, or, in an ideal
                            pixel, at its start because the signal was beyond a level already */
    uint64_t solved;              /* pixels that couldn't be passed over in a block */
    uint64_t nonfinite;           /* pixels with NaN or infinite signals */
    uint64_t suppressed;          /* by the mask: crossings put off until their pixel is visible, and noise events lost */
    uint64_t refractory;          /* crossings consumed, and noise events lost, in refractory periods */
} td_sensor_counts;

/* The results of a piece of work: events and counts. Pieces joined in order equal one piece. */
typedef struct td_work {
    td_event_buffer events;
    td_sensor_counts counts;
} td_work;
TIDES_MUST_CHECK tides_status td_work_join(td_work *to, const td_work *piece, tides_error *error);
void td_work_clear(td_work *work);
void td_work_release(td_work *work);

/* Bounds of a pixel's additive noise from the time reached up to `until_ns`. */
typedef struct td_noise_ahead {
    double low, high, until_ns;
} td_noise_ahead;

/* An array of values that pixels carry from step to step. */
typedef struct td_carried {
    const char *name;   /* in checkpoints; NULL: not saved, since it follows from the rest */
    td_state_type type; /* of its values */
    void *values;       /* (count), the sensor's */
} td_carried;

/* Most rows of that list: a sensor with every block has 20. A sensor with more is refused. */
enum { TD_CARRIED_MAX = 24 };

typedef struct td_sensor {
    tides_sensor sensor;
    int on;             /* a block is on; else every pixel is ideal, and arrays of blocks aren't allocated */
    int active_at_rest; /* pixels may fire where nothing moves, or wait for a time */
    int masks;          /* coverage is needed */
    int labels;         /* events get the delay that the front end added, where there is one */
    int exhaustive;     /* 1: every pixel is solved (for tests, and to measure what passing over saves) */
    int32_t model, image_width;
    double log_eps;
    struct {
        int64_t ns; /* the run's start, rounded down, and the rest */
        double fraction;
    } start;
    size_t count; /* pixels, in the simulator's order; the length of arrays */
    td_pixels pixels;
    /* of the blocks */
    double refractory_ns;
    double *threshold_on, *threshold_off; /* (count) own thresholds */
    double *leak;                         /* [log units/ns] */
    double *held_until;                   /* end of the refractory period, until it has been handled; -INFINITY: none */
    double *since;        /* last event, re-reference or consumed crossing: the ramp's share of a crossing counts from there */
    double *wake;         /* the first time at which the pixel must be handled whatever its signal does */
    unsigned char *reach; /* 1: may have fired in this macro step, for estimates */
    uint64_t maps_checksum; /* of the file of maps; 0: there was none */
    struct {
        double *draw; /* (count) in (0, 1): places the first reference between the levels; NULL: at the signal */
        float log_passage[TD_PASSAGES]; /* logarithms of hazards h(u) of additive noise, for `draw` */
    } first;
    td_frontend frontend;
    struct {
        double *state[TD_FRONTEND_STATE]; /* state of the filters; the first is S at the time reached */
        double *error;                    /* and the error of S, of a first-order filter only: the solver's */
    } filtered;
    td_shot_noise noise;
    td_additive_noise additive;
    td_kick kick;
    struct {
        double *number, *value; /* additive noise's segment at the time reached: its number, value at its begin [log units], */
        double *light;          /* and log-luminance there, of noise that depends on light */
        td_noise_ahead *ahead;  /* these follow from the others: td_sensor_resume */
        td_noise_now *now;      /* of noise that varies */
    } segment;
    uint32_t *number; /* the pixel's number in the image, for additive noise */
    struct {
        td_carried row[TD_CARRIED_MAX];
        int count;
    } carried; /* the list of what is carried from step to step */
} td_sensor;

/* Checks the parameters of the comparator, and the model: TIDES_BAD_ARGUMENT naming the field. */
TIDES_MUST_CHECK tides_status td_sensor_check_levels(const tides_sensor *sensor, int32_t model, tides_error *error);

/* Checks the blocks' parameters, except those of filters and additive noise: TIDES_BAD_ARGUMENT naming the field. */
TIDES_MUST_CHECK tides_status td_sensor_check(const tides_sensor *sensor, tides_error *error);

/* Checks the parameters, and draws all pixels of the `tiles` (in order, one after the other) of an image `image_width` wide.
 * td_sensor_release frees. */
TIDES_MUST_CHECK tides_status td_sensor_create(const tides_sensor *given, int32_t model, double log_eps, double start,
                                               int32_t image_width, const td_tile *tiles, int32_t tile_count, td_sensor *sensor,
                                               tides_error *error);
void td_sensor_release(td_sensor *sensor);

/* Makes the list of what pixels carry, when all arrays exist. */
TIDES_MUST_CHECK tides_status td_sensor_list(td_sensor *sensor, tides_error *error);

/* Adds the arrays that a checkpoint holds: those of the list with a name. */
void td_sensor_state(td_sensor *sensor, td_state *state);

/* Begins the run: pixel i has rested at log-luminance L[i], its reference is where sensor.initial puts it, and nothing has
 * fired. */
void td_sensor_begin(td_sensor *sensor, const double *L);

/* The state of a pixel that has rested at log-luminance L: its signal less its reference, the time since its last reset, and
 * how long it is still held [ns]. All are 0 where references begin at the signal. */
typedef struct td_initial {
    double offset, age, held;
} td_initial;
td_initial td_sensor_initial(const td_sensor *sensor, size_t pixel, double L);

/* Draws the random numbers of td_sensor_initial, when the rest of the sensor exists. */
tides_status td_sensor_draw_initial(td_sensor *sensor, const td_tile *tiles, int32_t tile_count, tides_error *error);

/* Sets the reference of a pixel that had log-luminance L and has done nothing yet, if td_sensor_shows_signal. */
void td_sensor_refer(const td_sensor *sensor, size_t pixel, double L);

/* 1 where td_seen.light is read: the log-luminance, where the signal is another, decides about noise or is labelled. */
int td_sensor_wants_light(const td_sensor *sensor);

/* Coverage of a tile's pixels at both ends of the step, in [0, 1]; read only where sensor->masks. */
typedef struct td_coverage {
    const double *begin, *end; /* (count) */
} td_coverage;

/* The inputs of a tile's pixels at both ends of a step. */
typedef struct td_seen {
    const td_signals *signals;
    const td_signals *light; /* log-luminance, where the signals aren't; NULL: they are, or td_sensor_wants_light is 0 */
    td_coverage coverage;
} td_seen;

/* Compares one tile over one step; appends its events pixel by pixel, each pixel's in time order (td_event_sort makes a
 * stream). Pixel i of the tile is pixel first + i of the sensor. `step` is half-open, (start, stop]: events are at start_ns to
 * stop_ns, both included, and no other step has one of these nanoseconds. A crossing at its stop belongs to it, and has fired
 * when the next one begins.
 *
 * First, events come from the local model (behind filters, from their response to it), at most max_events_per_step of them per
 * pixel. Then the signal at the step's end decides: while S_eff - S_ref >= C+ an ON event fires at the stop, while
 * S_eff - S_ref <= -C- an OFF event. That fires crossings that the linear model missed, takes back with the opposite polarity
 * those that it predicted and S1 denies, and fires those that the limit cut off (as far as they haven't cancelled). The other
 * models end at S1, so only the limit leaves them anything to catch up. So -C- < S_eff - S_ref < C+ holds for every pixel that
 * isn't held or masked after every step, in double arithmetic as written here.
 *
 * Where signals aren't finite the model fires nothing; the pixel is caught up as soon as a step ends in a finite S1. A pixel
 * that began at NaN or infinity has no reference, and stays silent. Both are counted.
 *
 * TIDES_OUT_OF_RANGE: a pixel would fire more than TD_EVENTS_PER_PIXEL_MAX events in the step. TIDES_NO_MEMORY. Then counts and
 * the events in the buffer are as before the call, and so are ideal pixels; the others are not. */
TIDES_MUST_CHECK tides_status td_sensor_step(const td_sensor *sensor, const td_step *step, const td_tile *tile, size_t first,
                                             const td_seen *seen, td_work *work, tides_error *error);

/* -- one pixel at a time --------------------------------------------------------------------------------------------------- */

/* *shows becomes 1 where a signal alone tells what its comparator does. Then the solver looks the signal up where events are,
 * and compares those pixels again. It is 0 with optics, filters, a surround, additive noise or kicks between signal and
 * comparator. The parameters are checked, too. */
TIDES_MUST_CHECK tides_status td_sensor_shows_signal(const tides_sensor *params, int *shows, tides_error *error);

/* Where a pixel's reference changed in a step. */
typedef struct td_change {
    double s;         /* 1: at the step's end, also if the signal there asked for it */
    double reference; /* after the change */
    int8_t polarity;  /* of the crossing; 0: the reference was taken from the signal */
    int8_t fired;     /* 1: the crossing is an event, the last one in the buffer at that moment */
} td_change;

/* Changes in order of time. If there is no room, a change is only counted, and its time stays the model's. */
enum { TD_CHANGES_MAX = 96 };
typedef struct td_changes {
    int count, lost;
    td_change change[TD_CHANGES_MAX];
} td_changes;

/* Sets active[i] to 1 where pixel i of the tile may do something in the step, if its signal is off by up to widen[i] between
 * the step's ends. Entries that are 1 stay 1. The other pixels then have their state at the step's end. */
void td_sensor_find(const td_sensor *sensor, const td_step *step, const td_tile *tile, size_t first, const td_signals *signals,
                    const double *widen, uint8_t *active);

/* Sets reaches[i] to 0 where no level is within the signal's range in the step, widened likewise, whatever the pixel has fired
 * before: all its levels are reference + n C. With blocks, or with unequal thresholds, all become 1. */
void td_sensor_reaches(const td_sensor *sensor, const td_step *step, const td_tile *tile, size_t first,
                       const td_signals *signals, const double *widen, uint8_t *reaches);

/* One pixel at (x, y) over a step, by these pieces between the signals at the step's ends. The pieces get its leak's ramp;
 * `changes` tells what it did. On failure the pixel's state is undefined. */
typedef struct td_sensor_single {
    const td_step *step;
    size_t pixel; /* number in the sensor */
    int32_t x, y;
    const td_ends *ends;
    td_coverage coverage; /* the pixel's; used only where sensor->masks */
    td_pieces *pieces;
    td_changes *changes;
} td_sensor_single;
TIDES_MUST_CHECK tides_status td_sensor_advance(const td_sensor *sensor, const td_sensor_single *single, td_work *work,
                                                tides_error *error);

/* All state that a pixel carries from one step to the next, to put it back: a word for each row of the list. */
typedef struct td_kept_pixel {
    uint64_t word[TD_CARRIED_MAX];
    int words;
} td_kept_pixel;
void td_sensor_keep(const td_sensor *sensor, size_t pixel, td_kept_pixel *kept);
void td_sensor_put_back(const td_sensor *sensor, size_t pixel, const td_kept_pixel *kept);

/* A time in [ns] since the run's start. */
static inline double td_sensor_time(const td_sensor *sensor, int64_t ns, double fraction) {
    return (double)(ns - sensor->start.ns) + (fraction - sensor->start.fraction);
}

/* -- between steps --------------------------------------------------------------------------------------------------------- */

/* The value that a pixel compares with its levels at `time` [ns since the run's start], the time reached, if its log-luminance
 * is L. */
double td_sensor_signal(const td_sensor *sensor, size_t pixel, double L, double time);

/* A pixel's own thresholds, which are the nominal ones if no block is on. */
static inline double td_sensor_threshold_on(const td_sensor *sensor, size_t pixel) {
    return sensor->on ? sensor->threshold_on[pixel] : sensor->sensor.threshold_on;
}
static inline double td_sensor_threshold_off(const td_sensor *sensor, size_t pixel) {
    return sensor->on ? sensor->threshold_off[pixel] : sensor->sensor.threshold_off;
}

/* The smaller of the nominal thresholds: limits of errors are shares of it. */
static inline double td_sensor_least_threshold(const tides_sensor *sensor) {
    return sensor->threshold_on < sensor->threshold_off ? sensor->threshold_on : sensor->threshold_off;
}

/* The levels of a tile's pixels: thresholds of pixel i at [i x stride] (stride 0: one for all), and references after the step.
 * The leak's ramp is added to the signal. */
typedef struct td_levels {
    const double *threshold_on, *threshold_off, *reference;
    int stride;
    const double *leak; /* [log units/ns]; NULL: none */
    double time;        /* when the step begins [ns since the run's start] */
} td_levels;

/* The levels of a tile that begins at pixel `first`, after its step. */
td_levels td_sensor_levels(const td_sensor *sensor, const td_step *step, size_t first);

/* 1 where the ends of refractory periods re-reference pixels. */
static inline int td_sensor_holds(const td_sensor *sensor) {
    return sensor->sensor.refractory_law == TIDES_REFRACTORY_HOLD && sensor->refractory_ns > 0;
}

/* The largest (S_eff - S_ref) / C+ or (S_ref - S_eff) / C- of the pixels that aren't held or masked at `time`, for
 * log-luminances L and coverages (used only where sensor->masks). It is below 1 after a step. NaN is left out. */
double td_sensor_worst_residual(const td_sensor *sensor, const double *L, const double *coverage, double time);

/* S_ref from the counts: S_init + n_on C+ - n_off C-. Pairs of ON and OFF are taken together, so that with equal thresholds a
 * pixel that returns to a level has the same reference there, to the bit. */
static inline double td_reference_at(double on, double off, double initial, double count_on, double count_off) {
    const double pairs = count_on < count_off ? count_on : count_off;
    const double unpaired = (count_on - pairs) * on - (count_off - pairs) * off; /* one of them is 0 */
    return initial + (pairs * (on - off) + unpaired);
}
static inline double td_reference_of(double on, double off, double initial, uint32_t count_on, uint32_t count_off) {
    return td_reference_at(on, off, initial, count_on, count_off);
}

/* The segment of the additive noise that contains the time reached. */
td_noise_segment td_sensor_noise_segment(const td_sensor *sensor, size_t pixel);

/* Makes that the pixel's segment. */
void td_sensor_put_segment(const td_sensor *sensor, size_t pixel, const td_noise_segment *segment);

/* Computes what follows from the pixel's segment. */
void td_sensor_resume_noise(const td_sensor *sensor, size_t pixel);

/* The sum of additive noise and kicks at a time [ns since the run's start], not before the time reached; 0 without them. */
double td_sensor_noise_at(const td_sensor *sensor, size_t pixel, double time);

/* Computes the rest of the state, after the carried state of pixels was set from outside. */
void td_sensor_resume(const td_sensor *sensor);

/* Sets the time of the pixel's next wake-up, after any of its parts changed. */
void td_sensor_set_wake(const td_sensor *sensor, size_t pixel);

#endif
