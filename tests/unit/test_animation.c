/* Animations: pictures read back from animated PNGs, video and numbered files; rates; failures, and the files that they
 * leave. */
#include "test_events_folder.h"

#include <fcntl.h>
#include <math.h>
#include <png.h>
#include <zlib.h>

#include "tides/image.h"

enum { WIDTH = 23, HEIGHT = 17, BYTES = 3 * WIDTH * HEIGHT, PICTURES = 3 };

static void fill_random(uint64_t seed, uint8_t rgb[BYTES]) {
    for (int i = 0; i < BYTES; i++) rgb[i] = (uint8_t)scene_next(&seed);
}

static tides_animation *open_animation(const char *path, double rate) {
    tides_animation *animation = NULL;
    tides_error error;
    if (tides_animation_open(path, WIDTH, HEIGHT, rate, &animation, &error) != TIDES_OK) fail_msg("%s", error.text);
    return animation;
}

static void write_animation(const char *path, double rate) {
    tides_animation *animation = open_animation(path, rate);
    tides_error error;
    for (uint64_t i = 0; i < PICTURES; i++) {
        uint8_t rgb[BYTES];
        fill_random(i, rgb);
        if (tides_animation_append(animation, rgb, &error) != TIDES_OK) fail_msg("%s", error.text);
    }
    if (tides_animation_finish(animation, &error) != TIDES_OK) fail_msg("%s", error.text);
}

static uint32_t read_32(const uint8_t *at) {
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

static void check_bytes(const void *png, size_t size, uint64_t seed) {
    png_image image = {.version = PNG_IMAGE_VERSION};
    uint8_t got[BYTES], expected[BYTES];
    if (!png_image_begin_read_from_memory(&image, png, size)) fail_msg("%s", image.message);
    assert_int_equal(image.width, WIDTH);
    assert_int_equal(image.height, HEIGHT);
    image.format = PNG_FORMAT_RGB;
    if (!png_image_finish_read(&image, NULL, got, 0, NULL)) fail_msg("%s", image.message);
    fill_random(seed, expected);
    assert_memory_equal(got, expected, BYTES);
}

/* ---- animated PNG ---- */

/* A picture put together again: the file's opening, one chunk of data, the end. */
typedef struct single {
    uint8_t bytes[8192];
    size_t size;
} single;

static void add(single *s, const uint8_t *bytes, size_t size) {
    assert_true(s->size + size <= sizeof s->bytes);
    memcpy(s->bytes + s->size, bytes, size);
    s->size += size;
}

static void add_chunk(single *s, const char *type, const uint8_t *data, size_t size) {
    uint8_t head[8] =
        {0, 0, (uint8_t)(size >> 8), (uint8_t)size, (uint8_t)type[0], (uint8_t)type[1], (uint8_t)type[2], (uint8_t)type[3]};
    uint8_t tail[4];
    uLong crc = crc32(crc32(0, NULL, 0), head + 4, 4);
    if (size) crc = crc32(crc, data, (uInt)size);
    for (int i = 0; i < 4; i++) tail[i] = (uint8_t)(crc >> (24 - 8 * i));
    add(s, head, 8);
    if (size) add(s, data, size);
    add(s, tail, 4);
}

typedef struct chunks {
    uint32_t sequence, frames, pictures_seen, delay[2];
    single picture[PICTURES];
} chunks;

static void take_chunk(chunks *c, const uint8_t *file, const uint8_t *chunk, size_t size) {
    const uint8_t *data = chunk + 8;
    const uLong crc = crc32(crc32(0, NULL, 0), chunk + 4, (uInt)size + 4);
    assert_int_equal(read_32(data + size), crc);
    if (memcmp(chunk + 4, "acTL", 4) == 0) c->frames = read_32(data);
    if (memcmp(chunk + 4, "fcTL", 4) == 0) {
        assert_int_equal(read_32(data), c->sequence++);
        assert_int_equal(read_32(data + 4), WIDTH);
        assert_int_equal(read_32(data + 8), HEIGHT);
        c->delay[0] = (uint32_t)data[20] << 8 | data[21];
        c->delay[1] = (uint32_t)data[22] << 8 | data[23];
        add(&c->picture[c->pictures_seen++], file, 33); /* signature and IHDR */
    }
    if (memcmp(chunk + 4, "IDAT", 4) == 0) assert_int_equal(c->pictures_seen, 1);
    if (memcmp(chunk + 4, "IDAT", 4) == 0) add_chunk(&c->picture[0], "IDAT", data, size);
    if (memcmp(chunk + 4, "fdAT", 4) != 0) return;
    assert_int_equal(read_32(data), c->sequence++);
    add_chunk(&c->picture[c->pictures_seen - 1], "IDAT", data + 4, size - 4);
}

static void read_chunks(const char *path, chunks *c) {
    size_t size;
    uint8_t *file = (uint8_t *)slurp(path, &size);
    memset(c, 0, sizeof *c);
    for (size_t at = 8; at + 12 <= size; at += read_32(file + at) + 12) take_chunk(c, file, file + at, read_32(file + at));
    for (uint32_t i = 0; i < c->pictures_seen; i++) add_chunk(&c->picture[i], "IEND", NULL, 0);
    free(file);
}

static void animated_png(void **state) {
    const char *const names[] = {"a.png", "a.apng"};
    static chunks c;
    for (int n = 0; n < 2; n++) {
        const char *path = in_folder(*state, names[n]);
        size_t size;
        write_animation(path, 25);
        read_chunks(path, &c);
        assert_int_equal(c.frames, PICTURES);
        assert_int_equal(c.pictures_seen, PICTURES);
        assert_int_equal(c.sequence, 2 * PICTURES - 1);
        for (uint32_t i = 0; i < PICTURES; i++) check_bytes(c.picture[i].bytes, c.picture[i].size, i);
        char *whole = slurp(path, &size); /* and readers that know no animations see the first */
        check_bytes(whole, size, 0);
        free(whole);
    }
}

static void rates(void **state) {
    const double rate[] = {25, 29.97, 0.5, 1000, 119.88, 0.02};
    const uint32_t delay[][2] = {{1, 25}, {100, 2997}, {2, 1}, {1, 1000}, {25, 2997}, {50, 1}};
    static chunks c;
    for (size_t i = 0; i < sizeof rate / sizeof *rate; i++) {
        const char *path = in_folder(*state, "rate.png");
        write_animation(path, rate[i]);
        read_chunks(path, &c);
        assert_int_equal(c.delay[0], delay[i][0]);
        assert_int_equal(c.delay[1], delay[i][1]);
    }
}

/* ---- video and numbered pictures ---- */

/* The primaries of BT.601 in studio range (ITU-R BT.601-7, 2.5). */
static void video_colours(void **state) {
    const uint8_t rgb[] = {0, 0, 0, 255, 255, 255, 255, 0, 0, 0, 255, 0, 0, 0, 255};
    const uint8_t planes[] = {16, 235, 81, 145, 41, 128, 128, 90, 54, 240, 128, 128, 240, 34, 110};
    const char head[] = "YUV4MPEG2 W5 H1 F25:1 Ip A1:1 C444 XCOLORRANGE=LIMITED\nFRAME\n";
    const char *path = in_folder(*state, "a.y4m");
    tides_animation *animation = NULL;
    size_t size;
    assert_int_equal(tides_animation_open(path, 5, 1, 25, &animation, NULL), TIDES_OK);
    assert_int_equal(tides_animation_append(animation, rgb, NULL), TIDES_OK);
    assert_int_equal(tides_animation_append(animation, rgb, NULL), TIDES_OK);
    assert_int_equal(tides_animation_finish(animation, NULL), TIDES_OK);
    char *file = slurp(path, &size);
    assert_int_equal(size, sizeof head - 1 + sizeof planes + 6 + sizeof planes);
    assert_memory_equal(file, head, sizeof head - 1);
    assert_memory_equal(file + sizeof head - 1, planes, sizeof planes);
    assert_memory_equal(file + size - sizeof planes, planes, sizeof planes);
    free(file);
}

static void video_stream(void **state) {
    char path[640];
    size_t size[2];
    snprintf(path, sizeof path, "%s", in_folder(*state, "file.y4m"));
    write_animation(path, 10);
    char *expected = slurp(path, &size[0]);
    const int descriptor = open(in_folder(*state, "stream"), O_RDWR | O_CREAT, 0600);
    tides_animation *animation = NULL;
    assert_true(descriptor >= 0);
    assert_int_equal(tides_animation_stream(descriptor, WIDTH, HEIGHT, 10, &animation, NULL), TIDES_OK);
    for (uint64_t i = 0; i < PICTURES; i++) {
        uint8_t rgb[BYTES];
        fill_random(i, rgb);
        assert_int_equal(tides_animation_append(animation, rgb, NULL), TIDES_OK);
    }
    assert_int_equal(tides_animation_finish(animation, NULL), TIDES_OK);
    assert_int_equal(write(descriptor, "x", 1), 1); /* still open */
    close(descriptor);
    char *got = slurp(in_folder(*state, "stream"), &size[1]);
    assert_int_equal(size[1], size[0] + 1);
    assert_memory_equal(got, expected, size[0]);
    free(got);
    free(expected);
}

static void numbered(void **state) {
    char name[32];
    write_animation(in_folder(*state, "p%03d.png"), 25);
    write_animation(in_folder(*state, "q%d-end.png"), 25);
    for (int i = 0; i < PICTURES; i++)
        for (int style = 0; style < 2; style++) {
            size_t size;
            snprintf(name, sizeof name, style ? "q%d-end.png" : "p%03d.png", i);
            char *file = slurp(in_folder(*state, name), &size);
            check_bytes(file, size, (uint64_t)i);
            free(file);
        }
    assert_false(file_exists(in_folder(*state, "p003.png")));
}

/* ---- what goes wrong ---- */

static void refused(void **state) {
    tides_animation *animation = NULL;
    tides_error error;
    const char *const bad[] = {"a.gif", "a.%d", "a.mp4", ".png"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(tides_animation_open(bad[i], 2, 2, 25, &animation, &error), TIDES_UNSUPPORTED);
        assert_non_null(strstr(error.text, ".y4m"));
        assert_null(animation);
    }
    const char *path = in_folder(*state, "a.png");
    assert_int_equal(tides_animation_open(path, 0, 2, 25, &animation, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_animation_open(path, 2, 70000, 25, &animation, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_animation_open(path, 2, 2, 0.001, &animation, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_animation_open(path, 2, 2, NAN, &animation, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_animation_open(NULL, 2, 2, 25, &animation, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_animation_stream(-1, 2, 2, 25, &animation, &error), TIDES_WRITE_FAILED);
    assert_int_equal(tides_animation_append(NULL, NULL, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_animation_finish(NULL, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_animation_finish(open_animation(path, 25), &error), TIDES_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "needs a picture"));
    tides_animation_abandon(open_animation(path, 25));
    tides_animation_abandon(NULL);
    assert_false(file_exists(path));
    assert_false(file_exists(in_folder(*state, "a.png.part")));
    assert_int_equal(tides_animation_open(in_folder(*state, "missing/a.png"), 2, 2, 25, &animation, &error),
                     TIDES_WRITE_FAILED);
}

static void write_limited(void *result, void *user) {
    tides_animation *animation = open_animation(user, 25);
    uint8_t rgb[BYTES];
    tides_status status = TIDES_OK;
    for (uint64_t i = 0; i < 20 && status == TIDES_OK; i++) {
        fill_random(i, rgb);
        status = tides_animation_append(animation, rgb, NULL);
    }
    if (status != TIDES_OK)
        tides_animation_abandon(animation);
    else
        status = tides_animation_finish(animation, NULL);
    *(int32_t *)result = status;
}

static void full_disk(void **state) {
    const char *const names[] = {"a.png", "a.y4m"};
    for (int n = 0; n < 2; n++) {
        char path[640], part[700];
        int32_t status = TIDES_OK;
        snprintf(path, sizeof path, "%s", in_folder(*state, names[n]));
        snprintf(part, sizeof part, "%s.part", path);
        put_text(path, "precious");
        const rlim_t limits[] = {0, 10, 5000, 20000};
        for (size_t l = 0; l < sizeof limits / sizeof *limits; l++) {
            run_limited(limits[l], write_limited, &status, sizeof status, path);
            assert_int_equal(status, TIDES_WRITE_FAILED);
            check_text(path, "precious");
            assert_false(file_exists(part));
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(animated_png, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(rates, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(video_colours, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(video_stream, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(numbered, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(refused, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(full_disk, folder_setup, folder_teardown),
    };
    return cmocka_run_group_tests_name("image: animations", tests, NULL, NULL);
}
