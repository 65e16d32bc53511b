/* The one list of the state that pixels carry from one step to the next, for the blocks that are on. Checkpoints save its
 * arrays that have names, and so does the undoing of a step. The solver puts single pixels back by all its arrays. New state of
 * a block is one row here.
 *
 * Thresholds, leaks and other values that are drawn once per pixel aren't carried: they are drawn again from the seed. */
#include "td_base.h"
#include "td_sensor.h"
#include "td_sensor_parts.h"
#include "td_single.h"

#include <string.h>

/* An array of the list: `real` or `count` is given. An array without a name follows from the others (td_sensor_resume) and
 * isn't saved. It is listed for single pixels, for which computing it again would take time. */
typedef struct listed {
    const char *name;
    double *real;
    uint32_t *count;
} listed;

tides_status td_sensor_list(td_sensor *s, tides_error *error) {
    const listed all[] = {
        {"initial", s->pixels.initial, NULL},
        {"count_on", NULL, s->pixels.count_on},
        {"count_off", NULL, s->pixels.count_off},
        {NULL, s->pixels.reference, NULL},
        {"held_until", s->held_until, NULL},
        {"last_event", s->since, NULL},
        {NULL, s->wake, NULL},
        {"shot_on_due", s->noise.due[TD_NOISE_SHOT_ON], NULL},
        {"shot_on_drawn", NULL, s->noise.drawn[TD_NOISE_SHOT_ON]},
        {"shot_off_due", s->noise.due[TD_NOISE_SHOT_OFF], NULL},
        {"shot_off_drawn", NULL, s->noise.drawn[TD_NOISE_SHOT_OFF]},
        {"hot_due", s->noise.due[TD_NOISE_HOT], NULL},
        {"hot_drawn", NULL, s->noise.drawn[TD_NOISE_HOT]},
        {"noise_segment", s->segment.number, NULL},
        {"noise_value", s->segment.value, NULL},
        {"noise_light", s->segment.light, NULL},
        {"filter_0", s->filtered.state[0], NULL},
        {"filter_1", s->filtered.state[1], NULL},
        {"filter_2", s->filtered.state[2], NULL},
        {"filter_3", s->filtered.state[3], NULL},
        {"filter_error", s->filtered.error, NULL},
    };
    typedef char one_row_each[TD_FRONTEND_STATE == 4 ? 1 : -1];
    (void)sizeof(one_row_each);
    s->carried.count = 0;
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        const td_carried row = {all[i].name, all[i].real ? TD_STATE_REAL : TD_STATE_COUNT,
                                all[i].real ? (void *)all[i].real : (void *)all[i].count};
        if (!row.values) continue; /* its block is off */
        if (s->carried.count == TD_CARRIED_MAX)
            return td_fail(error, TIDES_UNSUPPORTED, "a pixel carries more than %d numbers: raise TD_CARRIED_MAX",
                           (int)TD_CARRIED_MAX);
        s->carried.row[s->carried.count++] = row;
    }
    return TIDES_OK;
}

void td_sensor_state(td_sensor *s, td_state *state) {
    for (int i = 0; i < s->carried.count; i++)
        if (s->carried.row[i].name)
            td_state_add(state, s->carried.row[i].name, s->carried.row[i].type, TD_STATE_PIXELS, s->count,
                         s->carried.row[i].values);
}

/* Each value is copied into a 64-bit word. */
void td_sensor_keep(const td_sensor *s, size_t pixel, td_kept_pixel *kept) {
    kept->words = s->carried.count;
    for (int i = 0; i < s->carried.count; i++) {
        const td_carried *row = &s->carried.row[i];
        kept->word[i] = 0;
        if (row->type == TD_STATE_REAL)
            memcpy(&kept->word[i], (const double *)row->values + pixel, sizeof(double));
        else
            kept->word[i] = ((const uint32_t *)row->values)[pixel];
    }
}

void td_sensor_put_back(const td_sensor *s, size_t pixel, const td_kept_pixel *kept) {
    for (int i = 0; i < kept->words; i++) {
        const td_carried *row = &s->carried.row[i];
        if (row->type == TD_STATE_REAL)
            memcpy((double *)row->values + pixel, &kept->word[i], sizeof(double));
        else
            ((uint32_t *)row->values)[pixel] = (uint32_t)kept->word[i];
    }
}
