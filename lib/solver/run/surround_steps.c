/* Steps of all pixels together, through the centre-surround to the comparator, where the sensor has a surround. The surround's
 * arithmetic is in lib/sensor/surround. */
#include "solver/td_simulator.h"
#include "sensor/td_between.h"

#include <stdlib.h>

tides_status td_surround_steps_create(tides_simulator *s, const tides_sensor *sensor, int height, tides_error *error) {
    td_surround_steps *steps = &s->surround;
    size_t pixels = (size_t)s->layout.width * (size_t)height;
    if (!s->given.coupled) return TIDES_OK;
    if (sensor->bandwidth != TIDES_BANDWIDTH_FIRST_ORDER || sensor->highpass_hz > 0 ||
        (sensor->photoreceptor_cutoff_hz > 0 && sensor->photoreceptor_law != TIDES_PHOTORECEPTOR_CONSTANT))
        return td_fail(error, TIDES_UNSUPPORTED,
                       "center_surround: wants a photoreceptor whose filter is the same for all pixels: bandwidth first_order "
                       "and photoreceptor_law constant, without highpass_hz");
    double least = td_sensor_least_threshold(sensor);
    tides_status status =
        td_surround_create(sensor, s->layout.width, height, s->given.tolerance * least, &steps->surround, error);
    steps->surround.has_cubics = s->sensor.model == TIDES_MODEL_HERMITE;
    double **images[] = {&steps->from_dot, &steps->p, &steps->p_dot, &steps->S, &steps->h};
    for (size_t i = 0; i < sizeof images / sizeof *images && status == TIDES_OK; i++)
        if (!(*images[i] = td_alloc(pixels, sizeof **images[i], error))) status = TIDES_NO_MEMORY;
    return status;
}

void td_surround_steps_release(td_surround_steps *steps) {
    td_surround_release(&steps->surround);
    free(steps->from_dot);
    free(steps->p);
    free(steps->p_dot);
    free(steps->S);
    free(steps->h);
    memset(steps, 0, sizeof *steps);
}

/* Copies a tile's rows from the image's order to the tiles'. */
static void take_rows(const tides_simulator *s, int t, const double *in_image, double *in_tile) {
    const td_tile *tile = &s->layout.unit[t];
    const size_t row = (size_t)tile->width, apart = (size_t)s->layout.width;
    const double *image = in_image + (size_t)tile->y0 * apart + (size_t)tile->x0;
    for (const double *end = in_tile + tile->count; in_tile < end; in_tile += row, image += apart)
        memcpy(in_tile, image, row * sizeof *image);
}

static void put_rows(const tides_simulator *s, int t, const double *in_tile, double *in_image) {
    const td_tile *tile = &s->layout.unit[t];
    const size_t row = (size_t)tile->width, apart = (size_t)s->layout.width;
    double *image = in_image + (size_t)tile->y0 * apart + (size_t)tile->x0;
    for (const double *end = in_tile + tile->count; in_tile < end; in_tile += row, image += apart)
        memcpy(image, in_tile, row * sizeof *image);
}

/* Copies a plane of all tiles. */
static void take_all(const tides_simulator *s, const double *in_image, double *in_tiles) {
    for (int t = 0; t < s->layout.units; t++) take_rows(s, t, in_image, in_tiles + s->layout.first_pixel[t]);
}

static void put_all(const tides_simulator *s, const double *in_tiles, double *in_image) {
    for (int t = 0; t < s->layout.units; t++) put_rows(s, t, in_tiles + s->layout.first_pixel[t], in_image);
}

/* Stores S and h at the time reached. */
static void note_reached(tides_simulator *s) {
    take_all(s, s->surround.surround.end.S, s->surround.S);
    take_all(s, s->surround.surround.surround, s->surround.h);
}

/* Copies s->now into the image's order. */
static void take_now(tides_simulator *s) {
    put_all(s, s->now.plane[TD_PLANE_S], s->surround.p);
    put_all(s, s->now.plane[TD_PLANE_S_DOT], s->surround.p_dot);
}

void td_surround_steps_begin(tides_simulator *s) {
    td_surround_steps *steps = &s->surround;
    if (!s->given.coupled) return;
    take_now(s);
    td_surround_rest(&steps->surround, steps->p, steps->p_dot);
    note_reached(s);
}

void td_surround_steps_resume(tides_simulator *s) {
    td_surround_steps *steps = &s->surround;
    if (!s->given.coupled) return;
    take_now(s);
    put_all(s, steps->h, steps->from_dot);
    td_surround_resume(&steps->surround, steps->from_dot, steps->p, steps->p_dot);
    note_reached(s);
}

/* A tile at one end of a piece: the planes that the comparator needs, and the photoreceptor's input where it needs that. */
typedef struct tile_sample {
    double own[TD_PLANES_ALL][TD_TILE_PIXELS], p[TD_TILE_PIXELS], p_dot[TD_TILE_PIXELS];
    const double *plane[TD_PLANES_ALL];
} tile_sample;

/* Other planes are linear between s->now and s->next; `part` is the place in the step. */
static void take_tile(const tides_simulator *s, int t, const td_surround_sample *from, double part, int with_light,
                      tile_sample *to) {
    const td_tile *tile = &s->layout.unit[t];
    take_rows(s, t, from->S, to->own[TD_PLANE_S]);
    take_rows(s, t, from->S_dot, to->own[TD_PLANE_S_DOT]);
    if (with_light) {
        take_rows(s, t, from->p, to->p);
        take_rows(s, t, from->p_dot, to->p_dot);
    }
    for (int k = 0; k < s->given.sample_planes; k++) {
        to->plane[k] = to->own[k];
        const double *now = s->now.plane[k] + s->layout.first_pixel[t], *next = s->next.plane[k] + s->layout.first_pixel[t];
        for (int i = 0; i < tile->count && k >= TD_PLANES_SIGNAL; i++) to->own[k][i] = (1 - part) * now[i] + part * next[i];
    }
}

/* A part of a step, of all tiles. */
typedef struct part_step {
    td_step step;
    double part[2];
    td_surround_sample sample[2];
    const int32_t *which;
} part_step;

static tides_status compare_some(const tides_simulator *s, td_portion *portion, int first, int stop, const void *user,
                                 tides_error *error) {
    const part_step *at = user;
    const int with_light = td_sensor_wants_light(&s->sensor);
    tides_status status = TIDES_OK;
    for (int t = first; t < stop && status == TIDES_OK; t++) {
        tile_sample begin, end;
        take_tile(s, t, &at->sample[0], at->part[0], with_light, &begin);
        take_tile(s, t, &at->sample[1], at->part[1], with_light, &end);
        const td_signals light = {begin.p, begin.p_dot, end.p, end.p_dot};
        const td_compared unit = {t, &at->step, begin.plane, end.plane, with_light ? &light : NULL};
        const size_t before = portion->work.events.count;
        status = td_compare_unit(s, portion, &unit, error);
        if (at->which && status == TIDES_OK) td_time_events(s, portion, &s->refine.step[at->which[t]], &unit, before);
    }
    return status;
}

/* Puts the tiles' samples at the step's end into one image: those of the refined steps `which`, or of s->next. */
static void put_next(tides_simulator *s, const int32_t *which) {
    const td_refine *r = &s->refine;
    double *p, *p_dot;
    td_surround_next_input(&s->surround.surround, &p, &p_dot);
    for (int t = 0; t < s->layout.units; t++) {
        const size_t first = s->layout.first_pixel[t];
        const double *sample = which ? td_sample_at(&r->samples, r->step[which[t]].end) : NULL;
        put_rows(s, t, sample ? sample : s->next.plane[TD_PLANE_S] + first, p);
        put_rows(s, t, sample ? sample + r->samples.pixels : s->next.plane[TD_PLANE_S_DOT] + first, p_dot);
    }
}

tides_status td_surround_compare(tides_simulator *s, double start, double stop, const int32_t *which, tides_error *error) {
    td_surround_steps *steps = &s->surround;
    part_step at = {.which = which};
    td_surround_sample *sample = at.sample;
    double *part = at.part;
    tides_status status = TIDES_OK;
    const int goes_on = which && s->refine.step[which[0]].from > 0; /* p_dot may jump where macro steps begin */
    if (!goes_on) put_all(s, s->now.plane[TD_PLANE_S_DOT], steps->from_dot);
    put_next(s, which);
    td_surround_begin(&steps->surround, stop - start, goes_on ? NULL : steps->from_dot);
    while (status == TIDES_OK && td_surround_next(&steps->surround, &part[0], &part[1], &sample[0], &sample[1])) {
        double from = start + (stop - start) * part[0], to = part[1] < 1 ? start + (stop - start) * part[1] : stop;
        status = td_grid_step(&s->grid, from, to, &at.step, error);
        if (status == TIDES_OK) status = td_share_out(s, s->layout.units, TD_FEWEST_UNITS, compare_some, &at, error);
    }
    const int ends_macro = !which || s->refine.step[which[0]].next < 0;
    if (status == TIDES_OK && ends_macro) note_reached(s);
    return status;
}
