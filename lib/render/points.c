/* Points: pixels at times of their own, on which the solver places events. First, rows of record paths for the interval swept
 * last are found; then lists of the tiles with points; then values, tile by tile.
 *
 * A kept instant, which stays available after later sweeps, has an engine of its own. With one engine for both, preparing it
 * again for each interval would cost as much as asking for the instant's points late saves. */
#include "td_point_nodes.h"
#include "td_point_order.h"
#include "td_point_parts.h"
#include "td_points_direct.h"
#include "td_points_wanted.h"
#include "td_renderer.h"

#include <math.h>
#include <stdlib.h>

enum { POINTS_AT_ONCE = 1 << 16 }; /* per launch: 5 MB with all their data */

/* The points of a part of the interval that are asked for. */
typedef struct points_asked {
    const td_point *points;
    td_point_value *values;
    int *which; /* (count) their numbers */
    int count;
    int *order; /* (count) scratch */
} points_asked;

struct td_points {
    td_points_engine *engine;
    td_point_nodes nodes;
    td_point_span at; /* the interval that is asked for */
    td_point_parts parts;
    int begun;                 /* the part whose rows are there; -1: none */
    int *own_first, *own_list; /* copies of its lists and boxes, of an instant that is kept; else NULL */
    float *own_boxes;
    td_points_tile *tiles; /* (tiles) */
    td_points_wanted asks;
    int *wanted;           /* (tiles) lists to make */
    td_point_place *place; /* of order_points */
    size_t place_capacity;
    int *which; /* (2 x points requested) used by exact_points */
    size_t which_capacity;
    td_points_some away; /* the running launch; count 0: there is none */
    td_points_direct direct;
    double *column[TD_POINT_COLUMNS]; /* (points of a launch + TD_PAD) */
    int *piece;
    td_points_chunk *chunks;
    double *values;
};

/* Ends the launch that is under way; its results are dropped. */
static void drop_launch(td_points *p) {
    if (p->away.count == 0) return;
    tides_status ignored = p->engine->type->finish(p->engine, NULL);
    (void)ignored;
    p->away.count = 0;
}

void td_points_destroy(td_points *points) {
    if (!points) return;
    drop_launch(points);
    if (points->engine) points->engine->type->destroy(points->engine);
    td_points_direct_release(&points->direct);
    td_point_nodes_release(&points->nodes);
    for (int k = 0; k < TD_POINT_COLUMNS; k++) free(points->column[k]);
    td_point_parts_release(&points->parts);
    free(points->own_first);
    free(points->own_list);
    free(points->own_boxes);
    free(points->tiles);
    td_points_wanted_release(&points->asks);
    free(points->wanted);
    free(points->place);
    free(points->which);
    free(points->piece);
    free(points->chunks);
    free(points->values);
    free(points);
}

static tides_status allocate(const tides_renderer *renderer, td_points *p, tides_error *error) {
    size_t tiles = (size_t)renderer->stats.tiles, launch = POINTS_AT_ONCE + TD_PAD;
    p->tiles = td_alloc(tiles, sizeof *p->tiles, error);
    p->wanted = td_alloc(tiles, sizeof *p->wanted, error);
    p->piece = td_alloc(launch, sizeof *p->piece, error);
    p->chunks = td_alloc(launch, sizeof *p->chunks, error);
    p->values = td_alloc(2 * launch, sizeof *p->values, error);
    int all = p->tiles && p->wanted && p->piece && p->chunks && p->values;
    for (int k = 0; k < TD_POINT_COLUMNS; k++) {
        p->column[k] = td_alloc(launch, sizeof *p->column[k], error);
        all = all && p->column[k];
    }
    return all ? td_points_wanted_create(renderer, &p->asks, error) : TIDES_NO_MEMORY;
}

/* `shared`: the scene in double of another td_points, or NULL. */
static tides_status create_points(const tides_renderer *renderer, td_exact *shared, td_points **points, tides_error *error) {
    const td_image_numbers image = td_image_pack(&renderer->image);
    td_points *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    const double begun = td_now();
    tides_status status = allocate(renderer, made, error);
    if (status == TIDES_OK) status = td_point_nodes_create(renderer, shared, &made->nodes, error);
    if (status == TIDES_OK) status = td_points_create_engine(renderer, &image, &made->engine, error);
    renderer->backend->stats.time_build_s += td_now() - begun;
    if (status == TIDES_OK)
        *points = made;
    else
        td_points_destroy(made);
    return status;
}

tides_status td_renderer_exact_points(tides_renderer *renderer, tides_error *error) {
    if (renderer->points) return TIDES_OK;
    const char *why = td_renderer_lacks_exact_points(renderer);
    if (why) return td_fail(error, TIDES_UNSUPPORTED, "single pixels can't be worked out in double precision: %s", why);
    tides_status status = create_points(renderer, NULL, &renderer->points, error);
    return status == TIDES_OK && renderer->beside ? td_renderer_exact_points(renderer->beside, error) : status;
}

void td_renderer_points_groups(tides_renderer *renderer, int group, int some) {
    renderer->points->nodes.group_size = group;
    renderer->points->nodes.sample_size = some;
}

static void lay_tiles(const tides_renderer *renderer, td_points *p) {
    const int across = renderer->candidates.tiles_x, *first = p->at.first;
    for (int tile = 0; tile < renderer->stats.tiles; tile++) {
        p->tiles[tile].x = tile % across * TD_TILE;
        p->tiles[tile].y = tile / across * TD_TILE;
        p->tiles[tile].first = first[tile];
        p->tiles[tile].count = first[tile + 1] - first[tile];
    }
}

/* The group that has got paths last is the engine's. */
static tides_status add_group(const tides_renderer *renderer, td_points *p, tides_error *error) {
    td_points_group added = td_point_nodes_group(&p->nodes);
    if (added.seen_count == 0) return TIDES_OK;
    tides_status status = td_points_wanted_sights(renderer, &p->asks, &p->at, &added, error);
    if (status == TIDES_OK) status = p->engine->type->add(p->engine, &added, error);
    return status == TIDES_OK ? td_points_direct_add(renderer, &p->nodes, p->at.boxes, &p->direct, error) : status;
}

/* Makes paths for the Gaussians that the points numbered which[0 .. count) may see. */
static tides_status add_wanted(tides_renderer *renderer, const tides_trajectory *camera, td_points *p, const td_point *points,
                               const int *which, int count, tides_error *error) {
    tides_status status = td_points_wanted_find(renderer, &p->asks, &p->nodes, &p->at, points, which, count, error);
    while (p->nodes.wanted_count > 0 && status == TIDES_OK) {
        status = td_point_nodes_next(renderer, camera, p->engine, &p->nodes, error);
        if (status == TIDES_OK) status = add_group(renderer, p, error);
    }
    if (status != TIDES_OK) p->begun = -1; /* what has a path isn't known */
    td_points_wanted_found(&p->asks);
    return status;
}

/* The pieces of a part, unless they are there; or it is halved. */
static tides_status begin_part(tides_renderer *renderer, const tides_trajectory *camera, td_points *p, int k,
                               tides_error *error) {
    td_point_nodes *nodes = &p->nodes;
    td_point_span span = p->at;
    if (p->begun == k) return TIDES_OK;
    p->begun = -1;
    span.start = p->parts.part[k].start;
    span.stop = p->parts.part[k].stop;
    lay_tiles(renderer, p);
    tides_status status = td_point_nodes_find(renderer, camera, p->engine, &span, nodes, error);
    if (status != TIDES_OK) return status;
    if (!isnan(nodes->halve)) return td_point_parts_halve(&p->parts, k, nodes->halve, error);
    const td_points_interval interval = {.gaussians = renderer->store.count,
                                         .curves = td_point_nodes_expected(nodes),
                                         .slices = td_point_nodes_slices(nodes),
                                         .candidates = p->at.list,
                                         .candidate_count = p->at.first[renderer->stats.tiles],
                                         .tiles = p->tiles,
                                         .tile_count = renderer->stats.tiles};
    status = p->engine->type->begin(p->engine, &interval, error);
    td_points_wanted_clear(renderer, &p->asks);
    td_points_direct_clear(renderer, &p->direct);
    if (status == TIDES_OK) status = add_group(renderer, p, error);
    if (status == TIDES_OK) p->begun = k;
    return status;
}

static int tile_of(const tides_renderer *renderer, const td_point *point) {
    return point->y / TD_TILE * renderer->candidates.tiles_x + point->x / TD_TILE;
}

/* The piece that a time is in. */
static int piece_of(const td_point_nodes *nodes, double time) {
    int low = 0, high = nodes->pieces - 1;
    while (low < high) {
        const int middle = (low + high + 1) / 2;
        if (nodes->knot[middle] <= time)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

/* Place of a point in its tile and in the interval. */
static td_point_place place_of(const td_points *p, const td_point *point, int which) {
    const td_point_part *part = &p->parts.part[p->begun];
    const double length = part->stop - part->start;
    int step = length > 0 ? (int)((point->time - part->start) / length * TD_PLACE_STEPS) : 0;
    if (step >= TD_PLACE_STEPS) step = TD_PLACE_STEPS - 1;
    return (td_point_place){{(uint8_t)(point->x % TD_TILE), (uint8_t)(point->y % TD_TILE), (uint8_t)step}, which};
}

/* Finds where each tile's points begin, of those numbered which[0 .. count), or of all where that is NULL: begin (tiles). */
static void count_points(const tides_renderer *renderer, const td_point *points, const int *which, int count, int *begin) {
    const int tiles = renderer->stats.tiles;
    memset(begin, 0, (size_t)tiles * sizeof *begin);
    for (int i = 0; i < count; i++) begin[tile_of(renderer, &points[which ? which[i] : i])]++;
    for (int i = 0, sum = 0; i < tiles; i++) {
        const int own = begin[i];
        begin[i] = sum;
        sum += own;
    }
}

/* Orders the points which[0 .. count) tile by tile, with neighbours together: order (count). */
static tides_status order_points(const tides_renderer *renderer, td_points *p, const td_point *points, const int *which,
                                 int count, int *order, tides_error *error) {
    tides_status status = td_reserve((void **)&p->place, &p->place_capacity, 2 * (size_t)count, sizeof *p->place, error);
    if (status != TIDES_OK) return status;
    td_point_place *places = p->place;
    int *end = p->wanted; /* borrowed as scratch: no lists are wanted yet */
    count_points(renderer, points, which, count, end);
    for (int i = 0; i < count; i++)
        places[end[tile_of(renderer, &points[which[i]])]++] = place_of(p, &points[which[i]], which[i]);
    const td_point_tiles all = {places, places + count, end, renderer->stats.tiles, count, p->engine->lanes};
    td_point_gather_all(renderer->pool, &all, order);
    return TIDES_OK;
}

static tides_status check_point(const tides_renderer *renderer, const td_point_span *at, const td_point *point,
                                tides_error *error) {
    const td_image *image = &renderer->image;
    if (point->time >= at->start && point->time <= at->stop && point->x >= 0 && point->y >= 0 && point->x < image->width &&
        point->y < image->height)
        return TIDES_OK;
    return td_fail(error, TIDES_BAD_ARGUMENT, "point (%d, %d) at %.9g s is outside of the image, or of [%.9g, %.9g] s",
                   (int)point->x, (int)point->y, point->time, at->start, at->stop);
}

/* Sets the piece of point i, which is at `time`, and its place within the piece. */
static void place_time(const td_point_nodes *nodes, double time, td_points *p, int i) {
    const int low = piece_of(nodes, time);
    const double length = nodes->knot[low + 1] - nodes->knot[low];
    p->piece[i] = low;
    p->column[2][i] = length > 0 ? (time - nodes->knot[low]) / length : 0;
    p->column[3][i] = length > 0 ? length : TD_POINT_INSTANT;
}

/* Prepares points order[0 .. count) for a launch. Returns the number of chunks, and the tiles whose lists are missing. */
static int lay_launch(const tides_renderer *renderer, td_points *p, const td_point *points, const int *order, int count,
                      int *wanted) {
    int chunks = 0;
    *wanted = 0;
    for (int i = 0; i < count; i++) {
        const td_point *point = &points[order[i]];
        const int tile = tile_of(renderer, point);
        p->column[0][i] = point->x + 0.5;
        p->column[1][i] = point->y + 0.5;
        place_time(&p->nodes, point->time, p, i);
        if (chunks == 0 || p->chunks[chunks - 1].tile != tile || p->chunks[chunks - 1].count == p->engine->lanes)
            p->chunks[chunks++] = (td_points_chunk){tile, i, 0};
        p->chunks[chunks - 1].count++;
        if (td_points_wanted_list(&p->asks, tile)) p->wanted[(*wanted)++] = tile;
    }
    return chunks;
}

/* Waits for the launch that is under way, if there is one. */
static tides_status finish_launch(const tides_renderer *renderer, td_points *p, tides_error *error) {
    const td_points_some away = p->away;
    if (away.count == 0) return TIDES_OK;
    p->away.count = 0;
    tides_status status = p->engine->type->finish(p->engine, error);
    if (status != TIDES_OK) return status;
    return td_points_take(renderer->pool, away.points, away.which, away.count, p->values, away.values, error);
}

/* Queues the next launch behind the running one. */
static tides_status begin_launch(const tides_renderer *renderer, td_points *p, const td_points_some *next, tides_error *error) {
    int wanted;
    const int chunks = lay_launch(renderer, p, next->points, next->which, next->count, &wanted);
    const td_points_batch batch = {{p->column[0], p->column[1], p->column[2], p->column[3]},
                                   p->piece,
                                   next->count,
                                   p->chunks,
                                   chunks,
                                   td_points_backdrop_of(&renderer->image, renderer->scratch.backdrops)};
    tides_status status = finish_launch(renderer, p, error);
    if (status == TIDES_OK) status = p->engine->type->lists(p->engine, p->wanted, wanted, error);
    if (status != TIDES_OK) p->begun = -1; /* it isn't known which lists are ready */
    if (status == TIDES_OK) status = p->engine->type->values(p->engine, &batch, p->values, error);
    if (status == TIDES_OK) p->away = *next;
    return status;
}

/* Computes the points that see a splat without a curve; `asked` then has the others. */
static tides_status take_direct(tides_renderer *renderer, const tides_trajectory *camera, td_points *p, points_asked *asked,
                                tides_error *error) {
    int left = 0, direct = 0;
    for (int i = 0; i < asked->count; i++)
        if (td_points_direct_sees(&p->direct, &asked->points[asked->which[i]], renderer->image.width))
            asked->order[direct++] = asked->which[i];
        else
            asked->which[left++] = asked->which[i];
    asked->count = left;
    const td_points_some some = {asked->points, asked->values, asked->order, direct};
    const td_direct_user user = {renderer, camera, p->engine};
    return td_points_direct_values(&user, &p->direct, p->nodes.exact, &p->at, &some, error);
}

/* Computes the points of the part whose rows are ready. */
static tides_status points_of_part(tides_renderer *renderer, const tides_trajectory *camera, td_points *p, points_asked *asked,
                                   tides_error *error) {
    tides_status status = add_wanted(renderer, camera, p, asked->points, asked->which, asked->count, error);
    if (status == TIDES_OK) status = take_direct(renderer, camera, p, asked, error);
    const int count = asked->count;
    if (status == TIDES_OK) status = order_points(renderer, p, asked->points, asked->which, count, asked->order, error);
    for (int from = 0; from < count && status == TIDES_OK; from += POINTS_AT_ONCE) {
        const int some = count - from < POINTS_AT_ONCE ? count - from : POINTS_AT_ONCE;
        const td_points_some next = {asked->points, asked->values, asked->order + from, some};
        status = td_renderer_check_stop(renderer, (double)from / count, error);
        if (status == TIDES_OK) status = begin_launch(renderer, p, &next, error);
    }
    return status;
}

/* Chooses those of `count` points that are in part k. The part may be halved for them, and is the first half then. */
static tides_status choose_part(tides_renderer *renderer, const tides_trajectory *camera, td_points *p, int k, int count,
                                points_asked *asked, tides_error *error) {
    tides_status status = TIDES_OK;
    int parts;
    do {
        parts = p->parts.count;
        asked->count = 0;
        for (int i = 0; i < count; i++)
            if (td_point_parts_of(&p->parts, asked->points[i].time) == k) asked->which[asked->count++] = i;
        if (asked->count > 0) status = begin_part(renderer, camera, p, k, error);
    } while (status == TIDES_OK && p->parts.count != parts);
    return status;
}

/* Computes points, but leaves the last launch running. */
static tides_status begin_points(tides_renderer *renderer, const tides_trajectory *camera, td_points *p, const td_point *points,
                                 size_t count, td_point_value *values, tides_error *error) {
    tides_status status = td_renew((void **)&p->which, &p->which_capacity, 2 * count, sizeof *p->which, error);
    for (size_t i = 0; i < count && status == TIDES_OK; i++) status = check_point(renderer, &p->at, &points[i], error);
    if (status == TIDES_OK && td_point_parts_are_others(&p->parts, &p->at)) {
        p->begun = -1;
        status = td_point_parts_begin(&p->parts, &p->at, error);
    }
    for (int k = 0; k < p->parts.count && status == TIDES_OK; k++) {
        points_asked asked = {points, values, p->which, 0, p->which + count};
        status = finish_launch(renderer, p, error); /* the next part overwrites the running launch's list of points */
        if (status == TIDES_OK) status = choose_part(renderer, camera, p, k, (int)count, &asked, error);
        if (status == TIDES_OK && asked.count > 0) status = points_of_part(renderer, camera, p, &asked, error);
    }
    if (status != TIDES_OK) drop_launch(p);
    return status;
}

static tides_status exact_points(tides_renderer *renderer, const tides_trajectory *camera, td_points *p, const td_point *points,
                                 size_t count, td_point_value *values, tides_error *error) {
    const tides_status status = begin_points(renderer, camera, p, points, count, values, error);
    return status == TIDES_OK ? finish_launch(renderer, p, error) : status;
}

static td_points *of_swept(tides_renderer *renderer) {
    const td_candidates *lists = &renderer->candidates;
    const double *swept = renderer->sweep.interval;
    const double shortest = (swept[1] - swept[0]) / (1 << td_dynamic_finest(&renderer->dynamic));
    renderer->points->at =
        (td_point_span){lists->first, lists->list, renderer->sweep.boxes, swept[0], swept[1], shortest, lists->serial};
    return renderer->points;
}

static tides_status swept_points(tides_renderer *renderer, const tides_trajectory *camera, const td_point *points, size_t count,
                                 td_point_value *values, tides_error *error) {
    return exact_points(renderer, camera, of_swept(renderer), points, count, values, error);
}

tides_status td_renderer_points(tides_renderer *renderer, const tides_trajectory *camera, const td_point *points, size_t count,
                                td_point_value *values, tides_error *error) {
    return td_mosaic_points(renderer, swept_points, camera, points, count, values, error);
}

tides_status td_renderer_points_begin(tides_renderer *renderer, const tides_trajectory *camera, const td_point *points,
                                      size_t count, td_point_value *values, tides_error *error) {
    if (renderer->colour_filter) return td_renderer_points(renderer, camera, points, count, values, error);
    return begin_points(renderer, camera, of_swept(renderer), points, count, values, error);
}

tides_status td_renderer_points_end(tides_renderer *renderer, tides_error *error) {
    return renderer->points ? finish_launch(renderer, renderer->points, error) : TIDES_OK;
}

void td_renderer_points_drop(tides_renderer *renderer) {
    if (renderer->points) drop_launch(renderer->points);
}

int td_renderer_points_go_on(const tides_renderer *renderer) {
    const td_points *p = renderer->points;
    return p && !renderer->colour_filter && p->engine->goes_on && p->parts.count <= 1;
}

double td_renderer_points_took(const tides_renderer *renderer) {
    return td_renderer_points_go_on(renderer) ? renderer->points->engine->took : 0;
}

/* Keeps the objects' views at the instant: open paths may forget it before its rows are asked for. */
static tides_status keep_views(tides_renderer *renderer, const tides_trajectory *camera, td_points *p, tides_error *error) {
    const size_t objects = (size_t)renderer->store.objects;
    tides_status status = td_renderer_views(renderer, camera, renderer->sweep.interval, 1, error);
    if (status != TIDES_OK) return status;
    p->nodes.kept = td_alloc(objects, sizeof *p->nodes.kept, error);
    if (!p->nodes.kept) return TIDES_NO_MEMORY;
    memcpy(p->nodes.kept, renderer->scratch.views, objects * sizeof *p->nodes.kept);
    return status;
}

static tides_status keep_instant(tides_renderer *renderer, const tides_trajectory *camera, tides_error *error) {
    const td_candidates *lists = &renderer->candidates;
    const size_t tiles = (size_t)renderer->stats.tiles + 1, candidates = (size_t)lists->first[tiles - 1];
    const size_t gaussians = (size_t)renderer->store.count;
    const double *swept = renderer->sweep.interval;
    td_points_destroy(renderer->kept);
    renderer->kept = NULL;
    tides_status status = create_points(renderer, renderer->points->nodes.exact, &renderer->kept, error);
    if (status == TIDES_OK) status = keep_views(renderer, camera, renderer->kept, error);
    if (status != TIDES_OK) return status;
    td_points *p = renderer->kept;
    p->own_first = td_alloc(tiles, sizeof *p->own_first, error);
    p->own_list = td_alloc(candidates + 1, sizeof *p->own_list, error);
    p->own_boxes = td_alloc(gaussians, 4 * sizeof *p->own_boxes, error);
    if (!p->own_first || !p->own_list || !p->own_boxes) return TIDES_NO_MEMORY;
    memcpy(p->own_boxes, renderer->sweep.boxes, gaussians * 4 * sizeof *p->own_boxes);
    memcpy(p->own_first, lists->first, tiles * sizeof *p->own_first);
    memcpy(p->own_list, lists->list, candidates * sizeof *p->own_list);
    p->at = (td_point_span){p->own_first, p->own_list, p->own_boxes, swept[0], swept[0], 0, lists->serial};
    return TIDES_OK;
}

tides_status td_renderer_keep_instant(tides_renderer *renderer, const tides_trajectory *camera, tides_error *error) {
    tides_status status = TIDES_OK;
    for (; renderer && status == TIDES_OK; renderer = renderer->beside) status = keep_instant(renderer, camera, error);
    return status;
}

/* Paths of earlier points are kept only while they are few: nobody asks twice about the instant. */
static tides_status kept_points(tides_renderer *renderer, const tides_trajectory *camera, const td_point *points, size_t count,
                                td_point_value *values, tides_error *error) {
    if (renderer->kept->nodes.made > renderer->kept->nodes.group_size) renderer->kept->begun = -1;
    return exact_points(renderer, camera, renderer->kept, points, count, values, error);
}

tides_status td_renderer_kept_points(tides_renderer *renderer, const tides_trajectory *camera, const td_point *points,
                                     size_t count, td_point_value *values, tides_error *error) {
    return td_mosaic_points(renderer, kept_points, camera, points, count, values, error);
}

static tides_status direct_points(tides_renderer *renderer, const tides_trajectory *camera, const td_point *points,
                                  size_t count, td_point_value *values, tides_error *error) {
    td_points *p = of_swept(renderer);
    tides_status status = td_renew((void **)&p->which, &p->which_capacity, 2 * count, sizeof *p->which, error);
    drop_launch(p);
    for (size_t i = 0; i < count && status == TIDES_OK; i++) status = check_point(renderer, &p->at, &points[i], error);
    if (status != TIDES_OK) return status;
    count_points(renderer, points, NULL, (int)count, p->wanted); /* tile by tile: neighbours see the same splats */
    for (int i = 0; i < (int)count; i++) p->which[p->wanted[tile_of(renderer, &points[i])]++] = i;
    const td_points_some all = {points, values, p->which, (int)count};
    const td_direct_user user = {renderer, camera, p->engine};
    return td_points_direct_values(&user, &p->direct, p->nodes.exact, &p->at, &all, error);
}

tides_status td_renderer_direct_points(tides_renderer *renderer, const tides_trajectory *camera, const td_point *points,
                                       size_t count, td_point_value *values, tides_error *error) {
    return td_mosaic_points(renderer, direct_points, camera, points, count, values, error);
}

int td_renderer_points_rounded(const tides_renderer *renderer) {
    return renderer->points && renderer->dynamic.gaussians > 0 && !td_renderer_is_double(renderer);
}
