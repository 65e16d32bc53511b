/* Internal to lib/checkpoint: the parts of a checkpoint. Its file as sealed bytes, what tells one run from another, the
 * arrays and statistics that the run's parts name themselves. checkpoint.c documents the layout. */
#ifndef TD_CHECKPOINT_H
#define TD_CHECKPOINT_H

#include "archive/td_h5.h"
#include "archive/td_h5_place.h"
#include "solver/td_simulator.h"

/* Raised when a reader of the version before couldn't make sense of the file. */
#define TD_CHECKPOINT_FORMAT "tides-checkpoint"
enum { TD_CHECKPOINT_VERSION = 6 };

/* -- the file (file.c) -- */

/* A new HDF5 file in memory; negative on failure. */
hid_t td_checkpoint_image_create(void);

/* Writes the image and its seal beside `path` and renames. */
tides_status td_checkpoint_image_write(hid_t image, const char *path, tides_error *error);

/* Opens a file whose seal is whole, in memory. TIDES_FILE_NOT_FOUND, TIDES_BAD_FILE. */
tides_status td_checkpoint_image_read(const char *path, hid_t *image, tides_error *error);

/* -- what run it is (facts.c) -- */

/* A fact that must be the same for both parts of a run. */
typedef struct td_fact {
    const char *key; /* attribute; for people, the run file's key where there is one */
    int is_checksum;
    double number; /* where it isn't a checksum */
    uint64_t checksum;
} td_fact;

/* Room for twice what there is (63): a new key needs no thought, and one that finds no room is refused. */
enum { TD_FACTS_MAX = 128 };
typedef struct td_facts {
    td_fact fact[TD_FACTS_MAX];
    int count;
} td_facts;
tides_status td_facts_gather(const tides_simulator *simulator, td_facts *facts, tides_error *error);

/* TIDES_BAD_CONFIG naming the first key that two run files (JSON) have different values of, other than those whose row of the
 * parameter table says that they change no event. */
tides_status td_facts_compare_runs(const char *path, const char *saved, const char *given, tides_error *error);

/* -- the arrays (state.c) -- */

/* The rows of all parts, and a copy of each in the file's order. */
typedef struct td_saved {
    td_state state;
    void *copy[TD_STATE_ROWS];
} td_saved;

/* Room for what this simulator has; td_saved_free frees. */
tides_status td_saved_create(td_saved *saved, const tides_simulator *simulator, tides_error *error);
void td_saved_free(td_saved *saved);
void td_saved_take(td_saved *saved, const tides_simulator *simulator); /* out of the simulator */
void td_saved_give(const td_saved *saved, tides_simulator *simulator); /* and into it */
tides_status td_saved_write(const td_saved *saved, const tides_simulator *simulator, const td_place *root);
tides_status td_saved_read(td_saved *saved, const tides_simulator *simulator, const td_place *root);

/* -- the readout (readout.c): nothing where the run has none -- */

tides_status td_readout_write(const tides_simulator *simulator, const td_place *root);
/* A new arbiter in the state of the file: the caller's, also after a failure, where it may be NULL. */
tides_status td_readout_read(const tides_simulator *simulator, const td_place *root, tides_arbiter **arbiter);

/* -- the statistics (totals.c): those that add up, by the table of tides_stats_table -- */

tides_status td_totals_write(const tides_stats *stats, const td_place *place);
tides_status td_totals_read(const td_place *place, tides_stats *stats);

#endif
