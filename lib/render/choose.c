/* Chooses points to follow: places in the image drawn at random by (seed, draw), if a splat is seen there. */
#include "td_renderer.h"
#include "tides/truth.h"

#include "td_random.h"

#include <stdlib.h>

/* Places drawn at once per wanted point, and number of rounds. This is enough for images that show something in 1/32 of their
 * pixels. Each round costs a pass of ground truth. */
enum { DRAWN = 4, ROUNDS = 8 };

tides_status tides_renderer_choose(tides_renderer *r, const tides_trajectory *camera, double time, uint64_t seed,
                                   uint32_t number, size_t count, double *xy, tides_material_point *points, size_t *chosen,
                                   tides_error *error) {
    if (!r || !camera || !chosen || (count && (!xy || !points)))
        return td_fail(error, TIDES_BAD_ARGUMENT,
                       "tides_renderer_choose: renderer, camera, xy, points and chosen must be given");
    const size_t drawn = DRAWN * count;
    double *places = td_alloc(drawn, 2 * sizeof *places, error);
    tides_material_point *seen = td_alloc(drawn, sizeof *seen, error);
    tides_status status = places && seen ? TIDES_OK : TIDES_NO_MEMORY;
    size_t found = 0;
    for (uint64_t round = 0; round < ROUNDS && found < count && status == TIDES_OK; round++) {
        for (size_t i = 0; i < drawn; i++) {
            const td_random_bits bits = td_random(seed, number, round * drawn + i, TD_RANDOM_TRACKS);
            places[2 * i] = r->image.width * td_random_uniform(&bits, 0);
            places[2 * i + 1] = r->image.height * td_random_uniform(&bits, 1);
        }
        status = tides_renderer_pick(r, camera, time, places, drawn, seen, error);
        for (size_t i = 0; i < drawn && found < count && status == TIDES_OK; i++) {
            if (seen[i].object < 0) continue;
            memcpy(xy + 2 * found, places + 2 * i, 2 * sizeof *xy);
            points[found++] = seen[i];
        }
    }
    if (status == TIDES_OK) *chosen = found;
    free(places);
    free(seen);
    return status;
}
