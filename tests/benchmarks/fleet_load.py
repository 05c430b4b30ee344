"""100 and 500 vehicles of a fleet at 50 messages/s: CPU and memory of router, ground station and vehicle.

One vehicle is a real one, the others are sessions that send telemetry (fleet_members.py), to who does not look at them
each kind once a second, as real ones do. The ground station shows its Links screen and looks at one of them. Beside it,
in the same run, the same ground station with 100 vehicles on plain UDP.
"""

from __future__ import annotations

import re
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from groundstation.vehicles.state.vehicle_heartbeat import MAX_VEHICLES
from link.bridge.fleet.members import add_member
from tests.benchmarks.figures import BenchmarkError, Goal, Options, Report, Row, Table, brief
from tests.benchmarks.fleet_sender import RATE
from tests.benchmarks.procfs import cpu_seconds, family, memory
from tests.benchmarks.programs import Program, free_port, on_pipe, on_terminal, python, scratch
from tests.benchmarks.watch import Watch
from tests.e2e.fleet_programs import RouterProcess, make_fleet

SIZES = (100, 500)
"""Vehicles; of the larger number a ground station shows MAX_VEHICLES, and a counter gets all that they send."""
WHOLE_FLEET = 250
"""Vehicles with a system id of their own, which is all that a fleet can have."""
SHOWN = SIZES[0]
SECONDS, QUICK_SECONDS = 15.0, 4.0
READY_WITHIN = 120.0
SETTLE = 5.0
STARTED = 5000
"""Bytes that a ground station has drawn once it shows a screen."""
LINKS_SCREEN = b"\x1b[18~"
COLUMNS, LINES = 140, 45
CPU_LIMIT = 40.0
"""% of a core for a screen with 100 vehicles."""
PRESENT_WITHIN = 2.0
"""s until a vehicle is known to a ground station."""


@dataclass(frozen=True, slots=True)
class _Use:
    """What a program takes."""

    cpu: float
    """% of a core."""
    rss: float
    """MiB."""


@dataclass(frozen=True, slots=True)
class _Present:
    """s until a vehicle was on the screen."""

    started: float
    """From the start of its program."""
    connected: float
    """From when it said that it is connected."""


def run(options: Options) -> Report:
    """Measure each size, and the reference."""
    seconds = QUICK_SECONDS if options.quick else SECONDS
    rows: list[Row] = []
    watch = Watch()
    with scratch() as folder, ExitStack() as stack:
        options.say(f"fleet_load: certificates of {SIZES[-1]} vehicles")
        fleet = make_fleet(folder, rover="vehicle", alice="drive", bob="watch")
        for each in range(1, SIZES[-1] + 1):
            add_member(fleet / "fleet.toml", f"v{each}", "vehicle")
        router = RouterProcess(fleet, stack)
        options.say(f"fleet_load: {SHOWN} vehicles, a ground station")
        row, present = _with_station(watch, router, fleet, seconds, SHOWN, SHOWN)
        options.say(f"fleet_load: {row}, present after {present}; now {WHOLE_FLEET} vehicles")
        whole, _ = _with_station(watch, router, fleet, seconds, WHOLE_FLEET, MAX_VEHICLES)
        options.say(f"fleet_load: {whole}; now {SIZES[-1]} vehicles")
        larger, _ = _with_station(watch, router, fleet, seconds, SIZES[-1], None)
        options.say(f"fleet_load: {larger}; now a counter")
        rows += [row, whole, larger, _with_counter(watch, router, fleet, seconds)]
    options.say(f"fleet_load: {SHOWN} vehicles on UDP")
    reference = _on_udp(watch, seconds)
    goals = [
        Goal(
            f"CPU of the ground station, {SHOWN} vehicles of a fleet at {RATE} messages/s",
            row["station CPU %"],
            CPU_LIMIT,
            "%",
            reference=f"the same on plain UDP, {brief(reference['station CPU %'])} %",
        ),
        Goal("a vehicle is on the screen, from the start of its program", present.started, PRESENT_WITHIN, "s"),
        Goal("a vehicle is on the screen, once it is connected", present.connected, PRESENT_WITHIN, "s"),
        Goal(f"{SIZES[-1]} vehicles, messages delivered by the router", rows[-1]["delivered %"], 99.0, "%", True),
    ]
    note = (
        f"{RATE} messages/s of each vehicle, all of them to a counter. TLS, certificates and access rules for "
        f"{SIZES[-1] + 3} members."
    )
    return Report([Table("Many vehicles of one fleet", [*rows, reference], note)], goals)


def _with_station(
    watch: Watch, router: RouterProcess, fleet: Path, seconds: float, vehicles: int, shown: int | None
) -> tuple[Row, _Present]:
    """Measure with a real ground station, and one real vehicle that comes last; return also when that was present.

    `shown`: vehicles that must be on the screen; None to say how many there are, where this machine is too small.
    """
    with (
        _members(watch, fleet, 1, vehicles - 1),
        _ended(
            on_terminal(watch, python("groundstation", f"zenoh:{fleet}/alice.json5/farm"), COLUMNS, LINES)
        ) as station,
    ):
        _show_links(watch, station)
        if shown is not None:
            _heard(watch, station, min(vehicles - 1, shown))
        rover = f"zenoh:{fleet}/rover.json5/farm/rover"
        started = time.monotonic()
        with _ended(on_pipe(watch, python("vehicle", "--sim", rover, "--param", "MAV_SYSID=251"))) as vehicle:
            vehicle.wait_for("connected", READY_WITHIN)
            connected = time.monotonic()
            if shown is not None:
                _heard(watch, station, shown)
            present = _Present(time.monotonic() - started, time.monotonic() - connected)
            uses = _measure(
                watch, {"router": router.process.pid, "station": station.pid, "vehicle": vehicle.pid}, seconds
            )
        row = _row("fleet", vehicles, uses, None) | {"on the screen": _count_heard(station.text)}
    return row, present


def _with_counter(watch: Watch, router: RouterProcess, fleet: Path, seconds: float) -> Row:
    """Measure the router with all vehicles."""
    count = SIZES[-1]
    with (
        _members(watch, fleet, 1, count),
        _ended(on_pipe(watch, python("tests.benchmarks.fleet_members", str(fleet), "listen"))) as counter,
    ):
        counter.wait_for(f"heard {count} vehicles", READY_WITHIN)
        watch.pause(2.0)
        before, begun = _count(counter), time.monotonic()
        uses = _measure(watch, {"router": router.process.pid}, seconds)
        watch.pause(1.5)
        arrived = (_count(counter) - before) / (time.monotonic() - begun)
    return _row("fleet, a counter", count, uses, 100 * arrived / (count * RATE))


def _on_udp(watch: Watch, seconds: float) -> Row:
    port = free_port()
    with _ended(on_terminal(watch, python("groundstation", f"udpin:127.0.0.1:{port}"), COLUMNS, LINES)) as station:
        _await_start(watch, station)
        with _ended(on_pipe(watch, python("tests.benchmarks.fleet_sender", str(SHOWN), str(port)))):
            _show_links(watch, station)
            return _row("plain UDP", SHOWN, _measure(watch, {"station": station.pid}, seconds), None)


def _await_start(watch: Watch, station: Program) -> None:
    if not watch.until(lambda: station.received > STARTED, READY_WITHIN):
        raise BenchmarkError(f"the ground station does not start: {station.text[-300:]!r}")


def _show_links(watch: Watch, station: Program) -> None:
    """Open the Links screen, once the station draws, and let it hear all vehicles."""
    _await_start(watch, station)
    watch.pause(SETTLE)
    station.type(LINKS_SCREEN)
    watch.pause(SETTLE)


def _heard(watch: Watch, station: Program, vehicles: int) -> None:
    """Wait until the screen says that so many vehicles are heard."""
    texts = f"{vehicles} heard", f"{vehicles} of "  # of more than it has places for
    if not watch.until(lambda: any(each in station.text for each in texts), READY_WITHIN):
        raise BenchmarkError(f"{vehicles} vehicles are not on the screen: {station.text[-300:]!r}")


def _count_heard(text: str) -> int | None:
    """Return how many vehicles the screen says that it hears; of more than it has places for, those that it shows."""
    found = re.findall(r"(\d+) (?:heard|of \d+ )", text)
    return int(found[-1]) if found else None


def _measure(watch: Watch, programs: dict[str, int], seconds: float) -> dict[str, _Use]:
    families = {name: family(pid) for name, pid in programs.items()}
    before, begun = {name: cpu_seconds(pids) for name, pids in families.items()}, time.monotonic()
    watch.pause(seconds)
    took = time.monotonic() - begun
    return {
        name: _Use(100 * (cpu_seconds(pids) - before[name]) / took, memory(pids).rss) for name, pids in families.items()
    }


def _row(way: str, vehicles: int, uses: dict[str, _Use], delivered: float | None) -> Row:
    row: Row = {"way": way, "vehicles": vehicles, "messages/s": vehicles * RATE}
    for name in ("router", "station", "vehicle"):
        use = uses.get(name)
        row |= {f"{name} CPU %": use.cpu if use else None, f"{name} MiB": use.rss if use else None}
    return row | {"delivered %": delivered, "on the screen": None}


def _count(counter: Program) -> int:
    return int(re.findall(r"(\d+) messages", counter.text)[-1])


@contextmanager
def _members(watch: Watch, fleet: Path, first: int, count: int) -> Iterator[None]:
    """Run the process of so many vehicles."""
    words = (str(fleet), str(first), str(count), str(RATE))
    with _ended(on_pipe(watch, python("tests.benchmarks.fleet_members", *words))) as members:
        members.wait_for("members ready", READY_WITHIN)
        yield


@contextmanager
def _ended(program: Program) -> Iterator[Program]:
    try:
        yield program
    finally:
        program.end()
