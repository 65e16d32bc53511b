/* What a folder of results says, for people: one page that needs nothing else. */
#ifndef CLI_BENCH_PAGE_H
#define CLI_BENCH_PAGE_H

#include "bench.h"

/* Writes index.html: of each of the benchmarks `names` (NULL-terminated) whose NAME.json is in the folder its targets, its
 * pictures and its table. */
tides_status bench_page(const bench *b, const char *const *names, tides_error *error);

#endif
