/* Mean light over the exposures of a band of tiles, with as many renders as the tolerance needs. An exposure is divided into
 * panels, intervals between two nodes with a third node in their middle. It works level by level: all new nodes are rendered
 * in one batch, then each panel's error is estimated, and the panels that are cut make the next level. */
#include "td_expose.h"

#include "td_extremes.h"
#include "td_sort.h"

#include <math.h>
#include <stdlib.h>

/* How far splats may travel in a first panel, in their own diameters. A panel has a node in its middle, so that at most one
 * diameter lies between two nodes, and no splat passes a tile unseen. */
static const double travel_of_panel = 2;

/* Tiles rendered in one batch: a frame at 346x260 px, with 15 planes of 2 kB each. */
enum { BATCH_TILES = 512 };

/* A tile at one time. `lights` is the place of its light and rate, per pixel of each plane. */
typedef struct node {
    int tile, part;
} node;

/* An interval of a tile's exposure between two nodes, with a third one in its middle. */
typedef struct panel {
    int tile, node[3]; /* begin, middle and end */
    int cut;           /* 1: replaced by its halves */
} panel;

/* Weights of a cubic's two values and two rates in the mean over a row. */
typedef struct weights {
    double w[4];
} weights;

typedef struct expose_job {
    tides_renderer *renderer;
    const tides_trajectory *camera;
    td_expose_band *band;
    int tiles_x, tile_count; /* tiles of the band in reading order */
    node *nodes;
    double *lights; /* (nodes x planes x 2 x TD_TILE_PIXELS) */
    size_t node_count, node_capacity, light_capacity, rendered;
    panel *panels;
    float *errors; /* (panels x TD_TILE_PIXELS) error of each panel's mean */
    size_t panel_count, panel_capacity, error_capacity, judged;
    double *sums;  /* (tiles x TD_TILE_PIXELS) sum of a pixel's errors */
    int *leaves;   /* (tiles) number of panels that aren't cut */
    int *unknown;  /* (tiles) 1: an event may be shorter than any panel */
    double *times; /* scratch for a batch */
    td_request *requests;
    double *planes;
} expose_job;

td_row_window td_expose_tile_row(const td_expose_band *band, int height, int tile_row) {
    const int first = tile_row * TD_TILE, last = first + TD_TILE < height ? first + TD_TILE - 1 : height - 1;
    const td_row_window a = band->rows[first], b = band->rows[last];
    return (td_row_window){td_lesser(a.start, b.start), td_greater(a.stop, b.stop)};
}

static td_row_window exposure_of(const expose_job *job, int tile) {
    return td_expose_tile_row(job->band, job->renderer->image.height, job->band->first + tile / job->tiles_x);
}

/* The part of a tile's exposure within the stretch; empty if stop < start. */
static td_row_window window_of(const expose_job *job, int tile) {
    const td_row_window all = exposure_of(job, tile), stretch = job->band->stretch;
    return (td_row_window){td_greater(all.start, stretch.start), td_lesser(all.stop, stretch.stop)};
}

/* 1 if part of a tile's exposure is in the stretch. An instant on the border of two stretches belongs to the later one. */
static int is_exposed(const expose_job *job, int tile) {
    const td_row_window all = exposure_of(job, tile), stretch = job->band->stretch, own = window_of(job, tile);
    if (all.stop > all.start) return own.stop > own.start;
    return all.start >= stretch.start && (all.start < stretch.stop || stretch.stop >= job->band->all.stop);
}

/* The share of a tile's exposure in the stretch. */
static double share_of(const expose_job *job, int tile) {
    const td_row_window all = exposure_of(job, tile), own = window_of(job, tile);
    return all.stop > all.start ? (own.stop - own.start) / (all.stop - all.start) : 1;
}

/* 1 if `time` is the end of the tile's exposure, which counts as exposed. The end of another stretch belongs to the next
 * one. */
static int is_last(const expose_job *job, int tile, double time) { return time >= exposure_of(job, tile).stop; }

static double time_of(const expose_job *job, const node *n) {
    const td_row_window w = window_of(job, n->tile);
    return n->part == TD_EXPOSE_PARTS ? w.stop : w.start + (w.stop - w.start) * n->part / TD_EXPOSE_PARTS;
}

static size_t node_size(const expose_job *job) { return (size_t)job->band->planes * 2 * TD_TILE_PIXELS; }

/* -- nodes ----------------------------------------------------------------------------------------------------------- */

static tides_status add_node(expose_job *job, int tile, int part, int *at, tides_error *error) {
    tides_status status = td_reserve((void **)&job->nodes, &job->node_capacity, job->node_count + 1, sizeof *job->nodes, error);
    if (status != TIDES_OK) return status;
    *at = (int)job->node_count;
    job->nodes[job->node_count++] = (node){tile, part};
    return TIDES_OK;
}

/* The distinct times of nodes, ascending. */
static int gather_times(const expose_job *job, size_t first, int count, double *times) {
    int distinct = 0;
    for (int i = 0; i < count; i++) times[i] = time_of(job, &job->nodes[first + (size_t)i]);
    qsort(times, (size_t)count, sizeof *times, td_ascending);
    for (int i = 0; i < count; i++)
        if (distinct == 0 || times[i] > times[distinct - 1]) times[distinct++] = times[i];
    return distinct;
}

/* Converts a rendered tile to light and its rate. */
static void take_light(const expose_job *job, const double *planes, double *light) {
    const double log_eps = (double)job->renderer->image.log_eps;
    if (job->band->planes == 3) {
        memcpy(light, planes + TD_OUT_R * TD_TILE_PIXELS, 3 * TD_TILE_PIXELS * sizeof *light);
        memcpy(light + 3 * TD_TILE_PIXELS, planes + TD_OUT_R_DOT * TD_TILE_PIXELS, 3 * TD_TILE_PIXELS * sizeof *light);
        return;
    }
    for (int k = 0; k < TD_TILE_PIXELS; k++) {
        light[k] = planes[TD_OUT_Y * TD_TILE_PIXELS + k];
        light[TD_TILE_PIXELS + k] = planes[TD_OUT_L_DOT * TD_TILE_PIXELS + k] * (light[k] + log_eps);
    }
}

static tides_status render_some(expose_job *job, size_t first, int count, tides_error *error) {
    const int outputs = job->band->planes == 3 ? TD_OUT_COLOUR : TD_OUT_SIGNAL_Y;
    const int slots = gather_times(job, first, count, job->times);
    for (int i = 0; i < count; i++) {
        const node *n = &job->nodes[first + (size_t)i];
        const double time = time_of(job, n), *slot = bsearch(&time, job->times, (size_t)slots, sizeof time, td_ascending);
        job->requests[i] = (td_request){job->band->first * job->tiles_x + n->tile, (int)(slot - job->times), 0};
    }
    const td_tile_batch batch = {job->times, slots, TD_SIDE_BEGINS, job->requests, count, outputs};
    tides_status status = td_renderer_sharp_tiles(job->renderer, job->camera, &batch, job->planes, error);
    for (int i = 0; i < count && status == TIDES_OK; i++)
        take_light(job, job->planes + (size_t)i * (size_t)outputs * TD_TILE_PIXELS,
                   job->lights + (first + (size_t)i) * node_size(job));
    return status;
}

/* Renders all nodes that aren't rendered yet. */
static tides_status render_nodes(expose_job *job, tides_error *error) {
    tides_status status =
        td_reserve((void **)&job->lights, &job->light_capacity, job->node_count * node_size(job), sizeof *job->lights, error);
    while (job->rendered < job->node_count && status == TIDES_OK) {
        const size_t left = job->node_count - job->rendered;
        const int count = left < BATCH_TILES ? (int)left : BATCH_TILES;
        status = render_some(job, job->rendered, count, error);
        job->rendered += (size_t)count;
        job->band->tiles += (uint64_t)count;
    }
    return status;
}

/* -- means ----------------------------------------------------------------------------------------------------------- */

/* Integrals from 0 to u of the Hermite basis: of both values, then of both rates. */
static void integrals(double u, double out[4]) {
    const double u2 = u * u, u3 = u2 * u, u4 = u2 * u2;
    out[0] = u - u3 + 0.5 * u4;
    out[1] = u3 - 0.5 * u4;
    out[2] = 0.5 * u2 - 2.0 / 3 * u3 + 0.25 * u4;
    out[3] = 0.25 * u4 - u3 / 3;
}

/* The Hermite basis at u. */
static void cubics(double u, double out[4]) {
    const double u2 = u * u, u3 = u2 * u;
    out[0] = 1 - 3 * u2 + 2 * u3;
    out[1] = 3 * u2 - 2 * u3;
    out[2] = u - 2 * u2 + u3;
    out[3] = u3 - u2;
}

/* Weights of [from, to] in the mean over a row's exposure; `last`: the piece holds the last moment of the tile's exposure. */
static weights weights_of(td_row_window row, double from, double to, int last) {
    const double span = to - from, a = td_greater(row.start, from), b = td_lesser(row.stop, to);
    weights made = {{0, 0, 0, 0}};
    double high[4], low[4] = {0, 0, 0, 0}, scale = 1;
    if (row.stop > row.start) {
        if (!(b > a)) return made;
        integrals((b - from) / span, high);
        integrals((a - from) / span, low);
        scale = span / (row.stop - row.start);
    } else {
        if (row.start < from || row.start > to || (row.start == to && !last)) return made;
        cubics((row.start - from) / span, high);
    }
    for (int k = 0; k < 4; k++) made.w[k] = scale * (high[k] - low[k]);
    made.w[2] *= span;
    made.w[3] *= span;
    return made;
}

/* The weights of all rows of a tile, for the piece between two nodes. */
static void row_weights(const expose_job *job, int from, int to, weights rows[TD_TILE]) {
    const node *a = &job->nodes[from], *b = &job->nodes[to];
    const int y0 = (job->band->first + a->tile / job->tiles_x) * TD_TILE, height = job->renderer->image.height;
    for (int y = 0; y < TD_TILE; y++) {
        const int row = y0 + y < height ? y0 + y : height - 1;
        rows[y] = weights_of(job->band->rows[row], time_of(job, a), time_of(job, b), is_last(job, a->tile, time_of(job, b)));
    }
}

/* A piece's part of the mean, for one pixel of a plane. */
static inline double part_of(const expose_job *job, int from, int to, const double w[4], int plane, int pixel) {
    const size_t size = node_size(job), at = (size_t)plane * TD_TILE_PIXELS + (size_t)pixel, rate = size / 2;
    const double *a = job->lights + (size_t)from * size + at, *b = job->lights + (size_t)to * size + at;
    return w[0] * a[0] + w[1] * b[0] + w[2] * a[rate] + w[3] * b[rate];
}

/* 1 if pixel i of the tile is within the image. */
static int is_pixel(const expose_job *job, int tile, int i) {
    const td_image *image = &job->renderer->image;
    return tile % job->tiles_x * TD_TILE + i % TD_TILE < image->width &&
           (job->band->first + tile / job->tiles_x) * TD_TILE + i / TD_TILE < image->height;
}

/* Distance of the panel's own cubic from the middle node: in value and slope. */
static double bend_of(const expose_job *job, const panel *p, double span, int plane, int pixel) {
    const size_t size = node_size(job), at = (size_t)plane * TD_TILE_PIXELS + (size_t)pixel;
    const double *f0 = job->lights + (size_t)p->node[0] * size + at, *fm = job->lights + (size_t)p->node[1] * size + at,
                 *f1 = job->lights + (size_t)p->node[2] * size + at;
    const size_t rate = size / 2;
    const double value = fm[0] - 0.5 * (f0[0] + f1[0]) - 0.125 * span * (f0[rate] - f1[rate]);
    const double slope = span * (fm[rate] + 0.25 * (f0[rate] + f1[rate])) - 1.5 * (f1[0] - f0[0]);
    return fabs(value) + fabs(slope);
}

/* A panel from the point of view of one row. */
typedef struct row_look {
    weights whole, half[2];
    double share; /* share of the row's exposure that the panel covers */
    int in_part;  /* 1: the row's exposure begins or ends within the panel */
} row_look;

static void look_of(const expose_job *job, const panel *p, row_look looks[TD_TILE]) {
    weights rows[3][TD_TILE];
    const double from = time_of(job, &job->nodes[p->node[0]]), to = time_of(job, &job->nodes[p->node[2]]);
    const int y0 = (job->band->first + p->tile / job->tiles_x) * TD_TILE, height = job->renderer->image.height;
    row_weights(job, p->node[0], p->node[2], rows[0]);
    row_weights(job, p->node[0], p->node[1], rows[1]);
    row_weights(job, p->node[1], p->node[2], rows[2]);
    for (int y = 0; y < TD_TILE; y++) {
        const td_row_window *w = &job->band->rows[y0 + y < height ? y0 + y : height - 1];
        const double share = rows[0][y].w[0] + rows[0][y].w[1];
        looks[y] = (row_look){rows[0][y], {rows[1][y], rows[2][y]}, share, w->start > from || w->stop < to};
    }
}

/* Estimates the error of a panel's halves for a pixel of a plane. If the row's exposure covers the panel, that is half the
 * difference between halves and whole panel. But with a kink at a quarter, both have the same integral, and the middle's
 * value is right. So it is also at least a quarter of the deviation in value and slope at the middle, which is 1.5 times what
 * a kink anywhere costs the halves. If the exposure covers a part, down to an instant, the difference may vanish by chance,
 * and a kink costs up to half of the deviation. For smooth signals the two estimates are equal. */
static double error_of(const expose_job *job, const panel *p, const row_look *look, double span, int plane, int pixel) {
    const double bend = look->share * bend_of(job, p, span, plane, pixel);
    if (look->in_part) return 0.5 * bend;
    const double apart = part_of(job, p->node[0], p->node[1], look->half[0].w, plane, pixel) +
                         part_of(job, p->node[1], p->node[2], look->half[1].w, plane, pixel) -
                         part_of(job, p->node[0], p->node[2], look->whole.w, plane, pixel);
    return td_greater(0.5 * fabs(apart), 0.25 * bend);
}

/* Sets the error of a panel in each pixel: that of the worst plane. */
static void judge(expose_job *job, size_t index) {
    const panel *p = &job->panels[index];
    const double span = time_of(job, &job->nodes[p->node[2]]) - time_of(job, &job->nodes[p->node[0]]);
    row_look looks[TD_TILE];
    look_of(job, p, looks);
    for (int i = 0; i < TD_TILE_PIXELS; i++) {
        const int y = i / TD_TILE, pixel = td_tile_pixel(i % TD_TILE, y);
        double worst = 0;
        for (int c = 0; c < job->band->planes && is_pixel(job, p->tile, i); c++)
            worst = td_greater(worst, error_of(job, p, &looks[y], span, c, pixel));
        job->errors[index * TD_TILE_PIXELS + (size_t)i] = (float)worst;
        job->sums[(size_t)p->tile * TD_TILE_PIXELS + (size_t)i] += job->errors[index * TD_TILE_PIXELS + (size_t)i];
    }
    job->leaves[p->tile]++;
}

/* -- panels ---------------------------------------------------------------------------------------------------------- */

/* Adds a panel between two existing nodes, and a node in its middle. */
static tides_status add_panel(expose_job *job, int tile, int from, int to, tides_error *error) {
    tides_status status =
        td_reserve((void **)&job->panels, &job->panel_capacity, job->panel_count + 1, sizeof *job->panels, error);
    panel made = {tile, {from, -1, to}, 0};
    if (status == TIDES_OK)
        status = add_node(job, tile, (job->nodes[from].part + job->nodes[to].part) / 2, &made.node[1], error);
    if (status == TIDES_OK) job->panels[job->panel_count++] = made;
    return status;
}

double td_expose_asked(const tides_renderer *r, const td_expose_band *band, int tile) {
    double most = 0;
    for (; r && band->asked; r = r->beside) { /* channels see the same splats, at other places of their lists */
        const td_candidates *lists = &r->candidates;
        for (int i = lists->first[tile]; i < lists->first[tile + 1]; i++)
            if (lists->list[i] != TD_NO_GAUSSIAN) most = td_greater(most, (double)band->asks[lists->list[i]]);
    }
    return most;
}

/* Number of panels that a tile begins with: from the travel of its splats, and from their scales of time. It is a power of
 * two, so that tiles share times. `*unknown`: more would be needed. */
static int first_panels(const expose_job *job, int tile, int *unknown) {
    const int number = job->band->first * job->tiles_x + tile;
    const double *swept = job->renderer->sweep.interval;
    const td_row_window w = window_of(job, tile);
    const double part = (w.stop - w.start) / (swept[1] - swept[0]);
    const double travel = td_renderer_tile_travel(job->renderer, number) * part;
    const double asked = td_expose_asked(job->renderer, job->band, number) * part;
    int panels = 1;
    while (panels < TD_EXPOSE_PANELS && (travel > travel_of_panel * panels || asked > panels)) panels *= 2;
    *unknown = asked > panels;
    return panels;
}

/* Adds a tile's first panels; for a tile at rest, one node and no panel. */
static tides_status begin_tile(expose_job *job, int tile, tides_error *error) {
    const td_row_window w = window_of(job, tile);
    int from = 0, to = 0;
    if (!is_exposed(job, tile)) return TIDES_OK;
    tides_status status = add_node(job, tile, 0, &from, error);
    if (status != TIDES_OK || !(w.stop > w.start) ||
        !td_renderer_tile_moves(job->renderer, job->band->first * job->tiles_x + tile))
        return status;
    const int panels = first_panels(job, tile, &job->unknown[tile]);
    for (int k = 1; k <= panels && status == TIDES_OK; k++) {
        status = add_node(job, tile, TD_EXPOSE_PARTS / panels * k, &to, error);
        if (status == TIDES_OK) status = add_panel(job, tile, from, to, error);
        from = to;
    }
    return status;
}

/* 1 if a pixel's sum is above the tolerance, and this panel has more than half its share of the allowed sum. */
static int wants_cut(const expose_job *job, const panel *p, const float *errors) {
    const double tolerance = job->band->tolerance * share_of(job, p->tile), share = 0.5 * tolerance / job->leaves[p->tile];
    const double *sums = job->sums + (size_t)p->tile * TD_TILE_PIXELS;
    for (int i = 0; i < TD_TILE_PIXELS; i++)
        if (sums[i] > tolerance && errors[i] > share) return 1;
    return 0;
}

/* Cuts panels into halves, which go to the end of the list; *any is 0 if there were none. */
static tides_status cut_panels(expose_job *job, int *any, tides_error *error) {
    tides_status status = TIDES_OK;
    const size_t count = job->panel_count;
    *any = 0;
    for (size_t i = 0; i < count && status == TIDES_OK; i++) {
        const panel p = job->panels[i];
        if (p.cut || job->nodes[p.node[2]].part - job->nodes[p.node[0]].part < 4) continue; /* halves need middles */
        if (!wants_cut(job, &p, job->errors + i * TD_TILE_PIXELS)) continue;
        *any = job->panels[i].cut = 1;
        status = add_panel(job, p.tile, p.node[0], p.node[1], error);
        if (status == TIDES_OK) status = add_panel(job, p.tile, p.node[1], p.node[2], error);
    }
    for (size_t i = 0; i < count; i++) { /* only now, so that all panels were judged by the same sums */
        const panel *p = &job->panels[i];
        if (p->cut != 1) continue;
        job->panels[i].cut = 2;
        job->leaves[p->tile]--;
        for (int k = 0; k < TD_TILE_PIXELS; k++)
            job->sums[(size_t)p->tile * TD_TILE_PIXELS + (size_t)k] -= job->errors[i * TD_TILE_PIXELS + (size_t)k];
    }
    return status;
}

static tides_status refine(expose_job *job, tides_error *error) {
    tides_status status = TIDES_OK;
    for (int any = 1; any && status == TIDES_OK;) {
        status = render_nodes(job, error);
        if (status == TIDES_OK)
            status = td_reserve((void **)&job->errors, &job->error_capacity, job->panel_count * TD_TILE_PIXELS,
                                sizeof *job->errors, error);
        if (status != TIDES_OK) return status;
        for (; job->judged < job->panel_count; job->judged++) judge(job, job->judged);
        status = cut_panels(job, &any, error);
    }
    return status;
}

/* -- the result ------------------------------------------------------------------------------------------------------ */

/* The weights of a tile's rows if one node stands for the whole stretch. */
static void rest_weights(const expose_job *job, int tile, weights rows[TD_TILE]) {
    const int y0 = (job->band->first + tile / job->tiles_x) * TD_TILE, height = job->renderer->image.height;
    const td_row_window w = window_of(job, tile);
    const int whole = share_of(job, tile) >= 1;
    for (int y = 0; y < TD_TILE; y++) {
        const td_row_window row = job->band->rows[y0 + y < height ? y0 + y : height - 1];
        rows[y] = whole ? (weights){{1, 0, 0, 0}} : weights_of(row, w.start, w.stop, is_last(job, tile, w.stop));
        rows[y] = (weights){{rows[y].w[0] + rows[y].w[1], 0, 0, 0}};
    }
}

/* Adds a panel's halves to the band's light; for a tile with a single node (`from` is `to`), all of its light. */
static void add_light(const expose_job *job, int tile, int from, int to) {
    const td_image *image = &job->renderer->image;
    const int x0 = tile % job->tiles_x * TD_TILE, y0 = (job->band->first + tile / job->tiles_x) * TD_TILE;
    weights rows[TD_TILE];
    if (from != to)
        row_weights(job, from, to, rows);
    else
        rest_weights(job, tile, rows);
    for (int y = 0; y < TD_TILE && y0 + y < image->height; y++)
        for (int x = 0; x < TD_TILE && x0 + x < image->width; x++)
            for (int c = 0; c < job->band->planes; c++)
                job->band->light[((size_t)c * image->height + (size_t)(y0 + y)) * image->width + (size_t)(x0 + x)] +=
                    part_of(job, from, to, rows[y].w, c, td_tile_pixel(x, y));
}

/* Notes each pixel's brightest value at any node of its tile. */
static void note_brightest(const expose_job *job, const node *n, const double *light, float *brightest) {
    const int planes = job->band->planes;
    for (int c = 0; c < planes && job->unknown[n->tile]; c++)
        for (int i = 0; i < TD_TILE_PIXELS; i++) {
            float *own = &brightest[n->tile * TD_TILE_PIXELS + i];
            *own = fmaxf(*own, (float)light[c * TD_TILE_PIXELS + td_tile_pixel(i % TD_TILE, i / TD_TILE)]);
        }
}

/* Marks pixels as doubtful whose light may have changed between nodes. The change isn't known, so the error is their
 * brightest value. */
static tides_status doubt_unknown(expose_job *job, tides_error *error) {
    float *brightest = td_alloc((size_t)job->tile_count * TD_TILE_PIXELS, sizeof *brightest, error);
    if (!brightest) return TIDES_NO_MEMORY;
    for (size_t k = 0; k < job->node_count; k++)
        note_brightest(job, &job->nodes[k], job->lights + k * node_size(job), brightest);
    for (int tile = 0; tile < job->tile_count; tile++)
        for (int i = 0; i < TD_TILE_PIXELS && job->unknown[tile]; i++) {
            const int at = tile * TD_TILE_PIXELS + i;
            if (is_pixel(job, tile, i)) job->sums[at] += td_greater(2 * job->band->tolerance, (double)brightest[at]);
        }
    free(brightest);
    return TIDES_OK;
}

/* Adds up light and errors, in the order of the panels. */
static void finish(expose_job *job) {
    for (size_t i = 0; i < job->node_count; i++) /* a tile without panels has one node */
        if (job->nodes[i].part == 0 && job->leaves[job->nodes[i].tile] == 0) add_light(job, job->nodes[i].tile, (int)i, (int)i);
    for (size_t i = 0; i < job->panel_count; i++) {
        const panel *p = &job->panels[i];
        if (p->cut) continue;
        add_light(job, p->tile, p->node[0], p->node[1]);
        add_light(job, p->tile, p->node[1], p->node[2]);
    }
    for (size_t i = 0; i < (size_t)job->tile_count * TD_TILE_PIXELS; i++) job->band->sums[i] += job->sums[i];
}

static void release(expose_job *job) {
    free(job->nodes);
    free(job->lights);
    free(job->panels);
    free(job->errors);
    free(job->sums);
    free(job->leaves);
    free(job->unknown);
    free(job->times);
    free(job->requests);
    free(job->planes);
}

tides_status td_expose_panels(tides_renderer *renderer, const tides_trajectory *camera, td_expose_band *band,
                              tides_error *error) {
    const int tiles_x = renderer->candidates.tiles_x, tiles = tiles_x * (band->last - band->first);
    expose_job job = {.renderer = renderer, .camera = camera, .band = band, .tiles_x = tiles_x, .tile_count = tiles};
    const size_t outputs = band->planes == 3 ? TD_OUT_COLOUR : TD_OUT_SIGNAL_Y;
    job.sums = td_alloc((size_t)tiles * TD_TILE_PIXELS, sizeof *job.sums, error);
    job.leaves = td_alloc((size_t)tiles, sizeof *job.leaves, error);
    job.unknown = td_alloc((size_t)tiles, sizeof *job.unknown, error);
    job.times = td_alloc(BATCH_TILES, sizeof *job.times, error);
    job.requests = td_alloc(BATCH_TILES, sizeof *job.requests, error);
    job.planes = td_alloc(BATCH_TILES * outputs * TD_TILE_PIXELS, sizeof *job.planes, error);
    tides_status status =
        job.sums && job.leaves && job.unknown && job.times && job.requests && job.planes ? TIDES_OK : TIDES_NO_MEMORY;
    for (int tile = 0; tile < tiles && status == TIDES_OK; tile++) status = begin_tile(&job, tile, error);
    if (status == TIDES_OK) status = refine(&job, error);
    if (status == TIDES_OK && band->asked) status = doubt_unknown(&job, error);
    if (status == TIDES_OK) finish(&job);
    release(&job);
    return status;
}
