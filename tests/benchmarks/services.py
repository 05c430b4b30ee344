"""How long parameters, a mission of 200 items and a log of 1 MB take from a real vehicle, as a share of the link.

On a serial line the reference is the wire: the time of the bytes that must travel at its baud rate, both directions one
after the other where the protocol makes them wait for each other. On UDP loopback, which limits nothing, the reference
is the barest form of both ends (bare_services.py), in turns with ours.
"""

from __future__ import annotations

import asyncio
import random
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from statistics import median

from tests.benchmarks import service_jobs as jobs
from tests.benchmarks.baud_cable import BITS_PER_BYTE
from tests.benchmarks.driven_download import LOG_SIZE, QUICK_LOG_SIZE, Part, drive, judge
from tests.benchmarks.figures import ROUNDS, Goal, Options, Report, Table, brief
from tests.benchmarks.programs import free_port, on_pipe, python, scratch
from tests.benchmarks.station import Station, connected
from tests.benchmarks.watch import Watch

BAUD = 57600
LOG, WIRE_LOG, QUICK_WIRE_LOG = 1_000_000, 250_000, 50_000
"""Bytes on the network and on the wire, where a megabyte takes four minutes."""
ARMED = "parameter list, armed"
ARDUROVER = 30.9
"""s of ArduRover's list at 57600 baud, with more parameters than ours; the figure was measured before."""
LOG_RATE = 2.0
"""MB/s of a log on UDP loopback while nobody drives; link/services/pacing.py allows 2.8."""
LEAST = {jobs.FILE: 80.0, ARMED: 25.0, jobs.UPLOAD: 60.0, jobs.DOWNLOAD: 60.0}
"""% of the wire: the share of bulk in vehicle/telemetry/bandwidth.py while the vehicle cannot be driven and while it
can.

It is less its steps; an item of a mission waits for the one before it.
"""


def run(options: Options) -> Report:
    """Measure the network first, then the wire."""
    report = Report()
    _on_network(options, report)
    _on_wire(options, report)
    return report


def _on_network(options: Options, report: Report) -> None:
    size = LOG
    ours: jobs.Times = {}
    bare: jobs.Times = {}
    with ExitStack() as stack:
        folder, watch = stack.enter_context(scratch()), Watch()
        stack.callback(watch.close)
        port, bare_port = free_port(), free_port()
        stack.enter_context(_vehicle(watch, folder, size, f"udpin:127.0.0.1:{port}"))
        parameters = 0

        async def all_jobs(station: Station) -> None:
            nonlocal parameters
            await jobs.fetch_params(station, ours)
            await jobs.upload(station, ours)
            await jobs.download(station, ours)
            await jobs.fetch_log(station, ours, size)
            parameters = len(station.params.params)

        for turn in range(ROUNDS):
            options.say(f"services: round {turn + 1} of {ROUNDS}, UDP loopback")
            asyncio.run(connected(f"udpout:127.0.0.1:{port}", all_jobs))
            if turn == 0:
                words = python("tests.benchmarks.bare_services", str(bare_port), str(parameters), str(_log(folder)))
                server = on_pipe(watch, words)
                stack.callback(server.end)
                server.wait_for("ready", 20)
            jobs.bare_round(bare_port, bare, size)
    note = (
        f"{parameters} parameters, a log of {size:,} bytes. bare: the same by blocking loops without pacing, checks "
        "and repeats. Ours is paced (link/services/pacing.py) and goes on at the vehicle's control cycles."
    )
    table = Table("Parameters, missions and logs on UDP loopback, s", note=note)
    for name, times in ours.items():
        taken, reference = median(times), median(bare[name])
        table.rows.append({"job": name, "taken": taken, "bare": reference, "x": taken / reference})
    report.tables.append(table)
    rate = size / median(ours[jobs.FILE]) / 1e6
    plain = f"bare pair, {brief(size / median(bare[jobs.FILE]) / 1e6)} MB/s"
    report.goals.append(Goal("log on UDP loopback while nobody drives", rate, LOG_RATE, "MB/s", True, plain))


def _on_wire(options: Options, report: Report) -> None:
    size, driven_size = (QUICK_WIRE_LOG, QUICK_LOG_SIZE) if options.quick else (WIRE_LOG, LOG_SIZE)
    parts: dict[str, Part] = {}
    times: jobs.Times = {}
    needed: dict[str, int] = {}
    rounds = 1 if options.quick else ROUNDS

    async def all_jobs(station: Station) -> None:
        for number in range(rounds):
            options.say(f"services: round {number + 1} of {rounds}, {BAUD} baud")
            await jobs.fetch_params(station, times)
            await jobs.upload(station, times)
            await jobs.download(station, times)
        options.say(f"services: a log of {size:,} bytes, {BAUD} baud")
        await jobs.fetch_log(station, times, size)
        await station.arm()
        await jobs.fetch_params(station, times, ARMED)
        options.say(f"services: driving, {BAUD} baud")
        parts.update(await drive(station, times, quick=options.quick))
        needed.update(jobs.wire_bytes(station, size))
        needed.update({ARMED: needed[jobs.PARAMS], jobs.DRIVEN_FILE: jobs.log_bytes(driven_size)})

    with ExitStack() as stack:
        folder, watch = stack.enter_context(scratch()), Watch()
        stack.callback(watch.close)
        ends = folder / "vehicle", folder / "ground"
        cable = on_pipe(watch, python("tests.benchmarks.baud_cable", *map(str, ends), str(BAUD), "0"))
        stack.callback(cable.end)
        cable.wait_for("cable ready", 20)
        motors = folder / "motors"
        words = ["--motor-log", str(motors), "--param", "MOT_SLEWRATE=1000"]
        stack.enter_context(_vehicle(watch, folder, size, f"serial:{ends[0]}:{BAUD}", *words))
        (_log(folder).parent / jobs.DRIVEN_LOG).write_bytes(random.Random(6).randbytes(driven_size))
        asyncio.run(connected(f"serial:{ends[1]}:{BAUD}", all_jobs))
        share = 100 * needed[jobs.DRIVEN_FILE] * BITS_PER_BYTE / BAUD / median(times[jobs.DRIVEN_FILE])
        driven, late = judge(parts, motors, share, BAUD)

    note = (
        f"A log of {size:,} bytes. `wire`: of the bytes that must travel, alone on the line; telemetry flows beside "
        "them. `share`: of the wire that the job had."
    )
    table = Table(f"Parameters, missions and logs at {BAUD} baud, s", note=note)
    for name, each in times.items():
        wire = needed[name] * BITS_PER_BYTE / BAUD
        table.rows.append({"job": name, "taken": median(each), "wire": wire, "share %": 100 * wire / median(each)})
    report.tables += [table, driven]
    shares = {row["job"]: row["share %"] for row in table.rows}
    report.goals += [
        Goal(
            f"parameter list at {BAUD} baud (ArduRover's longer one: 30.9 s)",
            median(times[jobs.PARAMS]),
            ARDUROVER,
            "s",
            reference=f"on the wire alone, {brief(needed[jobs.PARAMS] * BITS_PER_BYTE / BAUD)} s",
        ),
        *(
            Goal(f"{name} at {BAUD} baud, share of the wire", shares[name], least, "%", True, "the wire")
            for name, least in LEAST.items()
        ),
        *late,
    ]


@contextmanager
def _vehicle(watch: Watch, folder: Path, size: int, endpoint: str, *words: str) -> Iterator[None]:
    """Start a simulated rover with a log of `size` bytes."""
    log = _log(folder)
    log.parent.mkdir(parents=True)
    log.write_bytes(random.Random(5).randbytes(size))
    vehicle = on_pipe(watch, python("vehicle", "--sim", endpoint, "--state", str(folder / "state"), *words))
    try:
        vehicle.wait_for("ready", 20)
        yield
    finally:
        vehicle.end()


def _log(folder: Path) -> Path:
    return folder / "state" / "logs" / jobs.LOG_NAME
