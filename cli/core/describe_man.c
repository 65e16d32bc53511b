/* Prints man pages, with the man(7) macros. */
#include "describe.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

/* Prints a text for roff: hyphens as typed, no escapes, no line that looks like a macro. */
static void put(const char *text) {
    int32_t fresh = 1;
    for (; *text; text++) {
        if (fresh && (*text == '.' || *text == '\'')) fputs("\\&", stdout);
        fresh = *text == '\n';
        if (*text == '\\')
            fputs("\\e", stdout);
        else if (*text == '-')
            fputs("\\-", stdout);
        else
            putchar(*text);
    }
}

static void put_upper(const char *text) {
    for (; *text; text++) putchar(toupper((unsigned char)*text));
}

/* Prints the title, without a date: the page has the tool's version. */
static void put_title(const char *name, int section) {
    fputs(".TH TIDES", stdout);
    if (name[0]) putchar('-');
    put_upper(name);
    printf(" %d \"\" \"TIDES %s\" \"TIDES\"\n.ad l\n.SH NAME\ntides%s%s \\- ", section, tides_version(), name[0] ? "\\-" : "",
           name);
}

static void put_option(const cli_option *o) {
    fputs(".TP\n", stdout);
    if (o->letter) printf("\\fB\\-%c\\fR, ", o->letter);
    fputs("\\fB", stdout);
    put(o->name);
    fputs("\\fR", stdout);
    if (o->argument) {
        fputs(" \\fI", stdout);
        put(o->argument);
        fputs("\\fR", stdout);
    }
    putchar('\n');
    put(o->help);
    putchar('\n');
}

/* Prints lines that roff doesn't join. */
static void put_lines(const char *text) {
    for (; *text; text++) {
        const size_t length = strcspn(text, "\n");
        char line[512];
        snprintf(line, sizeof line, "%.*s", (int)length, text);
        put(line);
        putchar('\n');
        text += length;
        if (!*text) return;
        fputs(".br\n", stdout);
    }
}

static void put_codes(void) {
    fputs(".SH \"EXIT STATUS\"\n0 for success, 1 for a failure, 2 for a wrong command line. Errors are one line on stderr.\n",
          stdout);
}

void describe_man_command(const cli_command *command, const cli_option *options) {
    cli_common common;
    cli_option shared[CLI_COMMON_OPTIONS];
    cli_common_options(shared, &common);
    put_title(command->name, 1);
    put(command->summary);
    printf("\n.SH SYNOPSIS\n\\fBtides %s\\fR ", command->name);
    put(command->arguments);
    fputs(" [\\fIoptions\\fR]\n.SH DESCRIPTION\n", stdout);
    put(command->summary);
    putchar('\n');
    if (command->details) {
        fputs(".PP\n", stdout);
        put_lines(command->details);
    }
    fputs(".SH OPTIONS\n", stdout);
    for (const cli_option *o = options; o->name; o++) put_option(o);
    for (size_t i = 0; i < CLI_COMMON_OPTIONS; i++) put_option(&shared[i]);
    put_codes();
    fputs(".SH \"SEE ALSO\"\n.BR tides (1),\n.BR tides\\-run (5)\n", stdout);
}

void describe_man_tool(const cli_command *commands, size_t count) {
    put_title("", 1);
    fputs("event cameras in continuous time, from dynamic Gaussian\\-splatting scenes\n"
          ".SH SYNOPSIS\n\\fBtides\\fR \\fIcommand\\fR ...\n.SH DESCRIPTION\n"
          "Renders log\\-luminance and its exact time derivative from a scene of Gaussian splats along a camera path, and "
          "solves\n"
          "for every threshold crossing in continuous time.\n.SH COMMANDS\n",
          stdout);
    for (size_t i = 0; i < count; i++) {
        printf(".TP\n\\fBtides %s\\fR ", commands[i].name);
        put(commands[i].arguments);
        putchar('\n');
        put(commands[i].summary);
        printf(" See\n.BR tides\\-%s (1).\n", commands[i].name);
    }
    fputs(".TP\n\\fBtides help\\fR [\\fIcommand\\fR]\nExplains a command. \\fB\\-\\-man\\fR [\\fIpage\\fR], \\fB\\-\\-bash\\fR "
          "and "
          "\\fB\\-\\-zsh\\fR print man pages and completions.\n"
          ".TP\n\\fBtides \\-\\-version\\fR\nPrints the version.\n",
          stdout);
    fputs(".SH ENVIRONMENT\n.TP\n.B TIDES_DEVICE\nThe device, where neither \\fB\\-\\-device\\fR nor the run file names one.\n"
          ".TP\n.B TIDES_PYTHON\nThe interpreter that has the Python package: \\fBtides bench live\\fR measures its ROS 2 "
          "feed. The "
          "package\\(aqs own \\fBtides\\fR sets it.\n"
          ".TP\n.B TIDES_THREADS\nHow many threads of the host a run has, where \\fB\\-\\-threads\\fR doesn't say; 0: as "
          "many as there are processors.\n"
          ".TP\n.B TIDES_KERNEL_DIR\nA folder to read the OpenCL kernels from, instead of those inside the library.\n",
          stdout);
    put_codes();
    fputs(".SH \"SEE ALSO\"\n.BR tides\\-run (5)\n", stdout);
}

/* -- the run file --------------------------------------------------------------------------------------------------- */

static void put_row(const tides_param *row) {
    static const char *const types[] =
        {[TIDES_PARAM_NUMBER] = "number",         [TIDES_PARAM_INTEGER] = "integer",
         [TIDES_PARAM_BOOLEAN] = "true or false", [TIDES_PARAM_STRING] = "text",
         [TIDES_PARAM_CHOICE] = "one of",         [TIDES_PARAM_VECTOR3] = "list of three numbers",
         [TIDES_PARAM_OBJECTS] = "list",          [TIDES_PARAM_VECTOR2] = "list of two numbers"};
    fputs(".TP\n\\fB", stdout);
    put(row->key);
    printf("\\fR (%s", types[row->type]);
    if (row->choices) {
        putchar(' ');
        put(row->choices);
    }
    if (row->unit[0]) {
        fputs(" [", stdout);
        put(row->unit);
        putchar(']');
    }
    if (row->lower < row->upper) {
        char range[80];
        snprintf(range, sizeof range, ", from %.10g to %.10g", row->lower, row->upper);
        put(range);
    }
    fputs("; ", stdout);
    if (row->fallback) fputs("default ", stdout);
    put(row->fallback ? row->fallback : "required");
    fputs(")\n", stdout);
    put(row->sentence);
    putchar('\n');
}

void describe_man_run(void) {
    size_t count;
    const tides_param *rows = tides_params(&count);
    const char *group = "";
    size_t length = 0;
    put_title("run", 5);
    fputs("the run file of TIDES\n.SH DESCRIPTION\n"
          "A run file is one JSON object that says what \\fBtides simulate\\fR, \\fBtides render\\fR and \\fBtides batch\\fR "
          "work on.\n"
          "A dot in a key stands for an object in an object. Paths are relative to the file. Unknown keys are errors.\n"
          "\\fB\\-\\-set\\fR \\fIkey\\fR=\\fIvalue\\fR overrides a key.\n"
          ".SH EXAMPLE\n.nf\n{ \"scene\": { \"file\": \"room.ply\" }, \"camera\": { \"file\": \"path.json\" }, \"time\": { "
          "\"stop\": 0.5 } "
          "}\n.fi\n.SH KEYS\n",
          stdout);
    for (size_t i = 0; i < count; i++) {
        const size_t here = strcspn(rows[i].key, ".");
        if (rows[i].key[here] == '\0') {
            if (group[0]) fputs(".SS The run\n", stdout);
            group = "";
        } else if (here != length || strncmp(group, rows[i].key, here) != 0) {
            group = rows[i].key;
            length = here;
            printf(".SS %.*s\n", (int)here, group);
        }
        put_row(&rows[i]);
    }
    fputs(".SH \"SEE ALSO\"\n.BR tides (1),\n.BR tides\\-simulate (1)\n", stdout);
}
