/* Model directories of trainers open as scenes that have exactly the arrays of golden.npz beside them: every folder of
 * $TIDES_SHARED/golden/stg and fudan4d, and dyn3dgs. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "scene/td_scene.h"
#include "tests/support/golden_motion.h"
#include "tests/support/scene_folder.h"
#include "tests/support/golden_folder.h"

#include <math.h>
#include <stdlib.h>

/* A field, or an array of the Gaussians, against an array of the file. */
static void same(npz *archive, const char *name, const float *values) {
    size_t count = 0;
    float *expected = golden_floats(archive, name, &count);
    assert_non_null(values);
    assert_memory_equal(values, expected, count * sizeof *values);
    free(expected);
}

static const float *field(const tides_object *object, const char *name) {
    const td_field *found = td_motion_field(object->motion, name);
    if (!found) fail_msg("the motion has no field %s", name);
    return found->value;
}

static void check_stg(npz *archive, const tides_object *object) {
    size_t reals = 0;
    float *f_dc = golden_floats(archive, "raw_f_dc", &reals);
    int width = (int)(reals / (size_t)object->gaussians.count);
    same(archive, "raw_xyz", object->gaussians.mean);
    same(archive, "raw_scale", object->gaussians.log_scale);
    same(archive, "raw_rotation", object->gaussians.quaternion);
    same(archive, "raw_opacity", object->gaussians.opacity_logit);
    same(archive, "raw_trbf_center", field(object, "opacity_centre"));
    same(archive, "raw_trbf_scale", field(object, "opacity_log_width"));
    same(archive, "raw_motion", field(object, "mean_coefficient"));
    same(archive, "raw_omega", field(object, "quaternion_dot"));
    assert_true(td_motion_setting(object->motion, "plain_colour", 0) == 1);
    assert_int_equal(td_motion_field(object->motion, "feature") != NULL, width == 6);
    if (width == 6) same(archive, "raw_f_dc", field(object, "feature"));
    if (width == 6) same(archive, "raw_f_t", field(object, "feature_dot"));
    for (int64_t i = 0; i < 3 * object->gaussians.count; i++) {
        double colour = 0.5 + 0.28209479177387814 * (double)object->gaussians.sh[i];
        assert_true(fabs(colour - (double)f_dc[i / 3 * width + i % 3]) < 1e-6);
    }
    free(f_dc);
}

/* Coefficient by coefficient: stored ones are the Gaussians' own 16, then those of each harmonic. */
static void check_fudan_colours(npz *archive, const tides_object *object) {
    const td_field *harmonic = td_motion_field(object->motion, "sh_harmonic");
    size_t reals = 0, count = (size_t)object->gaussians.count, harmonics = harmonic ? (size_t)harmonic->shape[1] : 0;
    float *dc = golden_floats(archive, "raw_features_dc", NULL), *rest = golden_floats(archive, "raw_features_rest", &reals);
    size_t stored = reals / 3 / count;
    assert_int_equal((long)harmonics, npz_int(archive, "sh_degree_t"));
    for (size_t i = 0; i < count; i++) {
        assert_memory_equal(object->gaussians.sh + 48 * i, dc + 3 * i, 3 * sizeof *dc);
        assert_memory_equal(object->gaussians.sh + 48 * i + 3, rest + 3 * stored * i, 45 * sizeof *rest);
        if (harmonics == 0) continue;
        assert_memory_equal(harmonic->value + 48 * harmonics * i, rest + 3 * stored * i + 45, 48 * harmonics * sizeof *rest);
    }
    free(dc);
    free(rest);
}

static void check_fudan(npz *archive, const tides_object *object) {
    double start, stop, *duration = golden_doubles(archive, "time_duration", NULL);
    same(archive, "raw_xyz", object->gaussians.mean);
    same(archive, "raw_scaling", object->gaussians.log_scale);
    same(archive, "raw_rotation", object->gaussians.quaternion);
    same(archive, "raw_opacity", object->gaussians.opacity_logit);
    same(archive, "raw_t", field(object, "centre"));
    same(archive, "raw_scaling_t", field(object, "log_scale_time"));
    if (npz_int(archive, "rot_4d"))
        same(archive, "raw_rotation_r", field(object, "quaternion_right"));
    else
        assert_null(td_motion_field(object->motion, "quaternion_right"));
    check_fudan_colours(archive, object);
    tides_motion_range(object->motion, &start, &stop);
    assert_true(start == duration[0]);
    assert_true(stop == duration[1]); /* told from the centres */
    free(duration);
}

static void check_dyn3dgs(npz *archive, const tides_object *object) {
    same(archive, "means3D", field(object, "mean"));
    same(archive, "unnorm_rotations", field(object, "quaternion"));
    same(archive, "log_scales", object->gaussians.log_scale);
    same(archive, "logit_opacities", object->gaussians.opacity_logit);
    assert_null(td_motion_field(object->motion, "sh")); /* the same colours in every frame */
}

typedef struct kind {
    const char *model, *archive;
    void (*check)(npz *archive, const tides_object *object);
} kind;

static int visit(void *user, const char *path, const char *name) {
    const kind *what = user;
    char golden[4096];
    tides_error error = {0, ""};
    tides_scene *scene = NULL;
    tides_object object;
    snprintf(golden, sizeof golden, "%s/%s", path, what->archive);
    npz *archive = npz_open(golden);
    assert_non_null(archive);
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    scene_expect_ok(tides_scene_add_file(scene, path, NULL, 1, &error), &error);
    assert_int_equal(tides_scene_objects(scene), 1);
    scene_expect_ok(tides_scene_object(scene, 0, &object, &error), &error);
    assert_non_null(object.motion);
    assert_string_equal(tides_motion_model(object.motion), what->model);
    what->check(archive, &object);
    print_message("%s: %lld Gaussians\n", name, (long long)object.gaussians.count);
    tides_scene_destroy(scene);
    npz_close(archive);
    return 0;
}

static const kind stg = {"polynomial", "golden.npz", check_stg}, fudan = {"rotor", "golden.npz", check_fudan},
                  dyn3dgs = {"keyframes", "params.npz", check_dyn3dgs};

static void open_all(const char *folder, kind what) { golden_folder(folder, "", visit, &what); }

static void test_stg(void **state) {
    (void)state;
    open_all("golden/stg", stg);
}

static void test_fudan(void **state) {
    (void)state;
    open_all("golden/fudan4d", fudan);
}

static void test_dyn3dgs(void **state) {
    char path[4096];
    kind what = dyn3dgs;
    (void)state;
    if (shared_path(path, sizeof path, "golden/dyn3dgs") != 0) {
        print_message("skipped: no %s\n", path);
        skip();
    }
    assert_int_equal(visit(&what, path, "dyn3dgs"), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_stg), cmocka_unit_test(test_fudan),
                                       cmocka_unit_test(test_dyn3dgs)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
