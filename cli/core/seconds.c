/* Seconds as whole nanoseconds, from numbers and text and back to text: times of 1.4e9 s keep their nanoseconds. */
#include "cli.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* [s] 64-bit nanoseconds end at 9.22e9 s. */
static const double furthest = 9e9;

int64_t cli_nanoseconds(double seconds) {
    const double whole = floor(seconds); /* the rest is exact; 1e9 times the sum is off by 128 ns at 1e9 s */
    return (int64_t)whole * 1000000000 + (int64_t)round((seconds - whole) * 1e9);
}

/* Parses "-12.0345" digit by digit, rounding at a tenth decimal; 0 for other notations ("1e-3"). */
static int take_decimal(const char *text, int64_t *ns) {
    const int negative = *text == '-';
    int64_t value = 0;
    int digits = -1; /* after the point; -1: none yet */
    const char *c = text + (negative || *text == '+');
    if (strlen(c) > 32) return 0;
    for (; (*c >= '0' && *c <= '9' && digits < 9) || (*c == '.' && digits < 0); c++) {
        if (*c != '.') value = 10 * value + (*c - '0');
        if (*c == '.' || digits >= 0) digits++;
        if (value > INT64_MAX / 10 - 9) break;
    }
    if (digits == 9 && *c >= '0' && *c <= '9') value += *c >= '5';
    while (digits == 9 && *c >= '0' && *c <= '9') c++;
    if (*c) return 0;
    for (digits = digits < 0 ? 0 : digits; digits < 9; digits++) {
        if (value > INT64_MAX / 10) return 0;
        value *= 10;
    }
    *ns = negative ? -value : value;
    return 1;
}

int cli_time(const cli_command *command, const char *option, const char *text, int64_t *ns) {
    double seconds;
    int code = cli_number(command, option, text, &seconds);
    if (code != CLI_GO) return code;
    if (!(fabs(seconds) < furthest)) return cli_usage(command, "%s %s: not a time in seconds", option, text);
    if (!take_decimal(text, ns)) *ns = cli_nanoseconds(seconds);
    return CLI_GO;
}

/* Adds a whole number as text: cJSON's doubles hold only 53 bits. */
void cli_add_ns(cJSON *object, const char *name, int64_t ns) {
    char text[24];
    snprintf(text, sizeof text, "%lld", (long long)ns);
    cJSON_AddRawToObject(object, name, text);
}

void cli_add_number(cJSON *object, const char *name, double value) {
    if (isfinite(value))
        cJSON_AddNumberToObject(object, name, value);
    else
        cJSON_AddNullToObject(object, name);
}

void cli_add_seconds(cJSON *object, const char *name, int64_t ns) {
    char text[CLI_SECONDS];
    cJSON_AddRawToObject(object, name, cli_seconds(ns, text));
}

const char *cli_seconds(int64_t ns, char text[CLI_SECONDS]) {
    const uint64_t size = ns < 0 ? 0 - (uint64_t)ns : (uint64_t)ns;
    snprintf(text, CLI_SECONDS, "%s%llu.%09llu", ns < 0 ? "-" : "", (unsigned long long)(size / 1000000000),
             (unsigned long long)(size % 1000000000));
    return text;
}
