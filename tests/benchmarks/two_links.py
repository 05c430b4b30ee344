"""Two links to one vehicle, real programs in networks of their own: one is cut, late, lossy, reordered or frozen.

The driver holds a key, changes the speed and stops, over and over. Each change of the motors has the vehicle's own
time, so that the age of the command that they obey is known. The CPU of a second link is that of both programs
together, with one link and with two in turns.
"""

from __future__ import annotations

import os
import random
import signal
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from itertools import pairwise
from statistics import median
from typing import NamedTuple
from unittest.mock import patch

from tests.benchmarks.figures import BenchmarkError, BenchmarkSkippedError, Goal, Options, Report, Row, Table, quantile
from tests.benchmarks.key_to_motor import LET_GO, Rig
from tests.benchmarks.motor_feed import MotorFeed
from tests.benchmarks.procfs import cpu_seconds, family
from tests.benchmarks.programs import Program, on_pipe, on_terminal, python, scratch
from tests.benchmarks.two_networks import DIRECT, RELAYED, TwoNetworks, why_not
from tests.benchmarks.watch import Watch
from tests.groundstation.held_key import GAP

STOPS, QUICK_STOPS = 8, 3
"""Drives of a network that count, each ended by the stop key."""
AGAIN = 4
"""Drives at most for each one that counts: a busy machine spoils some, and says nothing about the links."""
STARTS = 3
"""Times that the programs are started for a network in which too few drives have counted."""
DRIVE = (1.0, 1.6)
"""s of a drive, at random."""
CHANGES = (0.25, 0.45)
"""s between two changes of the speed, at random: longer than a command may be on its way."""
REST = 0.8
"""s between two drives: longer than a key counts as held."""
STOPPED_WITHIN = 1.0
"""s from the stop key to motors without power, else the key counts as lost: the ramp down takes 0.4 s."""
STEP, NEAR = 0.01, 0.04
"""Of the power: what counts as a change, and as equal; two speeds are 0.1 apart."""
LINK_LOST = "manual control lost"
"""What the vehicle says when it has stopped because no command came."""
OBEYED, CPU_SHARE = 0.1, 0.15
"""s of age of the oldest command that is obeyed while one link is sound, and added CPU of the second link."""
CPU_ROUNDS, QUICK_CPU_ROUNDS = 5, 1
TRIES = 5
"""Times that both speeds are tried before a drive, and that CPU is counted until the key drives all the time."""
CALIBRATION = 0.6
"""s for which each speed is held before it counts as reached."""
CPU_WINDOW = 8.0
"""s of driving over which CPU is counted."""


class Network(NamedTuple):
    """What is wrong with one of the links."""

    relay: tuple[str, ...] = ("0", "0.001", "0")
    """Arguments of lossy_relay.py: loss, delay, jitter."""
    lost: tuple[str, int] = (RELAYED, 0)
    """Network of which nftables drops so many percent."""
    alternates: str = ""
    """Network that is cut for a second in turn with a second whole."""
    frozen: bool = False
    """The relay is frozen for a second in turn with a second in which it goes on."""


NETWORKS = {
    "both sound": Network(),
    "one cut": Network(lost=(RELAYED, 100)),
    "the other one cut": Network(lost=(DIRECT, 100)),
    "one cut and back each second": Network(alternates=RELAYED),
    "the other one cut and back each second": Network(alternates=DIRECT),
    "one 0.3 s late": Network(("0", "0.3", "0")),
    "one 1 s late": Network(("0", "1.0", "0")),
    "one 2 s late": Network(("0", "2.0", "0")),
    "one loses 30 %": Network(lost=(RELAYED, 30)),
    "one loses 60 %": Network(lost=(RELAYED, 60)),
    "one reordered by 0.2 s": Network(("0", "0.1", "0.1", "reorder")),
    "one frozen and thawed each second": Network(frozen=True),
    "one 1 s late, reordered, loses 30 %": Network(("0.3", "1.0", "0.1", "reorder")),
}


@dataclass(slots=True)
class Outcome:
    """What was seen in one network."""

    ages: list[float] = field(default_factory=list)
    """s: of the newest command that explains a change of the motors; 0 for the one in force."""
    delays: list[float] = field(default_factory=list)
    """s from a key to the first change toward what it asks for: so long the command before it was obeyed."""
    stops: int = 0
    """Drives in which the vehicle stopped because no command came."""
    stop_times: list[float] = field(default_factory=list)
    """s from the stop key to motors without power."""
    lost_stops: int = 0
    valid: int = 0
    """Drives that count."""
    froze: int = 0
    """Drives in which the screen did not take each key: a busy machine had held it up, whatever the links did."""

    @property
    def counted(self) -> int:
        """Drives that say something about the links."""
        return self.valid + self.stops


class Driven:
    """The commands of the driver, beside what the motors did."""

    def __init__(self, rig: Rig, faults: Faults, chance: random.Random) -> None:
        self._rig, self._fault, self._chance = rig, faults.follow, chance
        self._commands: list[tuple[int, float]] = []
        """When a key was written, ns, and the power that it asks for."""
        self._levels: dict[bool, float] = {}
        """Faster -> power."""

    def calibrate(self) -> None:
        """Learn the power of both speeds, before anything is wrong. On a late machine a key may have to be let go."""
        for _ in range(TRIES):
            for faster, key in ((False, b"i"), (True, b"+")):
                self._rig.ground.type(key)
                self._hold(CALIBRATION)
                self._levels[faster] = self._power
            self._rig.ground.type(b"-")
            self._hold(CALIBRATION)
            self._rig.ground.type(b" ")
            self._rig.watch.pause(LET_GO)
            if 0.0 < self._levels[False] < self._levels[True]:
                return
        raise BenchmarkError(f"two speeds were asked for, the motors had {self._levels}")

    def drive(self, outcome: Outcome) -> None:
        """Drive once, change the speed meanwhile, and stop."""
        began, said = len(self._rig.feed.changes), self._rig.vehicle.received
        self._commands = [(self._rig.ground.type(b"i"), self._levels[False])]
        faster, ends = False, time.monotonic() + self._chance.uniform(*DRIVE)
        while time.monotonic() < ends:
            self._hold(self._chance.uniform(*CHANGES))
            faster = not faster
            self._commands.append((self._rig.ground.type(b"+" if faster else b"-"), self._levels[faster]))
        self._hold(self._chance.uniform(*CHANGES))
        stamp = self._rig.ground.type(b" ")
        self._commands.append((stamp, 0.0))
        stopped = self._rig.watch.until(lambda: self._power == 0.0, STOPPED_WITHIN)
        if stopped:
            outcome.stop_times.append((self._rig.feed.changes[-1].at - stamp) / 1e9)
        outcome.lost_stops += not stopped
        self._rest()
        if LINK_LOST in self._rig.vehicle.text_since(said):
            outcome.stops += 1
        elif self._all_taken(began):
            outcome.valid += 1
            self._judge(outcome, began)
            self._note_delays(outcome, began)
        else:
            outcome.froze += 1
            self.calibrate()
            return
        if faster:
            self._rig.ground.type(b"-")

    def _note_delays(self, outcome: Outcome, began: int) -> None:
        """Note how long the motors obeyed the command before each one: until they first change toward it."""
        for (stamp, asked), (end, _) in pairwise([*self._commands, (time.monotonic_ns(), 0.0)]):
            before = [each for each in self._rig.feed.changes if each.at <= stamp]
            power = max(map(abs, before[-1].throttles)) if before else 0.0
            if abs(power - asked) < NEAR:
                continue
            toward = (
                each.at
                for each in self._rig.feed.changes[began:]
                if stamp < each.at < end and (max(map(abs, each.throttles)) > power) == (asked > power)
            )
            outcome.delays.append((next(toward, end) - stamp) / 1e9)

    @property
    def _power(self) -> float:
        changes = self._rig.feed.changes
        return max(map(abs, changes[-1].throttles), default=0.0) if changes else 0.0

    def _hold(self, seconds: float) -> None:
        """Hold the drive key, as a terminal does: by repeats."""
        ends = time.monotonic() + seconds
        while time.monotonic() < ends:
            self._fault(time.monotonic())
            self._rig.ground.type(b"i")
            self._rig.watch.pause(GAP)

    def _rest(self) -> None:
        ends = time.monotonic() + REST
        while time.monotonic() < ends:
            self._fault(time.monotonic())
            self._rig.watch.pause(GAP)

    def measure_cpu(self) -> float:
        """Return the CPU of both programs while a key is held and the motors have power, % of a core."""
        pids = [each for program in (self._rig.ground, self._rig.vehicle) for each in family(program.pid)]
        for _ in range(TRIES):
            self._hold(1.0)
            before, began, seen = cpu_seconds(pids), time.monotonic(), len(self._rig.feed.changes)
            moved = self._power > 0.0
            self._hold(CPU_WINDOW)
            share = 100 * (cpu_seconds(pids) - before) / (time.monotonic() - began)
            moved = moved and all(any(each.throttles) for each in self._rig.feed.changes[seen:])
            self._rig.ground.type(b" ")
            self._rig.watch.pause(LET_GO)
            if moved:
                return share
        raise BenchmarkError("a key was held, and the motors did not have power all the time: the machine is too busy")

    def _all_taken(self, began: int) -> bool:
        """Return whether the motors had what each key asks for when the next one came."""
        for (_, asked), (stamp, _) in pairwise(self._commands):
            before = [each for each in self._rig.feed.changes[began:] if each.at <= stamp]
            if not before or abs(max(map(abs, before[-1].throttles)) - asked) > NEAR:
                return False
        return True

    def _judge(self, outcome: Outcome, began: int) -> None:
        """Compare each change of the power with the commands before it."""
        changes = self._rig.feed.changes[began:]
        power = 0.0
        for change in changes:
            before, power = power, max(map(abs, change.throttles))
            if abs(power - before) < STEP:
                continue
            outcome.ages.append(self._age(change.at, power, up=power > before) / 1e9)

    def _age(self, at: int, power: float, *, up: bool) -> int:
        """Return how long ago, ns, a power was asked for last toward which the motors change; 0 if it is now."""
        replaced = at
        for stamp, asked in reversed(self._commands):
            if stamp > at:
                continue
            if asked >= power - NEAR if up else asked <= power + NEAR:
                break
            replaced = stamp
        return at - replaced


class Faults:
    """What happens to the networks while the driver drives."""

    def __init__(self, network: Network, networks: TwoNetworks, relay: Program) -> None:
        self._network, self._networks, self._relay = network, networks, relay
        self._since: float | None = None
        self._bad = False

    def begin(self) -> None:
        """Let go wrong what goes wrong from here on."""
        self._since = time.monotonic()
        where, percent = self._network.lost
        if percent:
            self._networks.lose(where, percent)

    def follow(self, now: float) -> None:
        """Cut or freeze in turn."""
        bad = self._since is not None and int(now - self._since) % 2 == 0
        if bad == self._bad:
            return
        self._bad = bad
        if self._network.alternates:
            self._networks.lose(self._network.alternates, 100 if bad else 0)
        if self._network.frozen:
            self._relay.process.send_signal(signal.SIGSTOP if bad else signal.SIGCONT)


def run(options: Options) -> Report:
    """Drive through each network, then count the CPU of the second link."""
    if reason := why_not():
        raise BenchmarkSkippedError(reason)
    chance = random.Random(5)
    outcomes = {name: _drive_through(name, options, chance) for name in NETWORKS}
    cpu: dict[int, list[float]] = {1: [], 2: []}
    for turn in range(QUICK_CPU_ROUNDS if options.quick else CPU_ROUNDS):
        for links, shares in cpu.items():
            options.say(f"two_links: CPU, round {turn + 1}, {links} link{'s' * (links > 1)}")
            with _running(Network(), links) as (rig, faults):
                shares.append(Driven(rig, faults, chance).measure_cpu())
    return _report(outcomes, cpu)


def _drive_through(name: str, options: Options, chance: random.Random) -> Outcome:
    """Drive through a network until enough drives count, or too many have not."""
    outcome, wanted = Outcome(), QUICK_STOPS if options.quick else STOPS
    for _ in range(STARTS):
        options.say(f"two_links: {name}")
        try:
            with _running(NETWORKS[name]) as (rig, faults):
                driven = Driven(rig, faults, chance)
                driven.calibrate()
                faults.begin()
                for _ in range(AGAIN * wanted):
                    if outcome.counted >= wanted:
                        return outcome
                    driven.drive(outcome)
        except BenchmarkError as error:
            options.say(f"two_links: {name}: again: {error}")
    return outcome


@contextmanager
def _running(network: Network, links: int = 2) -> Iterator[tuple[Rig, Faults]]:
    """Start relay, ground station and vehicle, and arm."""
    with ExitStack() as stack:
        folder, runtime = (stack.enter_context(scratch()) for _ in range(2))
        stack.enter_context(patch.dict(os.environ, {"XDG_RUNTIME_DIR": str(runtime)}))
        networks, watch = TwoNetworks(stack), Watch()
        stack.callback(watch.close)
        feed = MotorFeed(watch, folder)
        stack.callback(feed.close)

        def start(where: str, *words: str, terminal: bool = False) -> Program:
            argv = [*networks.within(where), *python(*words)]
            program = on_terminal(watch, argv, 80, 24) if terminal else on_pipe(watch, argv)
            stack.callback(program.end)
            return program

        relay = start("relay", "tests.benchmarks.lossy_relay", *networks.relay_ends, *network.relay)
        stack.callback(relay.process.send_signal, signal.SIGCONT)
        relay.wait_for("relay ready", 20)
        ground = start("ground", "groundstation", *networks.ground_endpoints[:links], terminal=True)
        vehicle = start("vehicle", "vehicle", "--sim", "--allow-unsigned", *networks.vehicle_endpoints[:links],
                        "--motor-log", str(feed.path), "--param", "MOT_SLEWRATE=1000")  # fmt: skip
        ground.wait_for("DISARMED", 30)
        rig = Rig(ground, vehicle, feed, watch, 0)
        watch.pause(2.5)  # until a late link is known
        rig.arm()
        watch.pause(REST)
        yield rig, Faults(network, networks, relay)


def _report(outcomes: dict[str, Outcome], cpu: dict[int, list[float]]) -> Report:
    table = Table(
        "Driving over two links, one of which is bad",
        [_row(name, each) for name, each in outcomes.items()],
        "`oldest`: age of the oldest command that the motors obeyed, ms, beside the p99 of all. `stop`: from the stop "
        "key to motors without power, ms. nftables cuts and loses, a relay delays, reorders and freezes.",
    )
    one, two = (median(cpu[links]) for links in (1, 2))
    costs = Table(
        "CPU of station and vehicle while a key is held, % of a core",
        [{"links": links, "median": median(shares), "of all rounds": " / ".join(f"{each:.1f}" for each in shares)}
         for links, shares in cpu.items()],
    )  # fmt: skip
    every = list(outcomes.values())
    oldest = max(max((*each.ages, *each.delays), default=0.0) for each in every)
    goals = [
        Goal("oldest command that is obeyed while one link is sound", 1000 * oldest, 1000 * OBEYED, "ms"),
        Goal("stops while a key is held", sum(each.stops for each in every), 0, "stops"),
        Goal("stop keys that were lost", sum(each.lost_stops for each in every), 0, "keys"),
        Goal("networks in which no drive counted", sum(not each.counted for each in every), 0, "networks"),
        Goal("CPU that the second link adds", 100 * (two / one - 1.0), 100 * CPU_SHARE, "%"),
    ]  # fmt: skip
    return Report([table, costs], goals)


def _row(name: str, outcome: Outcome) -> Row:
    ages = sorted(1000 * each for each in (*outcome.ages, *outcome.delays))
    stops = sorted(1000 * each for each in outcome.stop_times)
    return {
        "network": name,
        "drives": outcome.counted,
        "changes": len(ages),
        "oldest": ages[-1] if ages else None,
        "p99": quantile(ages, 0.99) if ages else None,
        "stops": outcome.stops,
        "stop keys": len(stops) + outcome.lost_stops,
        "lost": outcome.lost_stops,
        "keys not taken": outcome.froze,
        "stop": stops[-1] if stops else None,
    }


def main(names: Sequence[str]) -> None:
    """Drive through some of the networks, as for a first look, and print the figures of each."""
    if reason := why_not():
        raise SystemExit(reason)
    if unknown := [each for each in names if each not in NETWORKS]:
        raise SystemExit(f"no network {unknown[0]!r}; there are: {', '.join(map(repr, NETWORKS))}")
    options = Options(quick=True, tlog=None, say=lambda text: print(text, file=sys.stderr, flush=True))
    for name in names or NETWORKS:
        print(_row(name, _drive_through(name, options, random.Random(5))), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
