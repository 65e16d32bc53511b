/* Internal: what a sequence has, and what a layout makes of it. dataset.c makes everything once and gives it to each layout
 * as it comes; a layout is a file of functions that write, and knows no other. */
#ifndef TD_DATASET_H
#define TD_DATASET_H

#include "td_base.h"
#include "camera/td_lens_models.h"
#include "td_text.h"
#include "tides/dataset.h"
#include "tides/image.h"
#include "tides/truth.h"

/* -- what there is --------------------------------------------------------------------------------------------------------- */

/* How a camera is looked through: as it is, or rectified: as a pinhole in its place, turned, of as many pixels. */
typedef struct td_view {
    tides_intrinsics intrinsics;
    double rotation[9];           /* from the camera's coordinates to the view's */
    const tides_trajectory *path; /* of the view */
    tides_trajectory *own;        /* the same, where it isn't the camera's */
    int32_t differs;              /* 0: it is what the camera sees */
} td_view;

/* Use of a rectified view: ground truth is the event cameras', rectified as a pair; pictures are the others'. */
enum { TD_TRUTH, TD_PICTURE, TD_KINDS };

/* A camera of the rig, varied from the session that was given. */
typedef struct td_member {
    char name[TIDES_RIG_NAME];
    double T_B_C[16];
    tides_session *session;
    int32_t owned;          /* the session is to be closed */
    int32_t event, picture; /* number among cameras that make events, or pictures: 0 is left, 1 right; -1: makes none */
    tides_session_facts facts;
    td_view rectified[TD_KINDS]; /* where a layout asks for them; of each kind that the camera makes */
} td_member;

typedef struct td_dataset {
    td_member *cameras;
    size_t count, event_cameras, picture_cameras;
    const char *name; /* of the sequence: the folder's last part */
    double metres;    /* of a unit; 0: unknown */
    double picture_hz, truth_hz, pose_hz;
    size_t pictures, truths, poses; /* of each camera */
    int64_t start_us, stop_us;      /* of all but events and IMU: within, whole exposures have room */
    int32_t exposed;                /* the run gives exposure.exposure_s */
    int32_t has_imu; /* the run says where down is (imu.down), or that there is no gravity; and the scale in metres */
} td_dataset;

/* Time number k of a rate, on whole microseconds: files have no finer ones, and what they say is then exactly where all was. */
int64_t td_dataset_us(const td_dataset *set, double hz, size_t k);
static inline double td_seconds(int64_t us) { return (double)us / 1e6; } /* the double that is nearest, as the decimal text's */
static inline double td_event_seconds(const tides_event *event) { return (double)event->t / 1e9; }

/* A picture, 8 bits: an instant's in sRGB, or exposed as the run says. Times are the exposure's middle, start and end. */
typedef struct td_picture {
    size_t index;
    int64_t us, from_us, to_us;
    const uint8_t *grey, *rgb; /* (height x width), (height x width x 3) */
} td_picture;

/* Ground truth at a time. Planes are (height x width). */
typedef struct td_truth {
    size_t index;
    int64_t us, next_us, before_us;    /* next_us, before_us: of the displacements */
    const double *flow_u, *flow_v;     /* [px/s] */
    const double *depth;               /* of the median splat [scene units]; 0: none */
    const double *instance;            /* -1: none */
    const double *next_u, *next_v;     /* displacement to next_us [px], NaN: unknown; NULL: this is the last */
    const double *next_seen;           /* 1: seen there as well */
    const double *before_u, *before_v; /* to before_us; NULL: this is the first */
} td_truth;

/* A camera's place in the world [scene units]. */
typedef struct td_place_at {
    int64_t us;
    double position[3], quaternion[4], rotation[9]; /* wxyz */
} td_place_at;

/* Where it is at a time. */
tides_status td_place(const td_member *camera, int64_t us, td_place_at *place, tides_error *error);

/* -- layouts --------------------------------------------------------------------------------------------------------------- */

/* One layout being written: of each camera in turn. */
typedef struct td_layout td_layout;
typedef struct td_writer {
    const td_layout *layout;
    const td_dataset *set;
    const td_member *camera;
    char *root;   /* the layout's folder */
    char *folder; /* the camera's: root, or a folder in it where the layout has one for each */
    void *state;  /* the layout's, of this camera */
    void *kept;   /* the layout's, of all cameras */
} td_writer;

/* NULL where a layout has no use for it. `begin` and `end` are around each camera; `complete` is after all, and `drop` frees
 * both states whatever happened. */
struct td_layout {
    const char *name, *summary;
    int32_t metric, per_camera;
    int32_t rectified; /* pictures and ground truth are those of rectified views */
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
extern const td_layout td_layout_contact; /* contact.png: of every dataset */

/* rectify.c: rectified views of all cameras: pairs of event cameras and of picture cameras look the same way, across what is
 * between them. TIDES_BAD_CONFIG names two that can't. To be released in any case. */
tides_status td_rectify(td_dataset *set, tides_error *error);
void td_rectify_release(td_member *camera);
/* The camera that is number `side` (0: left, 1: right) among those of a kind; NULL: none. */
const td_member *td_find_camera(const td_dataset *set, int kind, int side);

/* exposed.c: when a picture at `us` is exposed, all rows together, on whole microseconds. */
void td_exposed_between(const td_member *camera, int64_t us, int64_t *from_us, int64_t *to_us);

/* Room for an exposed picture: planes of (pixels) each. */
typedef struct td_exposed {
    double *light;    /* four planes */
    uint16_t *values; /* three */
    uint8_t *rgb;     /* (pixels x 3), result */
    uint8_t *grey;    /* (pixels), result */
} td_exposed;

/* Exposes a picture as the camera's run says. */
tides_status td_exposed_make(const td_member *camera, const tides_trajectory *path, tides_renderer *renderer,
                             const td_picture *picture, const td_exposed *to, tides_error *error);

/* scenes.c: pictures and ground truth of a camera, to every layout. */
typedef struct td_scenes {
    td_writer *writers;
    size_t count;
    tides_progress step;
    void *user;
} td_scenes;
tides_status td_scenes_give(const td_scenes *to, const td_dataset *set, const td_member *camera, tides_error *error);

/* -- what layouts share: folder.c, values.c -------------------------------------------------------------------------- */

/* FOLDER/name, made by td_format's rules; NULL where out of memory. And the folders above a file, where they are missing. */
char *td_in_folder(const char *folder, tides_error *error, const char *format, ...) TD_PRINTF(3, 4);
tides_status td_make_parents(const char *file, tides_error *error);
void td_remove_folder(const char *path);                    /* with all that is in it */
void td_empty_folder(const char *path, const char *except); /* of all but this name; NULL: of all */

/* A new text file, FOLDER/name. */
tides_status td_text_in_folder(td_text *text, const char *folder, const char *name, tides_error *error);

/* Pictures at FOLDER/format with a number: 8 or 16 bits, 1 or 3 channels. */
tides_status td_plane_write(const char *folder, const char *format, unsigned number, const td_member *camera, int32_t bits,
                            int32_t channels, const void *values, tides_error *error);

/* The camera's event file in one of tides_event_format_at's formats; takes over `path`, NULL being out of memory. And its end:
 * one that isn't open is fine, and none is open after it. */
tides_status td_events_begin(const td_writer *w, char *path, const char *format, tides_event_writer **events,
                             tides_error *error);
tides_status td_events_end(const td_writer *w, tides_event_writer **events, tides_error *error);

size_t td_pixels(const td_member *camera);
/* cx and cy where pixel centres are whole numbers, as OpenCV, ROS and all these layouts have them: ours are at 0.5. */
double td_whole_cx(const td_member *camera);
double td_whole_cy(const td_member *camera);
/* The lens as files have it: its coefficients, and its model; a pinhole is a radtan of zeros. */
const td_lens_model *td_lens_numbers(const td_member *camera, double numbers[TD_COEFFICIENTS_MAX]);
/* TIDES_BAD_CONFIG, naming the layout and the camera, where a camera's lens is another one than up to `most`: TIDES_LENS_*.
 * `least`: radtan without k3. */
tides_status td_check_lens(const td_dataset *set, const char *layout, int32_t most, int least, tides_error *error);
/* T_1_0: from camera 0's coordinates to camera 1's, in metres; row-major 4x4. */
void td_between(const td_dataset *set, const td_member *zero, const td_member *one, double transform[16]);
/* TIDES_BAD_CONFIG where a layout's ground truth has the numbers of pictures and not each has one; and how many of these there
 * are to one of those. */
tides_status td_check_numbers(const td_dataset *set, const char *layout, tides_error *error);
size_t td_pictures_per_truth(const td_dataset *set);
/* [m] from one camera to the other. */
double td_baseline(const td_dataset *set, const td_member *zero, const td_member *one);
/* `t ax ay az gx gy gz` [s, m/s^2, rad/s]. */
tides_status td_imu_line(td_text *lines, const tides_imu_sample *sample, tides_error *error);
/* `t px py pz qx qy qz qw` [s, m]: of the camera in the world. */
tides_status td_pose_line(const td_dataset *set, td_text *lines, const td_place_at *at, tides_error *error);
/* 16-bit depth: metres times `scale`, 0 where unknown or beyond. */
void td_depth_16(const td_dataset *set, const td_member *camera, const double *depth, double scale, uint16_t *out);

#endif
