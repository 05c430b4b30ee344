/* The MAVLink C library as the other end: reads frames as lines of hex digits, prints what it accepts, then signs one.
   Arguments: key as 64 hex digits, timestamp of its clock. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "minimal/mavlink.h"

static mavlink_signing_t signing;
static mavlink_signing_streams_t streams;

static int from_hex(const char *text, uint8_t *bytes)
{
    int count = 0;
    unsigned value;
    for (; sscanf(text + 2 * count, "%2x", &value) == 1; count++)
        bytes[count] = (uint8_t)value;
    return count;
}

int main(int argc, char **argv)
{
    char line[1024];
    uint8_t data[512];
    mavlink_message_t message;
    mavlink_status_t status;
    if (argc != 3)
        return 2;
    from_hex(argv[1], signing.secret_key);
    signing.timestamp = strtoull(argv[2], NULL, 10);
    signing.flags = MAVLINK_SIGNING_FLAG_SIGN_OUTGOING;
    signing.link_id = 5;
    mavlink_get_channel_status(MAVLINK_COMM_0)->signing = &signing;
    mavlink_get_channel_status(MAVLINK_COMM_0)->signing_streams = &streams;
    while (fgets(line, sizeof line, stdin) && line[0] != '\n') {
        int size = from_hex(line, data), accepted = 0;
        for (int i = 0; i < size; i++)
            accepted |= mavlink_parse_char(MAVLINK_COMM_0, data[i], &message, &status) == MAVLINK_FRAMING_OK;
        puts(accepted ? "accepted" : "refused");
    }
    mavlink_msg_heartbeat_pack_chan(1, 1, MAVLINK_COMM_0, &message, 10, 3, 0, 0, 4);
    uint16_t size = mavlink_msg_to_send_buffer(data, &message);
    for (int i = 0; i < size; i++)
        printf("%02x", data[i]);
    puts("");
    return 0;
}
