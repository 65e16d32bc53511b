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

/* Events carry 64-bit nanoseconds, which end at 9.22e9 s: no time is further from 0 than this [s]. Clocks that count from 1970
 * fit. */
#define TD_FURTHEST_TIME 9.2e9

/* Fills a nullable error and returns `status`, so that a failure is `return td_fail(error, TIDES_BAD_FILE, "...", ...)`.
 * One line: what, where, how to fix. */
tides_status td_fail(tides_error *error, tides_status status, const char *format, ...) TD_PRINTF(3, 4);
#ifdef __clang_analyzer__ /* it doesn't look into functions of any number of arguments: it is the status that comes back */
#define td_fail(error, status, ...) ((void)td_fail(error, status, __VA_ARGS__), (status))
#endif

/* Puts "prefix: " before the text that `error` already holds (to add where); returns its status. */
tides_status td_fail_within(tides_error *error, tides_status status, const char *format, ...) TD_PRINTF(3, 4);

/* A part of a piece of work as part of the whole: a tides_progress, whose user is a td_share. `stage` (nullable) is what the
 * whole calls it; without `progress` nobody is told, and nobody stops it. */
typedef struct td_share {
    tides_progress progress;
    void *user;
    double from, width; /* shares of the whole */
    const char *stage;
} td_share;
int td_share_step(void *part, double fraction, const char *stage);

/* count * size bytes, zeroed, overflow checked; never returns NULL for 0 bytes. NULL: out of memory, error filled. */
void *td_alloc(size_t count, size_t size, tides_error *error);

/* Grows `*array` (elements of `size` bytes, `*capacity` of them) to hold at least `needed`; contents kept. */
tides_status td_reserve(void **array, size_t *capacity, size_t needed, size_t size, tides_error *error);

/* Like td_reserve, but contents are lost where the array grows, and where it can't. */
tides_status td_renew(void **array, size_t *capacity, size_t needed, size_t size, tides_error *error);

char *td_strdup(const char *text, tides_error *error);

/* A formatted string, allocated. */
char *td_format(tides_error *error, const char *format, ...) TD_PRINTF(2, 3);

/* Appends a line to `*notes`, which is NULL or allocated: what somebody should hear, lines with "\n" between them. */
tides_status td_note(char **notes, tides_error *error, const char *format, ...) TD_PRINTF(3, 4);

/* Reads a whole file; `*bytes` gets its size, a NUL follows the data. TIDES_FILE_NOT_FOUND, TIDES_BAD_FILE above `limit`. */
tides_status td_read_file(const char *path, size_t limit, char **data, size_t *bytes, tides_error *error);

/* `path` with the links at its end followed, allocated; the last may lead to nothing. TIDES_WRITE_FAILED where they go in a
 * circle. */
tides_status td_follow_links(const char *path, char **target, tides_error *error);

/* Files are written beside and renamed (tides/base.h says how; output.c). `td_part_name` gives the name to write to, allocated:
 * "PATH.part", beside what PATH leads to where it is a link; PATH itself where it is a device or FIFO, which only formats that
 * are written from beginning to end (`streams`) can be sent to. TIDES_WRITE_FAILED where td_open_own would refuse the .part. */
tides_status td_part_name(const char *path, int streams, char **part, tides_error *error);

/* Locks an open file until it is closed, so that where two runs are told to write one file the second stops before it ruins the
 * first one's. 0, or EBUSY: another has it. */
int td_lock_alone(int descriptor);

/* The file at `path` for reading and writing, made where there is none and `create` is 1; -1 and errno where what is there is a
 * link, no file, or not ours alone: in a folder that others may write, they could have us write anywhere. */
int td_open_own(const char *path, int create);

/* The file at `path`, td_open_own's, made where there is none, emptied once it is locked: a descriptor for reading and
 * writing; -1 and errno, EBUSY where another run writes it, of which nothing is touched. */
int td_claim_file(const char *path);

/* A claimed file is claimed on when it is closed, so that nobody empties it before it is in its place: what is to be given to
 * td_end_claim then; -1: nothing (`descriptor` isn't one, or there is no other left). */
int td_keep_claim(int descriptor);
void td_end_claim(int claim);

/* The file at `part` emptied for writing, locked while it is open; NULL and errno, EBUSY where another run writes it, of which
 * nothing is touched. */
FILE *td_part_open(const char *part, const char *path);

/* Puts a .part that is closed into its place, and both on the disk; a failure removes it. `_or_keep` leaves it where it is
 * then, and says so: for what took hours. */
tides_status td_commit_file(const char *part, const char *path, tides_error *error);
tides_status td_commit_or_keep(const char *part, const char *path, tides_error *error);

/* Removes what was begun; never a device. */
void td_remove_part(const char *part, const char *path);

/* Removes a file, where there is one, and the .part that a process left which was killed as it wrote it. */
tides_status td_remove_file(const char *path, tides_error *error);

/* Copies the bytes of `from` to a .part; what fails half way is the caller's to remove. */
tides_status td_copy_file(const char *from, const char *to, tides_error *error);

/* Waits until the bytes of an open file are on the disk; 0 or errno. Files that can't be asked (pipes) are fine. */
int td_sync(int descriptor);

/* "; did you mean NAME?" with the nearest name of a list such as "smooth|inria|gsplat", whose names are parted by any of
 * `separators`; "" where none is near, or the list is too long. Returns `text`. */
enum { TD_SUGGESTION_MAX = 96 };
const char *td_suggest(const char *name, const char *list, const char *separators, char text[TD_SUGGESTION_MAX]);

/* A number with as few digits as read back as it: "0.05" where %.17g says 0.050000000000000003. Returns `text`; TD_SHORT's
 * lasts as long as the block that it stands in. */
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
