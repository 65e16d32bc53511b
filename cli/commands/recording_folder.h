/* The frames, poses and lens in a recording's folder, for `tides info` and `tides init`. */
#ifndef CLI_RECORDING_FOLDER_H
#define CLI_RECORDING_FOLDER_H

#include "cli.h"

enum { RECORDING_PATH = 4200, RECORDING_LENS = 9 /* fx fy cx cy k1 k2 p1 p2 k3 */ };

typedef struct recording_folder {
    tides_event_summary events;
    char frames[RECORDING_PATH], poses[RECORDING_PATH]; /* "" where there are none */
    size_t frame_count;
    int32_t frame_width, frame_height;
    double first_s, last_s;         /* [s] of the frames */
    double poses_first, poses_last; /* [s] */
    double lens[RECORDING_LENS];
    int32_t lens_count; /* 0: no calib.txt */
} recording_folder;

/* Reads `folder`. TIDES_FILE_NOT_FOUND where it holds no events; other parts that it lacks are left empty. */
tides_status recording_folder_read(const char *folder, recording_folder *found, tides_error *error);
/* Fills in the rest of `found`, which has only the summary of the folder's events. */
void recording_folder_look(const char *folder, recording_folder *found);
/* Adds facts of the frames, poses and lens beside the events of a folder, and their notes. `summary` is of the events. */
void recording_folder_facts(const char *folder, const tides_event_summary *summary, cJSON *facts);
/* Notes on frames that don't match the events: another camera, other times; "" for none. */
void recording_folder_lines(const recording_folder *found, char *text, size_t size);

#endif
