/* Internal: maps of a sensor's pixels from a file: arrays of the image's size, by name. Any map may be missing, and any pixel
 * may be NaN: its value is then drawn as without a file. */
#ifndef TD_MAPS_H
#define TD_MAPS_H

#include "td_base.h"

/* threshold_on, threshold_off [log units]; leak [Hz of ON events]; noise [Hz of both polarities, in the dark]; hot [Hz of ON
 * events]; dead [0 or 1]; noise_size [of additive noise, over the nominal pixel's]. */
enum { TD_MAP_ON = 0, TD_MAP_OFF, TD_MAP_LEAK, TD_MAP_NOISE, TD_MAP_HOT, TD_MAP_DEAD, TD_MAP_SIZE, TD_MAPS };
extern const char *const td_map_names[TD_MAPS];

typedef struct td_maps {
    double *map[TD_MAPS]; /* (width height), row by row; NULL: not in the file */
    uint64_t checksum;    /* of all values; 0: no file */
} td_maps;

/* Reads an .npy (structured), .npz or HDF5 file, which must have at least one map. TIDES_BAD_FILE names map and pixel. */
TIDES_MUST_CHECK tides_status td_maps_read(const char *path, int32_t width, int32_t height, td_maps *maps, tides_error *error);
void td_maps_release(td_maps *maps);

/* 1 where the map has a value for the pixel. */
static inline int td_maps_has(const td_maps *maps, int which, uint32_t pixel) {
    return maps->map[which] && maps->map[which][pixel] == maps->map[which][pixel];
}

/* Writes all maps as HDF5; the file appears whole or not at all. */
TIDES_MUST_CHECK tides_status td_maps_write(const char *path, int32_t width, int32_t height, const td_maps *maps,
                                            tides_error *error);

#endif
