/* The statistics of a run as JSON (DESIGN 6): the library's table, and facts of version and device. */
#include "session.h"

#include <string.h>

/* Adds every row of the table; "time_s.build" goes into the object time_s, "settings.unit" into settings. */
static int32_t add_rows(cJSON *root, const tides_stats *stats) {
    size_t count;
    const tides_stat *rows = tides_stats_table(&count);
    int32_t ok = 1;
    for (size_t i = 0; ok && i < count; i++) {
        const char *name = rows[i].name, *dot = strchr(name, '.');
        cJSON *group = root;
        if (dot) {
            char key[32];
            snprintf(key, sizeof key, "%.*s", (int)(dot - name), name);
            group = cJSON_GetObjectItemCaseSensitive(root, key);
            if (!group) group = cJSON_AddObjectToObject(root, key);
            name = dot + 1;
        }
        ok = group && cJSON_AddNumberToObject(group, name, tides_stat_value(stats, &rows[i])) != NULL;
    }
    return ok;
}

cJSON *cli_stats_json(const tides_stats *stats, const tides_session_facts *session) {
    cJSON *root = cJSON_CreateObject();
    int32_t ok = root && add_rows(root, stats);
    ok = ok && cJSON_AddStringToObject(root, "device", session->info.name);
    ok = ok && cJSON_AddStringToObject(root, "platform", session->info.platform);
    ok = ok && cJSON_AddNumberToObject(root, "lanes", session->info.lanes);
    ok = ok && cJSON_AddNumberToObject(root, "width", session->intrinsics.width);
    ok = ok && cJSON_AddNumberToObject(root, "height", session->intrinsics.height);
    ok = ok && cJSON_AddStringToObject(root, "version", tides_version());
    ok = ok && cJSON_AddNumberToObject(root, "numerics", TIDES_NUMERICS);
    ok = ok && cJSON_AddStringToObject(root, "seed", session->values.seed);
    if (!ok) {
        cJSON_Delete(root);
        root = NULL;
    }
    return root;
}
