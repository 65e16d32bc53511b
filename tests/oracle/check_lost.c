/* check_lost: the library's events against the oracle's on random scenes of the hard kinds (issue 38). Prints a line for each
 * scene, a summary, and whether each criterion holds. 34 scenes have 2.2 million events and take four minutes on one core.
 *
 *   --kind NAME   scenes of one kind; --list names them      --dump     each event that is lost or false
 *   --trials N    number of scenes (TIDES_TRIALS, 500)       --finer N  the oracle against itself, N times as many samples
 *   --seed N      the first one's seed (TIDES_SEED, 1)       --images N the oracle's L against the library's, at N times
 *   --device NAME the library's device (cpu)                 --share X  factor on images' width (1)
 *   --solve off|auto, --tolerance X, --step S  settings of the library's run
 *   --jobs N      processes (2)                              --brute N  the oracle against 50 ns samples of N pixels
 *   --transfer linear|srgb  how colours code light (TIDES_TRANSFER, linear) */
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
    const int kind = oracle_world_named(name);
    if (kind >= 0) return kind;
    fprintf(stderr, "check_lost: no kind '%s': --list names them\n", name);
    exit(2);
}

static int list_kinds(void) {
    for (int k = 0; k < oracle_world_kinds(); k++) puts(oracle_world_name(k));
    return 0;
}

static int32_t solve_named(const char *name) { return strcmp(name, "off") == 0 ? TIDES_SOLVE_OFF : TIDES_SOLVE_AUTO; }

static int is_srgb(const char *transfer) {
    if (strcmp(transfer, "srgb") == 0 || strcmp(transfer, "linear") == 0) return strcmp(transfer, "srgb") == 0;
    fprintf(stderr, "check_lost: no transfer '%s': linear and srgb are there\n", transfer);
    exit(2);
}

/* Stores an option that takes a value; 0 if no such option exists. */
static int read_option(options *o, const char *name, const char *value) {
    const struct {
        const char *name;
        int *number;
    } numbers[] = {{"--trials", &o->trials},
                   {"--jobs", &o->jobs},
                   {"--finer", &o->trial.finer},
                   {"--images", &o->trial.images},
                   {"--brute", &o->trial.brute}};
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
        if (strcmp(name, numbers[k].name) == 0) {
            *numbers[k].number = atoi(value);
            return 1;
        }
    if (strcmp(name, "--kind") == 0)
        o->kind = kind_named(value);
    else if (strcmp(name, "--seed") == 0)
        o->seed = strtoull(value, NULL, 10);
    else if (strcmp(name, "--device") == 0)
        o->trial.device = value;
    else if (strcmp(name, "--share") == 0)
        o->trial.share = atof(value);
    else if (strcmp(name, "--solve") == 0)
        o->trial.stepping.solve = solve_named(value);
    else if (strcmp(name, "--tolerance") == 0)
        o->trial.stepping.tolerance = atof(value);
    else if (strcmp(name, "--transfer") == 0)
        o->trial.coded = is_srgb(value);
    else if (strcmp(name, "--step") == 0)
        o->trial.stepping.step_s = atof(value);
    else
        return 0;
    return 1;
}

static void read_options(options *o, int argc, char **argv) {
    const char *kind = getenv("TIDES_KIND");
    if (kind && *kind) o->kind = kind_named(kind);
    const char *transfer = getenv("TIDES_TRANSFER");
    if (transfer && *transfer) o->trial.coded = is_srgb(transfer);
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--list") == 0) exit(list_kinds());
        if (strcmp(argv[i], "--dump") == 0)
            o->trial.dump = 1;
        else if (i + 1 < argc && read_option(o, argv[i], argv[i + 1]))
            i++;
        else {
            fprintf(stderr, "check_lost: %s: no such option, or it needs a value\n", argv[i]);
            exit(2);
        }
    }
}

int main(int argc, char **argv) {
    options o = {trial_defaults(), -1, (int)number_of("TIDES_TRIALS", SCENES), 2, number_of("TIDES_SEED", 1)};
    setvbuf(stdout, NULL, _IOLBF, 0);
    read_options(&o, argc, argv);
    if (o.trials < 1 || o.jobs < 1) return 2;
    trial_result *results = calloc((size_t)o.trials, sizeof *results);
    if (!results) return 2;
    const int finished = trial_run_all(&o.trial, o.kind, o.seed, o.trials, o.jobs, results);
    const int failed = trial_sum_up(&o.trial, results, finished) + (finished < o.trials);
    if (finished < o.trials) printf("%d scenes have no result\n", o.trials - finished);
    free(results);
    return failed ? 1 : 0;
}
