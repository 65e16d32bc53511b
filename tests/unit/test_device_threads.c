/* Several threads open devices at once, in processes that haven't loaded OpenCL's drivers before: each round is this program
 * again, as a child. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tides/device.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* Without the library's lock 3 rounds in 10 failed with two threads: 20 without one are 1 chance in 1000. */
enum { ROUNDS = 20, THREADS = 2 };
enum { ALL_OPENED = 0, SOME_FAILED = 1 };
static const char in_threads[] = "--in-threads"; /* argument of the child */

typedef struct opener {
    pthread_barrier_t *gate;
    tides_device *device;
    tides_device_info info;
    tides_error error;
    tides_status status;
} opener;

static void *open_at_once(void *user) {
    opener *one = user;
    pthread_barrier_wait(one->gate);
    one->status = tides_device_open("auto", &one->device, &one->error);
    if (one->status == TIDES_OK) tides_device_describe(one->device, &one->info);
    return NULL;
}

/* In the child. */
static int open_in_threads(void) {
    opener one[THREADS] = {{.device = NULL}};
    pthread_t thread[THREADS];
    pthread_barrier_t gate;
    int code = ALL_OPENED;
    if (pthread_barrier_init(&gate, NULL, THREADS)) return SOME_FAILED;
    for (int i = 0; i < THREADS; i++) {
        one[i].gate = &gate;
        if (pthread_create(&thread[i], NULL, open_at_once, &one[i])) return SOME_FAILED;
    }
    for (int i = 0; i < THREADS; i++) {
        pthread_join(thread[i], NULL);
        if (one[i].status != TIDES_OK) fprintf(stderr, "thread %d: %s\n", i, one[i].error.text);
        if (one[i].status != TIDES_OK || one[i].info.index != one[0].info.index) code = SOME_FAILED;
        tides_device_close(one[i].device);
    }
    pthread_barrier_destroy(&gate);
    return code;
}

/* What the child returns; 128 + signal where it crashed. */
static int in_child(char *program) {
    int result = -1;
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        char *arguments[] = {program, (char *)(uintptr_t)in_threads, NULL};
        execv(program, arguments);
        _exit(127);
    }
    assert_true(waitpid(child, &result, 0) == child);
    return WIFEXITED(result) ? WEXITSTATUS(result) : 128 + WTERMSIG(result);
}

static void test_threads_open_the_first_device_at_once(void **state) {
    int32_t count = 0;
    assert_int_equal(tides_device_list(NULL, 0, &count, NULL), TIDES_OK);
    if (count == 0) {
        print_message("skipped: this machine has no OpenCL device\n");
        skip();
    }
    for (int i = 0; i < ROUNDS; i++) assert_int_equal(in_child(*state), ALL_OPENED);
}

int main(int argc, char **argv) {
    if (argc > 1 && strcmp(argv[1], in_threads) == 0) return open_in_threads();
    const struct CMUnitTest tests[] = {cmocka_unit_test_prestate(test_threads_open_the_first_device_at_once, argv[0])};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
