/* Internal: bias settings of cameras: reads their files, and converts them to units of a pixel. */
#ifndef TD_BIASES_H
#define TD_BIASES_H

#include "td_base.h"

#include <cjson/cJSON.h>

/* DAVIS: coarse and fine values. DVS128: codes of 24 bits. PROPHESEE: codes, millivolts or offsets; which depends on the
 * chip, and files don't name it. */
enum { TD_BIASES_DAVIS = 1, TD_BIASES_DVS128 = 2, TD_BIASES_PROPHESEE = 3 };

enum { TD_BIASES_MAX = 64, TD_BIAS_NAME = 40 };

typedef struct td_bias {
    char name[TD_BIAS_NAME];
    double current_a; /* for DAVIS and DVS128 [A] */
    int32_t value;    /* in the file: the fine value, or the code; -1: missing */
    int32_t coarse;   /* 0 is the smallest; -1: missing */
} td_bias;

typedef struct td_biases {
    int32_t kind; /* TD_BIASES_* */
    int32_t count;
    td_bias bias[TD_BIASES_MAX];
    cJSON *settings; /* Metavision's settings as a whole; NULL: another format */
} td_biases;

/* Reads Metavision's camera settings (.json), .bias files, jAER's preferences (.xml, and in the header of .aedat 2), or
 * rpg_dvs_ros' .yaml; the content tells which. TIDES_BAD_FILE: none of these, or no bias in it. Call td_biases_free after a
 * failure, too. */
TIDES_MUST_CHECK tides_status td_biases_read(const char *path, td_biases *biases, tides_error *error);
void td_biases_free(td_biases *biases);

/* Finds a bias by name, in any case; NULL if it is missing. */
const td_bias *td_biases_find(const td_biases *biases, const char *name);

/* Values of a pixel from the biases of a DAVIS or a DVS128, by jAER's formulas; 0: the file lacks a bias, or no formula
 * holds. */
typedef struct td_bias_units {
    double threshold_on, threshold_off; /* [log units] */
    double refractory_s;                /* [s] */
    double cutoff_hz;                   /* [Hz] */
    int32_t limited;                    /* 1: the photoreceptor, for which there is no formula, is slower than its follower */
    int32_t off;                        /* 1: the OFF bias is off (fine 0), and read as fine 1 */
} td_bias_units;
td_bias_units td_biases_units(const td_biases *biases);

#endif
