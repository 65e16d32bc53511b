/* The text of kernels, from the table embedded in the library or, for development, from $TIDES_KERNEL_DIR. Each #include
 * "..." is replaced by the file (once), and #line directives keep file and line correct in the compiler's messages. */
#include "td_device.h"
#include "td_kernel_source.h"

#include <stdlib.h>
#include <string.h>

/* Limits against files that aren't kernels, and against circular includes. */
enum { MAX_KERNEL_FILE = 1 << 20, MAX_DEPTH = 16 };

static tides_status add_piece(td_source_text *text, char *piece, tides_error *error) {
    if (!piece) return TIDES_NO_MEMORY;
    tides_status status = td_reserve((void **)&text->piece, &text->capacity, text->count + 1, sizeof *text->piece, error);
    if (status == TIDES_OK)
        text->piece[text->count++] = piece;
    else
        free(piece);
    return status;
}

/* Loads the text of a kernel file, allocated. */
static tides_status load_file(const char *file, char **text, tides_error *error) {
    const char *directory = getenv("TIDES_KERNEL_DIR");
    if (directory && *directory) {
        size_t bytes;
        char *path = td_format(error, "%s/%s", directory, file);
        if (!path) return TIDES_NO_MEMORY;
        tides_status status = td_read_file(path, MAX_KERNEL_FILE, text, &bytes, error);
        if (status != TIDES_OK) td_fail_within(error, status, "TIDES_KERNEL_DIR");
        free(path);
        return status;
    }
    const td_kernel_source *source = td_kernel_sources;
    while (source->name && strcmp(source->name, file) != 0) source++;
    if (!source->name) return td_fail(error, TIDES_DEVICE_FAILED, "kernel file %s isn't in this library", file);
    size_t bytes = 1;
    for (const char *const *line = source->lines; *line; line++) bytes += strlen(*line);
    char *joined = td_alloc(bytes, 1, error);
    if (!joined) return TIDES_NO_MEMORY;
    char *end = joined;
    for (const char *const *line = source->lines; *line; line++) {
        size_t length = strlen(*line);
        memcpy(end, *line, length);
        end += length;
    }
    *text = joined;
    return TIDES_OK;
}

/* 1 if this file was included already: its first piece is its #line directive. */
static int has_file(const td_source_text *text, const char *file) {
    char mark[128];
    snprintf(mark, sizeof mark, "#line 1 \"%s\"\n", file);
    for (size_t i = 0; i < text->count; i++)
        if (strcmp(text->piece[i], mark) == 0) return 1;
    return 0;
}

/* Finds `name` in a line `#include "name"`; 0 for any other line. */
static int included_name(const char *line, char *name, size_t size) {
    if (strncmp(line, "#include \"", 10) != 0) return 0;
    size_t length = strcspn(line + 10, "\"\n");
    if (line[10 + length] != '"' || length + 1 > size) return 0;
    memcpy(name, line + 10, length);
    name[length] = 0;
    return 1;
}

static tides_status gather(td_source_text *text, const char *file, int depth, tides_error *error);

/* Adds `body` piece by piece, and follows its includes. */
static tides_status add_body(td_source_text *text, const char *file, char *body, int depth, tides_error *error) {
    tides_status status = TIDES_OK;
    int line = 1;
    char name[96];
    for (char *from = body; status == TIDES_OK && *from;) {
        char *to = from;
        while (*to && !included_name(to, name, sizeof name)) { /* up to the next include */
            to += strcspn(to, "\n");
            if (*to) to++;
            line++;
        }
        if (to > from) { /* ends the last line, since another line follows */
            const char *end = to[-1] == '\n' ? "" : "\n";
            status = add_piece(text, td_format(error, "%.*s%s", (int)(to - from), from, end), error);
        }
        if (status != TIDES_OK || !*to) break;
        if (!has_file(text, name)) status = gather(text, name, depth + 1, error);
        line++;
        if (status == TIDES_OK) status = add_piece(text, td_format(error, "#line %d \"%s\"\n", line, file), error);
        from = to + strcspn(to, "\n");
        if (*from) from++;
    }
    return status;
}

static tides_status gather(td_source_text *text, const char *file, int depth, tides_error *error) {
    char *body = NULL;
    if (depth > MAX_DEPTH) return td_fail(error, TIDES_DEVICE_FAILED, "kernel file %s: includes are nested too deeply", file);
    tides_status status = add_piece(text, td_format(error, "#line 1 \"%s\"\n", file), error);
    if (status == TIDES_OK) status = load_file(file, &body, error);
    if (status == TIDES_OK && body) status = add_body(text, file, body, depth, error);
    free(body);
    return status;
}

tides_status td_source_gather(td_source_text *text, const char *file, tides_error *error) {
    return gather(text, file, 0, error);
}

void td_source_release(td_source_text *text) {
    for (size_t i = 0; i < text->count; i++) free(text->piece[i]);
    free(text->piece);
    memset(text, 0, sizeof *text);
}
