/* How an event file is read: options that all commands for event files have, with equal meaning. */
#ifndef CLI_READING_H
#define CLI_READING_H

#include "cli.h"

/* Texts and switches of the options; NULL and 0 where not given. */
typedef struct cli_reading {
    const char *format, *columns, *unit, *stream, *offset;
    int32_t drop_invalid, rebase;
} cli_reading;

/* Rows for a command's table of options: single ones, then groups: what a file is, and which clock is wanted. */
#define CLI_FROM(r) \
    { "--from", 0, "FORMAT", "read as this (by content)", NULL, &(r).format, NULL }
#define CLI_COLUMNS(r) \
    { "--columns", 0, "LIST", "of text and tables: t,x,y,p in the file's order, - is another", NULL, &(r).columns, NULL }
#define CLI_UNIT(r) \
    { "--unit", 0, "s|ms|us|ns", "of the file's times (by format, header or values)", NULL, &(r).unit, NULL }
#define CLI_STREAM(r) \
    { "--stream", 0, "NAME", "which, of a file with several streams of events", NULL, &(r).stream, NULL }
#define CLI_DROP_INVALID(r) \
    { "--drop-invalid", 0, NULL, "leave out events that can't be, and say how many", &(r).drop_invalid, NULL, NULL }
#define CLI_REBASE(r) \
    { "--rebase", 0, NULL, "count times, given ones too, from first frame, start or first event", &(r).rebase, NULL, NULL }
#define CLI_OFFSET(r) \
    { "--offset", 0, "SECONDS", "add this to all times", NULL, &(r).offset, NULL }
#define CLI_READING_FILE(r) CLI_FROM(r), CLI_COLUMNS(r), CLI_UNIT(r), CLI_STREAM(r), CLI_DROP_INVALID(r)
#define CLI_READING_CLOCK(r) CLI_REBASE(r), CLI_OFFSET(r)

/* Converts the options for the library's reader; CLI_GO or CLI_USAGE. */
int cli_reading_parse(const cli_command *command, const cli_reading *given, tides_event_reading *reading);

/* Prints lines on stderr, unless quiet: the columns found, the meaning of time 0, events that were left out. */
void cli_reading_tell(const cli_common *common, const char *file, const tides_event_facts *facts, int32_t rebase);

/* The meaning of time 0, such as "the first frame". */
const char *cli_zero_name(int32_t zero);

#endif
