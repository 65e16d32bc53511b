/* PNG files: the pixels come back, and a failure leaves things as they were. */
#include "test_events_folder.h"

#include <png.h>

#include "tides/image.h"

static uint8_t *random_picture(uint64_t seed, int32_t width, int32_t height) {
    size_t bytes = (size_t)width * (size_t)height * 3;
    uint8_t *rgb = malloc(bytes);
    assert_non_null(rgb);
    for (size_t i = 0; i < bytes; i++) rgb[i] = (uint8_t)scene_next(&seed);
    return rgb;
}

static void check_picture(const char *path, int32_t width, int32_t height, const uint8_t *rgb) {
    png_image image = {.version = PNG_IMAGE_VERSION};
    assert_true(png_image_begin_read_from_file(&image, path));
    assert_int_equal(image.width, width);
    assert_int_equal(image.height, height);
    assert_int_equal(image.format, PNG_FORMAT_RGB);
    uint8_t *read = malloc(PNG_IMAGE_SIZE(image));
    assert_non_null(read);
    assert_true(png_image_finish_read(&image, NULL, read, 0, NULL));
    assert_memory_equal(read, rgb, (size_t)width * (size_t)height * 3);
    free(read);
}

static void test_round_trip(void **state) {
    const int32_t sizes[][2] = {{1, 1}, {1, 300}, {300, 1}, {37, 21}, {346, 260}};
    const char *path = in_folder(*state, "picture.png");
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        uint8_t *rgb = random_picture(s, sizes[s][0], sizes[s][1]);
        tides_error error;
        if (tides_png_write(path, sizes[s][0], sizes[s][1], rgb, &error) != TIDES_OK) fail_msg("%s", error.text);
        check_picture(path, sizes[s][0], sizes[s][1], rgb);
        free(rgb);
    }
}

static void test_bad_arguments(void **state) {
    const char *path = in_folder(*state, "refused.png");
    const uint8_t rgb[3] = {0};
    tides_error error;
    assert_int_equal(tides_png_write(path, 0, 1, rgb, &error), TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "0 x 1"));
    assert_int_equal(tides_png_write(path, 1, -5, rgb, NULL), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_png_write(NULL, 1, 1, rgb, NULL), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_png_write(path, 1, 1, NULL, NULL), TIDES_BAD_ARGUMENT);
    assert_false(file_exists(path));
}

static void write_big(void *result, void *user) {
    uint8_t *rgb = random_picture(1, 300, 300); /* 270 kB that deflate can't shrink */
    tides_error error = {0};
    int32_t *seen = result;
    seen[0] = tides_png_write(user, 300, 300, rgb, &error);
    seen[1] = strstr(error.text, user) != NULL && !strchr(error.text, '\n');
    free(rgb);
}

static void test_unwritable(void **state) {
    folder *f = *state;
    const uint8_t rgb[3] = {1, 2, 3};
    tides_error error;
    assert_int_equal(tides_png_write(in_folder(f, "missing/a.png"), 1, 1, rgb, &error), TIDES_WRITE_FAILED);
    assert_non_null(strstr(error.text, "No such file"));
    char path[640], part[700];
    assert_int_equal(tides_png_write(f->path, 1, 1, rgb, &error), TIDES_WRITE_FAILED);
    assert_non_null(strstr(error.text, "is a folder"));
    snprintf(part, sizeof part, "%s.part", f->path);
    assert_false(file_exists(part));
    snprintf(path, sizeof path, "%s", in_folder(f, "full.png"));
    snprintf(part, sizeof part, "%s.part", path);
    put_text(path, "precious");
    const rlim_t limits[] = {0, 10, 5000, 100000, 269000};
    for (size_t l = 0; l < sizeof limits / sizeof *limits; l++) {
        int32_t seen[2] = {0};
        run_limited(limits[l], write_big, seen, sizeof seen, path);
        assert_int_equal(seen[0], TIDES_WRITE_FAILED);
        assert_true(seen[1]);
        check_text(path, "precious");
        assert_false(file_exists(part));
    }
    assert_int_equal(tides_png_write(path, 1, 1, rgb, NULL), TIDES_OK);
    check_picture(path, 1, 1, rgb);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_round_trip, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_bad_arguments, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_unwritable, folder_setup, folder_teardown),
    };
    return cmocka_run_group_tests_name("image: PNG", tests, NULL, NULL);
}
