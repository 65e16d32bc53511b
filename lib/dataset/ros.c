/* ROS 2 messages in CDR. A number of n bytes is aligned to n, counted from behind the 4-byte header. */
#include "td_ros.h"

#include <string.h>

#define RULE "================================================================================\n"
#define DEFINES(name) RULE "MSG: " name "\n"
#define HEADER                 \
    DEFINES("std_msgs/Header") \
    "builtin_interfaces/Time stamp\nstring frame_id\n" DEFINES("builtin_interfaces/Time") "int32 sec\nuint32 nanosec\n"

/* Message definitions of ROS's own packages and of event_camera_msgs, without comments. */
static const struct message {
    const char *type, *schema;
} messages[TD_ROS_KINDS] = {
    [TD_ROS_EVENTS] = {"event_camera_msgs/msg/EventPacket",
                       "std_msgs/Header header\nuint32 height\nuint32 width\nuint64 seq\nuint64 time_base\nstring encoding\n"
                       "bool is_bigendian\nuint8[] events\n" HEADER},
    [TD_ROS_IMAGE] = {"sensor_msgs/msg/Image",
                      "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\n"
                      "uint8[] data\n" HEADER},
    [TD_ROS_INFO] = {"sensor_msgs/msg/CameraInfo",
                     "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\nfloat64[9] k\n"
                     "float64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\n"
                     "sensor_msgs/RegionOfInterest roi\n" HEADER DEFINES(
                         "sensor_msgs/RegionOfInterest") "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool "
                                                         "do_rectify\n"},
    [TD_ROS_POSE] =
        {"geometry_msgs/msg/PoseStamped",
         "std_msgs/Header header\ngeometry_msgs/Pose pose\n" HEADER DEFINES(
             "geometry_msgs/Pose") "geometry_msgs/Point position\n"
                                   "geometry_msgs/Quaternion orientation\n" DEFINES(
                                       "geometry_msgs/Point") "float64 x\nfloat64 y\nfloat64 z\n" DEFINES("geometry_msgs/"
                                                                                                          "Quaternion") "float6"
                                                                                                                        "4 "
                                                                                                                        "x\nflo"
                                                                                                                        "at64 "
                                                                                                                        "y\nflo"
                                                                                                                        "at64 "
                                                                                                                        "z\nflo"
                                                                                                                        "at64 "
                                                                                                                        "w\n"},
    [TD_ROS_IMU] = {"sensor_msgs/msg/Imu",
                    "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
                    "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
                    "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n" HEADER
                        DEFINES("geometry_msgs/Quaternion") "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n" DEFINES(
                            "geometry_msgs/Vector3") "float64 x\nfloat64 y\nfloat64 z\n"},
};

const char *td_ros_type(int kind) { return messages[kind].type; }
const char *td_ros_schema(int kind) { return messages[kind].schema; }

/* -- CDR ------------------------------------------------------------------------------------------------------------------- */

static void put(td_buffer *b, uint64_t value, int bytes) {
    while ((b->size - 4) % (size_t)bytes && !b->failed) td_buffer_number(b, 0, 1);
    td_buffer_number(b, value, bytes);
}

static void put_double(td_buffer *b, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put(b, bits, 8);
}

static void put_doubles(td_buffer *b, const double *values, int count) {
    for (int i = 0; i < count; i++) put_double(b, values[i]);
}

static void put_text(td_buffer *b, const char *text) {
    put(b, strlen(text) + 1, 4);
    td_buffer_put(b, text, strlen(text) + 1);
}

/* Begins a message with the header that every message has. */
static void begin(td_buffer *b, int64_t ns, const char *frame) {
    static const unsigned char lowest_first[4] = {0, 1, 0, 0};
    int64_t sec = ns / 1000000000, rest = ns % 1000000000;
    if (rest < 0) rest += 1000000000, sec--;
    b->size = 0;
    td_buffer_put(b, lowest_first, sizeof lowest_first);
    put(b, (uint64_t)sec, 4);
    put(b, (uint64_t)rest, 4);
    put_text(b, frame);
}

/* -- messages -------------------------------------------------------------------------------------------------------------- */

/* Words of EVT 3.0: 12 bits of data below 4 bits of type. Time is 24 bits of microseconds. y and time hold until they are set
 * again. */
enum { WORD_Y = 0x0, WORD_X = 0x2, WORD_LOW = 0x6, WORD_HIGH = 0x8 };

static void put_word(td_buffer *b, unsigned kind, uint64_t value) { td_buffer_number(b, kind << 12 | (value & 0xfff), 2); }

/* Writes events. High and low time and y come first, so that a packet can be decoded without earlier ones. */
static void put_events(td_buffer *b, const tides_event *events, size_t count) {
    int64_t time = -1;
    int32_t y = -1;
    for (size_t i = 0; i < count; i++) {
        const tides_event *e = &events[i];
        const int64_t us = e->t / 1000 - (e->t % 1000 < 0);
        if (i == 0 || us >> 12 != time >> 12) put_word(b, WORD_HIGH, (uint64_t)(us >> 12));
        if (i == 0 || us != time) put_word(b, WORD_LOW, (uint64_t)us);
        if (e->y != y) put_word(b, WORD_Y, e->y);
        put_word(b, WORD_X, (uint64_t)(e->polarity > 0) << 11 | e->x);
        time = us;
        y = e->y;
    }
}

/* Writes a packet of events. The decoder finds the time in the stream; time_base isn't used by evt3, and is 0. */
void td_ros_events(td_buffer *b, const td_member *camera, uint64_t seq, const tides_event *events, size_t count) {
    begin(b, count ? events[0].t : 0, camera->name);
    put(b, (uint64_t)camera->facts.intrinsics.height, 4);
    put(b, (uint64_t)camera->facts.intrinsics.width, 4);
    put(b, seq, 8);
    put(b, 0, 8);
    put_text(b, "evt3");
    put(b, 0, 1);
    put(b, 0, 4); /* number of bytes, set below */
    const size_t place = b->size - 4;
    put_events(b, events, count);
    if (b->failed) return;
    uint64_t bytes = b->size - place - 4;
    for (size_t i = 0; i < 4; i++, bytes >>= 8) b->bytes[place + i] = (unsigned char)(bytes & 255);
}

void td_ros_image(td_buffer *b, const td_member *camera, int64_t ns, const char *encoding, size_t pixel, const void *values) {
    const size_t width = (size_t)camera->facts.intrinsics.width, height = (size_t)camera->facts.intrinsics.height;
    begin(b, ns, camera->name);
    put(b, height, 4);
    put(b, width, 4);
    put_text(b, encoding);
    put(b, 0, 1);
    put(b, pixel * width, 4);
    put(b, pixel * width * height, 4);
    td_buffer_put(b, values, pixel * width * height);
}

void td_ros_info(td_buffer *b, const td_member *camera, int64_t ns) {
    const tides_intrinsics *k = &camera->facts.intrinsics;
    const double cx = td_whole_cx(camera), cy = td_whole_cy(camera);
    double lens[TD_COEFFICIENTS_MAX];
    const td_lens_model *model = td_lens_numbers(camera, lens);
    const double matrix[9] = {k->fx, 0, cx, 0, k->fy, cy, 0, 0, 1}, same[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const double projection[12] = {k->fx, 0, cx, 0, 0, k->fy, cy, 0, 0, 0, 1, 0};
    begin(b, ns, camera->name);
    put(b, (uint64_t)k->height, 4);
    put(b, (uint64_t)k->width, 4);
    put_text(b, model->ros);
    put(b, (uint64_t)model->count, 4);
    put_doubles(b, lens, model->count);
    put_doubles(b, matrix, 9);
    put_doubles(b, same, 9);
    put_doubles(b, projection, 12);
    for (int i = 0; i < 6; i++) put(b, 0, 4); /* no binning, and the whole image */
    put(b, 0, 1);
}

void td_ros_pose(td_buffer *b, int64_t ns, const double position[3], const double q[4]) {
    begin(b, ns, "world");
    put_doubles(b, position, 3);
    put_doubles(b, q + 1, 3);
    put_double(b, q[0]);
}

/* Writes an IMU reading. A covariance beginning with -1 means no orientation; covariances of 0 are unknown ones. */
void td_ros_imu(td_buffer *b, const td_member *camera, int64_t ns, const tides_imu_sample *sample) {
    const double still[4] = {0, 0, 0, 1}, none[9] = {-1}, unknown[9] = {0};
    begin(b, ns, camera->name);
    put_doubles(b, still, 4);
    put_doubles(b, none, 9);
    put_doubles(b, sample->angular_rate, 3);
    put_doubles(b, unknown, 9);
    put_doubles(b, sample->specific_force, 3);
    put_doubles(b, unknown, 9);
}
