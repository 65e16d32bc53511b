/* Internal: additive noise of many pixels side by side: where it stays so far from levels that nothing can cross.
 *
 * It descends the tree of td_noise_bridge.h with vectors, as far as parts of an eighth of a segment and their extremes. Noise
 * that is quiet by it is quiet by td_noise_crossing. The reverse needn't hold: rounding is allowed for, and trees that are
 * deeper aren't followed to their end. */
#ifndef TD_NOISE_QUIET_H
#define TD_NOISE_QUIET_H

#include "td_additive_noise.h"

/* The result for a pixel. */
typedef struct td_noise_found {
    int reaches; /* 1: it may leave its band, but not before segment `first` */
    uint64_t first;
    double low, high; /* otherwise: its bounds from the step's end on, */
    double until_ns;  /* up to this time: the last segment's end, or where it may leave the band after the step */
} td_noise_found;

/* A part of a segment, and the band within which nothing crosses. */
typedef struct td_noise_part {
    int owner;      /* number of the pixel's td_noise_found */
    uint32_t pixel; /* its number, as random numbers want it */
    uint32_t node;  /* 1: the segment; 2 n and 2 n + 1: the halves of n */
    uint64_t k;     /* of the segment */
    double from_ns, to_ns, begin, end;
    double low, high;   /* bounds on the part */
    double bottom, top; /* the band */
    double sigma, l;    /* of noise that varies: size; length of the segment over tau */
} td_noise_part;

/* Parts side by side, with the laws of parts of each depth; what parts come of each, and which of them may leave the band. */
enum { TD_NOISE_EIGHTH = 3 }; /* the depth of an eighth */
typedef struct td_noise_lanes {
    double begin[TD_RANDOM_LANES], end[TD_RANDOM_LANES], low[TD_RANDOM_LANES], high[TD_RANDOM_LANES];
    double bottom[TD_RANDOM_LANES], top[TD_RANDOM_LANES], sigma[TD_RANDOM_LANES], l[TD_RANDOM_LANES];
    double variance[TD_NOISE_EIGHTH + 1][TD_RANDOM_LANES];
    double mean[TD_NOISE_EIGHTH][TD_RANDOM_LANES], change[TD_NOISE_EIGHTH][TD_RANDOM_LANES];
    double point[5][TD_RANDOM_LANES], least[4][TD_RANDOM_LANES], most[4][TD_RANDOM_LANES], leaves[4][TD_RANDOM_LANES];
} td_noise_lanes;

/* Parts that wait until there are enough of them: segments, their quarters, and eighths. */
enum { TD_NOISE_ROOM = 5 * TD_RANDOM_LANES };
typedef struct td_noise_quiet {
    const td_additive_noise *noise;
    double start_ns, stop_ns; /* of the step */
    td_noise_found *found;
    int count[3];
    td_noise_part part[3][TD_NOISE_ROOM];
    td_noise_lanes lanes;
} td_noise_quiet;

/* Begins a search. `found` has a row for each owner; the caller sets it to the bounds of segments that aren't added. */
void td_noise_quiet_begin(td_noise_quiet *quiet, const td_additive_noise *noise, double start_ns, double stop_ns,
                          td_noise_found *found);

/* Adds a segment with its band; segments of an owner are added in order of time. */
void td_noise_quiet_add(td_noise_quiet *quiet, int owner, uint32_t pixel, const td_noise_segment *segment, double bottom,
                        double top);

/* Looks at all that still waits. */
void td_noise_quiet_end(td_noise_quiet *quiet);

#endif
