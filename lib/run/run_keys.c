/* Values of a run's keys, the sources of these values, and notes for the user. */
#include "td_params.h"
#include "td_run.h"

#include <string.h>

const cJSON *td_run_value(const tides_run *run, const char *key) {
    const tides_param *row = td_param_find(key);
    return row ? run->values[row - tides_params(NULL)] : NULL;
}

double td_run_number(const tides_run *run, const char *key) {
    const cJSON *value = td_run_value(run, key);
    return cJSON_IsNumber(value) ? value->valuedouble : 0.0;
}

const char *td_run_file(const tides_run *run, const char *key) { return run->files[td_param_find(key) - tides_params(NULL)]; }

char *td_run_resolve(const tides_run *run, const char *path, tides_error *error) {
    if (path[0] == '/' || !run->directory[0] || strcmp(path, "-") == 0) return td_strdup(path, error);
    const char *slash = run->directory[strlen(run->directory) - 1] == '/' ? "" : "/";
    return td_format(error, "%s%s%s", run->directory, slash, path);
}

int32_t tides_run_gives(const tides_run *run, const char *key) {
    const tides_param *row = run && key ? td_param_find(key) : NULL;
    const int32_t given = row ? run->given[row - tides_params(NULL)] : 0;
    return given != 0 && given != TD_GIVEN_PRESET;
}

tides_status td_run_note(tides_run *run, const char *line, tides_error *error) {
    return td_note(&run->notes, error, "%s", line);
}

const char *tides_run_notes(const tides_run *run) { return run && run->notes ? run->notes : ""; }
