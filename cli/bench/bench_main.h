/* The main function of a program whose benchmarks are listed in a table. */
#ifndef CLI_BENCH_MAIN_H
#define CLI_BENCH_MAIN_H

#include "bench.h"

/* A benchmark. With own_devices it opens devices itself, and --row chooses rows of its table of results. Without, it gets an
 * open device, and --scene chooses among built-in scenes and .ply files. */
typedef struct bench_entry {
    const char *name, *sentence; /* the sentence is for the page of results */
    tides_status (*run)(bench *b, const cli_list *names, tides_error *error);
    int32_t own_devices;
    const char *const *(*names)(void); /* choices of --scene or --row; the list ends with a NULL */
    int32_t numbered;                  /* rows of a scene that have numbers from 0 on, which --row chooses; 0: none */
} bench_entry;

enum { BENCH_ENTRIES = 16 }; /* in a table at most */
typedef struct bench_list {
    const bench_entry *entry;
    size_t count;
} bench_list;

/* Runs a command whose argument is the name of a benchmark, or `all`. Returns the exit code. */
int bench_main(const cli_command *command, const bench_list *all, int argc, char **argv);

#endif
