/* A ROS 2 bag, NAME.mcap with rosbag2's metadata.yaml. Each camera has /CAMERA/events (event_camera_msgs/EventPacket,
 * encoding evt3), image_raw, camera_info, pose in the world [m], depth (32FC1 [m], NaN: none, by REP 118) and optic_flow
 * (32FC2 [px/s], as in ESIM). Messages have the run's times; a packet of events has that of its first event. */
#include "signal/td_step.h"
#include "td_ros.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Most events of a packet: about 200 kB, which DDS sends without trouble. */
enum { PACKET = 32768, TOPICS = 64 };

/* Topics of a camera: TD_ROS_* first, then images of numbers. */
enum { DEPTH = TD_ROS_KINDS, FLOW, CHANNELS };

typedef struct topic {
    char name[TIDES_RIG_NAME + 16];
    int kind;
} topic;

typedef struct ros2 {
    td_mcap *mcap;
    td_buffer message;
    topic topics[TOPICS]; /* indexed like the channels */
    int count;
    int channel[CHANNELS]; /* of the current camera */
    uint64_t packets;
    float *plane; /* two values per pixel */
} ros2;

static tides_status check(const td_dataset *set, tides_error *error) {
    for (size_t i = 0; i < set->count; i++) {
        const tides_intrinsics *k = &set->cameras[i].facts.intrinsics;
        if (k->width > 2048 || k->height > 2048)
            return td_fail(error, TIDES_BAD_CONFIG, "ros2: evt3 has 11 bits for a place, and %s is %d x %d px",
                           set->cameras[i].name, (int)k->width, (int)k->height);
    }
    if (set->start_us >= 0 && set->stop_us / 1000000 <= INT32_MAX) return TIDES_OK;
    return td_fail(error, TIDES_BAD_CONFIG, "ros2: its stamps are seconds from 0 to 2^31: move time.start");
}

static tides_status add_topic(td_writer *w, int which, const char *name, tides_error *error) {
    const int kind = which < TD_ROS_KINDS ? which : TD_ROS_IMAGE;
    ros2 *r = w->kept;
    if (r->count == TOPICS) return td_fail(error, TIDES_UNSUPPORTED, "ros2: the rig has too many cameras");
    topic *t = &r->topics[r->count++];
    t->kind = kind;
    snprintf(t->name, sizeof t->name, "/%s/%s", w->camera->name, name);
    return td_mcap_channel(r->mcap, t->name, td_ros_type(kind), td_ros_schema(kind), &r->channel[which], error);
}

static tides_status open_bag(td_writer *w, tides_error *error) {
    ros2 *r = w->kept = td_alloc(1, sizeof *r, error);
    if (!r) return TIDES_NO_MEMORY;
    return td_mcap_open(td_in_folder(w->root, error, "%.200s.mcap", w->set->name), &r->mcap, error);
}

static tides_status begin(td_writer *w, tides_error *error) {
    tides_status status = w->kept ? TIDES_OK : open_bag(w, error);
    if (status == TIDES_OK && w->camera->event >= 0) status = add_topic(w, TD_ROS_EVENTS, "events", error);
    if (status == TIDES_OK && w->camera->picture >= 0) status = add_topic(w, TD_ROS_IMAGE, "image_raw", error);
    if (status == TIDES_OK) status = add_topic(w, TD_ROS_INFO, "camera_info", error);
    if (status == TIDES_OK) status = add_topic(w, TD_ROS_POSE, "pose", error);
    if (status == TIDES_OK && w->set->has_imu) status = add_topic(w, TD_ROS_IMU, "imu", error);
    if (status == TIDES_OK) status = add_topic(w, DEPTH, "depth", error);
    if (status == TIDES_OK) status = add_topic(w, FLOW, "optic_flow", error);
    if (status != TIDES_OK) return status;
    ros2 *r = w->kept;
    r->packets = 0;
    free(r->plane);
    r->plane = td_alloc(2 * td_pixels(w->camera), sizeof *r->plane, error);
    return r->plane ? TIDES_OK : TIDES_NO_MEMORY;
}

static tides_status send(ros2 *r, int which, int64_t ns, tides_error *error) {
    return td_mcap_message(r->mcap, r->channel[which], ns, &r->message, error);
}

static tides_status events(td_writer *w, const tides_event *list, size_t count, tides_error *error) {
    ros2 *r = w->kept;
    tides_status status = TIDES_OK;
    for (size_t first = 0; first < count && status == TIDES_OK; first += PACKET) {
        const size_t some = count - first < PACKET ? count - first : PACKET;
        td_ros_events(&r->message, w->camera, r->packets++, list + first, some);
        status = send(r, TD_ROS_EVENTS, list[first].t, error);
    }
    return status;
}

/* Writes camera_info with each ground truth, for cameras without pictures. */
static tides_status tell(td_writer *w, int64_t us, tides_error *error) {
    ros2 *r = w->kept;
    td_ros_info(&r->message, w->camera, 1000 * us);
    return send(r, TD_ROS_INFO, 1000 * us, error);
}

static tides_status picture(td_writer *w, const td_picture *p, tides_error *error) {
    ros2 *r = w->kept;
    td_ros_image(&r->message, w->camera, 1000 * p->us, "rgb8", 3, p->rgb);
    const tides_status status = send(r, TD_ROS_IMAGE, 1000 * p->us, error);
    return status == TIDES_OK ? tell(w, p->us, error) : status;
}

static tides_status truth(td_writer *w, const td_truth *t, tides_error *error) {
    ros2 *r = w->kept;
    const size_t pixels = td_pixels(w->camera);
    for (size_t i = 0; i < pixels; i++) r->plane[i] = t->depth[i] > 0 ? (float)(t->depth[i] * w->set->metres) : NAN;
    td_ros_image(&r->message, w->camera, 1000 * t->us, "32FC1", 4, r->plane);
    tides_status status = send(r, DEPTH, 1000 * t->us, error);
    for (size_t i = 0; i < pixels; i++) r->plane[2 * i] = (float)t->flow_u[i], r->plane[2 * i + 1] = (float)t->flow_v[i];
    td_ros_image(&r->message, w->camera, 1000 * t->us, "32FC2", 8, r->plane);
    if (status == TIDES_OK) status = send(r, FLOW, 1000 * t->us, error);
    return status == TIDES_OK && w->camera->picture < 0 ? tell(w, t->us, error) : status;
}

static tides_status pose(td_writer *w, const td_place_at *at, tides_error *error) {
    ros2 *r = w->kept;
    const double m = w->set->metres, place[3] = {m * at->position[0], m * at->position[1], m * at->position[2]};
    td_ros_pose(&r->message, 1000 * at->us, place, at->quaternion);
    return send(r, TD_ROS_POSE, 1000 * at->us, error);
}

static tides_status imu(td_writer *w, const tides_imu_sample *sample, tides_error *error) {
    ros2 *r = w->kept;
    const int64_t ns = td_time_ns(sample->time);
    td_ros_imu(&r->message, w->camera, ns, sample);
    return send(r, TD_ROS_IMU, ns, error);
}

/* Writes metadata.yaml, version 5 of rosbag2. */
static tides_status put_metadata(td_writer *w, td_text *yaml, tides_error *error) {
    ros2 *r = w->kept;
    int64_t first, last;
    td_mcap_range(r->mcap, &first, &last);
    const long long from = first, length = last - first;
    const unsigned long long all = td_mcap_count(r->mcap, -1);
    tides_status status = td_text_put(yaml, error,
                                      "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n"
                                      "  duration:\n    nanoseconds: %lld\n"
                                      "  starting_time:\n    nanoseconds_since_epoch: %lld\n"
                                      "  message_count: %llu\n  topics_with_message_count:\n",
                                      length, from, all);
    for (int i = 0; i < r->count && status == TIDES_OK; i++)
        status = td_text_put(yaml, error,
                             "    - topic_metadata:\n        name: %s\n        type: %s\n"
                             "        serialization_format: cdr\n        offered_qos_profiles: \"\"\n"
                             "      message_count: %llu\n",
                             r->topics[i].name, td_ros_type(r->topics[i].kind), (unsigned long long)td_mcap_count(r->mcap, i));
    if (status != TIDES_OK) return status;
    return td_text_put(yaml, error,
                       "  compression_format: \"\"\n  compression_mode: \"\"\n"
                       "  relative_file_paths:\n    - %.200s.mcap\n  files:\n    - path: %.200s.mcap\n"
                       "      starting_time:\n        nanoseconds_since_epoch: %lld\n"
                       "      duration:\n        nanoseconds: %lld\n      message_count: %llu\n",
                       w->set->name, w->set->name, from, length, all);
}

static tides_status complete(td_writer *w, tides_error *error) {
    td_text yaml = {0};
    tides_status status = td_mcap_finish(((ros2 *)w->kept)->mcap, error);
    if (status == TIDES_OK) status = td_text_in_folder(&yaml, w->root, "metadata.yaml", error);
    if (status == TIDES_OK) status = put_metadata(w, &yaml, error);
    return td_text_close(&yaml, status, error);
}

static void drop(td_writer *w) {
    ros2 *r = w->kept;
    if (!r) return;
    td_mcap_free(r->mcap);
    td_buffer_free(&r->message);
    free(r->plane);
    free(r);
}

const td_layout td_layout_ros2 = {.name = "ros2",
                                  .summary = "ROS 2 bag (MCAP): events as EVT 3.0, pictures, calibration, poses",
                                  .metric = 1,
                                  .check = check,
                                  .begin = begin,
                                  .events = events,
                                  .picture = picture,
                                  .truth = truth,
                                  .pose = pose,
                                  .imu = imu,
                                  .complete = complete,
                                  .drop = drop};
