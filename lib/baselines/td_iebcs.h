/* Internal: the parts of IEBCS: measured noise, arbiters. */
#ifndef TD_IEBCS_H
#define TD_IEBCS_H

#include "td_baseline.h"

/* Noise events of one polarity: periodic at one rate, or with periods drawn from measured histograms. */
typedef struct td_iebcs_noise {
    double *next;     /* each pixel's next event [us], infinite without noise (pixels) */
    double period;    /* [us]; infinite without noise */
    double *chance;   /* cumulative, one row of TD_IEBCS_BINS per measured pixel; NULL: `period` is all */
    size_t rows;      /* of it */
    uint64_t *draws;  /* (pixels) */
    uint64_t purpose; /* keeps the polarities' random numbers apart */
} td_iebcs_noise;

/* Bins of IEBCS's histograms: 1 to 9 times 10^-3 to 10^4 Hz. */
enum { TD_IEBCS_BINS = 72 };

/* `rate` [Hz] for every pixel with random phases, or with `file` (nullable) what its histograms say. */
tides_status td_iebcs_noise_make(const tides_baseline *baseline, const char *file, double rate, int polarity,
                                 td_iebcs_noise *noise, tides_error *error);
void td_iebcs_noise_free(td_iebcs_noise *noise);

/* From a pixel's noise event to the next [us]. */
double td_iebcs_noise_period(const tides_baseline *baseline, td_iebcs_noise *noise, size_t i);

/* Events that wait for the readout, and the arbiter's clock. */
typedef struct td_arbiter {
    td_event_buffer waiting; /* by time; entries with polarity 0 are deleted ones */
    size_t next;             /* the first that isn't gone */
    tides_event *scratch;
    size_t scratch_events;
    double clock_us; /* the time that the readout has reached */
    int32_t row;     /* the synchronous arbiter's next */
} td_arbiter;

/* Takes the events of baseline->made from `first` on, and puts what is read out between `start_us` and `stop_us` there, with
 * the times of the readout. The rest waits. */
tides_status td_arbiter_run(tides_baseline *baseline, td_arbiter *arbiter, size_t first, double start_us, double stop_us,
                            tides_error *error);
void td_arbiter_free(td_arbiter *arbiter);

#endif
