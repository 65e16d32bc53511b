/* Data that the stages of the limit share. */
#ifndef LIMIT_PARTS_H
#define LIMIT_PARTS_H

#include "limit.h"
#include "limit_vector.h"

#include <pthread.h>
#include <stddef.h>

enum { TILE = 16, BLOCKS = 16 /* in a tile */, THREADS_MAX = 256 };
enum { GEOMETRY = 14 }; /* reals of a Gaussian: mean (3), factor (9, row-major R S), log2 opacity, reach (sqrt(2 ln 255 o)) */
enum { G_MEAN = 0, G_FACTOR = 3, G_LOG2_OPACITY = 12, G_REACH = 13 };

/* The groups of one object. A group is sixteen Gaussians, whose numbers of one kind stand side by side. */
typedef struct limit_part {
    int32_t first_group, groups, bands; /* bands: (degree + 1)^2 */
    float *geometry, *sh;               /* GEOMETRY and 3 bands vectors a group */
} limit_part;

/* A visible splat: log2 alpha = log2 opacity + q . (dx^2, dx dy, dy^2), and the rate of ln alpha. 64 bytes. */
typedef struct limit_record {
    float u, v, qxx, qxy, qyy, log2_opacity, luminance, luminance_dot;
    float k0, kx, ky, kxx, kxy, kyy;
    uint16_t x0, y0, x1, y1; /* the tiles of its box; x1 and y1 are beyond them */
} limit_record;

/* A hit: a splat in a tile. */
typedef struct limit_hit {
    int32_t tile, splat;
    uint32_t blocks;
} limit_hit;

/* The memory of a thread: its part of the splats and of the hits, and a tile. */
typedef struct limit_worker {
    limit_hit *hits;
    size_t hit_count, hit_capacity;
    int32_t *tile_counts;        /* its hits in each tile */
    limit_record *local;         /* copies of a tile's records */
    int32_t *lists;              /* for each block: numbers of records in `local` */
    size_t local_capacity;       /* of both arrays, in splats */
    int64_t first_splat, splats; /* those that it projected, in `records` */
    int64_t pairs;
    int32_t failed;  /* out of memory */
    char apart[128]; /* keeps threads from writing to one cache line */
} limit_worker;

typedef void (*limit_stage)(limit *l, int32_t thread);

struct limit {
    limit_setup setup; /* without its objects */
    limit_part *parts;
    limit_view *views;
    int32_t part_count, groups, threads, tiles_x, tiles_y, tiles;
    int32_t rates;
    float *L, *L_dot;
    /* Of a frame: the splats as projected, their depths, and both in order. */
    limit_record *records, *sorted;
    uint32_t *keys[2];
    int32_t *places[2];
    int64_t splats, capacity; /* visible; room */
    int32_t *starts;          /* (tiles + 1) where the list of each tile begins */
    int32_t *by_length;       /* tiles, the longest list first */
    int32_t *list;            /* splats of the tiles, tile by tile */
    uint16_t *masks;          /* the blocks that these splats reach */
    size_t list_capacity;
    int32_t next_tile;
    limit_worker workers[THREADS_MAX];
    /* Threads that wait for work. */
    pthread_t pool[THREADS_MAX];
    pthread_mutex_t lock;
    pthread_cond_t wake, done;
    limit_stage stage;
    int64_t turn;
    int32_t running, ending, started;
};

/* Runs a stage on all threads; the caller is thread 0. */
void limit_together(limit *l, limit_stage stage);

/* limit_project.c */
void limit_project(limit *l, int32_t thread);
/* limit_lists.c: the whole sort, and the lists. 0: out of memory. */
void limit_sort(limit *l);
int32_t limit_lists(limit *l);
/* limit_composite.c */
void limit_composite(limit *l, int32_t thread);

#endif
