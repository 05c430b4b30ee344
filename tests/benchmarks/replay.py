"""A long telemetry log in the replay process: open to first snapshot, index, jumps to random moments, memory."""

from __future__ import annotations

import random
import select
import struct
import time
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from statistics import median

from groundstation.client import StationClient
from groundstation.intents.replay import ReplayGoTo
from groundstation.snapshot import ReplayStatus, Snapshot
from link.tlog.tlog import encode_record, read_records
from tests.benchmarks.figures import BenchmarkError, Goal, Options, Report, Table
from tests.benchmarks.procfs import cpu_seconds, family, memory
from tests.benchmarks.programs import scratch

SOURCE = Path(__file__).parents[1] / "recordings" / "ardurover.tlog"
FULL, QUICK = 1_000_000_000, 50_000_000
"""Bytes of the log."""
JUMPS = 10
PAUSE = 100_000
"""us between two copies of the recording in the log."""
PATIENCE = 300.0
"""s for each wait."""

FIRST_LIMIT, JUMP_LIMIT, INDEX_LIMIT, MEMORY_LIMIT = 1.0, 0.3, 30.0, 250.0
"""s to the first snapshot, s of a jump, s of the index of 1 GB, MiB."""


def run(options: Options) -> Report:
    """Write the log, open it once and move in it."""
    size = QUICK if options.quick else FULL
    with scratch() as folder:
        options.say(f"replay: writing a log of {size / 1e6:.0f} MB")
        log = folder / "long.tlog"
        write_log(log, size)
        options.say("replay: opening it")
        return _measure(log, log.stat().st_size)


def write_log(path: Path, size: int) -> None:
    """Repeat the recording, with times that go on, up to a size."""
    records = list(read_records(SOURCE.read_bytes()))
    block, places = bytearray(), []
    for record in records:
        places.append((len(block), record.microseconds))
        block += encode_record(record.microseconds, record.raw)
    span, put = places[-1][1] - places[0][1] + PAUSE, struct.Struct(">Q").pack_into
    with path.open("wb") as file:
        for copy in range(-(-size // len(block))):
            later = copy * span
            for at, stamp in places:
                put(block, at, stamp + later)
            file.write(block)


def _measure(log: Path, size: int) -> Report:
    started = time.monotonic()
    with closing(StationClient.start_replay(log)) as client:
        _wait(client, lambda snapshot, status: snapshot.vehicle is not None)
        first = time.monotonic() - started
        pids = family(client.pid)
        status = _wait(client, lambda snapshot, status: status.indexed >= 1.0)
        index, busy = time.monotonic() - started, cpu_seconds(pids)
        jumps = _jump(client, status)
        resident = memory(pids).rss
    row = {
        "log, MB": size / 1e6,
        "hours": status.duration / 3600,
        "first snapshot, s": first,
        "index, s": index,
        "CPU until then, s": busy,
        "jump, median s": median(jumps),
        "jump, worst s": max(jumps),
        "RSS, MiB": resident,
    }
    note = "The index is complete before the checksums of all frames are checked, which goes on during the jumps."
    whole = first + (index - first) * FULL / size  # of 1 GB, also where the log is shorter
    return Report([Table("Replay of a long log", [row], note)], _goals(first, whole, jumps, resident))


def _goals(first: float, index: float, jumps: list[float], resident: float) -> list[Goal]:
    return [
        Goal("open a log to its first snapshot", first, FIRST_LIMIT, "s"),
        Goal("index of 1 GB, without the pass of checksums", index, INDEX_LIMIT, "s"),
        Goal(f"worst of {JUMPS} jumps", max(jumps), JUMP_LIMIT, "s"),
        Goal("memory of the replay process", resident, MEMORY_LIMIT, "MiB"),
    ]


def _jump(client: StationClient, status: ReplayStatus) -> list[float]:
    """Return how long jumps to random moments take, from the key to the snapshot."""
    chance, took = random.Random(1), []
    for _ in range(JUMPS):
        seconds, seeks = chance.uniform(0.0, status.duration), status.seeks
        started = time.monotonic()
        client.send(ReplayGoTo(f"{seconds // 60:.0f}:{seconds % 60:.1f}"))
        status = _wait(client, lambda snapshot, status, seeks=seeks: status.seeks != seeks)  # type: ignore[misc]
        took.append(time.monotonic() - started)
        if abs(status.position - seconds) > 1.0:
            raise BenchmarkError(f"the replay is at {status.position:.1f} s and not at {seconds:.1f} s")
    return took


def _wait(client: StationClient, wanted: Callable[[Snapshot, ReplayStatus], bool]) -> ReplayStatus:
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        select.select(client.filenos(), [], [], 1.0)
        snapshot = client.receive()
        if snapshot is not None and snapshot.replay is not None and wanted(snapshot, snapshot.replay):
            return snapshot.replay
        if not client.alive:
            raise BenchmarkError("the replay process has ended")
    raise BenchmarkError(f"nothing within {PATIENCE:.0f} s")
