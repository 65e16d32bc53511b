/* The motion models of kernels/ in double precision, one Gaussian at a time. */
#define TD_REAL_DOUBLE
#define MOVE move_f64
#include "tests/support/move_body.h"
