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

/* As tides_version has it. */
#define TIDES_VERSION_MAJOR 0
#define TIDES_VERSION_MINOR 1
#define TIDES_VERSION_PATCH 0

/* Raised whenever the events of an unchanged run file may change. */
#define TIDES_NUMERICS 14

#if defined(__GNUC__)
#define TIDES_API __attribute__((visibility("default")))
#define TIDES_MUST_CHECK __attribute__((warn_unused_result))
#else
#define TIDES_API
#define TIDES_MUST_CHECK
#endif

/* One list: the enum, the names and the texts can't drift apart. */
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

/* Width pinned apart from the enum, so that the ABI doesn't depend on the compiler's choice. */
typedef int32_t tides_status;

/* TIDES_OK, TIDES_BAD_ARGUMENT and so on, from the list. */
enum {
#define TIDES_STATUS_ENUM(name, value, text) TIDES_##name = value,
    TIDES_STATUS_LIST(TIDES_STATUS_ENUM)
#undef TIDES_STATUS_ENUM
};

/* How values are coded light: LINEAR: they are light; SRGB: light by IEC 61966-2-1; GAMMA: value^gamma. FILE, where a file may
 * give its coding: that of the file. */
enum { TIDES_TRANSFER_FILE = -1, TIDES_TRANSFER_LINEAR = 0, TIDES_TRANSFER_SRGB = 1, TIDES_TRANSFER_GAMMA = 2 };

/* "file", "linear", "srgb" or "gamma", as run files have it; NULL of other numbers. */
TIDES_API const char *tides_transfer_name(int32_t transfer);

/* The unit of the times in a file. AUTO: the unit that the file's reader knows. INDEX, of camera paths: the numbers are those
 * of poses, not times. */
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

/* The entry of `names` (NULL-terminated) that a misspelt `name` was probably meant to be: `name` itself where it is there,
 * else the first that begins with it (3 bytes or more), else the nearest by letters put in, left out, replaced or swapped with
 * their neighbour, the first of several, where these are at most half as many as `name` has. NULL where nothing is that near,
 * and where either argument is NULL. Bytes are compared, case counts; of names above 128 bytes only beginnings and the same
 * name are found. The answer is the list's own pointer. */
TIDES_API const char *tides_nearest_name(const char *name, const char *const *names);

/* Called now and then by long work, on the calling thread, with the fraction done in [0, 1] and a word for the stage ("building
 * kernels", "simulating"). A non-zero return stops the work with TIDES_CANCELLED; flushed data stays. A run also calls it
 * between the launches of a step: a step that is stopped there is undone, and the run goes on from its start. */
typedef int (*tides_progress)(void *user, double fraction, const char *stage);

/* TIDES_BAD_FILE where a file, by its first bytes and its name's ending, is of a kind that nothing here reads (a video, a mesh,
 * an archive, a web page): `error` says what it is and what gets further. TIDES_OK where it isn't known as such. */
TIDES_MUST_CHECK TIDES_API tides_status tides_file_foreign(const char *path, tides_error *error);

/* How every file of the library is written, so that PATH holds the old bytes or the new ones, never a part, whatever dies:
 *   - beside it, as PATH.part, which is put on the disk (fsync) and renamed, and then its folder; a failure leaves what was
 *     there alone and no PATH.part, but for recordings of events: those stay in PATH.part, and the error says so;
 *   - a PATH.part that is there is used where it is a file of the caller's user with no other name, such as a stopped run left,
 *     and is refused where it is anything else: in a folder that others may write, a link of theirs would lead anywhere;
 *   - where PATH is a link, that happens to what the link leads to, there or not yet, and the link stays;
 *   - a device or FIFO is written into, in formats that are written from beginning to end, and refused for others;
 *   - a folder is refused. */

/* All bytes of a file. */
TIDES_MUST_CHECK TIDES_API tides_status tides_file_write(const char *path, const void *bytes, size_t size, tides_error *error);

/* An early answer for a file that comes at the end of long work: TIDES_WRITE_FAILED where it can't be written. `streams`: 1
 * where it is written from beginning to end (text, .png), 0 where not (.h5, .exr, .npy). Leaves nothing behind. */
TIDES_MUST_CHECK TIDES_API tides_status tides_file_check(const char *path, int32_t streams, tides_error *error);

/* The name under which `path` is written, "PATH.part" where it is no link or device, as 0-terminated text of at most `size`
 * bytes. */
TIDES_MUST_CHECK TIDES_API tides_status tides_file_part(const char *path, char *part, size_t size, tides_error *error);

/* Asks, before anything is opened, whether the outputs of some work leave its inputs and one another alone: TIDES_BAD_ARGUMENT,
 * naming both, where an output or its .part is an input or another output, by whatever names and links, there yet or not, or
 * lies in a folder that is an input; and for an output "-". NULL entries count for nothing, devices and FIFOs neither. */
TIDES_MUST_CHECK TIDES_API tides_status tides_files_apart(const char *const *inputs, size_t input_count,
                                                          const char *const *outputs, size_t output_count, tides_error *error);

/* TIDES_BAD_ARGUMENT where a file that holds what `ending` (".json") stands for is called like another kind, such as "a.h5".
 * Names of no ending, or of one that stands for nothing, are fine. */
TIDES_MUST_CHECK TIDES_API tides_status tides_file_named(const char *path, const char *ending, tides_error *error);

#ifdef __cplusplus
}
#endif
#endif
