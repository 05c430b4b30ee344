"""The other vehicles of the benchmark `fleet`: a process that sends their telemetry until it is ended.

python -m tests.benchmarks.fleet_sender COUNT PORT
"""

from __future__ import annotations

import itertools
import random
import socket
import sys
import time
from contextlib import ExitStack

from dialects.messages import Heartbeat, Message
from tests.benchmarks.traffic import framed, telemetry

RATE = 50
"""Messages/s of each vehicle, one of them a HEARTBEAT."""
FIRST_SYSTEM = 2
STEP = 0.01
"""s between two bursts; each has messages of every vehicle in turn."""


def main(count: int, port: int) -> None:
    """Send, each vehicle from a port of its own."""
    with ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) for _ in range(count)]
        for each in sockets:
            each.connect(("127.0.0.1", port))
        frames = [vehicle_frames(system) for system in range(FIRST_SYSTEM, FIRST_SYSTEM + count)]
        sys.stdout.write("fleet ready\n")
        sys.stdout.flush()
        start, sent = time.monotonic(), 0
        for burst in itertools.count(1):
            time.sleep(max(0.0, start + burst * STEP - time.monotonic()))
            due = round(burst * STEP * RATE * count)
            for number in range(sent, due):
                vehicle, message = number % count, number // count
                at = (vehicle + message) % len(frames[vehicle])  # their heartbeats do not come all at once
                sockets[vehicle].send(frames[vehicle][at])
            sent = due


def vehicle_frames(system: int) -> list[bytes]:
    """Return the frames of 256 messages, so that there is no gap in the sequence numbers at the restart."""
    chance = random.Random(system)
    found = telemetry(chance, 256)
    beat: Message = Heartbeat(10, 3, 81, 0, 4, 3)
    messages = [
        beat if number % RATE == 0 or isinstance(each, Heartbeat) else each for number, each in enumerate(found)
    ]
    for number, each in enumerate(messages):
        if hasattr(each, "time_boot_ms"):  # 2.5 s of a clock that goes on: else it would look like a reboot
            each.time_boot_ms = 10_000 + 10 * number
    return [framed(each, number, system) for number, each in enumerate(messages)]


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
