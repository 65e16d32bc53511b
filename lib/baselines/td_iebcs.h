/* Internal: parts of IEBCS: its measured noise, and its readout arbiters. */
#ifndef TD_IEBCS_H
#define TD_IEBCS_H

#include "td_baseline.h"

/* Noise events of one polarity: periodic at one rate, or with periods drawn from measured histograms. */
typedef struct td_iebcs_noise {
    double *next;     /* (pixels) time of each pixel's next event [us]; infinite without noise */
    double period;    /* [us]; infinite without noise */
    double *chance;   /* cumulative probabilities, a row of TD_IEBCS_BINS per measured pixel; NULL: only `period` */
    size_t rows;      /* rows of `chance` */
    uint64_t *draws;  /* (pixels) */
    uint64_t purpose; /* distinguishes the random numbers of the polarities */
} td_iebcs_noise;

/* Bins of IEBCS's histograms: 1 to 9 times 10^-3 to 10^4 Hz. */
enum { TD_IEBCS_BINS = 72 };

/* Makes noise of `rate` [Hz] with random phases for every pixel or, if `file` isn't NULL, from the file's histograms. */
tides_status td_iebcs_noise_make(const tides_baseline *baseline, const char *file, double rate, int polarity,
                                 td_iebcs_noise *noise, tides_error *error);
void td_iebcs_noise_free(td_iebcs_noise *noise);

/* Time from a pixel's noise event to its next one [us]. */
double td_iebcs_noise_period(const tides_baseline *baseline, td_iebcs_noise *noise, size_t i);

/* Events that wait for readout, and the arbiter's clock. */
typedef struct td_arbiter {
    td_event_buffer waiting; /* in order of time; polarity 0 marks events already read out */
    size_t next;             /* the first event that still waits */
    tides_event *scratch;
    size_t scratch_events;
    double clock_us; /* time up to which the readout has worked */
    int32_t row;     /* next row of the synchronous arbiter */
} td_arbiter;

/* Takes the events of baseline->made from `first` on. Puts back those that are read out between `start_us` and `stop_us`,
 * with the times of readout; the others wait. */
tides_status td_arbiter_run(tides_baseline *baseline, td_arbiter *arbiter, size_t first, double start_us, double stop_us,
                            tides_error *error);
void td_arbiter_free(td_arbiter *arbiter);

#endif
