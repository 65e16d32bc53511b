/* Internal: bias settings of cameras: what files of them hold, and what that is in units of a pixel. */
#ifndef TD_BIASES_H
#define TD_BIASES_H

#include "td_base.h"

/* DAVIS: coarse and fine. DVS128: a code of 24 bits. PROPHESEE: codes, millivolts or offsets, by chip, which files don't
 * tell. */
enum { TD_BIASES_DAVIS = 1, TD_BIASES_DVS128 = 2, TD_BIASES_PROPHESEE = 3 };

enum { TD_BIASES_MAX = 64, TD_BIAS_NAME = 40 };

typedef struct td_bias {
    char name[TD_BIAS_NAME];
    double current_a; /* of DAVIS and DVS128 [A] */
    int32_t value;    /* as the file has it: fine, or the code; -1: not said */
    int32_t coarse;   /* 0 is the smallest; -1: not said */
} td_bias;

typedef struct td_biases {
    int32_t kind; /* TD_BIASES_* */
    int32_t count;
    td_bias bias[TD_BIASES_MAX];
} td_biases;

/* Metavision's camera settings (.json), .bias, jAER's preferences (.xml, and in the header of .aedat 2), rpg_dvs_ros' .yaml; by
 * content. TIDES_BAD_FILE: none of these, or without a bias in it. */
TIDES_MUST_CHECK tides_status td_biases_read(const char *path, td_biases *biases, tides_error *error);

/* By name, whatever its case; NULL where the file has none. */
const td_bias *td_biases_find(const td_biases *biases, const char *name);

/* Values of a pixel from the biases of a DAVIS or a DVS128, by the formulas of biases_law.c; 0: the file doesn't say, or no
 * formula holds. */
typedef struct td_bias_units {
    double threshold_on, threshold_off; /* [log units] */
    double refractory_s;                /* [s] */
    double cutoff_hz;                   /* [Hz] */
    int32_t limited; /* 1: the photoreceptor and not its follower is the slower, of which there is no formula */
    int32_t off;     /* 1: the OFF bias is off (fine 0), and taken as fine 1 */
} td_bias_units;
td_bias_units td_biases_units(const td_biases *biases);

#endif
