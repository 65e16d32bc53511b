/* Sorts poses by their pictures' names if a file has no times, and notes where a path leaps. */
#include "camera/td_path_reader.h"

#include "camera/td_rotation.h"
#include "td_math.h"
#include "td_sort.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* A step of more than 10 times the median is a leap. With fewer than 5 steps nothing is reported. */
enum { LEAP = 10, LEAST_STEPS = 5 };

void td_path_note(td_path_reader *reader, const char *format, ...) {
    char *notes = reader->path.notes;
    size_t used = strlen(notes);
    va_list arguments;
    if (used > 0 && used + 1 < TIDES_PATH_NOTES) notes[used++] = '\n';
    va_start(arguments, format);
    vsnprintf(notes + used, TIDES_PATH_NOTES - used, format, arguments);
    va_end(arguments);
}

void td_path_name_place(const td_path_reader *reader, const char *file, size_t place, char *text, size_t bytes) {
    if (reader->list)
        snprintf(text, bytes, "%s%s%s[%zu]", file ? file : "", file ? ": " : "", reader->list, place);
    else
        snprintf(text, bytes, "%s%s%zu", file ? file : "line", file ? ":" : " ", place);
}

/* -- names --------------------------------------------------------------------------------------------------------------- */

static int is_digit(char c) { return c >= '0' && c <= '9'; }

/* A run of digits from `at` on, without leading zeros. */
typedef struct digits {
    const char *first;
    size_t length, end;
} digits;

static digits take_digits(const char *name, size_t at, size_t length) {
    while (at < length && name[at] == '0') at++;
    digits d = {name + at, 0, at};
    while (d.end < length && is_digit(name[d.end])) d.end++;
    d.length = d.end - at;
    return d;
}

int td_path_compare_names(const char *a, size_t a_length, const char *b, size_t b_length) {
    size_t i = 0, k = 0;
    while (i < a_length && k < b_length) {
        if (is_digit(a[i]) && is_digit(b[k])) {
            const digits x = take_digits(a, i, a_length), y = take_digits(b, k, b_length);
            const int order = x.length != y.length ? (x.length < y.length ? -1 : 1) : memcmp(x.first, y.first, x.length);
            if (order) return order;
            i = x.end;
            k = y.end;
            continue;
        }
        if (a[i] != b[k]) return (unsigned char)a[i] < (unsigned char)b[k] ? -1 : 1;
        i++;
        k++;
    }
    return i < a_length ? 1 : k < b_length ? -1 : 0;
}

void td_path_set_name(td_path_sample *sample, const cJSON *object, const char *key) {
    const cJSON *name = cJSON_GetObjectItemCaseSensitive(object, key);
    sample->word = cJSON_IsString(name) ? name->valuestring : NULL;
    sample->length = sample->word ? strlen(sample->word) : 0;
}

static int by_name(const void *left, const void *right) {
    const td_path_sample *a = left, *b = right;
    const int order = td_path_compare_names(a->word, a->length, b->word, b->length);
    return order ? order : a->place < b->place ? -1 : a->place > b->place;
}

void td_path_order(td_path_reader *reader, int say) {
    int named = reader->count > 0, moved = 0;
    for (size_t i = 0; i < reader->count; i++) named &= reader->samples[i].word != NULL;
    for (size_t i = 1; named && i < reader->count; i++) moved |= by_name(reader->samples + i - 1, reader->samples + i) > 0;
    if (moved) qsort(reader->samples, reader->count, sizeof *reader->samples, by_name);
    if (moved && say)
        td_path_note(reader, "has no times: its poses are in the order of their pictures' names, which isn't that of the file");
    td_path_spread(reader);
}

/* -- leaps --------------------------------------------------------------------------------------------------------------- */

/* Distance [scene units] and angle [rad] between two poses. */
static void measure_step(const td_path_sample *from, const td_path_sample *to, double step[2]) {
    double square = 0, dot = 0, p[4], q[4];
    memcpy(p, from->pose.quaternion, sizeof p);
    memcpy(q, to->pose.quaternion, sizeof q);
    for (int k = 0; k < 3; k++) {
        const double way = to->pose.position[k] - from->pose.position[k];
        square += way * way;
    }
    step[0] = sqrt(square);
    step[1] = 0;
    if (!td_normalise_quaternion(p) || !td_normalise_quaternion(q)) return;
    for (int k = 0; k < 4; k++) dot += p[k] * q[k];
    step[1] = 2 * td_acos(fmin(1, fabs(dot)));
}

/* The median of the values that aren't 0 (a camera may stand still now and then); 0 if all are. `room` is as long as
 * `values`. */
static double middle(const double *values, size_t stride, size_t count, double *room) {
    size_t n = 0;
    for (size_t i = 0; i < count; i++)
        if (values[stride * i] > 0) room[n++] = values[stride * i];
    if (n == 0) return 0;
    qsort(room, n, sizeof *room, td_ascending);
    return room[n / 2];
}

/* Distance, angle, and their rates. A step is a leap only if its rate leaps, too: otherwise it bridges a gap in time. */
enum { PLACE, TURN, SPEED, RATE, KINDS };

static void note_leaps(td_path_reader *reader, const double *steps, size_t count, double *room) {
    double usual[KINDS], worst = 0;
    size_t leaps = 0, at = 0;
    for (int k = 0; k < KINDS; k++) usual[k] = middle(steps + k, KINDS, count, room);
    for (size_t i = 0; i < count; i++) {
        const double *s = steps + KINDS * i;
        double times = 0;
        for (int k = PLACE; k <= TURN; k++)
            if (usual[k] > 0 && s[k + SPEED] > LEAP * usual[k + SPEED]) times = fmax(times, s[k] / usual[k]);
        if (!(times > LEAP)) continue;
        leaps++;
        if (times > worst) worst = times, at = i;
    }
    if (leaps == 0) return;
    char from[64], to[64];
    td_path_name_place(reader, NULL, reader->samples[at].place, from, sizeof from);
    td_path_name_place(reader, NULL, reader->samples[at + 1].place, to, sizeof to);
    td_path_note(reader, "its poses leap %zu time%s, most from %s to %s, by %.3g middle steps: is their order that of time?",
                 leaps, leaps == 1 ? "" : "s", from, to, worst);
}

tides_status td_path_note_leaps(td_path_reader *reader) {
    const size_t count = reader->count ? reader->count - 1 : 0;
    if (count < LEAST_STEPS) return TIDES_OK;
    double *steps = td_alloc(count, (KINDS + 1) * sizeof *steps, reader->error);
    if (!steps) return TIDES_NO_MEMORY;
    for (size_t i = 0; i < count; i++) {
        const double time = td_path_since(reader->samples + i + 1, reader->samples + i);
        double *s = steps + KINDS * i;
        measure_step(reader->samples + i, reader->samples + i + 1, s);
        for (int k = PLACE; k <= TURN; k++) s[k + SPEED] = s[k] / time;
    }
    note_leaps(reader, steps, count, steps + KINDS * count);
    free(steps);
    return TIDES_OK;
}
