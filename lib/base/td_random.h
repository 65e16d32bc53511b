/* Internal: counter-based random numbers. Each is a function of (seed, pixel, index, purpose), so numbers depend neither on
 * tiles, threads or devices nor on where a run was cut.
 *
 * Philox4x32-10: J. Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC 2011. */
#ifndef TD_RANDOM_H
#define TD_RANDOM_H

#include <stdint.h>

/* Purposes of random numbers: two uses never share one. Add new ones at the end: a changed value changes the events of
 * every seed. */
enum {
    TD_RANDOM_THRESHOLD = 1,
    TD_RANDOM_LEAK = 2,
    TD_RANDOM_SHOT_ON = 3,
    TD_RANDOM_SHOT_OFF = 4,
    TD_RANDOM_HOT = 5,
    TD_RANDOM_DEAD = 6,
    TD_RANDOM_NOISE = 7,
    TD_RANDOM_DROP = 8,
    TD_RANDOM_JITTER = 9,
    TD_RANDOM_NOISE_BRIDGE = 10, /* noise within a step, halved as a tree; the purpose's upper bits are the number of a node */
    TD_RANDOM_FRAME_SHOT = 11,
    TD_RANDOM_FRAME_READ = 12,
    TD_RANDOM_IMU_NOISE = 13,
    TD_RANDOM_IMU_WALK = 14,
    TD_RANDOM_TRACKS = 15,
    TD_RANDOM_SAMPLE = 16,
    TD_RANDOM_INITIAL = 17,
    TD_RANDOM_ERC = 20,
    TD_RANDOM_NOISE_SIZE = 21,
    /* the baselines, from 64 on */
    TD_RANDOM_ESIM_THRESHOLD = 64,
    TD_RANDOM_V2E_THRESHOLD = 65,
    TD_RANDOM_V2E_LEAK = 66,
    TD_RANDOM_V2E_LEAK_JITTER = 67,
    TD_RANDOM_V2E_SHOT = 68,
    TD_RANDOM_V2E_NOISE = 69,
    TD_RANDOM_V2E_NOISE_LEVEL = 70,
    TD_RANDOM_VOLTMETER_HIT = 71,
    TD_RANDOM_IEBCS_THRESHOLD = 72,
    TD_RANDOM_IEBCS_LATENCY = 73,
    TD_RANDOM_IEBCS_NOISE = 74,
    TD_RANDOM_LDATI = 75
};

/* The lowest bits of a purpose number hold a value from the list. */
enum { TD_RANDOM_PURPOSE_BITS = 8 };

/* 128 random bits. */
typedef struct td_random_bits {
    uint32_t word[4];
} td_random_bits;
td_random_bits td_random(uint64_t seed, uint32_t pixel, uint64_t index, uint32_t purpose);

/* Philox itself, ten rounds. */
td_random_bits td_philox(const uint32_t counter[4], const uint32_t key[2]);

/* A uniform number (k + 1/2) / 2^52, never 0 or 1. `half` 0 takes the random words 0 and 1, `half` 1 the words 2 and 3. */
double td_random_uniform(const td_random_bits *bits, int half);

/* Two independent standard normals (Box and Muller). */
void td_random_normals(const td_random_bits *bits, double normal[2]);

/* Two normals, within +-6.7, and an exponential of mean 1, at most 22.2, in single precision. Each uniform number that they use
 * has 32 bits; `half` 0 takes words 0 and 1, `half` 1 words 2 and 3. Uniform numbers near 1 are rounded to 24 bits, which
 * changes a result by at most 1e-6. */
void td_random_short_normals(const td_random_bits *bits, int half, float normal[2]);
double td_random_short_exponential(const td_random_bits *bits, int half);

/* Several numbers at once, bit for bit those of td_random, in a fraction of the time. Lane i is of pixel[i] and index[i]. */
enum { TD_RANDOM_LANES = 16 };
typedef struct td_random_lanes {
    uint32_t word[4][TD_RANDOM_LANES];
} td_random_lanes;
void td_random_many(uint64_t seed, const uint32_t *pixel, const uint64_t *index, uint32_t purpose, td_random_lanes *bits);
void td_random_each(uint64_t seed, const uint32_t *pixel, const uint64_t *index, const uint32_t *purpose,
                    td_random_lanes *bits); /* lane i has its own purpose */
void td_random_short_normals_many(const td_random_lanes *bits, float normal[4][TD_RANDOM_LANES]);
void td_random_short_exponentials_many(const td_random_lanes *bits, float value[2][TD_RANDOM_LANES]); /* of both halves */

/* Exponential of mean 1. */
double td_random_exponential(const td_random_bits *bits, int half);

#endif
