/* tides bench calibrate. */
#ifndef CLI_BENCH_CALIBRATE_H
#define CLI_BENCH_CALIBRATE_H

#include "bench.h"

enum { BENCH_CALIBRATE_SENSORS = 40 };
/* "demo", "slider_depth", "trained_srgb" (both of $TIDES_SHARED); another name is a run file. NULL-terminated. */
const char *const *bench_calibrate_names(void);
tides_status bench_calibrate(bench *b, const cli_list *scenes, tides_error *error);

#endif
