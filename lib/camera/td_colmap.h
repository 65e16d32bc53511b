/* Internal: COLMAP's cameras.txt and cameras.bin, for the readers of its images and of formats that borrow its cameras. */
#ifndef TD_COLMAP_H
#define TD_COLMAP_H

#include "tides/camera.h"

typedef struct td_colmap_camera {
    uint32_t id;
    int32_t distorted; /* 1: the model bends lines as no lens here does */
    tides_intrinsics intrinsics;
} td_colmap_camera;

typedef struct td_colmap_cameras {
    td_colmap_camera *list;
    size_t count, capacity;
} td_colmap_cameras;

/* 1 where the file's name, folders apart, is `name`. */
int td_colmap_is_named(const char *file, const char *name);

/* Reads `bytes` that end in a NUL; `file` is for messages. All models; an empty list is TIDES_BAD_FILE. On success the caller
 * frees the list. TIDES_BAD_FILE, TIDES_UNSUPPORTED (an unknown model), TIDES_NO_MEMORY. */
tides_status td_colmap_parse_cameras(const char *file, const char *data, size_t bytes, int binary, td_colmap_cameras *cameras,
                                     tides_error *error);

/* The cameras.bin or cameras.txt beside `file`, whichever is of its kind first. TIDES_FILE_NOT_FOUND where there is none. */
tides_status td_colmap_load_cameras(const char *file, int binary, td_colmap_cameras *cameras, tides_error *error);

/* NULL where there is none. */
const td_colmap_camera *td_colmap_find(const td_colmap_cameras *cameras, uint32_t id);

#endif
