/* Data that the stages of the limit share. */
#ifndef LIMIT_PARTS_H
#define LIMIT_PARTS_H

#include "limit.h"
#include "limit_vector.h"

#include <pthread.h>
#include <stddef.h>

enum { TILE = 16, BLOCKS = 16 /* of a tile */, THREADS_MAX = 256 };
enum { GEOMETRY = 14 }; /* of a group: mean (3), factor (9, row-major R S), log2 opacity, reach (sqrt(2 ln 255 o)) */
enum { G_MEAN = 0, G_FACTOR = 3, G_LOG2_OPACITY = 12, G_REACH = 13 };

/* Sixteen Gaussians of one object; numbers of one kind stand side by side. */
typedef struct limit_part {
    int32_t first_group, groups, bands; /* bands: (degree + 1)^2 */
    float *geometry, *sh;               /* GEOMETRY and 3 bands vectors a group */
} limit_part;

/* A splat: log2 alpha = log2 opacity + q . (dx^2, dx dy, dy^2), and the rate of ln alpha. 64 bytes. */
typedef struct limit_record {
    float u, v, qxx, qxy, qyy, log2_opacity, luminance, luminance_dot;
    float k0, kx, ky, kxx, kxy, kyy;
    uint16_t x0, y0, x1, y1; /* tiles that its box reaches, without x1, y1 */
} limit_record;

/* A splat in a tile. */
typedef struct limit_hit {
    int32_t tile, splat;
    uint32_t blocks;
} limit_hit;

/* What a thread works with: its part of the splats, of the hits, and a tile. */
typedef struct limit_worker {
    limit_hit *hits;
    size_t hit_count, hit_capacity;
    int32_t *tile_counts;        /* of its hits */
    limit_record *local;         /* a tile's, contiguous */
    int32_t *lists;              /* and of each block: where in these */
    size_t local_capacity;       /* of both, in splats */
    int64_t first_splat, splats; /* that it projected, in `records` */
    int64_t pairs;
    int32_t failed;  /* out of memory */
    char apart[128]; /* no two threads write to one cache line */
} limit_worker;

typedef void (*limit_stage)(limit *l, int32_t thread);

struct limit {
    limit_setup setup; /* its objects are not kept */
    limit_part *parts;
    limit_view *views;
    int32_t part_count, groups, threads, tiles_x, tiles_y, tiles;
    int32_t rates;
    float *L, *L_dot;
    /* A frame's: splats as projected, their depths, and both in order. */
    limit_record *records, *sorted;
    uint32_t *keys[2];
    int32_t *places[2];
    int64_t splats, capacity; /* visible; room */
    int32_t *starts;          /* of each tile's list, tiles + 1 */
    int32_t *by_length;       /* tiles, the longest list first */
    int32_t *list;            /* splats of the tiles, tile by tile */
    uint16_t *masks;          /* and their blocks */
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
/* limit_lists.c: all of the sort; the lists, 0 where memory ran out. */
void limit_sort(limit *l);
int32_t limit_lists(limit *l);
/* limit_composite.c */
void limit_composite(limit *l, int32_t thread);

#endif
