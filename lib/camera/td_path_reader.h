/* Internal: what the readers of path files share. A reader appends samples; td_path_parse does the rest. */
#ifndef TD_PATH_READER_H
#define TD_PATH_READER_H

#include "tides/camera.h"

#include "td_base.h"

#include <cjson/cJSON.h>

/* One pose of a file. Its time is `time` + `low` until `start` has been subtracted: stamps of 1e9 s with nanoseconds need 60
 * bits of mantissa, of which a double has 53, so that text formats keep what the double loses. */
typedef struct td_path_sample {
    tides_pose_sample pose; /* its time isn't set yet */
    double time, low;       /* [s] */
    size_t place;           /* line number, or index in the file's list */
    size_t view;            /* which of the reader's views it is of, counted from 1; 0: the file doesn't say */
    const char *word;       /* its picture's name, or its time as the file writes it: while the file is read; NULL: none */
    size_t length;          /* of that word */
} td_path_sample;

/* The camera of one pose, as tides_path has it for all. */
typedef struct td_path_view {
    tides_intrinsics intrinsics;
    double field_of_view_x;
    int32_t distorted;
} td_path_view;

typedef struct td_path_reader {
    const char *file; /* for messages */
    const char *text; /* terminated */
    size_t bytes;
    const tides_path_options *options;
    td_path_sample *samples;
    size_t count, capacity;
    td_path_view *views;
    size_t view_count, view_capacity;
    int is_open;      /* its samples are an open path's (tides_trajectory_create_open) */
    int spread;       /* the file has no times: td_path_spread's wish */
    const char *list; /* the JSON list that `place` indexes ("frames"); NULL: `place` is a line */
    tides_path path;  /* what has been read so far; a generator sets the trajectory itself */
    tides_error *error;
} td_path_reader;

/* Reads `bytes` of a path file that end in a NUL; `file` is for messages. tides_path_load calls it once it has the bytes. */
tides_status td_path_parse(const char *file, const char *text, size_t bytes, const tides_path_options *options,
                           tides_path *path, tides_error *error);

/* -- samples (path_samples.c) -- */

/* A new sample at the end, zeroed; NULL: out of memory. */
td_path_sample *td_path_append(td_path_reader *reader, size_t place);

/* Time of `sample` since that of `origin` [s]. */
double td_path_since(const td_path_sample *sample, const td_path_sample *origin);

/* The time that `start` and `rebase` put at 0, for a file whose first sample is `first`. */
td_path_sample td_path_origin(const td_path_reader *reader, const td_path_sample *first);

#define TD_LARGEST_PATH ((size_t)1 << 30) /* [bytes] of a file: days at 200 Hz */

/* Sorts the samples by time, then by place. */
void td_path_sort(td_path_reader *reader);

/* Even times over [0, duration] for the samples that are kept, for files without times. */
void td_path_spread(td_path_reader *reader);

/* -- order (path_order.c) -- */

/* Adds a line to path.notes: a fact that a reader of the path may not expect. */
void td_path_note(td_path_reader *reader, const char *format, ...) TD_PRINTF(2, 3);

/* Order of names in which digits are numbers: 2 before 10; below, at or above 0. */
int td_path_compare_names(const char *a, size_t a_length, const char *b, size_t b_length);

/* For files without times: samples in the order of their names where all have one, else of the file; then td_path_spread.
 * `say`: notes where the file's order is another. */
void td_path_order(td_path_reader *reader, int say);

/* The text at `key` of `object` is the picture's name. */
void td_path_set_name(td_path_sample *sample, const cJSON *object, const char *key);

/* The samples into the trainer's frame, where options.frame or the file's folder has nerfstudio's dataparser_transforms.json;
 * `root` (nullable): the transforms.json, which says what was applied to it already (path_frame.c). */
tides_status td_path_apply_frame(td_path_reader *reader, const cJSON *root);

/* Notes where poses leap, once they have their times; TIDES_NO_MEMORY. */
tides_status td_path_note_leaps(td_path_reader *reader);

/* "FILE:12" or "FILE: frames[12]"; without `file` "line 12" or "frames[12]". */
void td_path_name_place(const td_path_reader *reader, const char *file, size_t place, char *text, size_t bytes);

/* -- times (path_times.c) -- */

/* The unit of the samples' times, which are as the file has them, where options.time_unit doesn't say: as a header says
 * (`told`: digits from the unit to nanoseconds, -1: it doesn't), or else `usual` where what comes out is plausible, another
 * where one is. Counts and what could be several are TIDES_BAD_FILE. `*digits` -1: they are numbers of poses, not times. */
tides_status td_path_find_unit(td_path_reader *reader, int told, int usual, int *digits);

/* Finds the unit as td_path_find_unit does, and sets the samples' times from their words, digit by digit, as the file writes
 * them. Where the words are numbers of poses, the times are spread. */
tides_status td_path_take_times(td_path_reader *reader, int told, int usual);

/* The camera of a sample (path_views.c). */
tides_status td_path_set_view(td_path_reader *reader, td_path_sample *sample, const td_path_view *view);

/* Once all is read: keeps the samples that options->views chooses, and the fields that all their cameras share: a field that
 * differs becomes 0. If lenses differ, none is kept, and path.distorted says so. */
tides_status td_path_choose(td_path_reader *reader);

/* The file or folder to read where `folder` is given, for the caller to free; NULL where nothing known is in it
 * (path_folder.c). */
tides_status td_path_find(const char *folder, char **file, tides_error *error);

/* A text whose rows are poses: where its columns are (path_table.c). */
typedef struct td_path_table {
    int columns; /* of a row */
    int commas;  /* ',' or ';' between them; 0: blanks */
    int named;   /* 1: a line of the file names them */
    int is_euroc;
    int place[8];      /* of time, x, y, z, qx, qy, qz, qw; time's is -1: none */
    int digits, usual; /* of times, to nanoseconds: as the names say, -1: they don't; and as the format has them */
    double metres;     /* of a unit of x, y and z */
    size_t line;       /* of the names; 0: none */
} td_path_table;

/* The table that the text is, if it is one. TIDES_BAD_FILE: it names its columns, and some are missing. */
tides_status td_path_find_table(td_path_reader *reader, td_path_table *table);

/* One reader per format. */
tides_status td_path_read_table(td_path_reader *reader, const td_path_table *table); /* TUM, ESIM, EuRoC */
tides_status td_path_mount_euroc(td_path_reader *reader); /* samples of EuRoC's body to its camera's */
tides_status td_path_read_kitti(td_path_reader *reader, int columns);
int td_path_is_kitti(int columns); /* 1 where rows of so many numbers are poses of KITTI's kind */
tides_status td_path_read_llff(td_path_reader *reader);
tides_status td_path_read_colmap(td_path_reader *reader, int binary);
tides_status td_path_read_nerfies(td_path_reader *reader, const cJSON *root);
tides_status td_path_read_nerfies_folder(td_path_reader *reader, const char *folder);
tides_status td_path_read_tides(td_path_reader *reader, const cJSON *root);
tides_status td_path_read_transforms(td_path_reader *reader, const cJSON *root);
tides_status td_path_read_cameras(td_path_reader *reader, const cJSON *root);
tides_status td_path_read_nerfstudio(td_path_reader *reader, const cJSON *root);

/* COLMAP's images with the cameras given, and the message for a file that only holds cameras. */
struct td_colmap_cameras;
tides_status td_path_read_images(td_path_reader *reader, int binary, const struct td_colmap_cameras *cameras);
tides_status td_path_refuse_cameras(td_path_reader *reader, int binary);

/* -- text: what lines of numbers are made of (path_text.c) ---------------------------------------------------------------- */

const char *td_text_skip(const char *c); /* behind blanks */
int td_text_ends(const char *c);         /* 1 where the line at `c` holds nothing more */

/* Properties that the lines of a text file share, so that a file cut within its last line is found: 0.7 of 0.7071 is a number,
 * and eight columns of seventeen are a pose. */
typedef struct td_text_lines {
    size_t count;
    int columns, decimals; /* of the first line: its commas, and what its last number has behind the point */
    int alike;             /* 1: all have as many */
} td_text_lines;

/* Takes a line that holds numbers. TIDES_BAD_FILE where it is the last, nothing ends it, and it has less than all before it. */
tides_status td_text_take(td_text_lines *lines, const td_path_reader *reader, size_t line, const char *data);

/* Reads the finite number at `c`; returns what follows it, or `c` where there is none. */
const char *td_text_number(const char *c, double *value);

/* Reads the time at `c`, of whose unit there are 10^`places` in a second, with the digits that a double has no room for in
 * `low`. `*end` is behind it, or at `c` where there is no finite number. */
void td_text_time(const char *c, int places, td_path_sample *sample, const char **end);

/* The quaternion's length must be about 1; `where` and `columns` name line and columns in the message. */
tides_status td_path_check_quaternion(const td_path_reader *reader, const char *where, const double q[4], const char *columns);

/* -- YAML: numbers of a list (yaml_numbers.c) ------------------------------------------------------------------------ */

const char *td_yaml_skip(const char *at); /* behind blanks and line breaks */

/* `count` numbers of the list at `at`, in [] or behind "- " each; rows of four, as lists in [] or behind "- " each. Return what
 * follows, or NULL. */
const char *td_yaml_row(const char *at, double *values, int count);
const char *td_yaml_matrix(const char *at, double m[16]);

/* -- bytes: little-endian numbers one after the other; 0 where too few are left (path_bytes.c) ---------------------------- */

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

/* A row-major matrix. */
tides_status td_json_matrix(td_path_reader *reader, const cJSON *object, const char *where, const char *key, double *values,
                            int rows, int columns);

/* Number of pixels: a whole number, at least 1. */
tides_status td_json_pixels(td_path_reader *reader, const cJSON *object, const char *where, const char *key, int32_t *value);

/* The camera-to-world matrix of a file with OpenGL axes, by rows, ends in 0 0 0 1; `where` and `key` are its place. */
tides_status td_json_opengl_pose(td_path_reader *reader, const char *where, const char *key, const double matrix[16],
                                 tides_pose_sample *pose);

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

/* Lenses by coefficients in OpenCV's order: k1 k2 p1 p2 k3 (a pinhole where all are 0), and k1 k2 k3 k4. */
tides_lens td_radtan(const double k[5]);
tides_lens td_equidistant(const double k[4]);

#endif
