/* Saves and restores a simulator: a run cut between two steps continues as if it had never stopped, to the bit.
 *
 * The state between two steps is S and S_dot, and per pixel the initial S and the number of events; the reference follows
 * from these. Layout of the HDF5 file, version 7 (1 lacked the totals of motion; in 2 `time` was absolute; 3 lacked the
 * totals of probes; 4 had other names for some totals; 5 had fewer keys in /run_is; 6 had sums of squares in place of the
 * number of measured events):
 *
 *     /                    attributes  format           text    "tides-checkpoint"
 *                                      version          int     7
 *                                      tides_version    text    of the writer; for people
 *                                      run              text    the run file as JSON, or ""
 *                                      step             double  number of the grid point reached
 *                                      time             double  [s after the start] where that is
 *                                      ended            int     1: this is the run's end, which no longer run can continue
 *                                      last_event       text    "t_ns x y polarity", identifies its recording; or ""
 *    /run_is              attributes  facts that decide events: a double, or 16 hexadecimal digits; named by the key
 *    /statistics          attributes  a double each: totals of the statistics that add up
 *     /signal, /signal_dot double (height x width)  S [log units], S_dot [log units/s]
 *     /initial             double (height x width)  S_init [log units]
 *     /count_on, /count_off  u4   (height x width)  n_on, n_off
 *     /tile_risk           double (tiles)           risk of each 16x16 tile, in reading order
 *    /held_until ...      double, u4 (height x width)  state of the sensor's blocks that are on
 *     /readout             i8                       state of the arbiter, if the run has one
 *     /filters             i8                       state of the filters, if the run has some
 *     /timing_errors       double (512)             weights of the statistics of timing errors
 *     /timing_measured     double (1)               number of measured events
 *
 * Each array is a row of the state that the simulator's parts list. Images are in image order (except the risk), so that a
 * run with other tiles can continue. All datasets are shuffled and deflated. The HDF5 file is followed by a line with its
 * checksum (file.c). */
#include "td_checkpoint.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* -- facts ----------------------------------------------------------------------------------------------------------------- */

static void print_checksum(uint64_t checksum, char text[17]) { snprintf(text, 17, "%016" PRIx64, checksum); }

static tides_status write_facts(const td_place *place, const td_facts *facts) {
    tides_status status = TIDES_OK;
    for (int i = 0; i < facts->count && status == TIDES_OK; i++) {
        char text[17];
        const td_fact *fact = &facts->fact[i];
        print_checksum(fact->checksum, text);
        status = fact->is_checksum ? td_place_write_text(place, fact->key, text)
                                   : td_place_write_double(place, fact->key, fact->number);
    }
    return status;
}

static tides_status check_fact(const td_place *place, const td_fact *fact) {
    if (fact->is_checksum) {
        char wanted[17], *found = NULL;
        print_checksum(fact->checksum, wanted);
        tides_status status = td_place_read_text(place, fact->key, &found);
        if (status == TIDES_OK && strcmp(found, wanted) != 0)
            status =
                td_fail(place->error, TIDES_BAD_CONFIG, "%s: is of another run: the %s changed since", place->file, fact->key);
        free(found);
        return status;
    }
    double found = 0;
    tides_status status = td_place_read_double(place, fact->key, &found);
    if (status == TIDES_OK && found != fact->number)
        status = td_fail(place->error, TIDES_BAD_CONFIG, "%s: is of another run: %s is %.15g there and %.15g here", place->file,
                         fact->key, found, fact->number);
    return status;
}

static tides_status check_facts(const td_place *place, const td_facts *facts) {
    tides_status status = TIDES_OK;
    for (int i = 0; i < facts->count && status == TIDES_OK; i++) status = check_fact(place, &facts->fact[i]);
    return status;
}

/* -- saving ---------------------------------------------------------------------------------------------------------------- */

static tides_status write_last(const td_place *root, const tides_event *last) {
    char text[64] = "";
    if (last) snprintf(text, sizeof text, "%" PRId64 " %u %u %d", last->t, last->x, last->y, last->polarity);
    return td_place_write_text(root, "last_event", text);
}

static tides_status write_root(const td_place *root, const tides_simulator *s, const char *run) {
    const td_reached reached = td_simulator_reached(s);
    tides_status status = td_place_write_text(root, "format", TD_CHECKPOINT_FORMAT);
    if (status == TIDES_OK) status = td_place_write_int(root, "version", TD_CHECKPOINT_VERSION);
    if (status == TIDES_OK) status = td_place_write_text(root, "tides_version", tides_version());
    if (status == TIDES_OK) status = td_place_write_text(root, "run", run ? run : "");
    if (status == TIDES_OK) status = td_place_write_double(root, "step", (double)reached.step);
    if (status == TIDES_OK) status = td_place_write_double(root, "time", reached.seconds);
    if (status == TIDES_OK) status = td_place_write_int(root, "ended", reached.step == td_simulator_saved(s).steps);
    return status == TIDES_OK ? write_last(root, td_simulator_last(s)) : status;
}

static tides_status write_all(const td_place *root, const tides_simulator *s, const char *run, const td_facts *facts,
                              const td_saved *saved) {
    td_place group;
    tides_stats totals;
    tides_status status = write_root(root, s, run);
    if (status == TIDES_OK) status = td_place_create(root, "run_is", &group);
    if (status != TIDES_OK) return status;
    status = write_facts(&group, facts);
    H5Gclose(group.id);
    if (status == TIDES_OK) status = td_place_create(root, "statistics", &group);
    if (status != TIDES_OK) return status;
    tides_simulator_stats(s, &totals);
    status = td_totals_write(&totals, &group);
    H5Gclose(group.id);
    if (status == TIDES_OK) status = td_readout_write(s, root);
    return status == TIDES_OK ? td_saved_write(saved, s, root) : status;
}

static tides_status save(const tides_simulator *s, const char *run, const char *path, const td_facts *facts,
                         const td_saved *saved, tides_error *error) {
    td_place root = {.id = td_checkpoint_image_create(), .file = path, .where = "/", .error = error};
    if (root.id < 0) return td_fail(error, TIDES_NO_MEMORY, "%s: a file in memory can't be made", path);
    tides_status status = write_all(&root, s, run, facts, saved);
    if (status == TIDES_OK) status = td_checkpoint_image_write(root.id, path, error);
    H5Fclose(root.id);
    return status;
}

tides_status tides_simulator_save(const tides_simulator *simulator, const char *run, const char *path, tides_error *error) {
    if (!simulator || !path)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_simulator_save: simulator and path must be given");
    if (td_simulator_reached(simulator).broken)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: an earlier error left a step half done: there is no state to save",
                       path);
    if (!td_simulator_reached(simulator).started)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: the run hasn't begun: call tides_simulator_run first", path);
    td_facts facts;
    td_saved saved;
    tides_status status = td_facts_gather(simulator, &facts, error);
    if (status == TIDES_OK) status = td_saved_create(&saved, simulator, error);
    if (status != TIDES_OK) return status;
    td_saved_take(&saved, simulator);
    H5E_BEGIN_TRY { status = save(simulator, run, path, &facts, &saved, error); }
    H5E_END_TRY
    td_saved_free(&saved);
    return status;
}

/* -- restoring ------------------------------------------------------------------------------------------------------------- */

/* The contents of a checkpoint. */
typedef struct contents {
    td_resumed rest;
    td_saved saved;
} contents;

static tides_status check_version(const td_place *root) {
    char *format = NULL;
    int32_t version = 0;
    int known = td_place_read_text(root, "format", &format) == TIDES_OK && strcmp(format, TD_CHECKPOINT_FORMAT) == 0;
    free(format);
    if (!known) return td_fail(root->error, TIDES_BAD_FILE, "%s: is HDF5 but not a checkpoint of TIDES", root->file);
    tides_status status = td_place_read_int(root, "version", &version);
    if (status != TIDES_OK || version == TD_CHECKPOINT_VERSION) return status;
    return td_fail(root->error, TIDES_UNSUPPORTED,
                   "%s: has version %d of the checkpoint's layout; TIDES %s reads version %d: use the version that wrote it",
                   root->file, (int)version, tides_version(), TD_CHECKPOINT_VERSION);
}

static tides_status check_run(const td_place *root, const char *run) {
    char *saved = NULL;
    tides_status status = td_place_read_text(root, "run", &saved);
    if (status == TIDES_OK && run && saved[0]) status = td_facts_compare_runs(root->file, saved, run, root->error);
    free(saved);
    return status;
}

/* Reads the step, which must be on this run's grid: the last step of a run is not if an earlier stop cut it short. And at a
 * run's end, its last nanosecond is included and its readout emptied, which isn't so in a longer run. Files from before
 * `ended` aren't checked for that. */
static tides_status read_step(const td_place *root, const tides_simulator *s, int64_t *step) {
    const td_saved_run run = td_simulator_saved(s);
    double steps = 0, time = 0;
    int32_t ended = 0;
    tides_status status = td_place_read_double(root, "step", &steps);
    if (status == TIDES_OK) status = td_place_read_double(root, "time", &time);
    if (status == TIDES_OK && H5Aexists(root->id, "ended") > 0) status = td_place_read_int(root, "ended", &ended);
    if (status != TIDES_OK) return status;
    if (!(steps >= 0) || steps > 1e15 || steps != (double)(int64_t)steps)
        return td_fail(root->error, TIDES_BAD_FILE, "%s: step is %g, no number of steps", root->file, steps);
    if (steps > (double)run.steps || time > run.length)
        return td_fail(root->error, TIDES_BAD_CONFIG, "%s: was made at %.15g s, after time.stop = %.15g s", root->file,
                       run.epoch + time, run.epoch + run.length);
    if (time != td_simulator_grid_time(s, (int64_t)steps) || (ended && (int64_t)steps < run.steps))
        return td_fail(root->error, TIDES_BAD_CONFIG,
                       "%s: was made at %s s, which is no end of a step now that time.stop is %s s: only a run that "
                       "stopped before its end, or kept its checkpoint (--keep-checkpoint), can be extended",
                       root->file, TD_SHORT(run.epoch + time), TD_SHORT(run.epoch + run.length));
    *step = (int64_t)steps;
    return TIDES_OK;
}

/* Reads the last event; files from before `last_event` don't have it. */
static tides_status read_last(const td_place *root, tides_event *last) {
    char *text = NULL;
    int polarity = 0;
    memset(last, 0, sizeof *last);
    if (H5Aexists(root->id, "last_event") <= 0) return TIDES_OK;
    tides_status status = td_place_read_text(root, "last_event", &text);
    if (status == TIDES_OK && text[0]) {
        if (sscanf(text, "%" SCNd64 " %" SCNu16 " %" SCNu16 " %d", &last->t, &last->x, &last->y, &polarity) != 4)
            status = td_fail(root->error, TIDES_BAD_FILE, "%s: last_event is '%s', no event", root->file, text);
        last->polarity = (int8_t)polarity;
    }
    free(text);
    return status;
}

static tides_status check_is_same(const td_place *root, const char *run, const td_facts *facts) {
    td_place group;
    tides_status status = check_version(root);
    if (status == TIDES_OK) status = check_run(root, run);
    if (status == TIDES_OK) status = td_place_open(root, "run_is", &group);
    if (status != TIDES_OK) return status;
    status = check_facts(&group, facts);
    H5Gclose(group.id);
    return status;
}

static tides_status read_all(const td_place *root, const tides_simulator *s, const char *run, const td_facts *facts,
                             contents *got) {
    td_place group;
    tides_status status = check_is_same(root, run, facts);
    if (status == TIDES_OK) status = read_step(root, s, &got->rest.step);
    if (status == TIDES_OK) status = read_last(root, &got->rest.last);
    if (status == TIDES_OK) status = td_place_open(root, "statistics", &group);
    if (status != TIDES_OK) return status;
    status = td_totals_read(&group, &got->rest.totals);
    H5Gclose(group.id);
    if (status == TIDES_OK) status = td_readout_read(s, root, &got->rest.arbiter);
    return status == TIDES_OK ? td_saved_read(&got->saved, s, root) : status;
}

static tides_status read_file(const tides_simulator *s, const char *run, const char *path, const td_facts *facts, contents *got,
                              tides_error *error) {
    td_place root = {.id = -1, .file = path, .where = "/", .error = error};
    tides_status status = td_checkpoint_image_read(path, &root.id, error);
    if (status != TIDES_OK) return status;
    status = read_all(&root, s, run, facts, got);
    H5Fclose(root.id);
    return status;
}

tides_status tides_simulator_restore(tides_simulator *simulator, const char *run, const char *path, tides_error *error) {
    if (!simulator || !path)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_simulator_restore: simulator and path must be given");
    const td_reached reached = td_simulator_reached(simulator);
    if (reached.started || reached.broken)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%s: the simulator has run already: restore into a new one", path);
    td_facts facts;
    contents got = {.rest = {.arbiter = NULL}};
    tides_status status = td_facts_gather(simulator, &facts, error);
    if (status == TIDES_OK) status = td_saved_create(&got.saved, simulator, error);
    if (status != TIDES_OK) return status;
    H5E_BEGIN_TRY { status = read_file(simulator, run, path, &facts, &got, error); }
    H5E_END_TRY
    if (status == TIDES_OK) {
        td_saved_give(&got.saved, simulator);
        td_simulator_resume(simulator, &got.rest);
    }
    tides_arbiter_destroy(got.rest.arbiter);
    td_saved_free(&got.saved);
    return status;
}
