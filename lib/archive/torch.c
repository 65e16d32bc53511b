/* Opens the ZIP archive of torch.save: STEM/data.pkl is the pickle, and STEM/data/KEY is the data of storage KEY. */
#include "archive/td_pickle.h"
#include "archive/td_pickle_parts.h"
#include "td_base.h"

#include <stdlib.h>
#include <string.h>

/* The bytes of a member of the archive; NULL until it is read. */
typedef struct payload {
    const unsigned char *data;
} payload;

struct td_torch {
    td_zip zip;
    size_t stem; /* length of "STEM/" in the name of data.pkl */
    const td_zip_member *pickle;
    payload *payloads; /* one per member of the archive */
};

static tides_status read_member(td_torch *torch, td_tree *tree, const td_zip_member *member, const unsigned char **data,
                                tides_error *error) {
    payload *kept = &torch->payloads[member - torch->zip.members];
    if (!kept->data) {
        void *owned = NULL;
        tides_status status = td_zip_read(&torch->zip, member, &kept->data, &owned, error);
        if (!status && (status = td_tree_adopt(tree, owned, error))) free(owned);
        if (status) {
            kept->data = NULL;
            return status;
        }
    }
    *data = kept->data;
    return TIDES_OK;
}

/* Finds STEM/FOLDER/NAME; `*member` is NULL if there is none. */
static tides_status find_member(const td_torch *torch, const char *folder, const char *name, const td_zip_member **member,
                                tides_error *error) {
    char *full = td_format(error, "%.*s%s%s", (int)torch->stem, torch->pickle->name, folder, name);
    if (!full) return TIDES_NO_MEMORY;
    *member = td_zip_find(&torch->zip, full);
    free(full);
    return TIDES_OK;
}

static tides_status find_storage(td_pickle *pickle, const td_value *id, td_value **made) {
    const char *word = td_value_text(td_value_item(id, 0)), *key = td_value_text(td_value_item(id, 2));
    int dtype = td_pickle_storage_dtype(td_value_item(id, 1));
    int64_t count = 0;
    if (!word || strcmp(word, "storage") != 0 || dtype < 0 || !key || !td_value_integer(td_value_item(id, 4), &count) ||
        count < 0)
        return td_fail(pickle->error, TIDES_BAD_FILE,
                       "%s: the pickle is damaged before byte %zu: it refers to something that "
                       "isn't a storage",
                       pickle->path, pickle->at);
    const td_zip_member *member = NULL;
    tides_status status = find_member(pickle->torch, "data/", key, &member, pickle->error);
    if (status) return status;
    size_t width = td_tensor_width(dtype);
    if (!member) return td_fail(pickle->error, TIDES_BAD_FILE, "%s: storage %.40s isn't in the archive", pickle->path, key);
    if (member->size % width || (uint64_t)count != member->size / width)
        return td_fail(pickle->error, TIDES_BAD_FILE,
                       "%s: storage %.40s should hold %lld elements of %zu bytes, but has %zu bytes", pickle->path, key,
                       (long long)count, width, member->size);
    td_storage *storage = td_tree_alloc(pickle->tree, sizeof *storage, pickle->error);
    td_value *value = storage ? td_tree_value(pickle->tree, TD_PICKLE_STORAGE, pickle->error) : NULL;
    if (!value) return TIDES_NO_MEMORY;
    storage->dtype = dtype;
    storage->count = count;
    value->as.text = (char *)storage;
    status = read_member(pickle->torch, pickle->tree, member, &storage->data, pickle->error);
    if (!status) *made = value;
    return status;
}

/* Fails if the archive has a member STEM/byteorder (newer versions of torch write it) with another text than "little". */
static tides_status check_order(td_torch *torch, td_tree *tree, tides_error *error) {
    const td_zip_member *member = NULL;
    const unsigned char *text = NULL;
    tides_status status = find_member(torch, "", "byteorder", &member, error);
    if (status || !member) return status;
    status = read_member(torch, tree, member, &text, error);
    if (status || (member->size == 6 && memcmp(text, "little", 6) == 0)) return status;
    return td_fail(error, TIDES_UNSUPPORTED, "%s: its byte order is '%.*s': only 'little' is read", torch->zip.path,
                   member->size > 16 ? 16 : (int)member->size, (const char *)text);
}

static tides_status find_pickle(td_torch *torch, tides_error *error) {
    static const char ending[] = "/data.pkl";
    for (size_t i = 0; i < torch->zip.count && !torch->pickle; i++) {
        const char *name = torch->zip.members[i].name;
        size_t length = strlen(name), tail = sizeof ending - 1;
        if (length <= tail || strcmp(name + length - tail, ending) != 0) continue;
        torch->pickle = &torch->zip.members[i];
        torch->stem = length - tail + 1;
    }
    if (torch->pickle) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE, "%s: is a ZIP archive without a data.pkl: torch.save didn't write it",
                   torch->zip.path);
}

static tides_status run(td_torch *torch, td_tree *tree, tides_error *error) {
    td_pickle pickle = {.path = torch->zip.path,
                        .size = torch->pickle->size,
                        .tree = tree,
                        .torch = torch,
                        .persistent = find_storage,
                        .error = error};
    td_value *root = NULL;
    tides_status status = check_order(torch, tree, error);
    if (!status) status = read_member(torch, tree, torch->pickle, &pickle.bytes, error);
    if (!status) status = td_pickle_run(&pickle, &root);
    if (!status) status = td_tree_check(torch->zip.path, root, error);
    if (!status) td_tree_set_root(tree, root);
    return status;
}

static tides_status check_archive(const char *path, const unsigned char *bytes, size_t size, tides_error *error) {
    if (td_zip_is(bytes, size)) return TIDES_OK;
    /* Before torch 1.6 a file was a bare pickle that begins with a magic number, a long of ten bytes. */
    if (size >= 4 && memcmp(bytes, "\x80\x02\x8a\x0a", 4) == 0)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "%s: was written in the form from before torch 1.6: load it with torch and save "
                       "it again",
                       path);
    return td_fail(error, TIDES_BAD_FILE, "%s: isn't a file of torch.save (no ZIP archive)", path);
}

tides_status td_torch_parse(const char *path, const void *bytes, size_t size, td_tree **tree, tides_error *error) {
    td_torch torch = {.pickle = NULL};
    tides_status status = check_archive(path, bytes, size, error);
    if (!status) status = td_zip_open(&torch.zip, path, bytes, size, error);
    if (status) return status;
    td_tree *made = td_tree_create(error);
    torch.payloads = made ? td_alloc(torch.zip.count, sizeof *torch.payloads, error) : NULL;
    status = torch.payloads ? find_pickle(&torch, error) : TIDES_NO_MEMORY;
    if (!status) status = run(&torch, made, error);
    free(torch.payloads);
    td_zip_close(&torch.zip);
    if (status)
        td_tree_free(made);
    else
        *tree = made;
    return status;
}

tides_status td_torch_open(const char *path, td_tree **tree, tides_error *error) {
    char *bytes = NULL;
    size_t size = 0;
    td_tree *made = NULL;
    tides_status status = td_read_file(path, SIZE_MAX - 1, &bytes, &size, error);
    if (!status) status = td_torch_parse(path, bytes, size, &made, error);
    if (!status) status = td_tree_adopt(made, bytes, error); /* tensors point into these bytes */
    if (!status) {
        *tree = made;
        return TIDES_OK;
    }
    td_tree_free(made);
    free(bytes);
    return status;
}
