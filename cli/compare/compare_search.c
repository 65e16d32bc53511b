/* Finds each method's best parameters. They are varied one at a time, by factors, while that brings the stream closer to the
 * recording by the Victor-Purpura fraction. This score ranks streams correctly under every known degradation. All methods,
 * TIDES too, have the same number of runs. Parameters that are 0 aren't varied. */
#include "compare.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The first factor; after a round without success its root is used. */
#define FIRST_FACTOR 1.3
#define LEAST_FACTOR 1.01

typedef struct search {
    comparison *c;
    compare_row *row;
    const char *const *keys;
    double values[COMPARE_SEARCHED];
    int32_t count, runs;
    double best;
} search;

static void write_found(search *s, const double *values) {
    s->row->found.count = 0;
    for (int32_t i = 0; i < s->count; i++) {
        snprintf(s->row->found_texts[i], COMPARE_SETTING, "%s=%.6g", s->keys[i], values[i]);
        s->row->found.items[s->row->found.count++] = s->row->found_texts[i];
    }
}

/* The score for some values of the parameters; infinite where the method refuses them. */
static tides_status attempt(search *s, const double *values, double *score, tides_error *error) {
    comparison *c = s->c;
    cli_stream kept = {.events = NULL};
    tides_metrics metrics;
    const compare_pair pair = {c->recording.events, c->recording.count, &kept, COMPARE_RECORDING, TIDES_METRIC_VICTOR_PURPURA};
    *score = INFINITY;
    write_found(s, values);
    tides_status status = compare_run_fair(c, s->row, &s->row->found, &kept, error);
    if (status == TIDES_OK) status = compare_measure(c, &pair, &metrics, error);
    if (status == TIDES_OK) *score = metrics.victor_purpura_fraction;
    free(kept.events);
    s->runs++;
    cli_progress_end(&c->progress);
    cli_note(c->common, "%s: run %d of %d: %s %.5g ...: %.4f, best %.4f", s->row->name, s->runs, c->search, s->keys[0],
             values[0], *score, fmin(*score, s->best));
    return status == TIDES_CANCELLED || status == TIDES_NO_MEMORY ? status : TIDES_OK;
}

/* The method's initial values. */
static tides_status begin(search *s, tides_error *error) {
    tides_session *session = NULL;
    tides_session_facts facts;
    tides_status status = compare_configure(s->c, s->row->name, compare_ideal(s->c), NULL, NULL, &session, error);
    if (status != TIDES_OK) return status;
    tides_session_get(session, &facts);
    cJSON *run = cJSON_Parse(facts.values.json);
    for (; s->keys[s->count]; s->count++) {
        const cJSON *value = compare_find(run, s->keys[s->count]);
        s->values[s->count] = cJSON_IsNumber(value) ? value->valuedouble : 0;
    }
    cJSON_Delete(run);
    tides_session_close(session);
    return attempt(s, s->values, &s->best, error);
}

/* Tries a parameter multiplied, then divided, by the factor. *better is 1 where that helped. */
static tides_status move(search *s, int32_t which, double factor, int32_t *better, tides_error *error) {
    tides_status status = TIDES_OK;
    for (int32_t way = 0; way < 2 && s->runs < s->c->search && status == TIDES_OK; way++) {
        double values[COMPARE_SEARCHED], score;
        memcpy(values, s->values, sizeof values);
        values[which] *= way ? 1 / factor : factor;
        status = attempt(s, values, &score, error);
        if (status != TIDES_OK || !(score < s->best)) continue;
        memcpy(s->values, values, sizeof values);
        s->best = score;
        *better = 1;
        return TIDES_OK;
    }
    return status;
}

tides_status compare_search(comparison *c, compare_row *row, tides_error *error) {
    search s = {.c = c, .row = row, .keys = compare_searched(row->name), .best = INFINITY};
    if (c->search == 0) return TIDES_OK;
    c->progress.label = row->name;
    tides_status status = begin(&s, error);
    for (double factor = FIRST_FACTOR; s.runs < c->search && factor > LEAST_FACTOR && status == TIDES_OK;) {
        int32_t better = 0;
        for (int32_t i = 0; i < s.count && status == TIDES_OK; i++)
            if (s.values[i] > 0) status = move(&s, i, factor, &better, error);
        if (!better) factor = sqrt(factor);
    }
    if (status == TIDES_OK && isfinite(s.best)) write_found(&s, s.values);
    return status;
}
