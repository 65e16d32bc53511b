/* Helpers around HDF5 for all files that use it: silenced error output, reasons of failures, attributes, datasets of rows,
 * and closing handles. */
#include "td_h5.h"

#include "td_h5_text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void td_h5_quiet_begin(td_h5_quiet *saved) {
    saved->function = NULL;
    saved->data = NULL;
    H5Eget_auto2(H5E_DEFAULT, &saved->function, &saved->data);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
}

void td_h5_quiet_end(const td_h5_quiet *saved) { H5Eset_auto2(H5E_DEFAULT, saved->function, saved->data); }

/* Called by HDF5 for each entry of its error stack; entry 0 is where the failure began. Entries of the driver wrap the
 * system's message in addresses and times: only the message is kept. */
static herr_t take_reason(unsigned n, const H5E_error2_t *entry, void *user) {
    td_h5_reason *reason = user;
    if (n > 0 || !entry->desc) return 0;
    static const char mark[] = "error message = '";
    const char *start = strstr(entry->desc, mark);
    if (start) start += sizeof mark - 1;
    const char *end = start ? strchr(start, '\'') : NULL;
    if (!end) {
        start = entry->desc;
        end = start + strlen(start);
    }
    snprintf(reason->text, sizeof reason->text, "%.*s", (int)(end - start), start);
    return 0;
}

const char *td_h5_reason_text(td_h5_reason *reason) {
    reason->text[0] = '\0';
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_reason, reason);
    if (!reason->text[0]) snprintf(reason->text, sizeof reason->text, "HDF5 gives no reason");
    for (char *c = reason->text; *c; c++)
        if (*c == '\n') *c = ' ';
    return reason->text;
}

herr_t td_h5_forbid_evictions(hid_t file) {
    H5AC_cache_config_t config = {.version = H5AC__CURR_CACHE_CONFIG_VERSION};
    if (H5Fget_mdc_config(file, &config) < 0) return -1;
    config.incr_mode = H5C_incr__off;
    config.flash_incr_mode = H5C_flash_incr__off;
    config.decr_mode = H5C_decr__off;
    config.evictions_enabled = 0;
    return H5Fset_mdc_config(file, &config);
}

/* A UTF-8 string type of `size` bytes, or H5T_VARIABLE. */
static hid_t text_type(size_t size) {
    hid_t type = H5Tcopy(H5T_C_S1);
    if (type < 0) return type;
    if (H5Tset_size(type, size) >= 0 && H5Tset_cset(type, H5T_CSET_UTF8) >= 0) return type;
    H5Tclose(type);
    return H5I_INVALID_HID;
}

herr_t td_h5_write_number(hid_t file, const char *name, hid_t file_type, hid_t memory_type, const void *value) {
    hid_t space = H5Screate(H5S_SCALAR);
    hid_t attribute = space < 0 ? -1 : H5Acreate2(file, name, file_type, space, H5P_DEFAULT, H5P_DEFAULT);
    herr_t failed = attribute < 0 ? -1 : H5Awrite(attribute, memory_type, value);
    td_h5_close(attribute);
    td_h5_close(space);
    return failed;
}

/* Writes a text that is too long for an attribute as a dataset. */
static herr_t write_dataset(hid_t file, const char *name, hid_t type, const char *text) {
    hid_t creation = H5Pcreate(H5P_DATASET_CREATE), space = H5Screate(H5S_SCALAR), dataset = -1;
    if (creation >= 0 && space >= 0 && H5Pset_obj_track_times(creation, 0) >= 0)
        dataset = H5Dcreate2(file, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    herr_t failed = dataset < 0 ? -1 : H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text);
    td_h5_close(dataset);
    td_h5_close(space);
    td_h5_close(creation);
    return failed;
}

herr_t td_h5_write_text(hid_t file, const char *name, const char *text) {
    size_t bytes = strlen(text) + 1;
    hid_t type = text_type(bytes);
    herr_t failed = -1;
    if (type >= 0)
        failed = bytes > TD_H5_ATTRIBUTE_MAX ? write_dataset(file, name, type, text)
                                             : td_h5_write_number(file, name, type, type, text);
    td_h5_close(type);
    return failed;
}

herr_t td_h5_write_free_text(hid_t file, const char *name, const char *text) {
    hid_t type = text_type(H5T_VARIABLE);
    herr_t failed = type < 0 ? -1 : td_h5_write_number(file, name, type, type, &text);
    td_h5_close(type);
    return failed;
}

herr_t td_h5_remove_text(hid_t file, const char *name) {
    return H5Aexists(file, name) > 0 ? H5Adelete(file, name) : H5Ldelete(file, name, H5P_DEFAULT);
}

herr_t td_h5_write_int(hid_t file, const char *name, hid_t type, int64_t value) {
    return td_h5_write_number(file, name, type, H5T_NATIVE_INT64, &value);
}

/* Opens a scalar attribute of this class, and its type; 0 if there is none. */
static int open_attribute(hid_t file, const char *name, H5T_class_t class, hid_t *attribute, hid_t *type) {
    if (H5Aexists(file, name) <= 0) return 0;
    *attribute = H5Aopen(file, name, H5P_DEFAULT);
    hid_t space = *attribute < 0 ? -1 : H5Aget_space(*attribute);
    *type = *attribute < 0 ? -1 : H5Aget_type(*attribute);
    int usable = space >= 0 && *type >= 0 && H5Tget_class(*type) == class && H5Sget_simple_extent_npoints(space) == 1;
    td_h5_close(space);
    if (usable) return 1;
    td_h5_close(*type);
    td_h5_close(*attribute);
    return 0;
}

/* Reads a text of fixed length, which the caller frees; NULL on failure. */
static char *read_fixed_text(hid_t id, hid_t type, int dataset) {
    size_t bytes = H5Tget_size(type);
    char *text = bytes > 0 && bytes <= TD_H5_TEXT_MAX ? calloc(bytes + 1, 1) : NULL;
    herr_t failed = !text ? -1 : dataset ? H5Dread(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text) : H5Aread(id, type, text);
    if (failed >= 0) return text;
    free(text);
    return NULL;
}

static char *text_in_dataset(hid_t file, const char *name) {
    hid_t dataset = H5Lexists(file, name, H5P_DEFAULT) > 0 ? H5Dopen2(file, name, H5P_DEFAULT) : -1;
    hid_t type = dataset < 0 ? -1 : H5Dget_type(dataset), space = dataset < 0 ? -1 : H5Dget_space(dataset);
    int usable = type >= 0 && H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0 &&
                 H5Sget_simple_extent_npoints(space) == 1;
    char *text = usable ? read_fixed_text(dataset, type, 1) : NULL;
    td_h5_close(space);
    td_h5_close(type);
    td_h5_close(dataset);
    return text;
}

char *td_h5_text(hid_t file, const char *name) {
    hid_t attribute, type;
    if (H5Aexists(file, name) == 0) return text_in_dataset(file, name);
    if (!open_attribute(file, name, H5T_STRING, &attribute, &type)) return NULL;
    char *text =
        H5Tis_variable_str(type) > 0 ? td_h5_free_text(file, name, TD_H5_TEXT_MAX) : read_fixed_text(attribute, type, 0);
    td_h5_close(type);
    td_h5_close(attribute);
    return text;
}

int td_h5_read_text(hid_t file, const char *name, char *text, size_t size) {
    char *found = td_h5_text(file, name);
    if (found) snprintf(text, size, "%s", found);
    free(found);
    return found != NULL;
}

int td_h5_read_int(hid_t file, const char *name, int64_t *value) {
    hid_t attribute, type;
    if (!open_attribute(file, name, H5T_INTEGER, &attribute, &type)) return 0;
    int64_t read = 0;
    int got = H5Aread(attribute, H5T_NATIVE_INT64, &read) >= 0;
    if (got) *value = read;
    td_h5_close(type);
    td_h5_close(attribute);
    return got;
}

/* -- rows -- */

hid_t td_h5_create_rows(hid_t file, const char *name, hid_t type, hsize_t chunk) {
    const hsize_t none = 0, unlimited = H5S_UNLIMITED;
    hid_t dataset = -1, space = H5Screate_simple(1, &none, &unlimited), creation = H5Pcreate(H5P_DATASET_CREATE);
    if (space >= 0 && creation >= 0 && H5Pset_chunk(creation, 1, &chunk) >= 0 && H5Pset_shuffle(creation) >= 0 &&
        H5Pset_deflate(creation, 1) >= 0 && H5Pset_obj_track_times(creation, 0) >= 0)
        dataset = H5Dcreate2(file, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    td_h5_close(creation);
    td_h5_close(space);
    return dataset;
}

/* Reads into `to`, or writes `from`; the other one is NULL. */
static herr_t transfer_rows(hid_t dataset, hid_t type, uint64_t first, size_t count, const void *from, void *to) {
    const hsize_t start = first, rows = count;
    hid_t memory = H5Screate_simple(1, &rows, NULL), file = H5Dget_space(dataset);
    herr_t failed = -1;
    if (memory >= 0 && file >= 0 && H5Sselect_hyperslab(file, H5S_SELECT_SET, &start, NULL, &rows, NULL) >= 0)
        failed = to ? H5Dread(dataset, type, memory, file, H5P_DEFAULT, to)
                    : H5Dwrite(dataset, type, memory, file, H5P_DEFAULT, from);
    td_h5_close(file);
    td_h5_close(memory);
    return failed;
}

herr_t td_h5_append_rows(hid_t dataset, hid_t type, uint64_t first, size_t count, const void *values) {
    const hsize_t total = first + count;
    return H5Dset_extent(dataset, &total) < 0 ? -1 : transfer_rows(dataset, type, first, count, values, NULL);
}

herr_t td_h5_read_rows(hid_t dataset, hid_t type, uint64_t first, size_t count, void *values) {
    return transfer_rows(dataset, type, first, count, NULL, values);
}

static void close_any(hid_t id) {
    switch (H5Iget_type(id)) {
        case H5I_DATASET: H5Dclose(id); break;
        case H5I_ATTR: H5Aclose(id); break;
        case H5I_DATASPACE: H5Sclose(id); break;
        case H5I_DATATYPE: H5Tclose(id); break;
        case H5I_GROUP: H5Gclose(id); break;
        case H5I_GENPROP_LST: H5Pclose(id); break;
        case H5I_FILE: H5Fclose(id); break;
        default: break;
    }
}

void td_h5_close(hid_t id) {
    if (id < 0) return;
    hid_t stack = H5Eget_num(H5E_DEFAULT) > 0 ? H5Eget_current_stack() : H5I_INVALID_HID;
    close_any(id);
    if (stack >= 0) H5Eset_current_stack(stack); /* HDF5 frees the copy */
}
