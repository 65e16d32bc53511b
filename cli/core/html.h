/* Pages of results: HTML in one file that loads nothing, with tables that sort and pictures as data. Light or dark as the
 * reader's browser. */
#ifndef CLI_HTML_H
#define CLI_HTML_H

#include "cli.h"

/* Writes the document's beginning with its heading. html_end: its end. */
void html_begin(FILE *file, const char *title);
void html_end(FILE *file);

/* Writes text, with entities for characters of markup. */
void html_text(FILE *file, const char *text);

/* Writes an .svg or .png as data, with its name as alternative text; nothing where it can't be read. */
void html_picture(FILE *file, const char *directory, const char *name);

/* Writes an array of objects as a table. Columns are the first object's keys, except those of arrays and objects. */
void html_table(FILE *file, const cJSON *rows);
/* A table written by hand, with numbers to the right. After html_table_begin write the head's cells and </tr></thead><tbody>,
 * then rows of <tr>. */
void html_table_begin(FILE *file);
void html_table_end(FILE *file);

#endif
