/* Internal: names of the lens models in files and keys, and their coefficients. */
#ifndef TD_LENS_MODELS_H
#define TD_LENS_MODELS_H

#include "tides/camera.h"

enum { TD_COEFFICIENTS_MAX = 6 };

typedef struct td_lens_model {
    const char *name; /* in camera.lens, in path files, and in Kalibr's */
    const char *ros;  /* in ROS' sensor_msgs/CameraInfo */
    int count;        /* number of coefficients, in OpenCV's order */
    const char *key[TD_COEFFICIENTS_MAX];
} td_lens_model;

/* The coefficients of all models, as keys: "k1" ... "p2". */
extern const char *const td_lens_key[TD_COEFFICIENTS_MAX];
/* A coefficient's place in a lens, by its number in td_lens_key. */
double *td_lens_at(tides_lens *lens, int number);

/* The row of a TIDES_LENS_* value; NULL if unknown. */
const td_lens_model *td_lens_model_of(int32_t model);

/* The TIDES_LENS_* value of a name; -1 if unknown. */
int32_t td_lens_named(const char *name);

/* Lists the coefficients of a lens in its model's order, followed by zeros; returns their number. */
int td_lens_list(const tides_lens *lens, double numbers[TD_COEFFICIENTS_MAX]);

/* 1 if the model has a coefficient of this name, such as "k4". */
int td_lens_has(int32_t model, const char *key);

/* Names the coefficients in a sentence: "k1, k2, p1, p2 and k3". */
enum { TD_LENS_WORDS = 128 };
const char *td_lens_keys(int32_t model, char text[TD_LENS_WORDS]);

/* Names the lenses with a distortion in a sentence: "radtan or equidistant". */
const char *td_lens_choices(char text[TD_LENS_WORDS]);

#endif
