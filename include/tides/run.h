/* The run file: one JSON text that says what to simulate (DESIGN 6), and the table of its parameters. */
#ifndef TIDES_RUN_H
#define TIDES_RUN_H

#include "tides/baselines.h"
#include "tides/exposure.h"
#include "tides/imu.h"
#include "tides/filters.h"
#include "tides/readout.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Kinds of tides_param: the values that a key takes. */
enum {
    TIDES_PARAM_NUMBER = 0,
    TIDES_PARAM_INTEGER,
    TIDES_PARAM_BOOLEAN,
    TIDES_PARAM_STRING,
    TIDES_PARAM_CHOICE,
    TIDES_PARAM_VECTOR3,
    TIDES_PARAM_OBJECTS,
    TIDES_PARAM_VECTOR2
};

/* One row of the parameter table, from which the JSON reader, --set, --help, man page and bindings are made. */
typedef struct tides_param {
    const char *key;      /* "sensor.threshold_on" */
    int32_t type;         /* TIDES_PARAM_* */
    const char *unit;     /* "log units", or "" */
    double lower, upper;  /* inclusive bounds of numbers; 0 and 0 for the rest */
    const char *fallback; /* default as JSON text; NULL: required */
    const char *choices;  /* "smooth|inria|gsplat", or NULL */
    const char *sentence; /* what it does */
    int32_t common;       /* 1: one of the few keys that most runs set, which --help lists and `tides init` writes */
} tides_param;

/* The table; static storage, `count` (nullable) receives its length. */
TIDES_API const tides_param *tides_params(size_t *count);

/* 1 if `key` takes the path of a file, or objects that name files. Relative paths are relative to the run file. sensor.preset
 * takes a name, too. */
TIDES_API int32_t tides_param_is_path(const char *key);

/* A run file that was read. Opaque, constant once made. */
typedef struct tides_run tides_run;

/* Reads a run file; a splat file or a model's folder in its place is a run of that scene on an orbit (camera.orbit_s = 12),
 * from 0 to 0.1 s; frames (a video, a folder of pictures, an array of three dimensions) are a run of frames.file.
 * `overrides` (nullable, `count` of them) are "key=value" texts, value as JSON or bare text, applied after the file. Unknown
 * keys are errors that name the nearest known key; values out of range name the key, the value and the range. Relative
 * paths are relative to the file. Beyond JSON, "//" outside a text begins a comment that ends with the line, and a comma may
 * stand before a closing bracket. Strongest first: a value of an override, a preset (sensor.preset) that an override names, the
 * file's own values, a preset that the file names. tides_run_notes lists the values that a preset didn't get to set. */
TIDES_MUST_CHECK TIDES_API tides_status tides_run_load(const char *file, const char *const *overrides, size_t count,
                                                       tides_run **run, tides_error *error);

/* Reads a run from JSON text; relative paths in it refer to `directory`. */
TIDES_MUST_CHECK TIDES_API tides_status tides_run_parse(const char *text, const char *directory, const char *const *overrides,
                                                        size_t count, tides_run **run, tides_error *error);

/* Makes a copy of a run with more overrides, applied after those of `base`. `base` isn't changed, nor needed afterwards. */
TIDES_MUST_CHECK TIDES_API tides_status tides_run_vary(const tides_run *base, const char *const *overrides, size_t count,
                                                       tides_run **run, tides_error *error);

TIDES_API void tides_run_destroy(tides_run *run); /* NULL is fine */

/* The points that tides_session_tracks follows: at random over what is seen, on a grid over the first image, or the same
 * number for each object that is seen. */
enum { TIDES_TRACKS_RANDOM = 0, TIDES_TRACKS_GRID = 1, TIDES_TRACKS_INSTANCE = 2 };

/* The run file's values, as the structs that the library takes. Plain value; strings live as long as the run. */
typedef struct tides_run_values {
    tides_intrinsics intrinsics;                                   /* zeros if neither the run nor its path file gives them */
    tides_image_params image;                                      /* image.*, scene.background */
    tides_sensor sensor;                                           /* sensor.* */
    tides_stepping stepping;                                       /* stepping.* */
    tides_readout readout;                                         /* readout.* */
    tides_filters filters;                                         /* filters.* */
    double start, stop;                                            /* time.* [s] */
    const char *scene_file, *camera_file, *device, *seed, *method; /* as in the file; "" or NULL if absent */
    tides_baseline_params baseline;                                /* its method is `method` */
    tides_frames_options frames;                                   /* frames.* */
    const char *frames_file;                                       /* NULL: the run has a scene */
    double frames_per_second;                                      /* of a baseline's renders [Hz] */
    tides_path_options path;                                       /* of camera.file */
    tides_scene_options scene_options;                             /* of scene.file, and `invalid` of all files */
    double scene_duration_s;                                       /* duration of the scene's motions; 0: the scene's own */
    double metres_per_unit;                                        /* of the scene [m]; 0: unknown */
    const char *dataset_layout;                                    /* layouts of tides_dataset_write; NULL: none given */
    double dataset_picture_hz, dataset_truth_hz, dataset_pose_hz;  /* of tides_dataset_write [Hz] */
    int32_t event_truth;                                           /* 1: event files get ground truth (tides_session_truth) */
    int32_t truth_metres;                                          /* 1: its depths are in metres */
    const char *truth_columns;                                     /* "flow,depth,alpha,instance", or some of these */
    int32_t track_choice;                                          /* TIDES_TRACKS_*: how tracked points are chosen */
    int32_t track_count;                                           /* points to follow (tides_session_tracks) */
    double track_rate_hz;                                          /* of tracks [Hz] */
    tides_exposure exposure;                                       /* of frames (tides_session_frames) */
    tides_imu imu;                                                 /* metres_per_unit is above instead */
    const char *json; /* the run with every default filled in, as written into event files */
} tides_run_values;
TIDES_API void tides_run_get(const tides_run *run, tides_run_values *values);

/* The name of preset `index` in the library ("davis346"). Returns 1, or 0 if there is none. */
enum { TIDES_PRESET_NAME = 32 };
TIDES_API int32_t tides_preset_at(size_t index, char name[TIDES_PRESET_NAME]);

/* The JSON text of a preset: the library's, or the user's own. The latter are NAME.json in $XDG_CONFIG_HOME/tides/presets
 * (else ~/.config/tides/presets), where sensor.preset finds them too. The caller frees it with tides_free.
 * TIDES_FILE_NOT_FOUND: there is none. */
TIDES_MUST_CHECK TIDES_API tides_status tides_preset_read(const char *name, char **text, tides_error *error);

/* Surprising facts about the run file, a line each, such as values that a preset couldn't set; else "". The string lives as
 * long as the run. */
TIDES_API const char *tides_run_notes(const tides_run *run);

/* 1 if the file or an override gives `key` ("sensor.threshold_on"). 0 if it has its default or the preset's value, or isn't a
 * key. */
TIDES_API int32_t tides_run_gives(const tides_run *run, const char *key);

/* Cameras of a rig (rig.cameras): their outputs, and their places on the body that camera.file moves. */
enum { TIDES_RIG_BOTH = 0, TIDES_RIG_EVENT = 1, TIDES_RIG_FRAME = 2, TIDES_RIG_NAME = 32 };
typedef struct tides_rig_camera {
    char name[TIDES_RIG_NAME]; /* of letters, digits, _ and - */
    int32_t kind;              /* TIDES_RIG_BOTH, _EVENT or _FRAME */
    int32_t reserved;
    double T_B_C[16]; /* row-major: p_body = T_B_C p_camera [scene units] */
} tides_rig_camera;

/* Camera `index` of the run's rig. Returns 1, or 0 if there is none, or no rig. A run simulates one camera; override
 * rig.camera for another. */
TIDES_API int32_t tides_run_rig_camera(const tides_run *run, size_t index, tides_rig_camera *camera);

/* Opens the scene with its objects, and the camera's path, on its rig if there is one. Intrinsics from the run file have
 * priority over the path file's; missing ones are an error that names the key. The caller destroys scene and trajectory. */
TIDES_MUST_CHECK TIDES_API tides_status tides_run_open(const tides_run *run, tides_scene **scene, tides_trajectory **camera,
                                                       tides_intrinsics *intrinsics, tides_error *error);

/* Opens the frames that the run names. TIDES_BAD_CONFIG: the run has no frames.file. The caller closes them. */
TIDES_MUST_CHECK TIDES_API tides_status tides_run_open_frames(const tides_run *run, tides_frames **frames, tides_error *error);

/* A run file for a new user: every key with its default, as a JSON object without comments. The caller frees `text` with
 * tides_free. */
TIDES_MUST_CHECK TIDES_API tides_status tides_run_template(const char *scene_file, const char *camera_file, char **text,
                                                           tides_error *error);
TIDES_API void tides_free(void *memory);

#ifdef __cplusplus
}
#endif
#endif
