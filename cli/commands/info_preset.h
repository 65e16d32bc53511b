/* Facts of sensor presets for tides info. */
#ifndef CLI_INFO_PRESET_H
#define CLI_INFO_PRESET_H

#include "cli.h"

/* 1 where the file is a preset: { "about": .., "sensor": {..}, "frontend": {..}, "readout": {..}, "image": {..} } with version
 * and resolution, and nothing else. Then `facts` are filled in, or `status` and `error` have the fault. */
int32_t info_preset(const char *file, cJSON *facts, tides_status *status, tides_error *error);

/* Facts of a preset by its name; TIDES_FILE_NOT_FOUND: there is none. */
tides_status info_named_preset(const char *name, cJSON *facts, tides_error *error);

/* How many of a preset's values are of a kind: documented, measured, derived, guess, or "not said". */
int32_t info_preset_kinds(const cJSON *json, const char *kind);

#endif
