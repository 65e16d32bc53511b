/* Folders of recordings as datasets are downloaded: where frames and poses are. The times of frames are found like those of
 * frames.file.
 *
 *   ECD       images/ and images.txt; calib.txt; groundtruth.txt
 *   EDS       images/ and images_timestamps.txt; stamped_groundtruth.txt
 *   DSEC      images/left/rectified/ and images/timestamps.txt
 *   HS-ERGB   images_corrected/ and timestamp.txt in it;  BS-ERGB: images/ and timestamp.txt in it
 *   TUM-VIE, HQF  if their pictures were unpacked to .png, with a list of times beside them */
#include "recording_folder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const frame_places[] = {"images",      "images_corrected", "images/left/rectified",
                                           "images/left", "left_images",      "frames",
                                           "frame"};
static const char *const pose_places[] = {"groundtruth.txt", "stamped_groundtruth.txt", "mocap_data.txt", "poses.txt"};

static void find_frames(const char *folder, recording_folder *found) {
    for (size_t i = 0; i < sizeof frame_places / sizeof *frame_places && !found->frames[0]; i++) {
        char path[RECORDING_PATH];
        tides_frames_options options;
        tides_frames *frames = NULL;
        tides_error why;
        tides_frames_options_defaults(&options);
        if (snprintf(path, sizeof path, "%s/%s", folder, frame_places[i]) >= (int)sizeof path) continue;
        if (access(path, F_OK) != 0 || tides_frames_open(path, &options, &frames, &why) != TIDES_OK) continue;
        snprintf(found->frames, sizeof found->frames, "%s", frame_places[i]);
        found->frame_count = tides_frames_count(frames);
        tides_frames_size(frames, &found->frame_width, &found->frame_height);
        found->first_s = tides_frames_time(frames, 0);
        found->last_s = tides_frames_time(frames, found->frame_count - 1);
        tides_frames_close(frames);
    }
}

static void find_poses(const char *folder, recording_folder *found) {
    for (size_t i = 0; i < sizeof pose_places / sizeof *pose_places && !found->poses[0]; i++) {
        char path[RECORDING_PATH];
        tides_path_options options;
        tides_path made = {.trajectory = NULL};
        tides_error why;
        tides_path_options_defaults(&options);
        if (snprintf(path, sizeof path, "%s/%s", folder, pose_places[i]) >= (int)sizeof path) continue;
        if (access(path, F_OK) != 0 || tides_path_load(path, &options, &made, &why) != TIDES_OK) continue;
        snprintf(found->poses, sizeof found->poses, "%s", pose_places[i]);
        tides_trajectory_range(made.trajectory, &found->poses_first, &found->poses_last);
        tides_trajectory_destroy(made.trajectory);
    }
}

/* Reads ECD's calib.txt: fx fy cx cy k1 k2 p1 p2 k3. Its pixel centres are whole numbers; those of TIDES are at .5. */
static void find_lens(const char *folder, recording_folder *found) {
    char path[RECORDING_PATH];
    size_t size = 0;
    if (snprintf(path, sizeof path, "%s/calib.txt", folder) >= (int)sizeof path) return;
    char *text = access(path, F_OK) == 0 ? cli_read_file(path, &size) : NULL, *at = text;
    for (int32_t i = 0; text && i < RECORDING_LENS; i++) {
        char *end = NULL;
        const double value = strtod(at, &end);
        if (end == at || !isfinite(value)) break;
        found->lens[found->lens_count++] = value + (i == 2 || i == 3 ? 0.5 : 0);
        at = end;
    }
    if (found->lens_count < 4) found->lens_count = 0;
    free(text);
}

void recording_folder_look(const char *folder, recording_folder *found) {
    find_frames(folder, found);
    find_poses(folder, found);
    find_lens(folder, found);
}

tides_status recording_folder_read(const char *folder, recording_folder *found, tides_error *error) {
    memset(found, 0, sizeof *found);
    const tides_status status = tides_events_summary(folder, &found->events, error);
    if (status == TIDES_OK) recording_folder_look(folder, found);
    return status;
}

void recording_folder_lines(const recording_folder *f, char *text, size_t size) {
    const int32_t width = f->events.width ? f->events.width : f->events.right;
    const int32_t height = f->events.height ? f->events.height : f->events.bottom;
    const double first = 1e-9 * (double)f->events.first_ns, last = 1e-9 * (double)f->events.last_ns;
    size_t used = 0;
    *text = 0;
    if (!f->frames[0]) return;
    if (f->frame_width != width || f->frame_height != height)
        used += (size_t)snprintf(text, size,
                                 "frames are %dx%d px and events %dx%d: another camera took them, and their pixels aren't the "
                                 "events'\n",
                                 f->frame_width, f->frame_height, width, height);
    if (used < size && (f->first_s > last || f->last_s < first))
        snprintf(text + used, size - used,
                 "frames last from %.9g to %.9g s and events from %.9g to %.9g s: their clocks differ (frames.offset_s)\n",
                 f->first_s, f->last_s, first, last);
}

static void add_facts(const recording_folder *f, cJSON *facts) {
    if (f->frames[0]) {
        cJSON_AddStringToObject(facts, "frames_in", f->frames);
        cJSON_AddNumberToObject(facts, "frames", (double)f->frame_count);
        cJSON_AddNumberToObject(facts, "frames_width", f->frame_width);
        cJSON_AddNumberToObject(facts, "frames_height", f->frame_height);
        cJSON_AddNumberToObject(facts, "frames_first_s", f->first_s);
        cJSON_AddNumberToObject(facts, "frames_last_s", f->last_s);
        if (f->last_s > f->first_s)
            cJSON_AddNumberToObject(facts, "frames_per_second", (double)(f->frame_count - 1) / (f->last_s - f->first_s));
    }
    if (f->poses[0]) {
        cJSON_AddStringToObject(facts, "poses_in", f->poses);
        cJSON_AddNumberToObject(facts, "poses_first_s", f->poses_first);
        cJSON_AddNumberToObject(facts, "poses_last_s", f->poses_last);
    }
    if (f->lens_count) cJSON_AddItemToObject(facts, "calib", cJSON_CreateDoubleArray(f->lens, f->lens_count));
}

void recording_folder_facts(const char *folder, const tides_event_summary *summary, cJSON *facts) {
    recording_folder found = {.events = *summary};
    char text[512];
    recording_folder_look(folder, &found);
    add_facts(&found, facts);
    recording_folder_lines(&found, text, sizeof text);
    cli_add_notes(facts, text);
}
