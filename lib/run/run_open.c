/* Opens the files that a run names: the scene with its moving objects, and the camera's path with its intrinsics; or frames.
 * It notes facts that may surprise the user. */
#include "camera/td_lens_models.h"
#include "camera/td_trajectory.h"
#include "td_folder.h"
#include "td_math.h"
#include "td_run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Formats what a path lacks: "0.0223 s at its beginning, 1.2 s at its end". */
static const char *lacking(double first, double last, double start, double stop, char text[96]) {
    const double before = first - start, after = stop - last;
    const char *between = before > 0 && after > 0 ? ", " : "";
    char head[40] = "", tail[40] = "";
    if (before > 0) snprintf(head, sizeof head, "%.4g s at its beginning", before);
    if (after > 0) snprintf(tail, sizeof tail, "%.4g s at its end", after);
    snprintf(text, 96, "%s%s%s", head, between, tail);
    return text;
}

/* Fails unless a path covers the run; `file` and `key` are for the message. */
static tides_status check_cover(const tides_run *run, const tides_trajectory *trajectory, const char *file, const char *key,
                                tides_error *error) {
    char text[96];
    double first, last, start = td_run_number(run, "time.start"), stop = td_run_number(run, "time.stop");
    tides_trajectory_range(trajectory, &first, &last);
    if (first <= start && stop <= last) return TIDES_OK;
    return td_fail(error, TIDES_OUT_OF_RANGE,
                   "%s: %s: the motion in %s covers [%.15g, %.15g] s, but the run needs [%.15g, %.15g] s; it lacks %s: change "
                   "time.start and time.stop%s",
                   run->origin, key, file, first, last, start, stop, lacking(first, last, start, stop, text),
                   strcmp(key, "camera.file") == 0
                       ? ", or camera.start_s, camera.rebase or camera.duration_s, or let it go on (camera.extrapolate)"
                   : strstr(key, "].trajectory") != NULL ? ", or start_s or duration_s beside the trajectory"
                                                         : "");
}

/* With camera.extrapolate: extends the camera's path to cover the run, and adds a note. */
static tides_status go_on(const tides_run *run, tides_trajectory **path, const char *file, char **notes, tides_error *error) {
    char text[96];
    double first, last, start = td_run_number(run, "time.start"), stop = td_run_number(run, "time.stop");
    tides_trajectory *longer = NULL;
    if (!cJSON_IsTrue(td_run_value(run, "camera.extrapolate"))) return TIDES_OK;
    tides_trajectory_range(*path, &first, &last);
    if (first <= start && stop <= last) return TIDES_OK;
    const tides_status status = td_trajectory_extend(*path, start, stop, &longer, error);
    if (status != TIDES_OK) return td_fail_within(error, status, "%s: camera.extrapolate: %s", run->origin, file);
    tides_trajectory_destroy(*path);
    *path = longer;
    return td_note(notes, error, "camera.extrapolate: %s goes on as its ends do: it lacks %s", file,
                   lacking(first, last, start, stop, text));
}

/* Adds notes about a path; `key` is the run file's key of the path. */
static tides_status note_path(const tides_run *run, const tides_path *path, const char *file, const char *key, double duration,
                              char **notes, tides_error *error) {
    const int camera = strcmp(key, "camera.file") == 0;
    tides_status status = TIDES_OK;
    for (const char *line = path->notes; *line && status == TIDES_OK;) {
        const size_t length = strcspn(line, "\n");
        status = td_note(notes, error, "%s: %s: %.*s", key, file, (int)length, line);
        line += length + (line[length] == '\n');
    }
    if (status != TIDES_OK || !path->untimed || (camera && tides_run_gives(run, "camera.duration_s"))) return status;
    return td_note(notes, error, "%s: %s: has no times: its %zu poses are spread evenly over %g s%s", key, file,
                   tides_trajectory_count(path->trajectory), duration,
                   camera ? "; camera.duration_s says how long they last" : "; duration_s beside it says how long they last");
}

/* Fails unless motions in the file's objects (from number `first` on) cover the run: an .h5 scene may hold moving objects. */
static tides_status check_motion(const tides_run *run, const tides_scene *scene, int32_t first, const char *file,
                                 const char *key, tides_error *error) {
    tides_status status = TIDES_OK;
    for (int32_t i = first; status == TIDES_OK && i < tides_scene_objects(scene); i++) {
        tides_object object;
        status = tides_scene_object(scene, i, &object, error);
        if (status == TIDES_OK && object.trajectory) status = check_cover(run, object.trajectory, file, key, error);
    }
    return status;
}

/* Adds a splat file, or a part of it (may be NULL), to the scene; errors name `key`. */
static tides_status add_file(const tides_run *run, tides_scene *scene, const char *file, const char *part,
                             const tides_trajectory *motion, double scale, const char *key, tides_error *error) {
    const int32_t first = tides_scene_objects(scene);
    tides_run_values values;
    tides_run_get(run, &values);
    values.scene_options.part = part;
    tides_status status = tides_scene_read(scene, file, &values.scene_options, motion, scale, error);
    return status == TIDES_OK ? check_motion(run, scene, first, file, key, error) : status;
}

/* Adds scene.objects[index]. */
static tides_status add_object(const tides_run *run, const cJSON *object, int index, tides_scene *scene, char **notes,
                               tides_error *error) {
    const cJSON *motion = cJSON_GetObjectItemCaseSensitive(object, "trajectory");
    const cJSON *size = cJSON_GetObjectItemCaseSensitive(object, "scale");
    char key[TD_KEY_MAX], path_key[TD_KEY_MAX];
    snprintf(key, sizeof key, "scene.objects[%d].file", index);
    snprintf(path_key, sizeof path_key, "scene.objects[%d].trajectory", index);
    tides_path path = {.trajectory = NULL};
    char *path_file = NULL;
    tides_status status = TIDES_NO_MEMORY;
    char *file = td_run_resolve(run, cJSON_GetObjectItemCaseSensitive(object, "file")->valuestring, error);
    if (!file) goto done;
    if (cJSON_IsString(motion)) {
        path_file = td_run_resolve(run, motion->valuestring, error);
        if (!path_file) goto done;
        tides_path_options options;
        td_run_object_path(object, &options);
        status = tides_path_load(path_file, &options, &path, error);
        /* the user gave the duration, so no note */
        if (cJSON_GetObjectItemCaseSensitive(object, "duration_s")) path.untimed = 0;
        if (status == TIDES_OK) status = check_cover(run, path.trajectory, path_file, path_key, error);
        if (status == TIDES_OK) status = note_path(run, &path, path_file, path_key, options.duration, notes, error);
        if (status != TIDES_OK) goto done;
    }
    const cJSON *part = cJSON_GetObjectItemCaseSensitive(object, "part");
    status = add_file(run, scene, file, cJSON_IsString(part) ? part->valuestring : NULL, path.trajectory,
                      size ? size->valuedouble : 1.0, key, error);
done:
    tides_trajectory_destroy(path.trajectory);
    free(path_file);
    free(file);
    return status;
}

/* Applies scene.duration_s, if given; a scene without motion doesn't need it. */
static tides_status set_duration(const tides_run *run, tides_scene *scene, tides_error *error) {
    if (!cJSON_IsNumber(td_run_value(run, "scene.duration_s"))) return TIDES_OK;
    if (tides_scene_set_duration(scene, td_run_number(run, "scene.duration_s")) > 0) return TIDES_OK;
    return td_fail(error, TIDES_BAD_CONFIG,
                   "%s: scene.duration_s is given, but no object of the scene moves by itself; leave it out", run->origin);
}

static tides_status open_scene(const tides_run *run, tides_scene **scene, char **notes, tides_error *error) {
    tides_scene *made = NULL;
    tides_status status = tides_scene_create(&made, error);
    if (status != TIDES_OK) return status;
    const char *file = td_run_file(run, "scene.file");
    const cJSON *part = td_run_value(run, "scene.part");
    if (file)
        status = add_file(run, made, file, cJSON_IsString(part) ? part->valuestring : NULL, NULL, 1.0, "scene.file", error);
    const cJSON *object;
    int index = 0;
    cJSON_ArrayForEach(object, td_run_value(run, "scene.objects")) {
        if (status == TIDES_OK) status = add_object(run, object, index++, made, notes, error);
    }
    if (status == TIDES_OK) status = set_duration(run, made, error);
    if (status == TIDES_OK)
        *scene = made;
    else
        tides_scene_destroy(made);
    return status;
}

enum { LARGEST_SIDE = 16384 }; /* [px] limit of camera.width and camera.height */

/* Returns the default for a value of 0, which path files have for what they don't know. */
static double given_or(double value, double otherwise) { return value > 0 || value < 0 ? value : otherwise; }

/* Takes the run's lens if it names one, otherwise the path file's: coefficients belong to their lens model. */
static tides_status merge_lens(const tides_run *run, const tides_path *file, tides_lens *merged, tides_error *error) {
    char choices[TD_LENS_WORDS];
    if (strcmp(td_run_value(run, "camera.lens")->valuestring, "file") != 0) return TIDES_OK;
    if (file->distorted)
        return td_fail(error, TIDES_BAD_CONFIG,
                       "%s: the lens of %s is no lens of TIDES, or differs from frame to frame; set camera.lens: none for a "
                       "pinhole, or %s with coefficients",
                       run->origin, td_run_file(run, "camera.file"), td_lens_choices(choices));
    for (int k = 0; k < TD_COEFFICIENTS_MAX; k++)
        if (*td_lens_at(merged, k) < 0 || *td_lens_at(merged, k) > 0)
            return td_fail(error, TIDES_BAD_CONFIG, "%s: camera.%s is given without camera.lens; set that to %s", run->origin,
                           td_lens_key[k], td_lens_choices(choices));
    *merged = file->intrinsics.lens;
    return TIDES_OK;
}

/* Scales image and lens to more or fewer pixels, with the same view. */
static void scale_view(tides_intrinsics *view, double scale) {
    const double width = fmax(1, round(scale * view->width)), height = fmax(1, round(scale * view->height));
    const double x = width / view->width, y = height / view->height;
    view->fx *= x;
    view->cx *= x;
    view->fy *= y;
    view->cy *= y;
    view->width = (int32_t)width;
    view->height = (int32_t)height;
}

/* If only one of camera.width and camera.height is given, the view is scaled to it. */
static double scale_of_one_side(const tides_intrinsics *own, const tides_intrinsics *path) {
    if (own->fx > 0 || own->fy > 0 || !(path->fx > 0) || path->width == 0 || path->height == 0) return 0;
    if (own->width && !own->height) return (double)own->width / path->width;
    return own->height && !own->width ? (double)own->height / path->height : 0;
}

/* Merges the intrinsics of run file and path file. Focal length and centre of the path file belong to its image size, so they
 * are used only if the run keeps this size, or names one side, which scales them. Two given sides could mean cropping or
 * scaling. An angle of view is valid for any size. */
static tides_status merge_intrinsics(const tides_run *run, const tides_path *file, tides_intrinsics *merged,
                                     tides_error *error) {
    tides_run_values values;
    tides_run_get(run, &values);
    const tides_intrinsics *path = &file->intrinsics;
    tides_intrinsics own = values.intrinsics, theirs = *path;
    const double one_side = scale_of_one_side(&own, path);
    if (one_side > 0) {
        scale_view(&theirs, one_side);
        own.width = theirs.width;
        own.height = theirs.height;
        path = &theirs;
    }
    if (own.width == 0) own.width = path->width;
    if (own.height == 0) own.height = path->height;
    const int32_t resized = (path->width && path->width != own.width) || (path->height && path->height != own.height);
    if (resized) theirs.fx = theirs.fy = theirs.cx = theirs.cy = 0;
    own.fx = given_or(own.fx, theirs.fx);
    if (file->field_of_view_x > 0) own.fx = given_or(own.fx, 0.5 * own.width / td_tan(0.5 * file->field_of_view_x));
    own.fy = given_or(given_or(own.fy, theirs.fy), own.fx);
    const char *missing = own.width == 0 ? "width" : own.height == 0 ? "height" : own.fx > 0 ? NULL : "fx";
    if (missing && resized)
        return td_fail(error, TIDES_BAD_CONFIG,
                       "%s: camera.%s is missing: that of %s is for %dx%d px, the run wants %dx%d; set camera.%s [px], or "
                       "camera.scale alone",
                       run->origin, missing, td_run_file(run, "camera.file"), path->width, path->height, own.width, own.height,
                       missing);
    const int32_t bit = own.width == 0 ? TIDES_VARIED_WIDTH : own.height == 0 ? TIDES_VARIED_HEIGHT : TIDES_VARIED_FX;
    if (missing && (file->varied & bit))
        return td_fail(error, TIDES_BAD_CONFIG,
                       "%s: camera.%s is missing: %s gives it differently from pose to pose; set camera.%s [px], or choose "
                       "poses "
                       "of one camera by camera.views",
                       run->origin, missing, td_run_file(run, "camera.file"), missing);
    if (missing)
        return td_fail(error, TIDES_BAD_CONFIG, "%s: camera.%s is missing: %s doesn't give it either; set camera.%s [px]",
                       run->origin, missing, td_run_file(run, "camera.file"), missing);
    if (!cJSON_IsNumber(td_run_value(run, "camera.cx"))) own.cx = given_or(theirs.cx, 0.5 * own.width);
    if (!cJSON_IsNumber(td_run_value(run, "camera.cy"))) own.cy = given_or(theirs.cy, 0.5 * own.height);
    const double scale = td_run_number(run, "camera.scale");
    if (scale < 1 || scale > 1) scale_view(&own, scale);
    if (own.width > LARGEST_SIDE || own.height > LARGEST_SIDE)
        return td_fail(error, TIDES_BAD_CONFIG, "%s: camera.scale = %g makes %dx%d px; at most %d on a side", run->origin,
                       scale, own.width, own.height, LARGEST_SIDE);
    *merged = own;
    return merge_lens(run, file, &merged->lens, error);
}

/* Finds an orbit around the contents of `scene`; the image has 640x480 px and 60 degrees unless the run says otherwise. The
 * orbit consists of whole turns from second 0 on, so that a longer run sees the same path. */
static tides_status find_orbit(const tides_run *run, const tides_scene *scene, tides_trajectory **camera,
                               tides_intrinsics *intrinsics, tides_error *error) {
    const double fx = 554.25625842204073; /* 320 / tan 30 degrees */
    const tides_path none = {.intrinsics = {.width = 640, .height = 480, .fx = fx, .fy = fx, .cx = 320, .cy = 240},
                             .field_of_view_x = 2 * td_atan2(320, fx)};
    const cJSON *up = td_run_value(run, "camera.up");
    const double turn = td_run_number(run, "camera.orbit_s"), start = td_run_number(run, "time.start");
    double own[3] = {0};
    tides_orbit orbit;
    tides_status status = merge_intrinsics(run, &none, intrinsics, error);
    if (status != TIDES_OK) return status;
    for (int i = 0; i < 3 && cJSON_IsArray(up); i++) own[i] = cJSON_GetArrayItem(up, i)->valuedouble;
    const double tangent = fmin(intrinsics->width / intrinsics->fx, intrinsics->height / intrinsics->fy);
    status = tides_scene_orbit(scene, cJSON_IsArray(up) ? own : NULL, 2 * td_atan2(0.5 * tangent, 1), &orbit, error);
    if (status != TIDES_OK) return status;
    orbit.angular_speed = 2 * TD_PI / turn;
    orbit.start = turn * floor(start / turn);
    orbit.stop = turn * ceil(td_run_number(run, "time.stop") / turn);
    orbit.start_angle = 0;
    status = tides_trajectory_create_orbit(&orbit, camera, error);
    return status == TIDES_OK ? status : td_fail_within(error, status, "%s: camera.orbit_s, camera.up", run->origin);
}

tides_status td_run_find_frame(const tides_run *run, char **file, tides_error *error) {
    static const char name[] = "dataparser_transforms.json";
    const cJSON *given = td_run_value(run, "camera.frame");
    const char *const near[] = {td_run_file(run, "camera.file"), td_run_file(run, "scene.file")};
    *file = NULL;
    if (cJSON_IsString(given) && strcmp(given->valuestring, "none") == 0) return TIDES_OK;
    if (cJSON_IsString(given)) {
        *file = td_run_resolve(run, given->valuestring, error);
        return *file ? TIDES_OK : TIDES_NO_MEMORY;
    }
    for (int i = 0; i < 2 && !*file; i++) {
        if (!near[i]) continue;
        char *beside = td_is_folder(near[i]) ? td_format(error, "%s/%s", near[i], name) : td_beside(near[i], name, error);
        if (!beside) return TIDES_NO_MEMORY;
        if (td_is_file(beside))
            *file = beside;
        else
            free(beside);
    }
    return TIDES_OK;
}

/* Sets the IMU's pose from the calibration: on the rig's body, or from the path's folder. */
static void place_imu(const tides_run *run, const tides_path *path, td_opening *opening) {
    static const double same[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    opening->has_imu = run->imu_body || path->has_imu;
    memcpy(opening->T_C_I, path->has_imu ? path->T_C_I : same, sizeof same);
    td_rig_move_imu(run, opening->T_C_I);
}

tides_status td_run_open_camera(const tides_run *run, const tides_scene *scene, tides_trajectory **camera,
                                tides_intrinsics *intrinsics, td_opening *opening, tides_error *error) {
    tides_run_values values;
    tides_run_get(run, &values);
    tides_path path = {.trajectory = NULL};
    tides_status status;
    if (values.camera_file) {
        char *frame = NULL;
        status = td_run_find_frame(run, &frame, error);
        values.path.body = run->imu_body; /* rig.file gives the cameras' poses on that body */
        values.path.frame = frame ? frame : "none";
        if (status == TIDES_OK) status = tides_path_load(values.camera_file, &values.path, &path, error);
        free(frame);
        opening->unframed = strcmp(path.format, "transforms") == 0 && !path.framed && !tides_run_gives(run, "camera.frame");
        if (status == TIDES_OK) status = go_on(run, &path.trajectory, values.camera_file, &opening->notes, error);
        if (status == TIDES_OK) status = check_cover(run, path.trajectory, values.camera_file, "camera.file", error);
        if (status == TIDES_OK) status = merge_intrinsics(run, &path, intrinsics, error);
        if (status == TIDES_OK)
            status = note_path(run, &path, values.camera_file, "camera.file", values.path.duration, &opening->notes, error);
    } else {
        status = find_orbit(run, scene, &path.trajectory, intrinsics, error);
    }
    if (status == TIDES_OK) place_imu(run, &path, opening);
    if (status == TIDES_OK) status = td_rig_mount(run, &path.trajectory, error);
    if (status == TIDES_OK)
        *camera = path.trajectory;
    else
        tides_trajectory_destroy(path.trajectory);
    return status;
}

/* Adds a note if cameras may be in another frame than the splats: those of ns-export are in the trainer's frame. */
static tides_status note_frames(const tides_run *run, const tides_scene *scene, const tides_trajectory *path,
                                const tides_intrinsics *k, td_opening *opening, tides_error *error) {
    int32_t sees = 1;
    tides_status status = td_run_sees(scene, path, k, &sees, error);
    if (status != TIDES_OK || sees) return status;
    return td_note(&opening->notes, error,
                   "camera.file: %s: its cameras see next to nothing of the scene, or stand far outside: where nerfstudio made "
                   "it, put "
                   "its dataparser_transforms.json beside one of them, or name it in camera.frame",
                   td_run_file(run, "camera.file"));
}

tides_status td_run_open(const tides_run *run, tides_scene **scene, tides_trajectory **camera, tides_intrinsics *intrinsics,
                         td_opening *opening, tides_error *error) {
    if (td_run_file(run, "frames.file"))
        return td_fail(error, TIDES_BAD_CONFIG, "%s: the run has frames.file and no scene to render", run->origin);
    tides_trajectory *path = NULL;
    tides_intrinsics size = {0};
    tides_scene *made = NULL;
    const int32_t given = td_run_file(run, "camera.file") != NULL;
    tides_status status = given ? td_run_open_camera(run, NULL, &path, &size, opening, error)
                                : TIDES_OK; /* first, since it is small and most mistakes are in it */
    if (status == TIDES_OK) status = open_scene(run, &made, &opening->notes, error);
    if (status == TIDES_OK && !given) status = td_run_open_camera(run, made, &path, &size, opening, error);
    if (status == TIDES_OK && opening->unframed) status = note_frames(run, made, path, &size, opening, error);
    if (status != TIDES_OK) {
        tides_scene_destroy(made);
        tides_trajectory_destroy(path);
        return status;
    }
    *scene = made;
    *camera = path;
    *intrinsics = size;
    return TIDES_OK;
}

tides_status tides_run_open(const tides_run *run, tides_scene **scene, tides_trajectory **camera, tides_intrinsics *intrinsics,
                            tides_error *error) {
    if (!run || !scene || !camera || !intrinsics)
        return td_fail(error, TIDES_BAD_ARGUMENT, "tides_run_open: run, scene, camera or intrinsics is NULL");
    td_opening opening = {.notes = NULL};
    tides_status status = td_run_open(run, scene, camera, intrinsics, &opening, error);
    free(opening.notes);
    return status;
}

tides_status tides_run_open_frames(const tides_run *run, tides_frames **frames, tides_error *error) {
    if (!run || !frames) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_run_open_frames: run or frames is NULL");
    tides_run_values values;
    tides_run_get(run, &values);
    if (!values.frames_file)
        return td_fail(error, TIDES_BAD_CONFIG, "%s: frames.file is missing: name a folder of pictures or an array file",
                       run->origin);
    return tides_frames_open(values.frames_file, &values.frames, frames, error);
}
