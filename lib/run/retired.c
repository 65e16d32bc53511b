/* Keys and choices of earlier versions with their replacements: a run file that still has one fails with this advice. */
#include "td_run.h"

#include <string.h>

/* A row without a choice is about the whole key. */
static const struct retired {
    const char *key, *choice, *instead;
} retired[] = {
    {"stepping.mode", "error_risk", "\"error\" finds what the risk score asks for, and \"risk\" alone is the paper's"},
    {"stepping.paths", NULL, "tiles are projected at each of their times, which is as quick; leave it out"},
    {"stepping.budget", NULL,
     "a looser stepping.tolerance takes fewer renders, and stepping.mode \"fixed\" as many as its steps"},
    {"stepping.solve", "float", "\"double\" is as quick and exact, and \"off\" is for images that jump"},
};

const char *td_param_retired(const char *key, const char *choice) {
    for (size_t i = 0; i < sizeof retired / sizeof *retired; i++) {
        const struct retired *row = &retired[i];
        if (strcmp(row->key, key) != 0 || !row->choice != !choice) continue;
        if (!choice || strcmp(row->choice, choice) == 0) return row->instead;
    }
    return NULL;
}
