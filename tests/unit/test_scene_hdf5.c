/* TIDES's own scene files: round trips with everything a scene holds, files made by others, placement, and every way of being
 * wrong, with its message. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"

#include <hdf5.h>
#include <math.h>
#include <unistd.h>

static tides_scene *new_scene(void) {
    tides_error error = {0, ""};
    tides_scene *scene = NULL;
    scene_expect_ok(tides_scene_create(&scene, &error), &error);
    return scene;
}

static void add(tides_scene *scene, const td_gaussians *g, const tides_trajectory *trajectory, double scale, const char *name) {
    tides_error error = {0, ""};
    tides_gaussians view = td_gaussians_view(g);
    scene_expect_ok(tides_scene_add(scene, &view, trajectory, scale, name, NULL, &error), &error);
}

static tides_object object_of(const tides_scene *scene, int32_t index) {
    tides_error error = {0, ""};
    tides_object object;
    scene_expect_ok(tides_scene_object(scene, index, &object, &error), &error);
    return object;
}

static void save(const tides_scene *scene, const char *path) {
    tides_error error = {0, ""};
    scene_expect_ok(tides_scene_save(scene, path, &error), &error);
}

static void load(tides_scene *scene, const char *path, const tides_trajectory *trajectory, double scale) {
    tides_error error = {0, ""};
    scene_expect_ok(tides_scene_add_file(scene, path, trajectory, scale, &error), &error);
}

static tides_trajectory *path_with_rates(int rates) {
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

static void expect_same_path(const tides_trajectory *a, const tides_trajectory *b) {
    assert_int_equal(tides_trajectory_count(a), tides_trajectory_count(b));
    for (size_t i = 0; i < tides_trajectory_count(a); i++) {
        tides_pose_sample s, t;
        assert_int_equal(tides_trajectory_sample(a, i, &s, NULL), TIDES_OK);
        assert_int_equal(tides_trajectory_sample(b, i, &t, NULL), TIDES_OK);
        assert_true(s.time == t.time && s.has_rates == t.has_rates);
        assert_memory_equal(s.position, t.position, sizeof s.position);
        for (int k = 0; k < 4; k++) assert_true(fabs(s.quaternion[k] - t.quaternion[k]) < 1e-15);
        if (!s.has_rates) continue;
        assert_memory_equal(s.velocity, t.velocity, sizeof s.velocity);
        assert_memory_equal(s.angular_velocity, t.angular_velocity, sizeof s.angular_velocity);
    }
}

/* -- round trips -- */

static void test_round_trip(void **state) {
    tides_error error = {0, ""};
    tides_scene *scene = new_scene(), *again = new_scene();
    tides_trajectory *paths[5] = {NULL, path_with_rates(0), path_with_rates(1), NULL, NULL};
    const double place[3] = {1, 2, 3}, turn[4] = {0, 1, 0, 0};
    scene_expect_ok(tides_trajectory_create_static(place, turn, &paths[3], &error), &error);
    static const char *const names[5] = {"wall", "fan \"\xc3\xa9\"", "", NULL, "4"};
    td_gaussians all[5];
    for (int32_t i = 0; i < 5; i++) {
        all[i] = scene_random(60 + (uint64_t)i, 1 + 10 * i, i, SCENE_TRAINED);
        add(scene, &all[i], paths[i], 0.5 + i, names[i]);
    }
    const char *path = scene_in_folder(*state, "s.h5");
    save(scene, path);
    assert_int_not_equal(access(scene_in_folder(*state, "s.h5.part"), F_OK), 0);
    load(again, path, NULL, 1);
    assert_int_equal(tides_scene_objects(again), 5);
    for (int32_t i = 0; i < 5; i++) {
        tides_object object = object_of(again, i);
        assert_true(scene_same(&all[i], &object.gaussians));
        assert_true(object.scale == 0.5 + i);
        assert_string_equal(object.name, i == 3 ? "object 3" : names[i]);
        assert_string_equal(object.source, path); /* made from arrays: no file before this one */
        assert_int_equal(object.trajectory != NULL, paths[i] != NULL);
        if (paths[i]) expect_same_path(object.trajectory, paths[i]);
        td_gaussians_free(&all[i]);
        tides_trajectory_destroy(paths[i]);
    }
    tides_pose pose;
    scene_expect_ok(tides_trajectory_at(object_of(again, 3).trajectory, 1e9, &pose, &error), &error); /* still static */
    tides_scene_destroy(scene);
    tides_scene_destroy(again);
}

/* PLY to HDF5 to PLY gives the bytes back, and the source stays the first file. */
static void test_ply_hdf5_ply(void **state) {
    for (int32_t degree = 0; degree <= TIDES_SH_DEGREE_MAX; degree++) {
        td_gaussians g = scene_random(70 + (uint64_t)degree, 50, degree, SCENE_TRAINED);
        tides_scene *a = new_scene(), *b = new_scene(), *c = new_scene();
        const char *first = scene_in_folder(*state, "first.ply"), *middle = scene_in_folder(*state, "middle.h5"),
                   *last = scene_in_folder(*state, "last.ply");
        add(a, &g, NULL, 1, NULL);
        save(a, first);
        load(b, first, NULL, 1);
        save(b, middle);
        load(c, middle, NULL, 1);
        assert_string_equal(object_of(c, 0).source, first);
        assert_string_equal(object_of(c, 0).name, "first");
        save(c, last);
        size_t size, size_again;
        char *bytes = scene_file_read(first, &size), *again = scene_file_read(last, &size_again);
        assert_int_equal(size, size_again);
        assert_memory_equal(bytes, again, size);
        free(bytes);
        free(again);
        td_gaussians_free(&g);
        tides_scene_destroy(a);
        tides_scene_destroy(b);
        tides_scene_destroy(c);
    }
}

/* The same scene makes the same bytes; the format is found from the content, whatever the name. */
static void test_deterministic(void **state) {
    td_gaussians g = scene_random(80, 20, 1, SCENE_TRAINED);
    tides_scene *scene = new_scene();
    tides_trajectory *path = path_with_rates(1);
    add(scene, &g, path, 1, "fan");
    const char *a = scene_in_folder(*state, "a.h5"), *b = scene_in_folder(*state, "b.h5");
    save(scene, a);
    save(scene, b);
    size_t size, size_again;
    char *bytes = scene_file_read(a, &size), *again = scene_file_read(b, &size_again);
    assert_int_equal(size, size_again);
    assert_memory_equal(bytes, again, size);
    free(bytes);
    free(again);
    const char *misnamed = scene_in_folder(*state, "really_hdf5.ply");
    assert_int_equal(rename(a, misnamed), 0);
    load(scene, misnamed, NULL, 1);
    assert_int_equal(tides_scene_objects(scene), 2);
    tides_trajectory_destroy(path);
    td_gaussians_free(&g);
    tides_scene_destroy(scene);
}

static void test_placement(void **state) {
    tides_error error = {0, ""};
    td_gaussians g = scene_random(81, 3, 0, SCENE_TRAINED);
    tides_trajectory *path = path_with_rates(0);
    tides_scene *rest = new_scene(), *moving = new_scene(), *scene = new_scene();
    const char *at_rest = scene_in_folder(*state, "rest.h5"), *in_motion = scene_in_folder(*state, "moving.h5");
    add(rest, &g, NULL, 2, "a");
    add(rest, &g, NULL, 3, "b");
    save(rest, at_rest);
    load(scene, at_rest, path, 10);
    assert_true(object_of(scene, 0).scale == 20 && object_of(scene, 1).scale == 30);
    expect_same_path(object_of(scene, 1).trajectory, path);
    add(moving, &g, NULL, 2, "a");
    add(moving, &g, path, 3, "b");
    save(moving, in_motion);
    scene_expect_error(tides_scene_add_file(scene, in_motion, path, 1, &error), TIDES_UNSUPPORTED, &error,
                       "moving.h5|/objects/1|trajectory of its own");
    scene_expect_error(tides_scene_add_file(scene, in_motion, NULL, 2, &error), TIDES_UNSUPPORTED, &error, "/objects/1");
    scene_expect_error(tides_scene_add_file(scene, at_rest, NULL, -2, &error), TIDES_BAD_ARGUMENT, &error,
                       "rest.h5|scale is -2");
    scene_expect_error(tides_scene_add_file(scene, at_rest, NULL, 0, &error), TIDES_BAD_ARGUMENT, &error, "scale is 0");
    assert_int_equal(tides_scene_objects(scene), 2); /* all of a file's objects, or none */
    tides_trajectory_destroy(path);
    td_gaussians_free(&g);
    tides_scene_destroy(rest);
    tides_scene_destroy(moving);
    tides_scene_destroy(scene);
}

/* -- edited files -- */

static void write_attribute(hid_t at, const char *name, hid_t type, const void *value) {
    if (H5Aexists(at, name) > 0) assert_true(H5Adelete(at, name) >= 0);
    hid_t space = H5Screate(H5S_SCALAR);
    hid_t attribute = H5Acreate2(at, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Awrite(attribute, type, value) >= 0);
    H5Aclose(attribute);
    H5Sclose(space);
}

static void write_fixed_text(hid_t at, const char *name, const char *text) {
    hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, strlen(text) + 1);
    write_attribute(at, name, type, text);
    H5Tclose(type);
}

/* A dataset in place of `name`: stored as `type`, chunked and compressed where `deflate`; NULL `values` writes none. */
static void replace_dataset(hid_t file, const char *name, hid_t type, int rank, const hsize_t *shape, const double *values,
                            int deflate) {
    if (H5Lexists(file, name, H5P_DEFAULT) > 0) H5Ldelete(file, name, H5P_DEFAULT);
    hid_t space = H5Screate_simple(rank, shape, NULL), properties = H5Pcreate(H5P_DATASET_CREATE);
    if (deflate) H5Pset_chunk(properties, rank, shape);
    if (deflate) H5Pset_deflate(properties, 9);
    hid_t set = H5Dcreate2(file, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    assert_true(set >= 0);
    if (values) assert_true(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    H5Dclose(set);
    H5Pclose(properties);
    H5Sclose(space);
}

/* Two objects of 4 Gaussians, degree 1; the second moves. */
static void save_sample(const char *path, td_gaussians *g) {
    *g = scene_random(82, 4, 1, SCENE_SMALL_INTEGERS);
    tides_scene *scene = new_scene();
    tides_trajectory *trajectory = path_with_rates(1);
    add(scene, g, NULL, 1, "a");
    add(scene, g, trajectory, 1, "b");
    save(scene, path);
    tides_trajectory_destroy(trajectory);
    tides_scene_destroy(scene);
}

/* As h5py or another program would write it: big-endian doubles, half floats, compression, texts of fixed length, and more than
 * the layout asks for. */
static void test_other_writers(void **state) {
    const char *path = scene_in_folder(*state, "s.h5");
    td_gaussians g;
    save_sample(path, &g);
    double values[48];
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    for (int i = 0; i < 12; i++) values[i] = g.mean[i];
    replace_dataset(file, "/objects/0/mean", H5T_IEEE_F64BE, 2, (hsize_t[]){4, 3}, values, 1);
    for (int i = 0; i < 48; i++) values[i] = g.sh[i];
    hid_t half = H5Tcopy(H5T_IEEE_F32LE); /* binary16, which numpy writes: exact for these values */
    assert_true(H5Tset_fields(half, 15, 10, 5, 0, 10) >= 0 && H5Tset_size(half, 2) >= 0 && H5Tset_ebias(half, 15) >= 0);
    replace_dataset(file, "/objects/0/sh", half, 3, (hsize_t[]){4, 4, 3}, values, 1);
    H5Tclose(half);
    replace_dataset(file, "/objects/0/labels", H5T_STD_I32LE, 2, (hsize_t[]){4, 3}, values, 0);
    write_fixed_text(file, "format", "tides-scene");
    write_fixed_text(file, "tides_version", "99.0.0");
    const long long version = 1;
    write_attribute(file, "version", H5T_NATIVE_LLONG, &version);
    hid_t object = H5Gopen2(file, "/objects/0", H5P_DEFAULT);
    write_fixed_text(object, "name", "made by hand");
    const int whole = 2;
    write_attribute(object, "scale", H5T_NATIVE_INT, &whole);
    H5Gclose(object);
    H5Fclose(file);
    tides_scene *scene = new_scene();
    load(scene, path, NULL, 1);
    tides_object read = object_of(scene, 0);
    assert_true(scene_same(&g, &read.gaussians));
    assert_string_equal(read.name, "made by hand");
    assert_true(read.scale == 2);
    tides_scene_destroy(scene);
    td_gaussians_free(&g);
}

/* What one edit does to the sample file. */
typedef struct edit {
    enum { REMOVE, REMOVE_ATTRIBUTE, TEXT, INT, DOUBLE, SHAPE, INTEGERS, NO_VALUES, VALUE } kind;
    const char *group, *name; /* a dataset or link: the whole path in `name` */
    const char *text;
    double number;
    int rank;
    hsize_t shape[3];
    tides_status status;
    const char *expected;
} edit;

static void fill_dataset(hid_t file, const edit *e, hid_t type) {
    size_t count = 1;
    for (int i = 0; i < e->rank; i++) count *= (size_t)e->shape[i];
    double *values = calloc(count ? count : 1, sizeof *values);
    assert_non_null(values);
    for (size_t i = 0; i < count; i++) values[i] = e->kind == VALUE ? e->number : 1;
    replace_dataset(file, e->name, type, e->rank, e->shape, values, 0);
    free(values);
}

static void apply(hid_t file, const edit *e) {
    hid_t group = H5Gopen2(file, e->group ? e->group : "/", H5P_DEFAULT);
    assert_true(group >= 0);
    int whole = (int)e->number;
    switch (e->kind) {
        case REMOVE: assert_true(H5Ldelete(file, e->name, H5P_DEFAULT) >= 0); break;
        case REMOVE_ATTRIBUTE: assert_true(H5Adelete(group, e->name) >= 0); break;
        case TEXT: write_fixed_text(group, e->name, e->text); break;
        case INT: write_attribute(group, e->name, H5T_NATIVE_INT, &whole); break;
        case DOUBLE: write_attribute(group, e->name, H5T_NATIVE_DOUBLE, &e->number); break;
        case NO_VALUES: replace_dataset(file, e->name, H5T_IEEE_F32LE, e->rank, e->shape, NULL, 0); break;
        case INTEGERS: fill_dataset(file, e, H5T_STD_I32LE); break;
        default: fill_dataset(file, e, H5T_IEEE_F64LE); break;
    }
    H5Gclose(group);
}

static void test_refusals(void **state) {
    static const edit edits[] = {
        {.kind = REMOVE_ATTRIBUTE, .name = "format", .expected = "not a TIDES scene"},
        {.kind = TEXT, .name = "format", .text = "tides-events", .expected = "not a TIDES scene|tides-scene"},
        {.kind = INT, .name = "format", .number = 1, .expected = "not a TIDES scene"},
        {.kind = REMOVE_ATTRIBUTE, .name = "version", .expected = "attribute version of /|whole number"},
        {.kind = TEXT, .name = "version", .text = "1", .expected = "attribute version of /|whole number"},
        {.kind = DOUBLE, .name = "version", .number = 1, .expected = "attribute version of /|whole number"},
        {.kind = INT,
         .name = "version",
         .number = 2,
         .status = TIDES_UNSUPPORTED,
         .expected = "version 2|reads version 1|update"},
        {.kind = REMOVE_ATTRIBUTE, .name = "objects", .expected = "attribute objects of /"},
        {.kind = INT, .name = "objects", .number = 0, .expected = "holds 0 objects"},
        {.kind = INT, .name = "objects", .number = -3, .expected = "holds -3 objects"},
        {.kind = INT, .name = "objects", .number = 3, .expected = "group 2 is missing in /objects"},
        {.kind = INT, .name = "objects", .number = 2147483647, .expected = "group 2 is missing in /objects"},
        {.kind = REMOVE, .name = "/objects", .expected = "group objects is missing in /"},
        {.kind = REMOVE_ATTRIBUTE, .group = "/objects/1", .name = "name", .expected = "attribute name of /objects/1|text"},
        {.kind = INT, .group = "/objects/1", .name = "source", .expected = "attribute source of /objects/1|text"},
        {.kind = REMOVE_ATTRIBUTE, .group = "/objects/1", .name = "scale", .expected = "attribute scale of /objects/1"},
        {.kind = DOUBLE, .group = "/objects/1", .name = "scale", .number = -1, .expected = "scale of /objects/1 is -1"},
        {.kind = DOUBLE, .group = "/objects/1", .name = "scale", .number = NAN, .expected = "scale of /objects/1 is|nan"},
        {.kind = DOUBLE, .group = "/objects/1", .name = "scale", .number = 1e300, .expected = "scale of /objects/1 is 1e+300"},
        {.kind = REMOVE_ATTRIBUTE, .group = "/objects/1", .name = "sh_degree", .expected = "attribute sh_degree of /objects/1"},
        {.kind = INT, .group = "/objects/1", .name = "sh_degree", .number = 5, .expected = "sh_degree of /objects/1 is 5"},
        {.kind = INT,
         .group = "/objects/1",
         .name = "sh_degree",
         .number = 2,
         .expected = "dataset sh|length 4 in dimension 1|9"},
        {.kind = REMOVE, .name = "/objects/1/mean", .expected = "dataset mean of /objects/1 is missing"},
        {.kind = REMOVE, .name = "/objects/1/log_scale", .expected = "dataset log_scale of /objects/1 is missing"},
        {.kind = REMOVE, .name = "/objects/1/quaternion", .expected = "dataset quaternion of /objects/1 is missing"},
        {.kind = REMOVE, .name = "/objects/1/opacity_logit", .expected = "dataset opacity_logit of /objects/1 is missing"},
        {.kind = REMOVE, .name = "/objects/1/sh", .expected = "dataset sh of /objects/1 is missing"},
        {.kind = INTEGERS, .name = "/objects/1/mean", .rank = 2, .shape = {4, 3}, .expected = "mean|floating-point"},
        {.kind = SHAPE, .name = "/objects/1/mean", .rank = 1, .shape = {12}, .expected = "mean of /objects/1|2 dimensions"},
        {.kind = SHAPE,
         .name = "/objects/1/mean",
         .rank = 2,
         .shape = {5, 3},
         .expected = "log_scale|length 4 in dimension 0|5"},
        {.kind = SHAPE, .name = "/objects/1/mean", .rank = 2, .shape = {4, 2}, .expected = "mean|length 2 in dimension 1"},
        {.kind = SHAPE, .name = "/objects/1/mean", .rank = 2, .shape = {0, 3}, .expected = "/objects/1 holds 0 Gaussians"},
        {.kind = SHAPE, .name = "/objects/1/quaternion", .rank = 2, .shape = {4, 3}, .expected = "quaternion|should be 4"},
        {.kind = SHAPE,
         .name = "/objects/1/opacity_logit",
         .rank = 2,
         .shape = {4, 1},
         .expected = "opacity_logit|1 dimensions"},
        {.kind = SHAPE, .name = "/objects/1/sh", .rank = 2, .shape = {4, 12}, .expected = "sh of /objects/1|3 dimensions"},
        {.kind = NO_VALUES, .name = "/objects/1/mean", .rank = 2, .shape = {4, 3}, .expected = "mean|more than the file holds"},
        {.kind = NO_VALUES,
         .name = "/objects/1/mean",
         .rank = 2,
         .shape = {1000000000000, 3},
         .expected = "mean|1000000000000 rows|more than the file holds"},
        {.kind = VALUE,
         .name = "/objects/1/mean",
         .rank = 2,
         .shape = {4, 3},
         .number = NAN,
         .expected = "/objects/1|mean[0] is nan"},
        {.kind = VALUE,
         .name = "/objects/1/mean",
         .rank = 2,
         .shape = {4, 3},
         .number = 1e300,
         .expected = "/objects/1|mean[0] is inf"},
        {.kind = VALUE,
         .name = "/objects/1/quaternion",
         .rank = 2,
         .shape = {4, 4},
         .expected = "Gaussian 0: quaternion|norm 0"},
        {.kind = REMOVE, .name = "/objects/1/trajectory/time", .expected = "time of /objects/1/trajectory is missing"},
        {.kind = REMOVE, .name = "/objects/1/trajectory/velocity", .expected = "dataset velocity|missing"},
        {.kind = REMOVE, .name = "/objects/1/trajectory/angular_velocity", .expected = "dataset angular_velocity|missing"},
        {.kind = SHAPE,
         .name = "/objects/1/trajectory/time",
         .rank = 1,
         .shape = {5},
         .expected = "position|length 4|should be 5"},
        {.kind = VALUE,
         .name = "/objects/1/trajectory/time",
         .rank = 1,
         .shape = {4},
         .expected = "/objects/1/trajectory|equals"},
        {.kind = SHAPE,
         .name = "/objects/1/trajectory/time",
         .rank = 1,
         .shape = {0},
         .expected = "position of /objects/1/trajectory|should be 0"},
        {.kind = SHAPE,
         .name = "/objects/1/trajectory/position",
         .rank = 2,
         .shape = {3, 3},
         .expected = "position|should be 4"},
        {.kind = VALUE,
         .name = "/objects/1/trajectory/quaternion",
         .rank = 2,
         .shape = {4, 4},
         .expected = "quaternion is zero"},
    };
    const char *path = scene_in_folder(*state, "s.h5");
    for (size_t i = 0; i < sizeof edits / sizeof edits[0]; i++) {
        td_gaussians g;
        save_sample(path, &g);
        hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
        assert_true(file >= 0);
        apply(file, &edits[i]);
        H5Fclose(file);
        tides_error error = {0, ""};
        tides_scene *scene = new_scene();
        add(scene, &g, NULL, 1, NULL);
        tides_status wanted = edits[i].status ? edits[i].status : TIDES_BAD_FILE;
        tides_status status = tides_scene_add_file(scene, path, NULL, 1, &error);
        scene_expect_error(status, wanted, &error, edits[i].expected);
        scene_expect_error(status, wanted, &error, "s.h5");
        assert_int_equal(tides_scene_objects(scene), 1); /* not even the good object of the file */
        assert_int_equal(tides_scene_add_file(scene, path, NULL, 1, NULL), wanted);
        assert_int_equal(H5Fget_obj_count((hid_t)H5F_OBJ_ALL, H5F_OBJ_ALL), 0); /* every handle is closed */
        td_gaussians_free(&g);
        tides_scene_destroy(scene);
    }
}

/* However much of a file is missing at its end, it is refused. */
static void test_truncations(void **state) {
    const char *path = scene_in_folder(*state, "s.h5");
    td_gaussians g;
    save_sample(path, &g);
    size_t size;
    char *bytes = scene_file_read(path, &size);
    for (size_t kept = 8; kept < size; kept += kept < 256 ? 1 : 97) {
        scene_file_write(path, bytes, kept);
        tides_error error = {0, ""};
        tides_scene *scene = new_scene();
        scene_expect_error(tides_scene_add_file(scene, path, NULL, 1, &error), TIDES_BAD_FILE, &error, "s.h5|HDF5|truncated");
        tides_scene_destroy(scene);
    }
    free(bytes);
    td_gaussians_free(&g);
}

/* HDF5's own printing of errors is the program's affair: silent during a call of ours, and as it was afterwards. */
static herr_t count_prints(hid_t stack, void *user) {
    (void)stack;
    ++*(int *)user;
    return 0;
}

static void test_error_printing(void **state) {
    int prints = 0;
    H5E_auto2_t before = NULL;
    void *before_data = NULL;
    H5Eget_auto2(H5E_DEFAULT, &before, &before_data);
    H5Eset_auto2(H5E_DEFAULT, count_prints, &prints);
    const char *path = scene_in_folder(*state, "s.h5");
    td_gaussians g;
    save_sample(path, &g);
    scene_file_write(path, "\x89HDF\r\n\x1a\n rubbish", 16);
    tides_error error = {0, ""};
    tides_scene *scene = new_scene();
    assert_int_equal(tides_scene_add_file(scene, path, NULL, 1, &error), TIDES_BAD_FILE);
    assert_int_equal(prints, 0);
    assert_true(H5Gopen2(-1, "none", H5P_DEFAULT) < 0);
    assert_int_equal(prints, 1);
    H5Eset_auto2(H5E_DEFAULT, before, before_data);
    td_gaussians_free(&g);
    tides_scene_destroy(scene);
}

int main(void) {
#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_setup, scene_folder_teardown)
    const struct CMUnitTest tests[] = {
        IN_FOLDER(test_round_trip),  IN_FOLDER(test_ply_hdf5_ply),   IN_FOLDER(test_deterministic),
        IN_FOLDER(test_placement),   IN_FOLDER(test_other_writers),  IN_FOLDER(test_refusals),
        IN_FOLDER(test_truncations), IN_FOLDER(test_error_printing),
    };
    return cmocka_run_group_tests_name("scene_hdf5", tests, NULL, NULL);
}
