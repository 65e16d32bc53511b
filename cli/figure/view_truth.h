/* tides view of ground truth files: .exr, .png and .npy, read by tides_truth_read. */
#ifndef CLI_VIEW_TRUTH_H
#define CLI_VIEW_TRUTH_H

#include "canvas.h"
#include "cli.h"

/* 1 where the file is drawn as ground truth: by --kind, or without it by the file's name. */
int32_t view_is_truth(const char *kind, const char *file);

/* Runs the whole command. Returns the exit code. */
int view_truth(const cli_command *command, const char *file, const canvas_style *style, const char *out,
               const cli_common *common);

#endif
