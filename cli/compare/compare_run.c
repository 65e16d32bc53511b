/* Runs a row's method, and keeps its events. */
#include "compare.h"

#include <stdlib.h>
#include <string.h>

tides_status compare_keep_events(const comparison *c, const char *name, const tides_session_facts *s, const tides_event *events,
                                 size_t count, tides_error *error) {
    tides_event_writer *writer = NULL;
    int64_t start_ns, stop_ns;
    char path[COMPARE_PATH];
    if (!c->keep) return TIDES_OK;
    snprintf(path, sizeof path, "%s/%s.h5", c->directory, name);
    compare_interval(c, COMPARE_EXACT, &start_ns, &stop_ns);
    const tides_event_file facts = {.width = s->intrinsics.width,
                                    .height = s->intrinsics.height,
                                    .run = s->values.json,
                                    .seed = s->values.seed,
                                    .start_ns = start_ns,
                                    .stop_ns = stop_ns - 1};
    tides_status status = tides_event_writer_open(path, NULL, &facts, &writer, error);
    if (status == TIDES_OK) status = tides_event_writer_append(writer, events, NULL, count, error);
    if (status == TIDES_OK) return tides_event_writer_finish(writer, stop_ns - 1, error);
    tides_event_writer_abandon(writer);
    return status;
}

/* Runs the configured session, and measures it. */
static tides_status work(comparison *c, compare_row *row, tides_session *session, tides_error *error) {
    tides_session_facts facts;
    tides_session_get(session, &facts);
    tides_status status =
        tides_session_run(session, cli_keep, &row->stream, cli_progress_step, &c->progress, &row->stats, error);
    cli_progress_end(&c->progress);
    if (status == TIDES_OK) status = compare_score(c, row, error);
    cli_progress_end(&c->progress);
    return status == TIDES_OK ? compare_keep_events(c, row->name, &facts, row->stream.events, row->stream.count, error)
                              : status;
}

/* Notes a tolerance that the run chose for itself. */
static tides_status tell_tolerance(compare_row *row, tides_error *error) {
    static const char key[] = "stepping.tolerance";
    if (!cJSON_IsNull(cJSON_GetObjectItemCaseSensitive(row->parameters, key))) return TIDES_OK;
    cJSON *used = cJSON_CreateNumber(row->stats.tolerance);
    if (used && cJSON_ReplaceItemInObjectCaseSensitive(row->parameters, key, used)) return TIDES_OK;
    cJSON_Delete(used);
    return cli_error(error, TIDES_NO_MEMORY, "out of memory: settings of %s", row->name);
}

tides_status compare_run(comparison *c, compare_row *row, tides_error *error) {
    tides_session *session = NULL;
    c->progress.label = row->name;
    row->error = (tides_error){TIDES_OK, ""};
    tides_status status = compare_configure(c, row->name, compare_ideal(c), &row->found, row, &session, &row->error);
    if (status == TIDES_OK) status = work(c, row, session, &row->error);
    if (status == TIDES_OK) status = tell_tolerance(row, &row->error);
    tides_session_close(session);
    row->error.status = status;
    if (status == TIDES_CANCELLED) *error = row->error;
    return status == TIDES_CANCELLED ? status : TIDES_OK;
}

void compare_row_free(compare_row *row) {
    cJSON_Delete(row->settings);
    cJSON_Delete(row->parameters);
    for (int32_t i = 0; i < COMPARE_REFERENCES; i++) cJSON_Delete(row->against[i]);
    free(row->stream.events);
}
