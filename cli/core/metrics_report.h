/* The result of tides metrics, as JSON or as a table. */
#ifndef CLI_METRICS_REPORT_H
#define CLI_METRICS_REPORT_H

#include "cli.h"

/* {"reference": {...}, "simulated": {...}, "comparison": {...}}: values by family as wanted; null: undefined. NULL: out of
 * memory. */
cJSON *cli_metrics_json(const tides_metrics *metrics, const tides_metrics_options *options);

/* Prints the report as text: the streams' values side by side, then the comparison's. */
void cli_metrics_print(const cJSON *report);

/* Meaning of a value of the comparison, and the better direction, from the library's table; NULL: no such value. */
enum { CLI_MEANING = 160 };
const char *cli_metric_meaning(const char *name, char text[CLI_MEANING]);

#endif
