/* The part of `tides bench live` about ROS 2: tides.ros2_bench of the Python package sends packets of events to another process
 * and times them. TIDES_PYTHON names the interpreter. The `tides` that the package installs sets it: any other interpreter may
 * have no TIDES, or another version. */
#include "bench.h"

#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

/* Whether Python ended without an error. Its messages go to stderr, to the user. */
static int32_t run_python(const char *python, const char *file, int32_t packets) {
    char count[16];
    int ended = 0;
    snprintf(count, sizeof count, "%d", (int)packets);
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        execlp(python, python, "-m", "tides.ros2_bench", "--json", file, "--packets", count, (char *)NULL);
        _exit(CLI_FAILED);
    }
    return child > 0 && waitpid(child, &ended, 0) == child && WIFEXITED(ended) && WEXITSTATUS(ended) == 0;
}

tides_status bench_feed(const bench *b, int32_t packets, cJSON **rows, tides_error *error) {
    const char *python = getenv("TIDES_PYTHON");
    char file[4200];
    size_t size = 0;
    *rows = NULL;
    tides_status status = bench_path(b, "live_ros2", ".json", file, sizeof file, error);
    if (status != TIDES_OK) return status;
    const char *why = !python || !*python                  ? "no TIDES_PYTHON names a Python that has this package"
                      : !run_python(python, file, packets) ? "its measurement failed"
                                                           : NULL;
    char *text = why ? NULL : cli_read_file(file, &size);
    *rows = text ? cJSON_ParseWithLength(text, size) : NULL;
    free(text);
    if (!*rows && !b->common->quiet)
        cli_failed("bench live: the ROS 2 feed isn't in the table: %s. pip install 'tides[ros2]', then run that `tides`",
                   why ? why : "its results can't be read");
    return TIDES_OK;
}
