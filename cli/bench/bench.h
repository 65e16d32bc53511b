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
    tides_filters filters;  /* likewise */
    double start, stop;     /* [s] */
    double macro_step_s;    /* greatest step of controlled stepping */
    double truth_step_s;    /* greatest step of the exact stream's first level */
    const char *image_name; /* the image's name, where it differs from the rules'; or NULL */
    tides_exact truth[BENCH_RULES];
} bench_scene;

/* The names of the built-in scenes, NULL-terminated. */
const char *const *bench_scene_names(void);
/* Makes the scene called `name`, or one of a trained .ply file with a camera in orbit. `quick`: small and short.
 * TIDES_FILE_NOT_FOUND where a built-in scene's file is missing. */
tides_status bench_scene_make(const char *name, int32_t quick, bench_scene *scene, tides_error *error);
void bench_scene_free(bench_scene *scene);
/* Sets all of a scene but its content, for scenes that aren't built in. */
void bench_lay_out(bench_scene *scene, const char *name, const char *sentence);

/* bench_parts.c: parts of the built-in scenes. */
tides_status bench_add_wall(tides_scene *scene, tides_error *error);             /* the demo's wall */
tides_status bench_add_room(tides_scene *scene, tides_error *error);             /* wall, table, balls */
tides_status bench_add_fan(tides_scene *scene, double stop, tides_error *error); /* stand, guard, and blades that turn */
/* A ball of `radius` that moves at `speed` [m/s] along x and is at `centre` halfway to `stop`. */
tides_status bench_add_flying_ball(tides_scene *scene, const double centre[3], double radius, double speed, double stop,
                                   tides_error *error);
/* A disc with sectors in two colours that turns about its axis, which is z. */
tides_status bench_add_turning_disc(tides_scene *scene, const double centre[3], double radius, double turns_per_s, double stop,
                                    tides_error *error);

/* bench_periodic.c: objects that return to their state within a step. */
enum { BENCH_WAVES = 2 };
typedef struct bench_vibration {
    double centre[3], quaternion[4], along[3];      /* place, rotation, direction of the motion */
    double amplitude[BENCH_WAVES], hz[BENCH_WAVES]; /* [m]; 0: none */
} bench_vibration;
tides_status bench_vibrating_path(const bench_vibration *vibration, double stop, tides_trajectory **path, tides_error *error);
/* Adds a textured plane at rest. _vibrating_ball: a ball that swings. _lit_plane: a plane under a lamp. */
tides_status bench_add_plane(tides_scene *scene, int64_t gaussians, tides_error *error);
tides_status bench_add_vibrating_ball(tides_scene *scene, const bench_vibration *vibration, double radius, double stop,
                                      tides_error *error);
typedef struct bench_lamp {
    double centre[3], scale; /* of the plane */
    int64_t gaussians;       /* of the plane, about */
    double hz, depth;        /* light is 1 + depth sin(2 pi hz t), by keyframes */
} bench_lamp;
tides_status bench_add_lit_plane(tides_scene *scene, const bench_lamp *lamp, double stop, tides_error *error);

/* -- measured runs (bench_run.c) -------------------------------------------------------------------------------------- */

/* Settings that every run of a benchmark needs. */
typedef struct bench {
    const cli_common *common;
    const char *directory;
    canvas_style style; /* of pictures */
    int32_t quick;
    const cli_list *rows; /* of --row */
    int32_t float_truth;  /* 1: exact streams come from the measured device: faster, good to some 10 ns */
    tides_device *device;
    tides_device_info info;
    cli_progress progress; /* only asked whether to stop */
    int32_t failed;        /* rows of bench_stability and bench_determinism that failed */
} bench;

/* One row of the results. */
typedef struct bench_row {
    char scene[64];
    const char *method, *unit, *image;
    double setting;
    double frames;     /* renders of equal steps; `renders` is less if still tiles are skipped. 0: other steps */
    double run_time_s; /* of tides_simulator_run without kernel builds; the least of `runs` */
    double all_threads_s, own_thread_s; /* processor time of the last run with kernel builds: all threads', and the caller's */
    int32_t runs;
    tides_stats stats;
    tides_match match;
    int32_t refused;    /* the device doesn't support it: it isn't in the results */
    double exact_share; /* error of the exact stream itself, as a share of the errors measured against it */
} bench_row;

typedef struct bench_rows {
    bench_row *rows;
    size_t count, capacity;
} bench_rows;

/* Appends an empty row; NULL: out of memory. */
bench_row *bench_rows_add(bench_rows *rows, tides_error *error);

/* Simulates once. Run time and statistics go to the row, events to the stream (emptied before; nullable). */
tides_status bench_simulate(bench *b, const bench_scene *scene, int32_t rules, const tides_sensor *sensor,
                            const tides_stepping *stepping, cli_stream *stream, bench_row *row, tides_error *error);
/* Runs a row again if it was short, for the least run time; else simulates and matches it against the exact stream. A row that
 * needs double precision on a device without it is left out, with a message. */
tides_status bench_measure(bench *b, const bench_scene *scene, int32_t rules, const tides_sensor *sensor,
                           const tides_stepping *stepping, bench_row *row, tides_error *error);
/* Parts of exact events that a row may switch on; without a flag a part is off, whatever the library's defaults are. */
enum { BENCH_SOLVED = 1, BENCH_BLOCKS = 2, BENCH_TOGETHER = BENCH_SOLVED | BENCH_BLOCKS };
void bench_choose_parts(tides_stepping *stepping, int32_t parts);
/* Median and quartiles, interpolated between neighbours. Sorts the values. */
void bench_quartiles(double *values, int32_t count, double *low, double *median, double *high);
/* Processor time of the process or the thread [s]. */
double bench_processor_s(int32_t all_threads);
/* Prints a line on stderr. */
void bench_say(const bench *b, const char *format, ...) CLI_PRINTF(2, 3);
void bench_say_row(const bench *b, const bench_row *row);
/* The name of an image's rules: "smooth", "inria". */
const char *bench_rules_name(int32_t rules);

/* Calls `visit` for each of the named scenes, or for all built-in ones. Scenes whose files are missing are skipped with a
 * message. */
typedef tides_status (*bench_visit)(void *user, bench *b, bench_scene *scene, tides_error *error);
tides_status bench_each_scene(bench *b, const cli_list *names, bench_visit visit, void *user, tides_error *error);

/* bench_truth.c: finds the exact stream of the scene under `rules`: steps are halved until events no longer move, or to a
 * limit. */
tides_status bench_find_truth(bench *b, bench_scene *scene, int32_t rules, tides_error *error);

/* -- the ROS 2 feed (bench_feed.c) ------------------------------------------------------------------------------------ */

/* Measures the latency of events over ROS 2, in packets of 1 ms. The caller frees `rows`: for each rate of events an object of
 * rate, packets, lost, events, seconds, and `ms`, the sorted latencies. NULL, with a message, without the Python package. */
tides_status bench_feed(const bench *b, int32_t packets, cJSON **rows, tides_error *error);

/* -- processes (bench_child.c) ---------------------------------------------------------------------------------------- */

/* How a process ended. BENCH_RAN: by itself. BENCH_REFUSED is set by the work itself, BENCH_DIED where a signal killed it. */
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

/* bench_table.c. _header: facts of the run's version and machine. bench_write: NAME.json and NAME.csv in the directory. */
cJSON *bench_header(const bench *b, const char *name);
/* `rows` (nullable) adds the verdicts. */
int32_t bench_header_scene(cJSON *header, const bench_scene *scene, const bench_rows *rows);
tides_status bench_write(const bench *b, const char *name, cJSON *header, const bench_rows *rows, tides_error *error);
/* bench_write for rows of any kind: each row has the same columns, a cell each. */
enum { BENCH_CELLS_MAX = 40 };
typedef struct bench_cell {
    const char *name, *text; /* text that contains no quotes; NULL: a number: */
    double number;           /* NaN: none */
} bench_cell;
typedef struct bench_table {
    const void *rows;
    size_t count;
    int32_t (*cells)(const void *rows, size_t index, bench_cell cells[BENCH_CELLS_MAX]); /* how many */
} bench_table;
tides_status bench_write_table(const bench *b, const char *name, cJSON *header, const bench_table *table, tides_error *error);
/* NAME.csv alone, as of now: a long run writes it as its rows end. */
tides_status bench_write_csv(const bench *b, const char *name, const bench_table *table, tides_error *error);
tides_status bench_path(const bench *b, const char *name, const char *ending, char *path, size_t size, tides_error *error);

/* bench_summary.c: run time and renders that a method needs for a target, interpolated between its settings. */
typedef struct bench_need {
    double run_time_s, renders, frames, mismatch_percent; /* frames: renders without skipping still tiles */
    int32_t bound; /* 0: interpolated; 1: at most this, the cheapest setting does; -1: above this, the finest doesn't */
} bench_need;
enum { BENCH_P95 = 0, BENCH_MEDIAN = 1 };
/* 0 where the method has no row. */
int32_t bench_needed(const bench_rows *rows, const char *scene, const char *method, int32_t measure, double target_us,
                     bench_need *need);
/* Prints what each method needs on a scene for p95 <= 2 us and a median of 0.05 us, and whether estimates held. */
void bench_summary(const bench_rows *rows, const char *scene, FILE *out);

/* bench_verdict.c */
#define BENCH_EXACT_SHARE 0.01         /* the exact stream is a hundred times better than what is measured by it (DESIGN 7) */
#define BENCH_MISMATCH_TOLERANCE 0.003 /* tolerance of the row of the cubic alone */
#define BENCH_DEFAULT_TOLERANCE 0.1    /* and of the default, which looks events up */
#define BENCH_MISMATCH_PERCENT 0.01    /* greatest share of events without a counterpart */
typedef struct bench_verdict {
    int32_t rows, estimated, honest;
    int32_t of_image[BENCH_RULES],
        within_share[BENCH_RULES]; /* runs on an image; those for which its exact stream is good enough */
    double exact_share[BENCH_RULES], worst_residual;
    double mismatch_percent, default_mismatch_percent; /* NaN without a row at that tolerance */
} bench_verdict;
/* 1 where median, p95 and p99 of the true errors don't exceed the run's own estimates; 0 where one does; -1 where the run made
 * no estimate, or no event was matched. */
int32_t bench_is_honest(const bench_row *row);
/* The error of the exact stream, by its last refinement, over the errors measured against it: the greatest share at median, p95
 * and p99. Errors below the unit of event times count as 0. */
double bench_exact_share(const tides_exact *truth, const tides_match *match);
bench_verdict bench_judge(const bench_rows *rows, const char *scene);
void bench_print_verdict(const bench_rows *rows, const char *scene, FILE *out);

/* bench_run.c: a benchmark of measured runs: scene by scene, then its files, its picture and its summary. */
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

/* bench_figure.c: pictures of the rows. A canvas whose first line has the version, the device and `what`; it is wider than
 * asked for if the line needs that. rgb is NULL: out of memory. */
cli_canvas bench_canvas(const bench *b, int32_t width, int32_t height, const char *what);
/* Writes NAME.png, and the format of --pictures, and frees the canvas. */
tides_status bench_write_canvas(const bench *b, cli_canvas *canvas, const char *name, tides_error *error);
tides_status bench_figure_curves(const bench *b, const bench_rows *rows, tides_error *error);
tides_status bench_figure_bars(const bench *b, const bench_rows *rows, tides_error *error);

/* Run time of a frame with L and L_dot in each of the images [s]: the least of many, taken in turns. */
tides_status bench_frame_costs(bench *b, const bench_scene *scene, const tides_image_params *images, size_t count,
                               double *seconds, tides_error *error);

/* bench_pairs.c: runs with settings, each after a run with the first case's settings. */
enum { BENCH_SETTINGS_MAX = 4, BENCH_PAIRS = 9 };
typedef struct bench_case {
    const char *name, *group;
    const char *settings[BENCH_SETTINGS_MAX]; /* as with --set; ends with NULL */
} bench_case;
typedef struct bench_timed {
    double run, all_threads, own_thread; /* [s] */
} bench_timed;
typedef struct bench_pairs {
    bench_timed with[BENCH_PAIRS], without[BENCH_PAIRS];
} bench_pairs;

/* Cost of a case in a scene: its runs against those of the first case, in turns. */
typedef struct bench_cost {
    char scene[64];
    const char *block, *group; /* such as "mismatch" of "comparator" */
    char settings[128];        /* keys of the run file, separated by spaces */
    int32_t runs;
    double run_time_s, processor_s;      /* medians; the latter of all threads */
    double ratio, ratio_low, ratio_high; /* processor time over that without: median and quartiles */
    double run_ratio;                    /* likewise of run time: median */
    double ns, ns_low, ns_high; /* [ns] additional time per pixel and step of the thread that runs the sensor, likewise */
    double steps, pixel_steps;
    double spent_s; /* time spent in its runs and the first case's */
    tides_stats stats;
} bench_cost;
void bench_pairs_begin(const bench_scene *scene, const bench_case *of, bench_cost *cost);
/* Numbers of pairs: as many of each case as bench_pairs has room for, or at least 2 if they take longer than `enough_s`. */
typedef struct bench_plan {
    const bench_case *cases;
    size_t count;
    double enough_s, enough_quick_s;
    tides_stepping stepping;
} bench_plan;
tides_status bench_pairs_measure(bench *b, const bench_scene *scene, const bench_plan *plan, bench_pairs *p, bench_cost *costs,
                                 tides_error *error);
/* Medians and quartiles; the caller sets cost->pixel_steps. */
void bench_pairs_judge(const bench_pairs *p, bench_cost *cost);
/* bench_blocks_figure.c: blocks.png, of nanoseconds; sensors.png, of ratios. */
tides_status bench_figure_costs(const bench *b, const bench_cost *costs, size_t count, tides_error *error);
tides_status bench_figure_ratios(const bench *b, const bench_cost *costs, size_t count, tides_error *error);

/* bench_accuracy.c, bench_ablation.c, bench_blocks.c and others. */
tides_status bench_accuracy(bench *b, const cli_list *scenes, tides_error *error);
tides_status bench_ablation(bench *b, const cli_list *scenes, tides_error *error);
tides_status bench_blocks(bench *b, const cli_list *scenes, tides_error *error);
tides_status bench_sensors(bench *b, const cli_list *scenes, tides_error *error);
tides_status bench_live(bench *b, const cli_list *scenes, tides_error *error);
tides_status bench_throughput(bench *b, const cli_list *scenes, tides_error *error);
/* Benchmarks of axes, rows or runs, not of scenes. They open devices in processes of their own. */
tides_status bench_scaling(bench *b, const cli_list *axes, tides_error *error);
tides_status bench_stability(bench *b, const cli_list *rows, tides_error *error);
tides_status bench_determinism(bench *b, const cli_list *rows, tides_error *error);

#endif
