/* Jobs on event files that several commands do. */
#ifndef CLI_EVENT_JOB_H
#define CLI_EVENT_JOB_H

#include "reading.h"

/* How the input is read, into a conversion; CLI_GO or CLI_USAGE. */
int cli_conversion_reading(const cli_command *command, const cli_reading *given, tides_event_conversion *what);

/* Converts and reports; the exit code. */
int cli_event_convert(const char *in, const char *out, const tides_event_conversion *what, const cli_common *common);

/* One line on stderr where events lost their distance in time. */
void cli_tell_collapsed(uint64_t collapsed);

/* A number of pixels from the text of `option`; CLI_GO or CLI_USAGE. */
int cli_size(const cli_command *command, const char *option, const char *text, int32_t *size);

/* The table of formats, for --help. */
void cli_help_formats(void);

/* The table of scene formats, for --help. */
void cli_help_scenes(void);

#endif
