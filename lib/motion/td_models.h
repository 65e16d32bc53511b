/* Internal: the classes of the motion models, and helpers for their files. */
#ifndef TD_MODELS_H
#define TD_MODELS_H

#include "td_motion.h"

extern const td_motion_class td_polynomial_class;
extern const td_motion_class td_rotor_class;
extern const td_motion_class td_keyframes_class;
extern const td_motion_class td_callback_class;

/* Adds a copy of a caller's array with `rank` extents. TIDES_BAD_ARGUMENT names an array that is NULL or has NaN or Inf. */
tides_status td_motion_copy_field(tides_motion *motion, const char *name, int rank, const uint64_t *shape, const float *value,
                                  tides_error *error);

/* Add, or find, a field with a row per Gaussian: its shape is (count) if `width` is 1, else (count x width). */
tides_status td_motion_copy_rows(tides_motion *motion, const char *name, int64_t count, int width, const float *value,
                                 tides_error *error);
tides_status td_motion_need_rows(const tides_motion *motion, const char *name, int64_t count, int width, const td_field **field,
                                 tides_error *error);

/* Allocates `rows` zeroed rows of `stride` reals; TIDES_UNSUPPORTED if 32-bit indices don't reach them. */
tides_status td_mover_create_rows(td_mover_numbers *numbers, const char *model, int64_t rows, int64_t stride,
                                  tides_error *error);

/* 1 / (1 + e^-x) in double. */
double td_sigmoid(double x);

/* Ends a constructor: hands out the motion if `status` is TIDES_OK, otherwise destroys it. */
tides_status td_motion_finish(tides_status status, tides_motion *made, tides_motion **motion);

#endif
