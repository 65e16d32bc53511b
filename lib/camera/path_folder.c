/* Finds the camera path within a folder (of COLMAP, nerfstudio, EuRoC ...): the first file of a known name. */
#include "camera/td_path_reader.h"

#include "td_base.h"
#include "td_folder.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Names to look for. The order decides if a dataset has several of them. */
static const char *const places[] = {"images.bin",
                                     "images.txt",
                                     "sparse/0/images.bin",
                                     "sparse/0/images.txt",
                                     "sparse/images.bin",
                                     "sparse/images.txt",
                                     "0/images.bin",
                                     "0/images.txt",
                                     "colmap/sparse/0/images.bin",
                                     "transforms.json",
                                     "transforms_train.json",
                                     "cameras.json",
                                     "poses_bounds.npy",
                                     "data.csv",
                                     "state_groundtruth_estimate0/data.csv",
                                     "mav0/state_groundtruth_estimate0/data.csv",
                                     "camera",
                                     "groundtruth.txt",
                                     "stamped_groundtruth.txt"};
enum { PLACES = sizeof places / sizeof places[0] };

/* 1 if the file is an images.txt without a cameras file beside it. The Event Camera Dataset has an images.txt that isn't
 * COLMAP's. */
static int is_alone(const char *file, tides_error *error) {
    if (strncmp(td_base_name(file), "images.", 7) != 0) return 0;
    int found = 0;
    for (int i = 0; i < 2 && !found; i++) {
        char *cameras = td_beside(file, i ? "cameras.txt" : "cameras.bin", error);
        found = cameras && td_is_file(cameras);
        free(cameras);
    }
    return !found;
}

tides_status td_path_find(const char *folder, char **file, tides_error *error) {
    char *alone = NULL; /* read only if nothing else is found; the reader's error then says what is missing */
    *file = NULL;
    for (size_t k = 0; k < PLACES && !*file; k++) {
        struct stat facts;
        char *one = td_format(error, "%s/%s", folder, places[k]);
        if (!one) {
            free(alone);
            return TIDES_NO_MEMORY;
        }
        if (stat(one, &facts) != 0)
            free(one);
        else if (!is_alone(one, error))
            *file = one;
        else if (!alone)
            alone = one;
        else
            free(one);
    }
    if (*file)
        free(alone);
    else
        *file = alone;
    return TIDES_OK;
}
