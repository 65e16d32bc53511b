/* tides view -o OUT.html: a page to look at events. */
#ifndef CLI_VIEW_PAGE_H
#define CLI_VIEW_PAGE_H

#include "recording.h"

/* Writes the page of a stretch and prints a summary; returns the exit code. `most` is the text of --max-events, or NULL. */
int view_page(const cli_command *command, const cli_stretch *stretch, const char *most, const char *out,
              const cli_common *common);

#endif
