/* check_lost: the library's events against the oracle's on random scenes of the hard kinds (issue 38). A line for each scene, a
 * summary, and whether what DESIGN 3.2 promises holds.
 *
 *   --kind NAME   scenes of one kind; --list names them      --dump     each event that is lost or false
 *   --trials N    so many scenes (TIDES_TRIALS, 500)         --finer N  the oracle against itself, N times as many samples
 *   --seed N      the first one's seed (TIDES_SEED, 1)       --images N the oracle's L against the library's, at N times
 *   --device NAME the library's device (cpu)                 --share X  images X times as wide (1)
 *   --jobs N      processes (2)                              --brute N  the oracle against 50 ns samples of N pixels */
#include "tests/oracle/trial.h"
#include "tests/oracle/worlds.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SCENES = 500 };

typedef struct options {
    trial_options trial;
    int kind, trials, jobs; /* kind below 0: all in turn */
    unsigned long long seed;
} options;

static unsigned long long number_of(const char *variable, unsigned long long fallback) {
    const char *text = getenv(variable);
    return text && *text ? strtoull(text, NULL, 10) : fallback;
}

static int kind_named(const char *name) {
    for (int k = 0; k < oracle_world_kinds(); k++)
        if (strcmp(oracle_world_name(k), name) == 0) return k;
    fprintf(stderr, "check_lost: no kind '%s': --list names them\n", name);
    exit(2);
}

static int list_kinds(void) {
    for (int k = 0; k < oracle_world_kinds(); k++) puts(oracle_world_name(k));
    return 0;
}

/* An option with a value. */
static void read_option(options *o, const char *name, const char *value) {
    const char *kind = getenv("TIDES_KIND");
    if (!name) {
        if (kind && *kind) o->kind = kind_named(kind);
    } else if (!value) {
        fprintf(stderr, "check_lost: %s needs a value\n", name);
        exit(2);
    } else if (strcmp(name, "--kind") == 0) {
        o->kind = kind_named(value);
    } else if (strcmp(name, "--trials") == 0) {
        o->trials = atoi(value);
    } else if (strcmp(name, "--seed") == 0) {
        o->seed = strtoull(value, NULL, 10);
    } else if (strcmp(name, "--device") == 0) {
        o->trial.device = value;
    } else if (strcmp(name, "--finer") == 0) {
        o->trial.finer = atoi(value);
    } else if (strcmp(name, "--images") == 0) {
        o->trial.images = atoi(value);
    } else if (strcmp(name, "--brute") == 0) {
        o->trial.brute = atoi(value);
    } else if (strcmp(name, "--share") == 0) {
        o->trial.share = atof(value);
    } else if (strcmp(name, "--jobs") == 0) {
        o->jobs = atoi(value);
    } else {
        fprintf(stderr, "check_lost: no option %s\n", name);
        exit(2);
    }
}

int main(int argc, char **argv) {
    options o = {{.device = "cpu", .share = 1}, -1, (int)number_of("TIDES_TRIALS", SCENES), 2, number_of("TIDES_SEED", 1)};
    setvbuf(stdout, NULL, _IOLBF, 0);
    read_option(&o, NULL, NULL);
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--list") == 0) return list_kinds();
        if (strcmp(argv[i], "--dump") == 0) {
            o.trial.dump = 1;
        } else {
            read_option(&o, argv[i], argv[i + 1]);
            i++;
        }
    }
    if (o.trials < 1 || o.jobs < 1) return 2;
    trial_result *results = calloc((size_t)o.trials, sizeof *results);
    if (!results) return 2;
    const int finished = trial_run_all(&o.trial, o.kind, o.seed, o.trials, o.jobs, results);
    const int failed = trial_sum_up(&o.trial, results, finished) + (finished < o.trials);
    if (finished < o.trials) printf("%d scenes have no result\n", o.trials - finished);
    free(results);
    return failed ? 1 : 0;
}
