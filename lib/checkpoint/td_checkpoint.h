/* Internal to lib/checkpoint: the parts of a checkpoint: its file with a checksum, facts that identify the run, and the
 * arrays and statistics that the parts of a run list. */
#ifndef TD_CHECKPOINT_H
#define TD_CHECKPOINT_H

#include "archive/td_h5.h"
#include "archive/td_h5_place.h"
#include "solver/td_reached.h"
#include "solver/td_saved_run.h"

/* The version is raised when older readers would misread the file. */
#define TD_CHECKPOINT_FORMAT "tides-checkpoint"
enum { TD_CHECKPOINT_VERSION = 7 };

/* -- the file -- */

/* A new HDF5 file in memory; negative on failure. */
hid_t td_checkpoint_image_create(void);

/* Writes the image and its checksum to PATH.part, and renames it. */
tides_status td_checkpoint_image_write(hid_t image, const char *path, tides_error *error);

/* Opens a file in memory, if its checksum is right. TIDES_FILE_NOT_FOUND, TIDES_BAD_FILE. */
tides_status td_checkpoint_image_read(const char *path, hid_t *image, tides_error *error);

/* -- facts that identify the run -- */

/* A fact that must be the same for both parts of a run. */
typedef struct td_fact {
    const char *key; /* name of the attribute: the run file's key, if there is one */
    int is_checksum;
    double number; /* unless it is a checksum */
    uint64_t checksum;
} td_fact;

/* Room for twice the present number (63); a fact without room is refused. */
enum { TD_FACTS_MAX = 128 };
typedef struct td_facts {
    td_fact fact[TD_FACTS_MAX];
    int count;
} td_facts;
tides_status td_facts_gather(const tides_simulator *simulator, td_facts *facts, tides_error *error);

/* Fails with TIDES_BAD_CONFIG, naming the first key whose values in two run files (JSON) differ. Keys that change no event
 * are ignored. */
tides_status td_facts_compare_runs(const char *path, const char *saved, const char *given, tides_error *error);

/* -- the arrays -- */

/* The rows of all parts of a run, and a copy of each in the file's order. */
typedef struct td_saved {
    td_state state;
    void *copy[TD_STATE_ROWS];
} td_saved;

/* Allocates copies for this simulator's rows; td_saved_free frees them. */
tides_status td_saved_create(td_saved *saved, const tides_simulator *simulator, tides_error *error);
void td_saved_free(td_saved *saved);
void td_saved_take(td_saved *saved, const tides_simulator *simulator); /* copies from the simulator */
void td_saved_give(const td_saved *saved, tides_simulator *simulator); /* copies to the simulator */
tides_status td_saved_write(const td_saved *saved, const tides_simulator *simulator, const td_place *root);
tides_status td_saved_read(td_saved *saved, const tides_simulator *simulator, const td_place *root);

/* -- the readout: nothing happens in a run without one -- */

tides_status td_readout_write(const tides_simulator *simulator, const td_place *root);
/* Reads the state into a new arbiter, which belongs to the caller; after a failure it may be NULL. */
tides_status td_readout_read(const tides_simulator *simulator, const td_place *root, tides_arbiter **arbiter);

/* -- the statistics that add up -- */

tides_status td_totals_write(const tides_stats *stats, const td_place *place);
tides_status td_totals_read(const td_place *place, tides_stats *stats);

#endif
