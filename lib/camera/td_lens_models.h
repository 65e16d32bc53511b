/* Internal: the models of lenses as files and keys know them: names, and the order of their coefficients. kernels/lens.h has
 * their effect on light. */
#ifndef TD_LENS_MODELS_H
#define TD_LENS_MODELS_H

#include "tides/camera.h"

enum { TD_COEFFICIENTS_MAX = 6 };

typedef struct td_lens_model {
    const char *name; /* of camera.lens, of path files, and Kalibr's */
    const char *ros;  /* of sensor_msgs/CameraInfo */
    int count;        /* of coefficients, in OpenCV's order: */
    const char *key[TD_COEFFICIENTS_MAX];
    size_t field[TD_COEFFICIENTS_MAX]; /* in tides_lens */
} td_lens_model;

/* The row of TIDES_LENS_*; NULL: it is none of them. */
const td_lens_model *td_lens_model_of(int32_t model);

/* TIDES_LENS_* of a name; -1: it is none. */
int32_t td_lens_named(const char *name);

/* The coefficients of a lens in its model's order, zeros behind them; how many it has. */
int td_lens_list(const tides_lens *lens, double numbers[TD_COEFFICIENTS_MAX]);

/* Whether a model has the coefficient "k4". */
int td_lens_has(int32_t model, const char *key);

/* "k1, k2, p1, p2 and k3" */
enum { TD_LENS_WORDS = 64 };
const char *td_lens_keys(int32_t model, char text[TD_LENS_WORDS]);

#endif
