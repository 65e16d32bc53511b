/* Event files whose writer crashes, is killed, or runs out of space: flushed events stay readable. */
#include "test_events_common.h"

#include <time.h>

static const tides_event_file facts = {.width = 346, .height = 260, .run = "{}", .seed = "1"};

enum { CHUNK = 65536, STREAM = 700000 };

static void part_of(folder *f, char out[700]) { snprintf(out, 700, "%s.part", in_folder(f, "events.h5")); }

/* Appends until all is in or the process dies; portions that fit no chunk. Says so on `ready` once the file is open. Only for
 * the child: returns its exit code. */
static int append_forever(const char *path, const tides_event *events, size_t count, int ready) {
    tides_event_writer *writer = NULL;
    if (tides_event_writer_open(path, NULL, &facts, &writer, NULL) != TIDES_OK) return 2;
    if (write(ready, "", 1) != 1) return 4;
    for (size_t done = 0; done < count;) {
        size_t portion = count - done < 12345 ? count - done : 12345;
        if (tides_event_writer_append(writer, events + done, NULL, portion, NULL) != TIDES_OK) return 3;
        done += portion;
    }
    return 0;
}

/* How many events the .part holds; they must be the first of the stream. */
static size_t check_prefix(const char *part, const tides_event *events) {
    tides_event_summary summary;
    tides_error error;
    if (tides_events_summary(part, &summary, &error) != TIDES_OK) fail_msg("%s", error.text);
    assert_true(summary.count <= STREAM);
    assert_int_equal(summary.width, 346);
    assert_file_holds(part, events, (size_t)summary.count);
    return (size_t)summary.count;
}

/* Starts a child that appends the stream; returns once its file is open. */
static pid_t start_child(const char *path, const tides_event *events) {
    int ends[2];
    char byte;
    assert_int_equal(pipe(ends), 0);
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) _exit(append_forever(path, events, STREAM, ends[1]));
    assert_true(child > 0);
    close(ends[1]);
    assert_int_equal(read(ends[0], &byte, 1), 1);
    close(ends[0]);
    return child;
}

static void test_exit_without_finish(void **state) {
    folder *f = *state;
    char part[700];
    part_of(f, part);
    tides_event *events = random_events(21, STREAM, facts.width, facts.height, 900000);
    pid_t child = start_child(in_folder(f, "events.h5"), events);
    int status = -1;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_true(WEXITSTATUS(status) == 0);
    assert_false(file_exists(in_folder(f, "events.h5")));
    assert_int_equal(check_prefix(part, events), STREAM / CHUNK * CHUNK);
    free(events);
}

/* 15 kills at times drawn from the first 60 ms, wherever they may hit; from a longer time, and more of them, while nothing was
 * written by then, as on a busy machine. TIDES_TEST_KILLS asks for more. */
static void test_kill(void **state) {
    folder *f = *state;
    char part[700];
    part_of(f, part);
    tides_event *events = random_events(22, STREAM, facts.width, facts.height, 900000);
    const char *asked = getenv("TIDES_TEST_KILLS");
    long kills = asked ? strtol(asked, NULL, 10) : 15;
    uint64_t random = (uint64_t)time(NULL);
    uint64_t within_ns = 60000000;
    const uint64_t longest_ns = 900000000;
    size_t most = 0;
    print_message("seed %llu\n", (unsigned long long)random);
    for (long k = 0; k < kills || (most == 0 && k < 10 * kills); k++) {
        pid_t child = start_child(in_folder(f, "events.h5"), events);
        nanosleep(&(struct timespec){.tv_nsec = (long)(scene_next(&random) % within_ns)}, NULL);
        kill(child, SIGKILL);
        assert_int_equal(waitpid(child, NULL, 0), child);
        size_t held = check_prefix(part, events);
        if (held > most) most = held;
        if (most == 0 && within_ns < longest_ns) within_ns += within_ns / 4;
    }
    assert_true(kills == 0 || most > 0); /* or the kills came too early to prove anything */
    free(events);
}

/* What a child under a file size limit saw. */
typedef struct outcome {
    int32_t opened, failed, again, finished, same_text, text_says_why;
    uint64_t count, safe;
} outcome;

typedef struct stream {
    const char *path;
    const tides_event *events;
} stream;

static void write_until_full(void *result, void *user) {
    outcome *seen = result;
    const stream *from = user;
    tides_event_writer *writer = NULL;
    tides_error error = {0}, again = {0};
    seen->opened = tides_event_writer_open(from->path, NULL, &facts, &writer, &error);
    if (seen->opened != TIDES_OK) return;
    for (size_t done = 0; done < STREAM && seen->failed == TIDES_OK; done += 10000)
        seen->failed = tides_event_writer_append(writer, from->events + done, NULL, 10000, &error);
    seen->count = tides_event_writer_count(writer);
    const char *safe = strstr(error.text, "its first ");
    seen->safe = safe ? strtoull(safe + 10, NULL, 10) : UINT64_MAX;
    seen->text_says_why = strstr(error.text, "File too large") != NULL;
    seen->again = tides_event_writer_append(writer, from->events, NULL, 1, &again);
    seen->same_text = strcmp(error.text, again.text) == 0;
    seen->finished = tides_event_writer_finish(writer, 0, NULL);
}

static void test_disk_full(void **state) {
    folder *f = *state;
    char part[700];
    part_of(f, part);
    tides_event *events = random_events(23, STREAM, facts.width, facts.height, 900000);
    /* From files that can't even be created, over ones that fill up at the first, second ... chunk. */
    const rlim_t limits[] = {0, 700, 5000, 30000, 1000000, 1300000, 1500000, 1800000, 2000000, 2500000, 3000000};
    const char *path = in_folder(f, "events.h5");
    uint64_t most = 0;
    for (size_t l = 0; l < sizeof limits / sizeof *limits; l++) {
        outcome seen = {0};
        put_text(path, "precious");
        run_limited(limits[l], write_until_full, &seen, sizeof seen, &(stream){path, events});
        check_text(path, "precious");
        if (seen.opened != TIDES_OK) {
            assert_int_equal(seen.opened, TIDES_WRITE_FAILED);
            assert_false(file_exists(part)); /* an empty shell is no use to anyone */
            continue;
        }
        assert_int_equal(seen.failed, TIDES_WRITE_FAILED);
        assert_int_equal(seen.again, TIDES_WRITE_FAILED);
        assert_int_equal(seen.finished, TIDES_WRITE_FAILED);
        assert_true(seen.same_text && seen.text_says_why);
        assert_int_equal(seen.count, seen.safe + CHUNK); /* the chunk that found no room is still in memory */
        assert_int_equal(check_prefix(part, events), seen.safe);
        if (seen.safe > most) most = seen.safe;
    }
    assert_true(most >= 2 * CHUNK);
    free(events);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_exit_without_finish, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_kill, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_disk_full, folder_setup, folder_teardown),
    };
    return cmocka_run_group_tests_name("events: crashes", tests, NULL, NULL);
}
