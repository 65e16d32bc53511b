/* The reference in double precision once more, for processors with fused multiply-add (td_fused.h). */
#include "td_fused.h"

#ifdef TD_FUSED
TD_FUSED_BEGIN
#define TD_REAL_DOUBLE
#define TD_REFERENCE_CREATE td_backend_create_f64_fused
#include "reference_body.h"
TD_FUSED_END
#endif
