/* Load for routers: sends MAVLink frames over UDP loopback and takes them at the other end, as fast as the router lets
   it (never more than WINDOW frames under way, so that nothing is lost to full buffers) or at 50 Hz for the latency.

   blast rate IN OUT FRAMES_A_DATAGRAM SECONDS   -> "FRAMES SECONDS LOST"
   blast latency IN OUT 1 SECONDS                -> one line a frame: us */
#include <arpa/inet.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { WINDOW = 192, FRAME = 40, NUMBERS = 1 << 16 };

struct shared {
    atomic_long received, first_seen;
    atomic_llong sent_at[NUMBERS], came_at[NUMBERS];
};
static struct shared *shared;

static long long now_ns(void) {
    struct timespec at;
    clock_gettime(CLOCK_MONOTONIC, &at);
    return at.tv_sec * 1000000000LL + at.tv_nsec;
}

static void pause_ns(long ns) {
    struct timespec wait = {ns / 1000000000L, ns % 1000000000L};
    nanosleep(&wait, NULL);
}

static uint16_t crc(const uint8_t *data, int length, uint8_t extra) {
    uint16_t value = 0xFFFF;
    for (int at = 0; at <= length; at++) {
        uint8_t byte = (at < length ? data[at] : extra) ^ (uint8_t)value;
        byte ^= (uint8_t)(byte << 4);
        value = (uint16_t)(value >> 8) ^ (uint16_t)(byte << 8) ^ (uint16_t)(byte << 3) ^ (byte >> 4);
    }
    return value;
}

static int finish(uint8_t *frame, int length, uint8_t extra) {
    uint16_t check = crc(frame + 1, length + 9, extra);
    frame[length + 10] = (uint8_t)check;
    frame[length + 11] = (uint8_t)(check >> 8);
    return length + 12;
}

static int attitude(uint8_t *frame, uint32_t number) {
    uint8_t head[10] = {0xFD, 28, 0, 0, (uint8_t)number, 1, 1, 30, 0, 0};
    memcpy(frame, head, 10);
    memset(frame + 10, 0x3C, 28);
    memcpy(frame + 10, &number, 4);
    return finish(frame, 28, 39);
}

static int heartbeat(uint8_t *frame, uint8_t number) {
    uint8_t whole[19] = {0xFD, 9, 0, 0, number, 1, 1, 0, 0, 0, 0, 0, 0, 0, 10, 3, 0, 4, 3};
    memcpy(frame, whole, 19);
    return finish(frame, 9, 50);
}

static void sink(int port) {
    int sock = socket(AF_INET, SOCK_DGRAM, 0);
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (bind(sock, (struct sockaddr *)&address, sizeof address)) exit(3);
    static uint8_t data[65536];
    for (;;) {
        ssize_t size = recv(sock, data, sizeof data, 0);
        long long at = now_ns();
        long frames = 0;
        for (ssize_t start = 0; start + 12 <= size && data[start] == 0xFD; start += data[start + 1] + 12) {
            if (data[start + 7] == 0) atomic_fetch_add(&shared->first_seen, 1);
            if (data[start + 7] != 30) continue;
            uint32_t number;
            memcpy(&number, data + start + 10, 4);
            atomic_store(&shared->came_at[number % NUMBERS], at);
            frames++;
        }
        atomic_fetch_add(&shared->received, frames);
    }
}

static void send_all(int sock, const uint8_t *data, int size) {
    if (send(sock, data, (size_t)size, 0) < 0) pause_ns(50000);
}

static int wake_router(int sock) { /* heartbeats until one comes through: the router knows us and is warm */
    uint8_t frame[64];
    for (int tries = 0; tries < 300; tries++) {
        send_all(sock, frame, heartbeat(frame, (uint8_t)tries));
        pause_ns(50000000);
        if (atomic_load(&shared->first_seen) > 3) return 1;
    }
    return 0;
}

static void rate(int sock, int together, double seconds) {
    uint8_t data[FRAME * 64];
    uint32_t number = 0;
    long given_up = 0;
    long long start = now_ns(), end = start + (long long)(seconds * 1e9), progress = start;
    long seen = 0;
    while (now_ns() < end) {
        long received = atomic_load(&shared->received);
        if (received != seen) seen = received, progress = now_ns();
        if ((long)number - given_up - received + together > WINDOW) {
            if (now_ns() - progress > 1000000000LL) given_up = (long)number - received; /* lost on the way */
            pause_ns(20000);
            continue;
        }
        int size = 0;
        for (int each = 0; each < together; each++) size += attitude(data + size, number++);
        send_all(sock, data, size);
    }
    long frames = atomic_load(&shared->received);
    double took = (double)(now_ns() - start) / 1e9;
    pause_ns(500000000); /* what is still under way is not lost */
    printf("%ld %.6f %ld\n", frames, took, (long)number - atomic_load(&shared->received));
}

static void latency(int sock, double seconds) {
    uint8_t frame[64];
    uint32_t count = (uint32_t)(seconds * 50);
    long long due = now_ns();
    for (uint32_t number = 0; number < count; number++) {
        due += 20000000;
        long long wait = due - now_ns();
        if (wait > 0) pause_ns(wait);
        int size = attitude(frame, number);
        atomic_store(&shared->sent_at[number % NUMBERS], now_ns());
        send_all(sock, frame, size);
    }
    pause_ns(300000000);
    for (uint32_t number = 0; number < count; number++)
        if (shared->came_at[number]) printf("%.1f\n", (double)(shared->came_at[number] - shared->sent_at[number]) / 1e3);
}

int main(int count, char **words) {
    if (count != 6) return 2;
    shared = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    pid_t child = fork();
    if (!child) sink(atoi(words[3]));
    int sock = socket(AF_INET, SOCK_DGRAM, 0);
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_port = htons((uint16_t)atoi(words[2]))};
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    int awake = !connect(sock, (struct sockaddr *)&address, sizeof address) && wake_router(sock);
    if (awake && !strcmp(words[1], "rate")) rate(sock, atoi(words[4]), atof(words[5]));
    if (awake && !strcmp(words[1], "latency")) latency(sock, atof(words[5]));
    kill(child, 9);
    waitpid(child, NULL, 0);
    return awake ? 0 : 1;
}
