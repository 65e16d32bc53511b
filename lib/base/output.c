/* Writes each output as PATH.part beside PATH and renames it when it is complete, so that PATH never holds a half-written
 * file. */
#include "td_base.h"
#include "td_folder.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static const char ending[] = ".part";

/* ---- names ---- */

/* Reads the link `path`. `*target` is its target, relative to the current folder, allocated. */
static tides_status read_link(const char *path, char **target, tides_error *error) {
    char text[4096]; /* PATH_MAX of Linux: no link holds more */
    ssize_t length = readlink(path, text, sizeof text);
    if (length < 0 || (size_t)length >= sizeof text)
        return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: it is a link that can't be read", path);
    const int folder = text[0] == '/' ? 0 : (int)(td_base_name(path) - path);
    *target = td_format(error, "%.*s%.*s", folder, path, (int)length, text);
    return *target ? TIDES_OK : TIDES_NO_MEMORY;
}

tides_status td_follow_links(const char *path, char **target, tides_error *error) {
    enum { LINKS_MAX = 40 }; /* Linux gives up after as many */
    struct stat there;
    char *at = td_strdup(path, error);
    tides_status status = at ? TIDES_OK : TIDES_NO_MEMORY;
    for (int links = 0; status == TIDES_OK && at && lstat(at, &there) == 0 && S_ISLNK(there.st_mode); links++) {
        char *next = NULL;
        status = links < LINKS_MAX ? read_link(at, &next, error)
                                   : td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: its links go in a circle", path);
        free(at);
        at = next;
    }
    if (status == TIDES_OK)
        *target = at;
    else
        free(at);
    return status;
}

/* Why an existing .part must not be overwritten; NULL: it may. Only a plain file of this user with one name is overwritten,
 * such as the remains of a stopped run. In a folder that others may write, anybody could put a link to another file there. */
static const char *foreign(const struct stat *there) {
    if (S_ISLNK(there->st_mode)) return "is a link";
    if (!S_ISREG(there->st_mode)) return "isn't a file";
    if (there->st_uid != geteuid()) return "belongs to another user";
    return there->st_nlink > 1 ? "has another name (a hard link)" : NULL;
}

static tides_status check_part(const char *part, tides_error *error) {
    struct stat there;
    const char *why = lstat(part, &there) == 0 ? foreign(&there) : NULL;
    if (!why) return TIDES_OK;
    return td_fail(error, TIDES_WRITE_FAILED, "%s: %s, and isn't written, for others may have put it there: remove it", part,
                   why);
}

tides_status td_part_name(const char *path, int streams, char **part, tides_error *error) {
    struct stat there;
    char *target = NULL;
    if (stat(path, &there) == 0 && S_ISDIR(there.st_mode))
        return td_fail(error, TIDES_WRITE_FAILED, "%s: is a folder: name a file in it", path);
    if (strcmp(path, "-") == 0)
        return td_fail(error, TIDES_WRITE_FAILED, "-: standard output isn't written to: name a file; ./- is one of that name");
    int special = stat(path, &there) == 0 && !S_ISREG(there.st_mode);
    if (special && !streams)
        return td_fail(error, TIDES_WRITE_FAILED,
                       "%s: is a device or FIFO, and this format isn't written from beginning to end: name a file", path);
    tides_status status = special ? TIDES_OK : td_follow_links(path, &target, error);
    if (status != TIDES_OK) return status;
    char *made = special ? td_strdup(path, error) : td_format(error, "%s%s", target, ending);
    free(target);
    status = !made ? TIDES_NO_MEMORY : special ? TIDES_OK : check_part(made, error);
    if (status == TIDES_OK)
        *part = made;
    else
        free(made);
    return status;
}

void td_remove_part(const char *part, const char *path) {
    if (part && strcmp(part, path) != 0) unlink(part);
}

tides_status td_remove_file(const char *path, tides_error *error) {
    char *part = NULL;
    const tides_status status = td_part_name(path, 0, &part, error);
    if (status != TIDES_OK) return status;
    td_remove_part(part, path);
    free(part);
    if (remove(path) == 0 || errno == ENOENT) return TIDES_OK;
    return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be removed: %s", path, strerror(errno));
}

/* ---- the disk ---- */

int td_sync(int descriptor) {
    int failed = fsync(descriptor) == 0 ? 0 : errno;
    /* pipes and some file systems have nothing to flush */
    return failed == EINVAL || failed == ENOTSUP || failed == ENOSYS ? 0 : failed;
}

int td_lock_alone(int descriptor) {
    /* a file system without locks counts as locked */
    return flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK ? EBUSY : 0;
}

/* 1 if `descriptor` is still the file at `path`, which another process may have replaced after it was opened. */
static int is_still_at(int descriptor, const char *path) {
    struct stat own, there;
    return fstat(descriptor, &own) == 0 && stat(path, &there) == 0 && own.st_dev == there.st_dev && own.st_ino == there.st_ino;
}

/* Opens a file for reading and writing. O_NONBLOCK: a FIFO without a reader would block. */
static int open_there(const char *path) {
    struct stat own;
    const int descriptor = open(path, O_RDWR | O_NOFOLLOW | O_NONBLOCK);
    if (descriptor < 0) return -1;
    const int failed = fstat(descriptor, &own) != 0 ? errno : foreign(&own) ? EPERM : 0;
    if (!failed) return descriptor;
    close(descriptor);
    errno = failed;
    return -1;
}

int td_open_own(const char *path, int create) {
    for (;;) {
        int descriptor = create ? open(path, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW, 0666) : -1;
        if (descriptor >= 0 || (create && errno != EEXIST)) return descriptor;
        descriptor = open_there(path);
        /* ENOENT in spite of O_CREAT's EEXIST: removed in between, so try again */
        if (descriptor >= 0 || !create || errno != ENOENT) return descriptor;
    }
}

int td_claim_file(const char *path) {
    for (;;) {
        const int descriptor = td_open_own(path, 1);
        if (descriptor < 0) return -1;
        int failed = td_lock_alone(descriptor);
        const int is_there = failed || is_still_at(descriptor, path);
        if (!failed && is_there && ftruncate(descriptor, 0) != 0) failed = errno;
        if (!failed && is_there) return descriptor;
        close(descriptor);
        errno = failed;
        if (failed) return -1;
    }
}

int td_keep_claim(int descriptor) { return descriptor < 0 ? -1 : fcntl(descriptor, F_DUPFD_CLOEXEC, 0); }

void td_end_claim(int claim) {
    if (claim < 0) return;
    flock(claim, LOCK_UN); /* a child process forked meanwhile shares the lock, so closing alone would keep it */
    close(claim);
}

FILE *td_part_open(const char *part, const char *path) {
    if (strcmp(part, path) == 0) return fopen(part, "wb"); /* PATH itself is a device or FIFO */
    const int descriptor = td_claim_file(part);
    FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "r+b");
    if (descriptor >= 0 && !file) {
        const int failed = errno;
        td_remove_part(part, path); /* while it is still ours alone */
        close(descriptor);
        errno = failed;
    }
    return file;
}

static int sync_path(const char *path, int flags) {
    int descriptor = open(path, flags);
    if (descriptor < 0) return errno;
    int failed = td_sync(descriptor);
    if (close(descriptor) != 0 && !failed) failed = errno;
    return failed;
}

/* Flushes the folder: a rename changes the folder, and is lost in a crash until the folder is on the disk. A folder without
 * permission to read is skipped. */
static int sync_folder_of(const char *path) {
    char *folder = td_folder_of(path, NULL);
    if (!folder) return ENOMEM;
    int failed = sync_path(folder, O_RDONLY | O_DIRECTORY);
    free(folder);
    return failed == EACCES || failed == EPERM ? 0 : failed;
}

/* Renames `part` to `target`; returns 0 or errno. The target is checked again, because the work may have taken hours, and
 * another file may have appeared there. */
static int put_in_place(const char *part, const char *target) {
    struct stat there;
    if (lstat(target, &there) == 0 && !S_ISREG(there.st_mode)) return S_ISDIR(there.st_mode) ? EISDIR : EEXIST;
    int failed = sync_path(part, O_RDONLY);
    if (!failed && rename(part, target) != 0) failed = errno;
    return failed;
}

static tides_status commit(const char *part, const char *path, int keep, tides_error *error) {
    if (strcmp(part, path) == 0) return TIDES_OK; /* written in place */
    char *target = td_format(error, "%.*s", (int)(strlen(part) - (sizeof ending - 1)), part);
    tides_status status = target ? TIDES_OK : TIDES_NO_MEMORY;
    int failed = target ? put_in_place(part, target) : ENOMEM;
    if (failed && keep)
        status = td_fail(error, TIDES_WRITE_FAILED, "%s: can't be put in place (%s); the data is in %s", path, strerror(failed),
                         part);
    else if (failed)
        status = td_fail(error, TIDES_WRITE_FAILED, "%s: can't be put in place: %s", path, strerror(failed));
    else if ((failed = sync_folder_of(target)) != 0)
        status = td_fail(error, TIDES_WRITE_FAILED, "%s: is written, but its folder can't be put on the disk: %s", path,
                         strerror(failed));
    if (status != TIDES_OK && !keep) td_remove_part(part, path);
    free(target);
    return status;
}

tides_status td_commit_file(const char *part, const char *path, tides_error *error) { return commit(part, path, 0, error); }

tides_status td_commit_or_keep(const char *part, const char *path, tides_error *error) { return commit(part, path, 1, error); }

/* ---- whole files ---- */

/* Writes all bytes and closes the file; returns 0 or errno. */
static int write_bytes(FILE *file, const void *bytes, size_t size) {
    errno = 0;
    int failed = size == 0 || fwrite(bytes, 1, size, file) == size ? 0 : errno ? errno : EIO;
    if (fclose(file) != 0 && !failed) failed = errno; /* with a full disk the error may come only here */
    return failed;
}

tides_status td_copy_file(const char *from, const char *to, tides_error *error) {
    char bytes[65536];
    size_t got = 0;
    FILE *in = fopen(from, "rb"), *out = in ? td_part_open(to, from) : NULL;
    int failed = out ? 0 : errno;
    while (!failed && (got = fread(bytes, 1, sizeof bytes, in)) > 0)
        if (fwrite(bytes, 1, got, out) != got) failed = errno ? errno : EIO;
    if (in && ferror(in) && !failed) failed = EIO;
    if (in) fclose(in);
    if (out && fclose(out) != 0 && !failed) failed = errno ? errno : EIO;
    if (!failed) return TIDES_OK;
    return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be copied to %s: %s", from, to, strerror(failed));
}

tides_status tides_file_write(const char *path, const void *bytes, size_t size, tides_error *error) {
    if (!path || (!bytes && size > 0)) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_file_write: an argument is NULL");
    char *part = NULL;
    tides_status status = td_part_name(path, 1, &part, error);
    if (status != TIDES_OK || !part) return status;
    FILE *file = td_part_open(part, path);
    const int failed = file ? write_bytes(file, bytes, size) : errno;
    if (failed) {
        status = td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", path, strerror(failed));
        if (file) td_remove_part(part, path);
    } else {
        status = td_commit_file(part, path, error);
    }
    free(part);
    return status;
}

/* Tests whether `part` can be written; returns 0 or errno. A FIFO isn't opened: its reader would see the end of the data. */
static int try_part(const char *part, const char *path) {
    if (strcmp(part, path) == 0) return access(path, W_OK) == 0 ? 0 : errno;
    int made = open(part, O_WRONLY | O_CREAT | O_EXCL, 0666);
    if (made >= 0) {
        /* a lock that fails, or a different file there: another run has begun to write it, and it stays */
        if (td_lock_alone(made) == 0 && is_still_at(made, part)) unlink(part);
        close(made);
        return 0;
    }
    made = errno == EEXIST ? open_there(part) : -1; /* an existing .part is being written by another run, or can be resumed */
    if (made < 0) return errno;
    close(made);
    return 0;
}

tides_status tides_file_check(const char *path, int32_t streams, tides_error *error) {
    if (!path) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_file_check: path is NULL");
    char *part = NULL;
    tides_status status = td_part_name(path, streams, &part, error);
    int failed = part ? try_part(part, path) : 0;
    if (failed) status = td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", path, strerror(failed));
    free(part);
    return status;
}

tides_status tides_file_part(const char *path, char *part, size_t size, tides_error *error) {
    if (!path || !part) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_file_part: an argument is NULL");
    char *name = NULL;
    tides_status status = td_part_name(path, 1, &name, error);
    if (status != TIDES_OK || !name) return status;
    if (strlen(name) < size)
        memcpy(part, name, strlen(name) + 1);
    else
        status = td_fail(error, TIDES_BAD_ARGUMENT, "%s: its name needs more than %zu bytes", path, size);
    free(name);
    return status;
}
