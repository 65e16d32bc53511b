/* Rows of `tides bench stability` about depth order: many layers, equal depths, splats that swap, sheets. */
#include "bench_stability.h"

#include <string.h>

enum { SEED = 14142 };

/* Adds `count` splats in one line of sight, a pixel wide, `apart` from each other in depth. */
static void add_layers(stability_pile *pile, int32_t count, double apart) {
    uint64_t state = SEED;
    for (int32_t i = 0; i < count; i++) {
        stability_splat s = {.decades = {-1.5, -1.5, -1.5}, .quaternion = {1, 0, 0, 0}};
        s.mean[2] = 5 + apart * i;
        s.mean[0] = s.mean[2] * stability_between(&state, -0.01, 0.01);
        s.mean[1] = s.mean[2] * stability_between(&state, -0.01, 0.01);
        s.logit = -5; /* five thousand of them together have a transmittance of e^-33 */
        s.sh = stability_between(&state, -1.5, 1.5);
        stability_add(pile, &s);
    }
}

/* Splats in a plane: a grid of side x side over a square of `edge`, at `centre`, its plane through `along` and y. */
typedef struct sheet {
    double centre[3], along[3], edge;
    int32_t side;
    double logit, wide; /* width of splats in spacings; 0: 1 */
} sheet;

static void add_sheet(stability_pile *pile, const sheet *of, uint64_t *state) {
    const double pitch = of->edge / of->side, middle = 0.5 * (of->side - 1);
    double decades = 0, power = 1;
    while (power > 1.2 * pitch * (of->wide > 0 ? of->wide : 1)) power *= 0.7943282347242815, decades -= 0.1; /* by 10^-0.1 */
    for (int32_t i = 0; i < of->side * of->side; i++) {
        const int32_t column = i % of->side, row = i / of->side;
        const double u = pitch * (column - middle), v = pitch * (row - middle);
        stability_splat s = {.decades = {decades, decades, decades - 1}, .quaternion = {1, 0, 0, 0}, .logit = of->logit};
        for (size_t k = 0; k < 3; k++) s.mean[k] = of->centre[k] + of->along[k] * u + (k == 1 ? v : 0);
        s.sh = stability_between(state, -1.5, 1.5);
        stability_add(pile, &s);
    }
}

/* Twenty by twenty splats in the plane of an object. It turns about the vertical, and faces the camera halfway: there all
 * depths are equal, and their order reverses. With `axis` 3 of the quaternion in place of 2 it turns about its normal, so that
 * all depths are equal except for rounding. */
static tides_status put_turning(stability_pile *pile, stability_world *w, int32_t axis, double wide, tides_error *error) {
    const sheet facing = {.along = {1, 0, 0}, .edge = 3, .side = 20, .logit = 2, .wide = wide};
    stability_slide slide = {.from = {0, 0, 5}, .turn = 5};
    tides_pose_sample samples[3];
    tides_trajectory *path = NULL;
    uint64_t state = SEED;
    memset(samples, 0, sizeof samples);
    for (int i = 0; i < 3; i++) {
        samples[i].time = w->scene.stop * i / 2;
        samples[i].position[2] = slide.from[2];
        samples[i].quaternion[0] = 1;
        samples[i].quaternion[axis] = slide.turn * w->scene.stop * (i - 1) / 2;
    }
    add_sheet(pile, &facing, &state);
    tides_status status = tides_trajectory_create(samples, 3, &path, error);
    if (status != TIDES_OK) stability_free(pile);
    if (status == TIDES_OK) status = stability_put(pile, w, path, error);
    tides_trajectory_destroy(path);
    return status;
}

/* A sheet, and another of as many splats that flies through it from front to back within the run. */
static tides_status put_swapping(stability_pile *pile, stability_world *w, tides_error *error) {
    const sheet still = {.centre = {0, 0, 5}, .along = {1, 0, 0}, .edge = 4, .side = 12, .logit = 0};
    const sheet flies = {.along = {1, 0, 0}, .edge = 4, .side = 12, .logit = 0};
    const stability_slide through = {.from = {0.07, 0.03, 4.8}, .velocity = {2, 0, 20}};
    tides_trajectory *path = NULL;
    uint64_t state = SEED;
    add_sheet(pile, &still, &state);
    tides_status status = stability_put(pile, w, NULL, error);
    if (status == TIDES_OK) status = stability_path(w, &through, &path, error);
    if (status == TIDES_OK) {
        add_sheet(pile, &flies, &state);
        status = stability_put(pile, w, path, error);
    }
    tides_trajectory_destroy(path);
    return status;
}

/* An opaque surface at an angle over the whole view, with the centres of `per_pixel` splats in each pixel. */
static void add_surface(stability_pile *pile, stability_world *w, double per_pixel) {
    tides_intrinsics *camera = &w->scene.intrinsics;
    camera->width = 32;
    camera->height = 24;
    camera->fx = camera->fy = 30;
    camera->cx = 16;
    camera->cy = 12;
    sheet surface = {.centre = {0, 0, 5}, .along = {1, 0, 0.25}, .edge = 8, .logit = 2};
    const double pixels = surface.edge * camera->fx / surface.centre[2];
    while (surface.side * surface.side < per_pixel * pixels * pixels) surface.side++;
    uint64_t state = SEED;
    add_sheet(pile, &surface, &state);
}

tides_status stability_layers(const stability_case *c, stability_world *w, tides_error *error) {
    static const sheet first = {.centre = {0, 0, 5}, .along = {1, 0, 0.3}, .edge = 4, .side = 20, .logit = 2};
    static const sheet second = {.centre = {0, 0, 5}, .along = {1, 0, -0.3}, .edge = 4, .side = 20, .logit = 2};
    stability_pile pile = {.count = 0};
    uint64_t state = SEED;
    switch (c->kind) {
        case LAYERS_APART: add_layers(&pile, (int32_t)c->size, 4e-4); break;
        case LAYERS_AT_ONE_DEPTH: add_layers(&pile, (int32_t)c->size, 0); break;
        case LAYERS_SWAP: return put_swapping(&pile, w, error);
        case LAYERS_INTERSECT:
            add_sheet(&pile, &first, &state);
            add_sheet(&pile, &second, &state);
            break;
        case LAYERS_TURNING: return put_turning(&pile, w, 2, c->size, error);
        case LAYERS_SPINNING: return put_turning(&pile, w, 3, c->size, error);
        case LAYERS_SURFACE: add_surface(&pile, w, c->size); break;
        default: w->scene.image.rules = (int32_t)c->size; stability_backdrop(&pile, 200);
    }
    return stability_put(&pile, w, NULL, error);
}
