/* Internal: numbers as text, with a decimal point in any locale: files that are written beside and renamed, of which any number
 * may be open, and a span of code that reads. */
#ifndef TD_TEXT_H
#define TD_TEXT_H

#include "td_base.h"

#include <locale.h>

typedef struct td_text {
    FILE *file;        /* NULL: not open */
    char *path, *part; /* to write, and what is written to */
    locale_t plain;
    int failed; /* errno of the first line that couldn't be written */
} td_text;

tides_status td_text_open(td_text *text, const char *path, tides_error *error);

/* The status of all lines so far: who doesn't look at it (and gives NULL for the error) hears it from td_text_close. */
tides_status td_text_put(td_text *text, tides_error *error, const char *format, ...) TD_PRINTF(3, 4);

/* Puts the file in place where `status` is TIDES_OK, else removes it; the status, or why it couldn't be written. It does
 * nothing for a text that isn't open. */
tides_status td_text_close(td_text *text, tides_status status, tides_error *error);
static inline void td_text_drop(td_text *text) { (void)td_text_close(text, TIDES_CANCELLED, NULL); }

/* Line breaks of a text that was read whole become LF alone: CR LF, and CR as old spreadsheets write it. A byte order mark
 * goes. Lines keep their numbers. */
void td_break_lines(char *text);

/* The calling thread's locale is C's from begin to end: strtod and cJSON read "1.5" as 1 where the program around us has chosen
 * one with a decimal comma. Where _begin fails, for want of memory for `what`, there is nothing to end. */
typedef struct td_plain_numbers {
    locale_t plain, before;
} td_plain_numbers;
tides_status td_plain_begin(td_plain_numbers *numbers, const char *what, tides_error *error);
void td_plain_end(const td_plain_numbers *numbers);

#endif
