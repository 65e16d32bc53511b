/* Makes random Gaussians, scenes and paths of them, and PLY files of every kind. Aborts if memory runs out. */
#include "scene_make.h"

#include "scene_folder.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { PROPERTIES_MAX = 128 };

uint64_t scene_next(uint64_t *seed) {
    uint64_t x = *seed += UINT64_C(0x9e3779b97f4a7c15); /* Steele, Lea, Flood 2014 */
    x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
    return x ^ x >> 31;
}

double scene_between(uint64_t *seed, double lower, double upper) {
    return lower + (upper - lower) * (double)(scene_next(seed) >> 11) * 0x1p-53;
}

void scene_bytes_add(scene_bytes *bytes, const void *data, size_t size) {
    if (bytes->size + size + 1 > bytes->capacity) {
        bytes->capacity = 2 * (bytes->size + size + 1);
        bytes->data = realloc(bytes->data, bytes->capacity);
        if (!bytes->data) abort();
    }
    memcpy(bytes->data + bytes->size, data, size);
    bytes->size += size;
    bytes->data[bytes->size] = '\0';
}

static void add_text(scene_bytes *bytes, const char *format, ...) {
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (length < 0 || (size_t)length >= sizeof text) abort();
    scene_bytes_add(bytes, text, (size_t)length);
}

/* -- Gaussians -- */

static void fill(float *values, size_t count, uint64_t *seed, int kind) {
    for (size_t i = 0; i < count; i++) {
        uint64_t bits = scene_next(seed);
        values[i] = kind == SCENE_SMALL_INTEGERS ? (float)(bits % 81) : (float)((double)(bits >> 11) * 0x1p-53 * 8 - 4);
    }
}

td_gaussians scene_random(uint64_t seed, int64_t count, int32_t sh_degree, int kind) {
    td_gaussians g;
    if (td_gaussians_create(&g, count, sh_degree, NULL)) abort();
    size_t n = (size_t)count;
    fill(g.mean, 3 * n, &seed, kind);
    fill(g.log_scale, 3 * n, &seed, kind);
    fill(g.quaternion, 4 * n, &seed, kind);
    fill(g.opacity_logit, n, &seed, kind);
    fill(g.sh, 3 * n * td_sh_coefficients(sh_degree), &seed, kind);
    for (size_t i = 0; i < n; i++) g.quaternion[4 * i] = 1; /* never zero */
    return g;
}

int scene_same(const td_gaussians *a, const tides_gaussians *b) {
    if (a->count != b->count || a->sh_degree != b->sh_degree) return 0;
    size_t n = (size_t)a->count * sizeof(float);
    return !memcmp(a->mean, b->mean, 3 * n) && !memcmp(a->log_scale, b->log_scale, 3 * n) &&
           !memcmp(a->quaternion, b->quaternion, 4 * n) && !memcmp(a->opacity_logit, b->opacity_logit, n) &&
           !memcmp(a->sh, b->sh, 3 * n * td_sh_coefficients(a->sh_degree));
}

/* -- scenes -- */

tides_scene *scene_new(void) {
    tides_error error = {0, ""};
    tides_scene *scene = NULL;
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    return scene;
}

void scene_add(tides_scene *scene, const td_gaussians *gaussians, const tides_trajectory *trajectory, double scale,
               const char *name) {
    tides_error error = {0, ""};
    tides_gaussians view = td_gaussians_view(gaussians);
    scene_expect_ok(tides_scene_add(scene, &view, trajectory, scale, name, NULL, &error), &error);
}

tides_object scene_object_of(const tides_scene *scene, int32_t index) {
    tides_error error = {0, ""};
    tides_object object;
    scene_expect_ok(tides_scene_object(scene, index, &object, &error), &error);
    return object;
}

void scene_save(const tides_scene *scene, const char *path) {
    tides_error error = {0, ""};
    scene_expect_ok(tides_scene_save(scene, path, &error), &error);
}

void scene_load(tides_scene *scene, const char *path, const tides_trajectory *trajectory, double scale) {
    tides_error error = {0, ""};
    scene_expect_ok(tides_scene_add_file(scene, path, trajectory, scale, &error), &error);
}

static void expect_srgb(const tides_scene *scene, const char *file) {
    int32_t transfer;
    double gamma;
    tides_error error = {0, ""};
    scene_expect_ok(tides_scene_transfer(scene, &transfer, &gamma, &error), &error);
    if (transfer != TIDES_TRANSFER_SRGB) fail_msg("%s: transfer %d", file, (int)transfer);
}

void scene_is_srgb(const tides_scene *scene, const char *folder) {
    tides_scene_format format;
    tides_error error = {0, ""};
    expect_srgb(scene, folder);
    for (size_t i = 0; tides_scene_format_at(i, &format); i++) {
        char file[1200];
        snprintf(file, sizeof file, "%s/coded%.*s", folder, (int)strcspn(format.endings, " "), format.endings);
        if (!format.writes) continue;
        if (scene_object_of(scene, 0).motion && tides_scene_save(scene, file, &error) == TIDES_UNSUPPORTED) continue;
        tides_scene *again = scene_new();
        scene_save(scene, file);
        scene_load(again, file, NULL, 1);
        expect_srgb(again, file);
        tides_scene_destroy(again);
        remove(file);
    }
}

tides_trajectory *scene_path(int rates) {
    tides_pose_sample samples[4];
    memset(samples, 0, sizeof samples);
    for (int i = 0; i < 4; i++) {
        double angle = 0.5 * i;
        samples[i].time = 0.25 * i - 3;
        samples[i].position[0] = cos(angle);
        samples[i].position[2] = 7 + i;
        samples[i].quaternion[0] = cos(angle / 2);
        samples[i].quaternion[2] = sin(angle / 2);
        samples[i].velocity[1] = 0.1 * i;
        samples[i].angular_velocity[1] = 2;
        samples[i].has_rates = rates;
    }
    tides_error error = {0, ""};
    tides_trajectory *path = NULL;
    scene_expect_ok(tides_trajectory_create(samples, 4, &path, &error), &error);
    return path;
}

/* -- PLY -- */

/* A property of the PLY file, with the address of its values. */
typedef struct property {
    char name[32];
    const float *base; /* NULL: skipped; values are random */
    size_t stride;
    int type, list;
} property;

typedef struct maker {
    scene_bytes bytes;
    const scene_recipe *recipe;
    property properties[PROPERTIES_MAX];
    size_t count;
    uint64_t seed;
} maker;

static const char *const type_names[2][SCENE_TYPES] = {{"char", "uchar", "short", "ushort", "int", "uint", "float", "double"},
                                                       {"int8", "uint8", "int16", "uint16", "int32", "uint32", "float32",
                                                        "float64"}};

static void add_property(maker *m, const char *name, const float *base, size_t stride, int list) {
    if (m->count == PROPERTIES_MAX) abort();
    property *p = &m->properties[m->count++];
    snprintf(p->name, sizeof p->name, "%s", name);
    p->base = base;
    p->stride = stride;
    p->list = list;
    p->type = m->recipe->mixed ? (int)(scene_next(&m->seed) % SCENE_TYPES) : m->recipe->type;
}

static void add_numbered(maker *m, const char *stem, size_t count, const float *base, size_t step, size_t stride) {
    char name[32];
    for (size_t i = 0; i < count; i++) {
        snprintf(name, sizeof name, "%s_%zu", stem, i);
        add_property(m, name, base + i * step, stride, 0);
    }
}

static void add_properties(maker *m, const td_gaussians *g) {
    size_t k = td_sh_coefficients(g->sh_degree);
    char name[32];
    add_property(m, "x", g->mean, 3, 0);
    add_property(m, "y", g->mean + 1, 3, 0);
    add_property(m, "z", g->mean + 2, 3, 0);
    if (m->recipe->extras) {
        add_property(m, "nx", NULL, 0, 0);
        add_property(m, "red", NULL, 0, 0);
        add_property(m, "neighbours", NULL, 0, 1);
        add_property(m, "f_dc", NULL, 0, 0); /* almost the name of a colour coefficient */
    }
    add_numbered(m, "f_dc", 3, g->sh, 1, 3 * k);
    for (size_t j = 0; j < 3 * (k - 1); j++) { /* channel-major in the file, coefficient-major in memory */
        snprintf(name, sizeof name, "f_rest_%zu", j);
        add_property(m, name, g->sh + 3 * (1 + j % (k - 1)) + j / (k - 1), 3 * k, 0);
    }
    add_property(m, "opacity", g->opacity_logit, 1, 0);
    add_numbered(m, "scale", 3, g->log_scale, 1, 3);
    add_numbered(m, "rot", 4, g->quaternion, 1, 4);
    if (m->recipe->filter) add_property(m, "filter_3D", m->recipe->filter, 1, 0);
}

static void shuffle(maker *m) {
    for (size_t i = m->count; i > 1; i--) {
        size_t j = (size_t)(scene_next(&m->seed) % i);
        property swapped = m->properties[i - 1];
        m->properties[i - 1] = m->properties[j];
        m->properties[j] = swapped;
    }
}

static void add_line(maker *m, const char *text) { add_text(&m->bytes, "%s%s", text, m->recipe->crlf ? "\r\n" : "\n"); }

static void add_header(maker *m, int64_t count) {
    static const char *const formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    const char *const *types = type_names[m->recipe->sized_names != 0];
    char text[128];
    add_line(m, "ply");
    snprintf(text, sizeof text, "format %s 1.0", formats[m->recipe->format]);
    add_line(m, text);
    if (m->recipe->extras) {
        add_line(m, "comment element vertex 99: only a comment");
        add_line(m, "obj_info made by a test");
        add_line(m, "element camera 2");
        add_line(m, "property list uchar int ids");
        add_line(m, "property float  focal");
        add_line(m, "element nothing 5");
        add_line(m, "element pair 3");
        add_line(m, "property\tdouble a");
        add_line(m, "property uchar b");
    }
    snprintf(text, sizeof text, "element vertex %lld", (long long)count);
    add_line(m, text);
    for (size_t i = 0; i < m->count; i++) {
        const property *p = &m->properties[i];
        snprintf(text, sizeof text, "property %s%s %s", p->list ? "list ushort " : "", types[p->type], p->name);
        add_line(m, text);
    }
    if (m->recipe->extras) {
        add_line(m, "element face 1000000"); /* behind the vertices: its rows may be missing */
        add_line(m, "property list uchar int vertex_indices");
    }
    add_line(m, "end_header");
}

static void add_reversible(maker *m, const void *value, size_t size) {
    const uint16_t probe = 1;
    unsigned char little = 0, bytes[8];
    memcpy(&little, &probe, 1);
    memcpy(bytes, value, size);
    if ((m->recipe->format == SCENE_LITTLE) != (little == 1))
        for (size_t i = 0; i < size / 2; i++) {
            unsigned char swapped = bytes[i];
            bytes[i] = bytes[size - 1 - i];
            bytes[size - 1 - i] = swapped;
        }
    scene_bytes_add(&m->bytes, bytes, size);
}

static void add_value(maker *m, int type, double value) {
    if (m->recipe->format == SCENE_ASCII) {
        add_text(&m->bytes, type == SCENE_DOUBLE ? "%.17g " : type == SCENE_FLOAT ? "%.9g " : "%.0f ", value);
        return;
    }
    int8_t i8 = (int8_t)(type == 0 ? value : 0);
    uint8_t u8 = (uint8_t)(type == 1 ? value : 0);
    int16_t i16 = (int16_t)(type == 2 ? value : 0);
    uint16_t u16 = (uint16_t)(type == 3 ? value : 0);
    int32_t i32 = (int32_t)(type == 4 ? value : 0);
    uint32_t u32 = (uint32_t)(type == 5 ? value : 0);
    float f32 = (float)value;
    const void *const all[] = {&i8, &u8, &i16, &u16, &i32, &u32, &f32, &value};
    static const size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    add_reversible(m, all[type], sizes[type]);
}

static void end_row(maker *m) {
    if (m->recipe->format == SCENE_ASCII) add_line(m, "");
}

static void add_list(maker *m, int count_type, int type, size_t length) {
    add_value(m, count_type, (double)length);
    for (size_t i = 0; i < length; i++) add_value(m, type, (double)(scene_next(&m->seed) % 100));
}

static void add_elements_before(maker *m) {
    for (size_t i = 0; i < 2; i++) {
        add_list(m, 1, 4, 3 * i); /* the second list is empty */
        add_value(m, SCENE_FLOAT, 0.5);
        end_row(m);
    }
    for (size_t i = 0; i < 3; i++) {
        add_value(m, SCENE_DOUBLE, 1e300);
        add_value(m, 1, 200);
        end_row(m);
    }
}

scene_bytes scene_ply(const td_gaussians *gaussians, const scene_recipe *recipe) {
    maker m = {.recipe = recipe, .seed = recipe->seed};
    add_properties(&m, gaussians);
    if (recipe->shuffle) shuffle(&m);
    add_header(&m, gaussians->count);
    if (recipe->extras) add_elements_before(&m);
    for (size_t i = 0; i < (size_t)gaussians->count; i++) {
        for (size_t j = 0; j < m.count; j++) {
            const property *p = &m.properties[j];
            if (p->list)
                add_list(&m, 3, p->type, (size_t)(scene_next(&m.seed) % 4));
            else
                add_value(&m, p->type, p->base ? (double)p->base[i * p->stride] : (double)(scene_next(&m.seed) % 100));
        }
        end_row(&m);
    }
    return m.bytes;
}

void scene_save_pair(const char *path, td_gaussians *g) {
    *g = scene_random(82, 4, 1, SCENE_SMALL_INTEGERS);
    tides_scene *scene = scene_new();
    tides_trajectory *trajectory = scene_path(1);
    scene_add(scene, g, NULL, 1, "a");
    scene_add(scene, g, trajectory, 1, "b");
    scene_save(scene, path);
    tides_trajectory_destroy(trajectory);
    tides_scene_destroy(scene);
}
