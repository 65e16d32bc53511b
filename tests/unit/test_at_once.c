/* Several processes write one file at the same moment: at least one succeeds, and the file is whole. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "lib/archive/td_h5_driver.h"
#include "tests/support/scene_folder.h"
#include "tides.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

enum { WRITERS = 3, ROUNDS = 150 };

/* As the tool does: what is in the way is seen before the work begins. */
static int write_events(const char *path) {
    const tides_event_file facts = {.width = 4, .height = 4, .stop_ns = 1000};
    const tides_event events[] = {{.t = 10, .x = 1, .y = 2, .polarity = 1}, {.t = 20, .x = 3, .y = 0, .polarity = -1}};
    tides_event_writer *writer = NULL;
    if (tides_file_check(path, 0, NULL) != TIDES_OK) return 1;
    if (tides_event_writer_open(path, NULL, &facts, &writer, NULL) != TIDES_OK) return 1;
    if (tides_event_writer_append(writer, events, NULL, 2, NULL) == TIDES_OK)
        return tides_event_writer_finish(writer, 1000, NULL) != TIDES_OK;
    tides_event_writer_abandon(writer);
    return 1;
}

/* How many of WRITERS processes wrote it. */
static int write_at_once(const char *path) {
    pid_t writers[WRITERS];
    int wrote = 0, status = 0;
    for (int k = 0; k < WRITERS; k++) {
        writers[k] = fork();
        assert_true(writers[k] >= 0);
        if (writers[k] == 0) _exit(write_events(path));
    }
    for (int k = 0; k < WRITERS; k++) {
        assert_int_equal(waitpid(writers[k], &status, 0), writers[k]);
        assert_true(WIFEXITED(status));
        wrote += WEXITSTATUS(status) == 0;
    }
    return wrote;
}

static void try_file(void **state, const char *name) {
    char path[700], part[710];
    size_t size = 0, got = 0;
    snprintf(path, sizeof path, "%s", scene_in_folder(*state, name));
    snprintf(part, sizeof part, "%s.part", path);
    assert_int_equal(write_events(path), 0);
    char *alone = scene_file_read(path, &size);
    for (int round = 0; round < ROUNDS; round++) {
        unlink(path);
        if (write_at_once(path) < 1) fail_msg("%s, round %d: nobody wrote it", name, round);
        char *content = scene_file_read(path, &got);
        if (got != size) fail_msg("%s, round %d: %zu bytes of %zu", name, round, got, size);
        assert_memory_equal(content, alone, size);
        free(content);
        assert_int_equal(access(part, F_OK), -1);
    }
    free(alone);
}

static void test_events(void **state) {
    try_file(state, "a.h5");
    try_file(state, "a.raw");
    try_file(state, "a.ecf.hdf5");
}

/* HDF5 itself empties a file before it asks whether another has it. */
static void test_hdf5(void **state) {
    char path[700], held[8] = "";
    int failed = 0;
    snprintf(path, sizeof path, "%s", scene_in_folder(*state, "b.h5"));
    const int other = open(path, O_RDWR | O_CREAT, 0600);
    assert_true(other >= 0 && flock(other, LOCK_EX | LOCK_NB) == 0 && write(other, "other", 5) == 5);
    const hid_t access = td_h5_write_access(&failed);
    hid_t file = -1;
    H5E_BEGIN_TRY { file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, access); }
    H5E_END_TRY
    assert_true(file < 0);
    assert_int_equal(failed, EBUSY);
    assert_int_equal(pread(other, held, sizeof held, 0), 5);
    assert_string_equal(held, "other");
    close(other);
    failed = 0;
    file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, access);
    assert_true(file >= 0 && H5Fclose(file) >= 0 && failed == 0);
    H5Pclose(access);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test_setup_teardown(test_events, scene_folder_setup, scene_folder_teardown),
                                       cmocka_unit_test_setup_teardown(test_hdf5, scene_folder_setup, scene_folder_teardown)};
    return cmocka_run_group_tests_name("files written at once", tests, NULL, NULL);
}
