/* A program of benchmarks, by a table of them. */
#ifndef CLI_BENCH_MAIN_H
#define CLI_BENCH_MAIN_H

#include "bench.h"

/* One that opens devices by itself goes through rows, the others through scenes: built-in ones, or files. */
typedef struct bench_entry {
    const char *name, *sentence; /* the latter for the page of results */
    tides_status (*run)(bench *b, const cli_list *names, tides_error *error);
    int32_t own_devices;
    const char *const *(*names)(void); /* what --scene or --row chooses from, NULL-terminated */
} bench_entry;

enum { BENCH_ENTRIES = 16 }; /* in a table at most */
typedef struct bench_list {
    const bench_entry *entry;
    size_t count;
} bench_list;

/* A command that takes the name of one, or `all`: cli_command.run with the table. */
int bench_main(const cli_command *command, const bench_list *all, int argc, char **argv);

#endif
