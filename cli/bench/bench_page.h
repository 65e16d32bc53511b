/* Results of a folder as a page for people: one file that needs nothing else. */
#ifndef CLI_BENCH_PAGE_H
#define CLI_BENCH_PAGE_H

#include "bench_main.h"

/* Writes index.html: of each of the benchmarks whose NAME.json is in the folder its targets, its pictures and its table. */
tides_status bench_page(const bench *b, const bench_list *all, tides_error *error);

#endif
