/* Keeps the events of an incomplete dataset, so that a second try needn't simulate again. Camera NAME has NAME.h5 (with a
 * checkpoint while it is incomplete) and NAME.run, the fingerprint of its run. NAME.seen means that all events are in the
 * file, and says if the camera had anything in view. */
#include "td_kept.h"
#include "td_folder.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static const char own[] = ".events";

/* -- the folder ------------------------------------------------------------------------------------------------------------ */

/* Locks the folder for the life of the process, so that no other process writes it. */
static tides_status take_lock(td_kept *kept, const char *part, tides_error *error) {
    char *path = td_in_folder(kept->folder, error, "lock");
    if (!path) return TIDES_NO_MEMORY;
    kept->lock = open(path, O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    free(path);
    if (kept->lock < 0) return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", part, strerror(errno));
    if (flock(kept->lock, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK)
        return TIDES_OK; /* some file systems have no locks */
    close(kept->lock);
    kept->lock = -1;
    return td_fail(error, TIDES_WRITE_FAILED, "%s: another process is writing it", part);
}

tides_status td_kept_open(td_kept *kept, const char *part, tides_error *error) {
    *kept = (td_kept){.folder = td_in_folder(part, error, "%s", own), .lock = -1};
    tides_status status = kept->folder ? tides_fingerprints_create(NULL, &kept->prints, error) : TIDES_NO_MEMORY;
    struct stat facts;
    const int there = status == TIDES_OK && lstat(part, &facts) == 0 && S_ISDIR(facts.st_mode) &&
                      lstat(kept->folder, &facts) == 0 && S_ISDIR(facts.st_mode);
    if (status == TIDES_OK && !there) status = td_make_new_folder(part, error);
    if (status == TIDES_OK && !there) status = td_make_folders(kept->folder, error);
    if (status == TIDES_OK) status = take_lock(kept, part, error);
    if (status == TIDES_OK && there) td_empty_folder(part, own);
    if (status != TIDES_OK) td_kept_close(kept, 1);
    return status;
}

int td_kept_any(const td_kept *kept) {
    td_folder files = {NULL, 0, 0};
    tides_status status = td_folder_list(&files, kept->folder, ".h5", NULL);
    if (status == TIDES_OK) status = td_folder_list(&files, kept->folder, ".checkpoint", NULL);
    const int any = status == TIDES_OK && files.count > 0;
    td_folder_free(&files);
    return any;
}

void td_kept_close(td_kept *kept, int stays) {
    if (kept->folder && !stays) td_remove_folder(kept->folder);
    if (kept->lock >= 0) close(kept->lock);
    tides_fingerprints_destroy(kept->prints);
    free(kept->folder);
    *kept = (td_kept){.lock = -1};
}

/* -- a camera -------------------------------------------------------------------------------------------------------------- */

/* The names of a camera's files. */
typedef struct files {
    char *events, *checkpoint, *run, *seen;
} files;

static tides_status name_files(files *names, const char *folder, const char *camera, tides_error *error) {
    names->events = td_in_folder(folder, error, "%s.h5", camera);
    names->checkpoint = td_in_folder(folder, error, "%s.h5.checkpoint", camera);
    names->run = td_in_folder(folder, error, "%s.run", camera);
    names->seen = td_in_folder(folder, error, "%s.seen", camera);
    return names->events && names->checkpoint && names->run && names->seen ? TIDES_OK : TIDES_NO_MEMORY;
}

static void free_files(files *names) {
    free(names->events);
    free(names->checkpoint);
    free(names->run);
    free(names->seen);
}

/* Reads the first line of a small file; "" if the file doesn't exist. */
static void read_word(const char *path, char *word, size_t bytes) {
    char *text = NULL;
    size_t length = 0;
    word[0] = '\0';
    if (td_read_file(path, bytes, &text, &length, NULL) == TIDES_OK)
        snprintf(word, bytes, "%.*s", (int)strcspn(text, "\n"), text);
    free(text);
}

static tides_status write_word(const char *path, const char *word, tides_error *error) {
    td_text text;
    tides_status status = td_text_open(&text, path, error);
    if (status != TIDES_OK) return status;
    status = td_text_put(&text, error, "%s\n", word);
    return td_text_close(&text, status, error);
}

/* Removes a camera's files if they are of another run, or of another version. */
static tides_status match_run(td_kept *kept, const td_member *camera, const files *names, tides_error *error) {
    char mine[32], there[32];
    tides_fingerprint print;
    tides_status status = tides_fingerprints_run(kept->prints, camera->facts.run, tides_version(), &print, error);
    if (status != TIDES_OK) return status;
    snprintf(mine, sizeof mine, "%016" PRIx64, print.hash);
    read_word(names->run, there, sizeof there);
    if (strcmp(mine, there) == 0) return TIDES_OK;
    unlink(names->seen);
    unlink(names->events);
    unlink(names->checkpoint);
    return write_word(names->run, mine, error);
}

static tides_status simulate(const td_member *camera, const files *names, tides_progress progress, void *user,
                             tides_error *error) {
    tides_recording how;
    tides_stats stats;
    tides_recording_defaults(&how);
    how.resume = td_is_file(names->checkpoint);
    const tides_status status = tides_session_write(camera->session, names->events, &how, progress, user, NULL, &stats, error);
    return status == TIDES_OK ? write_word(names->seen, stats.render.pairs_evaluated ? "1" : "0", error) : status;
}

static tides_status give(const char *path, tides_event_sink sink, void *user, tides_error *error) {
    enum { EACH = 1 << 16 }; /* events read at once */
    tides_event_reader *reader = NULL;
    tides_event *events = td_alloc(EACH, sizeof *events, error);
    tides_status status = events ? tides_event_reader_open(path, NULL, &reader, error) : TIDES_NO_MEMORY;
    for (size_t got = 1; got > 0 && status == TIDES_OK;) {
        status = tides_event_reader_read(reader, events, EACH, &got, error);
        if (status == TIDES_OK && got > 0 && sink(user, events, got) != 0)
            status = td_fail(error, TIDES_CANCELLED, "stopped on request");
    }
    tides_event_reader_close(reader);
    free(events);
    return status;
}

tides_status td_kept_events(td_kept *kept, const td_member *camera, tides_progress progress, void *user, tides_event_sink sink,
                            void *sink_user, int32_t *unseeing, tides_error *error) {
    files names = {NULL, NULL, NULL, NULL};
    char seen[8] = "";
    tides_status status = name_files(&names, kept->folder, camera->name, error);
    if (status == TIDES_OK) status = match_run(kept, camera, &names, error);
    if (status == TIDES_OK) read_word(names.seen, seen, sizeof seen);
    if (status == TIDES_OK && !seen[0]) status = simulate(camera, &names, progress, user, error);
    if (status == TIDES_OK) read_word(names.seen, seen, sizeof seen);
    *unseeing = seen[0] == '0';
    if (status == TIDES_OK) status = give(names.events, sink, sink_user, error);
    free_files(&names);
    return status;
}
