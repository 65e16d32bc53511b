/* Any bytes as a run file's text: parsed or refused in one line, and what is parsed prints to text that parses again.
 * For libFuzzer (clang -fsanitize=fuzzer,address). */
#include "tides/run.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Bytes up to the first 0x01 are the file, the rest an override. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char *text = malloc(size + 1);
    if (!text) return 0;
    memcpy(text, data, size);
    text[size] = '\0';
    char *split = memchr(text, 1, size);
    if (split) *split = '\0';
    const char *override = split ? split + 1 : NULL;

    tides_run *run = NULL, *again = NULL;
    tides_error error = {0, ""};
    tides_status status = tides_run_parse(text, "dir", &override, override ? 1 : 0, &run, &error);
    if (status != TIDES_OK && (run || error.status != status || !error.text[0] || strchr(error.text, '\n'))) abort();
    if (status == TIDES_OK) {
        tides_run_values values;
        tides_run_get(run, &values);
        if (tides_run_parse(values.json, "dir", NULL, 0, &again, &error) != TIDES_OK) abort();
    }
    tides_run_destroy(again);
    tides_run_destroy(run);
    free(text);
    return 0;
}
