"""What messages cost the ground station: CPU of its processes at 100 to 2000 messages a second from one vehicle."""

from __future__ import annotations

import socket
import time
from contextlib import ExitStack
from statistics import median

from tests.benchmarks.cost import SIZE, WARM_UP, Flood
from tests.benchmarks.figures import ROUNDS, Goal, Options, Report, Table, brief
from tests.benchmarks.procfs import cpu_seconds, family
from tests.benchmarks.programs import free_port, on_terminal, python
from tests.benchmarks.watch import Watch

RATES = (100, 300, 1000, 2000)
"""Messages a second."""
WINDOW, QUICK_WINDOW = 5.0, 2.0
"""s over which CPU time is counted."""


def run(options: Options) -> Report:
    """Measure the rates in turn, round by round."""
    cpu: dict[int, list[float]] = {rate: [] for rate in RATES}
    for turn in range(ROUNDS):
        for rate, seen in cpu.items():
            options.say(f"message_rates: round {turn + 1} of {ROUNDS}, {rate} messages/s")
            seen.append(_measure(rate, QUICK_WINDOW if options.quick else WINDOW))
    rows = [
        {
            "messages/s": rate,
            "CPU %": median(seen),
            "CPU % of rounds": " / ".join(f"{each:.1f}" for each in seen),
            "us a message": 1e4 * median(seen) / rate,
        }
        for rate, seen in cpu.items()
    ]
    note = "All processes of the ground station with the Drive screen at 140x45, with its own work without messages."
    low, high = (1e4 * median(cpu[rate]) / rate for rate in (RATES[0], RATES[-1]))
    beside = f"at {RATES[0]} messages/s, {brief(low)} us"
    goals = [Goal(f"CPU of a message at {RATES[-1]} messages/s", high / low, 1.0, "x", reference=beside)]
    return Report([Table("Ground station by messages a second", rows, note)], goals)


def _measure(rate: int, window: float) -> float:
    """Return the CPU of the ground station, % of a core."""
    port, watch = free_port(), Watch()
    with ExitStack() as stack:
        stack.callback(watch.close)
        ground = on_terminal(watch, python("groundstation", f"udpin:127.0.0.1:{port}"), *SIZE)
        stack.callback(ground.end)
        ground.wait_for("waiting for a vehicle", 20)
        sock = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        sock.connect(("127.0.0.1", port))
        flood = Flood(sock, rate)
        flood.send(watch, WARM_UP)
        pids = family(ground.pid)
        before, began = cpu_seconds(pids), time.monotonic()
        flood.send(watch, window)
        return 100 * (cpu_seconds(pids) - before) / (time.monotonic() - began)
