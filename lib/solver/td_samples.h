/* Internal: rendered units of a macro step, handed out and given back one by one. Memory grows in chunks that stay in place, so
 * that nothing is copied, and no more is held than was once in use. */
#ifndef TD_SAMPLES_H
#define TD_SAMPLES_H

#include "render/td_render.h"

/* Planes of a sample: S and S_dot, and diagnostics where the sensor or the readout needs them. */
enum {
    TD_PLANE_S,
    TD_PLANE_S_DOT,
    TD_PLANE_ALPHA,
    TD_PLANE_ALPHA_DOT,
    TD_PLANE_CONTRIBUTORS,
    TD_PLANES_ALL,
    TD_PLANES_SIGNAL = 2
};

/* Samples of a chunk, as a power of two. */
enum { TD_SAMPLE_BITS = 8 };

typedef struct td_samples {
    int planes;     /* of the image, TD_PLANES_SIGNAL or TD_PLANES_ALL; a plane of deviations and bytes of their falls follow */
    int pixels;     /* of a plane: TD_TILE_PIXELS or TD_BLOCK_PIXELS */
    double **chunk; /* 2^TD_SAMPLE_BITS samples each */
    size_t chunks, chunk_capacity;
    int32_t *spare; /* samples that were given back */
    size_t spares, spare_capacity;
    size_t made; /* most samples in use at once since the last clear */
} td_samples;

/* Doubles that hold one byte per pixel. */
static inline size_t td_sample_falls(const td_samples *samples) { return (size_t)samples->pixels / sizeof(double); }

/* Doubles per sample: its planes, row by row, and the unit's risk score. */
static inline size_t td_sample_reals(const td_samples *samples) {
    return ((size_t)samples->planes + 1) * (size_t)samples->pixels + td_sample_falls(samples) + 1;
}

/* A sample's planes: S, S_dot, the others, then deviations. */
static inline double *td_sample_at(const td_samples *samples, int32_t index) {
    return samples->chunk[index >> TD_SAMPLE_BITS] + (size_t)(index & ((1 << TD_SAMPLE_BITS) - 1)) * td_sample_reals(samples);
}

/* Deviations at this sample: how far the model of the step that was cut here was off, (pixels) [log units]. */
static inline double *td_sample_deviation(const td_samples *samples, int32_t index) {
    return td_sample_at(samples, index) + (size_t)samples->planes * (size_t)samples->pixels;
}

/* How far the deviation has fallen since the longer step was cut, as bytes (pixels) in the room of doubles. */
static inline uint8_t *td_sample_fall(const td_samples *samples, int32_t index) {
    return (uint8_t *)(td_sample_deviation(samples, index) + samples->pixels);
}

static inline double *td_sample_risk(const td_samples *samples, int32_t index) {
    return td_sample_at(samples, index) + td_sample_reals(samples) - 1;
}

/* Samples in use. */
static inline size_t td_samples_live(const td_samples *samples) { return samples->made - samples->spares; }

TIDES_MUST_CHECK tides_status td_samples_take(td_samples *samples, int32_t *index, tides_error *error);
void td_samples_give(td_samples *samples, int32_t index);

/* Gives back all samples; the memory is kept. */
void td_samples_clear(td_samples *samples);
void td_samples_release(td_samples *samples);

#endif
