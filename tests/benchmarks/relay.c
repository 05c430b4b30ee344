/* The least a router can do: every frame's checksum checked, then sent on in a datagram of its own. relay IN OUT */
#include <arpa/inet.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>

static uint16_t crc(const uint8_t *data, int length, uint8_t extra) {
    uint16_t value = 0xFFFF;
    for (int at = 0; at <= length; at++) {
        uint8_t byte = (at < length ? data[at] : extra) ^ (uint8_t)value;
        byte ^= (uint8_t)(byte << 4);
        value = (uint16_t)(value >> 8) ^ (uint16_t)(byte << 8) ^ (uint16_t)(byte << 3) ^ (byte >> 4);
    }
    return value;
}

int main(int count, char **words) {
    if (count != 3) return 2;
    int in = socket(AF_INET, SOCK_DGRAM, 0), out = socket(AF_INET, SOCK_DGRAM, 0);
    struct sockaddr_in from = {.sin_family = AF_INET, .sin_port = htons((uint16_t)atoi(words[1]))};
    from.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    struct sockaddr_in to = from;
    to.sin_port = htons((uint16_t)atoi(words[2]));
    if (bind(in, (struct sockaddr *)&from, sizeof from) || connect(out, (struct sockaddr *)&to, sizeof to)) return 3;
    puts("ready");
    fflush(stdout);
    static uint8_t data[65536];
    for (;;) {
        ssize_t size = recv(in, data, sizeof data, 0);
        for (ssize_t at = 0; at + 12 <= size && data[at] == 0xFD;) {
            int length = data[at + 1], id = data[at + 7];
            if (at + length + 12 > size) break;
            uint16_t check = crc(data + at + 1, length + 9, id == 30 ? 39 : 50);
            if (check == (data[at + length + 10] | data[at + length + 11] << 8)) send(out, data + at, (size_t)length + 12, 0);
            at += length + 12;
        }
    }
}
