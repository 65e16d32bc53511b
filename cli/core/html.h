/* Pages of results: HTML in one file that loads nothing, tables that sort, pictures within; light or dark as the reader has
 * it. */
#ifndef CLI_HTML_H
#define CLI_HTML_H

#include "cli.h"

/* From the document's beginning to its heading, and its end. */
void html_begin(FILE *file, const char *title);
void html_end(FILE *file);

/* Text, with what would be markup as entities. */
void html_text(FILE *file, const char *text);

/* An .svg or .png as data, with its name for who doesn't see it; nothing where it can't be read. */
void html_picture(FILE *file, const char *directory, const char *name);

/* An array of objects; the first one's keys are the columns, but for those that hold arrays and objects. */
void html_table(FILE *file, const cJSON *rows);
/* A table by hand, of whose cells numbers stand to the right: after html_table_begin the head's cells and
 * </tr></thead><tbody>, then rows of <tr>. */
void html_table_begin(FILE *file);
void html_table_end(FILE *file);

#endif
