/* Which known name a misspelt one was meant to be. */
#include "cli.h"

#include <string.h>

enum { LONGEST = 48 };

static size_t least(size_t a, size_t b) { return a < b ? a : b; }

/* Edit distance in which swapping two neighbours counts once, as typing does it. */
static size_t distance(const char *a, const char *b) {
    size_t rows[LONGEST + 1][LONGEST + 1], length_a = strlen(a), length_b = strlen(b);
    if (length_a > LONGEST || length_b > LONGEST) return SIZE_MAX;
    for (size_t i = 0; i <= length_a; i++) {
        for (size_t j = 0; j <= length_b; j++) {
            if (i == 0 || j == 0) {
                rows[i][j] = i + j;
                continue;
            }
            size_t cost = rows[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
            cost = least(cost, least(rows[i - 1][j], rows[i][j - 1]) + 1);
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) cost = least(cost, rows[i - 2][j - 2] + 1);
            rows[i][j] = cost;
        }
    }
    return rows[length_a][length_b];
}

const char *cli_nearest(const char *name, const char *const *names) {
    const char *nearest = NULL;
    size_t shortest = strlen(name) / 2 + 1; /* with more than half of it wrong it is no slip */
    for (; *names; names++) {
        size_t far = distance(name, *names);
        /* An abbreviation is meant too: --out, sim. */
        if (strlen(name) > 2 && strncmp(name, *names, strlen(name)) == 0) far = 0;
        if (far < shortest) {
            shortest = far;
            nearest = *names;
        }
    }
    return nearest;
}
