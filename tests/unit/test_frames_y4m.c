/* YUV4MPEG2 videos of every sampling, depth and range give the light that was written, at the header's rate, from a file and
 * from a pipe; wrong ones are reported in one line. */
#include "test_events_folder.h"

#include <math.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "tides/frames.h"
#include "tides/image.h"

enum { WIDTH = 5, HEIGHT = 3, PIXELS = WIDTH * HEIGHT, ROOM = 4096 };

/* Of colours r, g, b, the same in all pixels of a frame: its samples, studio range or full. */
typedef struct sampling {
    const char *name;
    int across, down, grey, depth;
} sampling;
static const sampling samplings[] = {{"C420jpeg", 1, 1, 0, 8}, {"C420", 1, 1, 0, 8},     {"C422", 1, 0, 0, 8},
                                     {"C444", 0, 0, 0, 8},     {"C411", 2, 0, 0, 8},     {"Cmono", 0, 0, 1, 8},
                                     {"C420p10", 1, 1, 0, 10}, {"Cmono16", 0, 0, 1, 16}, {"C444p12", 0, 0, 0, 12},
                                     {"Ip", 1, 1, 0, 8} /* no C: 4:2:0 */};

static size_t put(unsigned char *to, size_t at, double value, int depth) {
    const unsigned whole = (unsigned)(value + 0.5);
    to[at++] = (unsigned char)(whole & 255);
    if (depth > 8) to[at++] = (unsigned char)(whole >> 8);
    return at;
}

static size_t add_frame(unsigned char *to, size_t at, const sampling *s, int full, const double rgb[3]) {
    const double unit = (double)(1 << (s->depth - 8)), top = (double)((1 << s->depth) - 1);
    const double y = 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2], blue = (rgb[2] - y) / 1.772, red = (rgb[0] - y) / 1.402;
    const double luma = full ? top * y : unit * (16 + 219 * y), steps = full ? top : 224 * unit;
    const int chroma = ((WIDTH + (1 << s->across) - 1) >> s->across) * ((HEIGHT + (1 << s->down) - 1) >> s->down);
    for (const char *c = "FRAME\n"; *c; c++) to[at++] = (unsigned char)*c;
    for (int i = 0; i < PIXELS; i++) at = put(to, at, luma, s->depth);
    for (int i = 0; i < chroma && !s->grey; i++) at = put(to, at, 128 * unit + steps * blue, s->depth);
    for (int i = 0; i < chroma && !s->grey; i++) at = put(to, at, 128 * unit + steps * red, s->depth);
    return at;
}

static const double colours[2][3] = {{0.8, 0.4, 0.2}, {0.1, 0.5, 0.9}}, greys[2][3] = {{0.3, 0.3, 0.3}, {0.7, 0.7, 0.7}};

static size_t make_video(unsigned char *to, const sampling *s, int full) {
    size_t at = (size_t)sprintf((char *)to, "YUV4MPEG2 W%d H%d F30000:1001 Ip A1:1 %s%s\n", WIDTH, HEIGHT, s->name,
                                full ? " XCOLORRANGE=FULL" : "");
    for (int k = 0; k < 2; k++) at = add_frame(to, at, s, full, s->grey ? greys[k] : colours[k]);
    return at;
}

static void write_bytes(const char *path, const void *bytes, size_t size) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static void check(const char *path, const sampling *s) {
    tides_frames_options options;
    tides_frames *frames = NULL;
    tides_error error = {TIDES_OK, ""};
    double Y[PIXELS];
    int32_t width, height;
    tides_frames_options_defaults(&options);
    if (tides_frames_open(path, &options, &frames, &error) != TIDES_OK) fail_msg("%s: %s", s->name, error.text);
    tides_frames_size(frames, &width, &height);
    assert_true(tides_frames_count(frames) == 2 && width == WIDTH && height == HEIGHT);
    assert_true(fabs(tides_frames_time(frames, 1) - 1001.0 / 30000) < 1e-6);
    for (size_t k = 2; k-- > 0;) { /* in any order */
        const double *c = s->grey ? greys[k] : colours[k], light = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
        assert_int_equal(tides_frames_read(frames, k, Y, &error), TIDES_OK);
        for (int i = 0; i < PIXELS; i++)
            if (fabs(Y[i] - light) > 1.5 / (1 << s->depth)) fail_msg("%s: pixel %d is %g, not %g", s->name, i, Y[i], light);
    }
    tides_frames_close(frames);
}

static void every_sampling(void **state) {
    unsigned char video[ROOM];
    for (size_t i = 0; i < sizeof samplings / sizeof *samplings; i++)
        for (int full = 0; full < 2; full++) {
            const size_t size = make_video(video, &samplings[i], full);
            write_bytes(in_folder(*state, "v.y4m"), video, size);
            check(in_folder(*state, "v.y4m"), &samplings[i]);
        }
}

/* What the library writes itself. */
static void our_own(void **state) {
    const sampling own = {"own", 0, 0, 0, 8};
    uint8_t rgb[PIXELS * 3];
    tides_animation *animation = NULL;
    tides_error error;
    assert_int_equal(tides_animation_open(in_folder(*state, "own.y4m"), WIDTH, HEIGHT, 30000 / 1001.0, &animation, &error),
                     TIDES_OK);
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < 3 * PIXELS; i++) rgb[i] = (uint8_t)(255 * colours[k][i % 3] + 0.5);
        assert_int_equal(tides_animation_append(animation, rgb, &error), TIDES_OK);
    }
    assert_int_equal(tides_animation_finish(animation, &error), TIDES_OK);
    check(in_folder(*state, "own.y4m"), &own);
}

static void from_a_pipe(void **state) {
    unsigned char video[ROOM];
    const size_t size = make_video(video, &samplings[0], 0);
    const char *path = in_folder(*state, "pipe");
    assert_int_equal(mkfifo(path, 0600), 0);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        FILE *to = fopen(path, "wb");
        const int whole = to && fwrite(video, 1, size, to) == size && fclose(to) == 0;
        _exit(!whole);
    }
    check(path, &samplings[0]);
    int ended;
    assert_int_equal(waitpid(child, &ended, 0), child);
    assert_int_equal(ended, 0);
}

static void refused(void **state, const char *bytes, size_t size, const char *words) {
    tides_frames_options options;
    tides_frames *frames = NULL;
    tides_error error = {TIDES_OK, ""};
    tides_frames_options_defaults(&options);
    write_bytes(in_folder(*state, "bad.y4m"), bytes, size);
    assert_int_equal(tides_frames_open(in_folder(*state, "bad.y4m"), &options, &frames, &error), TIDES_BAD_FILE);
    if (!strstr(error.text, words) || strchr(error.text, '\n')) fail_msg("'%s' instead of '%s'", error.text, words);
}

static void what_is_wrong_is_said(void **state) {
    static const char *const bad[][2] = {
        {"", "is empty"},
        {"RIFF....AVI", "begins otherwise"},
        {"YUV4MPEG2", "begins otherwise"}, /* and doesn't end */
        {"YUV4MPEG2X W5 H3 F1:1\nFRAME\n", "begins otherwise"},
        {"YUV4MPEG2 W5 H3\nFRAME\n", "no frame rate"},
        {"YUV4MPEG2 W5 F30:1\nFRAME\n", "no width or height"},
        {"YUV4MPEG2 W0 H3 F30:1\n", "'W0' in its header: its size"},
        {"YUV4MPEG2 W5x H3 F30:1\n", "'W5x'"},
        {"YUV4MPEG2 W99999 H3 F30:1\n", "from 1 to 16384"},
        {"YUV4MPEG2 W-5 H3 F30:1\n", "'W-5'"},
        {"YUV4MPEG2 W5 H3 F30:0\n", "'F30:0' in its header: its frame rate"},
        {"YUV4MPEG2 W5 H3 F30\n", "'F30'"},
        {"YUV4MPEG2 W5 H3 F30:1 It\n", "interlaced"},
        {"YUV4MPEG2 W5 H3 F30:1 C444alpha\n", "'C444alpha'"},
        {"YUV4MPEG2 W5 H3 F30:1 C420p17\n", "'C420p17'"},
        {"YUV4MPEG2 W5 H3 F30:1 C420p\n", "'C420p'"},
        {"YUV4MPEG2 W5 H3 F30:1\n", "no frame"},
        {"YUV4MPEG2 W5 H3 F30:1\nFRAME\nshort", "ends within frame 0"},
        {"YUV4MPEG2 W5 H3 F30:1\nFRAME", "ends within frame 0"},
        {"YUV4MPEG2 W5 H3 F30:1 Cmono\nFRAME\n0123456789abcdeFRAMED\n", "no frame where frame 1 should be"},
        {"YUV4MPEG2 W5 H3 F30:1 Cmono\nFRAME\n0123456789abcdeFRAME\n0123", "ends within frame 1"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) refused(state, bad[i][0], strlen(bad[i][0]), bad[i][1]);
    static const char begins[] = "YUV4MPEG2 W5 ";
    char line[3000];
    memset(line, 'X', sizeof line);
    for (size_t i = 0; i < strlen(begins); i++) line[i] = begins[i];
    line[sizeof line - 1] = '\n';
    refused(state, line, sizeof line, "begins otherwise");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(every_sampling, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(our_own, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(from_a_pipe, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(what_is_wrong_is_said, folder_setup, folder_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
