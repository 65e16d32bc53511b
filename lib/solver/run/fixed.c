/* Fixed steps: several are rendered in one launch, at each step's end every unit that moves, and are then taken one by one as
 * samples of the whole image. How many steps a launch has changes the time, never the events. Also the first sample of any
 * run. */
#include "solver/td_simulator.h"

/* A longer batch has wider swept boxes, so that more candidates miss their tile, and each costs a projection. Above the first
 * share of such candidates the batch is halved, below the second it is doubled. Chosen, not measured. Where half of the
 * projections are lost, tighter boxes are worth one more launch. Halving a batch at most halves the share, so that closer
 * limits could make a batch alternate between two sizes. */
static const double too_many_culled = 0.5, few_culled = 0.3;

/* Copies one rendered unit to its place in a sample. */
static void store_unit(const tides_simulator *s, int t, const double *planes, const td_sample *sample) {
    size_t first = s->layout.first_pixel[t], bytes = (size_t)s->layout.unit[t].count * sizeof(double);
    td_unpack_tile(&s->layout.unit[t], planes, sample->plane[TD_PLANE_S] + first, sample->plane[TD_PLANE_S_DOT] + first);
    if (s->given.sample_planes == TD_PLANES_SIGNAL) return;
    double unpacked[TD_PLANES_ALL * TD_TILE_PIXELS];
    td_unpack_diagnostics(&s->layout.unit[t], planes, TD_TILE_PIXELS, unpacked);
    for (int k = TD_PLANES_SIGNAL; k < TD_PLANES_ALL; k++)
        memcpy(sample->plane[k] + first, unpacked + k * TD_TILE_PIXELS, bytes);
}

tides_status td_fixed_render(tides_simulator *s, int count, tides_error *error) {
    tides_status status = TIDES_OK;
    td_launch_clear(&s->launch);
    for (int k = 1; k <= count; k++)
        for (int i = 0; i < s->moving.count && status == TIDES_OK; i++)
            status = td_launch_add(&s->launch, s->moving.list[i], td_grid_time(s, s->step + k), 0, error);
    if (status != TIDES_OK) return status;
    return td_launch_render(s, 0, s->launch.count, TD_SIDE_ENDS, td_fixed_outputs(s), error);
}

/* A rendered step, and the units to be taken from it. */
typedef struct taken {
    int step;
    const td_sample *sample;
} taken;

static tides_status take_some(const tides_simulator *s, td_portion *portion, int first, int end, const void *user,
                              tides_error *error) {
    const taken *to = user;
    const size_t before = (size_t)to->step * (size_t)s->moving.count;
    (void)portion, (void)error;
    for (int i = first; i < end; i++)
        store_unit(s, s->moving.list[i], td_launch_planes(&s->launch, before + (size_t)i), to->sample);
    return TIDES_OK;
}

tides_status td_fixed_take(tides_simulator *s, int k, const td_sample *sample, tides_error *error) {
    enum { FEWEST = 32 };
    const taken to = {k, sample};
    const size_t bytes = s->layout.first_pixel[s->layout.units] * sizeof(double);
    if (s->moving.count < s->layout.units)
        for (int p = 0; p < s->given.sample_planes; p++) memcpy(sample->plane[p], s->now.plane[p], bytes);
    return td_share_out(s, s->moving.count, FEWEST, take_some, &to, error);
}

/* Replaces slopes of S by differences, as a renderer without derivatives would have them. */
void td_difference_slopes(tides_simulator *s, double h) {
    for (size_t i = 0; i < s->layout.first_pixel[s->layout.units]; i++) {
        double slope = (s->next.plane[TD_PLANE_S][i] - s->now.plane[TD_PLANE_S][i]) / h;
        s->next.plane[TD_PLANE_S_DOT][i] = slope;
        if (s->step == 0) s->now.plane[TD_PLANE_S_DOT][i] = slope;
    }
}

/* Number of steps, at most `count`, until the next knot: knots must be where batches begin. */
static int steps_to_knot(const tides_simulator *s, int count) {
    for (int k = 1; k < count; k++)
        if (td_grid_is_knot(&s->grid, s->step + k)) return k;
    return count;
}

int td_fixed_batch(const tides_simulator *s, int64_t most) {
    return steps_to_knot(s, most < s->batch.steps ? (int)most : s->batch.steps);
}

void td_fixed_adapt(tides_simulator *s, const tides_render_stats *before) {
    tides_render_stats after;
    tides_renderer_stats(s->renderer, &after);
    double projected = (double)(after.gaussians_projected - before->gaussians_projected);
    double culled = (double)(after.gaussians_culled - before->gaussians_culled);
    if (culled > too_many_culled * projected && s->batch.steps > 1)
        s->batch.steps /= 2;
    else if (culled < few_culled * projected || projected == 0)
        s->batch.steps = 2 * s->batch.steps < s->batch.limit ? 2 * s->batch.steps : s->batch.limit;
}

static void store_first(const tides_simulator *s, const td_ask *ask, const double *planes, const void *user) {
    (void)user;
    store_unit(s, ask->unit, planes, &s->now);
}

static tides_status render_first(tides_simulator *s, tides_error *error) {
    tides_status status = TIDES_OK;
    td_launch_clear(&s->launch);
    for (int t = 0; t < s->layout.units && status == TIDES_OK; t++) status = td_launch_add(&s->launch, t, 0, 0, error);
    return status == TIDES_OK ? td_launch_take_all(s, TD_SIDE_BEGINS, td_fixed_outputs(s), store_first, NULL, error) : status;
}

tides_status td_begin(tides_simulator *s, tides_error *error) {
    tides_status status = td_sweep(s, 0, 0, error);
    if (status == TIDES_OK) status = render_first(s, error);
    if (status != TIDES_OK) return status;
    td_surround_steps_begin(s);
    td_sensor_begin(&s->sensor, td_seen_now(s), s->sharing.pool);
    s->started = 1;
    return TIDES_OK;
}
