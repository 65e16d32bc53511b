/* Facts about a renderer: its precision, knots, motion in its tiles and blocks, and the numbers that define its image. */
#include "td_device.h"
#include "td_renderer.h"

#include <math.h>

const double *td_renderer_knots(const tides_renderer *renderer, size_t *count) {
    *count = renderer->dynamic.knot_count;
    return renderer->dynamic.knots;
}

int td_renderer_is_double(const tides_renderer *renderer) { return td_device_is_double(renderer->device); }

int td_renderer_colours_bend(const tides_renderer *renderer) {
    return renderer->image.colours_move && renderer->image.colour_floor >= 0;
}

int td_renderer_tile_moves(const tides_renderer *renderer, int tile) { return renderer->candidates.moving[tile]; }

/* The largest travel over a colour filter's channels. Travel includes changes of colour, which differ by channel; whether a
 * tile moves depends on places only. */
double td_renderer_tile_travel(const tides_renderer *renderer, int tile) {
    double most = 0;
    for (; renderer; renderer = renderer->beside) most = fmax(most, (double)renderer->candidates.travel[tile]);
    return most;
}

int td_renderer_block_moves(const tides_renderer *renderer, int tile, int block) {
    return renderer->candidates.moving_blocks[tile] >> block & 1;
}

double td_renderer_block_travel(const tides_renderer *renderer, int tile, int block) {
    const int at = tile * TD_TILE_BLOCKS + block;
    double most = 0;
    for (; renderer; renderer = renderer->beside) most = fmax(most, (double)renderer->candidates.block_travel[at]);
    return most;
}

int td_renderer_tiles_across(const tides_renderer *renderer) { return renderer->candidates.tiles_x; }

typedef char td_image_facts_are_these[TD_IMAGE_FACTS == TD_IMAGE_REALS + TD_IMAGE_INTS + 6 ? 1 : -1];

void td_renderer_image_facts(const tides_renderer *renderer, double facts[TD_IMAGE_FACTS]) {
    const td_image_numbers image = td_image_pack(&renderer->image);
    const td_psf *psf = &renderer->psf;
    int at = 0;
    for (int i = 0; i < TD_IMAGE_REALS; i++) facts[at++] = image.real[i];
    for (int i = 0; i < TD_IMAGE_INTS; i++) facts[at++] = image.whole[i];
    facts[at++] = psf->radius ? psf->sigma : 0;
    facts[at++] = psf->radius ? psf->domain : 0;
    for (int c = 0; c < 3; c++) facts[at++] = renderer->scratch.backdrops[0].colour[c];
    facts[at++] = renderer->colour_filter;
}
