/* `tides bench calibrate`: known sensors are simulated, and measured again from their events. */
#ifndef CLI_BENCH_CALIBRATE_H
#define CLI_BENCH_CALIBRATE_H

#include "bench.h"

enum { BENCH_CALIBRATE_SENSORS = 40 };
/* Names of the scenes, NULL-terminated: "demo", and "slider_depth" and "trained_srgb" of $TIDES_SHARED. In bench_calibrate any
 * other name is the path of a run file. */
const char *const *bench_calibrate_names(void);
tides_status bench_calibrate(bench *b, const cli_list *scenes, tides_error *error);

#endif
