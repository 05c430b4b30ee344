"""Key byte written to a real terminal -> motor outputs changed at the vehicle: both real programs, UDP loopback.

The common hobby form runs the same path beside it: a mavutil sender thread at a fixed rate, and a mavutil receiver that
polls at each tick. A measurement ends with the vehicle's own timestamp of the change; all processes share that clock.
"""

from __future__ import annotations

import random
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from groundstation.ui.drive.panes import PANES
from tests.benchmarks.figures import ROUNDS, BenchmarkError, Goal, Options, Report, Row, Spread, Table, brief, spread
from tests.benchmarks.motor_feed import MotorFeed
from tests.benchmarks.programs import Program, free_port, on_pipe, on_terminal, python, scratch
from tests.benchmarks.watch import Watch
from tests.groundstation.held_key import DELAY, GAP

KEYS = 80
"""Keys of one contender in one round: of 240 the third longest is the p99."""
QUICK_KEYS = 14

DRIVE_KEYS = (b"i", b"w")
STOP_KEYS = (b"k", b" ")

QUIET = 0.06
"""s without a change after which the outputs count as settled: three control cycles."""

GAPS = (0.02, 0.15)
"""s, random, from settled outputs to the next key, so that keys meet every phase of every timer.

A key of the ground station counts as held for 0.75 s: QUIET and gap together stay below.
"""

LOST_AFTER = 1.0
"""s without a change after which a key counts as lost."""

ARMED_WITHIN = 60.0
"""s for all tries to arm and drive; the first succeeds unless the machine is busy."""
HOLD = 3.0
"""s of repeats of the key that arms; it needs 1 s."""
LET_GO = 1.2
"""s without a repeat after which a key counts as released (1.1 s at most)."""

OURS_WIDE, OURS_NARROW = "mavhelm, 140x45", "mavhelm, 80x24"
BARE = "bare pair of Python processes"
HOBBY = "hobby: 50 Hz sender, 50 Hz receiver"
BUSIEST = "charts"
"""Pane of Drive that draws most."""


@dataclass(frozen=True, slots=True)
class Contender:
    """One way from a key to a motor."""

    ground: tuple[str, ...]
    """Module and arguments; {port} is filled in."""
    vehicle: tuple[str, ...]
    """The same; {motors} is the motor log."""
    columns: int = 80
    lines: int = 24
    arms: bool = False
    """True if it must be armed by holding r before keys drive."""


_OURS = (
    ("groundstation", "udpin:127.0.0.1:{port}"),
    ("vehicle", "--sim", "udpout:127.0.0.1:{port}", "--motor-log", "{motors}", "--param", "MOT_SLEWRATE=1000"),
)
"""Without a ramp of the motors, as the references: the outputs settle at once, so that more keys fit into a run."""
_BARE = ("tests.benchmarks.bare_ground", "{port}"), ("tests.benchmarks.bare_vehicle", "{port}", "{motors}")
_HOBBY_GROUND, _HOBBY_VEHICLE = "tests.benchmarks.hobby_ground", "tests.benchmarks.hobby_vehicle"

CONTENDERS = {
    OURS_WIDE: Contender(*_OURS, columns=140, lines=45, arms=True),
    HOBBY: Contender(
        (_HOBBY_GROUND, "udpin:127.0.0.1:{port}", "50"), (_HOBBY_VEHICLE, "udpout:127.0.0.1:{port}", "0.02", "{motors}")
    ),
    BARE: Contender(*_BARE),
    OURS_NARROW: Contender(*_OURS, arms=True),
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Network:
    """The network between ground station and vehicle; `loss` 0..1, times one way in s."""

    loss: float = 0.0
    delay: float = 0.0
    jitter: float = 0.0

    @property
    def arguments(self) -> list[str]:
        """Return the arguments of lossy_relay.py."""
        return [str(self.loss), str(self.delay), str(self.jitter)]


@dataclass(slots=True)
class Outcome:
    """Results of one contender so far."""

    latencies: list[list[float]]
    """ms, one list a round."""
    lost: int = 0


def run(options: Options) -> Report:
    """Measure all contenders in turn, round by round."""
    chance = random.Random(7)
    outcomes = {name: Outcome([]) for name in CONTENDERS}
    for turn in range(ROUNDS):
        for name, contender in CONTENDERS.items():
            options.say(f"key_to_motor: round {turn + 1} of {ROUNDS}, {name}")
            with running(contender) as rig:
                if contender.arms:
                    rig.arm()
                    rig.show(BUSIEST)
                rig.measure(outcomes[name], QUICK_KEYS if options.quick else KEYS, chance)
    return _report(outcomes)


class Rig:
    """A ground station on a terminal and a vehicle whose motors are watched, connected."""

    def __init__(self, ground: Program, vehicle: Program, feed: MotorFeed, watch: Watch, port: int) -> None:
        self.ground = ground
        self.vehicle = vehicle
        self.feed = feed
        self.watch = watch
        self.port = port
        """UDP port of the ground station."""

    def arm(self) -> None:
        """Arm with keys, as a driver does; then drive once, so that nothing happens for the first time later."""
        deadline = time.monotonic() + ARMED_WITHIN
        while not (self._arms() and self._drives()):
            if time.monotonic() > deadline:
                raise BenchmarkError(f"the wheels never turned; the screen says {self.ground.text[-500:]!r}")
            self.watch.pause(LET_GO)

    def _arms(self) -> bool:
        """Hold the key once. A machine that delays two repeats into one read ends the hold, as pasted text does."""
        if not self._says_armed():
            self.ground.type(b"r")
            self.watch.pause(DELAY)
            deadline = time.monotonic() + HOLD
            while time.monotonic() < deadline and not self._says_armed():
                self.ground.type(b"r")
                self.watch.pause(GAP)
        return self.watch.until(self._says_armed, LET_GO)

    def _says_armed(self) -> bool:
        """Return whether the hint that was drawn last is the one of an armed vehicle."""
        text = self.ground.text
        return text.rfind("hold i to drive") > text.rfind("disarmed:")

    def _drives(self) -> bool:
        stamp = self.ground.type(DRIVE_KEYS[0])
        if self.feed.after(stamp, LOST_AFTER) is None:
            return False
        self.ground.type(STOP_KEYS[0])
        return True

    def measure(self, outcome: Outcome, keys: int, chance: random.Random, gaps: tuple[float, float] = GAPS) -> None:
        """Press `keys` keys, each of which must change the outputs."""
        latencies: list[float] = []
        for each in range(keys):
            self.settle(chance, gaps)
            choice = self.next_keys()
            stamp = self.ground.type(choice[each // 2 % len(choice)])
            change = self.feed.after(stamp, LOST_AFTER)
            if change is None:
                outcome.lost += 1
            else:
                latencies.append((change.at - stamp) / 1e6)
        if not latencies:
            raise BenchmarkError("no key reached the motors")
        outcome.latencies.append(latencies)

    def show(self, pane: str) -> None:
        """Show this pane of Drive; the first one is shown now."""
        for _ in range([each.id for each in PANES].index(pane)):
            self.ground.type(b"v")
            self.watch.pause(LET_GO)

    def next_keys(self) -> tuple[bytes, ...]:
        """Return the keys that change the outputs now."""
        return STOP_KEYS if self.feed.moving else DRIVE_KEYS

    def settle(self, chance: random.Random, gaps: tuple[float, float] = GAPS) -> None:
        """Wait for steady outputs, and then for a random time in which they stay so."""
        while True:
            if not self.feed.quiet_for(QUIET, 10):
                raise BenchmarkError("the outputs never settled")
            before = len(self.feed.changes)
            gap = chance.uniform(*gaps)
            if not self.watch.until(lambda: len(self.feed.changes) > before, gap):  # noqa: B023
                return


@contextmanager
def running(contender: Contender, network: Network | None = None) -> Iterator[Rig]:
    """Start both programs, connected to each other directly or through a bad `network`."""
    with ExitStack() as stack:
        folder: Path = stack.enter_context(scratch())
        watch = Watch()
        stack.callback(watch.close)
        feed = MotorFeed(watch, folder)
        stack.callback(feed.close)
        ground_port = vehicle_port = free_port()
        if network is not None:
            vehicle_port = free_port()
            relay_argv = python("tests.benchmarks.lossy_relay", str(vehicle_port), str(ground_port), *network.arguments)
            relay = on_pipe(watch, relay_argv)
            stack.callback(relay.end)
            relay.wait_for("relay ready", 20)
        ground_argv = python(*(word.format(port=ground_port) for word in contender.ground))
        ground = on_terminal(watch, ground_argv, contender.columns, contender.lines)
        stack.callback(ground.end)
        vehicle_argv = python(*(word.format(port=vehicle_port, motors=feed.path) for word in contender.vehicle))
        vehicle = on_pipe(watch, vehicle_argv)
        stack.callback(vehicle.end)
        ground.wait_for("DISARMED" if contender.arms else "ready", 20)
        yield Rig(ground, vehicle, feed, watch, ground_port)


# ---- report ----


def _report(outcomes: dict[str, Outcome]) -> Report:
    spreads = {name: spread(outcome.latencies) for name, outcome in outcomes.items()}
    table = Table(
        "Key byte written to the terminal -> motor outputs changed, ms",
        [_row(name, spreads, outcome) for name, outcome in outcomes.items()],
        "p50 is the median of the rounds' medians; p90, p99 and max are of all keys. "
        "`x`: the 50 Hz hobby form / this. Drive with the pane "
        f"{BUSIEST}, which draws most.",
    )
    return Report([table], _goals(spreads, outcomes))


def _row(name: str, spreads: dict[str, Spread], outcome: Outcome) -> Row:
    mine, hobby = spreads[name], spreads[HOBBY]
    return {
        "path": name,
        "keys": mine.samples,
        "lost": outcome.lost,
        "p50": mine.p50,
        "p90": mine.p90,
        "p99": mine.p99,
        "max": mine.max,
        "x p50": hobby.p50 / mine.p50,
        "x p99": hobby.p99 / mine.p99,
        "p50 of rounds": " / ".join(f"{value:.2f}" for value in mine.rounds),
    }


def _goals(spreads: dict[str, Spread], outcomes: dict[str, Outcome]) -> list[Goal]:
    hobby, bare = spreads[HOBBY], spreads[BARE]
    goals: list[Goal] = []
    for size, mine in (("140x45", spreads[OURS_WIDE]), ("80x24", spreads[OURS_NARROW])):
        for quantile, ours, theirs, most in (("p50", mine.p50, bare.p50, 2.0), ("p99", mine.p99, bare.p99, 3.0)):
            what = f"key to motor at {size}, {quantile} {brief(ours)} ms, against the bare pair"
            goals.append(Goal(what, ours / theirs, most, "x", reference=f"bare pair, {brief(theirs)} ms"))
        for quantile, ours, theirs in (("p50", mine.p50, hobby.p50), ("p99", mine.p99, hobby.p99)):
            what = f"50 Hz hobby form / key to motor at {size}, {quantile}"
            goals.append(Goal(what, theirs / ours, 20, "x", True, f"hobby form, {brief(theirs)} ms"))
    lost = outcomes[OURS_WIDE].lost + outcomes[OURS_NARROW].lost
    return [*goals, Goal("keys lost", lost, 0, "keys", reference=f"hobby form, {outcomes[HOBBY].lost}")]
