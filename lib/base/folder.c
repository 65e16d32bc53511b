/* Lists the files of a folder, makes folders, and splits paths into folder and name. Used by readers of event files and
 * frames that are stored as a folder. */
#include "td_folder.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

void td_folder_free(td_folder *folder) {
    for (size_t i = 0; i < folder->count; i++) free(folder->files[i]);
    free(folder->files);
    *folder = (td_folder){NULL, 0, 0};
}

int td_ends_in(const char *name, const char *ending) {
    size_t length = strlen(name), tail = strlen(ending);
    return length > tail && strcasecmp(name + length - tail, ending) == 0;
}

const char *td_base_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

char *td_plain_path(const char *path, tides_error *error) {
    size_t length = strlen(path);
    while (length > 1 && path[length - 1] == '/') length--;
    return td_format(error, "%.*s", (int)length, path);
}

char *td_beside(const char *path, const char *name, tides_error *error) {
    return td_format(error, "%.*s%s", (int)(td_base_name(path) - path), path, name);
}

char *td_folder_prefix(const char *path, tides_error *error) { return td_beside(path, "", error); }

char *td_folder_of(const char *path, tides_error *error) {
    const int length = (int)(td_base_name(path) - path);
    return length == 0 ? td_strdup(".", error) : td_format(error, "%.*s", length > 1 ? length - 1 : 1, path);
}

int td_is_folder(const char *path) {
    struct stat facts;
    return stat(path, &facts) == 0 && S_ISDIR(facts.st_mode);
}

int td_is_file(const char *path) {
    struct stat facts;
    return stat(path, &facts) == 0 && S_ISREG(facts.st_mode);
}

/* Natural order: runs of digits compare as numbers, so that frame_9 comes before frame_10. */
static int compare(const void *a, const void *b) {
    const char *left = *(char *const *)a, *right = *(char *const *)b;
    while (*left && *right) {
        size_t zeros_left = strspn(left, "0"), zeros_right = strspn(right, "0");
        size_t digits_left = strspn(left + zeros_left, "0123456789"), digits_right = strspn(right + zeros_right, "0123456789");
        if (zeros_left + digits_left && zeros_right + digits_right) {
            if (digits_left != digits_right) return digits_left < digits_right ? -1 : 1;
            int order = memcmp(left + zeros_left, right + zeros_right, digits_left);
            if (order) return order;
            left += zeros_left + digits_left;
            right += zeros_right + digits_right;
            continue;
        }
        if (*left != *right) return (unsigned char)*left < (unsigned char)*right ? -1 : 1;
        left++;
        right++;
    }
    if (*left || *right) return *left ? 1 : -1;
    return strcmp(*(char *const *)a, *(char *const *)b); /* equal as numbers, such as "7" and "07": by their bytes */
}

tides_status td_folder_add(td_folder *folder, const char *path, const char *name, tides_error *error) {
    void *files = folder->files;
    tides_status status = td_reserve(&files, &folder->capacity, folder->count + 1, sizeof *folder->files, error);
    folder->files = files;
    if (status != TIDES_OK) return status;
    if (!(folder->files[folder->count] = td_format(error, "%s/%s", path, name))) return TIDES_NO_MEMORY;
    folder->count++;
    return TIDES_OK;
}

tides_status td_folder_list(td_folder *folder, const char *path, const char *ending, tides_error *error) {
    DIR *entries = opendir(path);
    const struct dirent *entry;
    tides_status status = TIDES_OK;
    while (status == TIDES_OK && entries && (entry = readdir(entries)))
        if (entry->d_name[0] != '.' && td_ends_in(entry->d_name, ending))
            status = td_folder_add(folder, path, entry->d_name, error);
    if (entries) closedir(entries);
    if (status == TIDES_OK && folder->count) qsort(folder->files, folder->count, sizeof *folder->files, compare);
    return status;
}

tides_status td_make_folders(const char *path, tides_error *error) {
    char *at = td_strdup(path, error);
    if (!at) return TIDES_NO_MEMORY;
    tides_status status = TIDES_OK;
    for (char *slash = strchr(at + 1, '/'); status == TIDES_OK; slash = slash ? strchr(slash + 1, '/') : NULL) {
        if (slash) *slash = '\0';
        if (mkdir(at, 0777) != 0 && errno != EEXIST)
            status = td_fail(error, TIDES_WRITE_FAILED, "%s: can't be made: %s", at, strerror(errno));
        if (!slash) break;
        *slash = '/';
    }
    free(at);
    return status;
}

tides_status td_make_new_folder(const char *path, tides_error *error) {
    char *above = td_folder_of(path, error);
    tides_status status = above ? td_make_folders(above, error) : TIDES_NO_MEMORY;
    free(above);
    if (status != TIDES_OK || mkdir(path, 0777) == 0) return status;
    if (errno != EEXIST) return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be made: %s", path, strerror(errno));
    return td_fail(error, TIDES_WRITE_FAILED,
                   "%s: is there already: another process is writing it, or an interrupted one left it; then remove it", path);
}
