/* Writes text files of numbers: with a decimal point in any locale, to PATH.part first, renamed when all is on the disk. */
#include "td_text.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static tides_status fail_write(const td_text *text, int reason, tides_error *error) {
    return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", text->path, strerror(reason));
}

static void free_text(td_text *text) {
    if (text->plain) freelocale(text->plain);
    free(text->part);
    free(text->path);
    memset(text, 0, sizeof *text);
}

static locale_t plain_locale(void) { return newlocale(LC_NUMERIC_MASK, "C", (locale_t)0); }

tides_status td_text_open(td_text *text, const char *path, tides_error *error) {
    memset(text, 0, sizeof *text);
    text->path = td_strdup(path, error);
    tides_status status = text->path ? td_part_name(path, 1, &text->part, error) : TIDES_NO_MEMORY;
    if (status == TIDES_OK) {
        text->plain = plain_locale();
        text->file = text->plain ? td_part_open(text->part, text->path) : NULL;
        if (!text->file) status = fail_write(text, errno, error);
    }
    if (status != TIDES_OK) free_text(text);
    return status;
}

/* The thread's locale is switched for this line only: between two lines the caller's own code runs. */
tides_status td_text_put(td_text *text, tides_error *error, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    const locale_t before = uselocale(text->plain);
    if (vfprintf(text->file, format, arguments) < 0 && !text->failed) text->failed = errno;
    uselocale(before);
    va_end(arguments);
    return text->failed ? fail_write(text, text->failed, error) : TIDES_OK;
}

tides_status td_text_close(td_text *text, tides_status status, tides_error *error) {
    if (!text->file) return status;
    const int broken = ferror(text->file);
    /* closing writes the buffered rest, and may fail, too */
    if ((fclose(text->file) != 0 || broken) && !text->failed) text->failed = errno ? errno : EIO;
    if (status == TIDES_OK && text->failed) status = fail_write(text, text->failed, error);
    if (status == TIDES_OK)
        status = td_commit_file(text->part, text->path, error);
    else
        td_remove_part(text->part, text->path);
    free_text(text);
    return status;
}

void td_break_lines(char *text) {
    if (strncmp(text, "\xEF\xBB\xBF", 3) == 0) memmove(text, text + 3, strlen(text + 3) + 1);
    for (char *at = text; (at = strchr(at, '\r')); at++) *at = at[1] == '\n' ? ' ' : '\n';
}

tides_status td_plain_begin(td_plain_numbers *numbers, const char *what, tides_error *error) {
    numbers->plain = plain_locale();
    if (!numbers->plain) return td_fail(error, TIDES_NO_MEMORY, "%s: the C locale can't be had", what);
    numbers->before = uselocale(numbers->plain);
    return TIDES_OK;
}

void td_plain_end(const td_plain_numbers *numbers) {
    uselocale(numbers->before);
    freelocale(numbers->plain);
}
