"""How late the control cycles of the real vehicle process are at 50 Hz, on an idle machine and on a busy one.

Measured from outside: the vehicle drives motors that record when each cycle reaches them (ticking.py), armed and driven
at 20 Hz by a small ground station over UDP. Two bare loops do the same in turn.
"""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from functools import partial
from pathlib import Path

from dialects.axes import Axes, build_manual_control
from dialects.enums import Autopilot, Command, SystemState, VehicleType
from dialects.messages import CommandLong, Heartbeat, Message
from tests.benchmarks.figures import ROUNDS, BenchmarkError, Goal, Options, Report, Row, Table, brief, spread
from tests.benchmarks.programs import free_port, on_pipe, python, scratch
from tests.benchmarks.ticking import PERIOD, read
from tests.benchmarks.traffic import framed
from tests.benchmarks.watch import Watch

SECONDS, QUICK_SECONDS = 2.6, 0.8
"""s of one contender under one load in one round."""
SKIPPED = 0.3
"""s after a change of the load, in which the scheduler moves the processes."""
LONGEST = 60.0
"""s after which a busy child ends in any case."""

DEMANDS = 0.05
"""s between two demands: 20 Hz, as our ground station sends them."""
NEUTRAL_FIRST = 20
"""Neutral demands after arming; the vehicle accepts others only after them."""

OURS, ASYNCIO, BLOCKING = "vehicle, driven at 20 Hz", "bare asyncio loop", "bare blocking loop"
IDLE, OTHER, ALL = "idle", "one core busy", "all cores busy"
CORES = len(os.sched_getaffinity(0))
LOADS = {IDLE: 0, OTHER: 1, ALL: CORES}
"""Name -> busy processes, at normal priority and free to move."""

BUSY = "import sys, time; end = time.monotonic() + float(sys.argv[1])\nwhile time.monotonic() < end: pass"
GOAL_BEYOND = 1.0
"""ms that a cycle with all its work may be later, at p99, than a bare loop of the same kind."""

Contender = Callable[[Path], AbstractContextManager[Callable[[float], None]]]
"""Starts a contender, given a folder; yields a function that lets time pass."""

Samples = dict[tuple[str, str], list[list[float]]]
"""(contender, load) -> ms late, a list per round."""


def run(options: Options) -> Report:
    """Measure all contenders in turn, each under all loads, round by round."""
    seconds = QUICK_SECONDS if options.quick else SECONDS
    samples: Samples = {(name, load): [] for load in LOADS for name in CONTENDERS}
    for turn in range(ROUNDS):
        for name, contender in CONTENDERS.items():
            options.say(f"loop_lateness: round {turn + 1} of {ROUNDS}, {name}")
            with scratch() as folder, contender(folder) as pause:
                for load, children in LOADS.items():
                    samples[name, load].append(_under(children, pause, folder, seconds))
    return _report(samples)


def _under(children: int, pause: Callable[[float], None], folder: Path, seconds: float) -> list[float]:
    """Return the lateness of the cycles within `seconds`, ms."""
    with _busy(children):
        pause(SKIPPED)
        before = len(read(folder / "stamps"))
        pause(seconds)
        stamps = read(folder / "stamps")[before:]
    if len(stamps) < seconds / PERIOD / 2:
        raise BenchmarkError(f"only {len(stamps)} control cycles in {seconds} s; is it armed?")
    return lateness(stamps)


def lateness(stamps: Sequence[int]) -> list[float]:
    """Return the lateness of cycles that should be PERIOD apart, ms.

    The deadlines are not visible: the earliest cycle counts as on time. The loops skip nothing: a cycle that comes
    after the next one's deadline moves the deadlines that follow.
    """
    late: list[float] = []
    due = float(stamps[0])
    for stamp in stamps:
        late.append((stamp - due) / 1e6)
        due = max(due + PERIOD * 1e9, stamp)
    earliest = min(late)
    return [each - earliest for each in late]


@contextmanager
def _busy(children: int) -> Iterator[None]:
    argv = [sys.executable, "-c", BUSY, str(LONGEST)]
    with ExitStack() as stack:
        for _ in range(children):
            child = subprocess.Popen(argv, stdin=subprocess.DEVNULL)
            stack.callback(child.wait)
            stack.callback(child.kill)
        yield


# ---- contenders ----


@contextmanager
def _vehicle(folder: Path) -> Iterator[Callable[[float], None]]:
    port = free_port()
    config = folder / "rover.toml"
    config.write_text(
        f'endpoints = ["udpin:127.0.0.1:{port}"]\nstate = "{folder}/state"\n'
        f'[motors]\ndriver = "tests.benchmarks.ticking:Motors"\nstamps = "{folder}/stamps"\n'
    )
    with _process(python("vehicle", "--config", str(config)), "ready") as watch, Driver(port, watch) as driver:
        driver.arm(folder / "stamps")
        yield driver.drive


@contextmanager
def _reference(kind: str, folder: Path) -> Iterator[Callable[[float], None]]:
    with _process(python("tests.benchmarks.ticking", kind, str(folder / "stamps"))) as watch:
        if not _begins(watch, folder / "stamps"):
            raise BenchmarkError(f"the {kind} loop did not begin")
        yield watch.pause


def _begins(watch: Watch, stamps: Path) -> bool:
    for _ in range(100):
        watch.pause(DEMANDS)
        if read(stamps):
            return True
    return False


@contextmanager
def _process(argv: list[str], ready: str = "") -> Iterator[Watch]:
    watch = Watch()
    program = on_pipe(watch, argv)
    try:
        program.wait_for(ready, 20)
        yield watch
    finally:
        program.end()
        watch.close()


CONTENDERS: dict[str, Contender] = {
    OURS: _vehicle,
    ASYNCIO: partial(_reference, "asyncio"),
    BLOCKING: partial(_reference, "blocking"),
}


class Driver:
    """The smallest ground station: a heartbeat, arming, a demand. A steady demand changes nothing between cycles."""

    def __init__(self, port: int, watch: Watch) -> None:
        self._watch = watch
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.connect(("127.0.0.1", port))
        self._socket.setblocking(False)
        watch.add(self._socket.fileno(), self._read)
        self._sequence = 0

    def __enter__(self) -> Driver:
        return self

    def __exit__(self, *_: object) -> None:
        self._watch.remove(self._socket.fileno())
        self._socket.close()

    def arm(self, stamps: Path) -> None:
        """Wait until the cycles reach the motors, and then for a steady speed."""
        for _ in range(10):
            self._send(Heartbeat(VehicleType.GCS, Autopilot.INVALID, 0, 0, SystemState.ACTIVE, 3))
            self._watch.pause(0.2)
            self._send(CommandLong(1, 1, Command.COMPONENT_ARM_DISARM, 0, 1, 0, 0, 0, 0, 0, 0))
            self._demand(Axes(), NEUTRAL_FIRST)
            if read(stamps):
                return self.drive(1.0)
        raise BenchmarkError("the vehicle did not arm")

    def drive(self, seconds: float) -> None:
        """Let time pass at the same speed."""
        self._demand(Axes(throttle=0.3), round(seconds / DEMANDS))

    def _demand(self, axes: Axes, times: int) -> None:
        for number in range(times):
            if number % 10 == 0:
                self._send(Heartbeat(VehicleType.GCS, Autopilot.INVALID, 0, 0, SystemState.ACTIVE, 3))
            self._send(build_manual_control(axes, 1))
            self._watch.pause(DEMANDS)

    def _send(self, message: Message) -> None:
        self._sequence = (self._sequence + 1) & 0xFF
        self._socket.send(framed(message, self._sequence, 255, 190))

    def _read(self) -> bool:
        self._socket.recv(65536)
        return True


# ---- report ----


def _report(samples: Samples) -> Report:
    rows = [_row(name, load, rounds) for (name, load), rounds in samples.items()]
    note = (
        f"{CORES} cores; `busy`: one process that only counts, or one a core. p50 is the median of the rounds' "
        "medians; p99 and max are of all cycles. Late against the earliest cycle of the same 3 s."
    )
    goals = []
    for load in LOADS:
        ours, bare = (spread(samples[name, load]).p99 for name in (OURS, ASYNCIO))
        what, beside = f"cycle late, {load}, p99, more than a bare asyncio loop's", f"bare loop, {brief(bare)} ms"
        goals.append(Goal(what, ours - bare, GOAL_BEYOND, "ms", reference=beside))
    return Report([Table("Lateness of control cycles at 50 Hz, ms", rows, note)], goals)


def _row(name: str, load: str, rounds: list[list[float]]) -> Row:
    each = spread(rounds)
    return {"loop": name, "machine": load, "cycles": each.samples, "p50": each.p50, "p99": each.p99, "max": each.max}
