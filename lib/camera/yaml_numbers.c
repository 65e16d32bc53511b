/* Reads lists of numbers in YAML: "[a, b]", which may continue on the next line, or one number behind each "- ". */
#include "camera/td_path_reader.h"

#include <string.h>

const char *td_yaml_skip(const char *at) { return at + strspn(at, " \t\r\n"); }

/* Skips a "-" that is followed by a blank, and the blanks. */
static const char *take_dash(const char *at) {
    return *at == '-' && strchr(" \t\r\n", at[1]) && at[1] ? td_yaml_skip(at + 1) : NULL;
}

const char *td_yaml_row(const char *at, double *values, int count) {
    at = td_yaml_skip(at);
    const int flow = *at == '[';
    if (flow) at = td_yaml_skip(at + 1);
    for (int k = 0; k < count; k++) {
        if (!flow && !(at = take_dash(at))) return NULL;
        const char *end = td_text_number(at, values + k);
        if (end == at) return NULL;
        at = td_yaml_skip(end);
        if (flow && k + 1 < count && *at++ != ',') return NULL;
        if (flow) at = td_yaml_skip(at);
    }
    if (flow && *at++ != ']') return NULL;
    return td_yaml_skip(at);
}

const char *td_yaml_matrix(const char *at, double m[16]) {
    at = td_yaml_skip(at);
    const int flow = *at == '[';
    if (flow) at = td_yaml_skip(at + 1);
    for (int i = 0; i < 4 && at; i++) {
        if (!flow && !(at = take_dash(at))) return NULL;
        at = td_yaml_row(at, m + 4 * i, 4);
        if (at && flow && *at++ != (i < 3 ? ',' : ']')) return NULL;
        if (at) at = td_yaml_skip(at);
    }
    return at;
}
