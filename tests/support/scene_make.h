/* Test support: random Gaussians, and PLY files of every kind made from them, byte by byte and without the library's code. */
#ifndef TESTS_SUPPORT_SCENE_MAKE_H
#define TESTS_SUPPORT_SCENE_MAKE_H

#include "scene/td_scene.h"

/* Growing bytes. Starts as {0}; the caller frees `data`, which is always followed by a NUL. */
typedef struct scene_bytes {
    char *data;
    size_t size, capacity;
} scene_bytes;
void scene_bytes_add(scene_bytes *bytes, const void *data, size_t size);

enum { SCENE_TRAINED, SCENE_SMALL_INTEGERS };

/* `count` Gaussians from `seed`: values as training gives them, or whole numbers from 0 to 80, which any PLY type can hold.
 * Freed with td_gaussians_free. */
td_gaussians scene_random(uint64_t seed, int64_t count, int32_t sh_degree, int kind);

/* 1 where both have the same counts and the same bits. */
int scene_same(const td_gaussians *a, const tides_gaussians *b);

enum { SCENE_ASCII, SCENE_LITTLE, SCENE_BIG };
enum { SCENE_TYPES = 8 }; /* char uchar short ushort int uint float double */

/* How a PLY file is written; zeroes are the plain case (ASCII, all float). */
typedef struct scene_recipe {
    int format;
    int type;            /* 0..7 for all properties */
    int mixed;           /* 1: a random type each */
    int sized_names;     /* 1: int8 .. float64 instead of char .. double */
    int shuffle;         /* 1: properties in random order */
    int extras;          /* 1: normals, colours, lists, other elements before and after, comments */
    int crlf;            /* 1: lines end in CR LF */
    const float *filter; /* filter_3D, or NULL */
    uint64_t seed;
} scene_recipe;
enum { SCENE_FLOAT = 6, SCENE_DOUBLE = 7 };
scene_bytes scene_ply(const td_gaussians *gaussians, const scene_recipe *recipe);

/* The library's calls; a failure fails the test with its message. */
tides_scene *scene_new(void);
void scene_add(tides_scene *scene, const td_gaussians *gaussians, const tides_trajectory *trajectory, double scale,
               const char *name);
tides_object scene_object_of(const tides_scene *scene, int32_t index);
void scene_save(const tides_scene *scene, const char *path);
void scene_load(tides_scene *scene, const char *path, const tides_trajectory *trajectory, double scale);

/* Checks that the scene's colours code light as srgb, which is the default for files without such a tag. Checks it again
 * after the scene was saved in `folder` in each format that can hold it, and read. */
void scene_is_srgb(const tides_scene *scene, const char *folder);

/* A path of four samples that moves and turns; its samples have rates if `rates` is 1. */
tides_trajectory *scene_path(int rates);

/* Saves a scene of two objects, "a" and "b", of the same 4 Gaussians, degree 1, the second moving. The caller frees them. */
void scene_save_pair(const char *path, td_gaussians *gaussians);

/* splitmix64: the next number of a seeded sequence. scene_between: a number in [lower, upper) made of it. */
uint64_t scene_next(uint64_t *seed);
double scene_between(uint64_t *seed, double lower, double upper);

#endif
