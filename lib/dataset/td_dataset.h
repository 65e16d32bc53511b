/* Internal: datasets. All results (events, pictures, ground truth, poses) are made once, and given to each layout as they are
 * made. A layout is one file of functions that write them. */
#ifndef TD_DATASET_H
#define TD_DATASET_H

#include "td_base.h"
#include "camera/td_lens_models.h"
#include "td_text.h"
#include "tides/dataset.h"
#include "tides/image.h"
#include "tides/truth.h"

/* -- the dataset --------------------------------------------------------------------------------------------------------- */

/* A view of a camera: its own, or rectified, which is a pinhole at the camera's place, possibly turned, with as many pixels. */
typedef struct td_view {
    tides_intrinsics intrinsics;
    double rotation[9];           /* from the camera's coordinates to the view's */
    const tides_trajectory *path; /* of the view */
    tides_trajectory *own;        /* the same path, if it belongs to the view */
    int32_t differs;              /* 0: equal to the camera's own view */
} td_view;

/* Kinds of rectified views: of ground truth, for cameras that make events; of pictures, for cameras that make pictures. The
 * left and the right camera of a kind are rectified as a pair. */
enum { TD_TRUTH, TD_PICTURE, TD_KINDS };

/* A camera of the rig. Its session is a variation of the given session. */
typedef struct td_member {
    char name[TIDES_RIG_NAME];
    double T_B_C[16];
    tides_session *session;
    int32_t owned;          /* 1: the session must be closed */
    int32_t event, picture; /* number among cameras that make events, or pictures: 0 left, 1 right; -1: makes none */
    tides_session_facts facts;
    td_view rectified[TD_KINDS]; /* for each kind that the camera makes, if a layout needs it */
} td_member;

typedef struct td_dataset {
    td_member *cameras;
    size_t count, event_cameras, picture_cameras;
    const char *name; /* name of the sequence: the last part of the folder */
    double metres;    /* metres per scene unit; 0: unknown */
    double picture_hz, truth_hz, pose_hz;
    size_t pictures, truths, poses; /* numbers for each camera */
    int64_t start_us, stop_us;      /* span of pictures, truth and poses; all exposures lie within the run */
    int32_t exposed;                /* 1: the run gives exposure.exposure_s */
    int32_t has_imu;                /* 1: the run gives imu.down (or no gravity) and the scale in metres, so there is an IMU */
} td_dataset;

/* Time number k of a rate, rounded to whole microseconds: files have no finer times, so their contents are exactly at the
 * time stated. */
int64_t td_dataset_us(const td_dataset *set, double hz, size_t k);
static inline double td_seconds(int64_t us) { return (double)us / 1e6; } /* the nearest double, as from the decimal text */
static inline double td_event_seconds(const tides_event *event) { return (double)event->t / 1e9; }

/* A picture with 8 bits: of an instant, in sRGB, or exposed as the run says. Times are the exposure's middle, begin and end. */
typedef struct td_picture {
    size_t index;
    int64_t us, from_us, to_us;
    const uint8_t *grey, *rgb; /* (height x width), (height x width x 3) */
} td_picture;

/* Ground truth at a time. Planes are (height x width). */
typedef struct td_truth {
    size_t index;
    int64_t us, next_us, before_us;    /* ends of the displacements */
    const double *flow_u, *flow_v;     /* [px/s] */
    const double *depth;               /* of the median splat [scene units]; 0: nothing is seen */
    const double *instance;            /* -1: nothing is seen */
    const double *next_u, *next_v;     /* displacement to next_us [px], NaN: unknown; NULL: the last truth */
    const double *next_seen;           /* 1: the point is visible then, too */
    const double *before_u, *before_v; /* displacement to before_us; NULL: the first truth */
} td_truth;

/* A camera's pose in the world [scene units]. */
typedef struct td_place_at {
    int64_t us;
    double position[3], quaternion[4], rotation[9]; /* wxyz */
} td_place_at;

/* Computes the pose at a time. */
tides_status td_place(const td_member *camera, int64_t us, td_place_at *place, tides_error *error);

/* -- layouts --------------------------------------------------------------------------------------------------------------- */

/* A layout that is being written, one camera after the other. */
typedef struct td_layout td_layout;
typedef struct td_writer {
    const td_layout *layout;
    const td_dataset *set;
    const td_member *camera;
    char *root;   /* the layout's folder */
    char *folder; /* the camera's: root, or a subfolder if the layout has one per camera */
    void *state;  /* the layout's, for this camera */
    void *kept;   /* the layout's, for all cameras */
} td_writer;

/* Functions are NULL if a layout doesn't need them. `begin` and `end` enclose each camera; `complete` comes after all; `drop`
 * frees both states in any case. */
struct td_layout {
    const char *name, *summary;
    int32_t metric, per_camera; /* 1: lengths are in metres, so the run must give a unit's size; each camera has a folder */
    int32_t rectified;          /* 1: pictures and ground truth are those of rectified views */
    tides_status (*check)(const td_dataset *set, tides_error *error);
    tides_status (*begin)(td_writer *w, tides_error *error);
    tides_status (*events)(td_writer *w, const tides_event *events, size_t count, tides_error *error);
    tides_status (*picture)(td_writer *w, const td_picture *picture, tides_error *error);
    tides_status (*truth)(td_writer *w, const td_truth *truth, tides_error *error);
    tides_status (*pose)(td_writer *w, const td_place_at *place, tides_error *error);
    tides_status (*imu)(td_writer *w, const tides_imu_sample *sample, tides_error *error);
    tides_status (*end)(td_writer *w, tides_error *error);
    tides_status (*complete)(td_writer *w, tides_error *error);
    void (*drop)(td_writer *w);
};
extern const td_layout td_layout_ecd, td_layout_dsec, td_layout_mvsec, td_layout_evimo, td_layout_blinkflow, td_layout_tum,
    td_layout_ros2, td_layout_kubric;
tides_status td_dsec_calibration(const td_writer *w, tides_error *error);
extern const td_layout td_layout_contact; /* the overview picture of every dataset */

/* Finds rectified views of all cameras. TIDES_BAD_CONFIG names two cameras that can't form a pair. Call td_rectify_release in
 * any case. */
tides_status td_rectify(td_dataset *set, tides_error *error);
void td_rectify_release(td_member *camera);
/* Camera number `side` (0: left, 1: right) among those of a kind; NULL: none. */
const td_member *td_find_camera(const td_dataset *set, int kind, int side);

/* Begin and end of a picture's exposure at `us`, over all rows, in whole microseconds. */
void td_exposed_between(const td_member *camera, int64_t us, int64_t *from_us, int64_t *to_us);

/* Room for an exposed picture. A plane has a value per pixel. */
typedef struct td_exposed {
    double *light;    /* four planes: red, green, blue, luminance [linear light] */
    uint16_t *values; /* three planes of pixel values */
    uint8_t *rgb;     /* (pixels x 3), result */
    uint8_t *grey;    /* (pixels), result */
} td_exposed;

/* Exposes a picture as the camera's run says. */
tides_status td_exposed_make(const td_member *camera, const tides_trajectory *path, tides_renderer *renderer,
                             const td_picture *picture, const td_exposed *to, tides_error *error);

/* Gives pictures and ground truth of a camera to every layout. */
typedef struct td_scenes {
    td_writer *writers;
    size_t count;
    tides_progress step;
    void *user;
} td_scenes;
tides_status td_scenes_give(const td_scenes *to, const td_dataset *set, const td_member *camera, tides_error *error);

/* -- helpers of layouts -------------------------------------------------------------------------- */

/* td_in_folder formats FOLDER/name, NULL if memory is short; td_make_parents makes the missing folders above a file. */
char *td_in_folder(const char *folder, tides_error *error, const char *format, ...) TD_PRINTF(3, 4);
tides_status td_make_parents(const char *file, tides_error *error);
void td_remove_folder(const char *path);                    /* with all its contents */
void td_empty_folder(const char *path, const char *except); /* of all but this name; NULL: of everything */

/* Begins a text file FOLDER/name. */
tides_status td_text_in_folder(td_text *text, const char *folder, const char *name, tides_error *error);

/* Writes a picture to FOLDER/format with a number: 8 or 16 bits, 1 or 3 channels. */
tides_status td_plane_write(const char *folder, const char *format, unsigned number, const td_member *camera, int32_t bits,
                            int32_t channels, const void *values, tides_error *error);

/* Begins the camera's event file in a format of tides_event_format_at; takes over `path` (NULL: out of memory). td_events_end
 * ends it; it does nothing if no file is open. */
tides_status td_events_begin(const td_writer *w, char *path, const char *format, tides_event_writer **events,
                             tides_error *error);
tides_status td_events_end(const td_writer *w, tides_event_writer **events, tides_error *error);

size_t td_pixels(const td_member *camera);
/* cx and cy with pixel centres at whole numbers, as in OpenCV, ROS and all these layouts; in TIDES centres are at 0.5. */
double td_whole_cx(const td_member *camera);
double td_whole_cy(const td_member *camera);
/* The lens model of a camera, and its coefficients; a pinhole is radtan with zeros. */
const td_lens_model *td_lens_numbers(const td_member *camera, double numbers[TD_COEFFICIENTS_MAX]);
/* TIDES_BAD_CONFIG, naming layout and camera, if a lens isn't among the models up to `most` (TIDES_LENS_*). `least`: radtan
 * must have no k3. */
tides_status td_check_lens(const td_dataset *set, const char *layout, int32_t most, int least, tides_error *error);
/* T_1_0: maps camera 0's coordinates to camera 1's, in metres; row-major 4x4. */
void td_between(const td_dataset *set, const td_member *zero, const td_member *one, double transform[16]);
/* For layouts whose ground truth is numbered as the pictures are: TIDES_BAD_CONFIG unless each ground truth has a picture.
 * td_pictures_per_truth: pictures per ground truth. */
tides_status td_check_numbers(const td_dataset *set, const char *layout, tides_error *error);
size_t td_pictures_per_truth(const td_dataset *set);
/* Distance between two cameras [m]. */
double td_baseline(const td_dataset *set, const td_member *zero, const td_member *one);
/* Writes a line `t ax ay az gx gy gz` [s, m/s^2, rad/s]. */
tides_status td_imu_line(td_text *lines, const tides_imu_sample *sample, tides_error *error);
/* Writes a line `t px py pz qx qy qz qw` [s, m] with the camera's pose in the world. */
tides_status td_pose_line(const td_dataset *set, td_text *lines, const td_place_at *at, tides_error *error);
/* Converts depth to 16 bits: metres times `scale`, 0 if unknown or too large. */
void td_depth_16(const td_dataset *set, const td_member *camera, const double *depth, double scale, uint16_t *out);

#endif
