/* Samples of a macro step: chunks of memory, and a stack of samples that were given back. */
#include "solver/td_samples.h"

#include <stdlib.h>

static tides_status add_chunk(td_samples *samples, tides_error *error) {
    tides_status status =
        td_reserve((void **)&samples->chunk, &samples->chunk_capacity, samples->chunks + 1, sizeof *samples->chunk, error);
    if (status == TIDES_OK) /* room for giving back all, which then can't fail */
        status = td_reserve((void **)&samples->spare, &samples->spare_capacity, (samples->chunks + 1) << TD_SAMPLE_BITS,
                            sizeof *samples->spare, error);
    if (status != TIDES_OK) return status;
    double *chunk = malloc(((size_t)1 << TD_SAMPLE_BITS) * td_sample_reals(samples) * sizeof *chunk);
    if (!chunk)
        return td_fail(error, TIDES_NO_MEMORY,
                       "out of memory: %zu samples of a tile were there, and more are wanted: set "
                       "stepping.memory_mb lower",
                       samples->made);
    samples->chunk[samples->chunks++] = chunk;
    return TIDES_OK;
}

tides_status td_samples_take(td_samples *samples, int32_t *index, tides_error *error) {
    if (samples->spares > 0) {
        *index = samples->spare[--samples->spares];
        return TIDES_OK;
    }
    if (samples->made == samples->chunks << TD_SAMPLE_BITS) {
        tides_status status = add_chunk(samples, error);
        if (status != TIDES_OK) return status;
    }
    *index = (int32_t)samples->made++;
    return TIDES_OK;
}

void td_samples_give(td_samples *samples, int32_t index) { samples->spare[samples->spares++] = index; }

void td_samples_clear(td_samples *samples) { samples->made = samples->spares = 0; }

void td_samples_release(td_samples *samples) {
    for (size_t i = 0; i < samples->chunks; i++) free(samples->chunk[i]);
    free(samples->chunk);
    free(samples->spare);
    *samples = (td_samples){.planes = samples->planes, .pixels = samples->pixels};
}
