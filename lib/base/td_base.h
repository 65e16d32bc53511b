/* Internal: error texts, checked allocation, small text and file helpers shared by all of lib/. */
#ifndef TD_BASE_H
#define TD_BASE_H

#include "tides/base.h"

#include <stdarg.h>
#include <stdio.h>

#if defined(__GNUC__)
#define TD_PRINTF(text, first) __attribute__((__format__(__printf__, text, first)))
#else
#define TD_PRINTF(text, first)
#endif

/* The largest size of any time [s]: event times are 64-bit nanoseconds, which end at 9.22e9 s. Clocks that count from 1970
 * fit. */
#define TD_FURTHEST_TIME 9.2e9

/* Fills `error` (may be NULL) and returns `status`: `return td_fail(error, TIDES_BAD_FILE, "...", ...)`. The text is one
 * line: what is wrong, where, and how to mend it. */
tides_status td_fail(tides_error *error, tides_status status, const char *format, ...) TD_PRINTF(3, 4);
#ifdef __clang_analyzer__ /* the analyzer doesn't follow variadic functions: the macro tells it that the result is `status` */
#define td_fail(error, status, ...) ((void)td_fail(error, status, __VA_ARGS__), (status))
#endif

/* Puts "prefix: " (the place of the error) before the text that `error` already holds, and returns its status. */
tides_status td_fail_within(tides_error *error, tides_status status, const char *format, ...) TD_PRINTF(3, 4);

/* Reports the progress of one part of a longer work as progress of the whole. Pass td_share_step as the part's
 * tides_progress, with a td_share as its user. `stage` is the name of the whole work (may be NULL). If `progress` is NULL,
 * nothing is reported and nothing can stop the work. */
typedef struct td_share {
    tides_progress progress;
    void *user;
    double from, width; /* fractions of the whole: begin and length of the part */
    const char *stage;
} td_share;
int td_share_step(void *part, double fraction, const char *stage);

/* count * size zeroed bytes, allocated. NULL: out of memory, or the product overflows; `error` is filled. 0 bytes still
 * give a pointer. */
void *td_alloc(size_t count, size_t size, tides_error *error);

/* Grows `*array` (room for `*capacity` elements of `size` bytes) to at least `needed` elements, and keeps the contents. */
tides_status td_reserve(void **array, size_t *capacity, size_t needed, size_t size, tides_error *error);

/* Grows an array as td_reserve does, but drops its contents, also if it fails. */
tides_status td_renew(void **array, size_t *capacity, size_t needed, size_t size, tides_error *error);

char *td_strdup(const char *text, tides_error *error);

/* A formatted string, allocated. */
char *td_format(tides_error *error, const char *format, ...) TD_PRINTF(2, 3);

/* Appends a line to `*notes`, which is NULL or allocated: notes for the user, separated by "\n". */
tides_status td_note(char **notes, tides_error *error, const char *format, ...) TD_PRINTF(3, 4);

/* Reads a whole file, and puts a NUL behind its `*bytes` bytes. TIDES_FILE_NOT_FOUND; TIDES_BAD_FILE if it has more than
 * `limit` bytes. */
tides_status td_read_file(const char *path, size_t limit, char **data, size_t *bytes, tides_error *error);

/* `path` with all links at its end followed, allocated. The last link may point to nothing. TIDES_WRITE_FAILED if the links
 * form a circle. */
tides_status td_follow_links(const char *path, char **target, tides_error *error);

/* The name under which an output is written until it is complete and renamed, allocated: "PATH.part", beside the target if
 * PATH is a link. A device or FIFO is written in place, so it is PATH itself; only formats written from beginning to end
 * (`streams`) allow that. TIDES_WRITE_FAILED if the .part is a link or may belong to somebody else. */
tides_status td_part_name(const char *path, int streams, char **part, tides_error *error);

/* Locks an open file until it is closed. So if two runs write one file, the second stops before it ruins the first one's.
 * 0, or EBUSY: another process has the lock. */
int td_lock_alone(int descriptor);

/* Opens the file at `path` for reading and writing; with `create`, makes it if it doesn't exist. -1 and errno if it is a
 * link, not a plain file, or not this user's alone. Otherwise others could, in a shared folder, make us overwrite any file. */
int td_open_own(const char *path, int create);

/* Opens the file at `path` by td_open_own, locks it, then empties it. Returns a descriptor for reading and writing, or -1
 * and errno. EBUSY: another run writes the file, which is left untouched. */
int td_claim_file(const char *path);

/* Keeps the lock of a claimed file after `descriptor` is closed, so that nobody empties the file before it is renamed.
 * Returns a second descriptor for td_end_claim, or -1 if `descriptor` is invalid or none is left. */
int td_keep_claim(int descriptor);
void td_end_claim(int claim);

/* Opens `part` for writing: locked while it is open, and empty. NULL and errno. EBUSY: another run writes the file, which
 * is left untouched. */
FILE *td_part_open(const char *part, const char *path);

/* Renames a closed .part to its final name, and flushes both to the disk. If that fails, td_commit_file removes the .part;
 * td_commit_or_keep leaves it and names it in the error, for files that took hours. */
tides_status td_commit_file(const char *part, const char *path, tides_error *error);
tides_status td_commit_or_keep(const char *part, const char *path, tides_error *error);

/* Removes an unfinished .part; never a device. */
void td_remove_part(const char *part, const char *path);

/* Removes a file, if it exists, and the .part that a killed process may have left beside it. */
tides_status td_remove_file(const char *path, tides_error *error);

/* Copies the bytes of `from` to the .part `to`. If it fails, the caller removes `to`. */
tides_status td_copy_file(const char *from, const char *to, tides_error *error);

/* Waits until the bytes of an open file are on the disk; 0 or errno. For files that can't be flushed (pipes), 0. */
int td_sync(int descriptor);

/* "; did you mean NAME?" with the nearest name of a list such as "smooth|inria|gsplat". Any character of `separators` ends
 * a name. "" if none is near or the list is too long. Returns `text`. */
enum { TD_SUGGESTION_MAX = 96 };
const char *td_suggest(const char *name, const char *list, const char *separators, char text[TD_SUGGESTION_MAX]);

/* A number with the fewest digits that read back as the same double: "0.05", not 0.050000000000000003. Returns `text`; the
 * text of TD_SHORT lives until the end of the enclosing block. */
enum { TD_SHORT_MAX = 32 };
const char *td_short(double number, char text[TD_SHORT_MAX]);
#define TD_SHORT(number) td_short(number, (char[TD_SHORT_MAX]){0})

/* Monotonic clock [s]. */
double td_now(void);

/* Processor time of the calling thread [s]. */
double td_own_time(void);

/* Peak resident memory of the process [bytes]; 0 where unknown. */
uint64_t td_peak_memory(void);

#endif
