/* Internal: writes and reads numbers as text with a decimal point, whatever the program's locale. A text file is written as
 * PATH.part and renamed when it is complete. Any number may be open at once. */
#ifndef TD_TEXT_H
#define TD_TEXT_H

#include "td_base.h"

#include <locale.h>

typedef struct td_text {
    FILE *file;        /* NULL: not open */
    char *path, *part; /* final path, and path while it is written */
    locale_t plain;
    int failed; /* errno of the first line that couldn't be written */
} td_text;

tides_status td_text_open(td_text *text, const char *path, tides_error *error);

/* Writes formatted text; returns the status of all writes so far. A caller may ignore it (with a NULL error), since
 * td_text_close reports it again. */
tides_status td_text_put(td_text *text, tides_error *error, const char *format, ...) TD_PRINTF(3, 4);

/* Closes the file and renames it if `status` is TIDES_OK; otherwise removes it. Returns `status`, or the reason why it
 * couldn't be written. A text that isn't open is left alone. */
tides_status td_text_close(td_text *text, tides_status status, tides_error *error);
static inline void td_text_drop(td_text *text) { (void)td_text_close(text, TIDES_CANCELLED, NULL); }

/* Replaces the line breaks of a whole text, CR LF or CR, by LF. Also removes a byte order mark. Line numbers stay the same. */
void td_break_lines(char *text);

/* From begin to end the calling thread has the C locale. In a program with a decimal comma, strtod and cJSON would read
 * "1.5" as 1. _begin fails if memory is short; then _end must not be called. */
typedef struct td_plain_numbers {
    locale_t plain, before;
} td_plain_numbers;
tides_status td_plain_begin(td_plain_numbers *numbers, const char *what, tides_error *error);
void td_plain_end(const td_plain_numbers *numbers);

#endif
