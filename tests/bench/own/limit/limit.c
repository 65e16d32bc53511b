/* The limit: lays its Gaussians out for vectors, starts its threads, and makes a frame stage by stage. */
#define _POSIX_C_SOURCE 200809L
#include "limit_parts.h"

#include <stdlib.h>
#include <time.h>

/* -- threads -------------------------------------------------------------------------------------------------------------- */

/* What a thread is started with: the limit, and the thread's number. */
typedef struct seat {
    limit *l;
    int32_t thread;
} seat;

static void *wait_and_work(void *given) {
    const seat own = *(seat *)given;
    free(given);
    limit *l = own.l;
    for (int64_t seen = 0;;) {
        pthread_mutex_lock(&l->lock);
        while (l->turn == seen && !l->ending) pthread_cond_wait(&l->wake, &l->lock);
        seen = l->turn;
        const int32_t ending = l->ending;
        pthread_mutex_unlock(&l->lock);
        if (ending) return NULL;
        l->stage(l, own.thread);
        pthread_mutex_lock(&l->lock);
        if (--l->running == 0) pthread_cond_signal(&l->done);
        pthread_mutex_unlock(&l->lock);
    }
}

void limit_together(limit *l, limit_stage stage) {
    pthread_mutex_lock(&l->lock);
    l->stage = stage;
    l->running = l->threads - 1;
    l->turn++;
    pthread_cond_broadcast(&l->wake);
    pthread_mutex_unlock(&l->lock);
    stage(l, 0);
    pthread_mutex_lock(&l->lock);
    while (l->running) pthread_cond_wait(&l->done, &l->lock);
    pthread_mutex_unlock(&l->lock);
}

static int32_t start_threads(limit *l) {
    for (l->started = 1; l->started < l->threads; l->started++) {
        seat *own = malloc(sizeof *own);
        if (!own) return 0;
        *own = (seat){l, l->started};
        if (pthread_create(&l->pool[l->started], NULL, wait_and_work, own) != 0) {
            free(own);
            return 0;
        }
    }
    return 1;
}

static void end_threads(limit *l) {
    pthread_mutex_lock(&l->lock);
    l->ending = 1;
    pthread_cond_broadcast(&l->wake);
    pthread_mutex_unlock(&l->lock);
    for (int32_t t = 1; t < l->started; t++) pthread_join(l->pool[t], NULL);
}

/* -- Gaussians ------------------------------------------------------------------------------------------------------------ */

/* R(q) times the scales, row by row. */
static void factor_of(const float q[4], const float log_scale[3], float m[9]) {
    const double n = 1 / sqrt((double)q[0] * q[0] + (double)q[1] * q[1] + (double)q[2] * q[2] + (double)q[3] * q[3]);
    const double w = q[0] * n, x = q[1] * n, y = q[2] * n, z = q[3] * n;
    const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                         2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    for (int k = 0; k < 9; k++) m[k] = (float)(r[k] * exp((double)log_scale[k % 3]));
}

static void fill_part(const limit_object *o, limit_part *part) {
    const int32_t own_bands = (o->sh_degree + 1) * (o->sh_degree + 1);
    for (int64_t i = 0; i < o->count; i++) {
        float *g = part->geometry + (size_t)(i / LANES) * GEOMETRY * LANES + i % LANES;
        float *sh = part->sh + (size_t)(i / LANES) * 3 * part->bands * LANES + i % LANES, m[9];
        const double opacity = 1 / (1 + exp(-(double)o->opacity_logit[i]));
        factor_of(o->quaternion + 4 * i, o->log_scale + 3 * i, m);
        for (int k = 0; k < 3; k++) g[LANES * (G_MEAN + k)] = (float)(o->origin[k] + o->mean[3 * i + k]);
        for (int k = 0; k < 9; k++) g[LANES * (G_FACTOR + k)] = m[k];
        g[LANES * G_LOG2_OPACITY] = (float)log2(opacity);
        g[LANES * G_REACH] = opacity > 1 / 255.0 ? (float)sqrt(2 * log(255 * opacity)) : 0;
        for (int k = 0; k < 3 * part->bands; k++) sh[LANES * k] = o->sh[(size_t)i * 3 * own_bands + k];
    }
}

/* Places of a group behind its last Gaussian get no reach. */
static int32_t make_part(const limit_object *o, int32_t first_group, limit_part *part) {
    const int32_t degree = o->sh_degree < 3 ? o->sh_degree : 3;
    part->first_group = first_group;
    part->groups = (int32_t)((o->count + LANES - 1) / LANES);
    part->bands = (degree + 1) * (degree + 1);
    part->geometry = calloc((size_t)part->groups * GEOMETRY * LANES, sizeof *part->geometry);
    part->sh = calloc((size_t)part->groups * 3 * part->bands * LANES, sizeof *part->sh);
    if (!part->geometry || !part->sh) return 0;
    fill_part(o, part);
    return 1;
}

/* -- from creation to destruction ----------------------------------------------------------------------------------------- */

static void destroy(limit *l) {
    if (!l) return;
    end_threads(l);
    for (int32_t k = 0; l->parts && k < l->part_count; k++) free(l->parts[k].geometry), free(l->parts[k].sh);
    for (int32_t t = 0; t < l->threads; t++) {
        limit_worker *w = &l->workers[t];
        free(w->hits), free(w->tile_counts), free(w->local), free(w->lists);
    }
    for (int k = 0; k < 2; k++) free(l->keys[k]), free(l->places[k]);
    free(l->parts), free(l->views), free(l->records), free(l->sorted), free(l->starts), free(l->by_length);
    free(l->list), free(l->masks);
    pthread_cond_destroy(&l->wake), pthread_cond_destroy(&l->done), pthread_mutex_destroy(&l->lock);
    free(l);
}

static int32_t make_room(limit *l) {
    l->capacity = (int64_t)l->groups * LANES;
    const size_t n = (size_t)(l->capacity ? l->capacity : 1);
    l->records = malloc(n * sizeof *l->records);
    l->sorted = malloc(n * sizeof *l->sorted);
    for (int k = 0; k < 2; k++) {
        l->keys[k] = malloc(n * sizeof *l->keys[k]);
        l->places[k] = malloc(n * sizeof *l->places[k]);
        if (!l->keys[k] || !l->places[k]) return 0;
    }
    l->starts = malloc(((size_t)l->tiles + 1) * sizeof *l->starts);
    l->by_length = malloc((size_t)l->tiles * sizeof *l->by_length);
    for (int32_t t = 0; t < l->threads; t++) {
        l->workers[t].tile_counts = malloc((size_t)l->tiles * sizeof *l->workers[t].tile_counts);
        if (!l->workers[t].tile_counts) return 0;
    }
    return l->records && l->sorted && l->starts && l->by_length;
}

static limit *create(const limit_setup *setup) {
    limit *l = calloc(1, sizeof *l);
    if (!l) return NULL;
    l->setup = *setup;
    l->setup.objects = NULL;
    l->threads = setup->threads < 1 ? 1 : setup->threads < THREADS_MAX ? setup->threads : THREADS_MAX;
    l->tiles_x = (setup->width + TILE - 1) / TILE;
    l->tiles_y = (setup->height + TILE - 1) / TILE;
    l->tiles = l->tiles_x * l->tiles_y;
    l->part_count = setup->object_count;
    pthread_mutex_init(&l->lock, NULL), pthread_cond_init(&l->wake, NULL), pthread_cond_init(&l->done, NULL);
    l->parts = calloc((size_t)l->part_count, sizeof *l->parts);
    l->views = calloc((size_t)l->part_count, sizeof *l->views);
    int32_t ok = l->parts && l->views;
    for (int32_t k = 0; k < l->part_count && ok; k++) {
        ok = make_part(&setup->objects[k], l->groups, &l->parts[k]);
        l->groups += l->parts[k].groups;
    }
    if (ok && make_room(l) && start_threads(l)) return l;
    destroy(l);
    return NULL;
}

/* -- a frame -------------------------------------------------------------------------------------------------------------- */

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int32_t frame(limit *l, const limit_view *views, int32_t rates, float *log_luminance, float *log_luminance_dot,
                     limit_counts *counts) {
    double at[LIMIT_STAGES + 1];
    memcpy(l->views, views, (size_t)l->part_count * sizeof *views);
    l->rates = rates;
    l->L = log_luminance;
    l->L_dot = log_luminance_dot;
    l->next_tile = 0;
    at[0] = now();
    limit_together(l, limit_project);
    at[1] = now();
    limit_sort(l);
    at[2] = now();
    if (!limit_lists(l)) return 0;
    at[3] = now();
    limit_together(l, limit_composite);
    at[4] = now();
    for (int k = 0; k < LIMIT_STAGES; k++) counts->seconds[k] = at[k + 1] - at[k];
    counts->gaussians = l->capacity;
    counts->splats = l->splats;
    counts->entries = l->starts[l->tiles];
    counts->pairs = 0;
    for (int32_t t = 0; t < l->threads; t++) {
        counts->pairs += l->workers[t].pairs;
        if (l->workers[t].failed) return 0;
    }
    return 1;
}

extern const limit_functions limit_of_frames __attribute__((visibility("default")));
const limit_functions limit_of_frames = {
    .size = sizeof(limit_functions),
    .made_by = __VERSION__,
    .create = create,
    .destroy = destroy,
    .frame = frame,
};
