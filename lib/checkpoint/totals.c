/* Saves the statistics of a run's first part: those that are combined with the second part's by their sum or maximum. Others
 * are computed again. */
#include "td_checkpoint.h"

/* The next row from `*i` on that is saved; NULL after the last. */
static const tides_stat *next(size_t *i) {
    size_t count;
    const tides_stat *table = tides_stats_table(&count);
    while (*i < count && table[*i].joined == TIDES_JOIN_DERIVED) (*i)++;
    return *i < count ? &table[(*i)++] : NULL;
}

tides_status td_totals_write(const tides_stats *stats, const td_place *place) {
    const tides_stat *row;
    tides_status status = TIDES_OK;
    for (size_t i = 0; status == TIDES_OK && (row = next(&i)) != NULL;)
        status = td_place_write_double(place, row->name, tides_stat_value(stats, row));
    return status;
}

tides_status td_totals_read(const td_place *place, tides_stats *stats) {
    const tides_stat *row;
    tides_status status = TIDES_OK;
    memset(stats, 0, sizeof *stats);
    for (size_t i = 0; status == TIDES_OK && (row = next(&i)) != NULL;) {
        /* times are differences, and may be slightly below 0 */
        double value = 0, least = row->type == TIDES_STAT_REAL ? -0x1p53 : 0;
        status = td_place_read_double(place, row->name, &value);
        if (status == TIDES_OK && !(value >= least && value < 0x1p53))
            status = td_fail(place->error, TIDES_BAD_FILE, "%s: %s is %g, no total", place->file, row->name, value);
        if (status == TIDES_OK) td_stat_set(stats, row, value);
    }
    return status;
}
