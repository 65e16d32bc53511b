/* Any text as the lod-meta.json of a streamed SOG, all of whose parts are missing. */
#include "fuzz.h"

#include "scene/td_splat.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[FUZZ_PATH];
    tides_error error = {0, ""};
    td_gaussians gaussians = {.count = -1};
    td_folder files = {NULL, 0, 0};
    fuzz_put("lod-meta.json", data, size);
    fuzz_path(path, "lod-meta.json");
    tides_status listed = td_sog_lod_files(path, NULL, &files, &error);
    if (listed != TIDES_OK) fuzz_refusal(listed, &error);
    td_folder_free(&files);
    tides_status status = td_sog_read_lod(path, NULL, &gaussians, &error);
    if (status == TIDES_FILE_NOT_FOUND && listed == TIDES_OK)
        fuzz_one_line(status, &error);
    else
        fuzz_refusal(status, &error); /* OK is none */
    if (gaussians.count != -1) abort();
    return 0;
}
