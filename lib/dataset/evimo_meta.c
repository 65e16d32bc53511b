/* EVIMO2's `meta` in dataset_info.npz, from which its readers take times, poses and the IMU. It is a dict of
 *   frames           for each ground truth: id (the number in its planes' names, from 0 on), ts [s], cam, OBJECT ..., gt_frame,
 *                    classical_frame
 *   full_trajectory  for each pose: id, ts, cam, OBJECT ...
 *   imu              {"/CAMERA/imu": [{ts, angular_velocity, linear_acceleration}]}, if there is one
 *   meta             fx fy cx cy, k1 k2 k3 k4 p1 p2 of dist_model (radtan, equidistant), res_x res_y num_frames, and
 *                    ros_time_offset, which is 0 as all times are the run's
 * cam is {ts, pos: {t: {x y z} [m], q: {w x y z}, rpy: {r p y}}}, the camera in the world. The key OBJECT is an object's
 * number in the masks as text; its value is such a pose of the object in the camera. Objects at rest have one, too, since
 * readers compute flow from it. Motion of Gaussians within an object isn't included. Each value is pickled when it is given. */
#include "td_evimo.h"

#include "camera/td_rotation.h"
#include "td_math.h"

#include <math.h>
#include <string.h>

static void put_named(td_pickler *p, const char *const *names, const double *values, int count) {
    td_pickler_dict(p);
    for (int i = 0; i < count; i++) {
        td_pickler_text(p, names[i]);
        td_pickler_number(p, values[i]);
    }
    td_pickler_dict_end(p);
}

static void put_vector(td_pickler *p, const char *key, const double v[3]) {
    static const char *const names[] = {"x", "y", "z"};
    td_pickler_text(p, key);
    put_named(p, names, v, 3);
}

/* Writes the angles about x, y and z, in this order (tf's getRPY). */
static void put_angles(td_pickler *p, const double r[9]) {
    static const char *const names[] = {"r", "p", "y"};
    const double angles[3] = {td_atan2(r[7], r[8]), td_atan2(-r[6], td_hypot(r[7], r[8])), td_atan2(r[3], r[0])};
    td_pickler_text(p, "rpy");
    put_named(p, names, angles, 3);
}

static void put_time(td_pickler *p, double seconds) {
    td_pickler_text(p, "ts");
    td_pickler_number(p, seconds);
}

/* Writes the pose of `name`: {ts, pos}. */
static void put_place(td_pickler *p, const char *name, double scale, const td_place_at *at) {
    static const char *const quaternion[] = {"w", "x", "y", "z"};
    const double metres[3] = {at->position[0] * scale, at->position[1] * scale, at->position[2] * scale};
    td_pickler_text(p, name);
    td_pickler_dict(p);
    put_time(p, td_seconds(at->us));
    td_pickler_text(p, "pos");
    td_pickler_dict(p);
    put_vector(p, "t", metres);
    td_pickler_text(p, "q");
    put_named(p, quaternion, at->quaternion, 4);
    put_angles(p, at->rotation);
    td_pickler_dict_end(p);
    td_pickler_dict_end(p);
}

/* Pose of an object in the camera's axes: R_c^T R_o and R_c^T (t_o - t_c). */
static tides_status find_object(const td_writer *w, int32_t index, const td_place_at *camera, td_place_at *place,
                                tides_error *error) {
    tides_object object;
    tides_pose pose = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    tides_status status = tides_scene_object(w->camera->facts.scene, index, &object, error);
    if (status == TIDES_OK && object.trajectory)
        status = tides_trajectory_at(object.trajectory, td_seconds(camera->us), &pose, error);
    *place = (td_place_at){.us = camera->us};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            place->position[i] += camera->rotation[3 * k + i] * (pose.position[k] - camera->position[k]);
            for (int j = 0; j < 3; j++) place->rotation[3 * i + j] += camera->rotation[3 * k + i] * pose.rotation[3 * k + j];
        }
    td_quaternion_from_rotation(place->rotation, place->quaternion);
    return status;
}

/* Begins a dict with id, ts, cam and objects; it stays open. */
static void begin_place(td_evimo_meta *m, const td_writer *w, size_t id, const td_place_at *at) {
    td_pickler *p = &m->pickler;
    td_pickler_dict(p);
    td_pickler_text(p, "id");
    td_pickler_integer(p, (int32_t)id);
    put_time(p, td_seconds(at->us));
    put_place(p, "cam", w->set->metres, at);
    for (int32_t i = 0; i < tides_scene_objects(w->camera->facts.scene) && p->status == TIDES_OK; i++) {
        char name[16];
        td_place_at place;
        p->status = find_object(w, i, at, &place, p->error);
        snprintf(name, sizeof name, "%d", (int)i + 1);
        put_place(p, name, w->set->metres, &place);
    }
}

static void leave(td_evimo_meta *m) {
    if (m->section) td_pickler_list_end(&m->pickler);
    if (m->section == TD_EVIMO_IMU) td_pickler_dict_end(&m->pickler);
    m->section = 0;
}

/* Begins a section, and ends the previous one. The order is: poses, IMU samples, ground truth. */
static void enter(td_evimo_meta *m, int section, const char *camera) {
    if (m->section == section) return;
    static const char *const names[] = {"", "full_trajectory", "imu", "frames"};
    char topic[TIDES_RIG_NAME + 8];
    leave(m);
    m->section = section;
    m->count = 0;
    td_pickler_text(&m->pickler, names[section]);
    if (section == TD_EVIMO_IMU) {
        snprintf(topic, sizeof topic, "/%s/imu", camera);
        td_pickler_dict(&m->pickler);
        td_pickler_text(&m->pickler, topic);
    }
    td_pickler_list(&m->pickler);
}

void td_evimo_begin(td_evimo_meta *m, tides_error *error) {
    *m = (td_evimo_meta){.section = 0};
    td_pickler_begin(&m->pickler, error);
    td_pickler_dict(&m->pickler);
}

void td_evimo_pose(td_evimo_meta *m, const td_writer *w, const td_place_at *at) {
    enter(m, TD_EVIMO_POSES, w->camera->name);
    begin_place(m, w, m->count++, at);
    td_pickler_dict_end(&m->pickler);
}

void td_evimo_imu(td_evimo_meta *m, const td_writer *w, const tides_imu_sample *sample) {
    enter(m, TD_EVIMO_IMU, w->camera->name);
    td_pickler_dict(&m->pickler);
    put_time(&m->pickler, sample->time);
    put_vector(&m->pickler, "angular_velocity", sample->angular_rate);
    put_vector(&m->pickler, "linear_acceleration", sample->specific_force);
    td_pickler_dict_end(&m->pickler);
}

void td_evimo_frame(td_evimo_meta *m, const td_writer *w, size_t id, const td_place_at *at, int32_t picture) {
    char name[32];
    enter(m, TD_EVIMO_FRAMES, w->camera->name);
    begin_place(m, w, id, at);
    m->count++;
    snprintf(name, sizeof name, "depth_mask_%zu.png", id);
    td_pickler_text(&m->pickler, "gt_frame");
    td_pickler_text(&m->pickler, name);
    if (picture) {
        snprintf(name, sizeof name, "img_%zu.png", id);
        td_pickler_text(&m->pickler, "classical_frame");
        td_pickler_text(&m->pickler, name);
    }
    td_pickler_dict_end(&m->pickler);
}

tides_status td_evimo_end(td_evimo_meta *m, const td_writer *w, td_npy_writer *npy) {
    static const char *const names[] =
        {"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4", "p1", "p2", "ros_time_offset", "res_x", "res_y", "num_frames"};
    const tides_intrinsics *k = &w->camera->facts.intrinsics;
    const tides_lens *l = &k->lens;
    const double values[] =
        {k->fx,    k->fy,     td_whole_cx(w->camera), td_whole_cy(w->camera), l->k1, l->k2, l->k3, l->k4, l->p1, l->p2, 0,
         k->width, k->height, (double)m->count};
    enum { REALS = 11, ALL = sizeof names / sizeof *names };
    td_pickler *p = &m->pickler;
    leave(m);
    td_pickler_text(p, "meta");
    td_pickler_dict(p);
    for (int i = 0; i < ALL; i++) {
        td_pickler_text(p, names[i]);
        if (i < REALS)
            td_pickler_number(p, values[i]);
        else
            td_pickler_integer(p, (int32_t)values[i]);
    }
    td_pickler_text(p, "dist_model");
    td_pickler_text(p, tides_lens_name(l->model ? l->model : TIDES_LENS_RADTAN));
    td_pickler_dict_end(p);
    td_pickler_dict_end(p);
    return td_pickler_end(p, npy, "meta");
}
