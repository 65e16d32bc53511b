/* Internal: writes MCAP (mcap.dev/spec), the container of ROS 2 bags: messages in chunks, with an index for players. */
#ifndef TD_MCAP_H
#define TD_MCAP_H

#include "td_base.h"

/* A growing buffer; numbers are appended little-endian. `failed`: memory was short, and nothing more is appended. */
typedef struct td_buffer {
    unsigned char *bytes;
    size_t size, capacity;
    int failed;
} td_buffer;
void td_buffer_put(td_buffer *buffer, const void *bytes, size_t size);
void td_buffer_number(td_buffer *buffer, uint64_t value, int bytes);
void td_buffer_free(td_buffer *buffer);

typedef struct td_mcap td_mcap;

/* Begins a file; takes over `path` (NULL: out of memory). */
tides_status td_mcap_open(char *path, td_mcap **mcap, tides_error *error);

/* Adds a channel of messages, whose bytes are CDR, as ROS 2 encodes them. `schema` defines `type` ("sensor_msgs/msg/Imu") in
 * the text format of ROS 2, and must outlive the mcap. */
tides_status td_mcap_channel(td_mcap *mcap, const char *topic, const char *type, const char *schema, int *number,
                             tides_error *error);

/* Adds a message at `ns`. Messages of one channel come in order of time; channels may be mixed. */
tides_status td_mcap_message(td_mcap *mcap, int channel, int64_t ns, const td_buffer *message, tides_error *error);

/* Facts for a bag's metadata.yaml: number of messages, and their range of time. */
uint64_t td_mcap_count(const td_mcap *mcap, int channel); /* channel -1: all */
void td_mcap_range(const td_mcap *mcap, int64_t *first, int64_t *last);

/* Ends the file; the mcap still gives its counts. */
tides_status td_mcap_finish(td_mcap *mcap, tides_error *error);
void td_mcap_free(td_mcap *mcap); /* may be NULL */

#endif
