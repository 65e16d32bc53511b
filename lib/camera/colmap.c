/* Reads COLMAP's cameras. Text: one line per camera, `ID MODEL WIDTH HEIGHT PARAMETERS`; '#' begins a comment. Binary,
 * little-endian: uint64 count, then for each camera {uint32 id, int32 model, uint64 width, uint64 height, double parameters[]}.
 * A model's number is its index in `models`, which has the number of its parameters.
 *
 * Parameters begin with f, cx, cy or fx, fy, cx, cy. The rest are coefficients of distortion, which is radtan or equidistant
 * for most models. FULL_OPENCV, FOV and THIN_PRISM_FISHEYE have other coefficients, too. If one of those isn't 0, the camera
 * gets no lens, and td_colmap_camera.distorted is 1. Its intrinsics are then of the pinhole that agrees with the lens at its
 * axis.
 *
 * Pixel centres are at 0.5 in COLMAP as in TIDES. */
#include "camera/td_colmap.h"

#include "camera/td_path_reader.h"
#include "td_base.h"
#include "td_folder.h"
#include "td_math.h"
#include "td_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MODELS = 11, PARAMETERS_MAX = 12, FOV = 7 }; /* FOV: its index in `models` */

/* COLMAP's models, in the order of their numbers. */
static const struct {
    const char *name;
    int parameters, focals;
} models[MODELS] = {{"SIMPLE_PINHOLE", 3, 1},
                    {"PINHOLE", 4, 2},
                    {"SIMPLE_RADIAL", 4, 1},
                    {"RADIAL", 5, 1},
                    {"OPENCV", 8, 2},
                    {"OPENCV_FISHEYE", 8, 2},
                    {"FULL_OPENCV", 12, 2},
                    {"FOV", 5, 2},
                    {"SIMPLE_RADIAL_FISHEYE", 4, 1},
                    {"RADIAL_FISHEYE", 5, 1},
                    {"THIN_PRISM_FISHEYE", 12, 2}};

/* 1 for a fisheye. A fisheye isn't a pinhole even if all coefficients are 0. */
static int is_fisheye(int model) { return strstr(models[model].name, "FISHEYE") != NULL; }

/* For each model, the indices of the lens coefficients k1 k2 p1 p2 k3 (fisheyes: k1 to k4) among the parameters behind the
 * principal point; -1: none. */
static const int places[MODELS][5] = {{-1, -1, -1, -1, -1}, {-1, -1, -1, -1, -1}, {0, -1, -1, -1, -1}, {0, 1, -1, -1, -1},
                                      {0, 1, 2, 3, -1},     {0, 1, 2, 3, -1},     {0, 1, 2, 3, 4},     {-1, -1, -1, -1, -1},
                                      {0, -1, -1, -1, -1},  {0, 1, -1, -1, -1},   {0, 1, 4, 5, -1}};

/* Sets `lens` from a camera's parameters. If a coefficient that no lens of TIDES has isn't 0, it sets none and returns 0. */
static int lens_of(int model, const double *parameters, tides_lens *lens) {
    const int first = 2 + models[model].focals, rest = models[model].parameters - first;
    double k[5] = {0};
    int used = 0, whole = 1;
    for (int i = 0; i < 5; i++) {
        if (places[model][i] < 0) continue;
        k[i] = parameters[first + places[model][i]];
        used |= 1 << places[model][i];
    }
    for (int i = 0; i < rest; i++) whole &= (used >> i & 1) || parameters[first + i] == 0.0;
    *lens = (tides_lens){.model = TIDES_LENS_NONE};
    if (whole) *lens = is_fisheye(model) ? td_equidistant(k) : td_radtan(k);
    return whole;
}

/* Magnification of a lens at its axis, over that of a pinhole with the file's focal lengths. FOV images a ray with
 * |(x, y)| / z = r at the radius atan(2 r tan(omega / 2)) / omega (Devernay and Faugeras 2001). For the other models it is 1:
 * their radii are r and terms of higher order. */
static double axis_scale(int model, const double *parameters) {
    const double omega = parameters[4];
    if (model != FOV || fabs(omega) < 1e-8) return 1; /* the next term, omega^2 / 12, is below rounding */
    return 2 * td_tan(0.5 * omega) / omega;
}

int td_colmap_is_named(const char *file, const char *name) { return strcmp(td_base_name(file), name) == 0; }

/* One camera of the file. */
typedef struct entry {
    uint32_t id;
    int model;
    double width, height, parameters[PARAMETERS_MAX];
} entry;

static tides_status check_entry(const char *file, const entry *e, tides_error *error) {
    const double *p = e->parameters;
    const unsigned long id = e->id;
    if (!(e->width >= 1 && e->width <= INT32_MAX && e->height >= 1 && e->height <= INT32_MAX))
        return td_fail(error, TIDES_BAD_FILE,
                       "%s: camera %lu: %g x %g pixels; width and height must be whole numbers from 1 to 2147483647", file, id,
                       e->width, e->height);
    for (int k = 0; k < models[e->model].parameters; k++)
        if (!isfinite(p[k]) || (k < models[e->model].focals && !(p[k] > 0)))
            return td_fail(error, TIDES_BAD_FILE, "%s: camera %lu: parameter %d of its model %s is %g; it must be finite%s",
                           file, id, k + 1, models[e->model].name, p[k], k < models[e->model].focals ? " and above 0" : "");
    if (e->model == FOV && !(fabs(p[4]) < TD_PI))
        return td_fail(error, TIDES_BAD_FILE,
                       "%s: camera %lu: parameter 5 of its model FOV is %g; it is an angle in radians between -pi and pi", file,
                       id, p[4]);
    return TIDES_OK;
}

static tides_status add_entry(const char *file, const entry *e, td_colmap_cameras *cameras, tides_error *error) {
    const double *p = e->parameters;
    int two = models[e->model].focals == 2;
    tides_status status = check_entry(file, e, error);
    if (status) return status;
    if (td_colmap_find(cameras, e->id))
        return td_fail(error, TIDES_BAD_FILE, "%s: two cameras have the id %lu", file, (unsigned long)e->id);
    void *list = cameras->list;
    if (td_reserve(&list, &cameras->capacity, cameras->count + 1, sizeof *cameras->list, error)) return TIDES_NO_MEMORY;
    cameras->list = list;
    const double scale = axis_scale(e->model, p);
    tides_intrinsics read = {(int32_t)e->width, (int32_t)e->height, scale * p[0], scale * p[two], p[1 + two], p[2 + two], {0}};
    const int distorted = !lens_of(e->model, p, &read.lens);
    cameras->list[cameras->count++] = (td_colmap_camera){e->id, distorted, read};
    return TIDES_OK;
}

/* -- text -- */

static tides_status parse_line(const char *file, size_t line, const char *c, td_colmap_cameras *cameras, tides_error *error) {
    entry e = {0};
    char *end;
    double id = 0, *const numbers[] = {&id, &e.width, &e.height};
    for (int k = 0; k < 3; k++) {
        const char *after = td_text_number(c, numbers[k]);
        if (after == c || *numbers[k] != floor(*numbers[k]) || !(id >= 0 && id <= UINT32_MAX))
            return td_fail(error, TIDES_BAD_FILE,
                           "%s:%zu: a camera is ID MODEL WIDTH HEIGHT and the model's parameters, with whole numbers as ID (0 "
                           "to 4294967295), WIDTH and HEIGHT",
                           file, line);
        c = td_text_skip(after);
        if (k > 0) continue;
        size_t length = strcspn(c, " \t\r\n");
        char word[TD_QUOTE];
        e.model = 0;
        while (e.model < MODELS && (strlen(models[e.model].name) != length || strncmp(models[e.model].name, c, length) != 0))
            e.model++;
        if (e.model == MODELS)
            return td_fail(error, TIDES_UNSUPPORTED,
                           "%s:%zu: unknown camera model \"%s\"; TIDES reads COLMAP's models %s to %s", file, line,
                           td_path_quote(c, length, word), models[0].name, models[MODELS - 1].name);
        c = td_text_skip(c + length);
    }
    int count = 0;
    for (; count < models[e.model].parameters && !td_text_ends(c); count++, c = td_text_skip(end)) {
        e.parameters[count] = strtod(c, &end);
        if (end == c) break;
    }
    e.id = (uint32_t)id;
    if (count == models[e.model].parameters && td_text_ends(c)) return add_entry(file, &e, cameras, error);
    return td_fail(error, TIDES_BAD_FILE, "%s:%zu: %s needs exactly %d numbers after WIDTH and HEIGHT", file, line,
                   models[e.model].name, models[e.model].parameters);
}

static tides_status parse_text(const char *file, const char *c, td_colmap_cameras *cameras, tides_error *error) {
    tides_status status = TIDES_OK;
    for (size_t line = 1; *c && !status; line++) {
        const char *data = td_text_skip(c);
        if (!td_text_ends(data)) status = parse_line(file, line, data, cameras, error);
        c += strcspn(c, "\n");
        c += *c == '\n';
    }
    return status;
}

/* -- binary -- */

static tides_status parse_binary(const char *file, const char *data, size_t bytes, td_colmap_cameras *cameras,
                                 tides_error *error) {
    td_bytes b = {data, bytes};
    uint64_t count = 0, width, height, id, model;
    if (!td_bytes_number(&b, 8, &count))
        return td_fail(error, TIDES_BAD_FILE, "%s: ends within the number of cameras: truncated?", file);
    for (uint64_t i = 0; i < count; i++) {
        entry e = {0};
        int whole = td_bytes_number(&b, 4, &id) && td_bytes_number(&b, 4, &model) && td_bytes_number(&b, 8, &width) &&
                    td_bytes_number(&b, 8, &height);
        if (whole && model >= MODELS)
            return td_fail(error, TIDES_UNSUPPORTED,
                           "%s: camera %lu (number %llu of %llu) has the unknown model %ld; TIDES reads models 0 to %d", file,
                           (unsigned long)id, (unsigned long long)i + 1, (unsigned long long)count, (long)(int32_t)model,
                           MODELS - 1);
        for (int k = 0; whole && k < models[model].parameters; k++) whole = td_bytes_double(&b, &e.parameters[k]);
        if (!whole)
            return td_fail(error, TIDES_BAD_FILE, "%s: ends within camera %llu of %llu: truncated?", file,
                           (unsigned long long)i + 1, (unsigned long long)count);
        e.id = (uint32_t)id;
        e.model = (int)model;
        e.width = (double)width;
        e.height = (double)height;
        tides_status status = add_entry(file, &e, cameras, error);
        if (status) return status;
    }
    return TIDES_OK;
}

tides_status td_colmap_parse_cameras(const char *file, const char *data, size_t bytes, int binary, td_colmap_cameras *cameras,
                                     tides_error *error) {
    td_colmap_cameras made = {NULL, 0, 0};
    tides_status status = binary ? parse_binary(file, data, bytes, &made, error) : parse_text(file, data, &made, error);
    if (!status && made.count == 0) status = td_fail(error, TIDES_BAD_FILE, "%s: holds no camera", file);
    if (status)
        free(made.list);
    else
        *cameras = made;
    return status;
}

tides_status td_colmap_load_cameras(const char *file, int binary, td_colmap_cameras *cameras, tides_error *error) {
    for (int k = 0; k < 2; k++) {
        int as_binary = k == 0 ? binary : !binary;
        char *beside = td_beside(file, as_binary ? "cameras.bin" : "cameras.txt", error);
        if (!beside) return TIDES_NO_MEMORY;
        char *data = NULL;
        size_t bytes = 0;
        int there = access(beside, F_OK) == 0;
        tides_status status = there ? td_read_file(beside, TD_LARGEST_PATH, &data, &bytes, error) : TIDES_OK;
        if (there && !status && !as_binary) td_break_lines(data);
        if (there && !status) status = td_colmap_parse_cameras(beside, data, bytes, as_binary, cameras, error);
        free(data);
        free(beside);
        if (there || status) return status;
    }
    return td_fail(error, TIDES_FILE_NOT_FOUND, "%s: needs COLMAP's cameras.bin or cameras.txt beside it", file);
}

const td_colmap_camera *td_colmap_find(const td_colmap_cameras *cameras, uint32_t id) {
    for (size_t i = 0; i < cameras->count; i++)
        if (cameras->list[i].id == id) return &cameras->list[i];
    return NULL;
}
