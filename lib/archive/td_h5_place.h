/* Internal: a place in an HDF5 file (scenes, checkpoints), the root or a group, and what is read and written there: attributes
 * and whole datasets, each with one status and one clear message.
 *
 * HDF5 prints a stack of messages on stderr for each failure unless that is switched off: the entry points of those who use
 * this do so (H5E_BEGIN_TRY) around everything that happens here. */
#ifndef TD_H5_PLACE_H
#define TD_H5_PLACE_H

#include "tides/base.h"

#include <hdf5.h>

/* An open file or group, and what messages call it. */
typedef struct td_place {
    hid_t id;
    const char *file; /* the path */
    char where[64];   /* "/" or "/objects/0" */
    tides_error *error;
} td_place;

/* Opens (or creates) the group `name` within `parent`; the caller closes `place->id` with H5Gclose. */
tides_status td_place_open(const td_place *parent, const char *name, td_place *place);
tides_status td_place_create(const td_place *parent, const char *name, td_place *place);

/* How many links (or attributes) there are, and the name of number i in alphabetical order; names that don't fit in `size`
 * bytes with their NUL are TIDES_BAD_FILE. */
size_t td_place_links(const td_place *place);
size_t td_place_attributes(const td_place *place);
tides_status td_place_link_name(const td_place *place, size_t i, char *name, size_t size);
tides_status td_place_attribute_name(const td_place *place, size_t i, char *name, size_t size);

/* The rank of a dataset of floating-point numbers, 1 to TD_PLACE_RANK_MAX; TIDES_BAD_FILE for anything else. */
tides_status td_place_rank(const td_place *place, const char *name, int *rank);

/* 1 where a link of this name exists. */
int td_place_has(const td_place *place, const char *name);

/* Attributes: one number, or one text (UTF-8, allocated on reading; a dataset where it is long: td_h5.h). */
tides_status td_place_read_int(const td_place *place, const char *name, int32_t *value);
tides_status td_place_read_double(const td_place *place, const char *name, double *value);
tides_status td_place_read_text(const td_place *place, const char *name, char **text);
tides_status td_place_write_int(const td_place *place, const char *name, int32_t value);
tides_status td_place_write_double(const td_place *place, const char *name, double value);
tides_status td_place_write_text(const td_place *place, const char *name, const char *text);

/* As many dimensions as a field of a motion has (td_motion.h). */
enum { TD_PLACE_RANK_MAX = 4 };

/* The shape of a dataset of floating-point numbers; TIDES_BAD_FILE where its rank isn't `rank`, it holds another kind of
 * values, or it claims more of them than a file of this size can hold. */
tides_status td_place_shape(const td_place *place, const char *name, int rank, uint64_t shape[TD_PLACE_RANK_MAX]);

/* 1 where a dataset's numbers are wider than single precision. */
int td_place_is_wide(const td_place *place, const char *name);

/* All of a dataset, converted to `memory_type` (H5T_NATIVE_FLOAT, H5T_NATIVE_DOUBLE); ask for the shape first. */
tides_status td_place_read(const td_place *place, const char *name, hid_t memory_type, void *values);

/* A new dataset: `file_type` as stored, `memory_type` as given. Contiguous, since trained values hardly compress. The file is
 * built in memory, so failures to write are TIDES_NO_MEMORY. */
tides_status td_place_write(const td_place *place, const char *name, hid_t file_type, hid_t memory_type, int rank,
                            const uint64_t *shape, const void *values);

#endif
