/* Reads frames and event streams of the shared golden files. */
#include "golden_events.h"

#include "signal/td_event_sort.h"
#include "td_base.h"
#include "tests/support/shared.h"

#include <math.h>
#include <stdarg.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>

void *golden_allocate(size_t count, size_t size) {
    void *memory = td_alloc(count, size, NULL);
    if (!memory) abort();
    return memory;
}

void golden_movie_free(golden_movie *m) {
    free(m->Y);
    free(m->t);
    *m = (golden_movie){.path = ""};
}

int golden_movie_load(golden_movie *m, const char *path) {
    if (strcmp(m->path, path) == 0) return 0;
    golden_movie_free(m);
    npz *file = npz_open(path);
    const npz_array *Y = file ? npz_get(file, "Y") : NULL;
    if (Y && Y->ndim == 3) {
        m->frames = Y->shape[0];
        m->height = (int32_t)Y->shape[1];
        m->width = (int32_t)Y->shape[2];
        m->pixels = Y->shape[1] * Y->shape[2];
        m->Y = npz_doubles(file, "Y", NULL);
        m->t = npz_doubles(file, "t", NULL);
    }
    npz_close(file);
    if (!m->Y || !m->t) return -1;
    snprintf(m->path, sizeof m->path, "%s", path);
    return 0;
}

int golden_keep(void *user, const tides_event *events, size_t count) {
    golden_stream *s = user;
    void *grown = s->events;
    if (td_reserve(&grown, &s->capacity, s->count + count, sizeof *events, NULL) != TIDES_OK) abort();
    s->events = grown;
    if (count) memcpy(s->events + s->count, events, count * sizeof *events);
    s->count += count;
    return 0;
}

static int compare(const void *a, const void *b) { return td_event_compare(a, b); }

golden_stream golden_stream_read(npz *file, double unit) {
    golden_stream s = {NULL, 0, 0};
    double *t = npz_doubles(file, "t", &s.count), *x = npz_doubles(file, "x", NULL), *y = npz_doubles(file, "y", NULL);
    double *p = npz_doubles(file, "p", NULL);
    assert_true(t && x && y && p);
    s.events = golden_allocate(s.count, sizeof *s.events);
    for (size_t k = 0; k < s.count; k++) {
        s.events[k].t = (int64_t)llround(unit * t[k]);
        s.events[k].x = (uint16_t)x[k];
        s.events[k].y = (uint16_t)y[k];
        s.events[k].polarity = (int8_t)(p[k] > 0 ? 1 : -1);
    }
    qsort(s.events, s.count, sizeof *s.events, compare);
    free(t);
    free(x);
    free(y);
    free(p);
    return s;
}

int golden_compare_places(const void *a, const void *b) {
    const tides_event *left = a, *right = b;
    if (left->y != right->y) return left->y < right->y ? -1 : 1;
    if (left->x != right->x) return left->x < right->x ? -1 : 1;
    if (left->t != right->t) return left->t < right->t ? -1 : 1;
    return (left->polarity > right->polarity) - (left->polarity < right->polarity);
}

golden_stream golden_simulate(const tides_baseline_params *params, const golden_movie *m) {
    golden_stream s = {NULL, 0, 0};
    tides_error error = {TIDES_OK, ""};
    tides_baseline *baseline = NULL;
    if (tides_baseline_create(params, m->width, m->height, &baseline, &error) != TIDES_OK) fail_msg("%s", error.text);
    for (size_t k = 0; k < m->frames; k++)
        if (tides_baseline_push(baseline, m->t[k], m->Y + k * m->pixels, golden_keep, &s, &error) != TIDES_OK)
            fail_msg("%s", error.text);
    assert_int_equal(tides_baseline_finish(baseline, golden_keep, &s, &error), TIDES_OK);
    tides_baseline_destroy(baseline);
    for (size_t k = 1; k < s.count; k++) assert_true(td_event_compare(&s.events[k - 1], &s.events[k]) <= 0);
    return s;
}

double golden_number(const cJSON *params, const char *key, double otherwise) {
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(params, key);
    return cJSON_IsNumber(item) ? item->valuedouble : otherwise;
}

/* -- the folders ----------------------------------------------------------------------------------------------------------- */

typedef struct search {
    const char *part;
    void (*visit)(golden_file *file);
    golden_movie movie;
    size_t compared;
} search;

static int visit_file(void *user, const char *path, const char *name) {
    search *v = user;
    char frames[1024], text[4096];
    struct stat facts;
    if (!strstr(name, v->part)) return 0;
    int folder = (int)(strlen(path) - strlen(name)), prefix = (int)strcspn(name, "_");
    int length = snprintf(frames, sizeof frames, "%.*s%.*s_input_frames.npz", folder, path, prefix, name);
    if (length < 0 || (size_t)length >= sizeof frames || stat(frames, &facts) != 0) return 0;
    npz *file = npz_open(path);
    assert_non_null(file);
    npz_string(file, "params", text, sizeof text);
    cJSON *params = cJSON_Parse(text);
    const cJSON *scene = cJSON_GetObjectItemCaseSensitive(params, "scene");
    if (!cJSON_IsString(scene) || strcmp(scene->valuestring, "A") != 0) {
        if (golden_movie_load(&v->movie, frames) != 0) fail_msg("%s: can't be read as frames", frames);
        golden_file g = {name, &v->movie, file, params, 0};
        v->visit(&g);
        v->compared += (size_t)g.compared;
    }
    cJSON_Delete(params);
    npz_close(file);
    return 0;
}

static int visit_folder(void *user, const char *path, const char *name) {
    (void)name;
    shared_scan(path, ".npz", visit_file, user);
    return 0;
}

size_t golden_visit(const char *part, void (*visit)(golden_file *file)) {
    char root[1024];
    search v = {.part = part, .visit = visit};
    if (shared_path(root, sizeof root, "golden") == 0) shared_scan(root, "", visit_folder, &v);
    golden_movie_free(&v.movie);
    return v.compared;
}
