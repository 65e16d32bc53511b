/* Internal: the sensor: signals of a tile's pixels on a step in, events out. The comparator (paper, "Comparator and sensor
 * model"; DESIGN 3.2 to 3.4) with its blocks behind the photoreceptor's filters: mismatch, leak, refractory period, coverage
 * mask, shot noise, hot and dead pixels, additive noise. Where none of them is on, all pixels are ideal, and a faster branch of
 * the same comparator. It is for the solver, and for the baselines on frames; what lies before it (PSF, centre-surround's
 * steps) and after it (readout) is theirs.
 *
 * A pixel fires ON where S_eff - S_ref >= C+ and OFF where S_eff - S_ref <= -C-; equality fires. S_ref = S_init + n_on C+ -
 * n_off C- always comes from the integer counts, so it doesn't drift. No crossing is ever lost: see td_sensor_step. S_eff = S +
 * ramp, where ramp = leak x (time since the run's start). A pixel is re-referenced (S_init = S_eff, counts 0) where a HOLD ends
 * and at each noise event. Times of pixels are nanoseconds since the run's start, in double: 1e-4 ns at 1000 s.
 *
 * Held pixels. HOLD: nothing fires, and the reference is S_eff at the end. DROP_KEEP: nothing fires; what S_eff is beyond
 * the levels at the end fires then, one event per refractory period. DROP_CONSUME: crossings move the reference and fire
 * nothing; one at the very end fires. Noise events in the period are lost.
 *
 * Masked pixels, those with coverage below b_min, where coverage between two samples is taken to be linear: crossings are put
 * off, and noise events are lost. The reference stays. Where the pixel becomes visible again, what S_eff is beyond its levels
 * fires at that moment; what went there and back in the dark is not seen.
 *
 * Cause of a crossing: LEAK where the ramp since the pixel's last event, re-reference or consumed crossing is more than half of
 * the threshold that was crossed upwards, that is, where without it the signal hadn't come half the way; else SIGNAL. Leak from
 * before the run (STEADY) is where the pixel began, and no cause: half is of the way that was left then. */
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

/* A dead pixel's thresholds: out of reach, and finite, so that 0 of them are 0. */
#define TD_OUT_OF_REACH 1e300

/* Rates of passage, by the level's distance in sigma: at so many of them, from 0 on (td_steady.h). */
enum { TD_PASSAGES = 97, TD_PASSAGES_PER_SIGMA = 12 };

/* A pixel that wants more events in one step has a signal that is no log luminance; without a limit it would fill memory. */
enum { TD_EVENTS_PER_PIXEL_MAX = 1 << 20 };

/* The comparator's state of each pixel, in the simulator's order. */
typedef struct td_pixels {
    double *initial;     /* S_init (count) */
    double *reference;   /* S_ref, kept because it is read far more often than it changes (count) */
    uint32_t *count_on;  /* n_on   (count) */
    uint32_t *count_off; /* n_off  (count) */
} td_pixels;

/* Counts since the run's start. */
typedef struct td_sensor_counts {
    uint64_t events_on, events_off;
    uint64_t cause[TIDES_CAUSES]; /* events by TIDES_CAUSE_* */
    uint64_t truncated;           /* fired at the step's end because the pixel had used up max_events_per_step */
    uint64_t caught_up;  /* fired at a step's end because the model had missed or wrongly predicted crossings, or, in an ideal
                            pixel, at its start because the signal was beyond a level already */
    uint64_t solved;     /* pixels that the rejection couldn't settle */
    uint64_t nonfinite;  /* pixels with NaN or infinite signals */
    uint64_t suppressed; /* by the mask: crossings put off to where their pixel became visible, and noise events lost */
    uint64_t refractory; /* crossings consumed, and noise events lost, in refractory periods */
} td_sensor_counts;

/* The results of a piece of work: its events and counts. Pieces joined in their order are as one. */
typedef struct td_work {
    td_event_buffer events;
    td_sensor_counts counts;
} td_work;
TIDES_MUST_CHECK tides_status td_work_join(td_work *to, const td_work *piece, tides_error *error);
void td_work_clear(td_work *work);
void td_work_release(td_work *work);

/* An array of what pixels carry from step to step (carried.c). */
typedef struct td_carried {
    const char *name;   /* in checkpoints; NULL: it isn't in them, and follows from the rest */
    td_state_type type; /* of its values */
    void *values;       /* (count), the sensor's */
} td_carried;

/* Rows of that list: a sensor with every block has 20. One with more is refused when it is made. */
enum { TD_CARRIED_MAX = 24 };

typedef struct td_sensor {
    tides_sensor sensor;
    int on;             /* a block is on; else every pixel is ideal, and nothing of the blocks' below is there */
    int active_at_rest; /* pixels may fire where nothing moves, or are waiting for a time */
    int masks;          /* coverage is wanted */
    int labels;         /* events get what the front end added, where there is one */
    int exhaustive;     /* 1: every pixel is solved (tests, and to measure what the rejection saves); 0 as created */
    int32_t model, image_width;
    double log_eps;
    int64_t start_ns; /* the run's, floored, and what that took */
    double start_fraction;
    size_t count; /* pixels, in the simulator's order; as long are the arrays that are there */
    td_pixels pixels;
    /* the blocks' */
    double refractory_ns;
    double *threshold_on, *threshold_off; /* of each pixel */
    double *leak;                         /* [log units/ns] */
    double *held_until;                   /* end of the refractory period that is still to be dealt with; -INFINITY: none */
    double *since;                        /* last event, re-reference or consumed crossing: where the ramp's share begins */
    double *wake;                         /* the first time that the pixel must be looked at whatever its signal does */
    unsigned char *reach;                 /* 1: may have fired in this macro step (td_sensor_estimate) */
    uint64_t maps_checksum;               /* of the file of maps, whose name isn't kept in `sensor`; 0: there was none */
    double *draw;                /* in (0, 1): where the pixel's reference begins between its levels; NULL: at the signal */
    double passage[TD_PASSAGES]; /* of additive noise, where `draw` is for it: h(u) (td_steady.h) */
    td_frontend frontend;
    double *filter[TD_FRONTEND_STATE]; /* the filters' state, where there are any; the first is S at the time reached, */
    double *filter_error;              /* and what that may be off by, of a first-order one alone: the solver's (timing.c) */
    td_shot_noise noise;
    td_additive_noise additive;
    td_kick kick;
    double *noise_segment, *noise_value; /* with it: number and begin [log units] of the segment that the time reached is on, */
    double *noise_light;                 /* the log-luminance where that began, of noise that goes with light, */
    uint32_t *number;                    /* and the pixel's in the image */
    td_carried carry[TD_CARRIED_MAX];    /* the list of what is carried, */
    int carried;                         /* so many rows */
} td_sensor;

/* Checks what the comparator reads of the parameters, and the model: TIDES_BAD_ARGUMENT naming the field. */
TIDES_MUST_CHECK tides_status td_sensor_check_levels(const tides_sensor *sensor, int32_t model, tides_error *error);

/* Checks the blocks' parameters, but for their filters and additive noise (td_frontend_make, td_additive_noise_make):
 * TIDES_BAD_ARGUMENT naming the field. */
TIDES_MUST_CHECK tides_status td_sensor_check(const tides_sensor *sensor, tides_error *error);

/* Draws all pixels of the `tiles` (in order, one after the other) of an image `image_width` wide, after these checks.
 * td_sensor_release frees. */
TIDES_MUST_CHECK tides_status td_sensor_create(const tides_sensor *given, int32_t model, double log_eps, double start,
                                               int32_t image_width, const td_tile *tiles, int32_t tile_count, td_sensor *sensor,
                                               tides_error *error);
void td_sensor_release(td_sensor *sensor);

/* Lists what pixels carry; once, when all arrays are there (carried.c). */
TIDES_MUST_CHECK tides_status td_sensor_list(td_sensor *sensor, tides_error *error);

/* Adds the arrays that a checkpoint holds: those of the list with a name. */
void td_sensor_state(td_sensor *sensor, td_state *state);

/* The run's start: pixel i has rested at log-luminance L[i], its reference is where sensor.initial puts it, and nothing has
 * fired. */
void td_sensor_begin(td_sensor *sensor, const double *L);

/* Where a pixel stands that has rested at log-luminance L (initial.c): its signal less its reference, how long ago it was last
 * reset, and how long it is still held [ns], all 0 where references begin at the signal. */
typedef struct td_initial {
    double offset, age, held;
} td_initial;
td_initial td_sensor_initial(const td_sensor *sensor, size_t pixel, double L);

/* Draws the random numbers of td_sensor_initial, when all else of the sensor is there. */
tides_status td_sensor_draw_initial(td_sensor *sensor, const td_tile *tiles, int32_t tile_count, tides_error *error);

/* Sets the reference of a pixel that was at L and has done nothing yet; where td_sensor_shows_signal. */
void td_sensor_refer(td_sensor *sensor, size_t pixel, double L);

/* Coverage of a tile's pixels at both ends of the step, in [0, 1]; read only where sensor->masks. */
typedef struct td_coverage {
    const double *begin, *end; /* (count) */
} td_coverage;

/* The inputs of a tile's pixels at both ends of a step. */
typedef struct td_seen {
    const td_signals *signals;
    const td_signals *light; /* log-luminance, where the signals aren't; NULL: they are */
    td_coverage coverage;
} td_seen;

/* Compares one tile over one step; appends its events pixel by pixel, each pixel's in time order (td_event_sort makes a
 * stream). Pixel i of the tile is pixel first + i of the sensor. `step` is as the simulator has it: half-open, (start, stop];
 * events are at start_ns to stop_ns, both included, and no other step has one of these nanoseconds. A crossing at its stop
 * belongs to it, and has fired when the next one begins.
 *
 * First, events come from the local model (behind filters, from their response to it), at its times, at most
 * max_events_per_step of them per pixel. Then the signal at the step's end decides: while S_eff - S_ref >= C+ an ON event fires
 * at the stop, while S_eff - S_ref <= -C- an OFF event. That fires what the linear model missed, takes back with the opposite
 * polarity what it predicted and S1 denies, and fires what the limit cut off (as far as it hasn't cancelled). The other models
 * end at S1, so only a cut leaves them anything to catch up. So -C- < S_eff - S_ref < C+ holds of every pixel that isn't held
 * or masked after every step, in double arithmetic as written here.
 *
 * Where signals aren't finite the model fires nothing; the pixel is caught up as soon as a step ends in a finite S1. One that
 * began at NaN or infinity has no reference, and stays silent. Both are counted.
 *
 * TIDES_OUT_OF_RANGE: a pixel would fire more than TD_EVENTS_PER_PIXEL_MAX events in the step. TIDES_NO_MEMORY. Then counts and
 * the events in the buffer are as before the call, and so are ideal pixels; the others are not. */
TIDES_MUST_CHECK tides_status td_sensor_step(td_sensor *sensor, const td_step *step, const td_tile *tile, size_t first,
                                             const td_seen *seen, td_work *work, tides_error *error);

/* -- one pixel at a time --------------------------------------------------------------------------------------------------- */

/* For the solver, which looks the signal up where events are, and compares those pixels again (lib/solver/lookup/solve.c).
 * Where optics, filters, a surround, additive noise or kicks stand between signal and comparator, what is done where isn't
 * seen in the signal: whether none of them is on, of parameters that are checked by it. */
TIDES_MUST_CHECK tides_status td_sensor_shows_signal(const tides_sensor *params, int *shows, tides_error *error);

/* Where a pixel's reference changed in a step. */
typedef struct td_change {
    double s;         /* 1: at the step's end, as the signal there asked for, too */
    double reference; /* from then on */
    int8_t polarity;  /* of the crossing; 0: it was taken from the signal */
    int8_t fired;     /* the crossing is an event, the last one in the buffer by then */
} td_change;

/* Changes in order of time. A change without room is lost, and counted; its time is the model's. */
enum { TD_CHANGES_MAX = 96 };
typedef struct td_changes {
    int count, lost;
    td_change change[TD_CHANGES_MAX];
} td_changes;

/* active[i] becomes 1 where pixel i of the tile may do something in the step, its signal being off by widen[i] at most between
 * the step's ends; what is 1 stays. The others are at the step's end then. */
void td_sensor_find(const td_sensor *sensor, const td_step *step, const td_tile *tile, size_t first, const td_signals *signals,
                    const double *widen, uint8_t *active);

/* reaches[i] becomes 0 where no level is within the signal's range in the step, so widened, whatever the pixel has fired
 * before: all its levels are reference + n C. With blocks, or thresholds that differ, all become 1. */
void td_sensor_reaches(const td_sensor *sensor, const td_step *step, const td_tile *tile, size_t first,
                       const td_signals *signals, const double *widen, uint8_t *reaches);

/* td_sensor_step of one pixel at (x, y), on these pieces between the signals at the step's ends, which get its leak's ramp;
 * `changes` says what it did. On failure the pixel is in between. */
typedef struct td_sensor_single {
    const td_step *step;
    size_t pixel; /* the sensor's */
    int32_t x, y;
    const td_ends *ends;
    td_coverage coverage; /* the pixel's, read only where sensor->masks */
    td_pieces *pieces;
    td_changes *changes;
} td_sensor_single;
TIDES_MUST_CHECK tides_status td_sensor_advance(td_sensor *sensor, const td_sensor_single *single, td_work *work,
                                                tides_error *error);

/* All that a pixel carries from one step to the next, to take it back to where it was: a word for each row of the list. */
typedef struct td_kept_pixel {
    uint64_t word[TD_CARRIED_MAX];
    int words;
} td_kept_pixel;
void td_sensor_keep(const td_sensor *sensor, size_t pixel, td_kept_pixel *kept);
void td_sensor_put_back(td_sensor *sensor, size_t pixel, const td_kept_pixel *kept);

/* [ns] since the run's start. */
static inline double td_sensor_time(const td_sensor *sensor, int64_t ns, double fraction) {
    return (double)(ns - sensor->start_ns) + (fraction - sensor->start_fraction);
}

/* -- between steps --------------------------------------------------------------------------------------------------------- */

/* The value that a pixel compares with its levels at `time` [ns since the run's start], the time reached, where its
 * log-luminance is L. */
double td_sensor_signal(const td_sensor *sensor, size_t pixel, double L, double time);

/* A pixel's own thresholds; without blocks that are on it has the nominal ones. */
static inline double td_sensor_threshold_on(const td_sensor *sensor, size_t pixel) {
    return sensor->on ? sensor->threshold_on[pixel] : sensor->sensor.threshold_on;
}
static inline double td_sensor_threshold_off(const td_sensor *sensor, size_t pixel) {
    return sensor->on ? sensor->threshold_off[pixel] : sensor->sensor.threshold_off;
}

/* The smaller of the nominal thresholds, of which limits of errors are shares. */
static inline double td_sensor_least_threshold(const tides_sensor *sensor) {
    return sensor->threshold_on < sensor->threshold_off ? sensor->threshold_on : sensor->threshold_off;
}

/* The levels of a tile's pixels: thresholds of pixel i at [i x stride], with stride 0 those of all; references when the step is
 * over. The leak's ramp is added to the signal. */
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

/* The largest (S_eff - S_ref) / C+ or (S_ref - S_eff) / C- of the pixels that answer to their levels at time `time`, which have
 * log-luminances L and, read only where sensor->masks, coverages: below 1 after a step. NaN pixels are passed over. */
double td_sensor_worst_residual(const td_sensor *sensor, const double *L, const double *coverage, double time);

/* S_ref from the counts: S_init + n_on C+ - n_off C-, with pairs of ON and OFF taken together, so that with equal thresholds
 * a pixel that comes back to a level has the very reference that it had there before. */
static inline double td_reference_at(double on, double off, double initial, double count_on, double count_off) {
    const double pairs = count_on < count_off ? count_on : count_off;
    const double unpaired = (count_on - pairs) * on - (count_off - pairs) * off; /* one of them is 0 */
    return initial + (pairs * (on - off) + unpaired);
}
static inline double td_reference_of(double on, double off, double initial, uint32_t count_on, uint32_t count_off) {
    return td_reference_at(on, off, initial, count_on, count_off);
}

/* The segment of the additive noise, where it is on, that the time reached is on. */
td_noise_segment td_sensor_noise_segment(const td_sensor *sensor, size_t pixel);

/* The additive noise and the kicks at a time [ns since the run's start] that isn't before the time reached; 0 without. */
double td_sensor_noise_at(const td_sensor *sensor, size_t pixel, double time);

/* Computes the rest of the state, after the carried state of pixels was set from outside. */
void td_sensor_resume(td_sensor *sensor);

/* The time of the pixel's next wake-up, after any of its parts changed. */
void td_sensor_set_wake(td_sensor *sensor, size_t pixel);

#endif
