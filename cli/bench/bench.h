/* `tides bench`: scenes, measured runs, tables and pictures.
 *
 * A run's events are compared with the scene's exact stream. This is the scene's events from steps so short that halving them
 * moves no event by more than 1 ns, or from the shortest steps that a limit allows (tides_exact_stream). A measured run is a
 * row of the results. */
#ifndef CLI_BENCH_H
#define CLI_BENCH_H

#include "cli.h"
#include "canvas.h"
#include "stream.h"

#include <stdio.h>

/* -- scenes (bench_scenes.c) ------------------------------------------------------------------------------------------ */

enum { BENCH_TRUTH_SPLIT = 8 }; /* macro_step_s over truth_step_s, for scenes that don't set truth_step_s themselves */
enum { BENCH_RULES = 2 };       /* TIDES_RULES_SMOOTH and TIDES_RULES_INRIA have exact streams; arrays are indexed by them */

typedef struct bench_scene {
    char name[64];
    const char *sentence;
    tides_scene *scene;
    tides_trajectory *camera;
    tides_intrinsics intrinsics;
    tides_image_params image;
    tides_sensor sensor;
    tides_readout readout;          /* the default one, off */
    tides_filters filters;          /* the default ones, off */
    double start, stop;             /* [s] */
    double macro_step_s;            /* macro step of runs whose steps aren't equal [s] */
    double truth_step_s;            /* longest step of a smooth image's exact stream, before the first halving [s] */
    const char *image_name;         /* the image's name in results; NULL: the name of its rules */
    tides_exact truth[BENCH_RULES]; /* exact streams, set by bench_find_truth */
} bench_scene;

/* The names of the built-in scenes, NULL-terminated. */
const char *const *bench_scene_names(void);
/* Makes the built-in scene `name`. Any other `name` is the path of a trained .ply file, which gets a camera in orbit. With
 * `quick` the scene is small and short. TIDES_FILE_NOT_FOUND if the scene's file is missing. */
tides_status bench_scene_make(const char *name, int32_t quick, bench_scene *scene, tides_error *error);
void bench_scene_free(bench_scene *scene);
/* Clears a scene and sets everything but its Gaussians and its camera, for scenes that aren't built in. */
void bench_lay_out(bench_scene *scene, const char *name, const char *sentence);

/* bench_parts.c: parts of the built-in scenes. Motions last from time 0 to `stop` [s]. */
tides_status bench_add_wall(tides_scene *scene, tides_error *error);             /* the demo's wall */
tides_status bench_add_room(tides_scene *scene, tides_error *error);             /* wall, table, balls */
tides_status bench_add_fan(tides_scene *scene, double stop, tides_error *error); /* stand, guard, and blades that turn */
/* A ball of `radius` that moves at `speed` [m/s] along x and is at `centre` halfway to `stop`. */
tides_status bench_add_flying_ball(tides_scene *scene, const double centre[3], double radius, double speed, double stop,
                                   tides_error *error);
/* A disc with sectors in two colours that turns about its axis, which is z. */
tides_status bench_add_turning_disc(tides_scene *scene, const double centre[3], double radius, double turns_per_s, double stop,
                                    tides_error *error);

/* bench_periodic.c: vibrations and lamps, whose period may be shorter than a step. */
enum { BENCH_WAVES = 2 };
typedef struct bench_vibration {
    double centre[3], quaternion[4], along[3]; /* mean place, rotation, direction of the motion */
    double amplitude[BENCH_WAVES];             /* of each sine wave [m]; 0: no such wave */
    double hz[BENCH_WAVES];
} bench_vibration;
tides_status bench_vibrating_path(const bench_vibration *vibration, double stop, tides_trajectory **path, tides_error *error);
/* bench_add_plane adds a textured plane at rest, bench_add_vibrating_ball a ball that swings, and bench_add_lit_plane a plane
 * under a lamp. */
tides_status bench_add_plane(tides_scene *scene, int64_t gaussians, tides_error *error);
tides_status bench_add_vibrating_ball(tides_scene *scene, const bench_vibration *vibration, double radius, double stop,
                                      tides_error *error);
typedef struct bench_lamp {
    double centre[3], scale; /* of the plane */
    int64_t gaussians;       /* the plane has about so many */
    double hz, depth;        /* light is 1 + depth sin(2 pi hz t + 0.7), by keyframes */
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
    int32_t float_truth;  /* 1: the measured device computes exact streams: faster, but exact only to some 10 ns */
    tides_device *device;
    tides_device_info info;
    cli_progress progress; /* tells only whether the user wants to stop */
    int32_t failed;        /* rows of bench_stability and bench_determinism that failed */
} bench;

/* One row of the results. */
typedef struct bench_row {
    char scene[64];
    const char *method, *unit, *image;
    double setting; /* in `unit` */
    /* Full frames that equal steps render if no tile is skipped; 0: the steps aren't equal. The number
     * stats.renders_full_frame_equivalent is less where tiles in which nothing moves are skipped. */
    double frames;
    double run_time_s; /* of tides_simulator_run without kernel builds; the least of `runs` */
    /* Processor time of the last run, kernel builds included: of all threads, and of the caller's thread. */
    double all_threads_s, own_thread_s;
    int32_t runs;
    tides_stats stats;  /* of the last run */
    tides_match match;  /* of the first run's events against the exact stream */
    int32_t refused;    /* 1: the device lacks what the row needs, so the row isn't in the results */
    double exact_share; /* the result of bench_exact_share */
} bench_row;

typedef struct bench_rows {
    bench_row *rows;
    size_t count, capacity;
} bench_rows;

/* Appends an empty row; NULL: out of memory. */
bench_row *bench_rows_add(bench_rows *rows, tides_error *error);

/* Simulates once, with `rules` in place of the image's own. Run time and statistics go to the row. `stream` (nullable) is
 * emptied first, and gets the events. */
tides_status bench_simulate(bench *b, const bench_scene *scene, int32_t rules, const tides_sensor *sensor,
                            const tides_stepping *stepping, cli_stream *stream, bench_row *row, tides_error *error);
/* The first call simulates a row, and matches its events with the exact stream. A later call repeats a run of at most 1 s, and
 * the row keeps the least run time. If the row needs double precision and the device has none, it is refused with a message. */
tides_status bench_measure(bench *b, const bench_scene *scene, int32_t rules, const tides_sensor *sensor,
                           const tides_stepping *stepping, bench_row *row, tides_error *error);
/* Options of stepping that a row may switch on: BENCH_SOLVED looks events up in double precision, and BENCH_BLOCKS gives each
 * 4x4 block its own steps. bench_choose_parts turns off an option without its flag, whatever the library's default is. */
enum { BENCH_SOLVED = 1, BENCH_BLOCKS = 2, BENCH_TOGETHER = BENCH_SOLVED | BENCH_BLOCKS };
void bench_choose_parts(tides_stepping *stepping, int32_t parts);
/* Sorts `values`, and finds their median and quartiles, interpolated between neighbours. */
void bench_quartiles(double *values, int32_t count, double *low, double *median, double *high);
/* Processor time [s] of all threads of the process, or of the calling thread alone. */
double bench_processor_s(int32_t all_threads);
/* Prints a line on stderr, unless --quiet is given. bench_say_row: a row's results. */
void bench_say(const bench *b, const char *format, ...) CLI_PRINTF(2, 3);
void bench_say_row(const bench *b, const bench_row *row);
/* The name of an image's rules: "smooth", "inria". */
const char *bench_rules_name(int32_t rules);

/* Calls `visit` for each of the named scenes. Without names it visits all built-in scenes, or some with --quick. Built-in
 * scenes whose files are missing are skipped with a message. */
typedef tides_status (*bench_visit)(void *user, bench *b, bench_scene *scene, tides_error *error);
tides_status bench_each_scene(bench *b, const cli_list *names, bench_visit visit, void *user, tides_error *error);

/* bench_truth.c: finds the exact stream of the scene's image under `rules`, and puts it into scene->truth[rules]. */
tides_status bench_find_truth(bench *b, bench_scene *scene, int32_t rules, tides_error *error);

/* -- the ROS 2 feed (bench_feed.c) ------------------------------------------------------------------------------------ */

/* Measures the latency of events over ROS 2, in packets of 1 ms. `*rows` is a JSON array that the caller frees. For each
 * rate of events it has an object: rate, packets, lost, events, seconds, and `ms`, the sorted latencies. `*rows` is NULL,
 * with a message and TIDES_OK, if TIDES_PYTHON names no Python or its measurement fails. */
tides_status bench_feed(const bench *b, int32_t packets, cJSON **rows, tides_error *error);

/* -- processes (bench_child.c) ---------------------------------------------------------------------------------------- */

/* How a process ended. A work may also put these values into its result, and BENCH_REFUSED occurs only there. */
enum {
    BENCH_RAN,     /* with a result */
    BENCH_REFUSED, /* with an error instead of a result */
    BENCH_STOPPED, /* killed because the user stopped the benchmark */
    BENCH_DIED,    /* without a result, by a signal or an exit */
    BENCH_LATE     /* killed at its time limit */
};
typedef struct bench_ending {
    int32_t how;  /* BENCH_RAN and others */
    int32_t died; /* of BENCH_DIED: the signal; 0 and below: an exit, with the code -died */
} bench_ending;

/* Says how a process of BENCH_DIED ended. */
enum { BENCH_DEATH = 48 };
void bench_say_death(int32_t died, char text[BENCH_DEATH]);

/* Runs work(user, result) in a child process, for `limit_s` at most. The result comes back through a pipe, so it must have no
 * pointers. It is complete only if `ending` is BENCH_RAN. */
typedef void (*bench_work)(void *user, void *result);
tides_status bench_child(bench *b, bench_work work, void *user, void *result, size_t size, double limit_s, bench_ending *ending,
                         tides_error *error);
/* Puts the facts of the device that `b` names into b->info. A child process opens the device, so that the calling process gets
 * none of the driver's threads. */
tides_status bench_ask_device(bench *b, tides_error *error);

/* -- results ---------------------------------------------------------------------------------------------------------- */

/* bench_table.c. bench_header: an object with the version of TIDES, the device, the machine and the date. NULL: out of
 * memory. */
cJSON *bench_header(const bench *b, const char *name);
/* Adds a scene's facts to the header's list of scenes, with its bench_verdict if `rows` isn't NULL. 0: out of memory. */
int32_t bench_header_scene(cJSON *header, const bench_scene *scene, const bench_rows *rows);
/* Writes NAME.json and NAME.csv into the benchmark's directory. */
tides_status bench_write(const bench *b, const char *name, cJSON *header, const bench_rows *rows, tides_error *error);
/* Rows of any kind, for bench_write_table. Each row has the same columns, and a cell in each. */
enum { BENCH_CELLS_MAX = 40 };
typedef struct bench_cell {
    const char *name, *text; /* text without quotation marks; NULL: the cell is `number` */
    double number;           /* NaN: the cell is empty */
} bench_cell;
typedef struct bench_table {
    const void *rows;
    size_t count;
    int32_t (*cells)(const void *rows, size_t index, bench_cell cells[BENCH_CELLS_MAX]); /* returns the number of cells */
} bench_table;
tides_status bench_write_table(const bench *b, const char *name, cJSON *header, const bench_table *table, tides_error *error);
/* NAME.csv alone, as of now: a long run writes it as its rows end. */
tides_status bench_write_csv(const bench *b, const char *name, const bench_table *table, tides_error *error);
/* Writes the path of the file NAME with `ending` in the benchmark's directory to `path`. */
tides_status bench_path(const bench *b, const char *name, const char *ending, char *path, size_t size, tides_error *error);

/* bench_summary.c: run time and renders that a method needs for a target, interpolated between its settings. */
typedef struct bench_need {
    double run_time_s, renders, frames, mismatch_percent; /* frames: as in bench_row; `renders` if the steps aren't equal */
    /* 0: interpolated. 1: an upper bound, because the cheapest setting already meets the target. -1: a lower bound, because
     * even the finest setting misses it. */
    int32_t bound;
} bench_need;
enum { BENCH_P95 = 0, BENCH_MEDIAN = 1 };
/* Finds what `method` needs for an error of `target_us` at p95 or the median (`measure`). 0: the method has no row of the
 * scene. */
int32_t bench_needed(const bench_rows *rows, const char *scene, const char *method, int32_t measure, double target_us,
                     bench_need *need);
/* Prints what each method needs on a scene for p95 <= 2 us and a median of 0.05 us, and whether estimates held. */
void bench_summary(const bench_rows *rows, const char *scene, FILE *out);

/* bench_verdict.c */
#define BENCH_EXACT_SHARE 0.01         /* greatest exact_share of an exact stream that is good enough (DESIGN 7) */
#define BENCH_MISMATCH_TOLERANCE 0.003 /* [thresholds] of the judged row of method "error", which looks no events up */
#define BENCH_DEFAULT_TOLERANCE 0.1    /* [thresholds] of method "default", which looks events up */
#define BENCH_MISMATCH_PERCENT 0.01    /* greatest share of events without a counterpart [%] */
typedef struct bench_verdict {
    int32_t rows, estimated, honest;   /* rows; rows that estimate their errors; rows whose errors keep to the estimates */
    int32_t of_image[BENCH_RULES];     /* rows of the image with these rules */
    int32_t within_share[BENCH_RULES]; /* of them, rows with an exact_share of at most BENCH_EXACT_SHARE */
    double exact_share[BENCH_RULES], worst_residual; /* the greatest of the rows */
    double mismatch_percent;         /* of method "error" at BENCH_MISMATCH_TOLERANCE; NaN: there is no such row */
    double default_mismatch_percent; /* of method "default"; NaN: there is no such row */
} bench_verdict;
/* 1 where median, p95 and p99 of the true errors don't exceed the run's own estimates, or 1 ns; 0 where one does; -1 where the
 * run made no estimate, or no event was matched. */
int32_t bench_is_honest(const bench_row *row);
/* The exact stream's own error over the error measured with it: the greatest ratio at median, p95 and p99. The own error is the
 * time by which the last halving of the exact stream's steps moved its events. Up to 1 ns, the unit of event times, it counts
 * as 0. */
double bench_exact_share(const tides_exact *truth, const tides_match *match);
/* Judges a scene's rows. bench_print_verdict prints the verdict. */
bench_verdict bench_judge(const bench_rows *rows, const char *scene);
void bench_print_verdict(const bench_rows *rows, const char *scene, FILE *out);

/* bench_run.c: a benchmark of measured runs. bench_fill_sheet visits scene by scene, writes the files and the picture, and
 * prints the summary. */
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

/* bench_figure.c: pictures of the rows. bench_canvas: a canvas whose first line has the version, the device and `what`. It is
 * wider than `width` if the line needs that. A failure is reported when the canvas is written. */
cli_canvas bench_canvas(const bench *b, int32_t width, int32_t height, const char *what);
/* Writes NAME.png, and NAME in the format of --pictures if there is one, and frees the canvas. */
tides_status bench_write_canvas(const bench *b, cli_canvas *canvas, const char *name, tides_error *error);
/* accuracy_time.png and accuracy_renders.png, a curve for each method; ablation.png, a bar for each row. */
tides_status bench_figure_curves(const bench *b, const bench_rows *rows, tides_error *error);
tides_status bench_figure_bars(const bench *b, const bench_rows *rows, tides_error *error);

/* bench_pairs.c: costs of settings. A case is a list of settings, and the plan's cases[0] is the base. A pair is a run of the
 * base, and then a run of a case. */
enum { BENCH_SETTINGS_MAX = 4, BENCH_PAIRS = 9 };
typedef struct bench_case {
    const char *name, *group;
    const char *settings[BENCH_SETTINGS_MAX]; /* as with --set; ends with NULL */
} bench_case;
typedef struct bench_timed {
    double run, all_threads, own_thread; /* [s] */
} bench_timed;
typedef struct bench_pairs {
    bench_timed with[BENCH_PAIRS], without[BENCH_PAIRS]; /* the case's runs, and the base's */
} bench_pairs;

/* Cost of a case in a scene, from its pairs. */
typedef struct bench_cost {
    char scene[64];
    const char *block, *group;           /* name and group of the case, such as "mismatch" of "comparator" */
    char settings[128];                  /* of the case, as with --set, separated by spaces */
    int32_t runs;                        /* number of pairs */
    double run_time_s, processor_s;      /* of the case's runs: medians; processor time is of all threads */
    double ratio, ratio_low, ratio_high; /* processor time over the base's in the same pair: median and quartiles */
    double run_ratio;                    /* run time over the base's in the same pair: median */
    /* Additional processor time of the caller's thread, which runs the sensor, per pixel and step [ns]: median, quartiles. */
    double ns, ns_low, ns_high;
    double steps, pixel_steps; /* steps of a run; steps times pixels */
    double spent_s;            /* run time of all pairs */
    tides_stats stats;         /* of the case's last run */
} bench_cost;
/* Clears `cost`, and sets its names and settings. */
void bench_pairs_begin(const bench_scene *scene, const bench_case *of, bench_cost *cost);
/* The cases to measure. Each case gets BENCH_PAIRS pairs, or 3 with --quick. A case whose pairs took longer than `enough_s`
 * (with --quick, `enough_quick_s`) gets no more pairs after its second. */
typedef struct bench_plan {
    const bench_case *cases;
    size_t count;
    double enough_s, enough_quick_s;
    tides_stepping stepping;
} bench_plan;
tides_status bench_pairs_measure(bench *b, const bench_scene *scene, const bench_plan *plan, bench_pairs *p, bench_cost *costs,
                                 tides_error *error);
/* Sets medians and quartiles from the pairs. The caller sets cost->pixel_steps before. */
void bench_pairs_judge(const bench_pairs *p, bench_cost *cost);
/* bench_blocks_figure.c: blocks.png, of nanoseconds; sensors.png, of ratios. */
tides_status bench_figure_costs(const bench *b, const bench_cost *costs, size_t count, tides_error *error);
tides_status bench_figure_ratios(const bench *b, const bench_cost *costs, size_t count, tides_error *error);

/* The benchmarks: bench_accuracy.c, bench_ablation.c, bench_blocks.c and others. */
tides_status bench_accuracy(bench *b, const cli_list *scenes, tides_error *error);
tides_status bench_ablation(bench *b, const cli_list *scenes, tides_error *error);
tides_status bench_blocks(bench *b, const cli_list *scenes, tides_error *error);
tides_status bench_sensors(bench *b, const cli_list *scenes, tides_error *error);
tides_status bench_live(bench *b, const cli_list *scenes, tides_error *error);
/* Benchmarks without a scene, which open devices in processes of their own. The list chooses rows of stability's table, or runs
 * of determinism. */
tides_status bench_stability(bench *b, const cli_list *rows, tides_error *error);
tides_status bench_determinism(bench *b, const cli_list *runs, tides_error *error);

#endif
