/* A run as the folder of a dataset that other people's loaders open: events, pictures, depth, flow, masks, poses and
 * calibration of every camera of its rig, in one or several layouts. */
#ifndef TIDES_DATASET_H
#define TIDES_DATASET_H

#include "tides/session.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A layout: its name ("dsec"), a short summary, and whether its lengths are in metres; scene.metres_per_unit is then
 * required. */
typedef struct tides_dataset_layout {
    const char *name, *summary; /* static storage */
    int32_t metric;             /* 1: lengths are in metres */
    int32_t reserved;
} tides_dataset_layout;

/* Layout number `index`, from 0. Returns 1, or 0 if there is none. */
TIDES_API int32_t tides_dataset_layout_at(size_t index, tides_dataset_layout *layout);

/* Result of writing a dataset. Plain value. */
typedef struct tides_dataset_report {
    uint64_t events;                 /* of all cameras */
    int32_t cameras;                 /* of the rig; 1 without one */
    int32_t pictures, truths, poses; /* of each camera: frames, frames of ground truth, poses */
    int32_t unseeing;                /* event cameras that never had the scene in view */
    int32_t reserved;
} tides_dataset_report;

/* Writes a dataset. Each camera of the session's rig (rig.cameras; else the run's camera, as "left") is simulated once.
 * Pictures are rendered at dataset.picture_hz, ground truth at dataset.truth_hz. `layouts` are names separated by commas
 * ("ecd,dsec").
 *
 * Files go into `folder`, with several layouts into a folder in it for each. A picture of the dataset, contact.png, is beside
 * them. `folder` must not exist. It is written as FOLDER.part and renamed, so that it is complete or doesn't exist. If the
 * call is stopped (TIDES_CANCELLED) or fails, FOLDER.part keeps the events so far, and the next call of the same run
 * continues from them. TIDES_WRITE_FAILED: another process writes it. Times are the run's, in whole microseconds.
 * TIDES_BAD_CONFIG: a layout lacks something, such as a scale in metres. `report` is nullable. */
TIDES_MUST_CHECK TIDES_API tides_status tides_dataset_write(tides_session *session, const char *folder, const char *layouts,
                                                            tides_progress progress, void *user, tides_dataset_report *report,
                                                            tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
