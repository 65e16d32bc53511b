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
    char *notes;          /* what the run's reader may not expect, a line each; NULL: nothing */
};

/* params.c: row of `key`, or NULL; 1 where `key` is the first part of some row's key ("sensor", "stepping.risk"). */
const tides_param *td_param_find(const char *key);
int32_t td_param_is_group(const char *key);

/* params_suggest.c: the error for a key that isn't in the table, naming the nearest one that is; control characters in text
 * from outside to '?', so that an error stays one line. */
tides_status td_param_unknown(const char *where, const char *key, tides_error *error);
void td_one_line(char *text);

/* run_value.c: 1 where `value` equals the row's default; whether `value` may stand at `row`, errors starting with `where`. */
int32_t td_param_is_default(const tides_param *row, const cJSON *value);
tides_status td_param_check(const tides_param *row, const cJSON *value, const char *where, tides_error *error);

/* run_json.c: reads `bytes` of JSON text into run->values, and one "key=value" on top of it. */
tides_status td_run_read(tides_run *run, const char *text, size_t bytes, tides_error *error);
tides_status td_run_override(tides_run *run, const char *assignment, tides_error *error);

/* run_json.c: copies `value` to its row's place. */
tides_status td_run_store(tides_run *run, const tides_param *row, const cJSON *value, tides_error *error);

/* run.c: adds a line to the notes. */
tides_status td_run_note(tides_run *run, const char *line, tides_error *error);

/* rig.c: whether rig.cameras may be `value`; what the camera that rig.camera names has of its own, into the run; and its path,
 * on the body's, which it replaces. All do nothing without a rig. */
tides_status td_rig_check(const cJSON *value, const char *where, tides_error *error);
tides_status td_rig_apply(tides_run *run, tides_error *error);
tides_status td_rig_read_file(tides_run *run, tides_error *error); /* rig_file.c: before it, the cameras of rig.file */
uint64_t td_rig_seed(const tides_run *run, uint64_t seed);         /* of that camera: its own noise */
tides_status td_rig_mount(const tides_run *run, tides_trajectory **path, tides_error *error);

/* 1 where the name is a video's: .y4m, or "-" for one from a pipe. */
int32_t td_run_is_video(const char *file);

/* preset.c: the values of sensor.preset for the rows that nobody gives who is stronger. */
tides_status td_run_preset(tides_run *run, tides_error *error);
/* 1 where it is a path, and not the name of one of ours. */
int32_t td_preset_is_file(const char *name);

/* run_write.c: the table's defaults as JSON values, NULL when out of memory; nested JSON text of one value per row (NULL rows
 * are left out). */
cJSON **td_run_defaults(tides_error *error);
tides_status td_run_print(cJSON *const *values, char **text, tides_error *error);
void td_run_free_values(cJSON **values);

/* run_values.c: what the values are where a run says nothing; files, texts and intrinsics are NULL and 0. */
void td_run_values_defaults(tides_run_values *values);

/* run_open.c: the camera's path and intrinsics alone; `scene` is what an orbit is about, NULL where camera.file is given. */
tides_status td_run_open_camera(const tides_run *run, const tides_scene *scene, tides_trajectory **camera,
                                tides_intrinsics *intrinsics, tides_error *error);

/* run.c: the value of a row that is known to be in the table; `path` against the run's directory, allocated. */
const cJSON *td_run_value(const tides_run *run, const char *key);
double td_run_number(const tides_run *run, const char *key);    /* 0 where null */
const char *td_run_file(const tides_run *run, const char *key); /* resolved; NULL where null */
char *td_run_resolve(const tides_run *run, const char *path, tides_error *error);

#endif
