/* Internal: what the readers of path files share. A reader appends samples; td_path_parse does the rest. */
#ifndef TD_PATH_H
#define TD_PATH_H

#include "tides/camera.h"

#include <cjson/cJSON.h>

/* One pose of a file. Its time is `time` + `low` until `start` has been subtracted: stamps of 1e9 s with nanoseconds need 60
 * bits of mantissa, of which a double has 53, so that text formats keep what the double loses. */
typedef struct td_path_sample {
    tides_pose_sample pose; /* its time isn't set yet */
    double time, low;       /* [s] */
    size_t place;           /* line number, or index in the file's list */
} td_path_sample;

typedef struct td_path_reader {
    const char *file; /* for messages */
    const char *text; /* terminated */
    size_t bytes;
    const tides_path_options *options;
    td_path_sample *samples;
    size_t count, capacity;
    const char *list; /* the JSON list that `place` indexes ("frames"); NULL: `place` is a line */
    tides_path path;  /* what has been read so far; a generator sets the trajectory itself */
    tides_error *error;
} td_path_reader;

/* Reads `bytes` of a path file that end in a NUL; `file` is for messages. What tides_path_load does once it has the bytes. */
tides_status td_path_parse(const char *file, const char *text, size_t bytes, const tides_path_options *options,
                           tides_path *path, tides_error *error);

/* A new sample at the end, zeroed; NULL: out of memory. */
td_path_sample *td_path_append(td_path_reader *reader, size_t place);

/* Time of `sample` since that of `origin` [s]. */
double td_path_since(const td_path_sample *sample, const td_path_sample *origin);

/* The time that `start` and `rebase` put at 0, for a file whose first sample is `first`. */
td_path_sample td_path_origin(const td_path_reader *reader, const td_path_sample *first);

/* Gives the samples even times over [0, duration], for files without times. */
void td_path_spread(td_path_reader *reader);

/* One reader per format. */
tides_status td_path_read_text(td_path_reader *reader);
tides_status td_path_read_tides(td_path_reader *reader, const cJSON *root);
tides_status td_path_read_transforms(td_path_reader *reader, const cJSON *root);
tides_status td_path_read_cameras(td_path_reader *reader, const cJSON *root);

/* -- JSON: `where` is the path of `object` ("frames[3]", "" for the root); failures name file, path and key ------------- */

cJSON *td_json_parse(td_path_reader *reader);
tides_status td_json_number(td_path_reader *reader, const cJSON *object, const char *where, const char *key, double *value);
tides_status td_json_vector(td_path_reader *reader, const cJSON *object, const char *where, const char *key, double *values,
                            int count);

/* A row-major matrix. */
tides_status td_json_matrix(td_path_reader *reader, const cJSON *object, const char *where, const char *key, double *values,
                            int rows, int columns);

/* Number of pixels: a whole number, at least 1. */
tides_status td_json_pixels(td_path_reader *reader, const cJSON *object, const char *where, const char *key, int32_t *value);

int td_json_has(const cJSON *object, const char *key);

/* `object` is an object with no other keys than `keys` (NULL-terminated), each once. */
tides_status td_json_check_keys(td_path_reader *reader, const cJSON *object, const char *where, const char *const *keys);

/* Fails with TIDES_BAD_FILE and "FILE: WHERE.KEY: TEXT". */
tides_status td_json_fail(td_path_reader *reader, const char *where, const char *key, const char *text);

/* A word of the file for a message: at most TD_QUOTE - 1 characters, control characters replaced, so that the message stays
 * one line. Returns `out`. */
#define TD_QUOTE 41
const char *td_path_quote(const char *word, size_t bytes, char out[TD_QUOTE]);

/* Quaternion of a 3x3 rotation of a file; fails where it isn't one. */
tides_status td_json_rotation(td_path_reader *reader, const char *where, const char *key, const double rotation[9],
                              double q[4]);

/* Keeps in `common` what all samples share: a field that differs from the first sample's becomes 0. */
void td_path_share_intrinsics(tides_intrinsics *common, const tides_intrinsics *other, int first);

#endif
