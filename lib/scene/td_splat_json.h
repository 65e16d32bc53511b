/* Internal: JSON of splat files (SOG's meta.json, streamed SOG's lod-meta.json, glTF), with a decimal point in any locale. */
#ifndef TD_SPLAT_JSON_H
#define TD_SPLAT_JSON_H

#include "td_base.h"

#include <cjson/cJSON.h>

/* The caller deletes it. TIDES_BAD_FILE where `size` bytes are no JSON; `name` (nullable) is that of a file within `path`. */
tides_status td_splat_json(const char *path, const char *name, const void *text, size_t size, cJSON **json, tides_error *error);

/* object.key as a whole number from `least` to `most`; -1 where it isn't one. */
int64_t td_json_whole(const cJSON *object, const char *key, int64_t least, int64_t most);

/* object.key as `count` finite numbers within float's range. 0: it isn't. */
int td_json_numbers(const cJSON *object, const char *key, double *values, int count);

/* object.key's text; NULL where it has none. */
const char *td_json_text(const cJSON *object, const char *key);

/* 1 where a name that JSON gives to a file is of one beside it, or in a folder below: nothing else is looked at. */
int td_json_is_below(const char *name);

#endif
