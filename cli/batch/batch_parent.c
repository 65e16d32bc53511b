/* Makes a process end with its parent: a batch or a worker that is killed leaves no runs behind. They continue from their
 * checkpoints when they are started again. */
#include "batch.h"

#include <signal.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

tides_status batch_end_with(pid_t parent, tides_error *error) {
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() == parent) return TIDES_OK; /* else the parent ended before prctl was called, or isn't `parent` */
    return cli_error(error, TIDES_BAD_ARGUMENT, "process %ld isn't the one that started this", (long)parent);
#else
    (void)parent;
    return cli_error(error, TIDES_UNSUPPORTED, "this system can't end a process with the one that started it");
#endif
}
