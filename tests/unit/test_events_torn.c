/* Recordings whose process dies within a write. A signal that kills acts between two pages of a write, so that a piece of
 * metadata may be new on one page and old on the next. Here the process dies at each page of each write of a recording, and of
 * a resumed one. The .part must have the flushed events and lead to the same file. */
#include "test_events_common.h"

#include <sys/stat.h>

static const tides_event_file facts = {.width = 346, .height = 260, .run = "{\"stop\": 1}", .seed = "1"};

enum { CHUNK = 65536, STREAM = 3 * CHUNK + 1000, PAGE = 4096, DEAD = 77 };

/* -- the write that is torn ------------------------------------------------------------------------------------------------ */

static long points_left = -1;      /* until the process dies; below 0 it lives */
static const char *torn_file = ""; /* "": any */

static int32_t is_torn(int file) {
    struct stat its, asked;
    if (points_left < 0 || !*torn_file) return points_left >= 0;
    return fstat(file, &its) == 0 && stat(torn_file, &asked) == 0 && its.st_ino == asked.st_ino;
}

/* Where a write may end: before each of its pages; of many, the first three and the last. */
static size_t point_of(size_t point, size_t size, off_t at, size_t *points) {
    const size_t first = PAGE - (size_t)at % PAGE, pages = size > first ? 2 + (size - first - 1) / PAGE : 1;
    *points = pages < 4 ? pages : 4;
    const size_t page = point < 3 ? point : pages - 1;
    return page == 0 ? 0 : first + (page - 1) * PAGE;
}

static ssize_t put(int file, const void *data, size_t size, off_t at) {
    return lseek(file, at, SEEK_SET) == at ? write(file, data, size) : -1;
}

/* In place of the C library's: the driver of our HDF5 files writes with it alone. */
ssize_t pwrite(int file, const void *data, size_t size, off_t at) {
    size_t points = 0;
    point_of(0, size, at, &points);
    if (!is_torn(file)) return put(file, data, size, at);
    if ((size_t)points_left < points) {
        const size_t some = point_of((size_t)points_left, size, at, &points);
        _exit(some == 0 || put(file, data, some, at) == (ssize_t)some ? DEAD : 1);
    }
    points_left -= (long)points;
    return put(file, data, size, at);
}

/* -- a recording that dies ------------------------------------------------------------------------------------------------- */

typedef struct errand {
    const char *path;
    const tides_event *events;
    size_t from, to;
    int tell; /* where flushed counts go */
} errand;

/* Returns the exit code. */
static int run_errand(const errand *e) {
    enum { PORTION = CHUNK / 2 + 11 };
    tides_event_writer *writer = NULL;
    tides_status status = e->from ? tides_event_writer_resume(e->path, &facts, e->from, &writer, NULL)
                                  : tides_event_writer_open(e->path, NULL, &facts, &writer, NULL);
    if (status != TIDES_OK) return 2;
    for (size_t done = e->from, portion; done < e->to; done += portion) {
        portion = e->to - done < PORTION ? e->to - done : PORTION;
        if (tides_event_writer_append(writer, e->events + done, NULL, portion, NULL) != TIDES_OK) return 3;
        if (tides_event_writer_flush(writer, NULL) != TIDES_OK) return 4;
        const size_t flushed = done + portion;
        if (write(e->tell, &flushed, sizeof flushed) != sizeof flushed) return 5;
    }
    tides_event_writer_abandon(writer);
    return 0;
}

/* Runs it to its death at a point, or to its end where that comes first; `*told` becomes the last count that was flushed.
 * 1 where it died. */
static int send(errand *e, long point, size_t *told) {
    int ends[2], status = -1;
    size_t got;
    assert_int_equal(pipe(ends), 0);
    e->tell = ends[1];
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        points_left = point;
        _exit(run_errand(e));
    }
    assert_true(child > 0);
    close(ends[1]);
    *told = e->from;
    while (read(ends[0], &got, sizeof got) == sizeof got) *told = got;
    close(ends[0]);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    if (WEXITSTATUS(status) != DEAD) assert_int_equal(WEXITSTATUS(status), 0);
    return WEXITSTATUS(status) == DEAD;
}

/* What is there begins the stream, and holds the whole chunks of what was told; the rest is in the tail. */
static void check_part(const char *part, const tides_event *events, size_t told) {
    tides_event_summary summary;
    tides_error error;
    if (tides_events_summary(part, &summary, &error) != TIDES_OK) fail_msg("%s", error.text);
    if (summary.count < told / CHUNK * CHUNK || summary.count > STREAM)
        fail_msg("%zu events for %zu", (size_t)summary.count, told);
    assert_file_holds(part, events, (size_t)summary.count);
}

static void finish_rest(const char *path, const tides_event *events, size_t from) {
    tides_event_writer *writer = NULL;
    tides_error error;
    if (tides_event_writer_resume(path, &facts, from, &writer, &error) != TIDES_OK ||
        tides_event_writer_append(writer, events + from, NULL, STREAM - from, &error) != TIDES_OK ||
        tides_event_writer_finish(writer, 0, &error) != TIDES_OK)
        fail_msg("%s", error.text);
    assert_file_holds(path, events, STREAM);
}

/* All points of all files, the tail's too, with TIDES_FAULTS=all: minutes. */
static int32_t wants_all(void) {
    const char *asked = getenv("TIDES_FAULTS");
    return asked && strcmp(asked, "all") == 0;
}

/* From nothing to the end, or with `from` above 0 gone on with from there, once as much as `held` had been recorded. */
static void sweep(folder *f, size_t from, size_t held) {
    char path[700], part[700];
    snprintf(path, sizeof path, "%s", in_folder(f, "e.h5"));
    snprintf(part, sizeof part, "%s", in_folder(f, "e.h5.part"));
    tides_event *events = random_events(70, STREAM, facts.width, facts.height, 900000);
    const long stride = wants_all() ? 1 : 7;
    long point = 0, died = 0;
    if (!wants_all()) torn_file = part;
    for (int dead = 1; dead; point += stride) {
        errand before = {path, events, 0, held, 0}, e = {path, events, from, STREAM, 0};
        size_t told = 0;
        if (from) assert_false(send(&before, -1, &told));
        dead = send(&e, point, &told);
        died += dead;
        if (told == 0) continue; /* not yet begun: there is nothing to lose */
        check_part(part, events, told);
        finish_rest(path, events, told);
    }
    print_message("%ld deaths at points 0 to %ld\n", died, point);
    assert_true(died > 5);
    free(events);
}

static void test_recording(void **state) { sweep(*state, 0, 0); }

/* From within the second chunk, where the third had been begun: the .part is cut back. */
static void test_resumed(void **state) { sweep(*state, CHUNK + 900, 2 * CHUNK + 5000); }

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_recording, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(test_resumed, folder_setup, folder_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
