/* The files that a run reads, and their fingerprints, which tell whether a result is still up to date. */
#ifndef TIDES_INPUTS_H
#define TIDES_INPUTS_H

#include "tides/run.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A file or folder that a run reads. */
typedef struct tides_run_input {
    const char *key;  /* key of the run file: "scene.objects" */
    const char *path; /* resolved against the folder of the run file */
    int32_t folder;   /* 1: a folder, with everything in it */
    int32_t reserved;
} tides_run_input;

/* Lists what a run reads, each path once, in the order of the keys: files that keys name, and existing files that readers
 * look for beside them (COLMAP's cameras.bin beside images.bin, EuRoC's sensor.yaml, timestamps.txt ...). Folders of trained
 * models, and of datasets with a camera path, are replaced by the files that are read in them. Other folders stand for
 * everything in them. A missing file is listed if a key names it. Motions from callbacks read no file. Files are only opened
 * to find their kind. The caller frees `inputs` (count) with tides_free, which frees texts too. */
TIDES_MUST_CHECK TIDES_API tides_status tides_run_inputs(const tides_run *run, tides_run_input **inputs, size_t *count,
                                                         tides_error *error);

/* Checks that outputs don't overwrite a run's inputs, its own file, or each other; NULL entries are ignored. In a folder of
 * frames, only its pictures are protected. Functions that make files of a session check this themselves. Programs that write
 * several files check all of them, before long work begins. */
TIDES_MUST_CHECK TIDES_API tides_status tides_run_apart(const tides_run *run, const char *const *outputs, size_t count,
                                                        tides_error *error);

/* A fingerprint. Plain value. */
typedef struct tides_fingerprint {
    uint64_t hash;    /* FNV-1a, 64 bits */
    uint64_t files;   /* number of files */
    uint64_t bytes;   /* total size */
    uint64_t largest; /* of the largest one [bytes] */
} tides_fingerprint;

/* Computes fingerprints, and keeps those of files, which several runs may share. */
typedef struct tides_fingerprints tides_fingerprints;

/* `except` (nullable) is a folder that fingerprints leave out: that of the results, which may lie in an input's folder. */
TIDES_MUST_CHECK TIDES_API tides_status tides_fingerprints_create(const char *except, tides_fingerprints **fingerprints,
                                                                  tides_error *error);
TIDES_API void tides_fingerprints_destroy(tides_fingerprints *fingerprints); /* NULL is fine */

/* Fingerprint of a file, from its content; or of a folder, from the names, sizes and times of last change [ns] of its files.
 * These are all files below it whose names don't begin with a dot, links followed. Their content isn't read, because a
 * dataset holds gigabytes. So a write in place changes the fingerprint, unless the time of change is reset; and a copy with
 * new times has another fingerprint. TIDES_FILE_NOT_FOUND. */
TIDES_MUST_CHECK TIDES_API tides_status tides_fingerprints_file(tides_fingerprints *fingerprints, const char *path,
                                                                tides_fingerprint *fingerprint, tides_error *error);

/* Fingerprint of a run: its values with defaults filled in, all its inputs, the library's TIDES_NUMERICS, and `with`
 * (nullable), a text that the results depend on besides, such as the device. The sizes are those of the inputs alone. */
TIDES_MUST_CHECK TIDES_API tides_status tides_fingerprints_run(tides_fingerprints *fingerprints, const tides_run *run,
                                                               const char *with, tides_fingerprint *fingerprint,
                                                               tides_error *error);

/* Fingerprint of the concatenation of texts: FNV-1a of 64 bits over their bytes. It is used for names that derive from
 * content, such as those of a batch's runs, and is equal in every version. NULL has no bytes. */
TIDES_API uint64_t tides_fingerprint_text(const char *const *texts, size_t count);

#ifdef __cplusplus
}
#endif
#endif
