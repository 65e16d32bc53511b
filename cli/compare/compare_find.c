/* Finds values of reports by their path, and formats numbers for tables. */
#include "compare.h"

#include <math.h>
#include <string.h>

const cJSON *compare_find(const cJSON *object, const char *path) {
    char name[64];
    while (object && *path) {
        const size_t length = strcspn(path, ".");
        if (length >= sizeof name) return NULL;
        snprintf(name, sizeof name, "%.*s", (int)length, path);
        object = cJSON_GetObjectItemCaseSensitive(object, name);
        path += length + (path[length] == '.');
    }
    return object;
}

const char *compare_number(double value, char text[32]) {
    snprintf(text, 32, value == floor(value) || fabs(value) >= 1000 ? "%.0f" : "%.3g", value);
    return text;
}
