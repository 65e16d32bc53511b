/* Internal: a parsed run file: one JSON value per row of the parameter table, and texts that follow from these. */
#ifndef TD_RUN_H
#define TD_RUN_H

#include "td_base.h"
#include "tides/run.h"

#include <cjson/cJSON.h>

/* Longest key that can be known. */
enum { TD_KEY_MAX = 96 };

/* Sources of a value: the run file, an override, the rig's camera, or the preset named by an override. The last two also
 * replace values of the run file. */
enum { TD_GIVEN_FILE = 1, TD_GIVEN_SET = 2, TD_GIVEN_RIG = 3, TD_GIVEN_PRESET = 4 };

struct tides_run {
    char *origin;         /* name of the text in errors: the file's name, or "run" */
    char *file;           /* the loaded file; NULL: the run came from a text */
    char *directory;      /* base of relative paths */
    cJSON **values;       /* one per row; NULL: required and not (yet) given */
    unsigned char *given; /* one per row: TD_GIVEN_*; 0: the default, or the value of the file's preset */
    cJSON **beneath;      /* one per row: the run file's value hidden by TD_GIVEN_RIG or _PRESET, or NULL */
    char **files;         /* one per row: the resolved path of a file, or NULL */
    char *json;           /* all keys, with defaults filled in */
    int32_t imu_body;     /* 1: the body moved by camera.file is the IMU, by rig.file */
    char *notes;          /* notes for the user, one per line; NULL: none */
};

/* The row of `key`, or NULL; 1 if `key` is the first part of some row's key ("sensor", "stepping.risk"). */
const tides_param *td_param_find(const char *key);
int32_t td_param_is_group(const char *key);

/* The error for an unknown key, naming the nearest known one. td_one_line replaces control characters by '?', so that an
 * error stays one line. */
tides_status td_param_unknown(const char *where, const char *key, tides_error *error);
void td_one_line(char *text);

/* The advice for a key of an earlier version, or (if `choice` isn't NULL) for such a choice; NULL if there never was one. */
const char *td_param_retired(const char *key, const char *choice);

/* 1 if `value` equals the row's default; checks that `value` is valid for `row`, with errors that begin with `where`. */
int32_t td_param_is_default(const tides_param *row, const cJSON *value);
tides_status td_param_check(const tides_param *row, const cJSON *value, const char *where, tides_error *error);

/* The choice that a value names: true and false of JSON are "true" and "false", as in files from before a switch became a
 * choice. "" if it is neither a text nor one of these. */
const char *td_choice_text(const cJSON *value);

/* td_is_repeated: 1 if a later member of the object that holds `item` has its name. td_given_twice: the error for that. */
int32_t td_is_repeated(const cJSON *item);
tides_status td_given_twice(const char *where, const char *key, tides_error *error);

/* Reads JSON text of `bytes` bytes into run->values; applies one "key=value" on top. */
tides_status td_run_read(tides_run *run, const char *text, size_t bytes, tides_error *error);
tides_status td_run_override(tides_run *run, const char *assignment, tides_error *error);

/* Copies `value` to its row's place. */
tides_status td_run_store(tides_run *run, const tides_param *row, const cJSON *value, tides_error *error);

/* Checks a value of rig.cameras. td_rig_kind: TIDES_RIG_*, -1 if `item` is no kind. td_rig_transform: T_B_C, four rows of
 * four numbers, the identity for NULL; 0 if `item` is no such matrix. */
tides_status td_rig_check(const cJSON *value, const char *where, tides_error *error);
int32_t td_rig_kind(const cJSON *item);
int32_t td_rig_transform(const cJSON *item, double transform[16]);

/* Applies the rig's camera to the run: its own keys, its seed, and its path, which replaces the body's. Without a rig these
 * do nothing. */
tides_status td_rig_apply(tides_run *run, tides_error *error);
tides_status td_rig_read_file(tides_run *run, tides_error *error); /* comes first: takes the cameras of rig.file */
uint64_t td_rig_seed(const tides_run *run, uint64_t seed);         /* the camera's own noise */
tides_status td_rig_mount(const tides_run *run, tides_trajectory **path, tides_error *error);
/* Converts T_B_I (p_body = T_B_I p_imu) to the rig camera's T_C_I. */
void td_rig_move_imu(const tides_run *run, double T[16]);

/* Sets rows that follow from the illuminance at Y = 1, and from the black level, unless they are given. */
tides_status td_run_light(tides_run *run, tides_error *error);

/* Sets rows from the biases in sensor.biases, unless file or override gives them, with notes. */
tides_status td_run_biases(tides_run *run, tides_error *error);

/* Sets rows from sensor.preset, unless a stronger source gives them. */
tides_status td_run_preset(tides_run *run, tides_error *error);
/* Checks a preset's entry for a row, plain or with source, and finds its value. td_preset_tells: 1 if `item` is a valid member
 * beside the values (about, version, resolution), -1 if it is an invalid one, else 0. */
tides_status td_preset_entry(const tides_param *row, const cJSON *item, const char *where, const cJSON **value,
                             tides_error *error);
int32_t td_preset_tells(const cJSON *item);
/* 1 if it is a path, and not the name of a preset. */
int32_t td_preset_is_file(const char *name);
/* The file of a preset, given by path or found by name; allocated. NULL: it is embedded or unknown, or memory is short. */
char *td_preset_file(const tides_run *run, const char *name, tides_error *error);

/* The table's defaults as JSON values, NULL if memory is short; one value per row as nested JSON text (NULL values are left
 * out). */
cJSON **td_run_defaults(tides_error *error);
tides_status td_run_print(cJSON *const *values, char **text, tides_error *error);
void td_run_free_values(cJSON **values);

/* Sets the values of an empty run; files, texts and intrinsics are NULL and 0. */
void td_run_values_defaults(tides_run_values *values);

/* Takes path options from an entry of scene.objects, under the names td_object_path_keys (NULL-terminated). They mean what
 * camera.time_unit and its neighbours mean for the camera's path. */
void td_run_object_path(const cJSON *object, tides_path_options *options);
extern const char *const td_object_path_keys[];

/* Facts found while a run's files are opened. */
typedef struct td_opening {
    char *notes;      /* notes for the user; the caller frees them; NULL: none */
    int32_t unframed; /* 1: nerfstudio's cameras, without a dataparser_transforms.json */
    int32_t has_imu;  /* 1: a calibration gives the IMU's pose */
    double T_C_I[16]; /* the pose: p_camera = T_C_I p_imu, by rows [scene units] */
} td_opening;

/* Adds notes to *notes about what frames don't show of the light between them. */
tides_status td_run_frames_light(const tides_run_values *values, tides_frames *frames, char **notes, tides_error *error);

/* Opens a run's files. td_run_open_camera opens only the camera's path and intrinsics; without camera.file it makes an orbit
 * around `scene`. */
tides_status td_run_open(const tides_run *run, tides_scene **scene, tides_trajectory **camera, tides_intrinsics *intrinsics,
                         td_opening *opening, tides_error *error);
tides_status td_run_open_camera(const tides_run *run, const tides_scene *scene, tides_trajectory **camera,
                                tides_intrinsics *intrinsics, td_opening *opening, tides_error *error);

/* Finds the dataparser_transforms.json that camera.frame names, or that lies beside camera.file or scene.file; allocated.
 * NULL if there is none, or it isn't to be used. */
tides_status td_run_find_frame(const tides_run *run, char **file, tides_error *error);

/* Sets `sees` to 0 if no pose of the path sees more than a few Gaussians at rest, or if all poses are far outside the scene. */
tides_status td_run_sees(const tides_scene *scene, const tides_trajectory *path, const tides_intrinsics *k, int32_t *sees,
                         tides_error *error);

/* The value of a row, which must be in the table; its path, resolved against the run's directory (allocated by
 * td_run_resolve); a further line in the run's notes. */
const cJSON *td_run_value(const tides_run *run, const char *key);
double td_run_number(const tides_run *run, const char *key);    /* 0 if null */
const char *td_run_file(const tides_run *run, const char *key); /* resolved; NULL if null */
char *td_run_resolve(const tides_run *run, const char *path, tides_error *error);
tides_status td_run_note(tides_run *run, const char *line, tides_error *error);

#endif
