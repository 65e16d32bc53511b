/* The files that a run reads, and fingerprints of them: whether a result still is what its run would give. */
#ifndef TIDES_INPUTS_H
#define TIDES_INPUTS_H

#include "tides/run.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Something that a run reads. */
typedef struct tides_run_input {
    const char *key;  /* of the run file: "scene.objects" */
    const char *path; /* resolved against the run file */
    int32_t folder;   /* 1: a folder, and what lies below it */
    int32_t reserved;
} tides_run_input;

/* All that a run reads, each path once, in the order of the keys: what its keys name, and what the readers of those look for
 * beside it, where it is there (COLMAP's cameras.bin beside images.bin, EuRoC's sensor.yaml, timestamps.txt ...). The folder of
 * a trained model, or of a dataset that a camera path is read of, is replaced by the files that are read in it; other folders
 * stand for all that lies below them. A missing file is listed too where a key names it. Motions from callbacks read no file.
 * Nothing is opened but to see what kind of file it is. The caller frees `inputs` (count) with tides_free, texts and all. */
TIDES_MUST_CHECK TIDES_API tides_status tides_run_inputs(const tides_run *run, tides_run_input **inputs, size_t *count,
                                                         tides_error *error);

/* tides_files_apart of a run's inputs, its own file among them, and what is made of it (NULL entries count for nothing). A
 * folder of frames keeps its pictures alone from being replaced. The functions that make files of a session
 * (tides_session_write and the others) call this themselves. Programs that write several files call it for all of them, before
 * long work begins. */
TIDES_MUST_CHECK TIDES_API tides_status tides_run_apart(const tides_run *run, const char *const *outputs, size_t count,
                                                        tides_error *error);

/* A fingerprint. Plain value. */
typedef struct tides_fingerprint {
    uint64_t hash;    /* FNV-1a of 64 bits, of what is said below */
    uint64_t files;   /* looked at */
    uint64_t bytes;   /* of all of them */
    uint64_t largest; /* of the largest one [bytes] */
} tides_fingerprint;

/* Takes fingerprints, and keeps those of files that several runs share. */
typedef struct tides_fingerprints tides_fingerprints;

/* `except` (nullable) is a folder that no fingerprint looks into: that of the results, which may lie below a run's inputs. */
TIDES_MUST_CHECK TIDES_API tides_status tides_fingerprints_create(const char *except, tides_fingerprints **fingerprints,
                                                                  tides_error *error);
TIDES_API void tides_fingerprints_destroy(tides_fingerprints *fingerprints); /* NULL is fine */

/* Fingerprint of a file, from its content, or of a folder, from the names, sizes and times of last change [ns] of its files. A
 * folder's files are all below it whose names don't begin with a dot, links followed. Their content isn't read, because a
 * dataset holds gigabytes of pictures. So a write in place is seen, unless the time of change is put back, and a copy with new
 * times is another folder. TIDES_FILE_NOT_FOUND. */
TIDES_MUST_CHECK TIDES_API tides_status tides_fingerprints_file(tides_fingerprints *fingerprints, const char *path,
                                                                tides_fingerprint *fingerprint, tides_error *error);

/* Fingerprint of a run: the run with every default filled in, all its inputs, the library's TIDES_NUMERICS, and `with`
 * (nullable), a text that the run depends on besides, such as the device asked for. The sizes are those of the inputs alone. */
TIDES_MUST_CHECK TIDES_API tides_status tides_fingerprints_run(tides_fingerprints *fingerprints, const tides_run *run,
                                                               const char *with, tides_fingerprint *fingerprint,
                                                               tides_error *error);

/* Fingerprint of texts one after the other, as of one text: FNV-1a of 64 bits over their bytes. It serves names derived from
 * content, such as those of a batch's runs, and is equal in every version. NULL has no bytes. */
TIDES_API uint64_t tides_fingerprint_text(const char *const *texts, size_t count);

#ifdef __cplusplus
}
#endif
#endif
