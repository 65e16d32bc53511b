/* A run as a folder of a dataset that other people's loaders open: events, pictures, depth, flow, masks, poses and calibration
 * of every camera of its rig, in one layout or several at once. */
#ifndef TIDES_DATASET_H
#define TIDES_DATASET_H

#include "tides/session.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A layout: its name ("dsec"), a few words, and whether it has lengths in metres: scene.metres_per_unit must then be known. */
typedef struct tides_dataset_layout {
    const char *name, *summary; /* static storage */
    int32_t metric;             /* 1: it has lengths in metres */
    int32_t reserved;
} tides_dataset_layout;

/* Layout number `index` from 0 on; 1, or 0 behind the last. */
TIDES_API int32_t tides_dataset_layout_at(size_t index, tides_dataset_layout *layout);

/* Result of writing a dataset. Plain value. */
typedef struct tides_dataset_report {
    uint64_t events;                 /* of all cameras */
    int32_t cameras;                 /* of the rig; 1 without one */
    int32_t pictures, truths, poses; /* of each camera: frames, frames of ground truth, poses */
    int32_t unseeing;                /* cameras of events that had nothing of the scene in view, at any time */
    int32_t reserved;
} tides_dataset_report;

/* Simulates every camera of the session's rig (rig.cameras; without one the run's camera, as "left") once, renders pictures at
 * dataset.picture_hz and ground truth at dataset.truth_hz, and writes them in the `layouts` ("ecd,dsec", names separated by
 * commas). They go into `folder`, or with several layouts into a folder in it for each, beside contact.png, a picture of the
 * dataset. `folder` must not exist. It is written as FOLDER.part and renamed: it is there whole or not at all. Where it is
 * stopped (TIDES_CANCELLED), dies or has no room, FOLDER.part keeps the events of all cameras so far. The next call with that
 * folder goes on from them if they are of the same run; another process that writes it is TIDES_WRITE_FAILED. Times are the
 * run's, on whole microseconds. TIDES_BAD_CONFIG names what a layout lacks: a scale in metres, cameras that it has no place
 * for. `report` is nullable. */
TIDES_MUST_CHECK TIDES_API tides_status tides_dataset_write(tides_session *session, const char *folder, const char *layouts,
                                                            tides_progress progress, void *user, tides_dataset_report *report,
                                                            tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
