/* Checks that no output replaces an input or another output, and that a file's name has the ending of its format.
 *
 * Two paths are the same file if device and inode are the same. A file that doesn't exist yet has no inode: it is identified by
 * the nearest existing folder above it and the rest of its path. */
#include "td_base.h"
#include "td_folder.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Where a path leads: to an existing file or folder, or else to the nearest existing folder above it, plus the rest of the
 * path. */
typedef struct place {
    char *path;   /* after the links at its end; NULL: it can't be replaced (a device, a FIFO, "-" for a pipe) */
    dev_t device; /* device and inode of what exists: the path itself, or the folder above it */
    ino_t inode;
    const char *rest; /* the part of `path` below that folder; "": the path itself exists */
    int folder;       /* 1: the path exists and is a folder */
} place;

static const char *skip_slashes(const char *text) {
    while (text[0] == '/' || (text[0] == '.' && (text[1] == '/' || text[1] == '\0'))) text++;
    return text;
}

/* Completes a place that has its path: finds what exists of it. A device or FIFO clears the path. The only failure is
 * TIDES_NO_MEMORY. */
static tides_status find_place(place *p, tides_error *error) {
    struct stat there = {0};
    char *above = td_strdup(p->path, error);
    while (above && stat(above, &there) != 0) {
        char *next = td_folder_of(above, error);
        const int ended = next && strcmp(next, above) == 0; /* the folder above is the path itself: "/" or "." */
        free(above);
        above = next;
        if (ended) break;
    }
    if (!above) return TIDES_NO_MEMORY;
    const size_t known = strlen(above);
    const char *behind = strncmp(p->path, above, known) == 0 ? p->path + known : NULL;
    const int whole = behind && (behind[0] == '/' || behind[0] == '\0' || above[known - 1] == '/'); /* "." isn't in ".x" */
    p->rest = skip_slashes(whole ? behind : p->path); /* a bare name has no "./" */
    free(above);
    p->device = there.st_dev;
    p->inode = there.st_ino;
    p->folder = !p->rest[0] && S_ISDIR(there.st_mode);
    if (p->rest[0] || p->folder || S_ISREG(there.st_mode)) return TIDES_OK;
    free(p->path);
    p->path = NULL;
    return TIDES_OK;
}

/* The place of `path`. With `part`: the place of PATH.part, the file that holds an output until it is complete. */
static tides_status place_of(const char *path, int part, place *p, tides_error *error) {
    *p = (place){.rest = ""};
    if (!path || strcmp(path, "-") == 0) return TIDES_OK;
    char *plain = td_plain_path(path, error), *target = NULL;
    tides_status status = plain ? td_follow_links(plain, &target, error) : TIDES_NO_MEMORY;
    if (status == TIDES_OK) p->path = part ? td_format(error, "%s.part", target) : td_strdup(target, error);
    if (status == TIDES_OK && !p->path) status = TIDES_NO_MEMORY;
    free(target);
    free(plain);
    return status == TIDES_OK ? find_place(p, error) : status;
}

static int is_same(const place *a, const place *b) {
    return a->path && b->path && a->device == b->device && a->inode == b->inode && strcmp(a->rest, b->rest) == 0;
}

/* 1 if `a` is a folder, and `b` exists and lies in it at any depth. */
static int is_within(const place *a, const place *b, tides_error *error) {
    int found = 0;
    if (!a->path || !b->path || !a->folder || b->rest[0]) return 0;
    char *above = td_folder_of(b->path, error);
    for (struct stat there, last = {0}; above && !found && stat(above, &there) == 0; last = there) {
        if (last.st_ino == there.st_ino && last.st_dev == there.st_dev) break; /* "/.." is "/": the root was reached */
        found = there.st_dev == a->device && there.st_ino == a->inode;
        char *next = td_format(error, "%s/..", above);
        free(above);
        above = next;
    }
    free(above);
    return found;
}

/* Compares the two places of an output, its path and its .part, with those of an input or of another output. Fails if two of
 * them are the same, or if the output lies in a folder that is an input. */
static tides_status compare(const char *output, const place own[2], const char *other, const place theirs[2], int is_input,
                            tides_error *error) {
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2; k++) {
            if (!is_same(&own[i], &theirs[k]) && !(is_input && is_within(&theirs[k], &own[i], error))) continue;
            if (!is_input)
                return td_fail(error, TIDES_BAD_ARGUMENT, "%s: %s is written there, too: each output needs a name of its own",
                               output, other);
            return td_fail(error, TIDES_BAD_ARGUMENT, "%s: %s %s is read, and would be replaced: name another output", output,
                           i                  ? "while it is written, in .part,"
                           : theirs[k].folder ? "the folder"
                                              : "the input",
                           other);
        }
    return TIDES_OK;
}

static tides_status check_output(const char *const *inputs, size_t input_count, const char *const *outputs, size_t at,
                                 tides_error *error) {
    place own[2] = {{.path = NULL}, {.path = NULL}};
    const char *output = outputs[at];
    if (strcmp(output, "-") == 0)
        return td_fail(error, TIDES_BAD_ARGUMENT, "-: standard output isn't written to: name a file; ./- is one of that name");
    tides_status status = place_of(output, 0, &own[0], error);
    if (status == TIDES_OK && own[0].path && !own[0].folder) status = place_of(output, 1, &own[1], error);
    for (size_t i = 0; status == TIDES_OK && i < input_count + at; i++) {
        const int is_input = i < input_count;
        const char *other = is_input ? inputs[i] : outputs[i - input_count];
        place theirs[2] = {{.path = NULL}, {.path = NULL}};
        if (!other) continue;
        status = place_of(other, 0, &theirs[0], is_input ? NULL : error);
        if (is_input && status == TIDES_WRITE_FAILED) status = TIDES_OK; /* the input's reader reports circular links */
        if (status == TIDES_OK && !is_input && theirs[0].path) status = place_of(other, 1, &theirs[1], error);
        if (status == TIDES_OK) status = compare(output, own, other, theirs, is_input, error);
        free(theirs[0].path);
        free(theirs[1].path);
    }
    free(own[0].path);
    free(own[1].path);
    return status;
}

tides_status tides_files_apart(const char *const *inputs, size_t input_count, const char *const *outputs, size_t output_count,
                               tides_error *error) {
    if ((input_count && !inputs) || (output_count && !outputs))
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_files_apart: inputs or outputs is NULL");
    tides_status status = TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && i < output_count; i++)
        if (outputs[i]) status = check_output(inputs, input_count, outputs, i, error);
    return status;
}

/* ---- names ---- */

tides_status tides_file_named(const char *path, const char *ending, tides_error *error) {
    static const char *const known[] = {".h5",     ".hdf5", ".npy",  ".npz",  ".zip",  ".ply", ".spz",    ".splat",
                                        ".ksplat", ".sog",  ".glb",  ".gltf", ".raw",  ".dat", ".es",     ".csv",
                                        ".json",   ".png",  ".apng", ".jpg",  ".jpeg", ".exr", ".aedat4", ".svg",
                                        ".pdf",    ".y4m",  ".mp4",  ".html", ".bag",  ".mcap"};
    if (!path || !ending) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_file_named: an argument is NULL");
    if (td_ends_in(path, ending)) return TIDES_OK;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (td_ends_in(path, known[i]))
            return td_fail(error, TIDES_BAD_ARGUMENT, "%s: what is written isn't %s but %s: name it so", path, known[i],
                           ending);
    return TIDES_OK;
}
