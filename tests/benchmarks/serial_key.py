"""Key byte written to a real terminal -> motor outputs changed, both real programs connected by a serial cable.

The cable (baud_cable.py) passes bytes at the pace of 57600 or 921600 baud. Telemetry flows all the time; in every
second run of keys another ground station on the same line requests all parameters and a file again and again.
"""

from __future__ import annotations

import os
import random
import signal
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from statistics import median

from dialects.axes import Axes, build_manual_control
from dialects.messages import RoverOperatorPresence
from tests.benchmarks.baud_cable import BITS_PER_BYTE
from tests.benchmarks.figures import ROUNDS, BenchmarkError, Goal, Options, Report, Row, Table, brief, spread
from tests.benchmarks.key_to_motor import Outcome, Rig
from tests.benchmarks.motor_feed import MotorFeed
from tests.benchmarks.programs import Program, on_pipe, on_terminal, python, scratch
from tests.benchmarks.traffic import framed
from tests.benchmarks.watch import Watch

SLOW, FAST = 57600, 921600
KEYS = {SLOW: 22, FAST: 8}
"""Keys of one load in one round: most at the rate with the goal, 66 and 24 in all."""
QUICK_KEYS = {SLOW: 4, FAST: 3}
COPIES = 15.0
"""% of a slow line that copies of changed demands may take."""
NOISE = 0.03
"""Part of the ms of wire time in which noise spoils a byte: one frame in five is lost."""

SOFTWARE = 30.0
"""ms that the goal allows for everything but the wire: two programs, their timers, a terminal and a frame before ours.
"""

TELEMETRY, BULK = "telemetry", "telemetry, parameter list and file"
LOADS = (TELEMETRY, BULK)
NOISY = "telemetry, one frame in five spoilt"
SETTLE = 1.0
"""s after a change of the load, in which a list in transit ends."""


@dataclass(slots=True)
class Seen:
    """Results of one load at one rate."""

    keys: Outcome = field(default_factory=lambda: Outcome([]))
    down: list[float] = field(default_factory=list)
    """Share of the wire to the ground station that was in use, %, one per round."""
    up: list[float] = field(default_factory=list)
    copies: list[float] = field(default_factory=list)
    """The most that copies of changed demands took of the wire up within any second, %, one per round."""


class Wired:
    """A connected rig and the cable between its programs."""

    def __init__(self, rig: Rig, cable: Program, baud: int) -> None:
        self.rig = rig
        self._cable = cable
        self._rate = baud / BITS_PER_BYTE
        self._stamp = self._totals()[0]  # bulk is on now, so that both loads ran before the first measurement
        self._change()

    def measure(self, seen: Seen, keys: int, chance: random.Random) -> None:
        """Press `keys` keys under the present load, then switch to the other load."""
        self.rig.watch.pause(SETTLE)
        self.rig.measure(seen.keys, keys, chance)
        down, up, copies = self._change()
        seen.down.append(down)
        seen.up.append(up)
        seen.copies.append(copies)

    def _change(self) -> tuple[float, float, float]:
        """Switch the load; return how full the wires were since the last time, and with copies at most, %."""
        before = self._stamp
        self._stamp, *passed, copies = self._totals()
        seconds = (self._stamp - before) / 1e9
        down, up = (100 * each / self._rate / seconds for each in passed)
        return down, up, 100 * copies / self._rate

    def skip(self) -> None:
        """Switch the load without a measurement."""
        self._change()

    def _totals(self) -> list[int]:
        lines = self._lines()
        os.kill(self._cable.pid, signal.SIGUSR1)
        if not self.rig.watch.until(lambda: self._lines() > lines, 10):
            raise BenchmarkError("the cable does not answer")
        return [int(word) for word in self._cable.text.splitlines()[-1].split()[1:]]

    def _lines(self) -> int:
        return self._cable.text.count("\n")


def run(options: Options) -> Report:
    """Measure rate by rate; the loads take turns."""
    chance = random.Random(13)
    seen = {(SLOW, load): Seen() for load in (*LOADS, NOISY)} | {(FAST, load): Seen() for load in LOADS}
    for baud in (SLOW, FAST):
        options.say(f"serial_key: {baud} baud, connecting and arming")
        with wired(baud) as pair:
            for turn in range(ROUNDS):
                options.say(f"serial_key: round {turn + 1} of {ROUNDS}, {baud} baud")
                for load in LOADS:
                    pair.measure(seen[baud, load], (QUICK_KEYS if options.quick else KEYS)[baud], chance)
    _with_noise(seen[SLOW, NOISY], options, chance)
    return _report(seen)


def _with_noise(seen: Seen, options: Options, chance: random.Random) -> None:
    options.say(f"serial_key: {SLOW} baud, noise")
    with wired(SLOW, noise=NOISE) as pair:
        for _ in range(ROUNDS):
            pair.measure(seen, QUICK_KEYS[SLOW] if options.quick else KEYS[SLOW], chance)
            pair.rig.watch.pause(SETTLE)
            pair.skip()


@contextmanager
def wired(baud: int, *options: str, noise: float = 0.0) -> Iterator[Wired]:
    """Both programs at the ends of a cable, armed; `options` are the vehicle's, `noise` is that of BaudCable."""
    with ExitStack() as stack:
        folder = stack.enter_context(scratch())
        watch = Watch()
        stack.callback(watch.close)
        feed = MotorFeed(watch, folder)
        stack.callback(feed.close)
        ends = folder / "vehicle", folder / "ground"
        cable = on_pipe(watch, python("tests.benchmarks.baud_cable", *map(str, ends), str(baud), str(noise)))
        stack.callback(cable.end)
        cable.wait_for("cable ready", 20)
        ground = on_terminal(watch, python("groundstation", f"serial:{ends[1]}:{baud}"), 80, 24)
        stack.callback(ground.end)
        log = ["--motor-log", str(feed.path), *options]
        vehicle = on_pipe(watch, python("vehicle", "--sim", f"serial:{ends[0]}:{baud}", *log))
        stack.callback(vehicle.end)
        ground.wait_for("DISARMED", 30)
        rig = Rig(ground, vehicle, feed, watch, 0)
        rig.arm()
        yield Wired(rig, cable, baud)


# ---- report ----


def frame_sizes() -> tuple[int, int]:
    """Bytes of the presence and of the MANUAL_CONTROL that a key sends; no value is 0, so nothing is truncated."""
    presence = RoverOperatorPresence(1, 1, 2**31, 2**31, 2**31, 2**31, 2**15, 3)
    return len(framed(presence, 0)), len(framed(build_manual_control(Axes(0.5, 0.5), 1), 0))


def wire_time(baud: int) -> float:
    """Return the ms that a key's frames need on the wire."""
    return sum(frame_sizes()) * BITS_PER_BYTE / baud * 1000


def _report(seen: dict[tuple[int, str], Seen]) -> Report:
    presence, demand = frame_sizes()
    note = (
        f"`wire`: of ROVER_OPERATOR_PRESENCE ({presence} bytes) and MANUAL_CONTROL ({demand} bytes) together, ms. "
        "p50 is the median of the rounds' medians; p90, p99 and max are of all keys. "
        "`down`, `up`: how full the wires were, with what the second "
        "station asks for. `copies`: the most that copies of changed demands took of the wire up within any second."
    )
    rows = [_row(baud, load, each) for (baud, load), each in seen.items()]
    title = "Key byte written to the terminal -> motor outputs changed over a serial cable, ms"
    lost = sum(each.keys.lost for (_, load), each in seen.items() if load != NOISY)
    goals = [
        Goal(
            f"key to motor, {SLOW} baud, {load}, p99",
            spread(seen[SLOW, load].keys.latencies).p99,
            round(wire_time(SLOW) + SOFTWARE, 1),
            "ms",
            reference=f"wire time, {brief(wire_time(SLOW))} ms",
        )
        for load in LOADS
    ]
    goals.append(Goal("keys lost", lost, 0, "keys"))
    goals += [
        Goal(
            f"copies of changed demands at {baud} baud, {load}, most in any second",
            max(each.copies),
            COPIES,
            "% of the wire",
            reference=f"all that is sent there, {brief(median(each.up))} %",
        )
        for (baud, load), each in seen.items()
        if baud == SLOW
    ]
    return Report([Table(title, rows, note)], goals)


def _row(baud: int, load: str, seen: Seen) -> Row:
    each, wire = spread(seen.keys.latencies), wire_time(baud)
    return {
        "line": f"{baud} baud, {load}",
        "keys": each.samples,
        "lost": seen.keys.lost,
        "wire": wire,
        "p50": each.p50,
        "p90": each.p90,
        "p99": each.p99,
        "max": each.max,
        "p99 - wire": each.p99 - wire,
        "down %": median(seen.down),
        "up %": median(seen.up),
        "copies %": max(seen.copies),
    }
