/* Internal: additive noise and kicks of a block of pixels in a step. Bounds that earlier steps left decide
 * first. The noise of the others is swept to the step's end, and what then still may reach a level is looked at closely
 * (noise/td_noise_quiet.h). Only pixels that are left are walked through. No event depends on this. */
#ifndef TD_BLOCK_NOISE_H
#define TD_BLOCK_NOISE_H

#include "td_ideal_block.h"
#include "sensor/noise/td_noise_quiet.h"

enum { TD_NOISY_BLOCK = TD_IDEAL_BLOCK }; /* a multiple of TD_RANDOM_LANES */

/* The signals of the block's pixels in the step, over their references, without noise and kicks. */
typedef struct td_block_signals {
    double low[TD_NOISY_BLOCK], high[TD_NOISY_BLOCK]; /* bounds, NaN where signals aren't finite */
    int cubic;                                        /* 1: they are cubics, and end at `last` */
    double control[4][TD_NOISY_BLOCK], last[TD_NOISY_BLOCK];
} td_block_signals;

typedef struct td_block_noise {
    double kick_low[TD_NOISY_BLOCK], kick_high[TD_NOISY_BLOCK]; /* bounds of kicks */
    double on[TD_NOISY_BLOCK], off[TD_NOISY_BLOCK];             /* levels less bounds of noise and kicks */
    td_model input[TD_NOISY_BLOCK];                             /* log-luminance, for noise that varies */
    uint64_t quiet_before[TD_NOISY_BLOCK]; /* the noise reaches no level before this segment, unless the reference moves */
    /* bounds of S_eff, without noise and kicks, of pixels that are searched */
    double low[TD_NOISY_BLOCK], high[TD_NOISY_BLOCK];
    td_noise_path paths[TD_NOISY_BLOCK];
    /* of pixels that are swept, side by side */
    int swept;
    int k[TD_NOISY_BLOCK];    /* their numbers in the block */
    int slot[TD_NOISY_BLOCK]; /* of each pixel of the block; -1: it isn't swept */
    double segment[TD_NOISY_BLOCK], value[TD_NOISY_BLOCK];
    double path[TD_NOISY_BLOCK * TD_NOISE_PATH];
    td_noise_few few[TD_NOISY_BLOCK];
    td_noise_found found[TD_NOISY_BLOCK];
    td_noise_quiet quiet;
} td_block_noise;

/* A block's step: pixels from the sensor's number `at` on. */
typedef struct td_noisy_step {
    const td_sensor *sensor;
    double start, length, stop; /* [ns]; every wake-up of this step is at or before `stop` */
    size_t at, count;
} td_noisy_step;

/* Sets levels by kicks and by what is known of the noise; those of pixels of whose noise nothing is known can't be met. */
void td_block_noise_begin(td_block_noise *noise, const td_noisy_step *step);

/* Sweeps the pixels whose mark isn't 0. Where `signals` are given, marks of those become 0 whose noise turns out to reach no
 * level, and that needn't wake up. */
void td_block_noise_look(td_block_noise *noise, const td_noisy_step *step, const td_block_signals *signals, double *mark);

/* Takes the noise of pixel k of the block, which needs nothing, to the step's end. */
void td_block_noise_pass(const td_block_noise *noise, const td_noisy_step *step, size_t k);

#endif
