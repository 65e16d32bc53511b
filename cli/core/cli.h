/* Shared by the commands of `tides`: option parsing, error lines, facts, progress. The tool uses only the public headers. */
#ifndef CLI_H
#define CLI_H

#include "tides.h"

#include <cjson/cJSON.h>
#include <stdarg.h>
#include <stdio.h>

#if defined(__GNUC__)
#define CLI_PRINTF(text, first) __attribute__((__format__(__printf__, text, first)))
#else
#define CLI_PRINTF(text, first)
#endif

/* Exit codes. Two aren't: CLI_GO says that parsing went well and the command should run, CLI_DESCRIBED that --help=KIND was
 * answered and nothing more is to be said. */
/* A constant's number as text, for help. */
#define CLI_TEXT_OF(constant) CLI_TEXT_AS_IS(constant)
#define CLI_TEXT_AS_IS(text) #text

enum { CLI_OK = 0, CLI_FAILED = 1, CLI_USAGE = 2, CLI_GO = -1, CLI_DESCRIBED = -2 };

/* Options of every command. */
typedef struct cli_common {
    int32_t quiet, verbose, json, help;
    const char *device;  /* NULL: not given */
    const char *threads; /* likewise; cli_parse has put it into the environment */
} cli_common;

/* An option that may be given several times. */
enum { CLI_LIST_MAX = 256 };
typedef struct cli_list {
    const char *items[CLI_LIST_MAX];
    size_t count;
} cli_list;

/* One option; exactly one of flag, text, list is where its value goes. A table of them ends with a NULL name. */
typedef struct cli_option {
    const char *name;     /* "--output" */
    char letter;          /* 'o', or 0 */
    const char *argument; /* "FILE"; NULL for a switch */
    const char *help;
    int32_t *flag;
    const char **text;
    cli_list *list;
} cli_option;

typedef struct cli_command cli_command;
struct cli_command {
    const char *name;
    const char *arguments; /* of the usage line: "RUN.json -o EVENTS.h5" */
    const char *summary;   /* one line */
    const char *details;   /* paragraphs below the options, or NULL */
    int32_t positionals;   /* how many it takes, exactly; below 0: at most so many, and what is missing is NULL */
    int (*run)(const cli_command *command, int argc, char **argv);
    int32_t no_device; /* 1: it computes nothing on one, and says so where --device is given */
};

/* The commands (cmd_*.c): argv[0] is the command's name; the result is the exit code. */
int cmd_demo(const cli_command *command, int argc, char **argv);
int cmd_devices(const cli_command *command, int argc, char **argv);
int cmd_presets(const cli_command *command, int argc, char **argv);
int cmd_info(const cli_command *command, int argc, char **argv);
int cmd_render(const cli_command *command, int argc, char **argv);
int cmd_camera(const cli_command *command, int argc, char **argv);
int cmd_scene(const cli_command *command, int argc, char **argv);
int cmd_imu(const cli_command *command, int argc, char **argv);
int cmd_tracks(const cli_command *command, int argc, char **argv);
int cmd_frames(const cli_command *command, int argc, char **argv);
int cmd_simulate(const cli_command *command, int argc, char **argv);
int cmd_dataset(const cli_command *command, int argc, char **argv);
int cmd_convert(const cli_command *command, int argc, char **argv);
int cmd_cut(const cli_command *command, int argc, char **argv);
int cmd_view(const cli_command *command, int argc, char **argv);
int cmd_export(const cli_command *command, int argc, char **argv);
int cmd_metrics(const cli_command *command, int argc, char **argv);
int cmd_calibrate(const cli_command *command, int argc, char **argv);
int cmd_compare(const cli_command *command, int argc, char **argv);
int cmd_bench(const cli_command *command, int argc, char **argv);
int cmd_init(const cli_command *command, int argc, char **argv);
int cmd_batch(const cli_command *command, int argc, char **argv);

/* options.c: fills the options' targets, `common`, and `positional` (command->positionals of them). CLI_GO, or the exit code:
 * CLI_OK after --help was answered, CLI_USAGE after an error was printed. */
int cli_parse(const cli_command *command, const cli_option *options, int argc, char **argv, cli_common *common,
              const char **positional);
/* A finite number from the text of `option`; CLI_GO or CLI_USAGE. */
int cli_number(const cli_command *command, const char *option, const char *text, double *number);

/* seconds.c: seconds to the nearest nanosecond; exactly, as 1e9 times a time of 1e9 s isn't. */
int64_t cli_nanoseconds(double seconds);
/* Seconds from the text of `option` as nanoseconds, digit by digit; CLI_GO or CLI_USAGE. */
int cli_time(const cli_command *command, const char *option, const char *text, int64_t *ns);
/* Nanoseconds as seconds with nine decimals. */
enum { CLI_SECONDS = 24 };
const char *cli_seconds(int64_t ns, char text[CLI_SECONDS]);
/* As numbers of an object, with all their digits. */
void cli_add_ns(cJSON *object, const char *name, int64_t ns);
void cli_add_seconds(cJSON *object, const char *name, int64_t ns);

/* common.c: the options that every command takes, stored to `common`. */
enum { CLI_COMMON_OPTIONS = 6 };
void cli_common_options(cli_option options[CLI_COMMON_OPTIONS], cli_common *common);

/* describe.c: `tides COMMAND --help=man|bash|zsh`, and `tides help --man [PAGE]`, `--bash`, `--zsh`: man pages and completions.
 * CLI_DESCRIBED or CLI_USAGE; the exit code. */
int cli_describe(const char *kind, const cli_command *command, const cli_option *options);
int cli_help_pages(const cli_command *commands, size_t count, const char *what, const char *page);

/* help.c */
void cli_help_command(const cli_command *command, const cli_option *options);
void cli_help_keys(int32_t all); /* the run file's keys, from the parameter table: those that most runs set, or all */

/* output.c: "tides: ..." on stderr, one line. */
int cli_fail(const tides_error *error);                                                /* CLI_FAILED */
void cli_say(const char *format, va_list arguments, const char *end) CLI_PRINTF(1, 0); /* `end` closes or goes on */
int cli_failed(const char *format, ...) CLI_PRINTF(1, 2);
int cli_usage(const cli_command *command, const char *format, ...) CLI_PRINTF(2, 3); /* CLI_USAGE */
void cli_note(const cli_common *common, const char *format, ...) CLI_PRINTF(2, 3);   /* only with -v */
void cli_tell_lines(const cli_common *common, const char *lines);                    /* each line one; not with -q */
void cli_add_notes(cJSON *facts, const char *lines); /* as a list, "notes", where there are any; 1023 bytes of a line */
/* Prints facts as JSON, or as aligned text; deletes them. NULL facts: out of memory. */
int cli_print_facts(cJSON *facts, int32_t json);
/* cli_print_facts for --json and --quiet: with --quiet alone nothing is printed. */
int cli_report_facts(cJSON *facts, const cli_common *common);
/* A quoted field, its quotes doubled; a comma and a text, a number, or nothing. */
void cli_csv_text(FILE *file, const char *text);
void cli_csv_value(FILE *file, const cJSON *value);
/* 1234567 -> "1.23 M"; returns `text`. */
const char *cli_count(double number, char text[24]);
/* 1 where `path` is longer than `ending` (".png") and ends in it, whatever its case. */
int cli_ends_in(const char *path, const char *ending);
/* files.c: what a command writes. `ending` (".json") is of what is written; NULL: its writer knows names that fit. */
enum { CLI_OUTPUTS_MAX = 32 };
typedef struct cli_output {
    const char *path; /* NULL: not asked for */
    const char *ending;
} cli_output;
/* Before anything is opened: TIDES_BAD_ARGUMENT where an output would replace `input` (nullable; a file or folder), or what
 * the run reads, or another output, or is called like another kind of file. _folder: outputs are `names` (ended by NULL) in a
 * folder, and run may be NULL. */
tides_status cli_check_outputs(const char *input, const cli_output *outputs, size_t count, tides_error *error);
tides_status cli_check_run(const char *run, const cli_list *sets, const cli_output *outputs, size_t count, tides_error *error);
tides_status cli_check_folder(const char *run, const cli_list *sets, const char *input, const char *folder,
                              const char *const *names, tides_error *error);
/* Makes a directory; one that is there is fine. */
tides_status cli_make_directory(const char *directory, tides_error *error);
/* Writes a file as tides_file_write does: what `put` makes of `what`, or a text and the end of its line. */
typedef void (*cli_writer)(FILE *file, const void *what);
tides_status cli_write_file(const char *path, cli_writer put, const void *what, tides_error *error);
/* All bytes of a file, a 0 behind them, the caller's to free; NULL where it can't be read. */
char *cli_read_file(const char *path, size_t *size);
tides_status cli_write_text(const char *path, const char *text, tides_error *error);
/* Fills an error the way the library does. */
tides_status cli_error(tides_error *error, tides_status status, const char *format, ...) CLI_PRINTF(3, 4);
#ifdef __clang_analyzer__ /* it doesn't look into functions of any number of arguments: it is the status that comes back */
#define cli_error(error, status, ...) ((void)cli_error(error, status, __VA_ARGS__), (status))
#endif

/* sort.c: numbers without NaN, in ascending order. */
void cli_sort(double *values, size_t count);

/* progress.c: a tides_progress for stderr: a bar on a terminal, else a line for each 10 %; none for what takes under a second.
 * Zero it, set quiet, and events where they are counted; cli_progress_end clears the bar. */
typedef struct cli_progress {
    int32_t quiet;
    const uint64_t *events; /* counted so far, or NULL */
    const char *label;      /* printed before the stage, or NULL */
    char stage[48];
    double began, drawn;
    int32_t terminal, decile;
} cli_progress;
int cli_progress_step(void *progress, double fraction, const char *stage);
void cli_progress_end(cli_progress *progress);
double cli_now(void);
/* From here on Ctrl-C only makes cli_progress_step return 1; a second one ends the process. */
void cli_catch_interrupt(void);

#endif
