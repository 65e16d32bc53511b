/* Any bytes as a torch file and as a bare pickle: a tree that can be walked, its tensors copied, or a refusal in one line. */
#include "fuzz.h"

#include "archive/td_pickle.h"
#include "archive/td_pickle_parts.h"

/* Shared values make walks of a small tree long: so many are enough. */
enum { STEPS = 10000 };

static void walk(const td_value *value, int depth, int *steps) {
    if (depth > 200 || value->kind < TD_VALUE_NONE || value->kind > TD_VALUE_TENSOR) abort();
    if (++*steps > STEPS) return;
    size_t items = value->kind == TD_VALUE_DICT                                    ? 2 * value->count
                   : value->kind == TD_VALUE_LIST || value->kind == TD_VALUE_TUPLE ? value->count
                                                                                   : 0;
    for (size_t i = 0; i < items; i++) walk(value->as.items[i], depth + 1, steps);
    if (value->kind == TD_VALUE_TEXT && value->as.text[value->count]) abort();
    if (value->kind != TD_VALUE_TENSOR) return;
    float *copied = NULL;
    if (td_tensor_floats(value->as.tensor, &copied, NULL) != TIDES_OK) abort();
    free(copied);
}

static void check(tides_status status, const tides_error *error, td_tree *tree) {
    int steps = 0;
    if (status == TIDES_OK) {
        walk(td_tree_root(tree), 0, &steps);
        td_tree_free(tree);
        return;
    }
    fuzz_refusal(status, error);
    if (tree) abort();
}

static tides_status no_storage(td_pickle *pickle, const td_value *id, td_value **made) {
    (void)id, (void)made;
    return td_fail(pickle->error, TIDES_BAD_FILE, "a bare pickle has no storages");
}

/* As a torch file's pickle is run, without the archive around it. */
static tides_status run_bare(const uint8_t *data, size_t size, td_tree **tree, tides_error *error) {
    td_pickle pickle = {.path = "fuzz", .bytes = data, .size = size, .tree = td_tree_create(error), .error = error};
    pickle.persistent = no_storage;
    td_value *root = NULL;
    if (!pickle.tree) return TIDES_NO_MEMORY;
    tides_status status = td_pickle_run(&pickle, &root);
    if (!status) status = td_tree_check("fuzz", root, error);
    if (status) {
        td_tree_free(pickle.tree);
        return status;
    }
    td_tree_set_root(pickle.tree, root);
    *tree = pickle.tree;
    return TIDES_OK;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    td_tree *tree = NULL;
    tides_error error = {0, ""};
    tides_status status = td_torch_parse("fuzz", data, size, &tree, &error);
    check(status, &error, tree);
    tree = NULL;
    status = run_bare(data, size, &tree, &error);
    check(status, &error, tree);
    return 0;
}
