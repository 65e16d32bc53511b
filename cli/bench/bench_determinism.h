/* `tides bench determinism`: the same runs, made in ways that must give the same events, a hash for each. */
#ifndef CLI_BENCH_DETERMINISM_H
#define CLI_BENCH_DETERMINISM_H

#include "bench.h"
#include "sha256.h"

/* -- runs and ways (bench_determinism_rows.c) -------------------------------------------------------------------------- */

enum { DETERMINISM_TEXTS = 20, DETERMINISM_WAYS_MAX = 20 };

/* A run: the demo's world with these keys set. */
typedef struct determinism_run {
    const char *name, *sentence;
    const char *sets[DETERMINISM_TEXTS]; /* ends with a NULL */
    int32_t frames;                      /* 1: a method that differences frames, whose runs can't be cut */
} determinism_run;

/* How a run is made: at once, in pieces, by simulators that save and restore each other, through a file, or by processes that
 * are killed and resumed. */
enum { DETERMINISM_WHOLE, DETERMINISM_PIECES, DETERMINISM_SAVED, DETERMINISM_FILE, DETERMINISM_KILLED };

typedef struct determinism_way {
    const char *name, *sentence;
    int32_t how;
    const char *device;                 /* NULL: the user's choice */
    const char *sets[4];                /* added to the run's; ends with a NULL */
    const char *variable[3], *value[3]; /* environment variables */
    int32_t units;                      /* compute units that the device must report; 0: any */
    int32_t pocl;                       /* 1: only for PoCL */
    int32_t own_kernels;                /* 1: needs an empty kernel cache, since PoCL would use kernels of another method */
    int32_t signal;                     /* by which processes are ended; 0: SIGKILL */
    int32_t quick;                      /* 1: also with --quick */
} determinism_way;

extern const determinism_run determinism_runs[]; /* each list ends with a NULL name */
extern const determinism_way determinism_ways[];

const determinism_run *determinism_find(const char *name); /* or NULL */
const char *const *determinism_names(void);                /* ends with a NULL */
size_t determinism_count(void);
/* Appends the keys of a run to `sets`, after those that make the demo's world smaller. */
void determinism_take(const bench *b, const determinism_run *run, cli_list *sets);

/* -- making them (bench_determinism_run.c, in a process of bench_child.c) ----------------------------------------------- */

typedef struct determinism_job {
    const bench *b;
    const char *file; /* the run file */
    const determinism_run *run;
    const determinism_way *way;
    double usual_s; /* time of the run at once; processes are killed within it */
} determinism_job;

/* Sent through a pipe, so that it has no pointers. The hash is of 13 bytes per event: t [ns] in 8, x and y in 2 each, the
 * polarity in 1, little-endian. */
typedef struct determinism_result {
    int32_t how; /* BENCH_RAN .. BENCH_LATE */
    int32_t signal, units, cuts;
    char hash[CLI_SHA256_TEXT];
    char said[sizeof((tides_error *)0)->text];
    uint64_t events;
    double elapsed_s;
} determinism_result;

void determinism_make(const determinism_job *job, determinism_result *result);

#endif
