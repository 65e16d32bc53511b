/* The functions of kernels/ in double precision, one Gaussian at a time. */
#define TD_REAL_DOUBLE
#define GOLDEN_PROJECT golden_project_f64
#define GOLDEN_TILE golden_tile_f64
#include "tests/support/golden_project_body.h"
