/* Internal: a parsed run file is one JSON value per row of the parameter table; everything else is derived from that. */
#ifndef TD_RUN_H
#define TD_RUN_H

#include "td_base.h"
#include "tides/run.h"

#include <cjson/cJSON.h>

/* Longest dotted key that is looked at; longer ones are unknown by construction. */
enum { TD_KEY_MAX = 96 };

/* The run file, an override, the camera of a rig, or the preset that an override names; the latter two also where the run file
 * says something else. */
enum { TD_GIVEN_FILE = 1, TD_GIVEN_SET = 2, TD_GIVEN_RIG = 3, TD_GIVEN_PRESET = 4 };

struct tides_run {
    char *origin;         /* what errors call the text: the file's name, or "run" */
    char *file;           /* that was loaded; NULL: a text */
    char *directory;      /* what relative paths refer to */
    cJSON **values;       /* one per row of the table; NULL where required and not (yet) given */
    unsigned char *given; /* one per row: TD_GIVEN_*, who says it; 0 where its value is the default or the file's preset's */
    cJSON **beneath;      /* one per row: what the run file says where TD_GIVEN_RIG or _PRESET hides it, or NULL */
    char **files;         /* one per row: the resolved path where the row is a file's, and isn't null */
    char *json;           /* every key, defaults filled in */
    int32_t imu_body;     /* 1: rig.file says that the body which camera.file moves is its IMU */
    char *notes;          /* what the run's reader may not expect, a line each; NULL: nothing */
};

/* params.c: row of `key`, or NULL; 1 where `key` is the first part of some row's key ("sensor", "stepping.risk"). */
const tides_param *td_param_find(const char *key);
int32_t td_param_is_group(const char *key);

/* params_suggest.c: the error for a key that isn't in the table, naming the nearest one that is; control characters in text
 * from outside to '?', so that an error stays one line. */
tides_status td_param_unknown(const char *where, const char *key, tides_error *error);
void td_one_line(char *text);

/* retired.c: what to do in place of a key that there was, or (choice not NULL) of a choice; NULL where there never was one. */
const char *td_param_retired(const char *key, const char *choice);

/* run_value.c: 1 where `value` equals the row's default; whether `value` may stand at `row`, errors starting with `where`. */
int32_t td_param_is_default(const tides_param *row, const cJSON *value);
tides_status td_param_check(const tides_param *row, const cJSON *value, const char *where, tides_error *error);

/* run_value.c: the choice that a value names: JSON's true and false are "true" and "false", as in run files from before a
 * switch became a choice; "" where it is neither these nor a text. */
const char *td_choice_text(const cJSON *value);

/* run_json.c: reads `bytes` of JSON text into run->values, and one "key=value" on top of it. */
tides_status td_run_read(tides_run *run, const char *text, size_t bytes, tides_error *error);
tides_status td_run_override(tides_run *run, const char *assignment, tides_error *error);

/* run_json.c: copies `value` to its row's place. */
tides_status td_run_store(tides_run *run, const tides_param *row, const cJSON *value, tides_error *error);

/* rig_check.c: whether rig.cameras may be `value`; a camera's kind, TIDES_RIG_*, -1 where `item` is none; its T_B_C, four rows
 * of four numbers, the identity where `item` is NULL; 0 where it isn't such a matrix. */
tides_status td_rig_check(const cJSON *value, const char *where, tides_error *error);
int32_t td_rig_kind(const cJSON *item);
int32_t td_rig_transform(const cJSON *item, double transform[16]);

/* rig.c: the camera that rig.camera names: its own keys, into the run; and its path, on the body's, which it replaces. All do
 * nothing without a rig. */
tides_status td_rig_apply(tides_run *run, tides_error *error);
tides_status td_rig_read_file(tides_run *run, tides_error *error); /* rig_file.c: before it, the cameras of rig.file */
uint64_t td_rig_seed(const tides_run *run, uint64_t seed);         /* of that camera: its own noise */
tides_status td_rig_mount(const tides_run *run, tides_trajectory **path, tides_error *error);
/* T_B_I (p_body = T_B_I p_imu) becomes that camera's T_C_I. */
void td_rig_move_imu(const tides_run *run, double T[16]);

/* 1 where the name is a video's: .y4m, or "-" for one from a pipe. */
int32_t td_run_is_video(const char *file);

/* run_light.c: sets the rows that aren't given from the light of Y = 1, and from the dark. */
tides_status td_run_light(tides_run *run, tides_error *error);

/* biases.c: sets rows that neither file nor override gives from the camera's biases in sensor.biases, with a note of each. */
tides_status td_run_biases(tides_run *run, tides_error *error);

/* preset.c: sets the rows that no stronger source gives from sensor.preset. */
tides_status td_run_preset(tides_run *run, tides_error *error);
/* preset_entry.c: the value that a preset has for a row, plain or with what is known of it, checked; and what a preset tells
 * beside its values: 1 where `item` is such, -1 where it is and has a wrong value, else 0. */
tides_status td_preset_entry(const tides_param *row, const cJSON *item, const char *where, const cJSON **value,
                             tides_error *error);
int32_t td_preset_told(const cJSON *item);
/* 1 where it is a path, and not the name of one of ours. */
int32_t td_preset_is_file(const char *name);
/* The file that a preset is read from, given by its path or found by its name, allocated; NULL: none, or out of memory. */
char *td_preset_file(const tides_run *run, const char *name, tides_error *error);

/* run_write.c: the table's defaults as JSON values, NULL when out of memory; nested JSON text of one value per row (NULL rows
 * are left out). */
cJSON **td_run_defaults(tides_error *error);
tides_status td_run_print(cJSON *const *values, char **text, tides_error *error);
void td_run_free_values(cJSON **values);

/* params.c: what the values are where a run says nothing; files, texts and intrinsics are NULL and 0. */
void td_run_values_defaults(tides_run_values *values);

/* Takes the options of a trajectory's file from an entry of scene.objects, by the names of td_object_path_keys (run_value.c,
 * ended by NULL). They act as camera.time_unit and the like act for the camera's file. */
void td_run_object_path(const cJSON *object, tides_path_options *options);
extern const char *const td_object_path_keys[];

/* Facts found while a run is opened, beside the opened objects. */
typedef struct td_opening {
    char *notes;      /* what a reader of the run may not expect, for the caller to free; NULL: nothing */
    int32_t unframed; /* 1: cameras are nerfstudio's, and no dataparser_transforms.json was there */
    int32_t has_imu;  /* 1: a calibration says where the IMU is */
    double T_C_I[16]; /* there: p_camera = T_C_I p_imu, by rows [scene units] */
} td_opening;

/* frames_light.c: adds to *notes what frames don't say of the light: lines, or nothing. */
tides_status td_run_frames_light(const tides_run_values *values, tides_frames *frames, char **notes, tides_error *error);

/* run_open.c: what tides_run_open does; and the camera's path and intrinsics alone, where `scene` is what an orbit is about,
 * NULL where camera.file is given. */
tides_status td_run_open(const tides_run *run, tides_scene **scene, tides_trajectory **camera, tides_intrinsics *intrinsics,
                         td_opening *opening, tides_error *error);
tides_status td_run_open_camera(const tides_run *run, const tides_scene *scene, tides_trajectory **camera,
                                tides_intrinsics *intrinsics, td_opening *opening, tides_error *error);

/* run_open.c: the dataparser_transforms.json that camera.frame names, or that lies beside camera.file or scene.file: allocated;
 * NULL where there is none to be used. */
tides_status td_run_find_frame(const tides_run *run, char **file, tides_error *error);

/* seen.c: 0 where no pose of the path sees more than next to nothing of what is at rest in the scene, or all are far out. */
tides_status td_run_sees(const tides_scene *scene, const tides_trajectory *path, const tides_intrinsics *k, int32_t *sees,
                         tides_error *error);

/* run_keys.c: the value of a row that is known to be in the table; `path` against the run's directory, allocated; a line more
 * in the run's notes. */
const cJSON *td_run_value(const tides_run *run, const char *key);
double td_run_number(const tides_run *run, const char *key);    /* 0 where null */
const char *td_run_file(const tides_run *run, const char *key); /* resolved; NULL where null */
char *td_run_resolve(const tides_run *run, const char *path, tides_error *error);
tides_status td_run_note(tides_run *run, const char *line, tides_error *error);

#endif
