/* `tides bench`: scenes, measured runs against exact streams, tables and pictures. */
#ifndef CLI_BENCH_H
#define CLI_BENCH_H

#include "cli.h"
#include "canvas.h"
#include "stream.h"

#include <stdio.h>

/* -- scenes (bench_scenes.c) ------------------------------------------------------------------------------------------ */

enum { BENCH_TRUTH_SPLIT = 8 }; /* first steps of an exact stream per longest step, where no scene asks for more */
enum { BENCH_RULES = 2 };       /* TIDES_RULES_SMOOTH and TIDES_RULES_INRIA have exact streams */

typedef struct bench_scene {
    char name[64];
    const char *sentence;
    tides_scene *scene;
    tides_trajectory *camera;
    tides_intrinsics intrinsics;
    tides_image_params image;
    tides_sensor sensor;
    tides_readout readout;  /* the default one, off */
    double start, stop;     /* [s] */
    double macro_step_s;    /* the longest step that controlled stepping may take */
    double truth_step_s;    /* the longest that the exact stream's first level may take */
    const char *image_name; /* of another image than the rules' own, or NULL */
    tides_exact truth[BENCH_RULES];
} bench_scene;

/* The names of the built-in scenes, NULL-terminated. */
const char *const *bench_scene_names(void);
/* Makes the scene called `name`, or one of a trained .ply file that is looked at from a camera in orbit. `quick`: small and
 * short. A built-in scene whose file isn't there is TIDES_FILE_NOT_FOUND. */
tides_status bench_scene_make(const char *name, int32_t quick, bench_scene *scene, tides_error *error);
void bench_scene_free(bench_scene *scene);
/* All but what is to be seen, for scenes that aren't built in. */
void bench_lay_out(bench_scene *scene, const char *name, const char *sentence);

/* bench_parts.c: what the built-in scenes are made of. */
tides_status bench_add_wall(tides_scene *scene, tides_error *error);             /* the demo's wall */
tides_status bench_add_room(tides_scene *scene, tides_error *error);             /* wall, table, balls */
tides_status bench_add_fan(tides_scene *scene, double stop, tides_error *error); /* stand, guard, and blades that turn */
/* A ball of `radius` that moves at `speed` [m/s] along x and is at `centre` halfway to `stop`. */
tides_status bench_add_flying_ball(tides_scene *scene, const double centre[3], double radius, double speed, double stop,
                                   tides_error *error);
/* A disc with sectors in two colours that turns about its axis, which is z. */
tides_status bench_add_turning_disc(tides_scene *scene, const double centre[3], double radius, double turns_per_s, double stop,
                                    tides_error *error);

/* bench_periodic.c: what comes back within a step. */
enum { BENCH_WAVES = 2 };
typedef struct bench_vibration {
    double centre[3], quaternion[4], along[3];      /* where, how it is turned, and the direction that it moves in */
    double amplitude[BENCH_WAVES], hz[BENCH_WAVES]; /* [m]; 0 where there are fewer */
} bench_vibration;
tides_status bench_vibrating_path(const bench_vibration *vibration, double stop, tides_trajectory **path, tides_error *error);
/* A textured plane at rest; a ball that goes to and fro before it. */
tides_status bench_add_plane(tides_scene *scene, int64_t gaussians, tides_error *error);
tides_status bench_add_vibrating_ball(tides_scene *scene, const bench_vibration *vibration, double radius, double stop,
                                      tides_error *error);
typedef struct bench_lamp {
    double centre[3], scale; /* of the plane that it lights */
    int64_t gaussians;       /* that plane's, about */
    double hz, depth;        /* light is 1 + depth sin, on keyframes */
} bench_lamp;
tides_status bench_add_lit_plane(tides_scene *scene, const bench_lamp *lamp, double stop, tides_error *error);

/* -- measured runs (bench_run.c) -------------------------------------------------------------------------------------- */

/* Settings that every run of a benchmark needs. */
typedef struct bench {
    const cli_common *common;
    const char *directory;
    canvas_style style; /* of pictures */
    int32_t quick;
    int32_t float_truth; /* exact streams from the device that is measured: quicker, good to some 10 ns */
    tides_device *device;
    tides_device_info info;
    cli_progress progress; /* only asked whether to stop */
    int32_t failed;        /* rows of bench_stability and bench_determinism that do */
} bench;

/* One row of the results. */
typedef struct bench_row {
    char scene[64];
    const char *method, *unit, *image;
    double setting;
    double frames;     /* times that equal steps ask for; `renders` is less where still tiles are skipped. 0: other steps */
    double run_time_s; /* of tides_simulator_run without kernel builds; the better one of `runs` */
    double all_threads_s, own_thread_s; /* processor time of its last run, kernel builds too: all threads', the caller's */
    int32_t runs;
    tides_stats stats;
    tides_match match;
    int32_t refused;    /* the device can't have it: no row of the results */
    double exact_share; /* how far the exact stream itself may be off, as a share of the errors measured against it */
} bench_row;

typedef struct bench_rows {
    bench_row *rows;
    size_t count, capacity;
} bench_rows;

/* Appends an empty row; NULL: out of memory. */
bench_row *bench_rows_add(bench_rows *rows, tides_error *error);

/* Simulates once; run time and statistics go to the row, the events to the stream (emptied before; nullable). */
tides_status bench_simulate(bench *b, const bench_scene *scene, int32_t rules, const tides_sensor *sensor,
                            const tides_stepping *stepping, cli_stream *stream, bench_row *row, tides_error *error);
/* Runs a row again where it was short, for the better run time; else simulates and matches it against the truth. A row that
 * needs double precision on a device without it is left out, with a line that says so. */
tides_status bench_measure(bench *b, const bench_scene *scene, int32_t rules, const tides_sensor *sensor,
                           const tides_stepping *stepping, bench_row *row, tides_error *error);
/* The parts of exact events, which a row may have: where unset, off, whatever the library's defaults are. */
enum { BENCH_SOLVED = 1, BENCH_BLOCKS = 2, BENCH_TOGETHER = BENCH_SOLVED | BENCH_BLOCKS };
void bench_choose_parts(tides_stepping *stepping, int32_t parts);
/* Median and quartiles of measured values, between neighbours; puts them in order. */
void bench_quartiles(double *values, int32_t count, double *low, double *median, double *high);
/* A clock of the process or the thread [s]: processor time. */
double bench_processor_s(int32_t all_threads);
/* A line on stderr. */
void bench_say(const bench *b, const char *format, ...) CLI_PRINTF(2, 3);
void bench_say_row(const bench *b, const bench_row *row);
/* "smooth", "inria". */
const char *bench_rules_name(int32_t rules);

/* The scenes called for (all built-in ones where there are no names), each handed to `visit`; scenes whose files are absent are
 * skipped with a line. */
typedef tides_status (*bench_visit)(void *user, bench *b, bench_scene *scene, tides_error *error);
tides_status bench_each_scene(bench *b, const cli_list *names, bench_visit visit, void *user, tides_error *error);

/* bench_truth.c: the exact stream of the scene under `rules`, by halving steps until nothing moves, or to a limit. */
tides_status bench_find_truth(bench *b, bench_scene *scene, int32_t rules, tides_error *error);

/* -- processes (bench_child.c) ---------------------------------------------------------------------------------------- */

/* BENCH_RAN where a process ended by itself. BENCH_REFUSED is for what the work itself says. */
enum { BENCH_RAN, BENCH_REFUSED, BENCH_STOPPED, BENCH_DIED, BENCH_LATE };
typedef struct bench_ending {
    int32_t how;    /* BENCH_RAN .. */
    int32_t signal; /* that the process died of; 0: none */
} bench_ending;

/* Runs work(user, result) in a process of its own, for `limit_s` at most. */
typedef void (*bench_work)(void *user, void *result);
tides_status bench_child(bench *b, bench_work work, void *user, void *result, size_t size, double limit_s, bench_ending *ending,
                         tides_error *error);
/* Puts the facts of the device that `b` names into b->info. A process of its own queries it, so that this one has none of the
 * driver's threads. */
tides_status bench_ask_device(bench *b, tides_error *error);

/* -- results ---------------------------------------------------------------------------------------------------------- */

/* bench_table.c: what a run was made on; then NAME.json and NAME.csv below the directory. */
cJSON *bench_header(const bench *b, const char *name);
/* `rows` (nullable) adds the verdicts. */
int32_t bench_header_scene(cJSON *header, const bench_scene *scene, const bench_rows *rows);
tides_status bench_write(const bench *b, const char *name, cJSON *header, const bench_rows *rows, tides_error *error);
/* bench_write for any rows: one cell per column, the same columns in each row. */
enum { BENCH_CELLS_MAX = 40 };
typedef struct bench_cell {
    const char *name, *text; /* text without quotes; NULL: */
    double number;           /* NaN: none */
} bench_cell;
typedef struct bench_table {
    const void *rows;
    size_t count;
    int32_t (*cells)(const void *rows, size_t index, bench_cell cells[BENCH_CELLS_MAX]); /* how many */
} bench_table;
tides_status bench_write_table(const bench *b, const char *name, cJSON *header, const bench_table *table, tides_error *error);
tides_status bench_path(const bench *b, const char *name, const char *ending, char *path, size_t size, tides_error *error);

/* bench_summary.c: run time and renders that a method needs for a target, between its settings. */
typedef struct bench_need {
    double run_time_s, renders, frames, mismatch_percent; /* frames: renders without skipping still tiles */
    int32_t bound; /* 0: interpolated; 1: at most this, the cheapest setting does; -1: above this, the finest doesn't */
} bench_need;
enum { BENCH_P95 = 0, BENCH_MEDIAN = 1 };
/* 0 where there is no row of the method. */
int32_t bench_needed(const bench_rows *rows, const char *scene, const char *method, int32_t measure, double target_us,
                     bench_need *need);
/* Prints what each method needs on a scene for p95 <= 2 us and a median of 0.05 us, and how honest the estimates were. */
void bench_summary(const bench_rows *rows, const char *scene, FILE *out);

/* bench_verdict.c */
#define BENCH_EXACT_SHARE 0.01         /* the truth is a hundred times better than what is measured by it (DESIGN 7) */
#define BENCH_MISMATCH_TOLERANCE 0.003 /* of the cubic alone, and */
#define BENCH_DEFAULT_TOLERANCE 0.1    /* of the default, which looks events up: */
#define BENCH_MISMATCH_PERCENT 0.01    /* no more events than this may lack a counterpart */
typedef struct bench_verdict {
    int32_t rows, estimated, honest;
    int32_t of_image[BENCH_RULES],
        within_share[BENCH_RULES]; /* runs on an image; the ones that its exact stream is good enough for */
    double exact_share[BENCH_RULES], worst_residual;
    double mismatch_percent, default_mismatch_percent; /* NaN without a row at that tolerance */
} bench_verdict;
/* 1 where median, p95 and p99 of the true errors are no larger than the run's own estimates of them; 0 where one is; -1 where
 * the run made no estimate, or no event was matched. */
int32_t bench_is_honest(const bench_row *row);
/* The largest share that the exact stream's last refinement has in median, p95 or p99; errors below the unit of event times
 * count as 0. */
double bench_exact_share(const tides_exact *truth, const tides_match *match);
bench_verdict bench_judge(const bench_rows *rows, const char *scene);
void bench_print_verdict(const bench_rows *rows, const char *scene, FILE *out);

/* bench_run.c: a benchmark that is rows of measured runs: scene by scene, then its files, its picture and what it prints. */
typedef struct bench_sheet {
    bench_rows rows;
    cJSON *header;
} bench_sheet;
typedef struct bench_kind {
    const char *name;
    bench_visit visit; /* its user is the bench_sheet */
    tides_status (*figure)(const bench *b, const bench_rows *rows, tides_error *error);
    void (*print)(const bench_rows *rows);
} bench_kind;
tides_status bench_fill_sheet(bench *b, const bench_kind *kind, const cli_list *scenes, tides_error *error);

/* bench_figure.c: pictures of the rows. A canvas whose first line says the version, the device and `what` is seen: wider than
 * asked for where that needs it; rgb is NULL where memory ran out. */
cli_canvas bench_canvas(const bench *b, int32_t width, int32_t height, const char *what);
/* Writes NAME.png, and what --pictures says, and frees the canvas. */
tides_status bench_write_canvas(const bench *b, cli_canvas *canvas, const char *name, tides_error *error);
tides_status bench_figure_curves(const bench *b, const bench_rows *rows, tides_error *error);
tides_status bench_figure_bars(const bench *b, const bench_rows *rows, tides_error *error);

/* Run time of a frame with L and L_dot in each of the images, best of many that take turns [s]. */
tides_status bench_frame_costs(bench *b, const bench_scene *scene, const tides_image_params *images, size_t count,
                               double *seconds, tides_error *error);

/* bench_pairs.c: runs with settings, each after one with those of the first case. */
enum { BENCH_SETTINGS_MAX = 4, BENCH_PAIRS = 9 };
typedef struct bench_case {
    const char *name, *group;
    const char *settings[BENCH_SETTINGS_MAX]; /* what a user would give with --set; NULL where there are fewer */
} bench_case;
typedef struct bench_timed {
    double run, all_threads, own_thread; /* [s] */
} bench_timed;
typedef struct bench_pairs {
    bench_timed with[BENCH_PAIRS], without[BENCH_PAIRS];
} bench_pairs;

/* Cost of a case in a scene: its runs against those of the first case, taken in turns. */
typedef struct bench_cost {
    char scene[64];
    const char *block, *group; /* "mismatch" of "comparator" */
    char settings[128];        /* keys of the run file, separated by spaces */
    int32_t runs;
    double run_time_s, processor_s;      /* medians; the latter of all threads */
    double ratio, ratio_low, ratio_high; /* processor time over the one without: median and quartiles */
    double run_ratio;                    /* the same of run time: median */
    double ns, ns_low, ns_high;          /* of the thread that runs the sensor, more per pixel and step: the same [ns] */
    double steps, pixel_steps;
    double spent_s; /* in its runs and theirs */
    tides_stats stats;
} bench_cost;
void bench_pairs_begin(const bench_scene *scene, const bench_case *of, bench_cost *cost);
/* As many pairs of each case as bench_pairs has room for, or 2 at least where they take longer than `enough_s`. */
typedef struct bench_plan {
    const bench_case *cases;
    size_t count;
    double enough_s, enough_quick_s;
    tides_stepping stepping;
} bench_plan;
tides_status bench_pairs_measure(bench *b, const bench_scene *scene, const bench_plan *plan, bench_pairs *p, bench_cost *costs,
                                 tides_error *error);
/* Medians and quartiles; cost->pixel_steps is the caller's. */
void bench_pairs_judge(const bench_pairs *p, bench_cost *cost);
/* bench_blocks_figure.c: blocks.png, of the nanoseconds; sensors.png, of the ratios. */
tides_status bench_figure_costs(const bench *b, const bench_cost *costs, size_t count, tides_error *error);
tides_status bench_figure_ratios(const bench *b, const bench_cost *costs, size_t count, tides_error *error);

/* bench_accuracy.c, bench_ablation.c, bench_blocks.c; the exit code is the command's. */
tides_status bench_accuracy(bench *b, const cli_list *scenes, tides_error *error);
tides_status bench_ablation(bench *b, const cli_list *scenes, tides_error *error);
tides_status bench_blocks(bench *b, const cli_list *scenes, tides_error *error);
tides_status bench_sensors(bench *b, const cli_list *scenes, tides_error *error);
tides_status bench_live(bench *b, const cli_list *scenes, tides_error *error);
tides_status bench_throughput(bench *b, const cli_list *scenes, tides_error *error);
/* Axes, rows and runs, not scenes; all open devices by themselves, in processes of their own. */
tides_status bench_scaling(bench *b, const cli_list *axes, tides_error *error);
tides_status bench_stability(bench *b, const cli_list *rows, tides_error *error);
tides_status bench_determinism(bench *b, const cli_list *rows, tides_error *error);

#endif
