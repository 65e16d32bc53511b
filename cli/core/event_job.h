/* Jobs on event files that several commands do. */
#ifndef CLI_EVENT_JOB_H
#define CLI_EVENT_JOB_H

#include "reading.h"

/* Sets how a conversion reads its input, from options; CLI_GO or CLI_USAGE. */
int cli_conversion_reading(const cli_command *command, const cli_reading *given, tides_event_conversion *what);

/* Converts, and prints the result; returns the exit code. */
int cli_event_convert(const char *in, const char *out, const tides_event_conversion *what, const cli_common *common);

/* Prints a line on stderr where different times became equal in the output's unit. */
void cli_tell_collapsed(uint64_t collapsed);

/* Parses a number of pixels of `option`; CLI_GO or CLI_USAGE. */
int cli_size(const cli_command *command, const char *option, const char *text, int32_t *size);

/* Prints the table of event formats, for --help. */
void cli_help_formats(void);

/* Prints the table of scene formats, for --help. */
void cli_help_scenes(void);

#endif
