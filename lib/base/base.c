/* Status names, error texts, checked allocation, small text and file helpers. */
#include "td_base.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>

#define TD_TEXT(x) #x
#define TD_VERSION_TEXT(major, minor, patch) TD_TEXT(major) "." TD_TEXT(minor) "." TD_TEXT(patch)

/* clang-format off */
const char *tides_status_name(tides_status status) {
    switch (status) {
#define TD_NAME(name, value, text) case value: return "TIDES_" #name;
        TIDES_STATUS_LIST(TD_NAME)
#undef TD_NAME
        default: return "TIDES_UNKNOWN_STATUS";
    }
}

const char *tides_status_text(tides_status status) {
    switch (status) {
#define TD_STATUS_TEXT(name, value, text) case value: return text;
        TIDES_STATUS_LIST(TD_STATUS_TEXT)
#undef TD_STATUS_TEXT
        default: return "unknown status";
    }
}
/* clang-format on */

const char *tides_version(void) { return TD_VERSION_TEXT(TIDES_VERSION_MAJOR, TIDES_VERSION_MINOR, TIDES_VERSION_PATCH); }

/* Names from files may hold control characters: these are replaced, so that an error stays one line of printable text. */
static void one_line(char *text) {
    for (; *text; text++)
        if ((unsigned char)*text < 0x20 || *text == 0x7f) *text = '?';
}

tides_status(td_fail)(tides_error *error, tides_status status, const char *format, ...) {
    if (error) {
        va_list arguments;
        va_start(arguments, format);
        error->status = status;
        vsnprintf(error->text, sizeof error->text, format, arguments);
        va_end(arguments);
        one_line(error->text);
    }
    return status;
}

tides_status td_fail_within(tides_error *error, tides_status status, const char *format, ...) {
    if (!error) return status;
    char inner[sizeof error->text];
    memcpy(inner, error->text, sizeof inner);
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(error->text, sizeof error->text, format, arguments);
    va_end(arguments);
    if (length < 0 || (size_t)length + 2 >= sizeof error->text) return status;
    char *end = error->text + length;
    size_t room = sizeof error->text - (size_t)length - 3, wanted = strlen(inner); /* room for ": " and the terminator */
    size_t kept = wanted < room ? wanted : room;
    memcpy(end, ": ", 2);
    memcpy(end + 2, inner, kept);
    end[2 + kept] = 0;
    one_line(error->text);
    return status;
}

int td_share_step(void *part, double fraction, const char *stage) {
    const td_share *p = part;
    return p->progress ? p->progress(p->user, p->from + p->width * fraction, p->stage ? p->stage : stage) : 0;
}

void *td_alloc(size_t count, size_t size, tides_error *error) {
    void *memory = NULL;
    if (size == 0 || count <= SIZE_MAX / size) memory = calloc(count ? count : 1, size ? size : 1);
    if (!memory) td_fail(error, TIDES_NO_MEMORY, "out of memory: %zu items of %zu bytes were asked for", count, size);
    return memory;
}

tides_status td_reserve(void **array, size_t *capacity, size_t needed, size_t size, tides_error *error) {
    if (needed <= *capacity) return TIDES_OK;
    size_t grown = *capacity + *capacity / 2;
    if (grown < needed) grown = needed;
    void *memory = grown <= SIZE_MAX / size ? realloc(*array, grown * size) : NULL;
    if (!memory) return td_fail(error, TIDES_NO_MEMORY, "out of memory: %zu items of %zu bytes were asked for", grown, size);
    *array = memory;
    *capacity = grown;
    return TIDES_OK;
}

tides_status td_renew(void **array, size_t *capacity, size_t needed, size_t size, tides_error *error) {
    if (needed <= *capacity) return TIDES_OK;
    free(*array);
    *array = NULL;
    const size_t before = *capacity;
    *capacity = 0;
    return td_reserve(array, capacity, before + before / 2 > needed ? before + before / 2 : needed, size, error);
}

char *td_strdup(const char *text, tides_error *error) {
    size_t bytes = strlen(text) + 1;
    char *copy = td_alloc(bytes, 1, error);
    if (copy) memcpy(copy, text, bytes);
    return copy;
}

char *td_format(tides_error *error, const char *format, ...) {
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    int length = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    char *text = length < 0 ? NULL : td_alloc((size_t)length + 1, 1, error);
    if (text) vsnprintf(text, (size_t)length + 1, format, again);
    va_end(again);
    return text;
}

tides_status td_note(char **notes, tides_error *error, const char *format, ...) {
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    const size_t before = *notes ? strlen(*notes) + 1 : 0;
    const int length = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    char *grown = length < 0 ? NULL : td_alloc(before + (size_t)length + 1, 1, error);
    if (grown && before) snprintf(grown, before + 1, "%s\n", *notes);
    if (grown) vsnprintf(grown + before, (size_t)length + 1, format, again);
    va_end(again);
    if (!grown) return TIDES_NO_MEMORY;
    free(*notes);
    *notes = grown;
    return TIDES_OK;
}

/* Size of an open file, or -1 with the error filled. */
static long td_file_size(FILE *file, const char *path, size_t limit, tides_error *error) {
    struct stat facts;
    if (fstat(fileno(file), &facts) == 0 && S_ISDIR(facts.st_mode)) {
        td_fail(error, TIDES_BAD_FILE, "%s: is a folder, where a file is needed", path);
        return -1;
    }
    long size = fseek(file, 0, SEEK_END) == 0 ? ftell(file) : -1;
    if (size < 0 || fseek(file, 0, SEEK_SET) != 0) {
        td_fail(error, TIDES_BAD_FILE, "%s: is not a regular file", path);
        return -1;
    }
    if ((size_t)size > limit) {
        td_fail(error, TIDES_BAD_FILE, "%s: %ld bytes is more than the %zu that such a file may have", path, size, limit);
        return -1;
    }
    return size;
}

tides_status td_read_file(const char *path, size_t limit, char **data, size_t *bytes, tides_error *error) {
    FILE *file = fopen(path, "rb");
    if (!file) return td_fail(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened: %s", path, strerror(errno));
    tides_status status = TIDES_BAD_FILE;
    char *memory = NULL;
    long size = td_file_size(file, path, limit, error);
    if (size < 0) goto done;
    memory = td_alloc((size_t)size + 1, 1, error);
    if (!memory) {
        status = TIDES_NO_MEMORY;
        goto done;
    }
    if (fread(memory, 1, (size_t)size, file) != (size_t)size) {
        td_fail(error, TIDES_BAD_FILE, "%s: reading stopped early: %s", path, ferror(file) ? strerror(errno) : "end of file");
        goto done;
    }
    *data = memory;
    *bytes = (size_t)size;
    memory = NULL;
    status = TIDES_OK;
done:
    free(memory);
    fclose(file);
    return status;
}

const char *tides_transfer_name(int32_t transfer) {
    static const char *const names[] = {"file", "linear", "srgb", "gamma"};
    const int32_t known = transfer >= TIDES_TRANSFER_FILE && transfer <= TIDES_TRANSFER_GAMMA;
    return known ? names[transfer - TIDES_TRANSFER_FILE] : NULL;
}

static double read_clock(clockid_t clock) {
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double td_now(void) { return read_clock(CLOCK_MONOTONIC); }

double td_own_time(void) { return read_clock(CLOCK_THREAD_CPUTIME_ID); }

uint64_t td_peak_memory(void) {
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? (uint64_t)usage.ru_maxrss * 1024u : 0;
}

const char *td_short(double number, char text[TD_SHORT_MAX]) {
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, TD_SHORT_MAX, "%.*g", digits, number);
        const double back = strtod(text, NULL);
        if (!(back < number || back > number)) break;
    }
    return text;
}
