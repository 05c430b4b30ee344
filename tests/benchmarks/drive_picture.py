"""Driving by a picture: how old what a driver sees is, what it takes of the processor, and whether keys are late."""

from __future__ import annotations

import random
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from statistics import median
from subprocess import DEVNULL, Popen

from groundstation.pictures.cells import HALF_BLOCK
from tests.benchmarks.figures import ROUNDS, BenchmarkError, Goal, Options, Report, Row, Table, brief, quantile, spread
from tests.benchmarks.key_to_motor import LET_GO, Contender, Outcome, Rig, running
from tests.benchmarks.machine import ROOT
from tests.benchmarks.procfs import cpu_seconds, family
from tests.benchmarks.programs import free_port, python, scratch
from tests.benchmarks.timed_camera import COLUMNS, RATE, ROWS, TIME_BITS, read_fields
from tests.groundstation.pictures.decoders import CellScreen
from tests.groundstation.ui.drive.picture_terminal import AGE, PING, PictureTerminal

WIDE, LARGE = (140, 45), (162, 70)
"""The terminal of the keys, and the one whose picture has 160 x 90 pixels."""
PICTURE, EYE = "with the picture", "without it"
KEYS, QUICK_KEYS = 100, 20
"""Keys of a round: of 300 the third longest is the p99."""
WINDOW, QUICK_WINDOW = 8.0, 2.0
"""s over which CPU is counted."""
SEEN, QUICK_SEEN = 30.0, 5.0
"""s over which pictures are watched."""
LINES = {"loopback": 0, "a terminal line of 200 kB/s": 200_000}
"""Lines to the terminal, and the bytes a second that they carry; 0: as many as there are."""
NETWORK = "a network that loses 5 % and delays by 30 ms"
LOSS, DELAY = 0.05, 0.03
"""Of each way, also that of the pictures."""
XTERM = b"\x1b[?64;1;2c"
DRAWN = 10.0
"""Pictures a second that Drive draws at most."""
WITHIN = 30.0
SETTLE = 3.0
HOLD_RATE = 30.0
TRIES = 5
"""Of a window in which the picture is never old: else keys are locked, which costs something else."""
MIDDLE = 128
PLAUSIBLE = 5000
"""ms: an older picture is a damaged one, whose fields have the right sum by chance."""


def run(options: Options) -> Report:
    """Measure the age of what is seen, then keys and CPU with and without the picture in turn."""
    goals: list[Goal] = []
    return Report([_ages(options, goals), _keys(options, goals), _costs(options, goals)], goals)


# ---- the age of what is seen ----


def _ages(options: Options, goals: list[Goal]) -> Table:
    table = Table("Age of the picture on the terminal when its last cell is read, ms")
    table.note = f"From a camera of {RATE} pictures a second; lost: of the {DRAWN:g} a second that are drawn at most."
    for name in (*LINES, NETWORK):
        options.say(f"drive_picture: {name}")
        seconds = QUICK_SEEN if options.quick else SEEN
        with scratch() as folder, _network() if name == NETWORK else nullcontext() as ports:
            ages = sorted(_watch(folder, LINES.get(name, 0), seconds, ports))
        if not ages:
            raise BenchmarkError(f"no picture was read, {name}")
        lost = max(0.0, 100 * (1 - len(ages) / (DRAWN * seconds)))
        middle, late = quantile(ages, 0.5), quantile(ages, 0.99)
        table.rows.append({"line": name, "seen": len(ages), "p50": middle, "p99": late, "lost %": lost})
        goals.append(Goal(f"age of what is seen, {name}, p99", late, 500.0, "ms"))
    return table


Ports = tuple[int, int, int]
"""Of the ground station, and where the vehicle and its camera send to."""


@contextmanager
def _network() -> Iterator[Ports]:
    """Run the bad network within the block."""
    ground, vehicle, camera, pictures = (free_port() for _ in range(4))
    words = (*map(str, (vehicle, ground, camera, pictures)), str(LOSS), str(DELAY))
    with Popen(python("tests.benchmarks.camera_relay", *words), stdout=DEVNULL, cwd=ROOT) as relay:
        try:
            yield ground, vehicle, camera
        finally:
            relay.terminate()


def _watch(folder: Path, rate: int, seconds: float, ports: Ports | None) -> Iterator[float]:
    """Yield the ages of the pictures that come within this time, ms."""
    camera = f"#!/bin/sh\ncd {ROOT} && exec {sys.executable} -m tests.benchmarks.timed_camera\n"
    terminal = PictureTerminal(folder, XTERM, rate, LARGE, camera, ports)
    try:
        terminal.wait("DISARMED")
        terminal.type(b"f")
        terminal.wait(AGE.pattern)
        reader = PictureReader()
        begin = time.monotonic() + SETTLE
        while (now := time.monotonic()) < begin + seconds:
            terminal.read()
            if (age := reader.read(terminal)) is not None and now >= begin:
                yield age
    finally:
        terminal.end()


class PictureReader:
    """Reads the times of the pictures on a terminal."""

    def __init__(self) -> None:
        self._screen = CellScreen()
        self._fed = 0
        self._newest = -1

    def read(self, terminal: PictureTerminal) -> float | None:
        """Return the age of a picture that was not seen before, ms."""
        end = terminal.drawn.rfind(PING) + len(PING)
        if end <= self._fed:
            return None
        text = terminal.drawn[self._fed : end].decode(errors="replace")
        self._screen.feed(text.replace("\x1b[H", "\x1b[1;1H"))
        self._fed = end
        now = int(time.monotonic() * 1000)
        made = read_fields(self._fields())
        if made is None or made == self._newest:
            return None
        self._newest = made
        age = (now - made) % (1 << TIME_BITS)
        return float(age) if age < PLAUSIBLE else None

    def _fields(self) -> list[int]:
        top, rows, columns = self._area()
        found = []
        for row in range(ROWS):
            for column in range(COLUMNS):
                at = top + (2 * row + 1) * rows // (2 * ROWS), 2 + (2 * column + 1) * columns // (2 * COLUMNS)
                character, text, ground = self._screen.cells.get(at, (" ", (0, 0, 0), (0, 0, 0)))
                found.append(int(sum(text if character == HALF_BLOCK else ground) > 3 * MIDDLE))
        return found

    @staticmethod
    def _area() -> tuple[int, int, int]:
        """Return the first row of the picture, its rows and its columns."""
        return 4, 45, 160


# ---- keys ----


def _contender(size: tuple[int, int]) -> Contender:
    vehicle = (
        "vehicle", "--sim", "--camera", "udpout:127.0.0.1:{port}", "--motor-log", "{motors}",
        "--param", "MOT_SLEWRATE=1000",
    )  # fmt: skip
    return Contender(("groundstation", "udpin:127.0.0.1:{port}"), vehicle, *size, arms=True)


def _show_picture(rig: Rig) -> None:
    """Let the picture fill Drive, and wait until it is there."""
    rig.ground.type(b"f")
    if not rig.watch.until(lambda: "±" in rig.ground.text, WITHIN):
        raise BenchmarkError("no picture came")
    rig.watch.pause(SETTLE)


def _keys(options: Options, goals: list[Goal]) -> Table:
    chance = random.Random(7)
    outcomes = {PICTURE: Outcome([]), EYE: Outcome([])}
    for turn in range(ROUNDS):
        for name in outcomes:
            options.say(f"drive_picture: keys {name}, round {turn + 1} of {ROUNDS}")
            with running(_contender(WIDE)) as rig:
                rig.arm()
                if name == PICTURE:
                    _show_picture(rig)
                rig.measure(outcomes[name], QUICK_KEYS if options.quick else KEYS, chance)
    table = Table("Key byte written to the terminal -> motor outputs changed, ms, at 140x45")
    spreads = {name: spread(outcome.latencies) for name, outcome in outcomes.items()}
    for name, each in spreads.items():
        row = {"Drive": name, "keys": each.samples, "lost": outcomes[name].lost}
        table.rows.append(row | {"p50": each.p50, "p99": each.p99, "max": each.max})
    ratio = spreads[PICTURE].p99 / spreads[EYE].p99
    goals.append(Goal("key to motor with the picture, p99", ratio, 1.2, "x", reference=f"{brief(spreads[EYE].p99)} ms"))
    return table


# ---- CPU ----


def _costs(options: Options, goals: list[Goal]) -> Table:
    found: dict[str, dict[str, list[float]]] = {PICTURE: {}, EYE: {}}
    for turn in range(ROUNDS):
        for name, parts in found.items():
            options.say(f"drive_picture: CPU {name}, round {turn + 1} of {ROUNDS}")
            with running(_contender(LARGE)) as rig:
                rig.arm()
                if name == PICTURE:
                    _show_picture(rig)
                _count(rig, parts, QUICK_WINDOW if options.quick else WINDOW)
    table = Table("CPU while a key is held, % of a core, picture of 160 x 90 pixels in half blocks")
    table.rows = [_cost_row(name, parts) for name, parts in found.items()]
    both = sum(median(found[PICTURE][part]) for part in ("screen", "station"))
    alone = sum(median(found[EYE][part]) for part in ("screen", "station"))
    goals.append(Goal("station and screen with the picture", both, 12.0, "%", reference=f"without, {brief(alone)} %"))
    return table


def _cost_row(name: str, parts: dict[str, list[float]]) -> Row:
    return {"Drive": name} | {f"{part} %": median(values) for part, values in parts.items()}


def _count(rig: Rig, parts: dict[str, list[float]], seconds: float) -> None:
    """Add what each part of the ground station uses while a key is held."""
    for _ in range(TRIES):
        _hold(rig, 1.0)
        pids = {pid: _part_of(pid) for pid in family(rig.ground.pid)}
        before, began, received = {pid: cpu_seconds([pid]) for pid in pids}, time.monotonic(), rig.ground.received
        _hold(rig, seconds)
        if rig.feed.moving:
            break
        rig.watch.pause(LET_GO)
    else:
        raise BenchmarkError("the key did not drive to the end: the picture was too old, each time")
    spent = time.monotonic() - began
    used = dict.fromkeys(("screen", "station", "receiver", "ffmpeg"), 0.0)
    for pid, part in pids.items():
        used[part] += 100 * (cpu_seconds([pid]) - before[pid]) / spent
    for part, value in used.items():
        parts.setdefault(part, []).append(value)
    parts.setdefault("kB/s to the terminal, not", []).append((rig.ground.received - received) / spent / 1000)


def _part_of(pid: int) -> str:
    words = Path(f"/proc/{pid}/cmdline").read_text()
    for word, part in (("ffmpeg", "ffmpeg"), ("stream.receiver", "receiver"), ("station_process", "station")):
        if word in words:
            return part
    return "screen"


def _hold(rig: Rig, seconds: float) -> None:
    """Turn on the spot."""
    began = time.monotonic()
    for repeat in range(round(seconds * HOLD_RATE)):
        rig.watch.pause(began + repeat / HOLD_RATE - time.monotonic())
        rig.ground.type(b"j")
