/* Motion-scaled Chamfer distance (paper, Sec. 4.3): events are points (x, y, v t), so an error of time counts as the distance
 * that the image moves in it. Windows and polarities are compared separately, with one point per cell of space and time. */
#include "td_math.h"
#include "td_metrics.h"
#include "td_point_tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A cell of the current slab of time: the index of its point, which is valid if `serial` is that of the current slab. */
typedef struct cell {
    uint64_t serial;
    size_t point;
} cell;

/* The points of one stream in one window, of one polarity. */
typedef struct cloud {
    td_point *points;
    double *weights; /* number of events in each point */
    uint8_t *axes;
    size_t count, capacity, weight_capacity, axis_capacity;
} cloud;

typedef struct chamfer {
    const td_compare *compare;
    double speed, limit; /* [px/s], [px] */
    int64_t window_ns;
    cell *cells;
    size_t across;
    uint64_t serial;
    cloud clouds[2];
    td_sum weighted, weight; /* sums over windows and polarities: of a term times its points, and of the points */
    td_sum directed[2];      /* sums of distances from each stream's points */
    uint64_t points[2];      /* number of each stream's points */
} chamfer;

static size_t cell_of(double coordinate, double edge) {
    /* Coordinates are whole numbers, so a cell smaller than a pixel holds only one. */
    return (size_t)(edge > 1.0 ? floor(coordinate / edge) : coordinate);
}

static tides_status reserve(cloud *made, size_t count, tides_error *error) {
    tides_status status = td_reserve((void **)&made->points, &made->capacity, count, sizeof *made->points, error);
    if (status == TIDES_OK)
        status = td_reserve((void **)&made->weights, &made->weight_capacity, count, sizeof *made->weights, error);
    if (status == TIDES_OK) status = td_reserve((void **)&made->axes, &made->axis_capacity, count, 1, error);
    return status;
}

static void add_to_point(cloud *made, cell *here, uint64_t serial, const double at[3]) {
    if (here->serial != serial) {
        *here = (cell){serial, made->count};
        made->points[made->count] = (td_point){{0, 0, 0}};
        made->weights[made->count++] = 0;
    }
    for (int k = 0; k < 3; k++) made->points[here->point].at[k] += at[k];
    made->weights[here->point] += 1.0;
}

/* Replaces the events in each cell by their mean. Streams are in order of time, so a slab of cells is complete when the next
 * one begins. */
static tides_status thin(chamfer *f, const tides_event *events, size_t count, int polarity, int64_t window_ns, cloud *made) {
    const double edge = f->compare->options->cell_px;
    double slab = -1.0;
    made->count = 0;
    tides_status status = reserve(made, count, f->compare->error);
    if (status != TIDES_OK) return status;
    for (size_t i = 0; i < count; i++) {
        if (events[i].polarity != polarity) continue;
        const double elapsed_us = (double)(events[i].t - window_ns) / 1000.0;
        const double at[3] = {events[i].x, events[i].y, (f->speed * elapsed_us) * 1e-6};
        const double here = floor(at[2] / edge);
        if (here > slab) {
            slab = here;
            f->serial++;
        }
        add_to_point(made, &f->cells[cell_of(at[1], edge) * f->across + cell_of(at[0], edge)], f->serial, at);
    }
    for (size_t i = 0; i < made->count; i++)
        for (int k = 0; k < 3; k++) made->points[i].at[k] /= made->weights[i];
    return TIDES_OK;
}

/* Sum of the distances from each point of `from` to the nearest one of `to`. Points come in the order of their tree. So the
 * last distance, plus the step from the last point, is a bound for the next one. */
static double directed(const td_point_tree *from, const td_point_tree *to, double limit) {
    td_sum sum = {0, 0};
    double last = limit;
    for (size_t i = 0; i < from->count; i++) {
        double reach = limit;
        if (i && last < limit) {
            const td_point *a = &from->points[i - 1], *b = &from->points[i];
            const double x = a->at[0] - b->at[0], y = a->at[1] - b->at[1], z = a->at[2] - b->at[2];
            /* The bound is rounded up by more than the rounding errors. */
            reach = fmin(limit, (last + sqrt(x * x + y * y + z * z)) * (1.0 + 1e-12) + 1e-12);
        }
        last = sqrt(td_point_tree_nearest(to, &from->points[i], reach * reach));
        if (last > limit) last = limit;
        td_sum_add(&sum, last);
    }
    return td_sum_of(&sum);
}

/* Adds the term of a window and polarity. */
static void add_term(chamfer *f) {
    const size_t counts[2] = {f->clouds[0].count, f->clouds[1].count};
    const double points = (double)(counts[0] + counts[1]);
    if (counts[0] + counts[1] == 0) return;
    double sums[2] = {f->limit * (double)counts[0], f->limit * (double)counts[1]}, term = f->limit;
    f->compare->metrics->chamfer_terms++;
    if (counts[0] && counts[1]) {
        td_point_tree trees[2];
        for (int s = 0; s < 2; s++) trees[s] = td_point_tree_build(f->clouds[s].points, f->clouds[s].axes, counts[s]);
        for (int s = 0; s < 2; s++) sums[s] = directed(&trees[s], &trees[1 - s], f->limit);
        term = 0.5 * (sums[0] / (double)counts[0] + sums[1] / (double)counts[1]);
    } else {
        f->compare->metrics->chamfer_one_sided++;
    }
    td_sum_add(&f->weighted, term * points);
    td_sum_add(&f->weight, points);
    for (int s = 0; s < 2; s++) {
        td_sum_add(&f->directed[s], sums[s]);
        f->points[s] += counts[s];
    }
}

static size_t window_end(const td_stream *stream, size_t first, int64_t end_ns) {
    while (first < stream->count && stream->events[first].t < end_ns) first++;
    return first;
}

/* Goes through all windows with events. */
static tides_status walk(chamfer *f) {
    const td_compare *c = f->compare;
    const td_stream *streams[2] = {&c->reference, &c->simulated};
    size_t first[2] = {0, 0}, end[2];
    while (first[0] < streams[0]->count || first[1] < streams[1]->count) {
        int64_t next = INT64_MAX;
        for (int s = 0; s < 2; s++)
            if (first[s] < streams[s]->count && streams[s]->events[first[s]].t < next) next = streams[s]->events[first[s]].t;
        const int64_t window_ns = next / f->window_ns * f->window_ns;
        for (int s = 0; s < 2; s++) end[s] = window_end(streams[s], first[s], window_ns + f->window_ns);
        for (int polarity = -1; polarity <= 1; polarity += 2) {
            for (int s = 0; s < 2; s++) {
                tides_status status =
                    thin(f, streams[s]->events + first[s], end[s] - first[s], polarity, window_ns, &f->clouds[s]);
                if (status != TIDES_OK) return status;
            }
            add_term(f);
        }
        memcpy(first, end, sizeof first);
        tides_status status = td_compare_report(c, (double)window_ns / (double)c->span_ns, "Chamfer");
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}

static void summarise(const chamfer *f, double diagonal) {
    tides_metrics *m = f->compare->metrics;
    if (m->chamfer_terms == 0) return;
    m->chamfer_px = td_sum_of(&f->weighted) / td_sum_of(&f->weight);
    m->chamfer_fraction = m->chamfer_px / diagonal;
    if (f->points[0]) m->chamfer_to_simulated_px = td_sum_of(&f->directed[0]) / (double)f->points[0];
    if (f->points[1]) m->chamfer_to_reference_px = td_sum_of(&f->directed[1]) / (double)f->points[1];
}

tides_status td_compare_chamfer(td_compare *c) {
    const tides_metrics_options *o = c->options;
    tides_metrics *m = c->metrics;
    m->speed_px_per_s = o->speed_px_per_s;
    if (!(o->speed_px_per_s > 0)) {
        tides_status status = td_compare_speed(c, &m->speed_px_per_s);
        if (status != TIDES_OK) return status;
    }
    if (isnan(m->speed_px_per_s) || c->width == 0) return TIDES_OK;
    const double diagonal = td_hypot(c->width, c->height);
    m->chamfer_limit_px = fmin(m->speed_px_per_s * o->window_s, diagonal);
    const size_t across = cell_of(c->width - 1, o->cell_px) + 1, down = cell_of(c->height - 1, o->cell_px) + 1;
    chamfer f = {.compare = c, .speed = m->speed_px_per_s, .limit = m->chamfer_limit_px, .across = across};
    f.window_ns = llround(1e9 * o->window_s);
    f.cells = td_alloc(across * down, sizeof *f.cells, c->error);
    tides_status status = f.cells ? walk(&f) : TIDES_NO_MEMORY;
    if (status == TIDES_OK) summarise(&f, diagonal);
    free(f.cells);
    for (int s = 0; s < 2; s++) {
        free(f.clouds[s].points);
        free(f.clouds[s].weights);
        free(f.clouds[s].axes);
    }
    return status;
}
