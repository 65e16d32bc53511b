/* Fingerprints of a run's inputs: a hash of a file's content, or of the names, sizes and times of a folder's entries. A batch
 * keeps a result as long as its fingerprint is unchanged. */
#include "tides/inputs.h"

#include "td_base.h"
#include "td_hash.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Largest depth of nested folders; a deeper tree isn't a data set. */
enum { DEEPEST = 64 };

typedef struct taken {
    char *path;
    tides_fingerprint print;
} taken;

struct tides_fingerprints {
    taken *items;
    size_t count, capacity;
    int32_t has_except;
    dev_t except_device; /* the folder that is left out */
    ino_t except_inode;
};

static uint64_t hash_text(uint64_t hash, const char *text) { return td_hash_bytes(hash, text, strlen(text) + 1); }

/* -- files and folders --------------------------------------------------------------------------------------------- */

static void count_file(tides_fingerprint *print, uint64_t bytes) {
    print->files++;
    print->bytes += bytes;
    if (bytes > print->largest) print->largest = bytes;
}

static tides_status take_content(const char *path, tides_fingerprint *print, tides_error *error) {
    enum { PIECE = 1 << 18 };
    unsigned char *piece = td_alloc(PIECE, 1, error);
    if (!piece) return TIDES_NO_MEMORY;
    FILE *file = fopen(path, "rb");
    tides_status status = TIDES_OK;
    if (!file) {
        status = td_fail(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened: %s", path, strerror(errno));
    } else {
        size_t got;
        while ((got = fread(piece, 1, PIECE, file)) > 0) print->hash = td_hash_bytes(print->hash, piece, got);
        if (ferror(file)) status = td_fail(error, TIDES_BAD_FILE, "%s: can't be read", path);
        fclose(file);
    }
    free(piece);
    return status;
}

/* The folders that a walk is in: a link back to one of them ends there. */
typedef struct walk {
    const tides_fingerprints *of;
    tides_fingerprint *print;
    struct {
        dev_t device;
        ino_t inode;
    } above[DEEPEST];
    int32_t depth;
} walk;

static int32_t is_left_out(const walk *w, const struct stat *folder) {
    const tides_fingerprints *of = w->of;
    if (of->has_except && folder->st_dev == of->except_device && folder->st_ino == of->except_inode) return 1;
    for (int32_t i = 0; i < w->depth; i++)
        if (w->above[i].device == folder->st_dev && w->above[i].inode == folder->st_ino) return 1;
    return 0;
}

static tides_status take_folder(walk *w, const char *path, const struct stat *folder, tides_error *error);

/* Hashes an entry: its name, then a folder's contents or a file's size and time of modification. A vanished entry counts as
 * absent. */
static tides_status take_entry(walk *w, const char *folder, const char *name, tides_error *error) {
    struct stat facts;
    char *path = td_format(error, "%s/%s", folder, name);
    if (!path) return TIDES_NO_MEMORY;
    tides_status status = TIDES_OK;
    if (stat(path, &facts) == 0 && !(S_ISDIR(facts.st_mode) && is_left_out(w, &facts))) {
        w->print->hash = hash_text(w->print->hash, name);
        if (S_ISDIR(facts.st_mode)) {
            status = take_folder(w, path, &facts, error);
        } else {
            const int64_t what[3] = {(int64_t)facts.st_size, (int64_t)facts.st_mtim.tv_sec, (int64_t)facts.st_mtim.tv_nsec};
            w->print->hash = td_hash_bytes(w->print->hash, what, sizeof what);
            count_file(w->print, (uint64_t)facts.st_size);
        }
    }
    free(path);
    return status;
}

static int is_visible(const struct dirent *entry) { return entry->d_name[0] != '.'; }

/* Hashes a folder's entries in the order of names. The end of each folder is hashed, too, so that moving a file to the next
 * folder changes the hash. */
static tides_status take_folder(walk *w, const char *path, const struct stat *folder, tides_error *error) {
    struct dirent **entries = NULL;
    if (w->depth == DEEPEST)
        return td_fail(error, TIDES_BAD_FILE, "%s: lies over %d folders deep; give a folder that holds less", path, DEEPEST);
    const int count = scandir(path, &entries, is_visible, alphasort);
    if (count < 0) return td_fail(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened: %s", path, strerror(errno));
    w->above[w->depth].device = folder->st_dev;
    w->above[w->depth++].inode = folder->st_ino;
    tides_status status = TIDES_OK;
    for (int i = 0; i < count; i++) {
        if (status == TIDES_OK) status = take_entry(w, path, entries[i]->d_name, error);
        free(entries[i]);
    }
    free(entries);
    w->depth--;
    w->print->hash = hash_text(w->print->hash, "/");
    return status;
}

static tides_status take(const tides_fingerprints *of, const char *path, tides_fingerprint *print, tides_error *error) {
    struct stat facts;
    *print = (tides_fingerprint){.hash = TD_HASH_START};
    if (stat(path, &facts) != 0) return td_fail(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened: %s", path, strerror(errno));
    if (S_ISDIR(facts.st_mode)) {
        walk w = {.of = of, .print = print};
        return take_folder(&w, path, &facts, error);
    }
    count_file(print, (uint64_t)facts.st_size);
    return take_content(path, print, error);
}

/* -- the object ------------------------------------------------------------------------------------------------------- */

tides_status tides_fingerprints_create(const char *except, tides_fingerprints **fingerprints, tides_error *error) {
    if (!fingerprints) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_fingerprints_create: fingerprints is NULL");
    tides_fingerprints *made = td_alloc(1, sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    struct stat facts;
    made->has_except = except && stat(except, &facts) == 0; /* a missing folder needs no exception */
    if (made->has_except) {
        made->except_device = facts.st_dev;
        made->except_inode = facts.st_ino;
    }
    *fingerprints = made;
    return TIDES_OK;
}

void tides_fingerprints_destroy(tides_fingerprints *fingerprints) {
    if (!fingerprints) return;
    for (size_t i = 0; i < fingerprints->count; i++) free(fingerprints->items[i].path);
    free(fingerprints->items);
    free(fingerprints);
}

tides_status tides_fingerprints_file(tides_fingerprints *f, const char *path, tides_fingerprint *fingerprint,
                                     tides_error *error) {
    if (!f || !path || !fingerprint)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_fingerprints_file: fingerprints, path or fingerprint is NULL");
    for (size_t i = 0; i < f->count; i++) {
        if (strcmp(f->items[i].path, path) != 0) continue;
        *fingerprint = f->items[i].print;
        return TIDES_OK;
    }
    taken made = {NULL, {0, 0, 0, 0}};
    void *items = f->items;
    tides_status status = td_reserve(&items, &f->capacity, f->count + 1, sizeof *f->items, error);
    f->items = items;
    if (status == TIDES_OK) status = take(f, path, &made.print, error);
    if (status == TIDES_OK && !(made.path = td_strdup(path, error))) status = TIDES_NO_MEMORY;
    if (status != TIDES_OK) return status;
    f->items[f->count++] = made;
    *fingerprint = made.print;
    return TIDES_OK;
}

tides_status tides_fingerprints_run(tides_fingerprints *f, const tides_run *run, const char *with,
                                    tides_fingerprint *fingerprint, tides_error *error) {
    if (!f || !run || !fingerprint)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_fingerprints_run: fingerprints, run or fingerprint is NULL");
    tides_run_input *inputs = NULL;
    size_t count = 0;
    tides_status status = tides_run_inputs(run, &inputs, &count, error);
    if (status != TIDES_OK) return status;
    tides_run_values values;
    tides_run_get(run, &values);
    const int32_t numerics = TIDES_NUMERICS;
    tides_fingerprint whole = {.hash = td_hash_bytes(TD_HASH_START, &numerics, sizeof numerics)};
    whole.hash = hash_text(hash_text(whole.hash, values.json), with ? with : "");
    for (size_t i = 0; i < count && status == TIDES_OK; i++) {
        tides_fingerprint one;
        status = tides_fingerprints_file(f, inputs[i].path, &one, error);
        if (status != TIDES_OK) break;
        whole.hash = td_hash_bytes(whole.hash, &one.hash, sizeof one.hash);
        whole.files += one.files;
        whole.bytes += one.bytes;
        if (one.largest > whole.largest) whole.largest = one.largest;
    }
    tides_free(inputs);
    if (status == TIDES_OK) *fingerprint = whole;
    return status;
}

uint64_t tides_fingerprint_text(const char *const *texts, size_t count) {
    uint64_t hash = TD_HASH_START;
    for (size_t i = 0; texts && i < count; i++)
        if (texts[i]) hash = td_hash_bytes(hash, texts[i], strlen(texts[i]));
    return hash;
}
