/* The motion models of kernels/ in single precision. */
#define MOTION_ROWS motion_plain_f32
#include "tests/support/motion_rows_body.h"
