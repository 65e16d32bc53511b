/* Internal: ROS 2 messages as CDR (OMG DDSI-RTPS 10.2, lowest byte first): what a bag of a camera holds. */
#ifndef TD_ROS_H
#define TD_ROS_H

#include "td_dataset.h"
#include "td_mcap.h"

enum { TD_ROS_EVENTS, TD_ROS_IMAGE, TD_ROS_INFO, TD_ROS_POSE, TD_ROS_IMU, TD_ROS_KINDS };

/* "sensor_msgs/msg/Image", and the text that defines it with what it is made of. */
const char *td_ros_type(int kind);
const char *td_ros_schema(int kind);

/* Each makes `message` anew. Events are all of one packet, EVT 3.0 that can be read on its own; `seq` is its number. */
void td_ros_events(td_buffer *message, const td_member *camera, uint64_t seq, const tides_event *events, size_t count);
/* `pixel` bytes each, of "rgb8", "32FC1" or "32FC2" (floats, lowest byte first). */
void td_ros_image(td_buffer *message, const td_member *camera, int64_t ns, const char *encoding, size_t pixel,
                  const void *values);
void td_ros_info(td_buffer *message, const td_member *camera, int64_t ns);
void td_ros_pose(td_buffer *message, int64_t ns, const double position[3], const double quaternion[4]); /* [m], wxyz */
void td_ros_imu(td_buffer *message, const td_member *camera, int64_t ns, const tides_imu_sample *sample);

#endif
