/* Internal: PLY files in memory. The header as a table of elements and properties (ply_header.c), and the rows of one
 * element (ply_rows.c). Knows nothing of Gaussians; format: Turk 1994, "The PLY Polygon File Format". */
#ifndef TD_PLY_H
#define TD_PLY_H

#include "tides/base.h"

/* The bytes, and the name that messages give them. */
typedef struct td_ply_file {
    const char *path;
    const unsigned char *data;
    size_t size;
} td_ply_file;

enum { TD_PLY_ASCII = 1, TD_PLY_LITTLE_ENDIAN, TD_PLY_BIG_ENDIAN };

enum {
    TD_PLY_NONE = 0, /* as a list's count type: not a list */
    TD_PLY_INT8,
    TD_PLY_UINT8,
    TD_PLY_INT16,
    TD_PLY_UINT16,
    TD_PLY_INT32,
    TD_PLY_UINT32,
    TD_PLY_FLOAT32,
    TD_PLY_FLOAT64
};

/* A word of the header, where it stands: not terminated. */
typedef struct td_ply_word {
    const char *text;
    size_t length;
} td_ply_word;

typedef struct td_ply_property {
    td_ply_word name;
    int type, count_type;
} td_ply_property;

typedef struct td_ply_element {
    td_ply_word name;
    uint64_t count; /* rows that the header declares */
    size_t first_property, properties;
    size_t line;
} td_ply_element;

typedef struct td_ply_header {
    int format;
    size_t body;      /* byte where the rows begin */
    size_t lines;     /* of the header, its last one included */
    double up[3];     /* what comments say of where up is; zeros: nothing */
    td_ply_word mode; /* of the last comment that says how its splats are drawn: "mip", "default", "2dgs"; empty: none does */
    td_ply_word transfer, exponent; /* the words of "comment ColourTransfer: gamma 2.2"; empty: none */
    td_ply_element *elements;
    td_ply_property *properties; /* of all elements, in order */
    size_t element_count, property_count, element_capacity, property_capacity;
} td_ply_header;

/* 1 where the word is a number. Needs the C locale (td_plain_begin). */
int td_ply_number(td_ply_word word, double *value);

/* On success the caller frees the header; its words live as long as the file's bytes. */
tides_status td_ply_header_parse(const td_ply_file *file, td_ply_header *header, tides_error *error);
void td_ply_header_free(td_ply_header *header);

int td_ply_word_is(td_ply_word word, const char *text);
int td_ply_word_reads(td_ply_word word, const char *text); /* in capitals or not */

/* The word as printable text of at most 40 characters, for messages; the buffer lives as long as the caller's block. */
enum { TD_PLY_QUOTE_BYTES = 44 };
const char *td_ply_quote(td_ply_word word, char text[TD_PLY_QUOTE_BYTES]);
#define TD_PLY_QUOTE(word) td_ply_quote(word, (char[TD_PLY_QUOTE_BYTES]){""})

const td_ply_element *td_ply_find_element(const td_ply_header *header, const char *name);

/* Bytes of a value; 0 for TD_PLY_NONE. */
size_t td_ply_type_bytes(int type);

/* How far the file has been read: the next byte, and (ASCII only) the last line. Starts at {header.body, header.lines}. */
typedef struct td_ply_cursor {
    size_t at, line;
} td_ply_cursor;

/* Where the values of one property go: row i to base[i * stride], and without rounding to wide[i * stride]; NULL skips it. */
typedef struct td_ply_column {
    float *base;
    size_t stride;
    double *wide;
} td_ply_column;

/* TIDES_BAD_FILE where the element's rows can't possibly fit in what is left of the file: to be asked before memory is
 * allocated for them. */
tides_status td_ply_rows_fit(const td_ply_file *file, const td_ply_header *header, const td_ply_element *element,
                             const td_ply_cursor *cursor, tides_error *error);

/* Reads all rows of an element into `columns` (one per property; NULL skips the element) and moves the cursor behind them.
 * Values beyond float's range become infinite. */
tides_status td_ply_rows_read(const td_ply_file *file, const td_ply_header *header, const td_ply_element *element,
                              const td_ply_column *columns, td_ply_cursor *cursor, tides_error *error);

#endif
