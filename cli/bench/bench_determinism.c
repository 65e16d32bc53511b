/* `tides bench determinism`: runs of the demo's world, each made in ways that must give the same events: threads, PoCL's
 * methods, scalar C, sizes of launches, cut in pieces, saved and restored, through a file, killed and resumed. Each run gets
 * one SHA-256, or the list of ways that differ. The output has a line "HASH  RUN" for each, by which builds and languages can
 * be compared. */
#include "bench_determinism.h"
#include "demo.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* [s] A way takes seconds, plus a minute or two where kernels are built for another PoCL method. */
#define LIMIT_S 900.0

typedef struct row {
    const determinism_run *run;
    const determinism_way *way;
    determinism_result result;
    int32_t pass, reserved;
    char why[512]; /* why it fails; "" if it passes */
} row;

typedef struct sheet {
    row *rows;
    size_t count;
    char file[4400]; /* path of the run file */
} sheet;

/* -- rows ------------------------------------------------------------------------------------------------------------------ */

static int32_t is_made(const bench *b, const determinism_run *run, const determinism_way *way) {
    const int32_t cut = way->how == DETERMINISM_PIECES || way->how == DETERMINISM_SAVED || way->how == DETERMINISM_KILLED;
    if (way->pocl && !strstr(b->info.platform, "Portable Computing Language")) return 0;
    if (b->quick && !way->quick) return 0;
    return !run->frames || !cut;
}

/* Judges a row. `first`: the row whose hash this one must have. */
static void judge(row *r, const row *first) {
    const determinism_result *m = &r->result;
    if (m->how == BENCH_LATE)
        snprintf(r->why, sizeof r->why, "no end within %.0f s", m->elapsed_s);
    else if (m->how == BENCH_DIED)
        bench_say_death(m->died, r->why);
    else if (m->how != BENCH_RAN)
        snprintf(r->why, sizeof r->why, "%.400s", m->said);
    else if (r->way->units && r->way->units != m->units)
        snprintf(r->why, sizeof r->why, "has %d compute units, not %d", (int)m->units, (int)r->way->units);
    else if (m->events == 0)
        snprintf(r->why, sizeof r->why, "without events there is nothing to compare");
    else if (strcmp(m->hash, first->result.hash) != 0)
        snprintf(r->why, sizeof r->why, "other events than %s: %llu for %llu", first->way->name, (unsigned long long)m->events,
                 (unsigned long long)first->result.events);
    else if (r->way->how == DETERMINISM_KILLED && m->cuts == 0)
        snprintf(r->why, sizeof r->why, "was never killed: it ends too soon");
    r->pass = !r->why[0];
}

static void work(void *user, void *result) { determinism_make(user, result); }

/* The least time of a way so far, since the first may have built kernels. */
static double usual_time(const row *first, const row *end) {
    double usual = first->result.elapsed_s;
    for (const row *r = first; r < end; r++) usual = fmin(usual, r->result.elapsed_s);
    return usual;
}

static tides_status make_row(bench *b, sheet *s, const row *first, row *r, tides_error *error) {
    determinism_job job = {b, s->file, r->run, r->way, usual_time(first, r)};
    bench_ending ending;
    const double began = cli_now();
    tides_status status = bench_child(b, work, &job, &r->result, sizeof r->result, LIMIT_S, &ending, error);
    if (status != TIDES_OK) return status;
    if (ending.how == BENCH_STOPPED) return TIDES_CANCELLED;
    if (ending.how != BENCH_RAN)
        r->result = (determinism_result){.how = ending.how, .died = ending.died, .elapsed_s = cli_now() - began};
    judge(r, first);
    b->failed += !r->pass;
    bench_say(b, "%s  %-14s %-14s %.16s  %7llu events %6.2f s%s%s", r->pass ? "same" : "FAIL", r->run->name, r->way->name,
              r->result.hash, (unsigned long long)r->result.events, r->result.elapsed_s, r->why[0] ? "  " : "", r->why);
    return TIDES_OK;
}

static tides_status make_run(bench *b, sheet *s, const determinism_run *run, tides_error *error) {
    const size_t first = s->count;
    tides_status status = TIDES_OK;
    for (const determinism_way *way = determinism_ways; way->name && status == TIDES_OK; way++) {
        if (!is_made(b, run, way)) continue;
        row *r = &s->rows[s->count++];
        r->run = run;
        r->way = way;
        status = make_row(b, s, &s->rows[first], r, error);
    }
    return status;
}

static tides_status make_runs(bench *b, sheet *s, const cli_list *names, tides_error *error) {
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < names->count && status == TIDES_OK; i++)
        status = make_run(b, s, determinism_find(names->items[i]), error);
    for (const determinism_run *run = determinism_runs; !names->count && run->name && status == TIDES_OK; run++)
        status = make_run(b, s, run, error);
    return status;
}

/* -- results --------------------------------------------------------------------------------------------------------------- */

/* The keys of a run, separated by spaces, as for `tides simulate run.json --set ...`. */
static const char *settings_of(const bench *b, const determinism_run *run) {
    static char text[2048];
    size_t used = 0;
    cli_list sets = {.count = 0};
    determinism_take(b, run, &sets);
    for (size_t i = 0; i < sets.count && used < sizeof text; i++)
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%s", i ? " " : "", sets.items[i]);
    return text;
}

static int32_t add_runs(const bench *b, cJSON *header, const sheet *s) {
    cJSON *runs = cJSON_AddArrayToObject(header, "runs");
    int32_t ok = runs != NULL;
    cJSON_DeleteItemFromObject(header, "scenes");
    for (size_t i = 0; i < s->count && ok; i++) {
        if (i > 0 && s->rows[i].run == s->rows[i - 1].run) continue;
        cJSON *json = cJSON_CreateObject();
        ok = cJSON_AddItemToArray(runs, json) && cJSON_AddStringToObject(json, "run", s->rows[i].run->name) &&
             cJSON_AddStringToObject(json, "what", s->rows[i].run->sentence) &&
             cJSON_AddStringToObject(json, "settings", settings_of(b, s->rows[i].run)) &&
             cJSON_AddStringToObject(json, "sha256", s->rows[i].result.hash);
    }
    return ok;
}

static int32_t cells_of(const void *rows, size_t index, bench_cell cells[BENCH_CELLS_MAX]) {
    const row *r = (const row *)rows + index;
    const bench_cell made[] = {
        {"run", r->run->name, 0},
        {"way", r->way->name, 0},
        {"what", r->way->sentence, 0},
        {"verdict", r->pass ? "same" : "FAIL", 0},
        {"why", r->why, 0},
        {"sha256", r->result.hash, 0},
        {"events", NULL, (double)r->result.events},
        {"cuts", NULL, r->result.cuts},
        {"elapsed_s", NULL, r->result.elapsed_s},
    };
    memcpy(cells, made, sizeof made);
    return sizeof made / sizeof made[0];
}

static tides_status write_results(bench *b, const sheet *s, tides_error *error) {
    const bench_table table = {s->rows, s->count, cells_of};
    cJSON *header = bench_header(b, "determinism");
    tides_status status =
        header && add_runs(b, header, s) ? TIDES_OK : cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    if (status == TIDES_OK) status = bench_write_table(b, "determinism", header, &table, error);
    cJSON_Delete(header);
    return status;
}

/* Prints a line for each run: its hash, or the differences. */
static void print_summary(const bench *b, const sheet *s) {
    if (b->common->quiet || b->common->json) return;
    for (size_t i = 0, next; i < s->count; i = next) {
        int32_t differ = 0;
        for (next = i; next < s->count && s->rows[next].run == s->rows[i].run; next++) differ += !s->rows[next].pass;
        if (!differ) printf("%s  %s\n", s->rows[i].result.hash, s->rows[i].run->name);
        for (size_t k = i; k < next && differ; k++)
            if (!s->rows[k].pass) printf("FAIL  %s, %s: %s\n", s->rows[k].run->name, s->rows[k].way->name, s->rows[k].why);
    }
}

tides_status bench_determinism(bench *b, const cli_list *names, tides_error *error) {
    const size_t most = (names->count ? names->count : determinism_count()) * (size_t)DETERMINISM_WAYS_MAX;
    sheet *s = calloc(1, sizeof *s);
    if (s) s->rows = calloc(most, sizeof *s->rows);
    tides_status status = s && s->rows ? TIDES_OK : cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    if (status == TIDES_OK) status = bench_ask_device(b, error);
    if (status == TIDES_OK) status = bench_path(b, "run", ".json", s->file, sizeof s->file, error);
    if (status == TIDES_OK) status = demo_scene_write(b->directory, error);
    if (status == TIDES_OK) status = make_runs(b, s, names, error);
    if (status == TIDES_OK) status = write_results(b, s, error);
    if (status == TIDES_OK) print_summary(b, s);
    if (s) free(s->rows);
    free(s);
    return status;
}
