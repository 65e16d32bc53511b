/* Reads all vertices of a .ply file as columns by name, for methods that add their own properties (SpacetimeGaussians). */
#include "scene/td_ply_table.h"

#include "td_base.h"

#include <stdlib.h>
#include <string.h>

static tides_status read_rows(const td_ply_file *file, td_ply_table *table, tides_error *error) {
    td_ply_cursor cursor = {table->header.body, table->header.lines};
    size_t properties = table->vertex->properties;
    tides_status status = td_ply_rows_fit(file, &table->header, table->vertex, &cursor, error);
    if (status != TIDES_OK) return status;
    td_ply_column *columns = td_alloc(properties, sizeof *columns, error);
    table->values = td_alloc((size_t)table->vertex->count * properties, sizeof *table->values, error);
    if (!columns || !table->values) status = TIDES_NO_MEMORY;
    for (size_t i = 0; i < properties && status == TIDES_OK; i++) {
        if (table->header.properties[table->vertex->first_property + i].count_type) continue; /* a list: no column */
        columns[i].base = table->values + i;
        columns[i].stride = properties;
    }
    for (const td_ply_element *e = table->header.elements; e <= table->vertex && status == TIDES_OK; e++)
        status = td_ply_rows_read(file, &table->header, e, e == table->vertex ? columns : NULL, &cursor, error);
    free(columns);
    return status;
}

tides_status td_ply_table_open(const char *path, td_ply_table *table, tides_error *error) {
    size_t bytes = 0;
    memset(table, 0, sizeof *table);
    table->path = path;
    tides_status status = td_read_file(path, SIZE_MAX / 64, &table->data, &bytes, error);
    if (status != TIDES_OK) return status;
    const td_ply_file file = {path, (const unsigned char *)table->data, bytes};
    status = td_ply_header_parse(&file, &table->header, error);
    if (status == TIDES_OK) {
        table->vertex = td_ply_find_element(&table->header, "vertex");
        if (!table->vertex || table->vertex->count == 0)
            status = td_fail(error, TIDES_BAD_FILE, "%s: has no element vertex with rows: there is no Gaussian in it", path);
        else {
            table->rows = (int64_t)table->vertex->count;
            status = read_rows(&file, table, error);
        }
    }
    if (status != TIDES_OK) td_ply_table_close(table);
    return status;
}

void td_ply_table_close(td_ply_table *table) {
    td_ply_header_free(&table->header);
    free(table->values);
    free(table->data);
    memset(table, 0, sizeof *table);
}

static size_t find(const td_ply_table *table, const char *name) {
    size_t i = 0;
    while (i < table->vertex->properties &&
           !td_ply_word_is(table->header.properties[table->vertex->first_property + i].name, name))
        i++;
    return i;
}

int td_ply_table_has(const td_ply_table *table, const char *name) { return find(table, name) < table->vertex->properties; }

tides_status td_ply_table_column(const td_ply_table *table, const char *name, float *out, size_t stride, tides_error *error) {
    size_t column = find(table, name), properties = table->vertex->properties;
    if (column == properties || table->header.properties[table->vertex->first_property + column].count_type)
        return td_fail(error, TIDES_BAD_FILE, "%s: element vertex has no number '%s'", table->path, name);
    for (size_t i = 0; i < (size_t)table->rows; i++) out[i * stride] = table->values[i * properties + column];
    return TIDES_OK;
}

tides_status td_ply_table_columns(const td_ply_table *table, const char *prefix, int count, float **out, tides_error *error) {
    tides_status status = TIDES_OK;
    float *made = td_alloc((size_t)table->rows, (size_t)count * sizeof *made, error);
    if (!made) return TIDES_NO_MEMORY;
    for (int k = 0; k < count && status == TIDES_OK; k++) {
        char name[64];
        snprintf(name, sizeof name, "%s_%d", prefix, k);
        status = td_ply_table_column(table, name, made + k, (size_t)count, error);
    }
    if (status != TIDES_OK) {
        free(made);
        return status;
    }
    *out = made;
    return TIDES_OK;
}
