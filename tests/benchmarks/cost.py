"""Start-up time, memory and CPU of both programs, idle and driving, beside a bare Python and a bare Textual program."""

from __future__ import annotations

import socket
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from statistics import median

from tests.benchmarks.figures import ROUNDS, BenchmarkError, Goal, Options, Report, Row, Table, brief, spread
from tests.benchmarks.key_to_motor import CONTENDERS, OURS_NARROW, OURS_WIDE, Rig, running
from tests.benchmarks.procfs import cpu_seconds, family, memory
from tests.benchmarks.programs import Program, free_port, on_pipe, on_terminal, python, scratch
from tests.benchmarks.traffic import mix
from tests.benchmarks.watch import Watch

WINDOW, QUICK_WINDOW = 5.0, 2.0
"""s over which CPU time is counted."""
WARM_UP = 1.5
"""s before that, because what a program does once at its start is start-up time."""

STARTS = 3
"""Starts of each program in each round."""

REPEATS = 30.0
"""Hz of a held key, as most systems repeat it."""

FLOOD = 1000
"""Messages a second, the highest rate in performance.md; ArduPilot can be asked for as many."""
FLOOD_STEP = 0.01
KEY_GAP = 0.3
"""s between two of the keys that choose what is drawn."""

CHARTED = """
roll pitch yaw rollspeed pitchspeed yawspeed airspeed groundspeed servo1_raw servo2_raw servo3_raw servo4_raw
servo5_raw servo6_raw servo7_raw servo8_raw lat lon alt relative_alt vx vy vz hdg
"""
"""Fields of the flood, four for each chart."""

GROUND_MEMORY = 85.8
"""MiB, which is 90 MB, of the ground station's three processes. PSS, because the watchdog is a fork of the station: RSS
counts what both share twice, and the libraries three times."""

SIZE = (140, 45)
BARE_PYTHON = [sys.executable, "-c", "input('bare python ready')"]
DRIVING = {OURS_WIDE: "driving", OURS_NARROW: "driving at 80x24"}
"""Terminal -> the state in the table."""
GROUND, VEHICLE, PYTHON, TEXTUAL = "mavhelm", "mavhelm vehicle --sim", "bare python", "bare Textual app"
LOOP = "bare asyncio loop at 50 Hz"

MULTIPLES = (
    (f"{GROUND}, first paint", TEXTUAL, 1.9), (f"{GROUND} --sitl, rover on the screen", TEXTUAL, 2.2),
    (f"{VEHICLE}, ready", PYTHON, 12.0),
)  # fmt: skip
"""A start, beside which other one, and how many times as long it may take."""


def run(options: Options) -> Report:
    """Measure the starts first, then the cost of the running programs."""
    goals: list[Goal] = []
    return Report([_starts(options, goals), _running_costs(options, goals)], goals)


# ---- start-up ----


@dataclass(frozen=True, slots=True)
class Start:
    """A program, and the word in its output that shows that it has started."""

    argv: list[str]
    word: str
    terminal: bool = True


def _starters() -> dict[str, Start]:
    endpoint = f"127.0.0.1:{free_port()}"
    return {
        PYTHON: Start(BARE_PYTHON, "bare python ready"),
        TEXTUAL: Start(python("tests.benchmarks.bare_textual"), "bare textual ready"),
        f"{VEHICLE}, ready": Start(
            python("link.program", "vehicle", "--sim", f"udpout:{endpoint}"), "ready", terminal=False
        ),
        f"{GROUND}, first paint": Start(python("link.program", f"udpin:{endpoint}"), "waiting for a vehicle"),
        f"{GROUND} --sitl, rover on the screen": Start(python("link.program", "--sitl"), "DISARMED"),
    }


def _starts(options: Options, goals: list[Goal]) -> Table:
    seen: dict[str, list[list[float]]] = {}
    for start in _starters().values():
        _start_time(start)  # the first one writes byte code
    for turn in range(ROUNDS):
        for name, start in _starters().items():
            options.say(f"cost: round {turn + 1} of {ROUNDS}, start of {name}")
            times = [_start_time(start) for _ in range(1 if options.quick else STARTS)]
            seen.setdefault(name, []).append(times)
    table = Table("From the start of the process, s")
    for name, rounds in seen.items():
        each = spread(rounds)
        table.rows.append({"program": name, "starts": each.samples, "p50": each.p50, "max": each.max})
    for what, reference, limit in MULTIPLES:
        taken, bare = _p50(seen, what), _p50(seen, reference)
        beside = f"{reference}, {brief(bare)} s"
        goals.append(Goal(f"start of {what}", taken / bare, limit, "x", reference=beside))
    return table


def _p50(seen: dict[str, list[list[float]]], name: str) -> float:
    return spread(seen[name]).p50


def _start_time(start: Start) -> float:
    watch = Watch()
    program = on_terminal(watch, start.argv, *SIZE) if start.terminal else on_pipe(watch, start.argv)
    try:
        return program.wait_for(start.word, 20)
    finally:
        program.end()
        watch.close()


# ---- memory and CPU ----


@dataclass(slots=True)
class Cost:
    """The cost of one program in one state; one value per round."""

    processes: int = 0
    rss: list[float] = field(default_factory=list)
    pss: list[float] = field(default_factory=list)
    cpu: list[float] = field(default_factory=list)

    def row(self, name: str) -> Row:
        """Return the costs as a row of the table."""
        return {
            "program": name,
            "processes": self.processes,
            "RSS MiB": median(self.rss),
            "PSS MiB": median(self.pss),
            "CPU %": median(self.cpu),
            "CPU % of rounds": " / ".join(f"{value:.1f}" for value in self.cpu),
        }


class Ledger:
    """The costs by program and state, and how they are measured."""

    def __init__(self, window: float) -> None:
        self.costs: dict[str, Cost] = {}
        self.window = window

    def book(self, programs: dict[str, Program], meanwhile: Callable[[float], None]) -> None:
        """Measure what `programs` use while `meanwhile` lets the window pass."""
        meanwhile(WARM_UP)
        pids = {name: family(program.pid) for name, program in programs.items()}
        before = {name: cpu_seconds(each) for name, each in pids.items()}
        started = time.monotonic()
        meanwhile(self.window)
        spent = time.monotonic() - started
        for name, each in pids.items():
            cost = self.costs.setdefault(name, Cost())
            used = memory(each)
            cost.processes = len(each)
            cost.rss.append(used.rss)
            cost.pss.append(used.pss)
            cost.cpu.append(100 * (cpu_seconds(each) - before[name]) / spent)


def _running_costs(options: Options, goals: list[Goal]) -> Table:
    ledger = Ledger(QUICK_WINDOW if options.quick else WINDOW)
    for turn in range(ROUNDS):
        for state in (_bare, _waiting, _connected, _connected_narrow, _flooded, _flooded_table, _flooded_charts):
            options.say(f"cost: round {turn + 1} of {ROUNDS}, {state.__name__.strip('_')}")
            state(ledger)
    goals += _goals(ledger.costs)
    note = "RSS counts shared pages in each process, PSS divides them. CPU: 100 % is one core."
    return Table("While running", [cost.row(name) for name, cost in ledger.costs.items()], note)


def _goals(costs: dict[str, Cost]) -> Iterator[Goal]:
    loop = f"bare loop at 50 Hz, {brief(median(costs[LOOP].cpu))} %"
    textual = f"{TEXTUAL} at rest, {brief(median(costs[TEXTUAL].cpu))} %"
    for what, name, limit in (
        ("mavhelm, CPU waiting", f"{GROUND}, waiting", 1.0),
        ("mavhelm, CPU with a rover that stands", f"{GROUND}, rover disarmed", 2.0),
        ("mavhelm, CPU driving", f"{GROUND}, driving", 8.0),
        ("mavhelm, CPU at 1000 messages/s", f"{GROUND}, {FLOOD} messages/s", 12.0),
        ("mavhelm, CPU at 1000 messages/s, Messages screen", f"{GROUND}, {FLOOD} messages/s, Messages", 20.0),
        ("mavhelm, CPU at 1000 messages/s, Charts with 24 lines", f"{GROUND}, {FLOOD} messages/s, Charts", 20.0),
        ("vehicle, CPU disarmed", f"{VEHICLE}, disarmed", 1.2),
        ("vehicle, CPU driving", f"{VEHICLE}, driving", 2.0),
    ):
        yield Goal(what, median(costs[name].cpu), limit, "%", reference=loop if VEHICLE in name else textual)
    for terminal, most in ((OURS_WIDE, 9.0), (OURS_NARROW, 6.0)):
        together = sum(median(costs[f"{each}, {DRIVING[terminal]}"].cpu) for each in (GROUND, VEHICLE))
        yield Goal(f"all processes, CPU driving, {terminal}", together, most, "%", reference=loop)
    used = median(costs[f"{GROUND}, driving"].pss)
    bare = f"{TEXTUAL}, {brief(median(costs[TEXTUAL].pss))} MiB"
    yield Goal("mavhelm driving, PSS of all its processes", used, GROUND_MEMORY, "MiB", reference=bare)
    bare = f"{PYTHON}, {brief(median(costs[PYTHON].rss))} MiB"
    yield Goal("vehicle, RSS", median(costs[f"{VEHICLE}, driving"].rss), 34, "MiB", reference=bare)


def _bare(ledger: Ledger) -> None:
    bare = {PYTHON: (BARE_PYTHON, "ready"), TEXTUAL: (python("tests.benchmarks.bare_textual"), "ready")}
    with scratch() as folder:
        bare[LOOP] = python("tests.benchmarks.ticking", "asyncio", str(folder / "stamps")), ""
        for name, (argv, word) in bare.items():
            with _alone(argv, word) as (watch, program):
                ledger.book({name: program}, watch.pause)


def _waiting(ledger: Ledger) -> None:
    with _alone(python("groundstation", f"udpin:127.0.0.1:{free_port()}"), "waiting for a vehicle") as (watch, program):
        ledger.book({f"{GROUND}, waiting": program}, watch.pause)


def _connected(ledger: Ledger) -> None:
    with running(CONTENDERS[OURS_WIDE]) as rig:
        standing = {f"{GROUND}, rover disarmed": rig.ground, f"{VEHICLE}, disarmed": rig.vehicle}
        ledger.book(standing, rig.watch.pause)
        _drive(ledger, rig, DRIVING[OURS_WIDE])


def _connected_narrow(ledger: Ledger) -> None:
    with running(CONTENDERS[OURS_NARROW]) as rig:
        _drive(ledger, rig, DRIVING[OURS_NARROW])


def _drive(ledger: Ledger, rig: Rig, state: str) -> None:
    rig.arm()
    driving = {f"{GROUND}, {state}": rig.ground, f"{VEHICLE}, {state}": rig.vehicle}
    ledger.book(driving, lambda seconds: _hold(rig, seconds))
    if not rig.feed.moving:
        raise BenchmarkError("the rover did not drive while the key was held")


def _hold(rig: Rig, seconds: float) -> None:
    """Hold a key down for this time."""
    start = time.monotonic()
    for repeat in range(round(seconds * REPEATS)):
        rig.watch.pause(start + repeat / REPEATS - time.monotonic())
        rig.ground.type(b"i")


def _flooded(ledger: Ledger) -> None:
    _flood(ledger, f"{GROUND}, {FLOOD} messages/s")


def _flooded_table(ledger: Ledger) -> None:
    """Measure with the Messages screen on top and a message chosen in it."""
    _flood(ledger, f"{GROUND}, {FLOOD} messages/s, Messages", b"\x1b[13~", b"\x1b[B" * 3)


def _flooded_charts(ledger: Ledger) -> None:
    """Measure with the Charts screen on top and all lines drawn that it can have."""
    names = (f"{name} {place // 4 + 1}" for place, name in enumerate(CHARTED.split()))
    _flood(ledger, f"{GROUND}, {FLOOD} messages/s, Charts", b"\x1b[15~", *(f"a{name}\r".encode() for name in names))


def _flood(ledger: Ledger, name: str, *keys: bytes) -> None:
    port = free_port()
    with ExitStack() as stack:
        watch, program = stack.enter_context(_alone(python("groundstation", f"udpin:127.0.0.1:{port}"), "waiting"))
        sock = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        sock.connect(("127.0.0.1", port))
        frames = Flood(sock)
        for each in keys:
            frames.send(watch, KEY_GAP)
            program.type(each)
        ledger.book({name: program}, lambda seconds: frames.send(watch, seconds))


class Flood:
    """A vehicle that sends too much."""

    def __init__(self, sock: socket.socket, rate: int = FLOOD) -> None:
        self._socket = sock
        self._rate = rate
        self._frames = mix(2560)  # a multiple of the sequence numbers, so that there is no gap at the restart
        self._next = 0

    def send(self, watch: Watch, seconds: float) -> None:
        """Send frames at the rate, one per datagram, a few at a time."""
        start = time.monotonic()
        for step in range(round(seconds / FLOOD_STEP)):
            watch.pause(start + step * FLOOD_STEP - time.monotonic())
            for _ in range(round(self._rate * FLOOD_STEP)):
                self._socket.send(self._frames[self._next % len(self._frames)])
                self._next += 1


@contextmanager
def _alone(argv: list[str], word: str) -> Iterator[tuple[Watch, Program]]:
    watch = Watch()
    program = on_terminal(watch, argv, *SIZE)
    try:
        program.wait_for(word, 20)
        yield watch, program
    finally:
        program.end()
        watch.close()
