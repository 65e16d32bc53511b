/* TIDES' own scene files as other programs write them, and every error with its message: a valid file is edited through HDF5
 * and read. */
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

/* As h5py or another program would write it: big-endian doubles, half floats, compression, texts of fixed length, and more than
 * the layout asks for. */
static void test_other_writers(void **state) {
    const char *path = scene_in_folder(*state, "s.h5");
    td_gaussians g;
    scene_save_pair(path, &g);
    double values[48];
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    for (int i = 0; i < 12; i++) values[i] = g.mean[i];
    replace_dataset(file, "/objects/0/mean", H5T_IEEE_F64BE, 2, (hsize_t[]){4, 3}, values, 1);
    for (int i = 0; i < 48; i++) values[i] = g.sh[i];
    hid_t half = H5Tcopy(H5T_IEEE_F32LE); /* binary16, which numpy writes: exact for these values */
    assert_true(H5Tset_fields(half, 15, 10, 5, 0, 10) >= 0);
    assert_true(H5Tset_size(half, 2) >= 0);
    assert_true(H5Tset_ebias(half, 15) >= 0);
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
    tides_scene *scene = scene_new();
    scene_load(scene, path, NULL, 1);
    tides_object read = scene_object_of(scene, 0);
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

/* One at a time, each to a fresh sample; where no status is given, the file is bad. */
static const edit edits[] = {
    {.kind = REMOVE_ATTRIBUTE, .name = "format", .expected = "not a TIDES scene"},
    {.kind = TEXT, .name = "format", .text = "tides-events", .expected = "not a TIDES scene|tides-scene"},
    {.kind = INT, .name = "format", .number = 1, .expected = "not a TIDES scene"},
    {.kind = REMOVE_ATTRIBUTE, .name = "version", .expected = "attribute version of /|whole number"},
    {.kind = TEXT, .name = "version", .text = "1", .expected = "attribute version of /|whole number"},
    {.kind = DOUBLE, .name = "version", .number = 1, .expected = "attribute version of /|whole number"},
    {.kind = INT,
     .name = "version",
     .number = 3,
     .status = TIDES_UNSUPPORTED,
     .expected = "version 3|reads versions 1 to 2|update"},
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
    {.kind = INT, .group = "/objects/1", .name = "sh_degree", .number = 2, .expected = "dataset sh|length 4 in dimension 1|9"},
    {.kind = REMOVE, .name = "/objects/1/mean", .expected = "dataset mean of /objects/1 is missing"},
    {.kind = REMOVE, .name = "/objects/1/log_scale", .expected = "dataset log_scale of /objects/1 is missing"},
    {.kind = REMOVE, .name = "/objects/1/quaternion", .expected = "dataset quaternion of /objects/1 is missing"},
    {.kind = REMOVE, .name = "/objects/1/opacity_logit", .expected = "dataset opacity_logit of /objects/1 is missing"},
    {.kind = REMOVE, .name = "/objects/1/sh", .expected = "dataset sh of /objects/1 is missing"},
    {.kind = INTEGERS, .name = "/objects/1/mean", .rank = 2, .shape = {4, 3}, .expected = "mean|floating-point"},
    {.kind = SHAPE, .name = "/objects/1/mean", .rank = 1, .shape = {12}, .expected = "mean of /objects/1|2 dimensions"},
    {.kind = SHAPE, .name = "/objects/1/mean", .rank = 2, .shape = {5, 3}, .expected = "log_scale|length 4 in dimension 0|5"},
    {.kind = SHAPE, .name = "/objects/1/mean", .rank = 2, .shape = {4, 2}, .expected = "mean|length 2 in dimension 1"},
    {.kind = SHAPE, .name = "/objects/1/mean", .rank = 2, .shape = {0, 3}, .expected = "/objects/1 holds 0 Gaussians"},
    {.kind = SHAPE, .name = "/objects/1/quaternion", .rank = 2, .shape = {4, 3}, .expected = "quaternion|should be 4"},
    {.kind = SHAPE, .name = "/objects/1/opacity_logit", .rank = 2, .shape = {4, 1}, .expected = "opacity_logit|1 dimensions"},
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
    {.kind = VALUE, .name = "/objects/1/quaternion", .rank = 2, .shape = {4, 4}, .expected = "Gaussian 0: quaternion|norm 0"},
    {.kind = REMOVE, .name = "/objects/1/trajectory/time", .expected = "time of /objects/1/trajectory is missing"},
    {.kind = REMOVE, .name = "/objects/1/trajectory/velocity", .expected = "dataset velocity|missing"},
    {.kind = REMOVE, .name = "/objects/1/trajectory/angular_velocity", .expected = "dataset angular_velocity|missing"},
    {.kind = SHAPE, .name = "/objects/1/trajectory/time", .rank = 1, .shape = {5}, .expected = "position|length 4|should be 5"},
    {.kind = VALUE, .name = "/objects/1/trajectory/time", .rank = 1, .shape = {4}, .expected = "/objects/1/trajectory|equals"},
    {.kind = SHAPE,
     .name = "/objects/1/trajectory/time",
     .rank = 1,
     .shape = {0},
     .expected = "position of /objects/1/trajectory|should be 0"},
    {.kind = SHAPE, .name = "/objects/1/trajectory/position", .rank = 2, .shape = {3, 3}, .expected = "position|should be 4"},
    {.kind = VALUE, .name = "/objects/1/trajectory/quaternion", .rank = 2, .shape = {4, 4}, .expected = "quaternion is zero"},
};

static void test_refusals(void **state) {
    const char *path = scene_in_folder(*state, "s.h5");
    for (size_t i = 0; i < sizeof edits / sizeof edits[0]; i++) {
        td_gaussians g;
        scene_save_pair(path, &g);
        hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
        assert_true(file >= 0);
        apply(file, &edits[i]);
        H5Fclose(file);
        tides_error error = {0, ""};
        tides_scene *scene = scene_new();
        scene_add(scene, &g, NULL, 1, NULL);
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
    scene_save_pair(path, &g);
    size_t size;
    char *bytes = scene_file_read(path, &size);
    for (size_t kept = 8; kept < size; kept += kept < 256 ? 1 : 97) {
        scene_file_write(path, bytes, kept);
        tides_error error = {0, ""};
        tides_scene *scene = scene_new();
        scene_expect_error(tides_scene_add_file(scene, path, NULL, 1, &error), TIDES_BAD_FILE, &error, "s.h5|HDF5|truncated");
        tides_scene_destroy(scene);
    }
    free(bytes);
    td_gaussians_free(&g);
}

int main(void) {
#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_setup, scene_folder_teardown)
    const struct CMUnitTest tests[] = {
        IN_FOLDER(test_other_writers),
        IN_FOLDER(test_refusals),
        IN_FOLDER(test_truncations),
    };
    return cmocka_run_group_tests_name("scene_hdf5_edited", tests, NULL, NULL);
}
