/* Internal: camera chains as Kalibr writes them (camchain.yaml, camchain-imucam.yaml). */
#ifndef TD_CAMCHAIN_H
#define TD_CAMCHAIN_H

#include "tides/camera.h"

enum { TD_CAMCHAIN_MOST = 16 }; /* cameras of a chain */

typedef struct td_camchain_camera {
    tides_intrinsics intrinsics; /* pixel centres at halves, as everywhere in TIDES (Kalibr's are at whole numbers) */
    double T_B_C[16];            /* p_body = T_B_C p_camera [m] */
} td_camchain_camera;

/* Cameras cam0, cam1 ... in this order. The body is the IMU if cam0 has a transform to or from it (T_cam_imu, or OpenVINS's
 * T_imu_cam), else cam0. */
typedef struct td_camchain {
    td_camchain_camera camera[TD_CAMCHAIN_MOST];
    int count;
    int has_imu; /* 1: the body is the IMU */
} td_camchain;

/* Reads `text`, which it changes; `file` is for messages. Returns TIDES_BAD_FILE, or TIDES_UNSUPPORTED for another
 * camera_model or distortion_model and for a timeshift_cam_imu other than 0. The error names the line, or camera and key;
 * `chain` is then invalid. */
TIDES_MUST_CHECK tides_status td_camchain_parse(const char *file, char *text, td_camchain *chain, tides_error *error);

#endif
