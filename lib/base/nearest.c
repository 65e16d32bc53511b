/* Finds the known name that is nearest to a misspelt one, for error messages. Library, tool and Python package all use it,
 * so that they suggest the same name. The caller words the message. */
#include "td_base.h"

#include <string.h>

/* Longest name that is compared: no key, file ending or command is longer. Longer names count as far from all. */
enum { LONGEST = 128, ROW = LONGEST + 1 };

/* An abbreviation counts only from three letters on: shorter ones are the start of too many names. */
enum { LEAST_START = 3 };

/* Capital and small letters count as equal: people write a sensor's name as its maker does. */
static char small(char c) { return (char)(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c); }

static size_t lesser(size_t a, size_t b) { return a < b ? a : b; }

/* Computes row i of the distance table, for the i-th letter of `a`, from the two rows before it. */
static void next_row(const char *a, const char *b, size_t i, const size_t *before, const size_t *last, size_t *row) {
    row[0] = i;
    for (size_t j = 1; b[j - 1]; j++) {
        size_t cost = last[j - 1] + (small(a[i - 1]) != small(b[j - 1]));
        cost = lesser(cost, lesser(last[j], row[j - 1]) + 1);
        if (i > 1 && j > 1 && small(a[i - 1]) == small(b[j - 2]) && small(a[i - 2]) == small(b[j - 1]))
            cost = lesser(cost, before[j - 2] + 1);
        row[j] = cost;
    }
}

/* Edit distance in which two neighbours swapped count once, as typing does it (optimal string alignment). */
static size_t edit_distance(const char *a, const char *b) {
    size_t rows[3][ROW] = {{0}};
    const size_t length_a = strlen(a), length_b = strlen(b);
    if (length_a > LONGEST || length_b > LONGEST) return SIZE_MAX;
    for (size_t j = 0; j <= length_b; j++) rows[0][j] = j;
    for (size_t i = 1; i <= length_a; i++) next_row(a, b, i, rows[(i + 1) % 3], rows[(i + 2) % 3], rows[i % 3]);
    return rows[length_a % 3][length_b];
}

const char *tides_nearest_name(const char *name, const char *const *names) {
    if (!name || !names) return NULL;
    const char *nearest = NULL;
    const size_t length = strlen(name);
    size_t least = length / 2 + 1; /* more than half the letters wrong is not a slip */
    for (; *names; names++) {
        if (strcmp(name, *names) == 0) return *names;
        /* an abbreviation such as --out or sim */
        const int32_t starts = length >= LEAST_START && strncmp(name, *names, length) == 0;
        const size_t distance = starts ? 0 : edit_distance(name, *names);
        if (distance < least) {
            least = distance;
            nearest = *names;
        }
    }
    return nearest;
}

const char *td_suggest(const char *name, const char *list, const char *separators, char text[TD_SUGGESTION_MAX]) {
    enum { NAMES = 64, BYTES = 1024 }; /* names that are compared at most; bytes of the longest list */
    char copy[BYTES];
    const char *names[NAMES + 1] = {NULL};
    size_t count = 0, length = strlen(list);
    text[0] = '\0';
    if (length >= BYTES) return text;
    memcpy(copy, list, length + 1);
    for (char *at = copy + strspn(copy, separators); *at && count < NAMES; at += strspn(at, separators)) {
        names[count++] = at;
        at += strcspn(at, separators);
        if (*at) *at++ = '\0';
    }
    const char *nearest = tides_nearest_name(name, names);
    if (nearest && strlen(nearest) < TD_SUGGESTION_MAX - sizeof "; did you mean ?")
        snprintf(text, TD_SUGGESTION_MAX, "; did you mean %s?", nearest);
    return text;
}
