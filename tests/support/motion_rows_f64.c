/* The motion models of kernels/ in double precision. */
#define TD_REAL_DOUBLE
#define MOTION_ROWS motion_plain_f64
#include "tests/support/motion_rows_body.h"
