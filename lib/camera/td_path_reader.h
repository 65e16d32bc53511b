/* Internal: helpers shared by the readers of path files. A reader appends samples; td_path_parse calls it and does the rest. */
#ifndef TD_PATH_READER_H
#define TD_PATH_READER_H

#include "tides/camera.h"

#include "td_base.h"

#include <cjson/cJSON.h>

/* A pose of a file. Its time is `time` + `low` until `start` is subtracted. A stamp of 1e9 s with nanoseconds needs 60 bits
 * of mantissa, and a double has 53: `low` is the rest. */
typedef struct td_path_sample {
    tides_pose_sample pose; /* its time isn't set yet */
    double time, low;       /* [s] */
    size_t place;           /* line number, or index in the file's list */
    size_t view;            /* 1 + index of its camera among the reader's views; 0: not in the file */
    const char *word;       /* text in the file: picture's name, or digits of its time; valid while reading; NULL: none */
    size_t length;          /* of that word */
} td_path_sample;

/* The camera of one pose. */
typedef struct td_path_view {
    tides_intrinsics intrinsics;
    double field_of_view_x; /* [rad] */
    int32_t distorted;
} td_path_view;

typedef struct td_path_reader {
    const char *file; /* for messages */
    const char *text; /* with a NUL at its end */
    size_t bytes;
    const tides_path_options *options;
    td_path_sample *samples;
    size_t count, capacity;
    td_path_view *views;
    size_t view_count, view_capacity;
    int is_open;      /* 1: the samples are an open path's, with a cubic between each two */
    int spread;       /* 1: the file has no times, so the kept samples are spread evenly */
    const char *list; /* the JSON list that `place` indexes ("frames"); NULL: `place` is a line */
    tides_path path;  /* the result so far; a generator sets the trajectory itself */
    tides_error *error;
} td_path_reader;

/* Reads `bytes` of a path file, with a NUL behind them; `file` is for messages. */
tides_status td_path_parse(const char *file, const char *text, size_t bytes, const tides_path_options *options,
                           tides_path *path, tides_error *error);

/* -- samples -- */

/* Appends a zeroed sample; NULL if memory is short. */
td_path_sample *td_path_append(td_path_reader *reader, size_t place);

/* Time of `sample` since that of `origin` [s]. */
double td_path_since(const td_path_sample *sample, const td_path_sample *origin);

/* The time that becomes 0 by the options `start` and `rebase`, for a file whose first sample is `first`. */
td_path_sample td_path_origin(const td_path_reader *reader, const td_path_sample *first);

#define TD_LARGEST_PATH ((size_t)1 << 30) /* [bytes] of a file: days of poses at 200 Hz */

/* Sorts the samples by time, then by place. */
void td_path_sort(td_path_reader *reader);

/* Marks a file without times: the samples that are kept get even times over [0, duration]. */
void td_path_spread(td_path_reader *reader);

/* -- order -- */

/* Adds a line to path.notes: a fact that the user may not expect. */
void td_path_note(td_path_reader *reader, const char *format, ...) TD_PRINTF(2, 3);

/* Compares names, with digits as numbers (2 before 10): below 0, 0, or above 0. */
int td_path_compare_names(const char *a, size_t a_length, const char *b, size_t b_length);

/* For files without times: sorts samples by name if all have one, then spreads them evenly over the duration. `say`: adds a
 * note if that changed the file's order. */
void td_path_order(td_path_reader *reader, int say);

/* Sets the sample's picture name to the text at `key` of `object`. */
void td_path_set_name(td_path_sample *sample, const cJSON *object, const char *key);

/* Moves the samples to the frame of nerfstudio's trainer, if options.frame or the file's folder has a
 * dataparser_transforms.json. `root` (may be NULL) is the transforms.json, which says what was already applied. */
tides_status td_path_apply_frame(td_path_reader *reader, const cJSON *root);

/* Adds a note if poses leap, once all times are known; TIDES_NO_MEMORY. */
tides_status td_path_note_leaps(td_path_reader *reader);

/* Formats a place in the file: "FILE:12" or "FILE: frames[12]"; if `file` is NULL, "line 12" or "frames[12]". */
void td_path_name_place(const td_path_reader *reader, const char *file, size_t place, char *text, size_t bytes);

/* -- times -- */

/* Finds the unit of the samples' times, as decimal digits from it to nanoseconds. options.time_unit decides; then the header
 * (`told`, -1: no unit there). Otherwise it is `usual` if the times are plausible in it, or the only unit in which they are.
 * Ambiguous times are TIDES_BAD_FILE. `*digits` -1: they are numbers of poses, not times. */
tides_status td_path_find_unit(td_path_reader *reader, int told, int usual, int *digits);

/* Finds the unit, and sets the samples' times from the file's digits, without loss. Numbers of poses are replaced by evenly
 * spread times. */
tides_status td_path_take_times(td_path_reader *reader, int told, int usual);

/* Sets the camera of a sample. */
tides_status td_path_set_view(td_path_reader *reader, td_path_sample *sample, const td_path_view *view);

/* Called after reading: keeps the samples that options->views selects, and the fields that all their cameras share. A field
 * that differs becomes 0. If lenses differ, there is no lens, and path.distorted is set. */
tides_status td_path_choose(td_path_reader *reader);

/* Finds the file or folder to read within `folder`; the caller frees it. NULL if nothing of a known name is there. */
tides_status td_path_find(const char *folder, char **file, tides_error *error);

/* The columns of a text whose rows are poses. */
typedef struct td_path_table {
    int columns; /* of a row */
    int commas;  /* ',' or ';' between them; 0: blanks */
    int named;   /* 1: a header line names the columns */
    int is_euroc;
    int place[8];      /* of time, x, y, z, qx, qy, qz, qw; a missing time is -1 */
    int digits, usual; /* of times to nanoseconds: by the header (-1: not given), and by the format */
    double metres;     /* in a unit of x, y and z */
    size_t line;       /* line number of the header; 0: none */
} td_path_table;

/* Recognises the table. TIDES_BAD_FILE if it has a header in which columns are missing. */
tides_status td_path_find_table(td_path_reader *reader, td_path_table *table);

/* One reader per format. */
tides_status td_path_read_table(td_path_reader *reader, const td_path_table *table); /* TUM, ESIM, EuRoC */
tides_status td_path_mount_euroc(td_path_reader *reader); /* moves samples from EuRoC's body to its camera */
tides_status td_path_read_kitti(td_path_reader *reader, int columns);
int td_path_is_kitti(int columns); /* 1 if rows of so many numbers are KITTI's */
tides_status td_path_read_llff(td_path_reader *reader);
tides_status td_path_read_colmap(td_path_reader *reader, int binary);
tides_status td_path_read_nerfies(td_path_reader *reader, const cJSON *root);
tides_status td_path_read_nerfies_folder(td_path_reader *reader, const char *folder);
tides_status td_path_read_tides(td_path_reader *reader, const cJSON *root);
tides_status td_path_read_transforms(td_path_reader *reader, const cJSON *root);
tides_status td_path_read_cameras(td_path_reader *reader, const cJSON *root);
tides_status td_path_read_nerfstudio(td_path_reader *reader, const cJSON *root);

/* Reads COLMAP's images, given the cameras; and the error for a file with cameras only, without poses. */
struct td_colmap_cameras;
tides_status td_path_read_images(td_path_reader *reader, int binary, const struct td_colmap_cameras *cameras);
tides_status td_path_refuse_cameras(td_path_reader *reader, int binary);

/* -- text: lines of numbers ---------------------------------------------------------------- */

const char *td_text_skip(const char *c); /* skips blanks */
int td_text_ends(const char *c);         /* 1 if the rest of the line is empty */

/* Properties common to the lines of a text file, by which a file cut within its last line is detected. Otherwise 0.7 of
 * 0.7071 would be a valid number, and eight columns of seventeen a valid pose. */
typedef struct td_text_lines {
    size_t count;
    int columns, decimals; /* of the first line: 1 + its commas, and decimals of its last number */
    int alike;             /* 1: all lines so far are equal in these */
} td_text_lines;

/* Takes a line of numbers. TIDES_BAD_FILE if it is the last one, has no line break, and is shorter than all before it. */
tides_status td_text_take(td_text_lines *lines, const td_path_reader *reader, size_t line, const char *data);

/* Reads a finite number at `c`; returns the place behind it, or `c` if there is none. */
const char *td_text_number(const char *c, double *value);

/* Reads a time at `c`, in units of 10^-`places` s, with the digits that exceed a double in `low`. `*end` is behind it, or `c`
 * if there is no finite number. */
void td_text_time(const char *c, int places, td_path_sample *sample, const char **end);

/* Fails unless the quaternion's length is about 1; `where` and `columns` are for the message. */
tides_status td_path_check_quaternion(const td_path_reader *reader, const char *where, const double q[4], const char *columns);

/* -- YAML: lists of numbers ------------------------------------------------------------------------ */

const char *td_yaml_skip(const char *at); /* skips blanks and line breaks */

/* Read `count` numbers of a list, and a matrix of four such rows. A list is in [] or has "- " before each item. They return
 * the place behind it, or NULL. */
const char *td_yaml_row(const char *at, double *values, int count);
const char *td_yaml_matrix(const char *at, double m[16]);

/* -- bytes: little-endian numbers one after the other; 0 if too few bytes are left ---------------------------- */

typedef struct td_bytes {
    const char *at;
    size_t left;
} td_bytes;

int td_bytes_skip(td_bytes *b, uint64_t bytes);
int td_bytes_number(td_bytes *b, size_t bytes, uint64_t *value);
int td_bytes_double(td_bytes *b, double *value);

/* -- JSON: `where` is the path of `object` ("frames[3]", "" for the root); failures name file, path and key ------------- */

cJSON *td_json_parse(td_path_reader *reader);
tides_status td_json_number(td_path_reader *reader, const cJSON *object, const char *where, const char *key, double *value);
tides_status td_json_vector(td_path_reader *reader, const cJSON *object, const char *where, const char *key, double *values,
                            int count);

/* Reads a row-major matrix. */
tides_status td_json_matrix(td_path_reader *reader, const cJSON *object, const char *where, const char *key, double *values,
                            int rows, int columns);

/* Reads a number of pixels: a whole number, at least 1. */
tides_status td_json_pixels(td_path_reader *reader, const cJSON *object, const char *where, const char *key, int32_t *value);

/* Converts a camera-to-world matrix in OpenGL axes, by rows, whose last row must be 0 0 0 1. `where` and `key` are for
 * messages. */
tides_status td_json_opengl_pose(td_path_reader *reader, const char *where, const char *key, const double matrix[16],
                                 tides_pose_sample *pose);

int td_json_has(const cJSON *object, const char *key);

/* Fails unless `object` is an object whose keys are all in `keys` (NULL-terminated), each at most once. */
tides_status td_json_check_keys(td_path_reader *reader, const cJSON *object, const char *where, const char *const *keys);

/* Fails with TIDES_BAD_FILE and the text "FILE: WHERE.KEY: TEXT". */
tides_status td_json_fail(td_path_reader *reader, const char *where, const char *key, const char *text);

/* Quotes a word of the file for a message: at most TD_QUOTE - 1 characters, control characters replaced, so that a message is
 * one line. Returns `out`. */
#define TD_QUOTE 41
const char *td_path_quote(const char *word, size_t bytes, char out[TD_QUOTE]);

/* Converts a 3x3 rotation of a file to a quaternion; fails if the matrix isn't a rotation. */
tides_status td_json_rotation(td_path_reader *reader, const char *where, const char *key, const double rotation[9],
                              double q[4]);

/* Lens from coefficients in OpenCV's order: radtan k1 k2 p1 p2 k3 (a pinhole if all are 0), equidistant k1 k2 k3 k4. */
tides_lens td_radtan(const double k[5]);
tides_lens td_equidistant(const double k[4]);

#endif
