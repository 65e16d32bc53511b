/* Writes the results in a folder as a page: one file that needs no other. */
#ifndef CLI_BENCH_PAGE_H
#define CLI_BENCH_PAGE_H

#include "bench_main.h"

/* Writes index.html: targets, pictures and table of each benchmark whose NAME.json is in the folder. */
tides_status bench_page(const bench *b, const bench_list *all, tides_error *error);

#endif
