/* Internal: a place in an HDF5 file, the root or a group (scenes, checkpoints). Attributes and whole datasets are read and
 * written there, and each error names the file and the place.
 *
 * HDF5 prints its error stack on stderr for each failure. Callers switch that off (H5E_BEGIN_TRY) around all use of these
 * functions. */
#ifndef TD_H5_PLACE_H
#define TD_H5_PLACE_H

#include "tides/base.h"

#include <hdf5.h>

/* An open file or group, and its name in messages. */
typedef struct td_place {
    hid_t id;
    const char *file; /* the path */
    char where[64];   /* "/" or "/objects/0" */
    tides_error *error;
} td_place;

/* Opens (or creates) the group `name` within `parent`; the caller closes `place->id` with H5Gclose. */
tides_status td_place_open(const td_place *parent, const char *name, td_place *place);
tides_status td_place_create(const td_place *parent, const char *name, td_place *place);

/* The number of links (or attributes), and the name of the i-th in alphabetical order. A name that doesn't fit in `size`
 * bytes, with its NUL, is TIDES_BAD_FILE. */
size_t td_place_links(const td_place *place);
size_t td_place_attributes(const td_place *place);
tides_status td_place_link_name(const td_place *place, size_t i, char *name, size_t size);
tides_status td_place_attribute_name(const td_place *place, size_t i, char *name, size_t size);

/* The rank of a dataset of floating-point numbers, 1 to TD_PLACE_RANK_MAX; TIDES_BAD_FILE for anything else. */
tides_status td_place_rank(const td_place *place, const char *name, int *rank);

/* 1 if a link of this name exists. */
int td_place_has(const td_place *place, const char *name);

/* Attributes: one number, or one text (UTF-8, allocated on reading). A text of more than 60 000 bytes is a dataset. */
tides_status td_place_read_int(const td_place *place, const char *name, int32_t *value);
tides_status td_place_read_double(const td_place *place, const char *name, double *value);
tides_status td_place_read_text(const td_place *place, const char *name, char **text);
tides_status td_place_write_int(const td_place *place, const char *name, int32_t value);
tides_status td_place_write_double(const td_place *place, const char *name, double value);
tides_status td_place_write_text(const td_place *place, const char *name, const char *text);

/* The largest number of dimensions of an array in a scene file. */
enum { TD_PLACE_RANK_MAX = 4 };

/* The shape of a dataset of floating-point numbers. TIDES_BAD_FILE if its rank isn't `rank`, if it holds other values, or if
 * it claims more values than a file of this size can hold. */
tides_status td_place_shape(const td_place *place, const char *name, int rank, uint64_t shape[TD_PLACE_RANK_MAX]);

/* 1 if a dataset's numbers are wider than single precision. */
int td_place_is_wide(const td_place *place, const char *name);

/* Reads a whole dataset, converted to `memory_type` (H5T_NATIVE_FLOAT, H5T_NATIVE_DOUBLE). td_place_shape gives its size. */
tides_status td_place_read(const td_place *place, const char *name, hid_t memory_type, void *values);

/* Writes a new dataset, stored as `file_type`; `values` are of `memory_type`. It is contiguous, since trained values hardly
 * compress. The file is built in memory, so a failure is TIDES_NO_MEMORY. */
tides_status td_place_write(const td_place *place, const char *name, hid_t file_type, hid_t memory_type, int rank,
                            const uint64_t *shape, const void *values);

#endif
