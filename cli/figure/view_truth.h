/* tides view of ground truth in files: .exr, .png and .npy as tides_truth_read has them. */
#ifndef CLI_VIEW_TRUTH_H
#define CLI_VIEW_TRUTH_H

#include "canvas.h"
#include "cli.h"

/* 1 where the file is to be drawn as that: by --kind, or where none is given by the file's name. */
int32_t view_is_truth(const char *kind, const char *file);

/* The whole command. The exit code. */
int view_truth(const cli_command *command, const char *file, const canvas_style *style, const char *out,
               const cli_common *common);

#endif
