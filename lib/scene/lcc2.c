/* LCC2 scenes (XGRIDS): a .lcc2 is JSON that names files of Gaussians in its folder or below, all of them .sog, .spz or .ply:
 *
 *     {"version": "0.0.3", "totalLevels": 2, "splatType": ".sog", "root": {"splatFiles": ["data/3dgs/0.sog", ..],
 *      "data": {"env": {"name": 3}},
 *      "child": {"0": {"data": {"3dgs": {"name": 0, "start": 0, "count": 600}}, "child": ..}, ..}}}
 *
 * A node is a region of space. Its "3dgs" is the run of its Gaussians in the file of that number, and its children together are
 * the same region in finer detail. A node at depth d, the root's children being at 1, has level of detail totalLevels - d, and
 * 0 is the finest. The last node of a branch that ends earlier stands for its region at all finer levels. Several nodes of one
 * level may share a file. "env" names the file of the environment, which is read with every level. "child" is an object or an
 * array. Early files have other names: lod_level, child_num, and "files" without their ending. Some exporters leave commas
 * before } and ].
 *
 * Axes are LCC's: z is up. The numbers of a .spz are in these axes, too, and not in those of its own format. */
#include "td_base.h"
#include "td_folder.h"
#include "td_levels.h"
#include "td_scene.h"
#include "td_splat.h"
#include "td_splat_json.h"

#include <stdlib.h>
#include <string.h>

enum { LEVELS_MAX = 64, WHOLE = -1 };

/* A node's Gaussians: rows `start` to `start` + `count` of a file; all of its rows where count is WHOLE. */
typedef struct run {
    int64_t file, start, count;
} run;

typedef struct lcc2 {
    const char *path;
    cJSON *meta;
    const cJSON *root, *names;
    const char *ending; /* of all files: ".sog" */
    td_levels levels;
    int64_t files, environment; /* files: how many names; environment: its file; -1: none */
    run *runs;                  /* of the level that is read, by file and start */
    size_t count, capacity;
    tides_error *error;
} lcc2;

static const cJSON *item_of(const cJSON *object, const char *key, const char *early) {
    const cJSON *found = cJSON_GetObjectItemCaseSensitive(object, key);
    return found ? found : cJSON_GetObjectItemCaseSensitive(object, early);
}

/* -- the .lcc2 -- */

/* Overwrites with a blank each comma that is followed by } or ], perhaps after white space. JSON doesn't allow such commas. */
static void blank_commas(char *text) {
    int within = 0;
    for (char *c = text; *c; c++) {
        if (within && *c == '\\' && c[1]) {
            c++;
            continue;
        }
        if (*c == '"') within = !within;
        if (within || *c != ',') continue;
        const char *next = c + 1 + strspn(c + 1, " \t\r\n");
        if (*next == '}' || *next == ']') *c = ' ';
    }
}

/* The name of file `i` relative to the .lcc2, allocated; NULL: out of memory. */
static char *name_of(const lcc2 *l, int64_t i) {
    const char *name = cJSON_GetArrayItem(l->names, (int)i)->valuestring;
    if (*name == '/') name++;
    return td_format(l->error, "%s%s", name, td_ends_in(name, l->ending) ? "" : l->ending);
}

static tides_status check_names(lcc2 *l) {
    const cJSON *name;
    if (!cJSON_IsArray(l->names))
        return td_fail(l->error, TIDES_BAD_FILE, "%s: is no LCC2 scene: its root has no splatFiles", l->path);
    cJSON_ArrayForEach(name, l->names) {
        const char *text = cJSON_GetStringValue(name);
        if (!text || !*text || !td_json_is_below(*text == '/' ? text + 1 : text))
            return td_fail(l->error, TIDES_BAD_FILE, "%s: splatFiles must name files beside it or in folders there", l->path);
        l->files++;
    }
    return TIDES_OK;
}

static tides_status read_meta(lcc2 *l) {
    char *text = NULL;
    size_t size = 0;
    tides_status status = td_read_file(l->path, SIZE_MAX - 1, &text, &size, l->error);
    if (!status) blank_commas(text);
    if (!status) status = td_splat_json(l->path, NULL, text, size, &l->meta, l->error);
    free(text);
    if (status) return status;
    const char *type = td_json_text(l->meta, "splatType");
    l->root = cJSON_GetObjectItemCaseSensitive(l->meta, "root");
    l->names = item_of(l->root, "splatFiles", "files");
    l->ending = type ? type : ".sog";
    if (strcmp(l->ending, ".sog") != 0 && strcmp(l->ending, ".spz") != 0 && strcmp(l->ending, ".ply") != 0)
        return td_fail(l->error, TIDES_UNSUPPORTED, "%s: its splatType is \"%.40s\": .sog, .spz and .ply are read", l->path,
                       l->ending);
    l->levels.count =
        td_json_whole(l->meta, cJSON_GetObjectItemCaseSensitive(l->meta, "totalLevels") ? "totalLevels" : "lod_level", 1,
                      LEVELS_MAX);
    if (l->levels.count < 0)
        return td_fail(l->error, TIDES_BAD_FILE, "%s: is no LCC2 scene: its totalLevels isn't a number from 1 to %d", l->path,
                       LEVELS_MAX);
    return check_names(l);
}

/* -- the tree -- */

static const cJSON *run_of(const cJSON *node) {
    return cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(node, "data"), "3dgs");
}

static int has_finer(const cJSON *node) {
    const cJSON *child;
    cJSON_ArrayForEach(child, cJSON_GetObjectItemCaseSensitive(node, "child")) {
        if (run_of(child)) return 1;
    }
    return 0;
}

static tides_status add_run(lcc2 *l, const cJSON *of) {
    const int64_t most = INT64_C(1) << 40; /* sums stay far below 2^63 */
    run made = {td_json_whole(of, "name", 0, l->files - 1), 0, WHOLE};
    const int counted = cJSON_GetObjectItemCaseSensitive(of, "count") != NULL;
    if (counted) made.count = td_json_whole(of, "count", 0, most);
    if (cJSON_GetObjectItemCaseSensitive(of, "start")) made.start = td_json_whole(of, "start", 0, counted ? most : 0);
    if (made.file < 0 || made.start < 0 || (counted && made.count < 0))
        return td_fail(l->error, TIDES_BAD_FILE, "%s: a node's 3dgs must have a name, a number in splatFiles, start and count",
                       l->path);
    if (made.file == l->environment || made.count == 0) return TIDES_OK;
    tides_status status = td_reserve((void **)&l->runs, &l->capacity, l->count + 1, sizeof *l->runs, l->error);
    if (!status) l->runs[l->count++] = made;
    return status;
}

/* Lists the runs of the level below a node at `depth`; cJSON bounds how deep that can be. */
static tides_status list_runs(lcc2 *l, const cJSON *node, int64_t depth) {
    const cJSON *child;
    tides_status status = TIDES_OK;
    cJSON_ArrayForEach(child, cJSON_GetObjectItemCaseSensitive(node, "child")) {
        const cJSON *of = run_of(child);
        const int64_t level = l->levels.count - depth - 1;
        if (of && level < 0)
            return td_fail(l->error, TIDES_BAD_FILE, "%s: its tree is deeper than its %lld levels of detail", l->path,
                           (long long)l->levels.count);
        if (of && (level == l->levels.level || (level > l->levels.level && !has_finer(child)))) status = add_run(l, of);
        if (!status) status = list_runs(l, child, depth + 1);
        if (status) return status;
    }
    return status;
}

static int by_place(const void *a, const void *b) {
    const run *x = a, *y = b;
    if (x->file != y->file) return x->file < y->file ? -1 : 1;
    return (x->start > y->start) - (x->start < y->start);
}

static tides_status lcc2_open(lcc2 *l, const char *path, const char *part, tides_error *error) {
    *l = (lcc2){.path = path, .environment = -1, .error = error};
    tides_status status = read_meta(l);
    if (!status) status = td_levels_choose(l->path, part, &l->levels, l->error);
    if (status) return status;
    const cJSON *environment = cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(l->root, "data"), "env");
    if (cJSON_IsObject(environment)) l->environment = td_json_whole(environment, "name", 0, l->files - 1);
    if (cJSON_IsObject(environment) && l->environment < 0)
        return td_fail(error, TIDES_BAD_FILE, "%s: env must have a name, a number in splatFiles", path);
    status = list_runs(l, l->root, 0);
    if (!status && l->count == 0)
        status = td_fail(error, TIDES_BAD_FILE, "%s: no node of its tree has Gaussians at level %lld", path,
                         (long long)l->levels.level);
    if (!status) qsort(l->runs, l->count, sizeof *l->runs, by_place);
    return status;
}

static void lcc2_close(lcc2 *l) {
    cJSON_Delete(l->meta);
    free(l->runs);
}

/* -- Gaussians -- */

static tides_status read_file(const lcc2 *l, int64_t index, td_gaussians *g) {
    char *name = name_of(l, index), *file = name ? td_beside(l->path, name, l->error) : NULL, *data = NULL;
    size_t size = 0;
    tides_status status = file ? td_read_file(file, SIZE_MAX - 1, &data, &size, l->error) : TIDES_NO_MEMORY;
    if (!status)
        status = (strcmp(l->ending, ".sog") == 0   ? td_sog_parse
                  : strcmp(l->ending, ".spz") == 0 ? td_spz_parse
                                                   : td_ply_parse)(file, data, size, g, l->error);
    free(data);
    free(file);
    free(name);
    return status;
}

/* Keeps of a file's Gaussians those of its `count` runs. */
static tides_status keep_runs(const lcc2 *l, const run *runs, size_t count, td_gaussians *g) {
    int64_t kept = 0, end = 0;
    for (size_t i = 0; i < count; i++) {
        const int whole = runs[i].count == WHOLE;
        if (whole && count == 1) return TIDES_OK;
        if (whole || runs[i].start < end || runs[i].start + runs[i].count > g->count) {
            char *name = name_of(l, runs[i].file);
            tides_status status =
                td_fail(l->error, TIDES_BAD_FILE, "%s: nodes share Gaussians of %.80s, or it has fewer than they say, %lld",
                        l->path, name ? name : "", (long long)g->count);
            free(name);
            return status;
        }
        end = runs[i].start + runs[i].count;
        for (int64_t row = runs[i].start; row < end; row++, kept++)
            if (row != kept) td_gaussians_move(g, (size_t)kept, (size_t)row);
    }
    g->count = kept;
    return TIDES_OK;
}

/* The runs of one file, from run `i` on. */
static size_t runs_of_file(const lcc2 *l, size_t i) {
    size_t count = 1;
    while (i + count < l->count && l->runs[i + count].file == l->runs[i].file) count++;
    return count;
}

/* `*found` becomes 1 if the environment's file exists. Some scenes name one and are published without it. */
static tides_status find_environment(const lcc2 *l, int *found) {
    *found = 0;
    if (l->environment < 0) return TIDES_OK;
    char *name = name_of(l, l->environment), *file = name ? td_beside(l->path, name, l->error) : NULL;
    if (file) *found = td_is_file(file);
    free(name);
    tides_status status = file ? TIDES_OK : TIDES_NO_MEMORY;
    free(file);
    return status;
}

static tides_status read_parts(const lcc2 *l, td_gaussians *parts, size_t *count) {
    tides_status status = TIDES_OK;
    for (size_t i = 0, runs; i < l->count && !status; i += runs) {
        runs = runs_of_file(l, i);
        status = read_file(l, l->runs[i].file, &parts[*count]);
        if (!status) status = keep_runs(l, l->runs + i, runs, &parts[(*count)++]);
    }
    int environment = 0;
    if (!status) status = find_environment(l, &environment);
    if (!status && environment) status = read_file(l, l->environment, &parts[*count]);
    *count += !status && environment;
    if (!status && l->environment >= 0 && !environment)
        status = td_note(&parts[0].notes, l->error, "its environment isn't there, and isn't read");
    return status;
}

/* z, which is up, becomes -y. td_spz_parse has turned by half a turn about x before. */
static tides_status turn(const lcc2 *l, td_gaussians *g) {
    static const double quarter[12] = {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0}, back[12] = {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0};
    memset(g->up, 0, sizeof g->up);
    g->up[1] = -1;
    return td_gaussians_place(g, strcmp(l->ending, ".spz") == 0 ? back : quarter, l->error);
}

static tides_status note(const lcc2 *l, td_gaussians *g) {
    const char *version = td_json_text(l->meta, "version");
    tides_status status = td_levels_note(&l->levels, &g->notes, l->error);
    if (!status && version && strncmp(version, "0.0.", 4) != 0)
        status = td_note(&g->notes, l->error, "its version is %.20s, and what is known is 0.0.3", version);
    return status;
}

int td_lcc2_is(const char *path) { return td_ends_in(path, ".lcc2"); }

tides_status td_lcc2_read(const char *path, const char *part, td_gaussians *gaussians, tides_error *error) {
    lcc2 l;
    td_gaussians made = {0};
    size_t count = 0;
    tides_status status = lcc2_open(&l, path, part, error);
    td_gaussians *parts = status ? NULL : td_alloc(l.count + 1, sizeof *parts, error);
    if (!status && !parts) status = TIDES_NO_MEMORY;
    if (!status) status = read_parts(&l, parts, &count);
    if (!status) status = td_gaussians_join(parts, count, &made, error);
    if (!status) status = turn(&l, &made);
    if (!status) status = note(&l, &made);
    for (size_t i = 0; i < count; i++) td_gaussians_free(&parts[i]);
    free(parts);
    lcc2_close(&l);
    if (status)
        td_gaussians_free(&made);
    else
        *gaussians = made;
    return status;
}

static tides_status add_file(const lcc2 *l, int64_t index, const char *folder, td_folder *files) {
    char *name = name_of(l, index);
    tides_status status = name ? td_folder_add(files, folder, name, l->error) : TIDES_NO_MEMORY;
    free(name);
    return status;
}

tides_status td_lcc2_files(const char *path, const char *part, td_folder *files, tides_error *error) {
    lcc2 l;
    int environment = 0;
    tides_status status = lcc2_open(&l, path, part, error);
    char *folder = status ? NULL : td_folder_of(path, error);
    if (!status && !folder) status = TIDES_NO_MEMORY;
    for (size_t i = 0; i < l.count && !status; i += runs_of_file(&l, i)) status = add_file(&l, l.runs[i].file, folder, files);
    if (!status) status = find_environment(&l, &environment);
    if (!status && environment) status = add_file(&l, l.environment, folder, files);
    free(folder);
    lcc2_close(&l);
    return status;
}
