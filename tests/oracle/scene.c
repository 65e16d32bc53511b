/* Builds and frees scenes of the oracle. */
#include "tests/oracle/scene.h"

#include "tests/oracle/image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void round_splat(oracle_splat *splat) {
    double numbers[ORACLE_NUMBERS];
    memcpy(numbers, splat, sizeof numbers);
    for (int k = 0; k < ORACLE_NUMBERS; k++) numbers[k] = (double)(float)numbers[k];
    memcpy(splat, numbers, sizeof numbers);
}

void oracle_object_add(oracle_object *object, const oracle_splat *splat) {
    if (object->count == object->capacity) {
        const int capacity = 2 * object->capacity + 16;
        oracle_splat *grown = oracle_alloc((size_t)capacity, sizeof *grown);
        if (object->count) memcpy(grown, object->splat, (size_t)object->count * sizeof *grown);
        free(object->splat);
        object->splat = grown;
        object->capacity = capacity;
    }
    object->splat[object->count] = *splat;
    round_splat(&object->splat[object->count++]);
}

void oracle_object_key(oracle_object *object, int moves, int frames, int law) {
    object->moves = moves;
    object->keys = oracle_curve_make(frames, object->count * ORACLE_NUMBERS, law);
    for (int f = 0; f < frames; f++)
        memcpy(oracle_object_frame(object, f, 0), object->splat, (size_t)object->count * sizeof *object->splat);
}

oracle_splat *oracle_object_frame(oracle_object *object, int frame, int i) {
    const size_t at = ((size_t)frame * (size_t)object->count + (size_t)i) * ORACLE_NUMBERS;
    return (oracle_splat *)(void *)(object->keys.value + at); /* an oracle_splat has doubles alone */
}

oracle_curve oracle_path_make(int count, int law) {
    oracle_curve path = oracle_curve_make(count, 7, law);
    for (int i = 0; i < count; i++) path.value[7 * i + 3] = 1;
    return path;
}

/* Makes the quaternions of a path unit, each with the sign that is nearer to the one before; then computes its slopes. */
static void straighten(oracle_curve *path) {
    for (int i = 0; i < path->count; i++) {
        double *q = path->value + 7 * i + 3, square = 0, along = 0;
        for (int k = 0; k < 4; k++) square += q[k] * q[k];
        for (int k = 0; k < 4 && i > 0; k++) along += q[k] * q[k - 7];
        const double scale = (along < 0 ? -1 : 1) / sqrt(square);
        for (int k = 0; k < 4; k++) q[k] *= scale;
    }
    oracle_curve_finish(path);
}

static void finish_object(oracle_object *o) {
    straighten(&o->path);
    for (int f = 0; f < o->keys.count; f++)
        for (int i = 0; i < o->count; i++) round_splat(oracle_object_frame(o, f, i));
    oracle_curve_finish(&o->keys);
    o->factor = oracle_alloc((size_t)o->count, sizeof *o->factor);
    o->opacity = oracle_alloc((size_t)o->count, sizeof *o->opacity);
    for (int i = 0; i < o->count; i++) {
        oracle_factor(&o->splat[i], o->factor[i]);
        o->opacity[i] = oracle_opacity(o->splat[i].logit);
    }
}

void oracle_scene_finish(oracle_scene *s) {
    straighten(&s->camera);
    s->splats = 0;
    for (int k = 0; k < s->objects; k++) {
        finish_object(&s->object[k]);
        s->splats += s->object[k].count;
    }
    s->owner = oracle_alloc((size_t)s->splats, sizeof *s->owner);
    s->own = oracle_alloc((size_t)s->splats, sizeof *s->own);
    for (int k = 0, id = 0; k < s->objects; k++)
        for (int i = 0; i < s->object[k].count; i++, id++) {
            s->owner[id] = k;
            s->own[id] = i;
        }
}

void oracle_scene_free(oracle_scene *s) {
    oracle_curve_free(&s->camera);
    for (int k = 0; k < s->objects; k++) {
        oracle_object *o = &s->object[k];
        oracle_curve_free(&o->path);
        oracle_curve_free(&o->keys);
        free(o->splat);
        free(o->factor);
        free(o->opacity);
    }
    free(s->owner);
    free(s->own);
    memset(s, 0, sizeof *s);
}
