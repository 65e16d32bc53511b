/* Internal: the parts of a checkpoint: its file as sealed bytes, and what tells one run from another. checkpoint.c documents
 * the layout. */
#ifndef TD_CHECKPOINT_H
#define TD_CHECKPOINT_H

#include "archive/td_h5_place.h"
#include "td_simulator.h"

/* Raised when a reader of the version before couldn't make sense of the file. */
#define TD_CHECKPOINT_FORMAT "tides-checkpoint"
enum { TD_CHECKPOINT_VERSION = 4 };

/* -- the file (checkpoint_file.c) -- */

/* A 64-bit checksum that goes on from `sum` (0 to begin): for damage and mix-ups, not against forgery. */
uint64_t td_checksum(uint64_t sum, const void *data, size_t bytes);

/* A new HDF5 file in memory; negative on failure. */
hid_t td_checkpoint_image_create(void);

/* Writes the image and its seal beside `path` and renames. */
tides_status td_checkpoint_image_write(hid_t image, const char *path, tides_error *error);

/* Opens a file whose seal is whole, in memory. TIDES_FILE_NOT_FOUND, TIDES_BAD_FILE. */
tides_status td_checkpoint_image_read(const char *path, hid_t *image, tides_error *error);

/* -- what run it is (checkpoint_facts.c) -- */

/* A fact that must be the same for both parts of a run. */
typedef struct td_fact {
    const char *key; /* attribute; for people, the run file's key where there is one */
    int is_checksum;
    double number; /* where it isn't a checksum */
    uint64_t checksum;
} td_fact;

enum { TD_FACTS = 26 };
tides_status td_facts_gather(const tides_simulator *simulator, td_fact facts[TD_FACTS], tides_error *error);

/* TIDES_BAD_CONFIG naming the first key that two run files (JSON) have different values of, other than those that don't change
 * the events so far: time.stop, device. */
tides_status td_facts_compare_runs(const char *path, const char *saved, const char *given, tides_error *error);

/* -- the pixels (checkpoint_pixels.c) -- */

/* State that only some runs have: the sensor's, and what is kept of samples (checkpoint_optional.c). */
enum { TD_OPTIONAL_REALS = 11 + TD_FRONTEND_STATE, TD_OPTIONAL_COUNTS = 3 };
double *td_optional_real(const tides_simulator *simulator, int which); /* in the tiles' order; NULL: this run hasn't got it */
uint32_t *td_optional_count(const tides_simulator *simulator, int which);
extern const char *const td_optional_real_name[TD_OPTIONAL_REALS], *const td_optional_count_name[TD_OPTIONAL_COUNTS];

/* The state of all pixels in image order, the tiles' risk, and the estimated timing errors. */
typedef struct td_planes {
    double *signal, *signal_dot, *initial; /* (height x width) */
    uint32_t *count_on, *count_off;
    double *tile_risk;               /* (tiles) */
    double *real[TD_OPTIONAL_REALS]; /* (height x width) each; NULL where the run has no such state */
    uint32_t *count[TD_OPTIONAL_COUNTS];
    double timing[TD_TIMING_BINS];
} td_planes;

tides_status td_planes_create(td_planes *planes, const tides_simulator *simulator, tides_error *error);
void td_planes_free(td_planes *planes);
void td_planes_take(td_planes *planes, const tides_simulator *simulator); /* out of the simulator */
void td_planes_give(const td_planes *planes, tides_simulator *simulator); /* and into one, with the references */
tides_status td_planes_write(td_planes *planes, const tides_simulator *simulator, const td_place *root);
tides_status td_planes_read(td_planes *planes, const tides_simulator *simulator, const td_place *root);

/* -- the readout (checkpoint_readout.c): nothing where the run has none -- */

tides_status td_readout_write(const tides_simulator *simulator, const td_place *root);
/* A new arbiter in the state of the file: the caller's, also after a failure, where it may be NULL. */
tides_status td_readout_read(const tides_simulator *simulator, const td_place *root, tides_arbiter **arbiter);

/* -- the statistics (checkpoint_totals.c) -- */

enum { TD_TOTALS = 43 };
tides_status td_totals_write(const tides_simulator *simulator, const td_place *place);
tides_status td_totals_read(const td_place *place, double values[TD_TOTALS]);

/* What the simulator has done so far (building kernels) stays, and these come on top. */
void td_totals_add(tides_simulator *simulator, const double values[TD_TOTALS]);

#endif
