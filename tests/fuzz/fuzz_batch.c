/* Any bytes as the manifest of a batch: runs with distinct names that are valid folders, or a refusal in one line. If --only
 * names a run, it is the only one. */
#include "fuzz.h"

#include "cli/batch/batch.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[FUZZ_PATH];
    tides_error error = {TIDES_OK, ""};
    cli_list only = {.count = 0};
    batch b = {.directory = "out", .only = &only, .shards = size % 7 ? 1 : 3};
    if (size % 5 == 0) only.items[only.count++] = "a";
    fuzz_put("manifest.json", data, size);
    b.manifest = fuzz_path(path, "manifest.json");
    tides_status status = batch_read(&b, &error);
    if (status == TIDES_BAD_CONFIG)
        fuzz_one_line(status, &error);
    else if (status != TIDES_OK)
        fuzz_refusal(status, &error);
    for (size_t i = 0; status == TIDES_OK && i < b.count; i++)
        if (!b.runs[i].name[0] || b.runs[i].name[0] == '.' || strchr(b.runs[i].name, '/') || !b.runs[i].file) abort();
    if (status == TIDES_OK && only.count && b.shards == 1 && (b.count != 1 || strcmp(b.runs[0].name, "a") != 0)) abort();
    batch_free(&b);
    return 0;
}
