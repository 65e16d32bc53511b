/* Status codes, error text, progress, version: what every other header builds on.
 *
 * Every call that can fail returns a tides_status and takes a nullable tides_error as its last parameter. On failure the
 * error holds one line: what was wrong, where (file, line, key), and how to put it right; output parameters are then left
 * untouched unless the call says otherwise. The library never prints, exits or aborts.
 *
 * Thread rule for all objects: one object is used by one thread at a time; different objects may be used by different
 * threads. A `const` object may be read by several threads at once. */
#ifndef TIDES_BASE_H
#define TIDES_BASE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The version as numbers; tides_version gives it as text. */
#define TIDES_VERSION_MAJOR 0
#define TIDES_VERSION_MINOR 1
#define TIDES_VERSION_PATCH 0

/* Raised whenever the events of an unchanged run file may change. */
#define TIDES_NUMERICS 19

#if defined(__GNUC__)
#define TIDES_API __attribute__((visibility("default")))
#define TIDES_MUST_CHECK __attribute__((warn_unused_result))
#else
#define TIDES_API
#define TIDES_MUST_CHECK
#endif

/* The enum, the names and the texts come from one list, so they can't disagree. */
#define TIDES_STATUS_LIST(X)                                          \
    X(OK, 0, "success")                                               \
    X(BAD_ARGUMENT, 1, "an argument is out of range or inconsistent") \
    X(NO_MEMORY, 2, "out of memory")                                  \
    X(FILE_NOT_FOUND, 3, "a file can't be opened")                    \
    X(BAD_FILE, 4, "a file isn't what it claims to be")               \
    X(WRITE_FAILED, 5, "a file can't be written")                     \
    X(BAD_CONFIG, 6, "a run file or setting is wrong")                \
    X(UNSUPPORTED, 7, "this version can't do that")                   \
    X(NO_DEVICE, 8, "no OpenCL device matches")                       \
    X(DEVICE_FAILED, 9, "an OpenCL call or kernel build failed")      \
    X(CANCELLED, 10, "stopped on request")                            \
    X(OUT_OF_RANGE, 11, "a time lies outside what the data covers")

/* The width is fixed, since a compiler may choose any width for an enum, and the ABI would depend on it. */
typedef int32_t tides_status;

/* TIDES_OK, TIDES_BAD_ARGUMENT and so on, from the list. */
enum {
#define TIDES_STATUS_ENUM(name, value, text) TIDES_##name = value,
    TIDES_STATUS_LIST(TIDES_STATUS_ENUM)
#undef TIDES_STATUS_ENUM
};

/* How values code light. LINEAR: values are light; SRGB: light by IEC 61966-2-1; GAMMA: light is value^gamma. FILE: as a file
 * says, where it can say it. */
enum { TIDES_TRANSFER_FILE = -1, TIDES_TRANSFER_LINEAR = 0, TIDES_TRANSFER_SRGB = 1, TIDES_TRANSFER_GAMMA = 2 };

/* "file", "linear", "srgb" or "gamma", as in run files; NULL for other numbers. */
TIDES_API const char *tides_transfer_name(int32_t transfer);

/* The unit of the times in a file. AUTO: the file's format or values tell. INDEX, for camera paths: numbers are indices of
 * poses, not times. */
enum { TIDES_TIME_AUTO = 0, TIDES_TIME_S, TIDES_TIME_MS, TIDES_TIME_US, TIDES_TIME_NS, TIDES_TIME_INDEX };

/* Description of a failure. Plain value, owned by the caller; `text` is always terminated. */
typedef struct tides_error {
    tides_status status; /* TIDES_OK, or what went wrong */
    char text[1020];     /* one line: what, where, and how to put it right */
} tides_error;

/* "TIDES_BAD_FILE"; static storage; "TIDES_UNKNOWN_STATUS" for anything else. */
TIDES_API const char *tides_status_name(tides_status status);

/* "a file isn't what it claims to be"; static storage. */
TIDES_API const char *tides_status_text(tides_status status);

/* "0.1.0"; static storage. */
TIDES_API const char *tides_version(void);

/* The name in `names` (NULL-terminated) that a misspelt `name` probably means: `name` itself if it is in the list, else the
 * first that begins with it (3 bytes or more). Else it is the name that needs the fewest edits: letters inserted, deleted,
 * replaced or swapped with their neighbour, at most half as many as `name` has. Returns NULL if there is none, or an argument
 * is NULL. Bytes are compared, case counts. Names above 128 bytes are only found by their beginning, or whole. The answer is
 * the list's own pointer. */
TIDES_API const char *tides_nearest_name(const char *name, const char *const *names);

/* Called every now and then by long work, on the calling thread, with the fraction done in [0, 1] and the stage ("building
 * kernels", "simulating"). Non-zero stops the work with TIDES_CANCELLED; flushed data stays. A run also calls it within a
 * step; a step that is stopped is undone, and the run goes on from the step's start. */
typedef int (*tides_progress)(void *user, double fraction, const char *stage);

/* TIDES_BAD_FILE if a file's first bytes and ending are those of a kind that TIDES doesn't read (a video, a mesh, an archive,
 * a web page). `error` then says what it is and what to do. Else TIDES_OK. */
TIDES_MUST_CHECK TIDES_API tides_status tides_file_foreign(const char *path, tides_error *error);

/* How the library writes files: PATH holds the old bytes or the new ones, never a part, whatever fails:
 *   - bytes go to PATH.part beside it, which is synchronised to disk (fsync) and renamed; then the folder is synchronised. A
 *     failure leaves PATH as it was, and removes PATH.part. Recordings of events keep PATH.part, and the error says so;
 *   - an existing PATH.part is used if it is a plain file of the caller's user without other names, as a stopped run leaves it.
 *     Else it is refused, because in a folder that others may write, their link could lead anywhere;
 *   - if PATH is a link, its target is written so, even if it doesn't exist yet, and the link stays;
 *   - a device or FIFO is written directly if the format is written from beginning to end, else refused;
 *   - a folder is refused. */

/* Writes all bytes of a file. */
TIDES_MUST_CHECK TIDES_API tides_status tides_file_write(const char *path, const void *bytes, size_t size, tides_error *error);

/* Checks that a file can be written, before long work that ends with writing it: TIDES_WRITE_FAILED if not. `streams`: 1 if
 * it is written from beginning to end (text, .png), 0 if not (.h5, .exr, .npy). Leaves nothing behind. */
TIDES_MUST_CHECK TIDES_API tides_status tides_file_check(const char *path, int32_t streams, tides_error *error);

/* The name under which `path` is written: "PATH.part", unless PATH is a link or a device. 0-terminated text of at most `size`
 * bytes. */
TIDES_MUST_CHECK TIDES_API tides_status tides_file_part(const char *path, char *part, size_t size, tides_error *error);

/* Checks, before anything is opened, that outputs don't overwrite inputs or each other. TIDES_BAD_ARGUMENT, naming both, if
 * an output or its .part is an input or another output, under any name or link, or lies in a folder that is an input. Also if
 * an output is "-". NULL entries, devices and FIFOs are ignored. */
TIDES_MUST_CHECK TIDES_API tides_status tides_files_apart(const char *const *inputs, size_t input_count,
                                                          const char *const *outputs, size_t output_count, tides_error *error);

/* TIDES_BAD_ARGUMENT if a file of the kind `ending` (".json") has the ending of another kind, such as "a.h5". No ending, or
 * an unknown one, is fine. */
TIDES_MUST_CHECK TIDES_API tides_status tides_file_named(const char *path, const char *ending, tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
