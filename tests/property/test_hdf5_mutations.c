/* TIDES' own HDF5 files, scenes and recordings, damaged. Each is read in a process of its own, which must end by itself within
 * seconds and a bound of memory, with success or with one line. Files of earlier versions, whose texts have variable length,
 * are among them.
 *
 *   TIDES_MUTATIONS=20000        so many instead of MUTATIONS (make fuzz-hdf5)
 *   TIDES_MUTATION_SEED=1        other random mutations
 *   TIDES_MUTATIONS_KEEP=FOLDER  files that crashed or hung are kept there */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/event_stream.h"
#include "tests/support/moving_scene.h"
#include "tests/support/scene_folder.h"
#include "tests/support/scene_make.h"
#include "tides.h"

#include <hdf5.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum {
    MUTATIONS = 300,
    SECONDS = 5,
    EVENTS = 70000,    /* a chunk and a piece */
    EVENTS_SMALL = 50, /* nearly all of the file is metadata */
    BLOCK = 1000,      /* events read at once */
    BLOCKS = 200,      /* as many at most: a few damaged bytes can claim to be many */
    NOT_ONE_LINE = 3,  /* exit codes of the child */
    SEEDS = 7
};
static const rlim_t memory = (rlim_t)4 << 30; /* of addresses: what the process has already, and as much as any file may ask */

/* ---- the files ---- */

typedef struct seed_file {
    const char *name;
    void (*make)(const char *path);
    void (*read)(const char *path);
    char *bytes;
    size_t size;
} seed_file;

static void make_scene(const char *path) {
    td_gaussians g;
    scene_save_pair(path, &g);
    td_gaussians_free(&g);
}

static void make_moving(const char *path) {
    tides_error error;
    td_gaussians g = scene_random(91, 40, 1, SCENE_SMALL_INTEGERS);
    tides_scene *scene = scene_new();
    tides_gaussians view = td_gaussians_view(&g);
    scene_expect_ok(tides_scene_add_moving(scene, &view, polynomial_motion_make(3, 40, 0.5), 2.5, NULL, 1.5, "moves", NULL,
                                           &error),
                    &error);
    scene_save(scene, path);
    td_gaussians_free(&g);
    tides_scene_destroy(scene);
}

static void write_events(const char *path, size_t count, int32_t labels) {
    const tides_event_file facts = {.width = 64, .height = 48, .run = "{\"seed\": \"1\"}", .seed = "1", .labels = labels};
    tides_event *events = calloc(count, sizeof *events);
    uint64_t state = 5;
    tides_event_writer *writer = NULL;
    tides_error error;
    assert_non_null(events);
    random_stream(events, count, 64, 48, 50000000, 1, &state);
    scene_expect_ok(tides_event_writer_open(path, NULL, &facts, &writer, &error), &error);
    scene_expect_ok(tides_event_writer_append(writer, events, NULL, count, &error), &error);
    scene_expect_ok(tides_event_writer_finish(writer, 50000000, &error), &error);
    free(events);
}

static void make_events(const char *path) { write_events(path, EVENTS, 0); }
static void make_part(const char *path) {
    char whole[4096];
    snprintf(whole, sizeof whole, "%s.whole.h5", path);
    make_events(whole);
    assert_int_equal(rename(whole, path), 0);
}
static void make_labels(const char *path) { write_events(path, EVENTS_SMALL, 1); }

/* Every text attribute of an object becomes one of variable length, as files had them before. */
static void make_texts_free(hid_t file, const char *object, const char *const *names) {
    hid_t id = H5Oopen(file, object, H5P_DEFAULT), type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    assert_true(id >= 0);
    assert_true(H5Tset_size(type, H5T_VARIABLE) >= 0);
    assert_true(H5Tset_cset(type, H5T_CSET_UTF8) >= 0);
    for (; *names; names++) {
        char text[256] = "";
        const char *at = text;
        hid_t attribute = H5Aopen(id, *names, H5P_DEFAULT), fixed = H5Aget_type(attribute);
        assert_true(H5Tget_size(fixed) < sizeof text);
        assert_true(H5Aread(attribute, fixed, text) >= 0);
        H5Tclose(fixed);
        H5Aclose(attribute);
        assert_true(H5Adelete(id, *names) >= 0);
        attribute = H5Acreate2(id, *names, type, space, H5P_DEFAULT, H5P_DEFAULT);
        assert_true(attribute >= 0);
        assert_true(H5Awrite(attribute, type, &at) >= 0);
        H5Aclose(attribute);
    }
    H5Sclose(space);
    H5Tclose(type);
    H5Oclose(id);
}

static void make_old_scene(const char *path) {
    static const char *const root[] = {"format", "tides_version", NULL}, *const object[] = {"name", "source", NULL},
                             *const model[] = {"model", NULL};
    make_moving(path);
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    make_texts_free(file, "/", root);
    make_texts_free(file, "/objects/0", object);
    make_texts_free(file, "/objects/0/motion", model);
    assert_true(H5Fclose(file) >= 0);
}

static void make_old_events(const char *path) {
    static const char *const root[] = {"format", "tides_version", "seed", "run", NULL};
    write_events(path, EVENTS_SMALL, 0);
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    make_texts_free(file, "/", root);
    assert_true(H5Fclose(file) >= 0);
}

/* ---- reading, in the child ---- */

static void check_refusal(tides_status status, const tides_error *error) {
    if (status == TIDES_OK) return;
    if (error->status != status || !error->text[0] || strchr(error->text, '\n')) _exit(NOT_ONE_LINE);
}

static void read_scene(const char *path) {
    tides_error error = {TIDES_OK, ""};
    tides_scene *scene = NULL;
    if (tides_scene_create(&scene, &error) != TIDES_OK) _exit(NOT_ONE_LINE);
    check_refusal(tides_scene_add_file(scene, path, NULL, 1, &error), &error);
    tides_scene_destroy(scene);
}

static void read_events(const char *path) {
    static tides_event events[BLOCK];
    static int64_t fired[BLOCK];
    tides_error error = {TIDES_OK, ""};
    tides_event_reader *reader = NULL;
    tides_status status = tides_event_reader_open(path, NULL, &reader, &error);
    size_t got = 1;
    for (int i = 0; i < BLOCKS && got && status == TIDES_OK; i++)
        status = tides_event_reader_read(reader, events, BLOCK, &got, &error);
    tides_event_reader_close(reader);
    check_refusal(status, &error);
    status = tides_events_read(path, 0, BLOCK, events, &got, &error);
    if (status == TIDES_OK) status = tides_events_labels(path, 0, got, events, fired, &error);
    check_refusal(status, &error);
}

/* The .part of an interrupted run is read too, and cut back. */
static void resume_events(const char *path) {
    const tides_event_file facts = {.width = 64, .height = 48, .run = "{\"seed\": \"2\"}", .seed = "1"};
    tides_error error = {TIDES_OK, ""};
    tides_event_writer *writer = NULL;
    char final[4096];
    snprintf(final, sizeof final, "%.*s", (int)(strlen(path) - strlen(".part")), path);
    tides_status status = tides_event_writer_resume(final, &facts, 65536, &writer, &error);
    check_refusal(status, &error);
    if (status == TIDES_OK) check_refusal(tides_event_writer_finish(writer, 60000000, &error), &error);
}

static seed_file seeds[SEEDS] = {{"scene.h5", make_scene, read_scene, NULL, 0},
                                 {"moving.h5", make_moving, read_scene, NULL, 0},
                                 {"old_scene.h5", make_old_scene, read_scene, NULL, 0},
                                 {"events.h5", make_events, read_events, NULL, 0},
                                 {"labels.h5", make_labels, read_events, NULL, 0},
                                 {"old_events.h5", make_old_events, read_events, NULL, 0},
                                 {"resumed.h5.part", make_part, resume_events, NULL, 0}};

/* ---- mutations ---- */

/* Most bytes of a file are zeros and packed values: seven of eight mutations go where there is something else nearby. */
static size_t choose_place(const seed_file *seed, uint64_t *random) {
    size_t at = (size_t)(scene_next(random) % seed->size);
    static const char zeros[8];
    for (int tries = 0; tries < 64 && scene_next(random) % 8; tries++) {
        size_t word = at & ~(size_t)7;
        /* HDF5's addresses, sizes and counts are small numbers: they end in zeros */
        if (word + 8 <= seed->size && memcmp(seed->bytes + word, zeros, 8) != 0 &&
            memcmp(seed->bytes + word + 4, zeros, 4) == 0)
            break;
        at = (size_t)(scene_next(random) % seed->size);
    }
    return at;
}

static uint64_t choose_number(size_t size, uint64_t *random) {
    const uint64_t numbers[] = {0,          1,          7,         8,          255,  65535,    0x7fffffff,
                                0x80000000, UINT32_MAX, INT64_MAX, UINT64_MAX, size, size - 8, size / 2};
    const size_t count = sizeof numbers / sizeof *numbers;
    const uint64_t which = scene_next(random);
    return which % 2 ? scene_next(random) % (2 * size) : numbers[which / 2 % count];
}

static void mutate_once(const seed_file *seed, char *bytes, size_t *size, uint64_t *random) {
    size_t at = choose_place(seed, random), from = choose_place(seed, random), n = 1 + (size_t)(scene_next(random) % 64);
    uint64_t value = choose_number(seed->size, random);
    if (at >= *size) return; /* cut off by an earlier one */
    if (n > *size - at) n = *size - at;
    if (n > seed->size - from) n = seed->size - from;
    const size_t width = (size_t)1 << scene_next(random) % 4;
    switch (scene_next(random) % 8) {
        case 0:
        case 1: bytes[at] = (char)(bytes[at] ^ 1 << scene_next(random) % 8); break;
        case 2: bytes[at] = (char)scene_next(random); break;
        case 3:
        case 4: memcpy(bytes + at, &value, n < width ? n : width); break;
        case 5: memmove(bytes + at, seed->bytes + from, n); break;
        case 6: memset(bytes + at, scene_next(random) % 2 ? 0 : 255, n); break;
        default:
            if (scene_next(random) % 4 == 0) *size = at;
            break;
    }
}

/* ---- one damaged file ---- */

static void read_in_child(const seed_file *seed, const char *path) {
    const struct rlimit bound = {memory, memory}, none = {0, 0};
    const int crashes[] = {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL};
    for (size_t i = 0; i < sizeof crashes / sizeof *crashes; i++) signal(crashes[i], SIG_DFL); /* else cmocka goes on here */
    alarm(SECONDS);
#if !defined(__SANITIZE_ADDRESS__)
    setrlimit(RLIMIT_AS, &bound);
#else
    (void)bound;
#endif
    setrlimit(RLIMIT_CORE, &none);
    if (!freopen("/dev/null", "w", stderr)) _exit(NOT_ONE_LINE); /* HDF5 says there what it lost */
    seed->read(path);
    H5close(); /* what the process would do at its end */
    _exit(0);
}

static void keep(const seed_file *seed, long number, const char *bytes, size_t size) {
    char path[4096];
    const char *folder = getenv("TIDES_MUTATIONS_KEEP");
    if (!folder) return;
    snprintf(path, sizeof path, "%s/%ld-%s", folder, number, seed->name);
    scene_file_write(path, bytes, size);
}

/* 1 where it went well. */
static int try_bytes(void **state, const seed_file *seed, long number, const char *bytes, size_t size) {
    const char *path = scene_in_folder(*state, seed->name);
    scene_file_write(path, bytes, size);
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) read_in_child(seed, path);
    int how = 0;
    assert_true(child > 0);
    assert_true(waitpid(child, &how, 0) == child);
    int well = WIFEXITED(how) && WEXITSTATUS(how) == 0;
    if (!well) {
        print_message("mutation %ld of %s: %s %d\n", number, seed->name,
                      WIFSIGNALED(how) && WTERMSIG(how) == SIGALRM ? "hung, signal"
                      : WIFSIGNALED(how)                           ? "crashed, signal"
                                                                   : "not one line, code",
                      WIFSIGNALED(how) ? WTERMSIG(how) : WEXITSTATUS(how));
        keep(seed, number, bytes, size);
    }
    return well;
}

static int try_one(void **state, const seed_file *seed, long number, uint64_t *random) {
    char *bytes = malloc(seed->size);
    size_t size = seed->size;
    assert_non_null(bytes);
    memcpy(bytes, seed->bytes, size);
    for (uint64_t i = 0, times = 1 + scene_next(random) % 4; i < times; i++) mutate_once(seed, bytes, &size, random);
    const int well = try_bytes(state, seed, number, bytes, size);
    free(bytes);
    return well;
}

static long from_environment(const char *name, long otherwise) {
    const char *text = getenv(name);
    return text && *text ? atol(text) : otherwise;
}

/* Undamaged, all of them are read: those of earlier versions too. */
static void test_undamaged(void **state) {
    static tides_event events[EVENTS];
    tides_error error;
    for (int i = 0; i < SEEDS; i++) {
        const char *path = scene_in_folder(*state, seeds[i].name);
        seeds[i].make(path);
        size_t got = 0;
        if (seeds[i].read == read_scene) {
            tides_scene *scene = scene_new();
            scene_load(scene, path, NULL, 1);
            assert_true(tides_scene_count(scene) > 0);
            if (seeds[i].make == make_old_scene) assert_string_equal(scene_object_of(scene, 0).name, "moves");
            tides_scene_destroy(scene);
        } else {
            scene_expect_ok(tides_events_read(path, 0, EVENTS, events, &got, &error), &error);
            assert_int_equal(got, seeds[i].make == make_events || seeds[i].make == make_part ? EVENTS : EVENTS_SMALL);
        }
    }
    tides_event_reader *reader = NULL;
    tides_event_facts facts;
    scene_expect_ok(tides_event_reader_open(scene_in_folder(*state, "old_events.h5"), NULL, &reader, &error), &error);
    tides_event_reader_facts(reader, &facts);
    assert_string_equal(facts.format, "tides");
    assert_string_equal(facts.version, tides_version());
    tides_event_reader_close(reader);
}

static void test_mutations(void **state) {
    const long count = from_environment("TIDES_MUTATIONS", MUTATIONS);
    uint64_t random = (uint64_t)from_environment("TIDES_MUTATION_SEED", 1);
    long bad = 0;
#if defined(__SANITIZE_ADDRESS__)
    print_message("skipped: HDF5 itself reads freed memory where metadata are damaged\n");
    skip();
#endif
    for (int i = 0; i < SEEDS; i++) {
        const char *path = scene_in_folder(*state, seeds[i].name);
        seeds[i].make(path);
        seeds[i].bytes = scene_file_read(path, &seeds[i].size);
    }
    for (long n = 0; n < count; n++) bad += !try_one(state, &seeds[n % SEEDS], n, &random);
    for (int i = 0; i < SEEDS; i++) free(seeds[i].bytes);
    print_message("%ld mutations, %ld bad\n", count, bad);
    assert_int_equal(bad, 0);
}

/* `count` bytes at `at` of each message that begins so become `value`: every column of events with chunks of nothing, of no
 * dimension, or of numbers whose bits lie elsewhere. Many mutations hit none of them. */
static long damage_each(void **state, seed_file *seed, const char *begin, size_t length, size_t at, size_t count, int value) {
    long bad = 0, found = 0;
    for (size_t i = 0; i + at + count <= seed->size; i += 8) {
        char was[8];
        if (memcmp(seed->bytes + i, begin, length) != 0) continue;
        found++;
        memcpy(was, seed->bytes + i + at, count);
        memset(seed->bytes + i + at, value, count);
        bad += !try_bytes(state, seed, (long)i, seed->bytes, seed->size);
        memcpy(seed->bytes + i + at, was, count);
    }
    assert_true(found > 3);
    return bad;
}

static void test_messages(void **state) {
    static const char layout[] = "\x08\0\x18\0\0\0\0\0\x03\x02", type[] = "\x03\0\x10\0\x01\0\0\0\x10";
#if defined(__SANITIZE_ADDRESS__)
    skip(); /* as below */
#endif
    for (int i = 0; i < SEEDS; i++) {
        if (seeds[i].read == read_scene) continue;
        const char *path = scene_in_folder(*state, seeds[i].name);
        seeds[i].make(path);
        seeds[i].bytes = scene_file_read(path, &seeds[i].size);
        assert_int_equal(damage_each(state, &seeds[i], layout, sizeof layout - 1, 8 + 2, 1, 0), 0);
        assert_int_equal(damage_each(state, &seeds[i], layout, sizeof layout - 1, 8 + 11, 4, 0), 0);
        assert_int_equal(damage_each(state, &seeds[i], type, sizeof type - 1, 8 + 8, 2, 0x7f), 0);
        assert_int_equal(damage_each(state, &seeds[i], type, sizeof type - 1, 8 + 10, 2, 0), 0);
        free(seeds[i].bytes);
    }
}

int main(void) {
    const struct CMUnitTest tests[] =
        {cmocka_unit_test_setup_teardown(test_undamaged, scene_folder_setup, scene_folder_teardown),
         cmocka_unit_test_setup_teardown(test_messages, scene_folder_setup, scene_folder_teardown),
         cmocka_unit_test_setup_teardown(test_mutations, scene_folder_setup, scene_folder_teardown)};
    return cmocka_run_group_tests_name("damaged HDF5 files", tests, NULL, NULL);
}
