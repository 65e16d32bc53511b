/* Helpers of the batch: formatted strings, and JSON files. */
#include "batch.h"

#include <stdio.h>
#include <stdlib.h>

/* [bytes] A manifest of 100 000 runs is far smaller. */
enum { JSON_LIMIT = 1 << 26 };

char *batch_text(const char *format, ...) {
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    const int length = vsnprintf(NULL, 0, format, arguments);
    char *text = length < 0 ? NULL : malloc((size_t)length + 1);
    if (text) vsnprintf(text, (size_t)length + 1, format, again);
    va_end(again);
    va_end(arguments);
    return text;
}

cJSON *batch_read_json(const char *path) {
    size_t size = 0;
    char *text = cli_read_file(path, &size);
    cJSON *json = text && size <= JSON_LIMIT ? cJSON_ParseWithOpts(text, NULL, 1) : NULL;
    free(text);
    return json;
}

tides_status batch_write_json(const char *path, const cJSON *json, tides_error *error) {
    char *text = json ? cJSON_Print(json) : NULL;
    tides_status status = text ? cli_write_text(path, text, error) : batch_no_memory(error);
    cJSON_free(text);
    return status;
}

tides_status batch_no_memory(tides_error *error) { return cli_error(error, TIDES_NO_MEMORY, "out of memory"); }
