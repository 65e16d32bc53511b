/* The functions of kernels/ in single precision, one Gaussian at a time. */
#define GOLDEN_PROJECT golden_project_f32
#define GOLDEN_TILE golden_tile_f32
#include "tests/support/golden_project_body.h"
