/* Recordings that are interrupted and resumed: however the process ends, and wherever it is cut, the finished file has the
 * datasets of an uninterrupted recording, and the .part stays readable meanwhile. */
#include "test_events_common.h"

#include <sys/stat.h>
#include <time.h>

static const tides_event_file facts = {.width = 346, .height = 260, .run = "{\"stop\": 1}", .seed = "1"};

enum { CHUNK = 65536, STREAM = 400000 };

static const char *with(folder *f, const char *name, char out[700]) {
    snprintf(out, 700, "%s", in_folder(f, name));
    return out;
}

static void expect_ok(tides_status status, const tides_error *error) {
    if (status != TIDES_OK) fail_msg("%s", error->text);
}

static void expect_same_datasets(const char *a, const char *b) {
    static const char *const names[] = {"/events/t", "/events/t_ns", "/events/p", "/events/x", "/events/y", "/ms_to_idx"};
    for (size_t c = 0; c < sizeof names / sizeof *names; c++) {
        size_t n = 0, m = 0;
        int64_t *x = dataset_values(a, names[c], &n), *y = dataset_values(b, names[c], &m);
        assert_int_equal(n, m);
        assert_memory_equal(x, y, n * sizeof *x);
        free(x);
        free(y);
    }
}

/* -- children that die ----------------------------------------------------------------------------------------------------- */

/* What a child does: goes on at `from`, appends in portions and flushes now and then, up to `to`; tells each flushed count. */
typedef struct errand {
    const char *path;
    const tides_event *events;
    size_t from, to;
    uint64_t seed;
    int ends[2];
} errand;

/* Returns the exit code. */
static int run_errand(const errand *e) {
    tides_event_writer *writer = NULL;
    uint64_t random = e->seed;
    size_t done = e->from;
    tides_status status = e->from ? tides_event_writer_resume(e->path, &facts, e->from, &writer, NULL)
                                  : tides_event_writer_open(e->path, NULL, &facts, &writer, NULL);
    if (status != TIDES_OK) return 2;
    while (done < e->to) {
        size_t portion = 1 + scene_next(&random) % 30000;
        if (portion > e->to - done) portion = e->to - done;
        if (tides_event_writer_append(writer, e->events + done, NULL, portion, NULL) != TIDES_OK) return 3;
        done += portion;
        if (scene_next(&random) % 3) continue;
        if (tides_event_writer_flush(writer, NULL) != TIDES_OK) return 4;
        if (write(e->ends[1], &done, sizeof done) != sizeof done) return 5;
    }
    if (scene_next(&random) % 2) tides_event_writer_abandon(writer);
    return 0;
}

/* Runs it, killed after `patience` ns where that isn't 0; returns the last count it told, or e->from. */
static size_t send(errand *e, long patience) {
    int status = -1;
    assert_int_equal(pipe(e->ends), 0);
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) _exit(run_errand(e));
    assert_true(child > 0);
    close(e->ends[1]);
    if (patience) {
        nanosleep(&(struct timespec){.tv_nsec = patience}, NULL);
        kill(child, SIGKILL);
    }
    size_t told = e->from, got;
    while (read(e->ends[0], &got, sizeof got) == sizeof got) told = got;
    close(e->ends[0]);
    assert_int_equal(waitpid(child, &status, 0), child);
    if (!(WIFSIGNALED(status) && patience)) assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    return told;
}

/* The .part holds the first events of the stream. */
static void check_part(const char *part, const tides_event *events) {
    tides_event_summary summary;
    tides_error error;
    expect_ok(tides_events_summary(part, &summary, &error), &error);
    assert_true(summary.count <= STREAM);
    assert_file_holds(part, events, (size_t)summary.count);
}

static void finish_rest(const char *path, const tides_event *events, size_t from) {
    tides_event_writer *writer = NULL;
    tides_error error;
    expect_ok(tides_event_writer_resume(path, &facts, from, &writer, &error), &error);
    assert_true(tides_event_writer_count(writer) == from);
    expect_ok(tides_event_writer_append(writer, events + from, NULL, STREAM - from, &error), &error);
    expect_ok(tides_event_writer_finish(writer, 0, &error), &error);
}

static void test_deaths_in_a_row(void **state) {
    folder *f = *state;
    char path[700], part[700], tail[700], whole[700];
    with(f, "e.h5", path);
    with(f, "e.h5.part", part);
    with(f, "e.h5.part.tail", tail);
    with(f, "whole.h5", whole);
    for (uint64_t trial = 0; trial < 6; trial++) {
        uint64_t random = 40 + trial;
        tides_event *events = random_events(random, STREAM, facts.width, facts.height, 30000000); /* several index chunks */
        write_all(whole, &facts, events, STREAM, 0);
        size_t at = 0;
        while (at < STREAM) {
            size_t ahead = 1 + scene_next(&random) % 150000;
            errand e = {path, events, at, at + ahead < STREAM ? at + ahead : STREAM, scene_next(&random), {0, 0}};
            size_t told = send(&e, 0);
            check_part(part, events);
            if (told == at && ahead > 100000) break;
            at = told;
            if (scene_next(&random) % 8 == 0) break;
        }
        if (!file_exists(part)) continue;
        finish_rest(path, events, at);
        expect_same_datasets(whole, path);
        assert_false(file_exists(part) || file_exists(tail));
        free(events);
    }
}

/* Killed wherever it hits: while appending, flushing, or resuming. TIDES_TEST_KILLS asks for more. */
static void test_kills(void **state) {
    folder *f = *state;
    char path[700], part[700], whole[700];
    with(f, "e.h5", path);
    with(f, "e.h5.part", part);
    with(f, "whole.h5", whole);
    const char *asked = getenv("TIDES_TEST_KILLS");
    long kills = asked ? strtol(asked, NULL, 10) : 40;
    uint64_t random = (uint64_t)time(NULL);
    print_message("seed %llu\n", (unsigned long long)random);
    tides_event *events = random_events(50, STREAM, facts.width, facts.height, 30000000);
    write_all(whole, &facts, events, STREAM, 0);
    size_t at = 0;
    for (long k = 0; k < kills; k++) {
        errand e = {path, events, at, STREAM, scene_next(&random), {0, 0}};
        size_t told = send(&e, 1000000 + (long)(scene_next(&random) % 50000000));
        if (told > 0) check_part(part, events);
        at = told < STREAM ? told : 0;
    }
    if (at == 0) {
        errand e = {path, events, 0, STREAM / 2, random, {0, 0}};
        at = send(&e, 0);
    }
    finish_rest(path, events, at);
    expect_same_datasets(whole, path);
    free(events);
}

/* -- places to cut --------------------------------------------------------------------------------------------------------- */

/* Around chunk borders; the state that resumes may be older than the last flush, by chunks too. */
static void test_cuts_around_chunks(void **state) {
    folder *f = *state;
    static const size_t cuts[] = {1, 100, CHUNK - 1, CHUNK, CHUNK + 1, 2 * CHUNK - 1, 2 * CHUNK, 3 * CHUNK + 7};
    static const size_t beyond[] = {0, 1, 1000, CHUNK - 1, CHUNK, 2 * CHUNK + 5};
    char path[700], whole[700];
    with(f, "e.h5", path);
    with(f, "whole.h5", whole);
    tides_event *events = random_events(60, STREAM, facts.width, facts.height, 900000);
    write_all(whole, &facts, events, STREAM, 0);
    for (size_t c = 0; c < sizeof cuts / sizeof *cuts; c++)
        for (size_t b = 0; b < sizeof beyond / sizeof *beyond; b++) {
            tides_event_writer *writer = NULL;
            tides_error error;
            expect_ok(tides_event_writer_open(path, NULL, &facts, &writer, &error), &error);
            expect_ok(tides_event_writer_append(writer, events, NULL, cuts[c], &error), &error);
            expect_ok(tides_event_writer_flush(writer, &error), &error);
            expect_ok(tides_event_writer_append(writer, events + cuts[c], NULL, beyond[b], &error), &error);
            if (b % 2) expect_ok(tides_event_writer_flush(writer, &error), &error);
            tides_event_writer_abandon(writer);
            finish_rest(path, events, cuts[c]);
            expect_same_datasets(whole, path);
        }
    free(events);
}

/* At the very beginning, too: nothing is kept. And a resumed file checks the order of events. */
static void test_from_nothing(void **state) {
    folder *f = *state;
    char path[700], whole[700];
    with(f, "e.h5", path);
    with(f, "whole.h5", whole);
    tides_event *events = random_events(61, STREAM, facts.width, facts.height, 900000);
    write_all(whole, &facts, events, STREAM, 0);
    tides_event_writer *writer = NULL;
    tides_error error;
    expect_ok(tides_event_writer_open(path, NULL, &facts, &writer, &error), &error);
    expect_ok(tides_event_writer_flush(writer, &error), &error);
    expect_ok(tides_event_writer_append(writer, events, NULL, 200000, &error), &error);
    tides_event_writer_abandon(writer);
    finish_rest(path, events, 0);
    expect_same_datasets(whole, path);
    for (size_t cut = 70000; cut <= 2 * CHUNK; cut += 2 * CHUNK - 70000) {
        expect_ok(tides_event_writer_open(path, NULL, &facts, &writer, &error), &error);
        expect_ok(tides_event_writer_append(writer, events, NULL, 200000, &error), &error);
        tides_event_writer_abandon(writer);
        expect_ok(tides_event_writer_resume(path, &facts, cut, &writer, &error), &error);
        assert_int_equal(tides_event_writer_append(writer, events + cut - 2, NULL, 1, &error), TIDES_BAD_ARGUMENT);
        assert_non_null(strstr(error.text, "comes before"));
        tides_event_writer_abandon(writer);
    }
    free(events);
}

/* The run's text may be another one: its stop was moved. */
static void test_run_text(void **state) {
    folder *f = *state;
    char path[700], text[64] = "";
    with(f, "e.h5", path);
    const tides_event_file other = {facts.width, facts.height, "{\"stop\": 2, \"more\": \"text than before\"}", "1", 0, 0, 0};
    tides_event_writer *writer = NULL;
    tides_error error;
    expect_ok(tides_event_writer_open(path, NULL, &facts, &writer, &error), &error);
    tides_event_writer_abandon(writer);
    expect_ok(tides_event_writer_resume(path, &other, 0, &writer, &error), &error);
    expect_ok(tides_event_writer_finish(writer, 1000, &error), &error);
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(td_h5_read_text(file, "run", text, sizeof text));
    H5Fclose(file);
    assert_string_equal(text, other.run);
}

/* -- what is refused ------------------------------------------------------------------------------------------------------- */

static void refuse(const char *path, const tides_event_file *file, uint64_t count, tides_status wanted, const char *words) {
    tides_event_writer *writer = NULL;
    tides_error error = {0};
    tides_status status = tides_event_writer_resume(path, file, count, &writer, &error);
    if (status != wanted || !strstr(error.text, words) || strchr(error.text, '\n'))
        fail_msg("%s: %s", tides_status_name(status), error.text);
    assert_null(writer);
}

static void test_refusals(void **state) {
    folder *f = *state;
    char path[700], part[700], tail[700];
    with(f, "e.h5", path);
    with(f, "e.h5.part", part);
    with(f, "e.h5.part.tail", tail);
    tides_event *events = random_events(70, STREAM, facts.width, facts.height, 900000);
    tides_event_file wide = facts;
    tides_event_writer *writer = NULL;
    tides_error error;
    size_t bytes, after;
    refuse(path, &facts, 0, TIDES_FILE_NOT_FOUND, "e.h5.part: can't be opened");
    refuse(NULL, &facts, 0, TIDES_BAD_ARGUMENT, "NULL");
    expect_ok(tides_event_writer_open(path, NULL, &facts, &writer, &error), &error);
    expect_ok(tides_event_writer_append(writer, events, NULL, 100000, &error), &error);
    expect_ok(tides_event_writer_flush(writer, &error), &error);
    refuse(path, &facts, 100000, TIDES_WRITE_FAILED, "written by another run"); /* it's still at work */
    tides_event_writer_abandon(writer);
    assert_false(file_exists(tail));
    char *kept = slurp(part, &bytes);
    wide.width = 400;
    refuse(path, &wide, 100000, TIDES_BAD_FILE, "holds 346 x 260 px, the run has 400 x 260");
    refuse(path, &facts, 100001, TIDES_BAD_FILE, "ends 1 events before event 100001");
    refuse(path, &facts, 2 * CHUNK, TIDES_BAD_FILE, "fewer than 131072 events");
    char *now = slurp(part, &after);
    assert_int_equal(bytes, after);
    assert_memory_equal(kept, now, bytes); /* all that left it alone */
    free(now);
    truncate(part, (off_t)(bytes / 2));
    refuse(path, &facts, 100000, TIDES_BAD_FILE, "e.h5.part");
    put_text(part, "no HDF5");
    refuse(path, &facts, 100, TIDES_BAD_FILE, "e.h5.part");
    refuse(path, &facts, 0, TIDES_BAD_FILE, "e.h5.part: can't be opened");
    free(kept);
    free(events);
}

/* A flush that fails costs nothing but itself. */
static void test_flush_fails(void **state) {
    folder *f = *state;
    char path[700], blocked[700];
    with(f, "e.h5", path);
    with(f, "e.h5.part.tail.part", blocked);
    tides_event *events = random_events(80, STREAM, facts.width, facts.height, 900000);
    tides_event_writer *writer = NULL;
    tides_error error;
    expect_ok(tides_event_writer_open(path, NULL, &facts, &writer, &error), &error);
    expect_ok(tides_event_writer_append(writer, events, NULL, 1000, &error), &error);
    assert_int_equal(mkdir(blocked, 0777), 0);
    assert_int_equal(tides_event_writer_flush(writer, &error), TIDES_WRITE_FAILED);
    assert_non_null(strstr(error.text, "e.h5.part.tail.part"));
    assert_int_equal(rmdir(blocked), 0);
    expect_ok(tides_event_writer_flush(writer, &error), &error);
    expect_ok(tides_event_writer_append(writer, events + 1000, NULL, STREAM - 1000, &error), &error);
    expect_ok(tides_event_writer_finish(writer, 0, &error), &error);
    assert_file_holds(path, events, STREAM);
    assert_int_equal(tides_event_writer_flush(NULL, &error), TIDES_BAD_ARGUMENT);
    free(events);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_deaths_in_a_row, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_kills, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_cuts_around_chunks, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_from_nothing, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_run_text, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_refusals, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_flush_fails, folder_setup, folder_teardown),
    };
    return cmocka_run_group_tests_name("events: resume", tests, NULL, NULL);
}
