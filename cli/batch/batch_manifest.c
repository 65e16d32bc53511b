/* Reads the manifest of a batch: a base run, a grid over its keys, random draws, a list of runs, or several of these. Makes
 * its runs, and names them. */
#include "batch.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* RUNS_MAX: a folder with more runs isn't usable, so a larger grid is taken for a mistake. NAME_MAX_LENGTH [bytes]: of a run's
 * name, which is its folder's too; file systems allow 255. */
enum { RUNS_MAX = 100000, NAME_MAX_LENGTH = 120 };

static tides_status wrong(const batch *b, tides_error *error, const char *what, const char *name) {
    return cli_error(error, TIDES_BAD_CONFIG, "%s: %.200s %s", b->manifest, name, what);
}

/* Parts that all runs share: the manifest's "set", and the object with "command" and "options". */
typedef struct shared {
    const cJSON *set, *how;
} shared;

static void free_run(batch_run *run) {
    for (size_t i = 0; run->sets && i < run->count; i++) free(run->sets[i]);
    free(run->sets);
    free(run->seed);
    free(run->name);
    free(run->file);
    free(run->layouts);
    for (size_t i = 0; run->option && i < run->options; i++) free(run->option[i]);
    free(run->option);
    free(run->command);
    free(run->directory);
    free(run->error);
}

void batch_free(batch *b) {
    for (size_t i = 0; i < b->count; i++) free_run(&b->runs[i]);
    free(b->runs);
    b->runs = NULL;
    b->count = b->capacity = 0;
}

/* The path of `name`, which is relative to the manifest's folder. */
static char *beside(const batch *b, const char *name) {
    const char *slash = strrchr(b->manifest, '/');
    if (name[0] == '/' || !slash) return batch_text("%s", name);
    return batch_text("%.*s%s", (int)(slash - b->manifest + 1), b->manifest, name);
}

static char *assignment(const cJSON *item, const cJSON *value) {
    char *text = cJSON_PrintUnformatted(value), *made = text ? batch_text("%s=%s", item->string, text) : NULL;
    cJSON_free(text);
    return made;
}

/* The assignments of one run: the manifest's "set", then the grid's values (indices[i] of the i-th key) or the run's own. */
static tides_status add_sets(batch_run *run, const cJSON *common, const cJSON *own, const int *indices, tides_error *error) {
    const size_t wanted = (size_t)cJSON_GetArraySize(common) + (size_t)cJSON_GetArraySize(own);
    run->sets = calloc(wanted + 2, sizeof *run->sets); /* for a drawn run's seed and the NULL */
    if (!run->sets) return batch_no_memory(error);
    for (const cJSON *item = common ? common->child : NULL; item; item = item->next)
        if (!(run->sets[run->count++] = assignment(item, item))) return batch_no_memory(error);
    for (const cJSON *item = own ? own->child : NULL; item; item = item->next) {
        const cJSON *value = indices ? cJSON_GetArrayItem(item, *indices++) : item;
        if (!(run->sets[run->count++] = assignment(item, value))) return batch_no_memory(error);
    }
    return TIDES_OK;
}

/* A run's name, "sensor.threshold_on=0.1,seed=2", made of the keys that it sets, so that names stay when a grid grows.
 * Characters that can't be in a file's name become '-', and '_' at the beginning. '.' and '-' at the beginning become '_', too:
 * they would make a hidden folder, or an option. A hash is added where a character was replaced, or the name was cut. The last
 * 20 bytes of NAME_MAX_LENGTH are left for the hash, which takes 9. */
static char *grid_name(const batch_run *run, size_t first) {
    char name[NAME_MAX_LENGTH + 1];
    size_t used = 0;
    int32_t lost = 0;
    const uint64_t hash = tides_fingerprint_text((const char *const *)&run->sets[first], run->count - first);
    for (size_t i = first; i < run->count; i++) {
        for (const char *at = run->sets[i]; at[0]; at++) {
            if (*at == '"') continue;
            const int32_t plain = isalnum((unsigned char)*at) || strchr(used ? "._=+-" : "_=+", *at);
            lost |= !plain || used >= NAME_MAX_LENGTH - 20;
            if (used >= NAME_MAX_LENGTH - 20) continue;
            name[used] = plain ? *at : used ? '-' : '_';
            used++;
        }
        if (i + 1 < run->count && used < NAME_MAX_LENGTH - 20) name[used++] = ',';
    }
    name[used] = '\0';
    if (used == 0) return batch_text("run");
    return lost ? batch_text("%s~%08x", name, (unsigned)(hash ^ hash >> 32)) : batch_text("%s", name);
}

static int32_t is_name(const char *name) {
    const size_t length = strlen(name);
    if (length == 0 || length > NAME_MAX_LENGTH || name[0] == '.' || name[0] == '-') return 0;
    for (; *name; name++)
        if (!isalnum((unsigned char)*name) && !strchr("._=,+-~", *name)) return 0;
    return 1;
}

/* Makes room for a run, zeroed. It counts at once, so that batch_free frees it even if it stays incomplete. */
static batch_run *next_run(batch *b, tides_error *error) {
    if (b->count == RUNS_MAX) {
        cli_error(error, TIDES_BAD_CONFIG, "%s: over %d runs; split the manifest", b->manifest, RUNS_MAX);
        return NULL;
    }
    if (b->count == b->capacity) {
        const size_t capacity = b->capacity ? 2 * b->capacity : 64;
        batch_run *runs = realloc(b->runs, capacity * sizeof *runs);
        if (!runs) {
            batch_no_memory(error);
            return NULL;
        }
        b->runs = runs;
        b->capacity = capacity;
    }
    batch_run *run = &b->runs[b->count++];
    memset(run, 0, sizeof *run);
    return run;
}

/* Adds a run's command, from its own entry or the manifest's: "command" and "options". */
static tides_status add_command(const batch *b, batch_run *run, const cJSON *from, tides_error *error) {
    const cJSON *command = cJSON_GetObjectItemCaseSensitive(from, "command"), *option = NULL;
    const cJSON *options = cJSON_GetObjectItemCaseSensitive(from, "options");
    if (options && !command) return wrong(b, error, "are given without a command", "options");
    if (!command || strcmp(command->valuestring, "simulate") == 0)
        return options ? wrong(b, error, "takes no options here; set keys", "simulate") : TIDES_OK;
    run->command = batch_text("%s", command->valuestring);
    run->option = calloc((size_t)cJSON_GetArraySize(options) + 1, sizeof *run->option);
    if (!run->command || !run->option) return batch_no_memory(error);
    cJSON_ArrayForEach(option, options) {
        if (!cJSON_IsString(option)) return wrong(b, error, "holds something else than texts", "options");
        const tides_status status = batch_check_option(b, option, error);
        if (status != TIDES_OK) return status;
        if (!(run->option[run->options++] = batch_text("%s", option->valuestring))) return batch_no_memory(error);
    }
    return TIDES_OK;
}

static tides_status add_run(batch *b, const char *name, const char *file, const shared *common, const cJSON *own,
                            const int *indices, tides_error *error) {
    batch_run *run = next_run(b, error);
    if (!run) return error->status;
    tides_status status = add_sets(run, common->set, own, indices, error);
    if (status == TIDES_OK) status = add_command(b, run, common->how, error);
    if (status != TIDES_OK) return status;
    run->name = name ? batch_text("%s", name) : grid_name(run, (size_t)cJSON_GetArraySize(common->set));
    run->file = beside(b, file);
    run->directory = run->name ? batch_text("%s/%s", b->directory, run->name) : NULL;
    return run->directory && run->file ? TIDES_OK : batch_no_memory(error);
}

/* Every combination; the last key varies fastest. */
static tides_status add_grid(batch *b, const char *base, const shared *common, const cJSON *grid, tides_error *error) {
    enum { KEYS = 32 };
    int at[KEYS] = {0}, sizes[KEYS], keys = 0;
    for (const cJSON *item = grid->child; item; item = item->next) {
        if (!cJSON_IsArray(item) || !item->child) return wrong(b, error, "is no list of values; write [ ... ]", item->string);
        if (keys == KEYS) return wrong(b, error, "holds over 32 keys", "grid");
        sizes[keys++] = cJSON_GetArraySize(item);
    }
    for (;;) {
        tides_status status = add_run(b, NULL, base, common, grid, at, error);
        if (status != TIDES_OK) return status;
        int key = keys - 1;
        while (key >= 0 && ++at[key] == sizes[key]) at[key--] = 0;
        if (key < 0) return TIDES_OK;
    }
}

static tides_status check_keys(const batch *b, const cJSON *object, const char *const *known, tides_error *error) {
    for (const cJSON *item = object->child; item; item = item->next) {
        const char *const *name = known;
        while (*name && strcmp(*name, item->string) != 0) name++;
        for (const cJSON *other = item->next; *name && other; other = other->next)
            if (strcmp(other->string, item->string) == 0) return wrong(b, error, "is given twice; keep one", item->string);
        if (*name) continue;
        const char *nearest = tides_nearest_name(item->string, known);
        return cli_error(error, TIDES_BAD_CONFIG, "%s: unknown key \"%.100s\"; did you mean \"%s\"?", b->manifest, item->string,
                         nearest ? nearest : known[0]);
    }
    return TIDES_OK;
}

/* A member of the given type, or NULL where there is none. A wrong type sets `status`. */
static const cJSON *member(const batch *b, const cJSON *object, const char *name, int type, tides_status *status,
                           tides_error *error) {
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    if (!item || (item->type & 0xff) == type || *status != TIDES_OK) return item;
    *status = wrong(b, error,
                    type == cJSON_String   ? "is not a text in quotes"
                    : type == cJSON_Number ? "is not a number"
                    : type == cJSON_Array  ? "is not a list [ ... ]"
                                           : "is not an object { \"key\": value, ... }",
                    name);
    return NULL;
}

/* Checks the types of "command" and "options" of an object, and that the command exists. */
static void check_command(const batch *b, const cJSON *object, tides_status *status, tides_error *error) {
    const cJSON *command = member(b, object, "command", cJSON_String, status, error);
    (void)member(b, object, "options", cJSON_Array, status, error);
    if (*status == TIDES_OK && command) *status = batch_check_command(b, command->valuestring, error);
}

static tides_status add_listed(batch *b, const cJSON *base, const shared *common, const cJSON *entry, tides_error *error) {
    static const char *const known[] = {"name", "file", "set", "command", "options", NULL};
    if (!cJSON_IsObject(entry)) return wrong(b, error, "holds something else than { \"name\": ..., \"set\": {...} }", "runs");
    tides_status status = check_keys(b, entry, known, error);
    const cJSON *name = member(b, entry, "name", cJSON_String, &status, error);
    const cJSON *file = member(b, entry, "file", cJSON_String, &status, error);
    const cJSON *set = member(b, entry, "set", cJSON_Object, &status, error);
    check_command(b, entry, &status, error);
    if (status != TIDES_OK) return status;
    const int32_t says = cJSON_HasObjectItem(entry, "command") || cJSON_HasObjectItem(entry, "options");
    const shared own = {common->set, says ? entry : common->how};
    if (!name) return wrong(b, error, "holds a run without a name", "runs");
    if (strncmp(name->valuestring, "summary", strlen("summary")) == 0 && strpbrk(name->valuestring, ".-"))
        return wrong(b, error, "is a name that the batch's own files have: call the run otherwise", name->valuestring);
    if (!is_name(name->valuestring))
        return wrong(b, error, "is no name for a folder: use letters, digits and ._=,+-", name->valuestring);
    if (!file) file = base;
    if (!file) return wrong(b, error, "names no file, and there is no base", name->valuestring);
    return add_run(b, name->valuestring, file->valuestring, &own, set, NULL, error);
}

static tides_status add_draw(batch *b, const cJSON *base, const shared *common, const cJSON *from, const char *seed, int index,
                             tides_error *error) {
    char name[32];
    snprintf(name, sizeof name, "draw-%05d", index);
    cJSON *drawn = batch_draw(from, seed, index);
    const tides_status status =
        drawn ? add_run(b, name, base->valuestring, common, drawn, NULL, error) : batch_no_memory(error);
    cJSON_Delete(drawn);
    if (status != TIDES_OK) return status;
    return (b->runs[b->count - 1].seed = batch_draw_seed(seed, index)) ? TIDES_OK : batch_no_memory(error);
}

static tides_status add_draws(batch *b, const cJSON *base, const shared *common, const cJSON *draw, tides_error *error) {
    static const char *const known[] = {"count", "seed", "set", NULL};
    tides_status status = check_keys(b, draw, known, error);
    const cJSON *count = member(b, draw, "count", cJSON_Number, &status, error);
    const cJSON *seed = member(b, draw, "seed", cJSON_String, &status, error);
    const cJSON *from = member(b, draw, "set", cJSON_Object, &status, error);
    if (status != TIDES_OK) return status;
    if (!base) return wrong(b, error, "is missing: the run file that is drawn for", "base");
    if (!from) return wrong(b, error, "has no set: the keys and what to draw them from", "draw");
    if (!count || !(count->valuedouble >= 1 && count->valuedouble <= RUNS_MAX) || count->valuedouble != count->valueint)
        return wrong(b, error, "needs a count of runs", "draw");
    status = batch_check_draws(b, from, error);
    for (int i = 0; status == TIDES_OK && i < count->valueint; i++)
        status = add_draw(b, base, common, from, seed ? seed->valuestring : "0", i, error);
    return status;
}

static tides_status add_all(batch *b, const cJSON *root, tides_error *error) {
    static const char *const known[] = {"base", "set", "grid", "runs", "draw", "command", "options", NULL};
    tides_status status = check_keys(b, root, known, error);
    const cJSON *base = member(b, root, "base", cJSON_String, &status, error);
    const shared all = {member(b, root, "set", cJSON_Object, &status, error), root}, *common = &all;
    check_command(b, root, &status, error);
    const cJSON *grid = member(b, root, "grid", cJSON_Object, &status, error);
    const cJSON *runs = member(b, root, "runs", cJSON_Array, &status, error);
    const cJSON *draw = member(b, root, "draw", cJSON_Object, &status, error);
    if (status == TIDES_OK && !grid && !runs && !draw)
        status = wrong(b, error, "and runs are missing: give one of them, or draw", "grid");
    if (status == TIDES_OK && grid && !base) status = wrong(b, error, "is missing: the run file that grid varies", "base");
    if (status == TIDES_OK && grid) status = add_grid(b, base->valuestring, common, grid, error);
    if (status == TIDES_OK && draw) status = add_draws(b, base, common, draw, error);
    for (const cJSON *entry = runs ? runs->child : NULL; status == TIDES_OK && entry; entry = entry->next)
        status = add_listed(b, base, common, entry, error);
    return status;
}

static int by_name(const void *a, const void *b) {
    return strcmp((*(const batch_run *const *)a)->name, (*(const batch_run *const *)b)->name);
}

static tides_status check_names(const batch *b, tides_error *error) {
    const batch_run **sorted = malloc((b->count + 1) * sizeof *sorted);
    if (!sorted) return batch_no_memory(error);
    for (size_t i = 0; i < b->count; i++) sorted[i] = &b->runs[i];
    qsort(sorted, b->count, sizeof *sorted, by_name);
    tides_status status = TIDES_OK;
    for (size_t i = 1; status == TIDES_OK && i < b->count; i++)
        if (strcmp(sorted[i - 1]->name, sorted[i]->name) == 0)
            status = wrong(b, error, "is the name of two runs; keep one", sorted[i]->name);
    free(sorted);
    return status;
}

static void keep_shard(batch *b) {
    size_t kept = 0;
    for (size_t i = 0; i < b->count; i++) {
        if ((int32_t)(i % (size_t)b->shards) == b->shard)
            b->runs[kept++] = b->runs[i];
        else
            free_run(&b->runs[i]);
    }
    b->count = kept;
}

static tides_status no_such_run(const batch *b, const char *name, tides_error *error) {
    const char **names = calloc(b->count + 1, sizeof *names);
    if (!names) return batch_no_memory(error);
    for (size_t i = 0; i < b->count; i++) names[i] = b->runs[i].name;
    const char *nearest = tides_nearest_name(name, names);
    cli_error(error, TIDES_BAD_CONFIG, "%s: no run is called \"%.200s\"%s%s%s; --summary --json names them all", b->manifest,
              name, nearest ? "; did you mean \"" : "", nearest ? nearest : "", nearest ? "\"?" : "");
    free(names);
    return error->status;
}

static int32_t is_meant(const batch *b, const batch_run *run) {
    for (size_t i = 0; i < b->only->count; i++)
        if (strcmp(b->only->items[i], run->name) == 0) return 1;
    return 0;
}

/* Keeps the runs named in b->only, in the manifest's order. */
static tides_status keep_meant(batch *b, tides_error *error) {
    if (b->only->count == 0) return TIDES_OK;
    for (size_t i = 0; i < b->only->count; i++) {
        size_t at = 0;
        while (at < b->count && strcmp(b->runs[at].name, b->only->items[i]) != 0) at++;
        if (at == b->count) return no_such_run(b, b->only->items[i], error);
    }
    size_t kept = 0;
    for (size_t i = 0; i < b->count; i++) {
        if (is_meant(b, &b->runs[i]))
            b->runs[kept++] = b->runs[i];
        else
            free_run(&b->runs[i]);
    }
    b->count = kept;
    return TIDES_OK;
}

tides_status batch_read(batch *b, tides_error *error) {
    struct stat found;
    if (stat(b->manifest, &found) != 0)
        return cli_error(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened; name the batch's manifest", b->manifest);
    cJSON *root = batch_read_json(b->manifest);
    if (!root && tides_file_foreign(b->manifest, error) != TIDES_OK) return error->status;
    tides_status status = cJSON_IsObject(root) ? add_all(b, root, error)
                                               : cli_error(error, TIDES_BAD_CONFIG,
                                                           "%s: is not one JSON object { ... }; look "
                                                           "for a comma, quote or brace too many or too few",
                                                           b->manifest);
    cJSON_Delete(root);
    if (status == TIDES_OK) status = check_names(b, error);
    if (status == TIDES_OK) status = keep_meant(b, error);
    if (status == TIDES_OK) keep_shard(b);
    return status;
}
