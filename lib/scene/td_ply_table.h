/* Internal: the vertices of a .ply file as columns of numbers by name, for methods that add their own properties. */
#ifndef TD_PLY_TABLE_H
#define TD_PLY_TABLE_H

#include "scene/td_ply.h"

typedef struct td_ply_table {
    const char *path; /* borrowed */
    char *data;
    td_ply_header header;
    const td_ply_element *vertex;
    float *values; /* (rows x properties) */
    int64_t rows;
} td_ply_table;

/* Reads a file whole. On success the caller closes the table. */
tides_status td_ply_table_open(const char *path, td_ply_table *table, tides_error *error);
void td_ply_table_close(td_ply_table *table);

/* 1 if there is a property of this name. */
int td_ply_table_has(const td_ply_table *table, const char *name);

/* Copies column `name` to out[row * stride]. TIDES_BAD_FILE if it doesn't exist. */
tides_status td_ply_table_column(const td_ply_table *table, const char *name, float *out, size_t stride, tides_error *error);

/* Columns PREFIX_0 .. PREFIX_(count - 1) as rows of `count` numbers; the caller frees them. */
tides_status td_ply_table_columns(const td_ply_table *table, const char *prefix, int count, float **out, tides_error *error);

#endif
