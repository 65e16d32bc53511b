/* A trial: one random scene, the library's run of it and the oracle's events; and sums over many trials. */
#ifndef TESTS_ORACLE_TRIAL_H
#define TESTS_ORACLE_TRIAL_H

#include "tests/oracle/verdict.h"

typedef struct trial_options {
    const char *device;
    tides_stepping stepping;
    int dump, finer, images, brute; /* finer: factor on samples; images: number of times; brute: of pixels */
    int coded;                      /* 1: colours are coded as sRGB */
    double share;                   /* factor on images' width */
} trial_options;

typedef struct trial_result {
    verdict v;
    int kind, failed; /* failed: the library refused, or ended with an error */
    unsigned long long seed;
} trial_result;

/* All defaults. */
trial_options trial_defaults(void);

/* Runs `count` scenes, with seeds from `seed` on: all kinds in turn, or one (kind >= 0). They run in `jobs` processes, which
 * are started before any has a device; each scene prints a line. Returns the number of results, which is less than count if
 * a process died. */
int trial_run_all(const trial_options *options, int kind, unsigned long long seed, int count, int jobs, trial_result *results);

/* Prints a line for each criterion over all scenes, then "N passed, N failed"; returns the number that failed. */
int trial_sum_up(const trial_options *options, const trial_result *results, int count);

#endif
