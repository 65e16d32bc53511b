/* Detects processes that fork after they used OpenCL: PyTorch's DataLoader with workers, multiprocessing's default on Linux.
 * Without this check, the child hangs for ever in its first clFinish (PoCL 3.1).
 *
 * This state belongs to the process, so it is in variables outside any object; the library has no others. */
#include "td_forked.h"

#include <pthread.h>

static pthread_mutex_t loading = PTHREAD_MUTEX_INITIALIZER;
static int32_t loaded, forked; /* written with the mutex held, or in a child that has one thread */

static void before_fork(void) { pthread_mutex_lock(&loading); }
static void in_parent(void) { pthread_mutex_unlock(&loading); }
static void in_child(void) {
    forked = loaded;
    pthread_mutex_unlock(&loading);
}

void td_drivers_lock(void) {
    pthread_mutex_lock(&loading);
    if (!loaded) loaded = pthread_atfork(before_fork, in_parent, in_child) == 0;
}

void td_drivers_unlock(void) { pthread_mutex_unlock(&loading); }

int32_t td_is_forked(void) { return forked; }

tides_status td_check_forked(tides_error *error) {
    if (!forked) return TIDES_OK;
    return td_fail(error, TIDES_NO_DEVICE,
                   "this process was forked from one that had used OpenCL, whose drivers don't survive that: start it anew "
                   "(fork and exec; Python: multiprocessing_context=\"spawn\" or \"forkserver\"), or open devices after the "
                   "fork only, or take the device \"reference\"");
}
