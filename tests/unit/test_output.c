/* Outputs of every writer of the library: files are replaced, links' targets are written and the links stay, devices and FIFOs
 * are written by formats that can, folders are refused. */
#define _DEFAULT_SOURCE /* mknod */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "td_base.h"
#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"
#include "tides.h"

#include <fcntl.h>
#include <pthread.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

/* ---- the writers ---- */

static tides_status put_text(const char *path, tides_error *error) { return tides_file_write(path, "text", 4, error); }

static tides_status put_scene(const char *path, tides_error *error) {
    tides_scene *scene = scene_new();
    td_gaussians g = scene_random(7, 20, 1, SCENE_TRAINED);
    scene_add(scene, &g, NULL, 1, NULL);
    tides_status status = tides_scene_save(scene, path, error);
    td_gaussians_free(&g);
    tides_scene_destroy(scene);
    return status;
}

static tides_status put_path(const char *path, tides_error *error) {
    const tides_pose_sample samples[] = {{.time = 0, .quaternion = {1, 0, 0, 0}}, {.time = 1, .quaternion = {1, 0, 0, 0}}};
    tides_trajectory *trajectory = NULL;
    assert_int_equal(tides_trajectory_create(samples, 2, &trajectory, NULL), TIDES_OK);
    tides_status status = tides_path_save(path, trajectory, NULL, error);
    tides_trajectory_destroy(trajectory);
    return status;
}

static tides_status put_png(const char *path, tides_error *error) {
    const uint8_t rgb[3] = {1, 2, 3};
    return tides_png_write(path, 1, 1, rgb, error);
}

static tides_status put_exr(const char *path, tides_error *error) {
    const float value = 1;
    const tides_channel channel = {"Y", &value};
    return tides_exr_write(path, 1, 1, &channel, 1, TIDES_EXR_ZIPS, NULL, error);
}

static tides_status put_animation(const char *path, tides_error *error) {
    const uint8_t rgb[12] = {0};
    tides_animation *animation = NULL;
    tides_status status = tides_animation_open(path, 2, 2, 10, &animation, error);
    if (status == TIDES_OK) status = tides_animation_append(animation, rgb, error);
    if (status == TIDES_OK) return tides_animation_finish(animation, error);
    tides_animation_abandon(animation);
    return status;
}

static tides_status put_arrays(const char *path, tides_error *error) {
    const tides_array_shape shape = {.name = "frame", .planes = 1, .height = 2, .width = 2};
    const double values[4] = {1, 2, 3, 4};
    tides_array_writer *writer = NULL;
    tides_status status = tides_array_writer_open(path, &shape, &writer, error);
    if (status == TIDES_OK) status = tides_array_writer_append(writer, values, 0, 1000, 4, error);
    if (status == TIDES_OK) return tides_array_writer_finish(writer, error);
    tides_array_writer_abandon(writer);
    return status;
}

/* A failed write of events ends with the writer abandoned. */
static tides_status put_events(const char *path, tides_error *error) {
    const tides_event_file facts = {.width = 8, .height = 8};
    const tides_event events[] = {{.t = 1000, .x = 1, .y = 2, .polarity = 1}, {.t = 2000, .x = 3, .y = 4, .polarity = -1}};
    tides_event_writer *writer = NULL;
    tides_status status = tides_event_writer_open(path, NULL, &facts, &writer, error);
    if (status == TIDES_OK) status = tides_event_writer_append(writer, events, NULL, 2, error);
    if (status == TIDES_OK) return tides_event_writer_finish(writer, 2000, error);
    tides_event_writer_abandon(writer);
    return status;
}

typedef struct writer {
    const char *name;
    tides_status (*put)(const char *path, tides_error *error);
    int streams;
} writer;

static const writer writers[] = {{"a.json", put_text, 1},       {"a.ply", put_scene, 1},      {"scene.h5", put_scene, 1},
                                 {"a.path", put_path, 1},       {"a.png", put_png, 1},        {"a.exr", put_exr, 0},
                                 {"a.y4m", put_animation, 1},   {"a.apng", put_animation, 0}, {"frames.npy", put_arrays, 0},
                                 {"frames.npz", put_arrays, 0}, {"frames.h5", put_arrays, 0}, {"e.h5", put_events, 0},
                                 {"e.raw", put_events, 1},      {"e.txt", put_events, 1},     {"e.csv", put_events, 1},
                                 {"e.dat", put_events, 1},      {"e.es", put_events, 1},      {"e.aedat4", put_events, 0},
                                 {"e.npy", put_events, 0},      {"e.npz", put_events, 0}};
enum { WRITERS = sizeof writers / sizeof *writers };

static const char *within(void **state, const char *name) { return scene_in_folder(*state, name); }

static void put(const writer *w, const char *path) {
    tides_error error = {TIDES_OK, ""};
    if (w->put(path, &error) != TIDES_OK) fail_msg("%s: %s", w->name, error.text);
}

static void refuse(const writer *w, const char *path, const char *says) {
    tides_error error = {TIDES_OK, ""};
    tides_status status = w->put(path, &error);
    if (status != TIDES_WRITE_FAILED || error.status != status || !strstr(error.text, says) || strchr(error.text, '\n'))
        fail_msg("%s: status %d, '%s' doesn't say '%s'", w->name, (int)status, error.text, says);
}

static mode_t kind_of(const char *path) {
    struct stat there;
    return lstat(path, &there) == 0 ? there.st_mode & S_IFMT : 0;
}

/* The file holds what the writer makes, and not "old". */
static void check_written(const char *path) {
    size_t size = 0;
    char *data = scene_file_read(path, &size);
    assert_int_equal(kind_of(path), S_IFREG);
    assert_true(size > 3);
    assert_true(memcmp(data, "old", 3) != 0);
    free(data);
}

static void check_no_part(void **state, const char *name) {
    char part[128];
    snprintf(part, sizeof part, "%s.part", name);
    assert_int_equal(kind_of(within(state, part)), 0);
}

/* ---- the rules ---- */

static void test_replaced(void **state) {
    for (int i = 0; i < WRITERS; i++) {
        const char *path = within(state, writers[i].name);
        scene_file_write(path, "old", 3);
        put(&writers[i], path);
        check_written(path);
        check_no_part(state, writers[i].name);
    }
}

/* A link to a link in another folder, relative as links mostly are; first to nothing, then to a file. */
static void test_links(void **state) {
    for (int i = 0; i < WRITERS; i++) {
        const char *name = writers[i].name;
        char first[96], second[96], behind[96], target[96];
        snprintf(first, sizeof first, "first-%s", name);
        snprintf(second, sizeof second, "there/second-%s", name);
        snprintf(behind, sizeof behind, "target-%s", name); /* as seen from `there` */
        snprintf(target, sizeof target, "there/target-%s", name);
        mkdir(within(state, "there"), 0700);
        assert_int_equal(symlink(second, within(state, first)), 0);
        assert_int_equal(symlink(behind, within(state, second)), 0);
        for (int there = 0; there < 2; there++) {
            if (there) scene_file_write(within(state, target), "old", 3);
            put(&writers[i], within(state, first));
            check_written(within(state, target));
            assert_int_equal(kind_of(within(state, first)), S_IFLNK);
            assert_int_equal(kind_of(within(state, second)), S_IFLNK);
            check_no_part(state, first);
            check_no_part(state, target);
        }
    }
}

static void test_circle(void **state) {
    for (int i = 0; i < WRITERS; i++) {
        char other[96];
        snprintf(other, sizeof other, "other-%s", writers[i].name);
        assert_int_equal(symlink(other, within(state, writers[i].name)), 0);
        assert_int_equal(symlink(writers[i].name, within(state, other)), 0);
        refuse(&writers[i], within(state, writers[i].name), "circle");
    }
}

static void test_folders(void **state) {
    for (int i = 0; i < WRITERS; i++) {
        const char *path = within(state, writers[i].name);
        assert_int_equal(mkdir(path, 0700), 0);
        refuse(&writers[i], path, "is a folder");
        assert_int_equal(kind_of(path), S_IFDIR);
        check_no_part(state, writers[i].name);
    }
}

/* Reads a FIFO to its end. */
static void *drain(void *path) {
    char bytes[4096];
    static size_t total;
    total = 0;
    FILE *file = fopen(path, "rb");
    for (size_t got; file && (got = fread(bytes, 1, sizeof bytes, file)) > 0;) total += got;
    if (file) fclose(file);
    return &total;
}

static void write_fifo(const writer *w, const char *fifo, const char *file) {
    pthread_t reader;
    void *total = NULL;
    size_t size = 0;
    char *name = strdup(fifo);
    assert_non_null(name);
    assert_int_equal(pthread_create(&reader, NULL, drain, name), 0);
    put(w, fifo);
    pthread_join(reader, &total);
    free(name);
    put(w, file);
    free(scene_file_read(file, &size));
    assert_int_equal(*(size_t *)total, size); /* all that a file of it holds */
}

static void test_fifos(void **state) {
    for (int i = 0; i < WRITERS; i++) {
        char name[96], link[96], file[96];
        snprintf(name, sizeof name, "fifo-%s", writers[i].name);
        snprintf(link, sizeof link, "link-%s", writers[i].name);
        snprintf(file, sizeof file, "file-%s", writers[i].name);
        char fifo[700];
        snprintf(fifo, sizeof fifo, "%s", within(state, name));
        assert_int_equal(mkfifo(fifo, 0600), 0);
        assert_int_equal(symlink(name, within(state, link)), 0);
        if (writers[i].streams) {
            assert_int_equal(tides_file_check(fifo, 1, NULL), TIDES_OK);
            write_fifo(&writers[i], fifo, within(state, file));
            write_fifo(&writers[i], within(state, link), within(state, file));
        } else {
            refuse(&writers[i], fifo, "is a device or FIFO");
            assert_int_equal(tides_file_check(fifo, 0, NULL), TIDES_WRITE_FAILED);
        }
        assert_int_equal(kind_of(fifo), S_IFIFO);
        assert_int_equal(kind_of(within(state, link)), S_IFLNK);
        check_no_part(state, name);
    }
}

/* A /dev/null and a /dev/full of our own, as only root can make; the second has no room. */
static void test_devices(void **state) {
    for (int i = 0; i < WRITERS; i++) {
        char name[96], full[96];
        snprintf(name, sizeof name, "null-%s", writers[i].name);
        snprintf(full, sizeof full, "full-%s", writers[i].name);
        char null[700], none[700];
        snprintf(null, sizeof null, "%s", within(state, name));
        snprintf(none, sizeof none, "%s", within(state, full));
        if (mknod(null, S_IFCHR | 0666, makedev(1, 3)) != 0 || mknod(none, S_IFCHR | 0666, makedev(1, 7)) != 0) skip();
        int usable = open(null, O_WRONLY); /* not on file systems that are mounted without devices */
        if (usable < 0) skip();
        close(usable);
        if (writers[i].streams)
            put(&writers[i], null);
        else
            refuse(&writers[i], null, "is a device or FIFO");
        refuse(&writers[i], none, writers[i].streams ? "space" : "is a device or FIFO");
        assert_int_equal(kind_of(null), S_IFCHR);
        assert_int_equal(kind_of(none), S_IFCHR);
    }
}

/* ---- checking beforehand, and names ---- */

static void test_check(void **state) {
    tides_error error = {TIDES_OK, ""};
    const char *path = within(state, "a.txt"), *part = within(state, "a.txt.part");
    assert_int_equal(tides_file_check(path, 1, &error), TIDES_OK);
    assert_int_equal(kind_of(path), 0);
    assert_int_equal(kind_of(part), 0);
    scene_file_write(part, "going on", 8);
    assert_int_equal(tides_file_check(path, 0, &error), TIDES_OK);
    assert_int_equal(kind_of(part), S_IFREG); /* another run's */
    assert_int_equal(tides_file_check(within(state, "none/a.txt"), 1, &error), TIDES_WRITE_FAILED);
    assert_non_null(strstr(error.text, "none/a.txt: can't be written: No such file"));
    assert_int_equal(tides_file_check(*state, 1, &error), TIDES_WRITE_FAILED);
    assert_int_equal(tides_file_check(NULL, 1, &error), TIDES_BAD_ARGUMENT);
}

static void test_part_names(void **state) {
    tides_error error = {TIDES_OK, ""};
    char part[700], tight[4];
    assert_int_equal(tides_file_part(within(state, "a.h5"), part, sizeof part, &error), TIDES_OK);
    assert_string_equal(part, within(state, "a.h5.part"));
    assert_int_equal(symlink("elsewhere.h5", within(state, "link.h5")), 0);
    assert_int_equal(tides_file_part(within(state, "link.h5"), part, sizeof part, &error), TIDES_OK);
    assert_string_equal(part, within(state, "elsewhere.h5.part"));
    assert_int_equal(tides_file_part(within(state, "a.h5"), tight, sizeof tight, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_file_part(NULL, part, sizeof part, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_file_write(NULL, "", 0, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_file_write(part, NULL, 1, &error), TIDES_BAD_ARGUMENT);
    assert_int_equal(tides_file_write(within(state, "empty"), NULL, 0, &error), TIDES_OK);
    assert_int_equal(kind_of(within(state, "empty")), S_IFREG);
}

/* What came to be at the place while the work went on isn't replaced either, and the work isn't lost. */
static void test_changed_meanwhile(void **state) {
    const tides_event_file facts = {.width = 8, .height = 8};
    const tides_event event = {.t = 1000, .x = 1, .y = 2, .polarity = 1};
    tides_event_writer *open_one = NULL;
    tides_error error = {TIDES_OK, ""};
    char path[700];
    snprintf(path, sizeof path, "%s", within(state, "late.h5"));
    assert_int_equal(tides_event_writer_open(path, NULL, &facts, &open_one, &error), TIDES_OK);
    assert_int_equal(tides_event_writer_append(open_one, &event, NULL, 1, &error), TIDES_OK);
    assert_int_equal(mkfifo(path, 0600), 0);
    assert_int_equal(tides_event_writer_finish(open_one, 2000, &error), TIDES_WRITE_FAILED);
    assert_non_null(strstr(error.text, "the data is in"));
    assert_int_equal(kind_of(path), S_IFIFO);
    tides_event found;
    size_t got = 0;
    assert_int_equal(kind_of(within(state, "late.h5.part")), S_IFREG);
    assert_int_equal(tides_events_read(within(state, "late.h5.part"), 0, 1, &found, &got, &error), TIDES_OK);
    assert_int_equal(got, 1);
}

/* ---- what others put where a .part will be ---- */

/* Every writer refuses what isn't a file of ours alone, names it, and leaves it and what it leads to as they are. */
static void check_planted(void **state, const writer *w, const char *ending, const char *says) {
    char part[96], victim[700];
    snprintf(part, sizeof part, "%s%s", w->name, ending);
    snprintf(victim, sizeof victim, "%s", within(state, "victim"));
    scene_file_write(victim, "ours", 4);
    const mode_t kind = kind_of(within(state, part));
    refuse(w, within(state, w->name), says);
    assert_int_equal(kind_of(within(state, part)), kind);
    assert_int_equal(kind_of(within(state, w->name)), 0);
    size_t size = 0;
    char *data = scene_file_read(victim, &size);
    assert_int_equal(size, 4);
    assert_memory_equal(data, "ours", 4);
    free(data);
    assert_int_equal(kind_of(within(state, "nowhere")), 0);
    assert_int_equal(unlink(within(state, part)), 0);
    put(w, within(state, w->name));
    assert_int_equal(unlink(within(state, w->name)), 0);
}

static void test_planted(void **state) {
    scene_file_write(within(state, "victim"), "ours", 4);
    for (int i = 0; i < WRITERS; i++) {
        char name[96], part[700];
        snprintf(name, sizeof name, "%s.part", writers[i].name);
        snprintf(part, sizeof part, "%s", within(state, name));
        assert_int_equal(symlink("victim", part), 0);
        check_planted(state, &writers[i], ".part", "is a link");
        assert_int_equal(symlink("nowhere", part), 0);
        check_planted(state, &writers[i], ".part", "is a link");
        assert_int_equal(link(within(state, "victim"), part), 0);
        check_planted(state, &writers[i], ".part", "hard link");
        assert_int_equal(mkfifo(part, 0600), 0);
        check_planted(state, &writers[i], ".part", "isn't a file");
        if (geteuid() != 0) continue;
        scene_file_write(part, "theirs", 6);
        assert_int_equal(chown(part, 1, 1), 0);
        check_planted(state, &writers[i], ".part", "another user");
    }
}

/* Where the link comes after the name was looked at. */
static void test_planted_meanwhile(void **state) {
    char part[700], fifo[700];
    scene_file_write(within(state, "victim"), "ours", 4);
    snprintf(part, sizeof part, "%s", within(state, "a.part"));
    snprintf(fifo, sizeof fifo, "%s", within(state, "b.part"));
    assert_int_equal(symlink("victim", part), 0);
    assert_int_equal(mkfifo(fifo, 0600), 0);
    assert_int_equal(td_claim_file(part), -1);
    assert_int_equal(td_open_own(part, 0), -1);
    assert_int_equal(td_claim_file(fifo), -1);
    assert_int_equal(td_copy_file(within(state, "victim"), part, NULL), TIDES_WRITE_FAILED);
    const writer npz = {"e.npz", put_events, 0};
    assert_int_equal(symlink("victim", within(state, "e.npz.part.spool")), 0);
    refuse(&npz, within(state, "e.npz"), "spool");
    size_t size = 0;
    char *data = scene_file_read(within(state, "victim"), &size);
    assert_int_equal(size, 4);
    free(data);
}

/* ---- two runs ---- */

/* Of two that write one file the second is refused, and the first one's file is what it wrote. */
static void try_two(void **state, const char *name) {
    const tides_event_file facts = {.width = 8, .height = 8};
    const tides_event event = {.t = 1000, .x = 1, .y = 2, .polarity = 1};
    tides_event_writer *first = NULL, *second = NULL;
    tides_error error = {TIDES_OK, ""};
    tides_event found;
    size_t got = 0;
    char path[700];
    snprintf(path, sizeof path, "%s", within(state, name));
    assert_int_equal(tides_event_writer_open(path, NULL, &facts, &first, &error), TIDES_OK);
    assert_int_equal(tides_event_writer_append(first, &event, NULL, 1, &error), TIDES_OK);
    assert_int_equal(tides_event_writer_open(path, NULL, &facts, &second, &error), TIDES_WRITE_FAILED);
    assert_null(second);
    const int says = strstr(error.text, "is being written by another run") || strstr(error.text, "busy");
    if (!says) fail_msg("%s: %s", name, error.text);
    assert_int_equal(tides_event_writer_finish(first, 2000, &error), TIDES_OK);
    assert_int_equal(tides_events_read(path, 0, 1, &found, &got, &error), TIDES_OK);
    assert_int_equal(got, 1);
    assert_int_equal(found.x, 1);
}

static void test_two_recordings(void **state) {
    static const char *const names[] = {"two.h5", "two.raw", "two.dat", "two.csv", "two.npy", "two.npz", "two.ecf.hdf5"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) try_two(state, names[i]);
}

/* Whatever is written at once: another's .part is left alone. */
static void test_two_files(void **state) {
    tides_error error = {TIDES_OK, ""};
    const uint8_t rgb[3] = {1, 2, 3};
    char part[700], path[700], held[8] = "";
    snprintf(path, sizeof path, "%s", within(state, "a.png"));
    snprintf(part, sizeof part, "%s", within(state, "a.png.part"));
    const int other = open(part, O_RDWR | O_CREAT, 0600);
    assert_true(other >= 0 && flock(other, LOCK_EX | LOCK_NB) == 0 && write(other, "other", 5) == 5);
    assert_int_equal(tides_png_write(path, 1, 1, rgb, &error), TIDES_WRITE_FAILED);
    assert_non_null(strstr(error.text, "busy"));
    assert_int_equal(tides_file_write(path, "mine", 4, &error), TIDES_WRITE_FAILED);
    assert_int_equal(access(path, F_OK), -1);
    assert_int_equal(pread(other, held, sizeof held, 0), 5);
    assert_string_equal(held, "other");
    assert_int_equal(kind_of(part), S_IFREG);
    close(other);
    assert_int_equal(tides_png_write(path, 1, 1, rgb, &error), TIDES_OK);
    assert_int_equal(access(part, F_OK), -1);
}

#define CASE(name) cmocka_unit_test_setup_teardown(name, scene_folder_setup, scene_folder_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {CASE(test_replaced),
                                       CASE(test_links),
                                       CASE(test_circle),
                                       CASE(test_folders),
                                       CASE(test_fifos),
                                       CASE(test_devices),
                                       CASE(test_check),
                                       CASE(test_part_names),
                                       CASE(test_changed_meanwhile),
                                       CASE(test_two_recordings),
                                       CASE(test_two_files),
                                       CASE(test_planted),
                                       CASE(test_planted_meanwhile)};
    return cmocka_run_group_tests_name("where outputs go", tests, NULL, NULL);
}
