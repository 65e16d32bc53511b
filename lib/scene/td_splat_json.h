/* Internal: JSON of splat files (SOG's meta.json, streamed SOG's lod-meta.json, glTF), with a decimal point in any locale. */
#ifndef TD_SPLAT_JSON_H
#define TD_SPLAT_JSON_H

#include "td_base.h"

#include <cjson/cJSON.h>

/* Parses JSON, which the caller deletes. TIDES_BAD_FILE if it is invalid; `name` (may be NULL) is a file within `path`. */
tides_status td_splat_json(const char *path, const char *name, const void *text, size_t size, cJSON **json, tides_error *error);

/* object.key as a whole number from `least` to `most`; -1 if it isn't one. */
int64_t td_json_whole(const cJSON *object, const char *key, int64_t least, int64_t most);

/* Reads object.key as `count` finite numbers within float's range; 0 if it isn't that. */
int td_json_numbers(const cJSON *object, const char *key, double *values, int count);

/* The text of object.key; NULL if it isn't a text. */
const char *td_json_text(const cJSON *object, const char *key);

/* 1 if a file name from JSON lies beside the JSON or in a folder below it. Other names are refused, so that a scene can't
 * make TIDES read other files. */
int td_json_is_below(const char *name);

#endif
