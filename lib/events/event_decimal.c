/* Parses decimal numbers exactly. Binary floating point would shift the microseconds of times since 1970, and the C library's
 * parser depends on the locale. */
#include "td_event_format.h"

#include <string.h>

/* A longer number isn't a time; a larger exponent moves the point out of any number. */
enum { DIGITS_MAX = 512, EXPONENT_MAX = 100000 };

/* A number as digits and a scale: 12.5e3 is "125" with scale 2. */
typedef struct number {
    char digits[DIGITS_MAX];
    size_t count;
    long scale; /* places to move the decimal point right of the digits' end; negative: left */
    int negative;
} number;

static int is_digit(char c) { return c >= '0' && c <= '9'; }

/* Parses the exponent at `at`, which must extend to the end of the text. */
static int scan_exponent(const char *at, const char *end, long *exponent) {
    int negative = at < end && *at == '-';
    long value = 0;
    if (at < end && (*at == '-' || *at == '+')) at++;
    if (at == end) return 0;
    for (; at < end; at++) {
        if (!is_digit(*at)) return 0;
        value = value < EXPONENT_MAX ? 10 * value + (*at - '0') : value;
    }
    *exponent = negative ? -value : value;
    return 1;
}

static int scan(const char *text, size_t length, number *n) {
    const char *at = text, *end = text + length;
    int point = 0, seen = 0;
    long exponent = 0;
    n->count = 0;
    n->scale = 0;
    n->negative = at < end && *at == '-';
    if (at < end && (*at == '-' || *at == '+')) at++;
    for (; at < end && (is_digit(*at) || (*at == '.' && !point)); at++) {
        if (*at == '.') {
            point = 1;
            continue;
        }
        seen = 1;
        n->scale -= point;
        if (n->count == 0 && *at == '0') continue;
        if (n->count == DIGITS_MAX) return 0;
        n->digits[n->count++] = *at;
    }
    if (!seen || (at < end && *at != 'e' && *at != 'E')) return 0;
    if (at < end && !scan_exponent(at + 1, end, &exponent)) return 0;
    n->scale += exponent;
    return 1;
}

/* Appends a digit to `value`, which must stay below INT64_MAX; 0 on overflow. */
static int append(uint64_t *value, int digit) {
    if (*value > (uint64_t)(INT64_MAX - digit) / 10) return 0;
    *value = 10 * *value + (uint64_t)digit;
    return 1;
}

int td_decimal(const char *text, size_t length, int digits, int64_t *value) {
    number n;
    uint64_t sum = 0;
    if (!scan(text, length, &n)) return 0;
    long whole = (long)n.count + n.scale + digits; /* digits of the result */
    for (long i = 0; n.count > 0 && i < whole; i++)
        if (!append(&sum, i < (long)n.count ? n.digits[i] - '0' : 0)) return 0;
    if (whole >= 0 && whole < (long)n.count && n.digits[whole] >= '5') sum++;
    if (sum > INT64_MAX) return 0;
    *value = n.negative ? -(int64_t)sum : (int64_t)sum;
    return 1;
}

int td_decimal_whole(const char *text, size_t length, int64_t least, int64_t most, int64_t *value) {
    int64_t rounded, tenths;
    if (!td_decimal(text, length, 0, &rounded) || rounded < least || rounded > most) return 0;
    if (memchr(text, '.', length) && (!td_decimal(text, length, 1, &tenths) || tenths != 10 * rounded)) return 0;
    *value = rounded;
    return 1;
}
