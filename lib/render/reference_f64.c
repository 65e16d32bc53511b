/* The reference in double precision: the arbiter of truth (DESIGN 7). */
#define TD_REAL_DOUBLE
#define TD_REFERENCE_CREATE td_backend_create_f64
#include "reference_body.h"
