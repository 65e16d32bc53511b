/* Makes the padded arrays of a whole scene that backends read. Each object is split into Gaussians at rest (reordered along a
 * space-filling curve where order is free) and those that move. Gaussians are activated once, in double, and widened to the
 * kernels' strides. */
#include "motion/td_activate.h"
#include "motion/td_motion.h"
#include "td_space_order.h"
#include "td_launch.h"
#include "td_renderer.h"
#include "td_wide.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>

static void widen(const float *from, double *to, int count) {
    for (int i = 0; i < count; i++) to[i] = from[i];
}

/* -- parts ---------------------------------------------------------------------------------------------------------- */

/* An object of the store: Gaussians of one scene object that all rest in it, or all move by themselves. */
typedef struct store_part {
    int object;        /* index in the scene */
    int moving, first; /* first: index in the store */
    int64_t count;
} store_part;

typedef struct store_plan {
    store_part *parts;
    int count;
    uint8_t *moving; /* for every Gaussian of the scene, object by object */
    int64_t padded;
    int fades, in_space; /* arguments of td_store_create */
    td_pool *pool;
} store_plan;

static void add_part(store_plan *plan, int object, int moving, int64_t count) {
    if (count == 0) return;
    store_part added = {object, moving, 0, count};
    added.first = plan->padded < INT_MAX ? (int)plan->padded : 0; /* too many Gaussians are refused later */
    plan->parts[plan->count++] = added;
    plan->padded += (count + TD_PAD - 1) / TD_PAD * TD_PAD;
}

/* Plans the parts of the store: each object's Gaussians at rest come first. */
static tides_status make_plan(const tides_scene *scene, store_plan *plan, tides_error *error) {
    uint8_t *moving = plan->moving = td_alloc((size_t)tides_scene_count(scene) + 1, 1, error);
    plan->parts = td_alloc(2 * (size_t)tides_scene_objects(scene) + 1, sizeof *plan->parts, error);
    if (!plan->parts || !plan->moving) return TIDES_NO_MEMORY;
    for (int32_t i = 0; i < tides_scene_objects(scene); i++) {
        tides_object object;
        int64_t still = 0;
        tides_status status = tides_scene_object(scene, i, &object, error);
        if (status != TIDES_OK) return status;
        if (object.motion) td_motion_find_moving(object.motion, &object.gaussians, moving);
        for (int64_t k = 0; k < object.gaussians.count; k++) still += !moving[k];
        add_part(plan, i, 0, still);
        add_part(plan, i, 1, object.gaussians.count - still);
        moving += object.gaussians.count;
    }
    return TIDES_OK;
}

static void free_plan(store_plan *plan) {
    free(plan->parts);
    free(plan->moving);
}

/* The order of a part's Gaussians, which the caller frees: along a space-filling curve for Gaussians at rest, if `in_space`;
 * otherwise the object's own. */
static tides_status order_part(const tides_gaussians *gaussians, const uint8_t *moving, const store_part *part, int in_space,
                               int64_t **order, tides_error *error) {
    *order = td_alloc((size_t)part->count, sizeof **order, error);
    if (!*order) return TIDES_NO_MEMORY;
    if (in_space && !part->moving) return td_space_order(gaussians->mean, moving, gaussians->count, *order, error);
    for (int64_t i = 0, k = 0; i < gaussians->count; i++)
        if (moving[i] == part->moving) (*order)[k++] = i;
    return TIDES_OK;
}

/* The rows of a part, as the pool's threads share them. */
typedef struct part_rows {
    const tides_gaussians *gaussians;
    const int64_t *order;
    const store_part *part;
    td_store *store;
    int portions;
} part_rows;

/* Rows are read in the order of space, so that each is a cache miss unless it is asked for so many rows ahead. */
enum { AHEAD = 8, FEWEST_ROWS = 4096 };

static void prefetch(const tides_gaussians *gaussians, int64_t i, int own) {
    const char *sh = (const char *)(gaussians->sh + i * own);
    for (size_t at = 0; at < (size_t)own * sizeof *gaussians->sh; at += 64) TD_PREFETCH(sh + at);
    TD_PREFETCH(gaussians->mean + 3 * i);
    TD_PREFETCH(gaussians->log_scale + 3 * i);
    TD_PREFETCH(gaussians->quaternion + 4 * i);
}

/* Copies row k of a part to the store. Coefficients beyond the object's SH degree are zero. Gaussians that move stay invisible
 * here: their rows are computed for each time. */
static void add_row(const part_rows *of, int64_t k, int own) {
    const tides_gaussians *gaussians = of->gaussians;
    td_store *store = of->store;
    const int64_t i = of->order[k];
    const size_t g = (size_t)(of->part->first + k), stride = (size_t)store->sh_stride;
    double mean[3], log_scale[3], quaternion[4], *row = store->geometry + g * TD_GEOMETRY_STRIDE;
    widen(gaussians->mean + 3 * i, mean, 3);
    widen(gaussians->log_scale + 3 * i, log_scale, 3);
    widen(gaussians->quaternion + 4 * i, quaternion, 4);
    memset(row, 0, TD_GEOMETRY_STRIDE * sizeof *row);
    td_activate(mean, log_scale, quaternion, gaussians->opacity_logit[i], row);
    if (of->part->moving) row[TD_G_OPACITY] = 0;
    float *sh = store->sh + g * stride;
    memcpy(sh, gaussians->sh + i * own, (size_t)own * sizeof *sh);
    memset(sh + own, 0, (stride - (size_t)own) * sizeof *sh);
    store->number[g] = (int)i;
}

static void add_some(void *user, int portion) {
    const part_rows *of = user;
    const int own = 3 * (of->gaussians->sh_degree + 1) * (of->gaussians->sh_degree + 1), count = (int)of->part->count;
    const int end = td_pool_begin(count, of->portions, portion + 1);
    for (int k = td_pool_begin(count, of->portions, portion); k < end; k++) {
        if (k + AHEAD < end) prefetch(of->gaussians, of->order[k + AHEAD], own);
        add_row(of, k, own);
    }
}

/* Copies a part's Gaussians to the store, as its object `number`, and fills the part up with invisible ones. */
static void add_part_rows(const tides_gaussians *gaussians, const int64_t *order, const store_part *part, int number,
                          td_pool *pool, td_store *store) {
    part_rows all = {gaussians, order, part, store, td_pool_portions(pool, (int)part->count, FEWEST_ROWS)};
    const int last = part->first + (int)part->count, end = (last + TD_PAD - 1) / TD_PAD * TD_PAD;
    td_pool_run(pool, all.portions, add_some, &all);
    const size_t from = (size_t)last, more = (size_t)(end - last);
    memset(store->geometry + from * TD_GEOMETRY_STRIDE, 0, more * TD_GEOMETRY_STRIDE * sizeof *store->geometry);
    memset(store->sh + from * (size_t)store->sh_stride, 0, more * (size_t)store->sh_stride * sizeof *store->sh);
    for (int g = last; g < end; g++) store->number[g] = store->number[last - 1];
    for (int g = part->first; g < end; g++) store->object[g] = number;
}

/* Adds an object's parts, from number `first` on, and its motion. */
static tides_status add_object(const tides_scene *scene, const store_plan *plan, int first, const uint8_t *moving,
                               td_store *store, tides_error *error) {
    tides_object object;
    int which = plan->parts[first].object, still = -1, mover = -1;
    tides_status status = tides_scene_object(scene, which, &object, error);
    for (int p = first; p < plan->count && plan->parts[p].object == which && status == TIDES_OK; p++) {
        int64_t *order = NULL;
        status = order_part(&object.gaussians, moving, &plan->parts[p], plan->in_space, &order, error);
        if (status == TIDES_OK) add_part_rows(&object.gaussians, order, &plan->parts[p], p, plan->pool, store);
        free(order);
        store->scene_object[p] = which;
        store->mover[p] = -1;
        if (plan->parts[p].moving)
            mover = p;
        else
            still = p;
    }
    if (status != TIDES_OK || !object.motion) return status;
    td_resting resting = {0, 0};
    if (still >= 0) resting.first = plan->parts[still].first, resting.count = plan->parts[still].count;
    status = td_store_add_motion(&object, &resting, mover, plan->fades, store, error);
    return status == TIDES_OK ? status : td_fail_within(error, status, "motion of object %d", which);
}

/* Allocates memory that a device may read in place: aligned to a cache line, with zeros as slack behind the end. The rest is
 * left to those who fill it, threads side by side: half a million splats take 110 MB of fresh pages. */
static void *allocate_shared(size_t count, size_t size, tides_error *error) {
    void *memory = NULL;
    if (count > (SIZE_MAX - TD_BUFFER_SLACK) / size || posix_memalign(&memory, 64, count * size + TD_BUFFER_SLACK) != 0) {
        td_fail(error, TIDES_NO_MEMORY, "out of memory: %zu items of %zu bytes were asked for", count, size);
        return NULL;
    }
    memset((char *)memory + count * size, 0, TD_BUFFER_SLACK);
    return memory;
}

static tides_status allocate(td_store *store, tides_error *error) {
    size_t count = (size_t)store->count, objects = (size_t)store->objects;
    store->object = td_alloc(count, sizeof *store->object, error);
    store->number = td_alloc(count, sizeof *store->number, error);
    store->geometry = allocate_shared(count * TD_GEOMETRY_STRIDE, sizeof *store->geometry, error);
    store->sh = allocate_shared(count * (size_t)store->sh_stride, sizeof *store->sh, error);
    store->scene_object = td_alloc(objects, sizeof *store->scene_object, error);
    store->mover = td_alloc(objects, sizeof *store->mover, error);
    int all = store->object && store->number && store->geometry && store->sh && store->scene_object && store->mover;
    return all ? TIDES_OK : TIDES_NO_MEMORY;
}

static tides_status fill(const tides_scene *scene, const store_plan *plan, td_store *store, tides_error *error) {
    int degree = tides_scene_sh_degree(scene);
    store->objects = plan->count;
    store->sh_stride = 3 * (degree + 1) * (degree + 1);
    if (store->decoder && store->sh_stride < TD_FEATURES) store->sh_stride = TD_FEATURES;
    store->real_count = (int)tides_scene_count(scene);
    int64_t widest = store->sh_stride > TD_GEOMETRY_STRIDE ? store->sh_stride : TD_GEOMETRY_STRIDE;
    if (plan->padded > INT_MAX / widest)
        return td_fail(error, TIDES_UNSUPPORTED, "scene: %lld Gaussians of SH degree %d are more than 32-bit indices reach",
                       (long long)tides_scene_count(scene), degree);
    store->count = (int)plan->padded;
    if (store->count == 0) return td_fail(error, TIDES_BAD_ARGUMENT, "scene: holds no Gaussian; add one before rendering");
    tides_status status = allocate(store, error);
    const uint8_t *moving = plan->moving;
    for (int p = 0; p < plan->count && status == TIDES_OK;) {
        int object = plan->parts[p].object, first = p;
        int64_t count = 0;
        for (; p < plan->count && plan->parts[p].object == object; p++) count += plan->parts[p].count;
        status = add_object(scene, plan, first, moving, store, error);
        moving += count;
    }
    return status;
}

tides_status td_store_create(const tides_scene *scene, td_pool *pool, int fades, int in_space, td_store *store,
                             tides_error *error) {
    td_store made = {0};
    store_plan plan = {.fades = fades, .in_space = in_space, .pool = pool};
    tides_status status = make_plan(scene, &plan, error);
    if (status == TIDES_OK) status = td_store_find_decoder(scene, &made, error);
    if (status == TIDES_OK) status = fill(scene, &plan, &made, error);
    free_plan(&plan);
    if (status == TIDES_OK)
        *store = made;
    else
        td_store_release(&made);
    return status;
}

void td_store_release(td_store *store) {
    free(store->object);
    free(store->geometry);
    free(store->rates);
    free(store->sh);
    free(store->sh_wide);
    free(store->sh_rates);
    free(store->scene_object);
    free(store->mover);
    free(store->decoder);
    free(store->number);
    free(store->movers.row);
    free(store->movers.kind);
    free(store->movers.kinds_of);
    free(store->movers.data);
    memset(store, 0, sizeof *store);
}
