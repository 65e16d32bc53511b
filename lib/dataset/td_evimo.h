/* Internal: writes the dict `meta` of EVIMO2's layout, which describes its images, poses and IMU. */
#ifndef TD_EVIMO_H
#define TD_EVIMO_H

#include "archive/td_pickler.h"
#include "td_dataset.h"

enum { TD_EVIMO_POSES = 1, TD_EVIMO_IMU, TD_EVIMO_FRAMES };

typedef struct td_evimo_meta {
    td_pickler pickler;
    int section;  /* the open list: TD_EVIMO_*; 0: none */
    size_t count; /* number of its items */
} td_evimo_meta;

void td_evimo_begin(td_evimo_meta *meta, tides_error *error);
/* Add to the lists: the poses of the camera and (in its axes) of all objects; an IMU reading; a ground truth. `picture`: 1 if
 * a picture has the same number. */
void td_evimo_pose(td_evimo_meta *meta, const td_writer *w, const td_place_at *at);
void td_evimo_imu(td_evimo_meta *meta, const td_writer *w, const tides_imu_sample *sample);
void td_evimo_frame(td_evimo_meta *meta, const td_writer *w, size_t id, const td_place_at *at, int32_t picture);

/* Writes the dict to `npy` as "meta", frees all, and returns the status of all calls. */
tides_status td_evimo_end(td_evimo_meta *meta, const td_writer *w, td_npy_writer *npy);

#endif
