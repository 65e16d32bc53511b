/* `tides bench determinism` makes each run in several ways, which must all give the same events, and compares hashes of the
 * events. */
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
    int32_t frames;                      /* 1: a method that differences frames: no pieces, saved or killed */
} determinism_run;

/* How a run is made. */
enum {
    DETERMINISM_WHOLE,  /* by one simulator in one call */
    DETERMINISM_PIECES, /* by one simulator in several calls */
    DETERMINISM_SAVED,  /* by several simulators, each of which restores the state that the one before saved */
    DETERMINISM_FILE,   /* written to an event file and read again */
    DETERMINISM_KILLED  /* by several processes, each killed, and resumed by the next */
};

typedef struct determinism_way {
    const char *name, *sentence;
    int32_t how;
    const char *device;                 /* NULL: the user's choice */
    const char *sets[4];                /* added to the run's; ends with a NULL */
    const char *variable[3], *value[3]; /* environment variables */
    int32_t units;                      /* compute units that the device must report; 0: any */
    int32_t pocl;                       /* 1: only for PoCL */
    int32_t own_kernels; /* 1: a kernel cache of its own, since PoCL's may hold kernels of another POCL_WORK_GROUP_METHOD */
    int32_t signal;      /* ends processes of DETERMINISM_KILLED; 0: SIGKILL */
    int32_t quick;       /* 1: also with --quick */
} determinism_way;

extern const determinism_run determinism_runs[]; /* each list ends with a NULL name */
extern const determinism_way determinism_ways[];

const determinism_run *determinism_find(const char *name); /* or NULL */
const char *const *determinism_names(void);                /* ends with a NULL */
size_t determinism_count(void);
/* Appends to `sets` the keys that make the demo's world smaller, and then the keys of the run. */
void determinism_take(const bench *b, const determinism_run *run, cli_list *sets);

/* -- making them (bench_determinism_run.c, in a process of bench_child.c) ----------------------------------------------- */

typedef struct determinism_job {
    const bench *b;
    const char *file; /* the run file */
    const determinism_run *run;
    const determinism_way *way;
    double usual_s; /* the least time of the run's ways so far; processes are killed within it */
} determinism_job;

/* The result goes through a pipe, so it must have no pointers. The hash is of 13 bytes per event: t [ns] in 8, x and y in 2
 * each, the polarity in 1, little-endian. */
typedef struct determinism_result {
    int32_t how;   /* BENCH_RAN and others */
    int32_t died;  /* as that of bench_ending */
    int32_t units; /* compute units of the device */
    int32_t cuts;  /* how often the run was cut: between pieces, by saving, or by a kill */
    char hash[CLI_SHA256_TEXT];
    char said[sizeof((tides_error *)0)->text]; /* the error of BENCH_REFUSED */
    uint64_t events;
    double elapsed_s;
} determinism_result;

/* Makes the job's run in its way, in the calling process. */
void determinism_make(const determinism_job *job, determinism_result *result);

#endif
