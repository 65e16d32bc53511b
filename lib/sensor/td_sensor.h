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

#include "signal/td_signals.h"
#include "signal/td_step.h"
#include "td_pool.h"
#include "sensor/noise/td_additive_noise.h"
#include "sensor/noise/td_kick.h"
#include "sensor/response/td_frontend.h"
#include "sensor/noise/td_shot_noise.h"
#include "td_sensor_work.h"
#include "td_state.h"
#include "tides/sensor.h"

/* A dead pixel's thresholds: out of reach, and finite, so that 0 times them is 0. */
#define TD_OUT_OF_REACH 1e300

/* Rates of passage of additive noise, tabulated by the level's distance in sigma, from 0 on. */
enum { TD_PASSAGES = 97, TD_PASSAGES_PER_SIGMA = 12 };

/* The comparator's state of each pixel, in the simulator's order. */
typedef struct td_pixels {
    double *initial;     /* S_init (count) */
    double *reference;   /* S_ref (count): derived, but read far more often than it changes */
    uint32_t *count_on;  /* n_on   (count) */
    uint32_t *count_off; /* n_off  (count) */
} td_pixels;

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
        uint32_t *pixel;        /* the pixel's number in the image, for additive noise and kicks */
        double *origin;         /* where segment 0 begins [ns], of noise that doesn't vary: drawn once */
        td_noise_ahead *ahead;  /* these follow from the others: td_sensor_resume */
        td_noise_now *now;      /* of noise that varies */
    } segment;
    struct {
        td_carried row[TD_CARRIED_MAX];
        int count;
    } carried; /* the list of what is carried from step to step */
} td_sensor;

/* Checks the parameters of the comparator, and the model: TIDES_BAD_ARGUMENT naming the field. */
TIDES_MUST_CHECK tides_status td_sensor_check_levels(const tides_sensor *sensor, int32_t model, tides_error *error);

/* Checks the blocks' parameters, except those of filters and additive noise: TIDES_BAD_ARGUMENT naming the field. */
TIDES_MUST_CHECK tides_status td_sensor_check(const tides_sensor *sensor, tides_error *error);

/* The pixels of a sensor: those of `count` tiles, in order, of an image `width` wide. */
typedef struct td_sensor_tiles {
    const td_tile *tile;
    int32_t count, width;
} td_sensor_tiles;

/* Checks the parameters, and draws all pixels of the tiles. td_sensor_release frees. */
TIDES_MUST_CHECK tides_status td_sensor_create(const tides_sensor *given, int32_t model, double log_eps, double start,
                                               const td_sensor_tiles *tiles, td_sensor *sensor, tides_error *error);
void td_sensor_release(td_sensor *sensor);

/* Adds the arrays that a checkpoint holds: those of the list with a name. */
void td_sensor_state(td_sensor *sensor, td_state *state);

/* Computes the rest of the state, after the carried state of pixels was set from outside. */
void td_sensor_resume(const td_sensor *sensor);

/* Begins the run: pixel i has rested at log-luminance L[i], its reference is where sensor.initial puts it, and nothing has
 * fired. Pixels are shared out among the pool's threads; NULL: the caller does them all, with the same results. */
void td_sensor_begin(td_sensor *sensor, const double *L, td_pool *pool);

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

/* A time in [ns] since the run's start. */
static inline double td_sensor_time(const td_sensor *sensor, int64_t ns, double fraction) {
    return (double)(ns - sensor->start.ns) + (fraction - sensor->start.fraction);
}

#endif
