/* Tells if a path given alone is one of frames, by the same features by which the sources recognise their files. */
#include "td_frames.h"

#include "archive/td_h5_driver.h"
#include "archive/td_npy.h"
#include "td_folder.h"

#include <hdf5.h>

#include <stdlib.h>
#include <string.h>

int td_frames_is_video(const char *path) { return strcmp(path, "-") == 0 || td_ends_in(path, ".y4m"); }

static int holds_pictures(const char *path) {
    td_folder list = {NULL, 0, 0};
    const int found = td_folder_list(&list, path, ".png", NULL) == TIDES_OK &&
                      td_folder_list(&list, path, ".exr", NULL) == TIDES_OK && list.count > 0;
    td_folder_free(&list);
    return found;
}

/* 1 for an .npy whose header has the shape (frames, height, width) of numbers. */
static int is_array(const char *path) {
    char head[512] = {0};
    FILE *file = fopen(path, "rb");
    const size_t got = file ? fread(head, 1, sizeof head - 1, file) : 0;
    if (file) fclose(file);
    if (got < 16 || memcmp(head, "\x93NUMPY", 6) != 0) return 0;
    for (size_t i = 0; i < got; i++)
        if (!head[i]) head[i] = ' '; /* within the header's length field */
    const char *shape = strstr(head, "'shape': ("), *end = shape ? strchr(shape, ')') : NULL;
    int numbers = 0;
    for (const char *c = shape; c && c < end; c++) numbers += c[0] >= '0' && c[0] <= '9' && !(c[-1] >= '0' && c[-1] <= '9');
    return numbers == 3 && strstr(head, "'descr': '") != NULL;
}

static int is_archive(const char *path) {
    td_npz *npz = NULL;
    int found = 0;
    if (td_npz_open(path, &npz, NULL) != TIDES_OK) return 0;
    for (size_t i = 0; i < td_npz_count(npz); i++)
        for (const char *const *name = td_frame_arrays; *name; name++) found |= strcmp(td_npz_name(npz, i), *name) == 0;
    td_npz_close(npz);
    return found;
}

static int is_hdf5(const char *path) {
    int found = 0;
    H5E_BEGIN_TRY {
        const hid_t file = td_h5_open_disk(path);
        for (const char *const *name = td_frame_arrays; file >= 0 && *name; name++)
            found |= H5Lexists(file, *name, H5P_DEFAULT) > 0;
        if (file >= 0) H5Fclose(file);
    }
    H5E_END_TRY
    return found;
}

int td_frames_is(const char *path) {
    if (td_frames_is_video(path)) return 1;
    if (td_is_folder(path)) return holds_pictures(path);
    if (!td_is_file(path)) return 0;
    if (td_ends_in(path, ".npy")) return is_array(path);
    if (td_ends_in(path, ".npz")) return is_archive(path);
    return (td_ends_in(path, ".h5") || td_ends_in(path, ".hdf5")) && is_hdf5(path);
}
