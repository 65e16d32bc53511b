/* Makes the worlds (scene, camera, stepping) of `tides bench stability` whose splats are extreme: in shape, place, opacity,
 * length of the quaternion, or colour. Each world has 60 ordinary splats, the backdrop, and 40 splats that are altered as the
 * case says. Only SHAPE_SH_BANDS alters all 100. */
#include "bench_stability.h"

#include <stdlib.h>
#include <string.h>

enum { ALTERED = 40, MIDDLE = ALTERED / 2, BACKDROP = 60, SEED = 27182 };

/* Depth of the near plane [scene units] under the image rules `smooth` (lib/render/rules.c). A splat is invisible up to this
 * depth, and fades in up to 1.25 times this depth. */
#define NEAR 0.2

static void set_scales(stability_splat *s, double a, double b, double c) {
    s->decades[0] = a;
    s->decades[1] = b;
    s->decades[2] = c;
}

/* Places a splat beside the view, near the clamp of x/z in the projection's Jacobian: |x/z| = 1.3 tan(fov / 2). `spread` is the
 * range of the splats' |x/z| as a share of the clamp; the moving camera carries splats across it. The splats are so large that
 * they reach into the view. */
static void at_clamp(stability_splat *s, int32_t i, const tides_intrinsics *camera, double spread) {
    const double limit = 1.3 * 0.5 * camera->width / camera->fx, place = i - MIDDLE;
    s->mean[2] = 2;
    s->mean[0] = (i % 2 ? 1 : -1) * s->mean[2] * limit * (1 + spread * place / ALTERED);
    set_scales(s, -0.1, -0.1, -0.3);
}

static void turn(stability_splat *s, double size) {
    for (size_t k = 0; k < 4; k++) s->quaternion[k] *= size;
}

/* Alters splat `i` of a world. The meaning of `size` depends on `kind`:
 *   NEEDLES, PANCAKES  log10 of the ratio of a long to a short scale
 *   SMALL              -log10 of the scales
 *   LARGE, SINGULAR    log10 of the largest scale
 *   NEAR               depth as a multiple of NEAR
 *   CLAMP              spread of |x/z| about the clamp, as a share of it
 *   OPACITY            logit of the opacity
 *   QUATERNION         factor of the quaternion
 *   SH                 SH coefficient of the constant band
 *   RADIANCE           largest colour
 * CROSSING and SH_BANDS don't use it here. */
static void alter(int32_t kind, double size, int32_t i, const stability_world *w, stability_splat *s) {
    const double long_axis = -0.3;
    switch (kind) {
        case SHAPE_NEEDLES: set_scales(s, long_axis, long_axis - size, long_axis - size); break;
        case SHAPE_PANCAKES: set_scales(s, long_axis, long_axis, long_axis - size); break;
        case SHAPE_SMALL: set_scales(s, -size, -size, -size); break;
        case SHAPE_LARGE: set_scales(s, size, size - 0.3, size - 0.1); break;
        case SHAPE_SINGULAR: set_scales(s, size, -4, -4); break;
        case SHAPE_NEAR:
            s->mean[0] *= NEAR / s->mean[2];
            s->mean[1] *= NEAR / s->mean[2];
            s->mean[2] = NEAR * size * (1 + 0.005 * i / ALTERED);
            set_scales(s, -1.5, -1.7, -1.3);
            break;
        case SHAPE_CROSSING:
            s->mean[2] = NEAR + 0.01 * (i - MIDDLE);
            s->mean[0] *= 0.02;
            s->mean[1] *= 0.02;
            set_scales(s, -2, -1.8, -1.6);
            break;
        case SHAPE_CLAMP: at_clamp(s, i, &w->scene.intrinsics, size); break;
        case SHAPE_OPACITY: s->logit = size; break;
        case SHAPE_QUATERNION: turn(s, size); break;
        case SHAPE_SH: s->sh = size; break;
        case SHAPE_RADIANCE: s->sh = (size * (1 + i) / ALTERED - 0.5) / STABILITY_SH0; break;
        default: break;
    }
}

/* Gives the world a camera that flies forward, so that splats just beyond its near plane pass through it. */
static tides_status go_forward(stability_world *w, tides_error *error) {
    static const stability_slide forward = {.velocity = {0.5, 0, 5}};
    return stability_path(w, &forward, &w->scene.camera, error);
}

/* Adds the pile to the world with harmonics of degree 3, and frees it. The coefficients of all bands are random within
 * [-size, size]. So colours change with the direction of view, and the image formation cuts negative ones at 0. */
static tides_status put_bands(stability_pile *pile, stability_world *w, double size, tides_error *error) {
    enum { COEFFICIENTS = 16 };
    float *sh = malloc(pile->count * COEFFICIENTS * 3 * sizeof *sh);
    uint64_t state = SEED + 1;
    tides_gaussians g = stability_gaussians(pile);
    tides_status status = sh && !pile->failed ? TIDES_OK : cli_error(error, TIDES_NO_MEMORY, "out of memory: colours");
    for (size_t i = 0; status == TIDES_OK && i < pile->count * COEFFICIENTS * 3; i++)
        sh[i] = (float)stability_between(&state, -size, size);
    g.sh = sh;
    g.sh_degree = 3;
    if (status == TIDES_OK) status = tides_scene_add(w->scene.scene, &g, NULL, 1, NULL, NULL, error);
    free(sh);
    stability_free(pile);
    return status;
}

tides_status stability_shapes(const stability_case *c, stability_world *w, tides_error *error) {
    stability_pile pile = {.count = 0};
    uint64_t state = SEED;
    stability_backdrop(&pile, BACKDROP);
    for (int32_t i = 0; i < ALTERED; i++) {
        stability_splat s = stability_ordinary(&state);
        for (size_t k = 0; k < 3; k++) s.mean[k] *= 0.7; /* 2.8 to 4.2 scene units away; the backdrop is 4 to 6 away */
        alter(c->kind, c->size, i, w, &s);
        stability_add(&pile, &s);
    }
    if (c->kind == SHAPE_SINGULAR) w->scene.image.dilation = 0.01;
    if (c->kind == SHAPE_SH_BANDS) return put_bands(&pile, w, c->size, error);
    const tides_status status = stability_put(&pile, w, NULL, error);
    return status == TIDES_OK && c->kind == SHAPE_CROSSING ? go_forward(w, error) : status;
}
