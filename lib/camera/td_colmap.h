/* Internal: reads COLMAP's cameras.txt and cameras.bin, for the reader of COLMAP's images and for readers of other formats that
 * take their cameras from these files. */
#ifndef TD_COLMAP_H
#define TD_COLMAP_H

#include "tides/camera.h"

typedef struct td_colmap_camera {
    uint32_t id;
    int32_t distorted;           /* 1: no lens of TIDES has this distortion */
    tides_intrinsics intrinsics; /* if distorted, of the pinhole that agrees with the lens at its axis */
} td_colmap_camera;

typedef struct td_colmap_cameras {
    td_colmap_camera *list;
    size_t count, capacity;
} td_colmap_cameras;

/* 1 if the last part of the path `file`, behind its folders, is `name`. */
int td_colmap_is_named(const char *file, const char *name);

/* Reads the cameras in `data`: the contents of a cameras.bin if `binary` is 1, else of a cameras.txt. `data` is `bytes` long,
 * with a NUL behind its last byte. Errors call it `file`. Models 0 (SIMPLE_PINHOLE) to 10 (THIN_PRISM_FISHEYE) of COLMAP are
 * read. On success the caller frees cameras->list. TIDES_BAD_FILE: the data are malformed or hold no camera; TIDES_UNSUPPORTED:
 * an unknown model; TIDES_NO_MEMORY. */
tides_status td_colmap_parse_cameras(const char *file, const char *data, size_t bytes, int binary, td_colmap_cameras *cameras,
                                     tides_error *error);

/* Reads the cameras.bin or cameras.txt in the folder that holds `file`. If both exist, it reads cameras.bin if `binary` is 1,
 * else cameras.txt. TIDES_FILE_NOT_FOUND: neither exists. Other failures are those of td_colmap_parse_cameras. */
tides_status td_colmap_load_cameras(const char *file, int binary, td_colmap_cameras *cameras, tides_error *error);

/* The camera with this id, or NULL. */
const td_colmap_camera *td_colmap_find(const td_colmap_cameras *cameras, uint32_t id);

#endif
