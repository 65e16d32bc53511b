/* Steps of all pixels together, through the centre-surround to the comparator, where the sensor has a surround. The modes'
 * arithmetic is in lib/sensor/surround. */
#include "solver/td_simulator.h"

#include <stdlib.h>

tides_status td_surround_steps_create(tides_simulator *s, const tides_sensor *sensor, int height, tides_error *error) {
    td_surround_steps *steps = &s->surround;
    size_t pixels = (size_t)s->layout.width * (size_t)height;
    if (sensor->surround_lambda_px == 0) return TIDES_OK;
    if (sensor->bandwidth != TIDES_BANDWIDTH_FIRST_ORDER || sensor->highpass_hz > 0 ||
        (sensor->photoreceptor_cutoff_hz > 0 && sensor->photoreceptor_law != TIDES_PHOTORECEPTOR_CONSTANT))
        return td_fail(error, TIDES_UNSUPPORTED,
                       "center_surround: wants a photoreceptor whose filter is the same for all pixels: bandwidth first_order "
                       "and photoreceptor_law constant, without highpass_hz");
    double least = td_sensor_least_threshold(sensor);
    tides_status status =
        td_surround_create(sensor, s->layout.width, height, s->given.tolerance * least, &steps->surround, error);
    double **images[] = {&steps->from_dot, &steps->p, &steps->p_dot, &steps->S, &steps->modes};
    for (size_t i = 0; i < sizeof images / sizeof *images && status == TIDES_OK; i++)
        if (!(*images[i] = td_alloc(pixels, sizeof **images[i], error))) status = TIDES_NO_MEMORY;
    if (status == TIDES_OK) s->given.local = 0;
    return status;
}

void td_surround_steps_release(td_surround_steps *steps) {
    td_surround_release(&steps->surround);
    free(steps->from_dot);
    free(steps->p);
    free(steps->p_dot);
    free(steps->S);
    free(steps->modes);
    memset(steps, 0, sizeof *steps);
}

enum { TO_IMAGE, TO_TILES };

/* Copies a tile's rows from the tiles' order to the image's, or back. */
static void copy_rows(const tides_simulator *s, int t, int direction, double *in_image, double *in_tile) {
    const td_tile *tile = &s->layout.unit[t];
    const size_t row = (size_t)tile->width, apart = (size_t)s->layout.width;
    double *image = in_image + (size_t)tile->y0 * apart + (size_t)tile->x0;
    for (const double *end = in_tile + tile->count; in_tile < end; in_tile += row, image += apart) {
        if (direction == TO_IMAGE)
            memcpy(image, in_tile, row * sizeof *image);
        else
            memcpy(in_tile, image, row * sizeof *image);
    }
}

/* Copies the planes of all tiles. */
static void rearrange(const tides_simulator *s, int direction, double *in_image, double *in_tiles) {
    for (int t = 0; t < s->layout.units; t++) copy_rows(s, t, direction, in_image, in_tiles + s->layout.first_pixel[t]);
}

/* Stores S and the modes at the time reached. */
static void note_reached(const tides_simulator *s, const td_surround_sample *reached) {
    rearrange(s, TO_TILES, reached->S, s->surround.S);
    rearrange(s, TO_TILES, s->surround.surround.surround, s->surround.modes);
}

void td_surround_steps_begin(tides_simulator *s) {
    td_surround_steps *steps = &s->surround;
    td_surround_sample now;
    rearrange(s, TO_IMAGE, steps->p, s->now.plane[TD_PLANE_S]);
    rearrange(s, TO_IMAGE, steps->p_dot, s->now.plane[TD_PLANE_S_DOT]);
    td_surround_rest(&steps->surround, steps->p, steps->p_dot, &now);
    note_reached(s, &now);
}

void td_surround_steps_resume(tides_simulator *s) {
    td_surround_steps *steps = &s->surround;
    td_surround_sample now;
    rearrange(s, TO_IMAGE, steps->p, s->now.plane[TD_PLANE_S]);
    rearrange(s, TO_IMAGE, steps->p_dot, s->now.plane[TD_PLANE_S_DOT]);
    rearrange(s, TO_IMAGE, steps->from_dot, s->surround.modes);
    td_surround_resume(&steps->surround, steps->from_dot, steps->p, steps->p_dot, &now);
    note_reached(s, &now);
}

/* A tile at one end of a piece: the planes that the comparator needs, and the photoreceptor's input where it needs that. */
typedef struct tile_sample {
    double own[TD_PLANES_ALL][TD_TILE_PIXELS], p[TD_TILE_PIXELS], p_dot[TD_TILE_PIXELS];
    const double *plane[TD_PLANES_ALL];
} tile_sample;

/* Other planes are linear between s->now and s->next; `part` is the place in the step. */
static void take_tile(const tides_simulator *s, int t, const td_surround_sample *from, double part, tile_sample *to) {
    const td_tile *tile = &s->layout.unit[t];
    copy_rows(s, t, TO_TILES, from->S, to->own[TD_PLANE_S]);
    copy_rows(s, t, TO_TILES, from->S_dot, to->own[TD_PLANE_S_DOT]);
    copy_rows(s, t, TO_TILES, from->p, to->p);
    copy_rows(s, t, TO_TILES, from->p_dot, to->p_dot);
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
    tides_status status = TIDES_OK;
    for (int t = first; t < stop && status == TIDES_OK; t++) {
        tile_sample begin, end;
        take_tile(s, t, &at->sample[0], at->part[0], &begin);
        take_tile(s, t, &at->sample[1], at->part[1], &end);
        const td_signals light = {begin.p, begin.p_dot, end.p, end.p_dot};
        const td_compared unit = {t, &at->step, begin.plane, end.plane, &light};
        const size_t before = portion->work.events.count;
        status = td_compare_unit(s, portion, &unit, error);
        if (at->which && status == TIDES_OK) td_time_events(s, portion, &s->refine.step[at->which[t]], &unit, before);
    }
    return status;
}

tides_status td_surround_compare(tides_simulator *s, double start, double stop, const int32_t *which, tides_error *error) {
    td_surround_steps *steps = &s->surround;
    part_step at = {.which = which};
    td_surround_sample *sample = at.sample;
    double *part = at.part;
    tides_status status = TIDES_OK;
    rearrange(s, TO_IMAGE, steps->from_dot, s->now.plane[TD_PLANE_S_DOT]);
    rearrange(s, TO_IMAGE, steps->p, s->next.plane[TD_PLANE_S]);
    rearrange(s, TO_IMAGE, steps->p_dot, s->next.plane[TD_PLANE_S_DOT]);
    td_surround_begin(&steps->surround, stop - start, steps->from_dot, steps->p, steps->p_dot);
    while (status == TIDES_OK && td_surround_next(&steps->surround, &part[0], &part[1], &sample[0], &sample[1])) {
        double from = start + (stop - start) * part[0], to = part[1] < 1 ? start + (stop - start) * part[1] : stop;
        status = td_grid_step(&s->grid, from, to, &at.step, error);
        if (status == TIDES_OK) status = td_share_out(s, s->layout.units, TD_FEWEST_UNITS, compare_some, &at, error);
    }
    if (status == TIDES_OK) note_reached(s, &sample[1]);
    return status;
}
