/* Devices: listing, opening by SPEC, error messages, the table of built programs, and a machine without OpenCL (this program
 * again, as a child whose OpenCL loader finds no driver). */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "td_advice.h"
#include "td_device.h"
#include "td_wide.h"
#include "tides/render.h"
#include "tests/support/random_scene.h"
#include "tests/support/scene_folder.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { ROWS = 64 };
static const char without_opencl[] = "--without-opencl"; /* argument of the child */

static int32_t list(tides_device_info *rows) {
    int32_t count = -1;
    tides_error error;
    scene_expect_ok(tides_device_list(rows, ROWS, &count, &error), &error);
    assert_in_range(count, 0, ROWS);
    return count;
}

/* 1 if Linux says that the processor has `flag`. */
static int has_flag(const char *flag) {
    static char text[65536];
    char word[32];
    FILE *file = fopen("/proc/cpuinfo", "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    assert_int_equal(fclose(file), 0);
    snprintf(word, sizeof word, " %s ", flag);
    return strstr(text, word) != NULL;
}

/* Bits of the processor's widest vectors. */
static int32_t processor_bits(void) {
#if defined(__x86_64__)
    return has_flag("avx512f") ? 512 : has_flag("avx2") ? 256 : 128;
#elif defined(__aarch64__)
    return has_flag("sve") ? 2048 : 128; /* NEON's; SVE's are up to 2048 */
#else
    return 64; /* a double's */
#endif
}

/* The first device of the machine; skips the test where there's none. */
static tides_device_info first_device(void) {
    tides_device_info rows[ROWS];
    if (list(rows) == 0) {
        print_message("skipped: this machine has no OpenCL device\n");
        skip();
    }
    return rows[0];
}

static tides_device *open_device(const char *spec) {
    tides_device *device = NULL;
    tides_error error;
    scene_expect_ok(tides_device_open(spec, &device, &error), &error);
    return device;
}

static void expect_open(const char *spec, const char *name) {
    tides_device *device = open_device(spec);
    tides_device_info info;
    tides_device_describe(device, &info);
    assert_string_equal(info.name, name);
    tides_device_close(device);
}

static void expect_no_open(const char *spec, tides_status wanted, const char *words) {
    tides_device *untouched = (tides_device *)&wanted, *device = untouched;
    tides_error error;
    scene_expect_error(tides_device_open(spec, &device, &error), wanted, &error, words);
    assert_ptr_equal(device, untouched);
    assert_int_equal(tides_device_open(spec, &device, NULL), wanted); /* error is nullable */
}

/* -- with or without OpenCL ---------------------------------------------------------------------------------------- */

static void test_list_is_consistent(void **state) {
    (void)state;
    tides_device_info rows[ROWS];
    int32_t count = list(rows), only_count = -1;
    assert_int_equal(tides_device_list(NULL, 0, &only_count, NULL), TIDES_OK);
    assert_int_equal(only_count, count);
    for (int32_t i = 0; i < count; i++) {
        assert_int_equal(rows[i].index, i);
        assert_true(rows[i].name[0] && rows[i].platform[0] && rows[i].driver[0]);
        assert_in_range(rows[i].kind, TIDES_DEVICE_CPU, TIDES_DEVICE_OTHER);
        assert_true(rows[i].lanes == 1 || rows[i].lanes == 4 || rows[i].lanes == 8 || rows[i].lanes == 16);
        assert_true(rows[i].compute_units > 0);
        assert_true(rows[i].fused || strcmp(rows[i].platform, "rusticl") == 0);
        assert_true(rows[i].memory_bytes > 0);
        if (rows[i].kind != TIDES_DEVICE_CPU) continue;
        /* Narrower than the processor's where the driver doesn't know it (PoCL 3.1 then says 32), and never wider. */
        assert_in_range(rows[i].vector_bits, 32, processor_bits());
        assert_int_equal(rows[i].vector_bits % 32, 0);
    }
}

/* No more than `capacity` rows are written. */
static void test_list_keeps_to_its_capacity(void **state) {
    (void)state;
    tides_device_info rows[2], guard;
    int32_t count = 0;
    memset(rows, 0x5a, sizeof rows);
    memset(&guard, 0x5a, sizeof guard);
    assert_int_equal(tides_device_list(rows, 1, &count, NULL), TIDES_OK);
    assert_memory_equal(&rows[1], &guard, sizeof guard);
}

static void test_bad_arguments(void **state) {
    (void)state;
    tides_device_info row;
    tides_error error;
    int32_t count;
    scene_expect_error(tides_device_list(&row, 1, NULL, &error), TIDES_BAD_ARGUMENT, &error, "tides_device_list|count");
    scene_expect_error(tides_device_list(NULL, 1, &count, &error), TIDES_BAD_ARGUMENT, &error, "rows");
    scene_expect_error(tides_device_list(&row, -1, &count, &error), TIDES_BAD_ARGUMENT, &error, "capacity");
    scene_expect_error(tides_device_open("reference", NULL, &error), TIDES_BAD_ARGUMENT, &error, "tides_device_open|device");
    tides_device_close(NULL);
}

static void test_references_need_no_opencl(void **state) {
    (void)state;
    static const char *const specs[] = {"reference", "reference-f32"};
    for (int i = 0; i < 2; i++) {
        tides_device *device = open_device(specs[i]);
        tides_device_info info;
        tides_device_describe(device, &info);
        assert_string_equal(info.name, specs[i]);
        assert_int_equal(info.kind, TIDES_DEVICE_REFERENCE);
        assert_int_equal(info.index, -1);
        assert_int_equal(info.fused, 1);
        assert_int_equal(info.vector_bits, TD_WIDE_CLONES || processor_bits() < 128 ? processor_bits() : 128);
        tides_device_close(device);
    }
}

static void test_environment_is_the_default(void **state) {
    (void)state;
    setenv("TIDES_DEVICE", "reference-f32", 1);
    expect_open(NULL, "reference-f32");
    expect_open("", "reference-f32");
    expect_open("reference", "reference"); /* a given SPEC wins */
    setenv("TIDES_DEVICE", "no-such-device", 1);
    expect_no_open(NULL, TIDES_NO_DEVICE, "no-such-device");
    unsetenv("TIDES_DEVICE");
}

/* -- with OpenCL --------------------------------------------------------------------------------------------------- */

static void test_opening_by_index_kind_and_name(void **state) {
    (void)state;
    tides_device_info rows[ROWS];
    first_device();
    int32_t count = list(rows);
    for (int32_t i = count - 1; i >= 0; i--) { /* downwards: where names repeat the first is meant */
        char spec[64];
        snprintf(spec, sizeof spec, "%d", (int)i);
        expect_open(spec, rows[i].name);
    }
    char name[128];
    for (size_t k = 0; k < sizeof name; k++) name[k] = (char)toupper((unsigned char)rows[0].name[k]);
    expect_open(name, rows[0].name);
    expect_open(rows[0].platform, rows[0].name);
    for (int32_t kind = TIDES_DEVICE_CPU; kind <= TIDES_DEVICE_GPU; kind++) {
        const char *spec = kind == TIDES_DEVICE_CPU ? "cpu" : "gpu";
        int32_t at = 0;
        while (at < count && rows[at].kind != kind) at++;
        if (at < count)
            expect_open(spec, rows[at].name);
        else
            expect_no_open(spec, TIDES_NO_DEVICE, spec);
    }
}

static void test_errors_list_what_there_is(void **state) {
    (void)state;
    tides_device_info row = first_device();
    static const char *const wrong[] = {"no-such-device", "99", "-1", "0x"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        char words[300];
        snprintf(words, sizeof words, "%s|0 = |%.50s|%.30s|reference", wrong[i], row.name, row.platform);
        expect_no_open(wrong[i], TIDES_NO_DEVICE, words);
    }
}

static void test_errors_name_the_kernel(void **state) {
    (void)state;
    first_device();
    tides_device *device = open_device("0");
    cl_kernel untouched = (cl_kernel)(void *)&device, kernel = untouched;
    tides_error error;
    scene_expect_error(td_kernel_create(device, "nothing.cl", "", "f", &kernel, &error), TIDES_DEVICE_FAILED, &error,
                       "nothing.cl");
    scene_expect_error(td_kernel_create(device, "layout_check.cl", "", "td_no_such_kernel", &kernel, &error),
                       TIDES_DEVICE_FAILED, &error, "clCreateKernel|CL_INVALID_KERNEL_NAME");
    assert_ptr_equal(kernel, untouched);
    tides_device_close(device);
    assert_string_equal(td_cl_name(CL_OUT_OF_RESOURCES), "CL_OUT_OF_RESOURCES");
    assert_string_equal(td_cl_name(-9999), "unknown OpenCL error");
}

/* Same file and defines: the same program, not built twice. */
static void test_programs_are_built_once(void **state) {
    (void)state;
    static const char *const defines[] = {"", "#define TD_ANYTHING 1\n", ""};
    first_device();
    tides_device *device = open_device("0");
    cl_program program[3];
    for (int i = 0; i < 3; i++) {
        cl_kernel kernel;
        tides_error error;
        scene_expect_ok(td_kernel_create(device, "layout_check.cl", defines[i], "td_layout_check", &kernel, &error), &error);
        assert_int_equal(clGetKernelInfo(kernel, CL_KERNEL_PROGRAM, sizeof *program, &program[i], NULL), CL_SUCCESS);
        clReleaseKernel(kernel);
    }
    assert_ptr_equal(program[0], program[2]);
    assert_ptr_not_equal(program[0], program[1]);
    tides_device_close(device);
}

/* The kernel f of `text` in a folder of kernels whose builtins.h is `builtins`, where that is given. */
static tides_status build_text(tides_device *device, const char *text, const char *builtins, tides_error *error) {
    void *folder = NULL;
    cl_kernel kernel = NULL;
    assert_int_equal(scene_folder_setup(&folder), 0);
    scene_file_write(scene_in_folder(folder, "f.cl"), text, strlen(text));
    if (builtins) scene_file_write(scene_in_folder(folder, "builtins.h"), builtins, strlen(builtins));
    setenv("TIDES_KERNEL_DIR", folder, 1);
    const tides_status status = td_kernel_create(device, "f.cl", "", "f", &kernel, error);
    unsetenv("TIDES_KERNEL_DIR");
    if (kernel) clReleaseKernel(kernel);
    assert_int_equal(scene_folder_teardown(&folder), 0);
    return status;
}

/* PoCL's programs declare what they call. What they can't, the driver does, and errors are those of the driver's. */
static void test_functions_that_nobody_declares(void **state) {
    (void)state;
    static const char with_hypot[] = "__kernel void f(__global float *x) { x[0] = hypot(x[0], x[1]); }\n";
    static const char with_nothing[] = "__kernel void f(__global float *x) { x[0] = 1.0f; }\n";
    static const char *const builtins[] = {"", "float __attribute__((overloadable)) hypot(float);\n", "no C\n", NULL};
    const int is_pocl = strcmp(first_device().platform, "Portable Computing Language") == 0;
    for (size_t i = 0; i < sizeof builtins / sizeof *builtins; i++) {
        tides_device *device = open_device("0");
        tides_error error;
        assert_int_equal(device->own_builtins, is_pocl);
        scene_expect_ok(build_text(device, with_hypot, builtins[i], &error), &error);
        assert_int_equal(device->own_builtins, 0);
        tides_device_close(device);
    }
    tides_device *device = open_device("0");
    tides_error error;
    scene_expect_ok(build_text(device, with_nothing, "", &error), &error);
    assert_int_equal(device->own_builtins, is_pocl);
    tides_device_close(device);
    device = open_device("0");
    static const char wrong[] = "__kernel void f(void) { no_function(); }\n";
    scene_expect_error(build_text(device, wrong, "", &error), TIDES_DEVICE_FAILED, &error, "f.cl|no_function");
    assert_null(strstr(error.text, "builtins.h")); /* the same, and said once */
    scene_expect_error(build_text(device, wrong, "no C\n", &error), TIDES_DEVICE_FAILED, &error,
                       is_pocl ? "f.cl|no_function|before that|builtins.h:1" : "f.cl|no_function");
    assert_int_equal(device->own_builtins, is_pocl); /* it isn't these */
    tides_device_close(device);
}

/* What is advised on a system whose os-release holds `text`. */
static void expect_advice(const char *text, const char *wanted) {
    char name[] = "/tmp/tides-os-release-XXXXXX";
    int handle = mkstemp(name);
    assert_true(handle >= 0 && write(handle, text, strlen(text)) == (ssize_t)strlen(text));
    close(handle);
    assert_string_equal(td_device_advice(name), wanted);
    remove(name);
}

static void test_advice_is_the_systems(void **state) {
    (void)state;
    expect_advice("PRETTY_NAME=\"arch\"\nID=debian\n", "apt install pocl-opencl-icd");
    expect_advice("ID=linuxmint\nID_LIKE=\"ubuntu debian\"\n", "apt install pocl-opencl-icd");
    expect_advice("ID=\"rocky\"\nID_LIKE=\"rhel centos fedora\"\n", "dnf install pocl");
    expect_advice("ID=opensuse-leap\nID_LIKE='suse opensuse'\n", "zypper install pocl");
    expect_advice("NAME=Arch\nID=arch", "pacman -S pocl");
    expect_advice("ID=archetype\n", "PoCL, or your GPU's driver");
    assert_string_equal(td_device_advice("/nowhere/os-release"), "PoCL, or your GPU's driver");
}

/* -- without OpenCL ------------------------------------------------------------------------------------------------ */

static void test_no_platform_is_an_empty_list(void **state) {
    (void)state;
    tides_device_info rows[ROWS];
    assert_int_equal(list(rows), 0);
}

static void test_no_platform_says_what_to_do(void **state) {
    (void)state;
    static const char *const specs[] = {"auto", "cpu", "gpu", "0", "pocl"};
    for (size_t i = 0; i < sizeof specs / sizeof *specs; i++) {
        char words[100];
        snprintf(words, sizeof words, "%s|no OpenCL device|%s|reference", specs[i], td_device_advice(TD_OS_RELEASE));
        expect_no_open(specs[i], TIDES_NO_DEVICE, words);
    }
    expect_no_open(NULL, TIDES_NO_DEVICE, "auto|no OpenCL device");
    expect_no_open("referense", TIDES_NO_DEVICE, "did you mean reference?");
    tides_device *device = NULL;
    tides_error error;
    assert_int_equal(tides_device_open("auto", &device, &error), TIDES_NO_DEVICE);
    assert_null(strstr(error.text, "did you mean"));
}

static void test_reference_renders_without_opencl(void **state) {
    (void)state;
    random_recipe recipe = random_recipe_defaults(5);
    random_scene scene = random_scene_make(&recipe);
    tides_device *device = open_device("reference");
    tides_image_params params;
    tides_renderer *renderer = NULL;
    tides_error error;
    size_t pixels = (size_t)recipe.width * (size_t)recipe.height, lit = 0;
    tides_frame frame = {{NULL}};
    double *luminance = frame.plane[TIDES_Y] = calloc(pixels, sizeof *luminance);
    assert_non_null(luminance);
    tides_image_params_defaults(&params);
    scene_expect_ok(tides_renderer_create(device, scene.scene, &scene.camera, &params, NULL, NULL, &renderer, &error), &error);
    scene_expect_ok(tides_renderer_frame(renderer, scene.path, 0.5, &frame, &error), &error);
    for (size_t i = 0; i < pixels; i++) lit += luminance[i] > 0.01;
    assert_true(lit > pixels / 10);
    free(luminance);
    tides_renderer_destroy(renderer);
    tides_device_close(device);
    random_scene_free(&scene);
}

static int run_without_opencl(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_no_platform_is_an_empty_list),
                                       cmocka_unit_test(test_no_platform_says_what_to_do),
                                       cmocka_unit_test(test_list_is_consistent),
                                       cmocka_unit_test(test_references_need_no_opencl),
                                       cmocka_unit_test(test_reference_renders_without_opencl),
                                       cmocka_unit_test(test_environment_is_the_default)};
    return cmocka_run_group_tests_name("without OpenCL", tests, NULL, NULL);
}

/* The child's group, for an empty folder of drivers; the loaders of both Khronos and ocl-icd read this variable. */
static void test_machine_without_opencl(void **state) {
    char *program = *state;
    void *folder = NULL;
    int result = -1;
    assert_int_equal(scene_folder_setup(&folder), 0);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        char *arguments[] = {program, (char *)(uintptr_t)without_opencl, NULL};
        setenv("OCL_ICD_VENDORS", folder, 1);
        unsetenv("OCL_ICD_FILENAMES");
        execv(program, arguments);
        _exit(127);
    }
    assert_true(waitpid(child, &result, 0) == child);
    assert_int_equal(scene_folder_teardown(&folder), 0);
    assert_true(WIFEXITED(result));
    assert_int_equal(WEXITSTATUS(result), 0);
}

int main(int argc, char **argv) {
    unsetenv("TIDES_DEVICE");
    unsetenv("TIDES_KERNEL_DIR");
    if (argc > 1 && strcmp(argv[1], without_opencl) == 0) return run_without_opencl();
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_list_is_consistent),
                                       cmocka_unit_test(test_list_keeps_to_its_capacity),
                                       cmocka_unit_test(test_bad_arguments),
                                       cmocka_unit_test(test_references_need_no_opencl),
                                       cmocka_unit_test(test_environment_is_the_default),
                                       cmocka_unit_test(test_opening_by_index_kind_and_name),
                                       cmocka_unit_test(test_errors_list_what_there_is),
                                       cmocka_unit_test(test_errors_name_the_kernel),
                                       cmocka_unit_test(test_programs_are_built_once),
                                       cmocka_unit_test(test_functions_that_nobody_declares),
                                       cmocka_unit_test(test_advice_is_the_systems),
                                       cmocka_unit_test_prestate(test_machine_without_opencl, argv[0])};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
