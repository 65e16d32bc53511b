/* Camera paths that are folders (COLMAP's, nerfstudio's, EuRoC's ...): which file of it to read. Reading is the format's. */
#include "camera/td_path_reader.h"

#include "td_base.h"

#include <stdlib.h>
#include <sys/stat.h>

/* What is looked for, in this order: datasets that hold several mean the first. */
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
                                     "camera"};
enum { PLACES = sizeof places / sizeof places[0] };

tides_status td_path_find(const char *folder, char **file, tides_error *error) {
    for (size_t k = 0; k < PLACES; k++) {
        struct stat facts;
        *file = td_format(error, "%s/%s", folder, places[k]);
        if (!*file) return TIDES_NO_MEMORY;
        if (stat(*file, &facts) == 0) return TIDES_OK;
        free(*file);
        *file = NULL;
    }
    return TIDES_OK;
}
