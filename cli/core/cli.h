/* Shared by the commands of `tides`: option parsing, error messages, facts, progress. The tool uses only the public
 * headers. */
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

/* A constant's value as text, for help. */
#define CLI_TEXT_OF(constant) CLI_TEXT_AS_IS(constant)
#define CLI_TEXT_AS_IS(text) #text

/* Results of parsing. CLI_OK, CLI_FAILED and CLI_USAGE are exit codes. CLI_GO: the command should run. CLI_DESCRIBED:
 * --help=KIND was answered, and the command should end. */
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

/* An option; exactly one of flag, text, list gets its value. A table of options ends with a NULL name. */
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
    int32_t positionals;   /* exact number of operands; below 0: at most so many, and missing ones are NULL */
    int (*run)(const cli_command *command, int argc, char **argv);
    int32_t no_device; /* 1: it doesn't use a device, and says so if --device is given */
};

/* The commands (cmd_*.c). argv[0] is the command's name; they return the exit code. */
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

/* options.c: parses a command line: sets the options' targets, `common`, and `positional` (command->positionals of them).
 * Returns CLI_GO, or the exit code: CLI_OK after --help, CLI_USAGE after an error. */
int cli_parse(const cli_command *command, const cli_option *options, int argc, char **argv, cli_common *common,
              const char **positional);
/* Parses a finite number of `option`; CLI_GO or CLI_USAGE. */
int cli_number(const cli_command *command, const char *option, const char *text, double *number);

/* seconds.c: rounds seconds to nanoseconds. 1e9 times the number would be off at 1e9 s. */
int64_t cli_nanoseconds(double seconds);
/* Parses seconds of `option` as nanoseconds, digit by digit; CLI_GO or CLI_USAGE. */
int cli_time(const cli_command *command, const char *option, const char *text, int64_t *ns);
/* Nanoseconds as seconds with nine decimals. */
enum { CLI_SECONDS = 24 };
const char *cli_seconds(int64_t ns, char text[CLI_SECONDS]);
/* Adds nanoseconds, or seconds, to an object, with all digits. */
void cli_add_ns(cJSON *object, const char *name, int64_t ns);
void cli_add_seconds(cJSON *object, const char *name, int64_t ns);
/* Adds a number; what isn't finite becomes null. */
void cli_add_number(cJSON *object, const char *name, double value);

/* common.c: fills in the options that every command has, which are stored to `common`. */
enum { CLI_COMMON_OPTIONS = 6 };
void cli_common_options(cli_option options[CLI_COMMON_OPTIONS], cli_common *common);

/* describe.c. cli_describe: `tides COMMAND --help=man|bash|zsh`; CLI_DESCRIBED or CLI_USAGE. cli_help_pages: `tides help
 * --man [PAGE]`, `--bash`, `--zsh`; the exit code. */
int cli_describe(const char *kind, const cli_command *command, const cli_option *options);
int cli_help_pages(const cli_command *commands, size_t count, const char *what, const char *page);

/* help.c */
void cli_help_command(const cli_command *command, const cli_option *options);
void cli_help_keys(int32_t all); /* the run file's keys: those that most runs set, or all */

/* output.c: prints "tides: ..." on stderr, one line. */
int cli_fail(const tides_error *error);                                                /* CLI_FAILED */
void cli_say(const char *format, va_list arguments, const char *end) CLI_PRINTF(1, 0); /* `end` ends the line, or goes on */
int cli_failed(const char *format, ...) CLI_PRINTF(1, 2);
int cli_usage(const cli_command *command, const char *format, ...) CLI_PRINTF(2, 3); /* CLI_USAGE */
void cli_note(const cli_common *common, const char *format, ...) CLI_PRINTF(2, 3);   /* printed with -v only */
void cli_tell_lines(const cli_common *common, const char *lines);                    /* each line as one message; not with -q */
void cli_add_notes(cJSON *facts, const char *lines); /* a list "notes", if there are any; 1023 bytes of each line */
/* Prints facts as JSON or aligned text, and deletes them. NULL: out of memory. */
int cli_print_facts(cJSON *facts, int32_t json);
/* cli_print_facts for --json and --quiet: with --quiet alone it prints nothing. */
int cli_report_facts(cJSON *facts, const cli_common *common);
/* Writes a quoted field, with quotes doubled. Others: a comma and a text, a number, or nothing. */
void cli_csv_text(FILE *file, const char *text);
void cli_csv_value(FILE *file, const cJSON *value);
/* Formats a number: 1234567 -> "1.23 M"; returns `text`. */
const char *cli_count(double number, char text[24]);
/* 1 where `path` ends in `ending` (".png"), whatever its case, and is longer. */
int cli_ends_in(const char *path, const char *ending);
/* files.c: outputs of a command. `ending` (".json") is that of the output's kind; NULL: its writer checks names. */
enum { CLI_OUTPUTS_MAX = 32 };
typedef struct cli_output {
    const char *path; /* NULL: not asked for */
    const char *ending;
} cli_output;
/* Called before anything is opened. TIDES_BAD_ARGUMENT where an output would replace `input` (nullable; a file or folder), a
 * file that the run reads, or another output, or has the ending of another kind. _folder: outputs are `names` (ended by NULL)
 * in a folder, and run may be NULL. */
tides_status cli_check_outputs(const char *input, const cli_output *outputs, size_t count, tides_error *error);
tides_status cli_check_run(const char *run, const cli_list *sets, const cli_output *outputs, size_t count, tides_error *error);
tides_status cli_check_folder(const char *run, const cli_list *sets, const char *input, const char *folder,
                              const char *const *names, tides_error *error);
/* Makes a directory; an existing one is fine. */
tides_status cli_make_directory(const char *directory, tides_error *error);
/* Writes a file as tides_file_write does. `put` writes `what`; cli_write_text: a text and the end of its line. */
typedef void (*cli_writer)(FILE *file, const void *what);
tides_status cli_write_file(const char *path, cli_writer put, const void *what, tides_error *error);
/* All bytes of a file, and a 0 behind them; the caller frees them. NULL where it can't be read. */
char *cli_read_file(const char *path, size_t *size);
tides_status cli_write_text(const char *path, const char *text, tides_error *error);
/* Fills an error the way the library does. */
tides_status cli_error(tides_error *error, tides_status status, const char *format, ...) CLI_PRINTF(3, 4);
#ifdef __clang_analyzer__ /* for clang's analyzer, which doesn't follow variadic functions: they return `status` */
#define cli_error(error, status, ...) ((void)cli_error(error, status, __VA_ARGS__), (status))
#endif

/* sort.c: sorts numbers, none of which is NaN. */
void cli_sort(double *values, size_t count);

/* progress.c: a tides_progress for stderr: a bar on a terminal, else a line for each 10 %; nothing for work under a second. It
 * must be zeroed; set quiet, and events where they are counted. cli_progress_end clears the bar. */
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
