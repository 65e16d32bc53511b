/* Internal: declarations shared by the pickle's stack machine, the functions that it may call, and the archive around it. */
#ifndef TD_PICKLE_PARTS_H
#define TD_PICKLE_PARTS_H

#include "archive/td_tree.h"
#include "archive/td_zip.h"

/* Values that exist only while a pickle is read; td_tree_check refuses them in a finished tree. */
enum { TD_PICKLE_GLOBAL = TD_VALUE_TENSOR + 1, TD_PICKLE_STORAGE, TD_PICKLE_DTYPE };

/* A storage in the archive, with the element type that the pickle gives it. */
typedef struct td_storage {
    int dtype;
    int64_t count; /* elements */
    const unsigned char *data;
} td_storage;

typedef struct td_torch td_torch;
typedef struct td_pickle td_pickle;

/* Makes the value for a persistent id. torch.save's ids are ('storage', type, key, location, elements). */
typedef tides_status (*td_persistent)(td_pickle *pickle, const td_value *id, td_value **made);

struct td_pickle {
    const char *path;
    const unsigned char *bytes;
    size_t size, at;
    td_tree *tree;
    td_torch *torch; /* the archive: source of storages */
    td_persistent persistent;
    td_value **stack; /* NULL: a mark */
    size_t depth, stack_capacity;
    td_value **memo;
    size_t memo_count;
    tides_error *error;
};

/* Runs the instructions; `*root` is the value left on the stack. The caller checks the tree. */
tides_status td_pickle_run(td_pickle *pickle, td_value **root);

/* Do the instructions that import a name, call it, and set an object's state. `*made` is set on success. */
tides_status td_pickle_global(td_pickle *pickle, const char *module, size_t module_length, const char *name, size_t name_length,
                              td_value **made);
tides_status td_pickle_call(td_pickle *pickle, const td_value *callee, const td_value *arguments, td_value **made);
tides_status td_pickle_build(td_pickle *pickle, const td_value *object, const td_value *state);

/* The dtype of a storage's type such as torch.FloatStorage; -1 if `value` is no such type. */
int td_pickle_storage_dtype(const td_value *value);

#endif
