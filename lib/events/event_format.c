/* The table of event formats, and the choice of one: by name, by a file's content, or by the ending of a file to write. */
#include "td_event_format.h"

#include "td_event_rows.h"

#include "td_folder.h"
#include "td_kinds.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* In the order of detection: magic numbers first, then headers, then plain text, then formats recognised only by their size. */
const td_event_format *const td_event_formats[] = {
    &td_format_ecf,  &td_format_hdf5,   &td_format_aedat4,     &td_format_aedat2, &td_format_es,
    &td_format_evt4, &td_format_evt3,   &td_format_evt21,      &td_format_evt2,   &td_format_dat,
    &td_format_csv,  &td_format_csv_ns, &td_format_csv_openeb, &td_format_npy,    &td_format_npz,
    &td_format_ergb, &td_format_e2vid,  &td_format_ecd,        &td_format_nmnist, NULL,
};

enum { FORMATS_MAX = 32 };

tides_status td_event_format_named(const char *name, const td_event_format **format, tides_error *error) {
    const char *names[FORMATS_MAX + 1] = {NULL};
    for (size_t i = 0; td_event_formats[i]; i++) {
        names[i] = td_event_formats[i]->name;
        if (strcmp(name, names[i]) != 0) continue;
        *format = td_event_formats[i];
        return TIDES_OK;
    }
    const char *nearest = tides_nearest_name(name, names);
    return td_fail(error, TIDES_BAD_ARGUMENT, "\"%s\" is no format of event files%s%s%s", name,
                   nearest ? "; did you mean " : "", nearest ? nearest : "",
                   nearest ? "?" : ": tides convert --help lists them");
}

static tides_status probe_file(const char *path, td_event_probe *probe, tides_error *error) {
    struct stat there;
    FILE *file = fopen(path, "rb");
    if (!file) return td_fail(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened: %s", path, strerror(errno));
    if (fstat(fileno(file), &there) != 0) there.st_size = 0;
    memset(probe, 0, sizeof *probe);
    probe->path = path;
    probe->bytes = fread(probe->head, 1, TD_EVENT_HEAD, file);
    int unreadable = ferror(file) ? errno : 0;
    if (there.st_size > 0) probe->size = (uint64_t)there.st_size;
    fclose(file);
    if (unreadable) return td_fail(error, TIDES_BAD_FILE, "%s: can't be read: %s", path, strerror(unreadable));
    if (probe->bytes == 0) return td_fail(error, TIDES_BAD_FILE, "%s: is empty", path);
    return TIDES_OK;
}

/* 1 if a line of the header begins with `text`. The header's lines begin with "% ". */
static int header_has(const td_event_probe *probe, const char *text) {
    const char *at = probe->head, *end = probe->head + probe->bytes;
    const size_t length = strlen(text);
    while (at && (size_t)(end - at) >= length && at[0] == '%') {
        if (memcmp(at, text, length) == 0) return 1;
        at = memchr(at, '\n', (size_t)(end - at));
        at = at ? at + 1 : NULL;
    }
    return 0;
}

tides_status td_event_format_detect(const char *path, const tides_event_reading *how, const td_event_format **format,
                                    tides_error *error) {
    td_event_probe probe;
    if (td_is_folder(path)) {
        *format = &td_format_folder;
        return TIDES_OK;
    }
    tides_status status = probe_file(path, &probe, error);
    if (status != TIDES_OK) return status;
    for (size_t i = 0; td_event_formats[i]; i++) {
        if (!td_event_formats[i]->detect || !td_event_formats[i]->detect(&probe)) continue;
        *format = td_event_formats[i];
        return TIDES_OK;
    }
    if (how->columns && !memchr(probe.head, 0, probe.bytes)) { /* a text whose columns the caller gives */
        *format = &td_format_csv;
        return TIDES_OK;
    }
    if (memcmp(probe.head, "\xFF\xFE", 2) == 0 || memcmp(probe.head, "\xFE\xFF", 2) == 0)
        return td_fail(error, TIDES_BAD_FILE, "%s: is text in UTF-16: save it as UTF-8 (iconv -f UTF-16 -t UTF-8)", path);
    if (header_has(&probe, "% evt "))
        return td_fail(error, TIDES_UNSUPPORTED,
                       "%s: is an EVT of a version that isn't read (2.0, 2.1, 3.0 and 4.0 are): metavision_file_to_csv or "
                       "_to_hdf5 makes a file of it that is",
                       path);
    if ((status = td_kind_refuse(path, TD_WANTS_EVENTS, error)) != TIDES_OK) return status;
    if ((status = td_event_text_refuse(&probe, error)) != TIDES_OK) return status;
    return td_fail(error, TIDES_BAD_FILE,
                   "%s: isn't known by its content as an event file (HDF5, AEDAT, EVT, DAT, ES, numpy, CSV, text): name its "
                   "format, as tides convert --from does",
                   path);
}

/* Length of the ending in `endings` ("a b") that `path` has, 0 for none; the longest match wins. */
static size_t ending_fits(const char *path, const char *endings) {
    size_t longest = 0, length = strlen(path);
    while (endings && *endings) {
        size_t part = strcspn(endings, " ");
        if (part < length && part > longest && strncmp(path + length - part, endings, part) == 0) longest = part;
        endings += part + strspn(endings + part, " ");
    }
    return longest;
}

tides_status td_event_format_for(const char *path, const td_event_format **format, tides_error *error) {
    size_t best = 0;
    for (size_t i = 0; td_event_formats[i]; i++) {
        size_t fits = td_event_formats[i]->create ? ending_fits(path, td_event_formats[i]->endings) : 0;
        if (fits <= best) continue;
        best = fits;
        *format = td_event_formats[i];
    }
    if (best > 0) return TIDES_OK;
    const char *name = td_base_name(path), *ending = strrchr(name, '.');
    if (ending && ending[1] && ending != name) {
        static const char endings[] = ".h5, .raw, .dat, .es, .aedat4, .npy, .npz, .csv or .txt";
        char suggestion[TD_SUGGESTION_MAX];
        return td_fail(error, TIDES_UNSUPPORTED, "%s: no format of event files ends in %s: use %s%s", path, ending, endings,
                       td_suggest(ending, endings, ", ", suggestion));
    }
    *format = &td_format_hdf5;
    return TIDES_OK;
}

/* ---- helpers of several formats ---- */

int td_event_microseconds(int64_t us, int64_t *ns) {
    if (us > INT64_MAX / 1000 || us < INT64_MIN / 1000) return 0;
    *ns = us * 1000;
    return 1;
}

void td_event_close_state(td_event_stream *stream) { free(stream->state); }

void td_event_discard_state(td_event_sink *sink) { free(sink->state); }

/* Seconds with up to nine decimals, without trailing zeros: "1589163150.007461", "-0.25". */
static const char *seconds(int64_t ns, char text[40]) {
    const uint64_t size = ns < 0 ? 0 - (uint64_t)ns : (uint64_t)ns;
    int length = snprintf(text, 40, "%s%" PRIu64 ".%09" PRIu64, ns < 0 ? "-" : "", size / 1000000000, size % 1000000000);
    while (text[length - 1] == '0') text[--length] = '\0';
    if (text[length - 1] == '.') text[--length] = '\0';
    return text;
}

/* [ns] A start that precedes the recording by more than this, and by more than the recording's length, is on another clock. */
static const int64_t least_lead = 1000000000;

/* 1 if `start_ns` precedes the recording by more than least_lead and its length. INT64_MIN means that no start is requested.
 * Times are subtracted as unsigned numbers, so that nothing overflows. */
static int leads(int64_t first_ns, int64_t end_ns, int64_t start_ns) {
    const uint64_t lead = (uint64_t)first_ns - (uint64_t)start_ns, length = (uint64_t)end_ns - (uint64_t)first_ns;
    return start_ns != INT64_MIN && start_ns < first_ns && lead > length && lead > (uint64_t)least_lead;
}

tides_status tides_event_stretch_check(const char *file, int64_t first_ns, int64_t end_ns, int64_t start_ns, int64_t stop_ns,
                                       int32_t rebased, tides_error *error) {
    char first[40], end[40], asked[40];
    const int late = start_ns >= end_ns, early = stop_ns <= first_ns;
    if (first_ns >= end_ns || (!late && !early && !leads(first_ns, end_ns, start_ns))) return TIDES_OK;
    return td_fail(error, TIDES_BAD_ARGUMENT,
                   "%s: lasts from %s to %s s, but the requested span %s at %s s: give times within the recording%s",
                   file ? file : "the recording", seconds(first_ns, first), seconds(end_ns, end), early ? "ends" : "begins",
                   seconds(early ? stop_ns : start_ns, asked),
                   rebased ? "" : ", or count from the recording's zero (--rebase, rebase)");
}

tides_status td_event_cut_off(const td_event_stream *stream, tides_error *error) {
    return td_fail(error, TIDES_BAD_FILE, "%s: is cut off: it ends within a record at byte %llu", stream->input.path,
                   (unsigned long long)stream->input.size);
}
