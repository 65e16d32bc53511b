/* Internal: parses PLY files in memory: the header as a table of elements and properties, and the rows of one element. It is
 * independent of Gaussians. Format: Turk 1994, "The PLY Polygon File Format". */
#ifndef TD_PLY_H
#define TD_PLY_H

#include "tides/base.h"

/* The bytes of a file, and its name for messages. */
typedef struct td_ply_file {
    const char *path;
    const unsigned char *data;
    size_t size;
} td_ply_file;

enum { TD_PLY_ASCII = 1, TD_PLY_LITTLE_ENDIAN, TD_PLY_BIG_ENDIAN };

enum {
    TD_PLY_NONE = 0, /* the count type of a property that isn't a list */
    TD_PLY_INT8,
    TD_PLY_UINT8,
    TD_PLY_INT16,
    TD_PLY_UINT16,
    TD_PLY_INT32,
    TD_PLY_UINT32,
    TD_PLY_FLOAT32,
    TD_PLY_FLOAT64
};

/* A word within the header, without a NUL. */
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
    uint64_t count; /* number of rows */
    size_t first_property, properties;
    size_t line;
} td_ply_element;

typedef struct td_ply_header {
    int format;
    size_t body;                    /* byte where the rows begin */
    size_t lines;                   /* number of lines of the header */
    double up[3];                   /* up direction from comments; zeros: unknown */
    td_ply_word mode;               /* training mode from comments: "mip", "default", "2dgs"; empty: unknown */
    td_ply_word transfer, exponent; /* words of "comment ColourTransfer: gamma 2.2"; empty: none */
    td_ply_element *elements;
    td_ply_property *properties; /* of all elements, in order */
    size_t element_count, property_count, element_capacity, property_capacity;
} td_ply_header;

/* 1 if the word is a number. The thread must have the C locale (td_plain_begin). */
int td_ply_number(td_ply_word word, double *value);

/* On success the caller frees the header. Its words point into the file's bytes. */
tides_status td_ply_header_parse(const td_ply_file *file, td_ply_header *header, tides_error *error);
void td_ply_header_free(td_ply_header *header);

int td_ply_word_is(td_ply_word word, const char *text);
int td_ply_word_reads(td_ply_word word, const char *text); /* in any case */

/* The word as printable text of at most 40 characters, for messages. The text of TD_PLY_QUOTE lives until the end of the
 * enclosing block. */
enum { TD_PLY_QUOTE_BYTES = 44 };
const char *td_ply_quote(td_ply_word word, char text[TD_PLY_QUOTE_BYTES]);
#define TD_PLY_QUOTE(word) td_ply_quote(word, (char[TD_PLY_QUOTE_BYTES]){""})

const td_ply_element *td_ply_find_element(const td_ply_header *header, const char *name);

/* Bytes of a value; 0 for TD_PLY_NONE. */
size_t td_ply_type_bytes(int type);

/* Position of reading: next byte, and (ASCII only) last line. It starts at {header.body, header.lines}. */
typedef struct td_ply_cursor {
    size_t at, line;
} td_ply_cursor;

/* Target of one property: row i goes to base[i * stride] or, without rounding, to wide[i * stride]; NULL: skipped. */
typedef struct td_ply_column {
    float *base;
    size_t stride;
    double *wide;
} td_ply_column;

/* TIDES_BAD_FILE if the element's rows can't fit into the rest of the file. Call it before memory is allocated for them. */
tides_status td_ply_rows_fit(const td_ply_file *file, const td_ply_header *header, const td_ply_element *element,
                             const td_ply_cursor *cursor, tides_error *error);

/* Reads all rows of an element into `columns` (one per property; NULL skips the element), and moves the cursor behind them.
 * Values beyond float's range become infinite. */
tides_status td_ply_rows_read(const td_ply_file *file, const td_ply_header *header, const td_ply_element *element,
                              const td_ply_column *columns, td_ply_cursor *cursor, tides_error *error);

#endif
