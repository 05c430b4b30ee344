"""What recording costs the station: its CPU at 1000 messages a second with and without, in turns."""

from __future__ import annotations

import socket
import time
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median

from groundstation.client import StationClient
from groundstation.intents.session import RenewLease
from groundstation.recording.options import RecordOptions
from tests.benchmarks.cost import FLOOD, WARM_UP, Flood
from tests.benchmarks.figures import ROUNDS, BenchmarkError, Goal, Options, Report, Row, Table, brief
from tests.benchmarks.procfs import cpu_seconds, family
from tests.benchmarks.programs import free_port, scratch
from tests.benchmarks.watch import Watch

WINDOW, QUICK_WINDOW = 6.0, 3.0
"""s over which CPU time is counted."""
LEASE = 0.1
"""s between renewals of the lease, as of the screen."""
LIMIT = 3.0
"""% of a core that recording may cost."""
OFF, ON = "without", "with recording"


@dataclass(slots=True)
class Cost:
    """One value per round."""

    cpu: list[float] = field(default_factory=list)
    """% of a core."""
    written: list[float] = field(default_factory=list)
    """kB/s of the log."""

    def row(self, name: str) -> Row:
        """Return the costs as a row of the table."""
        return {
            "station": name,
            "CPU %": median(self.cpu),
            "CPU % of rounds": " / ".join(f"{value:.1f}" for value in self.cpu),
            "log, kB/s": median(self.written),
        }


def run(options: Options) -> Report:
    """Measure in turns."""
    costs = {OFF: Cost(), ON: Cost()}
    for turn in range(ROUNDS):
        for name, cost in costs.items():
            options.say(f"recording: round {turn + 1} of {ROUNDS}, {name}")
            _measure(cost, QUICK_WINDOW if options.quick else WINDOW, recorded=name == ON)
    extra = median(costs[ON].cpu) - median(costs[OFF].cpu)
    plain = f"without, {brief(median(costs[OFF].cpu))} %"
    table = Table(f"Station process at {FLOOD} messages/s", [cost.row(name) for name, cost in costs.items()])
    return Report([table], [Goal(f"recording at {FLOOD} messages/s", extra, LIMIT, "% of a core", False, plain)])


def _measure(cost: Cost, window: float, *, recorded: bool) -> None:
    with scratch() as folder, closing(Watch()) as watch:
        port = free_port()
        options = RecordOptions(folder, 100, 2000) if recorded else None
        client = StationClient.start([f"udpin:127.0.0.1:{port}"], record=options)
        try:
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
                sock.connect(("127.0.0.1", port))
                _flood(client, Flood(sock), watch, WARM_UP)
                pids, size = family(client.pid), _size(folder)
                before, started = cpu_seconds(pids), time.monotonic()
                _flood(client, Flood(sock), watch, window)
                spent = time.monotonic() - started
                cost.cpu.append(100 * (cpu_seconds(pids) - before) / spent)
                cost.written.append((_size(folder) - size) / spent / 1000)
        finally:
            client.close()
    if recorded and not cost.written[-1]:
        raise BenchmarkError("nothing was recorded")


def _flood(client: StationClient, flood: Flood, watch: Watch, seconds: float) -> None:
    for _ in range(round(seconds / LEASE)):
        client.send(RenewLease())
        client.receive()
        flood.send(watch, LEASE)


def _size(folder: Path) -> int:
    return sum(path.stat().st_size for path in folder.iterdir())
