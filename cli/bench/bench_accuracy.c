/* tides bench accuracy: run time and error of event times, for several methods at several settings. Errors are differences from
 * the exact events of the image that the method renders (smooth or inria rules). */
#include "bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SETTINGS_MAX = 10 };
enum { RATE = 0, TOLERANCE = 1, TIME_TOLERANCE = 2, LONGEST_STEP = 3 }; /* meaning of a setting */

/* A method; its settings end with 0, and --quick uses others. Methods with equal steps have local = 0: they render whole
 * frames, like simulators that compare successive frames. */
typedef struct method {
    const char *name;
    int32_t rules, mode, model, local, unit;
    double settings[SETTINGS_MAX], quick[SETTINGS_MAX];
    int32_t parts; /* parts of the solver that are on: BENCH_SOLVED (look-ups), BENCH_BLOCKS (steps by block) */
} method;

/* `esim`, `quadratic` and `hermite` take equal steps; the signal on a step is a line, a parabola or a cubic. `esim_inria` is
 * `esim` on the image of the inria rules.
 *
 * `error` limits the error of the cubic between a tile's renders, and looks nothing up. `error_time` limits the error of event
 * times instead, and `error_global` has the same steps for all tiles. `solved` is `error` with events looked up in the image,
 * `blocks` is `error` with steps for blocks of 4x4 pixels, and `together` has both. `default` is `together` at the library's
 * default tolerance.
 *
 * `risk` chooses steps by the paper's risk score r. Its setting is the longest step. A tile's step is the share kappa(r) of
 * it, from 1 at r = 0 down to 1/32 at r = 1. */
/* clang-format off */
static const method methods[] = {
    {"esim",         TIDES_RULES_SMOOTH, TIDES_STEPPING_FIXED, TIDES_MODEL_SECANT,    0, RATE,
     {500, 1000, 2000, 4000, 8000, 16000, 32000, 64000}, {2000, 4000, 16000, 32000}, 0},
    {"quadratic",    TIDES_RULES_SMOOTH, TIDES_STEPPING_FIXED, TIDES_MODEL_QUADRATIC, 0, RATE,
     {500, 1000, 2000, 4000, 8000, 16000, 32000}, {2000, 8000}, 0},
    {"hermite",      TIDES_RULES_SMOOTH, TIDES_STEPPING_FIXED, TIDES_MODEL_HERMITE,   0, RATE,
     {500, 1000, 2000, 4000, 8000, 16000}, {2000, 8000}, 0},
    {"error",        TIDES_RULES_SMOOTH, TIDES_STEPPING_ERROR, TIDES_MODEL_HERMITE,   1, TOLERANCE,
     {0.1, 0.03, 0.01, 0.005, 0.003, 0.002, 0.001}, {0.1, 0.01, 0.003}, 0},
    {"solved",       TIDES_RULES_SMOOTH, TIDES_STEPPING_ERROR, TIDES_MODEL_HERMITE,   1, TOLERANCE,
     {0.3, 0.1, 0.03, 0.01, 0.003}, {0.1, 0.01}, BENCH_SOLVED},
    {"blocks",       TIDES_RULES_SMOOTH, TIDES_STEPPING_ERROR, TIDES_MODEL_HERMITE,   1, TOLERANCE,
     {0.1, 0.03, 0.01, 0.003, 0.001}, {0.1, 0.01}, BENCH_BLOCKS},
    {"together",     TIDES_RULES_SMOOTH, TIDES_STEPPING_ERROR, TIDES_MODEL_HERMITE,   1, TOLERANCE,
     {0.3, 0.1, 0.03, 0.01, 0.003}, {0.1, 0.01}, BENCH_TOGETHER},
    {"default",      TIDES_RULES_SMOOTH, TIDES_STEPPING_ERROR, TIDES_MODEL_HERMITE,   1, TOLERANCE,
     {BENCH_DEFAULT_TOLERANCE}, {BENCH_DEFAULT_TOLERANCE}, BENCH_SOLVED | BENCH_BLOCKS},
    {"error_time",   TIDES_RULES_SMOOTH, TIDES_STEPPING_ERROR, TIDES_MODEL_HERMITE,   1, TIME_TOLERANCE,
     {1e-5, 1e-6}, {1e-5}, 0},
    {"risk",         TIDES_RULES_SMOOTH, TIDES_STEPPING_RISK,  TIDES_MODEL_HERMITE,   1, LONGEST_STEP,
     {4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4, 1.25e-4}, {1e-3, 2.5e-4}, 0},
    {"error_global", TIDES_RULES_SMOOTH, TIDES_STEPPING_ERROR, TIDES_MODEL_HERMITE,   0, TOLERANCE,
     {0.1, 0.03, 0.01}, {0.1, 0.01}, 0},
    {"esim_inria",   TIDES_RULES_INRIA,  TIDES_STEPPING_FIXED, TIDES_MODEL_SECANT,    0, RATE,
     {500, 1000, 2000, 4000, 8000, 16000, 32000, 64000}, {4000, 16000}, 0},
};
/* clang-format on */
enum { METHODS = sizeof methods / sizeof methods[0] };

static const char *const unit_names[] = {"frames/s", "tolerance", "s", "s at most"};

/* Sets every field that matters, so that the benchmark keeps its meaning when the library's defaults change. The shortest
 * step is the present default. */
static tides_stepping stepping_of(const method *m, const bench_scene *scene, double setting) {
    tides_stepping s;
    tides_stepping_defaults(&s);
    s.mode = m->mode;
    s.model = m->model;
    s.local = m->local;
    s.step_s = m->unit == RATE ? 1 / setting : m->unit == LONGEST_STEP ? setting : scene->macro_step_s;
    s.min_step_s = 1e-6;
    s.tolerance = m->unit == TOLERANCE ? setting : 1.0; /* [thresholds] so large that the time tolerance decides */
    s.time_tolerance_s = m->unit == TIME_TOLERANCE ? setting : 0;
    bench_choose_parts(&s, m->parts);
    return s;
}

/* One pass over all settings. The methods take turns, so that other load of the machine affects all alike. `first` is the row
 * of the scene's first result. The second pass (`again`) repeats short runs of the same rows, for the least run time. */
static tides_status pass(bench *b, const bench_scene *scene, bench_rows *rows, size_t first, int32_t again,
                         tides_error *error) {
    size_t at = first;
    for (size_t k = 0; k < SETTINGS_MAX; k++)
        for (size_t i = 0; i < METHODS; i++) {
            const method *m = &methods[i];
            const double setting = b->quick ? m->quick[k] : m->settings[k];
            if (!(setting > 0)) continue;
            bench_row *row = again ? &rows->rows[at] : bench_rows_add(rows, error);
            if (!row) return TIDES_NO_MEMORY;
            row->method = m->name;
            row->unit = unit_names[m->unit];
            row->setting = setting;
            row->frames = m->unit == RATE ? round(setting * (scene->stop - scene->start)) + 1 : 0;
            const tides_stepping stepping = stepping_of(m, scene, setting);
            tides_status status = bench_measure(b, scene, m->rules, &scene->sensor, &stepping, row, error);
            if (status != TIDES_OK) return status;
            at++;
        }
    return TIDES_OK;
}

static tides_status visit(void *user, bench *b, bench_scene *scene, tides_error *error) {
    bench_sheet *sheet = user;
    const size_t first = sheet->rows.count;
    tides_status status = TIDES_OK;
    for (int32_t rules = 0; rules < BENCH_RULES && status == TIDES_OK; rules++)
        status = bench_find_truth(b, scene, rules, error);
    for (int32_t again = 0; again < (b->quick ? 1 : 2) && status == TIDES_OK; again++)
        status = pass(b, scene, &sheet->rows, first, again, error);
    if (status != TIDES_OK) return status;
    if (!bench_header_scene(sheet->header, scene, &sheet->rows))
        return cli_error(error, TIDES_NO_MEMORY, "out of memory: results");
    return TIDES_OK;
}

/* Prints for each scene the run time and the renders that each method needs for a given error of event times. */
static void print_summary(const bench_rows *rows) {
    for (size_t i = 0; i < rows->count; i++)
        if (i == 0 || strcmp(rows->rows[i].scene, rows->rows[i - 1].scene) != 0)
            bench_summary(rows, rows->rows[i].scene, stdout);
}

tides_status bench_accuracy(bench *b, const cli_list *scenes, tides_error *error) {
    static const bench_kind kind = {"accuracy", visit, bench_figure_curves, print_summary};
    return bench_fill_sheet(b, &kind, scenes, error);
}
