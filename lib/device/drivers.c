/* Explains why no OpenCL device is found although drivers are installed. The loader only says that there is no platform, so
 * this repeats the loader's steps, and those of PoCL's start. */
#include "td_drivers.h"

#include "td_folder.h"

#include <dlfcn.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Folder of the loaders' entries, unless a variable names another one (ocl-icd, Khronos). */
static const char vendors[] = "/etc/OpenCL/vendors";

/* Findings about the drivers. */
typedef struct drivers {
    char *text; /* TD_TROUBLE_MAX */
    int count, pocl;
} drivers;

/* ---- PoCL's cache ---- */

/* PoCL's cache folder (versions 1 to 6); NULL: out of memory. */
static char *cache_folder(void) {
    const char *own = getenv("POCL_CACHE_DIR"), *xdg = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    if (own && own[0]) return td_strdup(own, NULL);
    if (xdg && xdg[0]) return td_format(NULL, "%s/pocl/kcache", xdg);
    return home && home[0] ? td_format(NULL, "%s/.cache/pocl/kcache", home) : td_strdup("/tmp/pocl/kcache", NULL);
}

/* Tests whether a file can be made in the folder; returns 0 or errno. */
static int try_folder(const char *folder) {
    char *name = td_format(NULL, "%s/tides-XXXXXX", folder);
    const int file = name ? mkstemp(name) : -1, failed = name ? errno : ENOMEM;
    if (file >= 0) {
        unlink(name);
        close(file);
    }
    free(name);
    return file >= 0 ? 0 : failed;
}

/* Tests a folder that may not exist yet: tests the nearest existing folder above it. */
static int try_below(const char *folder) {
    struct stat there;
    char *above = td_plain_path(folder, NULL);
    while (above && stat(above, &there) != 0 && errno == ENOENT && strcmp(above, "/") != 0 && strcmp(above, ".") != 0) {
        char *next = td_folder_of(above, NULL);
        free(above);
        above = next;
    }
    const int failed = above ? try_folder(above) : ENOMEM;
    free(above);
    return failed;
}

const char *td_cache_trouble(char text[TD_TROUBLE_MAX]) {
    char *folder = cache_folder();
    const int failed = folder ? try_below(folder) : 0;
    text[0] = '\0';
    if (failed)
        snprintf(text, TD_TROUBLE_MAX,
                 "the driver (PoCL) can't keep kernels in %.300s (%s): set POCL_CACHE_DIR to a folder that can be written",
                 folder, strerror(failed));
    free(folder);
    return text;
}

/* ---- libraries ---- */

/* Explains dlerror's text `said`, and adds the remedy. */
static void explain(drivers *d, const char *entry, const char *library, const char *said) {
    const char *path = getenv("LD_LIBRARY_PATH");
    const int older = strstr(said, "version `") != NULL, shadowed = older && path && path[0];
    const int gone = strstr(said, "cannot open shared object file") && strncmp(said, library, strlen(library)) == 0;
    const char *remedy = shadowed ? "LD_LIBRARY_PATH puts an older library first: start without it"
                         : older  ? "a library that it needs is too old: bring it up to date"
                         : gone   ? "its library is gone: install the driver again, or remove the entry"
                                  : "install the driver again, with what it needs";
    snprintf(d->text, TD_TROUBLE_MAX, "the driver of %.150s can't be loaded (%.300s): %s", entry, said, remedy);
}

/* Tries to load a library; only the first failure is reported. */
static void try_library(drivers *d, const char *entry, const char *library) {
    void *loaded = dlopen(library, RTLD_LAZY | RTLD_LOCAL);
    d->count++;
    d->pocl |= strstr(library, "pocl") != NULL;
    if (loaded)
        dlclose(loaded);
    else if (!d->text[0])
        explain(d, entry, library, dlerror());
}

/* Tries an .icd file, whose first line is a library's name or path. */
static void try_entry(drivers *d, const char *entry) {
    char line[512] = "";
    FILE *file = fopen(entry, "r");
    if (file && fgets(line, sizeof line, file)) line[strcspn(line, " \t\r\n")] = '\0';
    if (file) fclose(file);
    if (line[0]) try_library(d, entry, line);
}

static void try_entries(drivers *d, const char *folder) {
    td_folder entries = {NULL, 0, 0};
    if (td_folder_list(&entries, folder, ".icd", NULL) == TIDES_OK)
        for (size_t i = 0; i < entries.count; i++) try_entry(d, entries.files[i]);
    td_folder_free(&entries);
}

/* Tries all drivers. OCL_ICD_FILENAMES lists libraries, separated by colons; the other variables name a folder, or (ocl-icd)
 * an entry or a library. */
static void try_all(drivers *d) {
    const char *names = getenv("OCL_ICD_FILENAMES"), *folder = getenv("OCL_ICD_VENDORS"), *other = getenv("OPENCL_VENDOR_PATH");
    for (size_t length; names && *names; names += length + (names[length] == ':')) {
        length = strcspn(names, ":");
        char *library = td_format(NULL, "%.*s", (int)length, names);
        if (library && library[0]) try_library(d, "OCL_ICD_FILENAMES", library);
        free(library);
    }
    if (!folder || !folder[0]) folder = other && other[0] ? other : vendors;
    if (td_is_folder(folder))
        try_entries(d, folder);
    else if (td_ends_in(folder, ".icd"))
        try_entry(d, folder);
    else if (strcmp(folder, vendors) != 0)
        try_library(d, "OCL_ICD_VENDORS", folder);
}

const char *td_driver_trouble(char text[TD_TROUBLE_MAX]) {
    drivers d = {.text = text};
    text[0] = '\0';
    try_all(&d);
    if (!text[0] && d.pocl) td_cache_trouble(text);
    if (!text[0] && d.count)
        snprintf(text, TD_TROUBLE_MAX,
                 "%d driver%s installed and can be loaded, but %s no device: is the hardware there, and "
                 "may this user open it (groups video, render)?",
                 d.count, d.count == 1 ? " is" : "s are", d.count == 1 ? "has" : "have");
    return text;
}
