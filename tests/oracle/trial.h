/* A trial: one random scene, the library's run of it and the oracle's events; and sums over many trials. */
#ifndef TESTS_ORACLE_TRIAL_H
#define TESTS_ORACLE_TRIAL_H

#include "tests/oracle/verdict.h"

typedef struct trial_options {
    const char *device;
    tides_stepping stepping;
    int dump, finer, images, brute; /* brute: so many pixels */
    int coded;                      /* colours are sRGB's */
    double share;                   /* of a kind's width */
} trial_options;

typedef struct trial_result {
    verdict v;
    int kind, failed; /* failed: the library refused, or ended with an error */
    unsigned long long seed;
} trial_result;

/* All defaults. */
trial_options trial_defaults(void);

/* Scenes [0, count): all kinds in turn, or one (`kind` not below 0), from a seed on; in `jobs` processes, which are started
 * before any has a device. Each prints its line. How many of the results (count) are there: all but where a process died. */
int trial_run_all(const trial_options *options, int kind, unsigned long long seed, int count, int jobs, trial_result *results);

/* The criteria of issue 38 over all scenes, a line for each; and "N passed, N failed". How many failed. */
int trial_sum_up(const trial_options *options, const trial_result *results, int count);

#endif
