/* Hash of all that a run of a batch depends on (tides_fingerprints_run), and an estimate of its memory. */
#include "batch.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Estimated memory of a run: a process with an OpenCL compiler; a scene in the file's form, unpacked, and on the device; state
 * and channels of each pixel. It is coarse, and corrected by the first run that ends. */
#define PROCESS_BYTES 200e6
#define SCENE_FACTOR 4.0
#define PIXEL_BYTES 600.0
/* Number of pixels where only the path file has the image's size. */
#define UNKNOWN_PIXELS (1280.0 * 720.0)

/* A text of the inputs that aren't files: the device, and the run's command. NULL: out of memory. */
static char *circumstances(const batch *b, const batch_run *run) {
    const char *device = b->common->device ? b->common->device : "";
    char *all = run->command ? batch_text("%s\n%s", device, run->command) : batch_text("%s", device);
    for (size_t i = 0; all && i < run->options; i++) {
        char *longer = batch_text("%s\n%s", all, run->option[i]);
        free(all);
        all = longer;
    }
    return all;
}

/* Loads the run with its sets; a drawn run without a seed gets its own. */
static tides_status load(batch_run *run, tides_run **loaded, tides_error *error) {
    tides_run *plain = NULL;
    tides_status status = tides_run_load(run->file, (const char *const *)run->sets, run->count, &plain, error);
    if (status != TIDES_OK || !run->seed || tides_run_gives(plain, "seed")) {
        *loaded = plain;
        return status;
    }
    tides_run_destroy(plain);
    run->sets[run->count++] = run->seed;
    run->seed = NULL;
    return tides_run_load(run->file, (const char *const *)run->sets, run->count, loaded, error);
}

/* Refuses a run that reads files which its batch writes: its own folder, which is cleared, and the summaries. */
static tides_status check_apart(const batch *b, const batch_run *run, const tides_run *loaded, tides_error *error) {
    const char *const names[] = {"summary.json", "summary.csv"}, *const folder = run->directory;
    tides_status status = TIDES_OK;
    for (int i = 0; i < 2 && status == TIDES_OK; i++) {
        char *path = batch_text("%s/%s", b->directory, names[i]);
        const char *const output = path;
        status = path ? tides_run_apart(loaded, &output, 1, error) : batch_no_memory(error);
        free(path);
    }
    tides_run_input *inputs = NULL;
    size_t count = 0;
    if (status != TIDES_OK || access(folder, F_OK) != 0) return status;
    status = tides_run_inputs(loaded, &inputs, &count, error);
    for (size_t i = 0; status == TIDES_OK && i <= count; i++) {
        const char *const input = i < count ? inputs[i].path : run->file;
        if (tides_files_apart(&folder, 1, &input, 1, NULL) == TIDES_BAD_ARGUMENT)
            status = cli_error(error, TIDES_BAD_ARGUMENT, "%s: is read, and lies in %s, which the run writes", input, folder);
    }
    tides_free(inputs);
    return status;
}

/* A run that the reader refuses is an error of the manifest. A missing input file is a failure of this run alone. */
static tides_status prepare(const batch *b, tides_fingerprints *prints, batch_run *run, tides_error *error) {
    tides_run *loaded = NULL;
    tides_run_values v;
    tides_fingerprint print = {0, 0, 0, 0};
    tides_error reason = {TIDES_OK, ""};
    tides_status status = load(run, &loaded, &reason);
    if (status != TIDES_OK) return cli_error(error, status, "%s: %s: %.800s", b->manifest, run->name, reason.text);
    tides_run_get(loaded, &v);
    if ((status = check_apart(b, run, loaded, &reason)) != TIDES_OK) {
        tides_run_destroy(loaded);
        return cli_error(error, status, "%s: %s: %.800s", b->manifest, run->name, reason.text);
    }
    char *with = circumstances(b, run);
    if (!with) {
        tides_run_destroy(loaded);
        return batch_no_memory(error);
    }
    if (v.frames_file && strcmp(v.frames_file, "-") == 0)
        status = cli_error(&reason, TIDES_BAD_CONFIG,
                           "frames come from a pipe (-), and a batch has none to read: save the video as .y4m");
    else
        status = tides_fingerprints_run(prints, loaded, with, &print, &reason);
    free(with);
    const double pixels = (double)v.intrinsics.width * v.intrinsics.height;
    const double held = (double)(v.frames_file ? print.largest : print.bytes); /* frames are read one at a time */
    run->estimate = PROCESS_BYTES + SCENE_FACTOR * held + PIXEL_BYTES * (pixels > 0 ? pixels : UNKNOWN_PIXELS);
    snprintf(run->hash, sizeof run->hash, "%016" PRIx64, print.hash);
    const int32_t is_dataset = v.dataset_layout && !run->command;
    run->layouts = is_dataset ? batch_text("%s", v.dataset_layout) : NULL;
    const int32_t short_of_memory = is_dataset && !run->layouts;
    tides_run_destroy(loaded);
    if (short_of_memory) return batch_no_memory(error);
    if (status == TIDES_OK) return TIDES_OK;
    run->hash[0] = '\0'; /* a part of it may be set */
    run->state = BATCH_FAILED;
    return (run->error = batch_text("%s", reason.text)) ? TIDES_OK : batch_no_memory(error);
}

tides_status batch_prepare(batch *b, tides_error *error) {
    tides_fingerprints *prints = NULL;
    tides_status status = tides_fingerprints_create(b->directory, &prints, error);
    for (size_t i = 0; status == TIDES_OK && i < b->count; i++) status = prepare(b, prints, &b->runs[i], error);
    tides_fingerprints_destroy(prints);
    return status;
}
