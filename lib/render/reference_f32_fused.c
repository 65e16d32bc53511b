/* The single-precision reference, compiled for processors with fused multiply-add: faster, with the same bits. */
#include "td_fused.h"

#ifdef TD_FUSED
TD_FUSED_BEGIN
#define TD_REFERENCE_CREATE td_backend_create_f32_fused
#include "reference_body.h"
TD_FUSED_END
#endif
