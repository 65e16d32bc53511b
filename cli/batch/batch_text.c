/* Helpers of the batch: formatted strings, JSON files. */
#include "batch.h"

#include <stdio.h>
#include <stdlib.h>

/* A manifest of a hundred thousand runs is far below this. */
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
    FILE *file = fopen(path, "rb");
    if (!file) return NULL;
    long bytes = fseek(file, 0, SEEK_END) == 0 ? ftell(file) : -1;
    char *text = bytes >= 0 && bytes <= JSON_LIMIT && fseek(file, 0, SEEK_SET) == 0 ? malloc((size_t)bytes + 1) : NULL;
    size_t got = text ? fread(text, 1, (size_t)bytes, file) : 0;
    fclose(file);
    cJSON *json = NULL;
    if (text) {
        text[got] = '\0';
        json = cJSON_ParseWithOpts(text, NULL, 1);
    }
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
