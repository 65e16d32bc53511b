/* Internal: ROS 2 messages in CDR (OMG DDSI-RTPS 10.2, little-endian), for the bag of a camera. */
#ifndef TD_ROS_H
#define TD_ROS_H

#include "td_dataset.h"
#include "td_mcap.h"

enum { TD_ROS_EVENTS, TD_ROS_IMAGE, TD_ROS_INFO, TD_ROS_POSE, TD_ROS_IMU, TD_ROS_KINDS };

/* The type name of a kind, such as "sensor_msgs/msg/Image", and the text that defines it and the types in it. */
const char *td_ros_type(int kind);
const char *td_ros_schema(int kind);

/* Each function makes `message` anew. Events: one packet in EVT 3.0 that can be decoded alone; `seq` is its number. */
void td_ros_events(td_buffer *message, const td_member *camera, uint64_t seq, const tides_event *events, size_t count);
/* `pixel`: bytes per pixel. `encoding`: "rgb8", "32FC1" or "32FC2" (floats, little-endian). */
void td_ros_image(td_buffer *message, const td_member *camera, int64_t ns, const char *encoding, size_t pixel,
                  const void *values);
void td_ros_info(td_buffer *message, const td_member *camera, int64_t ns);
void td_ros_pose(td_buffer *message, int64_t ns, const double position[3], const double quaternion[4]); /* [m], wxyz */
void td_ros_imu(td_buffer *message, const td_member *camera, int64_t ns, const tides_imu_sample *sample);

#endif
