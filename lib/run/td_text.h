/* Internal to lib/run: text files of numbers, written beside and renamed, with a decimal point in any locale. */
#ifndef TD_TEXT_H
#define TD_TEXT_H

#include "td_base.h"

#include <locale.h>

typedef struct td_text {
    FILE *file;
    char *path, *part; /* to write, and what is written to */
    locale_t plain, before;
    int failed; /* errno of the first line that couldn't be written */
} td_text;

/* Begins a file; between this and td_text_close the thread has the C locale. */
tides_status td_text_open(td_text *text, const char *path, tides_error *error);
void td_text_put(td_text *text, const char *format, ...) TD_PRINTF(2, 3);

/* Puts the file in place where `status` is TIDES_OK, else removes it; the status, or why it couldn't be written. Of a text that
 * wasn't opened it does nothing. */
tides_status td_text_close(td_text *text, tides_status status, tides_error *error);

#endif
