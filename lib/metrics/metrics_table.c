/* The table of metrics: every value of a comparison, with family, unit, direction of better, and a sentence. The initial
 * NaNs, the tool's JSON, table and --only, and Python's list are made from it. A new metric needs a file, a documented field
 * in tides_metrics, and rows here. */
#include "td_metrics.h"

#define ROW(of, label, family, kind, often, field, span, units, way, text) \
    { label, FAMILY_##family, units, text, TIDES_BETTER_##way, TIDES_OF_##of, TIDES_REPEATS_##often, kind, field, span }
/* Rows about the comparison: a number, a count, or a number for each kind of pairs or each bin. */
#define ONCE(name, family, member, unit, way, text) \
    ROW(BOTH, name, family, 1, ONCE, offsetof(tides_metrics, member), 0, unit, way, text)
#define COUNT(name, family, member, unit, way, text) \
    ROW(BOTH, name, family, 0, ONCE, offsetof(tides_metrics, member), 0, unit, way, text)
#define EACH(often, name, family, member, unit, way, text) \
    ROW(BOTH, name, family, 1, often, offsetof(tides_metrics, member), sizeof(double), unit, way, text)
/* Rows about each stream. */
#define STREAM(often, real, name, family, member, span, unit, text) \
    ROW(STREAM, name, family, real, often, offsetof(tides_stream_metrics, member), span, unit, NEITHER, text)

/* Families: their names for --only, and their bits. */
#define FAMILY_COUNTS "counts", TIDES_METRIC_COUNTS
#define FAMILY_ISI "isi", TIDES_METRIC_ISI
#define FAMILY_SAME "same-ts", TIDES_METRIC_SAME_TIME
#define FAMILY_FANO "fano", TIDES_METRIC_FANO
#define FAMILY_CHAMFER "chamfer", TIDES_METRIC_CHAMFER
#define FAMILY_VICTOR "victor-purpura", TIDES_METRIC_VICTOR_PURPURA
#define FAMILY_ROSSUM "van-rossum", TIDES_METRIC_VAN_ROSSUM
#define FAMILY_NEAREST "time-difference", TIDES_METRIC_TIME_DIFFERENCE
#define FAMILY_KERNEL "kernel", TIDES_METRIC_KERNEL
#define FAMILY_MATCH "match", TIDES_METRIC_MATCH

/* In the order of the tool's output; families in the order of --only. */
static const tides_metric table[] = {
    STREAM(ONCE, 1, "on_fraction", COUNTS, on_fraction, 0, "", "ON events / events"),
    STREAM(PAIRS, 0, "isi", ISI, intervals[0].count, sizeof(tides_interval_fit), "", "intervals between events of a pixel"),
    STREAM(PAIRS, 0, "isi_floored", ISI, intervals[0].floored, sizeof(tides_interval_fit), "",
           "of them, shorter than the floor"),
    STREAM(PAIRS, 1, "isi_mean_s", ISI, intervals[0].mean_s, sizeof(tides_interval_fit), "s", "mean of the fitted law"),
    STREAM(PAIRS, 1, "isi_shape_s", ISI, intervals[0].shape_s, sizeof(tides_interval_fit), "s", "shape of the fitted law"),
    STREAM(ONCE, 1, "isi_spike", ISI, isi_spike, 0, "", "intervals of at most 1 us, or on a clock"),
    STREAM(ONCE, 1, "same_ts", SAME, same_time, 0, "", "events that share their tick with another one"),
    STREAM(ONCE, 1, "same_ts_tile", SAME, same_time_tile, 0, "", "of their tile"),
    STREAM(BINS, 1, "fano", FANO, fano, sizeof(double), "", "mean Fano factor of the tiles"),
    STREAM(ONCE, 1, "van_rossum_norm", ROSSUM, van_rossum_norm, 0, "", "distance from no events at all"),
    ONCE("count_ratio", COUNTS, count_ratio, "", ONE, "simulated events / reference events"),
    ONCE("count_ratio_on", COUNTS, count_ratio_on, "", ONE, "the same of ON events"),
    ONCE("count_ratio_off", COUNTS, count_ratio_off, "", ONE, "the same of OFF events"),
    EACH(BINS, "rate_error", COUNTS, rate_error, "", LOWER, "events too many or few in bins of time / reference events"),
    ONCE("region_error", COUNTS, region_error, "", LOWER, "events too many or few in tiles / reference events"),
    ONCE("count_correlation", COUNTS, count_correlation, "", ONE, "of events per pixel"),
    EACH(PAIRS, "ig_nll", ISI, ig_nll, "nats", LOWER, "the reference's intervals under a law fitted to the simulated ones"),
    EACH(PAIRS, "ig_nll_self", ISI, ig_nll_self, "nats", NEITHER,
         "the reference's intervals under their own fit: what ig_nll can be at least"),
    EACH(PAIRS, "ig_nll_excess", ISI, ig_nll_excess, "nats", LOWER,
         "ig_nll above ig_nll_self: divergence of the laws of intervals"),
    ONCE("isi_w1_decades", ISI, isi_w1, "decades", LOWER, "distance of log10 intervals; 1 is a factor of 10"),
    ONCE("isi_w1_after_off_decades", ISI, isi_w1_after[0], "decades", LOWER, "the same of intervals that an OFF event begins"),
    ONCE("isi_w1_after_on_decades", ISI, isi_w1_after[1], "decades", LOWER, "the same of intervals that an ON event begins"),
    EACH(BINS, "fano_error", FANO, fano_error, "", LOWER, "|ln| of the ratio of Fano factors (burstiness), mean of tiles"),
    ROW(BOTH, "fano_tiles", FANO, 0, BINS, offsetof(tides_metrics, fano_tiles), sizeof(uint64_t), "", NEITHER,
        "tiles that had enough events to be compared"),
    EACH(BINS, "fano_coverage", FANO, fano_coverage, "", ONE, "of the reference's tiles with enough events"),
    ONCE("chamfer_px", CHAMFER, chamfer_px, "px", LOWER, "distance to the nearest event of the other stream in (x, y, v t)"),
    ONCE("chamfer_fraction", CHAMFER, chamfer_fraction, "", LOWER, "the same over the image's diagonal"),
    ONCE("chamfer_to_simulated_px", CHAMFER, chamfer_to_simulated_px, "px", LOWER,
         "from reference events: what the simulation misses"),
    ONCE("chamfer_to_reference_px", CHAMFER, chamfer_to_reference_px, "px", LOWER, "from simulated events: what it invents"),
    ONCE("chamfer_limit_px", CHAMFER, chamfer_limit_px, "px", NEITHER, "what an event counts that has nothing near"),
    COUNT("chamfer_terms", CHAMFER, chamfer_terms, "", NEITHER, "windows of a polarity compared"),
    COUNT("chamfer_one_sided", CHAMFER, chamfer_one_sided, "", LOWER, "of them with one stream empty"),
    ONCE("speed_px_per_s", CHAMFER, speed_px_per_s, "px/s", NEITHER, "v: found or given, turns seconds into pixels"),
    ONCE("victor_purpura", VICTOR, victor_purpura, "", LOWER, "cost of shifting, adding, removing events until trains agree"),
    ONCE("victor_purpura_fraction", VICTOR, victor_purpura_fraction, "", LOWER,
         "Victor-Purpura cost: 0 for equal trains, 1 where nothing is near"),
    ONCE("van_rossum", ROSSUM, van_rossum, "", LOWER, "squared distance of smoothed trains"),
    ONCE("van_rossum_fraction", ROSSUM, van_rossum_fraction, "", LOWER,
         "van Rossum distance: 0 for equal trains, 1 where nothing is near"),
    ONCE("time_difference_us", NEAREST, time_difference_us, "us", LOWER, "to the pixel's nearest event of that polarity, mean"),
    COUNT("time_difference_over", NEAREST, time_difference_over, "", LOWER, "reference events without one within the limit"),
    ONCE("kernel_distance", KERNEL, kernel_distance, "", LOWER, "squared distance of the streams blurred in x, y and t"),
    COUNT("matched", MATCH, match.matched, "", HIGHER, "reference events found, one by one"),
    ONCE("matched_share", MATCH, matched_share, "", HIGHER, "events of both streams that have their counterpart"),
    COUNT("missing", MATCH, match.missing, "", LOWER, "reference events not found"),
    COUNT("spurious", MATCH, match.spurious, "", LOWER, "simulated events that the reference lacks"),
    ONCE("mismatch_percent", MATCH, match.mismatch_percent, "%", LOWER, "(missing + spurious) / reference events"),
    ONCE("dt_median_us", MATCH, match.dt_median_us, "us", LOWER, "|time difference| of matched events"),
    ONCE("dt_p95_us", MATCH, match.dt_p95_us, "us", LOWER, "|time difference| of matched events"),
    ONCE("dt_p99_us", MATCH, match.dt_p99_us, "us", LOWER, "|time difference| of matched events"),
    ONCE("dt_max_us", MATCH, match.dt_max_us, "us", LOWER, "|time difference| of matched events"),
    ONCE("dt_mean_us", MATCH, match.dt_mean_us, "us", ZERO,
         "simulated minus reference time of matched events: negative is early"),
};

const tides_metric *tides_metrics_table(size_t *count) {
    if (count) *count = sizeof table / sizeof table[0];
    return table;
}

const td_metric_part td_metric_parts[] = {
    {TIDES_METRIC_COUNTS, "counts", td_compare_counts, 1},
    {TIDES_METRIC_COUNTS, "rates", td_compare_rates, 0},
    {TIDES_METRIC_SAME_TIME, "Same-ts", td_compare_same_time, 0},
    {TIDES_METRIC_FANO, "Fano factors", td_compare_fano, 0},
    {TIDES_METRIC_ISI, "intervals", td_compare_isi, 1},
    {TIDES_METRIC_ISI, "intervals", td_compare_isi_after, 1},
    {TIDES_METRIC_VICTOR_PURPURA | TIDES_METRIC_VAN_ROSSUM | TIDES_METRIC_TIME_DIFFERENCE, "spike trains", td_compare_trains,
     1},
    {TIDES_METRIC_KERNEL, "kernel distance", td_compare_kernel, 0},
    {TIDES_METRIC_CHAMFER, "Chamfer", td_compare_chamfer, 0},
    {0, NULL, NULL, 0},
};
