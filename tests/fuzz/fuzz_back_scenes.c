/* Any Gaussians in each format of splat files that is written. .ply and .h5 give exactly the same numbers. Formats that round
 * (.glb, .spz, .splat) give the same numbers when written once more, or the writer refused them in one line. */
#include "fuzz.h"

#include "bytes.h"
#include "tides/scene.h"

#include <math.h>

enum { GAUSSIANS_MAX = 24, WIDTH_MAX = 75 /* SH of degree 4 */ };

typedef struct splats {
    float mean[3 * GAUSSIANS_MAX], log_scale[3 * GAUSSIANS_MAX], quaternion[4 * GAUSSIANS_MAX], logit[GAUSSIANS_MAX];
    float sh[WIDTH_MAX * GAUSSIANS_MAX];
} splats;

static void fill(float *values, size_t count, double reach, fuzz_bytes *b) {
    for (size_t i = 0; i < count; i++) values[i] = (float)fuzz_between(b, -reach, reach);
}

/* NULL where these can't be a scene. */
static tides_scene *scene_of(const tides_gaussians *g) {
    tides_scene *scene = NULL;
    tides_error error = {TIDES_OK, ""};
    if (tides_scene_create(&scene, &error) != TIDES_OK) abort();
    const tides_status status = tides_scene_add(scene, g, NULL, 1, NULL, NULL, &error);
    if (status == TIDES_OK) return scene;
    fuzz_one_line(status, &error);
    tides_scene_destroy(scene);
    return NULL;
}

/* Saved and read again; NULL where the format can't hold it. */
static tides_scene *there_and_back(const tides_scene *scene, const char *path) {
    tides_scene *again = NULL;
    tides_error error = {TIDES_OK, ""};
    const tides_status status = tides_scene_save(scene, path, &error);
    if (status != TIDES_OK) {
        if (status != TIDES_UNSUPPORTED) abort();
        fuzz_one_line(status, &error);
        return NULL;
    }
    if (tides_scene_create(&again, &error) != TIDES_OK) abort();
    if (tides_scene_add_file(again, path, NULL, 1, &error) != TIDES_OK) abort();
    return again;
}

static tides_gaussians gaussians_of(const tides_scene *scene) {
    tides_object object;
    tides_error error = {TIDES_OK, ""};
    if (tides_scene_objects(scene) != 1 || tides_scene_object(scene, 0, &object, &error) != TIDES_OK) abort();
    return object.gaussians;
}

static void near(const float *a, const float *b, size_t count, double tolerance) {
    for (size_t i = 0; i < count; i++)
        if (!(fabs((double)a[i] - (double)b[i]) <= tolerance * (1 + fabs((double)a[i])))) abort();
}

/* `tolerance` 0: the very bits, raw quaternions too. */
static void compare(const tides_scene *one, const tides_scene *two, double tolerance) {
    const tides_gaussians a = gaussians_of(one), b = gaussians_of(two);
    if (a.count != b.count || a.sh_degree != b.sh_degree) abort();
    const size_t n = (size_t)a.count, width = 3 * (size_t)(a.sh_degree + 1) * (size_t)(a.sh_degree + 1);
    for (size_t i = 0; i < 3 * n; i++) {
        const double x = a.origin[i % 3] + (double)a.mean[i], y = b.origin[i % 3] + (double)b.mean[i];
        if (!(fabs(x - y) <= tolerance * (1 + fabs(x)))) abort();
    }
    near(a.log_scale, b.log_scale, 3 * n, tolerance);
    near(a.sh, b.sh, width * n, tolerance);
    for (size_t i = 0; i < n; i++) {
        const double p = 1 / (1 + exp((double)-a.opacity_logit[i])), q = 1 / (1 + exp((double)-b.opacity_logit[i]));
        if (tolerance > 0 ? !(fabs(p - q) <= tolerance) : a.opacity_logit[i] != b.opacity_logit[i]) abort();
        const float *s = a.quaternion + 4 * i, *t = b.quaternion + 4 * i;
        double dot = 0, ss = 0, tt = 0;
        for (int k = 0; k < 4; k++) dot += (double)s[k] * t[k], ss += (double)s[k] * s[k], tt += (double)t[k] * t[k];
        if (tolerance > 0 ? !(fabs(dot) >= (1 - tolerance) * sqrt(ss * tt)) : memcmp(s, t, 4 * sizeof *s) != 0) abort();
    }
}

/* The first byte chooses the format, the second the degree of the SH; then how large things are, and the Gaussians. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const names[] = {"a.ply", "a.h5", "a.glb", "a.spz", "a.splat"};
    enum { NAMES = sizeof names / sizeof *names, EXACT = 2 };
    static splats s;
    char path[FUZZ_PATH];
    fuzz_bytes b = {data, size};
    const size_t format = fuzz_byte(&b) % NAMES;
    tides_gaussians g = {.sh_degree = (int32_t)(fuzz_byte(&b) % 5),
                         .count = 1 + fuzz_byte(&b) % GAUSSIANS_MAX,
                         .mean = s.mean,
                         .log_scale = s.log_scale,
                         .quaternion = s.quaternion,
                         .opacity_logit = s.logit,
                         .sh = s.sh};
    const size_t n = (size_t)g.count;
    const double far = ldexp(1, (int)(fuzz_byte(&b) % 64) - 20), large = fuzz_between(&b, 0, 90),
                 bright = fuzz_between(&b, 0, 9);
    fill(s.mean, 3 * n, far, &b);
    fill(s.log_scale, 3 * n, large, &b);
    fill(s.quaternion, 4 * n, 2, &b);
    fill(s.logit, n, 12, &b);
    fill(s.sh, 3 * n * (size_t)(g.sh_degree + 1) * (size_t)(g.sh_degree + 1), bright, &b);
    tides_scene *scene = scene_of(&g);
    if (!scene) return 0;
    fuzz_empty(fuzz_root());
    tides_scene *once = there_and_back(scene, fuzz_path(path, names[format]));
    if (once && format < EXACT) compare(scene, once, 0);
    if (once && format >= EXACT) {
        tides_scene *twice = there_and_back(once, path);
        if (!twice) abort();
        compare(once, twice, 2e-5);
        tides_scene_destroy(twice);
    }
    tides_scene_destroy(once);
    tides_scene_destroy(scene);
    return 0;
}
