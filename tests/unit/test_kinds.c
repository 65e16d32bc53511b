/* Files that no reader takes: every reader names the kind, whatever its own guess at the bytes would be, and says what gets
 * further; of its own formats it says what it has to say itself. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "td_kinds.h"
#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"
#include "tides.h"

#include <sys/stat.h>

enum { BYTES = 600 };

/* The first bytes, and zeros behind them. */
static const char *make(void *folder, const char *name, const char *magic, size_t length, size_t at) {
    char bytes[BYTES] = {0};
    const char *path = scene_in_folder(folder, name);
    memcpy(bytes + at, magic, length);
    scene_file_write(path, bytes, sizeof bytes);
    return path;
}

/* -- the readers ----------------------------------------------------------------------------------------------------------- */

static tides_status as_scene(const char *path, tides_error *error) {
    tides_scene *scene = scene_new();
    tides_status status = tides_scene_add_file(scene, path, NULL, 1, error);
    tides_scene_destroy(scene);
    return status;
}

static tides_status as_events(const char *path, tides_error *error) {
    tides_event_reader *reader = NULL;
    tides_status status = tides_event_reader_open(path, NULL, &reader, error);
    tides_event_reader_close(reader);
    return status;
}

static tides_status as_poses(const char *path, tides_error *error) {
    tides_path found;
    tides_status status = tides_path_load(path, NULL, &found, error);
    if (status == TIDES_OK) tides_trajectory_destroy(found.trajectory);
    return status;
}

static tides_status as_frames(const char *path, tides_error *error) {
    tides_frames *frames = NULL;
    tides_frames_options options;
    tides_frames_options_defaults(&options);
    tides_status status = tides_frames_open(path, &options, &frames, error);
    tides_frames_close(frames);
    return status;
}

static tides_status as_run(const char *path, tides_error *error) {
    tides_run *run = NULL;
    tides_status status = tides_run_load(path, NULL, 0, &run, error);
    tides_run_destroy(run);
    return status;
}

static const struct {
    tides_status (*read)(const char *path, tides_error *error);
    const char *wish;
} readers[] = {{as_scene, "not a scene of splats"},
               {as_events, "not an event file"},
               {as_poses, "not a camera path"},
               {as_frames, "not frames"},
               {as_run, "not a run file"}};

/* -- the kinds ------------------------------------------------------------------------------------------------------------- */

#define BYTES_OF(text) text, sizeof text - 1

static void foreign(void **state) {
    static const struct {
        const char *name, *magic;
        size_t length, at;
        const char *kind, *further;
    } cases[] = {
        {"a.mp4", BYTES_OF("ftypisom"), 4, "an MP4 video", NULL},
        {"a.mov", BYTES_OF("ftypqt  "), 4, "a QuickTime video", NULL},
        {"a.mkv", BYTES_OF("\x1a\x45\xdf\xa3"), 0, "a Matroska or WebM video", NULL},
        {"a.avi",
         BYTES_OF("RIFF\x10\x00\x00\x00"
                  "AVI "),
         0, "an AVI video", NULL},
        {"a.jpg", BYTES_OF("\xff\xd8\xff\xe0"), 0, "a JPEG picture", NULL},
        {"a.tif", BYTES_OF("II*\0"), 0, "a TIFF picture", NULL},
        {"a.bag", BYTES_OF("#ROSBAG V2.0\n"), 0, "a ROS 1 bag", "python -m tides.bag"},
        {"a.mcap", BYTES_OF("\x89MCAP0\r\n"), 0, "an MCAP file, as ROS 2 bags are", "python -m tides.bag"},
        {"a.db3", BYTES_OF("SQLite format 3\0"), 0, "a ROS 2 bag", "python -m tides.bag"},
        {"a.zip", BYTES_OF("PK\3\4"), 0, "a ZIP archive", "unpack it"},
        {"a.usdz", BYTES_OF("PK\3\4"), 0, "an OpenUSD archive", "python -m tides.usd"},
        {"a.usdc", BYTES_OF("PXR-USDC"), 0, "an OpenUSD scene", "python -m tides.usd"},
        {"a.usda", BYTES_OF("#usda 1.0\n"), 0, "an OpenUSD scene", "python -m tides.usd"},
        {"a.7z", BYTES_OF("7z\xbc\xaf\x27\x1c"), 0, "a 7-Zip archive", "unpack it"},
        {"a.tar", BYTES_OF("ustar"), 257, "a tar archive", "unpack it"},
        {"a.zst", BYTES_OF("\x28\xb5\x2f\xfd"), 0, "a zstd file", "unpack it"},
        {"a.blend", BYTES_OF("BLENDER-v402"), 0, "a Blender file", NULL},
        {"a.fbx", BYTES_OF("Kaydara FBX Binary"), 0, "an FBX file", NULL},
        {"a.obj", BYTES_OF("v 0 0 0\n"), 0, "a Wavefront file", NULL},
        {"a.las", BYTES_OF("LASF"), 0, "a LAS point cloud", "points"},
        {"a.mat", BYTES_OF("MATLAB 5.0 MAT-file"), 0, "a MATLAB file", "scipy.io.loadmat"},
        {"a.parquet", BYTES_OF("PAR1"), 0, "a Parquet table", "pandas"},
        {"a.pkl", BYTES_OF("\x80\x04\x95"), 0, "a Python pickle", "numpy.save"},
        {"login.ply", BYTES_OF("<!DOCTYPE html><html>"), 0, "a web page", "another address"},
        {"lfs.ply", BYTES_OF("version https://git-lfs.github.com/spec/v1\n"), 0, "a pointer of Git LFS", "git lfs pull"},
        {"a.pdf", BYTES_OF("%PDF-1.7"), 0, "a PDF document", NULL},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const char *path = make(*state, cases[i].name, cases[i].magic, cases[i].length, cases[i].at);
        tides_error error = {TIDES_OK, ""};
        char words[200];
        for (size_t k = 0; k < sizeof readers / sizeof readers[0]; k++) {
            snprintf(words, sizeof words, "%s: is %s|%s: %s%s", cases[i].name, cases[i].kind, readers[k].wish,
                     cases[i].further ? "|" : "", cases[i].further ? cases[i].further : "");
            /* LFS's pointer stands in a scene's place, which a run of it then says. */
            if (readers[k].read == as_run && strcmp(cases[i].name, "lfs.ply") == 0) continue;
            scene_expect_error(readers[k].read(path, &error), TIDES_BAD_FILE, &error, words);
        }
        scene_expect_error(tides_file_foreign(path, &error), TIDES_BAD_FILE, &error, cases[i].kind);
    }
}

/* What gets further with a video: the path in the line. */
static void pipes(void **state) {
    tides_error error;
    const char *path = make(*state, "a.mp4", BYTES_OF("ftypisom"), 4);
    char line[300];
    snprintf(line, sizeof line, "ffmpeg -i %s -f yuv4mpegpipe - | tides simulate - -o events.h5", path);
    assert_int_equal(as_frames(path, &error), TIDES_BAD_FILE);
    assert_non_null(strstr(error.text, line));
    assert_int_equal(as_run(path, &error), TIDES_BAD_FILE);
    assert_non_null(strstr(error.text, line));
}

/* A reader's own kinds keep its own words. */
static void own(void **state) {
    tides_error error = {TIDES_OK, ""};
    const char *npy = make(*state, "a.npy", BYTES_OF("\x93NUMPY\1\0"), 0),
               *h5 = make(*state, "a.h5", BYTES_OF("\x89HDF\r\n\x1a\n"), 0);
    assert_int_equal(td_kind_refuse(npy, TD_WANTS_FRAMES, &error), TIDES_OK);
    assert_int_equal(td_kind_refuse(npy, TD_WANTS_EVENTS, &error), TIDES_OK);
    assert_int_equal(td_kind_refuse(h5, TD_WANTS_SCENE, &error), TIDES_OK);
    assert_int_equal(tides_file_foreign(h5, &error), TIDES_OK);
    assert_int_equal(tides_file_foreign(scene_in_folder(*state, "gone"), &error), TIDES_OK);
    assert_int_equal(tides_file_foreign(*state, &error), TIDES_OK);
    scene_expect_error(td_kind_refuse(h5, TD_WANTS_RUN, &error), TIDES_BAD_FILE, &error, "an HDF5 file|--set scene.file=");
    scene_expect_error(td_kind_refuse(npy, TD_WANTS_SCENE, &error), TIDES_BAD_FILE, &error, "a numpy array|tides.Scene");
}

/* AEDAT 4 holds events and frames; its name alone makes no recording. */
static void aedat_4(void **state) {
    tides_error error = {TIDES_OK, ""};
    const char *aedat4 = make(*state, "a.aedat4", BYTES_OF("#!AER-DAT4.0\r\n"), 0);
    assert_int_equal(td_kind_refuse(aedat4, TD_WANTS_FRAMES, &error), TIDES_OK);
    assert_int_equal(td_kind_refuse(aedat4, TD_WANTS_EVENTS, &error), TIDES_OK);
    scene_expect_error(td_kind_refuse(aedat4, TD_WANTS_SCENE, &error), TIDES_BAD_FILE, &error,
                       "an AEDAT 4 recording|tides info");
    const char *picture = make(*state, "b.aedat4", BYTES_OF("\x89PNG\r\n\x1a\n"), 0);
    assert_int_equal(as_frames(picture, &error), TIDES_BAD_FILE);
    assert_non_null(strstr(error.text, "is a PNG picture, not frames"));
}

/* Folders that are nothing say so, and those of other pictures how they are read. */
static void folders(void **state) {
    tides_error error = {TIDES_OK, ""};
    scene_expect_error(as_run(*state, &error), TIDES_BAD_CONFIG, &error,
                       "is a folder|neither a trained model's|nor one of .png");
    make(*state, "1.jpg", BYTES_OF("\xff\xd8\xff\xe0"), 0);
    make(*state, "2.jpg", BYTES_OF("\xff\xd8\xff\xe0"), 0);
    scene_expect_error(as_run(*state, &error), TIDES_BAD_FILE, &error, "holds 2 .jpg pictures|-pattern_type glob|*.jpg");
    scene_expect_error(as_frames(*state, &error), TIDES_BAD_FILE, &error, "holds 2 .jpg pictures|-pattern_type glob");
    char text[300];
    tides_run *run = NULL;
    snprintf(text, sizeof text, "{\"frames\": {\"file\": \"a\"}, \"rig\": {\"file\": \"%s\"}}", (const char *)*state);
    scene_expect_error(tides_run_parse(text, "", NULL, 0, &run, &error), TIDES_BAD_FILE, &error, "rig.file|is a folder");
}

/* Frames alone are a run: an array, a folder of pictures, a video. */
static void frames_alone(void **state) {
    static const char header[] = "\x93NUMPY\1\0\x76\0{'descr': '|u1', 'fortran_order': False, 'shape': (2, 10, 10), }";
    const char *const sets[] = {"frames.frames_per_second=10"};
    tides_error error;
    tides_run *run = NULL;
    tides_run_values values;
    tides_frames *frames = NULL;
    char bytes[328];
    memset(bytes, ' ', sizeof bytes);
    memcpy(bytes, header, sizeof header - 1);
    bytes[127] = '\n';
    const char *path = scene_in_folder(*state, "f.npy");
    scene_file_write(path, bytes, sizeof bytes);
    scene_expect_ok(tides_run_load(path, sets, 1, &run, &error), &error);
    tides_run_get(run, &values);
    assert_string_equal(values.frames_file, path);
    scene_expect_ok(tides_run_open_frames(run, &frames, &error), &error);
    assert_int_equal(tides_frames_count(frames), 2);
    tides_frames_close(frames);
    tides_run_destroy(run);
    make(*state, "1.png", BYTES_OF("\x89PNG\r\n\x1a\n"), 0);
    scene_expect_ok(tides_run_load(*state, NULL, 0, &run, &error), &error);
    assert_non_null(strstr(tides_run_notes(run), "frames.transfer=srgb"));
    tides_run_destroy(run);
}

int main(void) {
#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_setup, scene_folder_teardown)
    const struct CMUnitTest tests[] = {IN_FOLDER(foreign), IN_FOLDER(pipes),   IN_FOLDER(own),
                                       IN_FOLDER(aedat_4), IN_FOLDER(folders), IN_FOLDER(frames_alone)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
