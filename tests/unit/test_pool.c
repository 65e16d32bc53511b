/* The pool of threads: each part is done once, with any number of threads; one thread starts none; a forked child works
 * without. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "td_pool.h"

#include <pthread.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PARTS = 500 };

typedef struct counting {
    int done[PARTS];
    pthread_t caller, by[PARTS];
} counting;

static void count_part(void *user, int k) {
    counting *c = user;
    c->done[k]++;
    c->by[k] = pthread_self();
}

static void run(td_pool *pool, counting *c, int parts) {
    memset(c, 0, sizeof *c);
    c->caller = pthread_self();
    td_pool_run(pool, parts, count_part, c);
    for (int k = 0; k < PARTS; k++) assert_int_equal(c->done[k], k < parts);
}

static void test_every_part_once(void **state) {
    static const int threads[] = {1, 2, 4, 7};
    (void)state;
    for (size_t i = 0; i < sizeof threads / sizeof *threads; i++) {
        td_pool *pool = NULL;
        counting c;
        assert_int_equal(td_pool_create(threads[i], &pool, NULL), TIDES_OK);
        for (int round = 0; round < 200; round++) run(pool, &c, round % PARTS);
        run(pool, &c, PARTS);
        for (int k = 0; k < PARTS && threads[i] == 1; k++) assert_true(pthread_equal(c.by[k], c.caller));
        assert_true(threads[i] > 1 ? td_pool_shared_time(pool) > 0 : !(td_pool_shared_time(pool) > 0));
        td_pool_release(pool);
    }
}

static void test_without_a_pool(void **state) {
    counting c;
    (void)state;
    run(NULL, &c, PARTS);
    assert_int_equal(td_pool_threads(NULL), 1);
    td_pool_release(NULL);
}

/* Portions cover all things once, in order, and none is shared out that isn't worth it. */
static void test_portions(void **state) {
    td_pool *pool = NULL;
    (void)state;
    assert_int_equal(td_pool_create(3, &pool, NULL), TIDES_OK);
    assert_int_equal(td_pool_portions(NULL, 1000, 1), 1);
    assert_int_equal(td_pool_portions(pool, 19, 10), 1);
    assert_int_equal(td_pool_portions(pool, 20, 10), 2);
    assert_int_equal(td_pool_portions(pool, 1000000, 10), 12);
    assert_int_equal(td_pool_begin(1000, 12, 0), 0);
    for (int k = 0; k < 12; k++) assert_true(td_pool_begin(1000, 12, k) < td_pool_begin(1000, 12, k + 1));
    assert_int_equal(td_pool_begin(1000, 12, 12), 1000);
    td_pool_release(pool);
}

/* The parent's threads aren't there: the child does the work by itself, and ends. */
static void test_a_child_does_without(void **state) {
    td_pool *pool = NULL;
    counting c;
    int ended = 0;
    (void)state;
    assert_int_equal(td_pool_create(4, &pool, NULL), TIDES_OK);
    run(pool, &c, PARTS);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        memset(&c, 0, sizeof c);
        alarm(20);
        td_pool_run(pool, PARTS, count_part, &c);
        td_pool_release(pool);
        _exit(c.done[0] == 1 && c.done[PARTS - 1] == 1 ? 0 : 1);
    }
    assert_int_equal(waitpid(child, &ended, 0), child);
    assert_true(WIFEXITED(ended) && WEXITSTATUS(ended) == 0);
    run(pool, &c, PARTS);
    td_pool_release(pool);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_part_once),
        cmocka_unit_test(test_without_a_pool),
        cmocka_unit_test(test_portions),
        cmocka_unit_test(test_a_child_does_without),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
