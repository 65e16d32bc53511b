/* Internal: the classes of the motion models, and what their files share. */
#ifndef TD_MODELS_H
#define TD_MODELS_H

#include "td_motion.h"

extern const td_motion_class td_polynomial_class;
extern const td_motion_class td_rotor_class;
extern const td_motion_class td_keyframes_class;
extern const td_motion_class td_callback_class;

/* Adds a copy of a caller's array of `rank` extents; NULL, NaN or Inf: TIDES_BAD_ARGUMENT naming it. */
tides_status td_motion_copy_field(tides_motion *motion, const char *name, int rank, const uint64_t *shape, const float *value,
                                  tides_error *error);

/* A field of one row per Gaussian: (count) where `width` is 1, else (count x width). */
tides_status td_motion_copy_rows(tides_motion *motion, const char *name, int64_t count, int width, const float *value,
                                 tides_error *error);
tides_status td_motion_need_rows(const tides_motion *motion, const char *name, int64_t count, int width, const td_field **field,
                                 tides_error *error);

/* `rows` zeroed rows of `stride` reals, as many as 32-bit indices reach: TIDES_UNSUPPORTED for more. */
tides_status td_mover_create_rows(td_mover_numbers *numbers, const char *model, int64_t rows, int64_t stride,
                                  tides_error *error);

/* 1 / (1 + e^-x) in double. */
double td_sigmoid(double x);

/* `motion` is kept where `status` is TIDES_OK, else destroyed: how constructors end. */
tides_status td_motion_finish(tides_status status, tides_motion *made, tides_motion **motion);

#endif
