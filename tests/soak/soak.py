"""One soak: the programs, the network between them, kills, and the rules, for so many seconds of real time.

In its first third each program in turn loses a process to kill -9, and is started again. Then all live, so that what
grows can be seen, also behind the time in which histories fill up. The network is bad all the time, but for the end.
"""

from __future__ import annotations

import itertools
import os
import random
import select
import signal
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from tests.ports import free_port
from tests.soak.census import Census
from tests.soak.crew import BridgeMember, Member, VehicleMember, processes, stations
from tests.soak.network import Network
from tests.soak.rules import NOISE, OBEYED, Witness, judge
from tests.soak.signing import make_keys
from tests.waits import Waits

TURN = 0.01
"""s between two looks at the drivers."""
JUDGED = 0.5
"""s between two looks at the motor log."""
DELAYED = 3.0
"""s before now in which a delay may explain what the motors do."""
COUNTED = 10.0
"""s between two looks at memory, descriptors and threads; at most a twentieth of the soak."""
KILLS = (6.0, 20.0)
"""s, random, between two kills."""
WOUNDED = (0.5, 4.0)
"""s, random, for which a program goes on without the process that was killed, before it is started again."""
KILLED = 1 / 3
"""Share of a soak in which processes are killed."""
LEAST_POWER = 0.02
"""Share of a soak for which motors must have power, or there was nothing to stop."""
REPORTED = 0.05
"""s between two control cycles of a busy vehicle: it reports the age in the second."""
MAX_FAULTS = 50
"""Faults that are told."""


@dataclass
class Findings:
    """What a soak has found."""

    faults: list[str] = field(default_factory=list)
    turned: float = 0.0
    """s in which motors had power."""
    stretches: int = 0
    kills: dict[str, int] = field(default_factory=dict)
    """Role -> number of kill -9."""

    def tell(self, now: float, fault: str) -> None:
        """Add a fault."""
        if len(self.faults) < MAX_FAULTS:
            self.faults.append(f"after {now:.1f} s: {fault}")


class Soak:
    """`run` it once, then read `report`."""

    def __init__(self, folder: Path, seconds: float, seed: int, *, keys: bool, signing: bool = False) -> None:
        """`keys`: the first station has a terminal. `signing`: both ends sign, and ignore what is not signed."""
        self._seconds, self._seed, self._signing = seconds, seed, signing
        self._chance = random.Random(seed)
        self.witness, self.census, self.findings = Witness(), Census(), Findings()
        self._network = Network(seed)
        bridge = [free_port() for _ in range(3)]
        taps = (self.witness.vehicle_says, self.witness.station_says, self.witness.station_says)
        names = ("vehicle", "one", "two")
        ports = [self._network.add(name, port, tap) for name, port, tap in zip(names, bridge, taps, strict=True)]
        self._vehicle = VehicleMember(folder, ports[0], make_keys(folder) if signing else ())
        self._stations = stations(folder, (ports[1], ports[2]), seed, keys=keys, signing=signing)
        self.crew: tuple[Member, ...] = (self._vehicle, BridgeMember(*bridge), *self._stations)
        self._begun = 0.0
        self._delays: list[tuple[float, float]] = []
        self._waits, self._waited = Waits(), 0.0
        self._judged = 0.0

    def run(self) -> None:
        """Run it to its end."""
        self._network.start()
        try:
            for member in reversed(self.crew):
                member.start()
            self._begun = time.monotonic()
            self._go_on()
        finally:
            for member in self.crew:
                member.kill()
            self._network.close()
        self._conclude()

    def report(self) -> dict[str, object]:
        """Return all figures, and the faults."""
        counts: dict[str, dict[str, int]] = {leg.name: leg.counts for leg in self._network.legs}
        return {
            "seconds": self._seconds,
            "seed": self._seed,
            "faults": self.findings.faults,
            "motors had power, s": round(self.findings.turned, 1),
            "times of power": self.findings.stretches,
            "frames signed, unsigned": [self.witness.signed, self.witness.unsigned.total()],
            "unsigned frames by sender and message": self.witness.unsigned,
            "demands of motion by station": self.witness.by_station,
            "oldest obeyed demand, s": round(self.witness.oldest_obeyed, 3),
            "kill -9": self.findings.kills,
            "network": counts,
            "processes": self.census.report(),
            "cpu, s": round(self.census.cpu(), 1),
        }

    # ---- time ----

    def _go_on(self) -> None:
        kills = self._kills()
        kill_due, judge_due, count_due = self._begun + next(kills), 0.0, 0.0
        while (now := time.monotonic()) < self._begun + self._seconds:
            for station in self._stations:
                station.step(now)
            if self._network.fair:  # first the wheels turn
                self._network.fair = self.findings.turned < 1.0
            elif now >= kill_due:
                kill_due = now + next(kills)
            if now >= judge_due:
                judge_due = now + JUDGED
                self._judge(now)
            if now >= count_due:
                count_due = now + min(COUNTED, self._seconds / 20)
                self._count(now)
            select.select([], [], [], TURN)

    def _kills(self) -> Iterator[float]:
        """Kill a process of each program in turn and start the program again; yield how long to wait, s."""
        quick = min(1.0, self._seconds / 150)  # a short soak kills each of them, too
        for number, member in enumerate(itertools.cycle(self.crew)):
            yield quick * self._chance.uniform(*KILLS)
            if number >= len(self.crew) and time.monotonic() > self._begun + self._seconds * KILLED:
                break
            self._wound(member)
            yield quick * self._chance.uniform(*WOUNDED)
            member.kill()
            member.start()
            self._waited += self._waits.total()
            self._waits = Waits(self._vehicle.pid)
        yield self._seconds

    def _wound(self, member: Member) -> None:
        role, pid = self._chance.choice(sorted(processes(member).items()) or [("", 0)])
        if not pid:
            return
        self.findings.kills[role] = self.findings.kills.get(role, 0) + 1
        if member is self._vehicle:
            member.kill()
            self.witness.beats.append((time.monotonic(), True))  # what it did since its last one is not known
        else:
            os.kill(pid, signal.SIGKILL)

    # ---- rules ----

    def _judge(self, now: float) -> None:
        slack = NOISE + self._delay(now)
        demands, beats = [*self.witness.demands], [*self.witness.beats]
        for stretch in self._vehicle.new_stretches(now):
            self.findings.turned += max(0.0, stretch.end - max(stretch.start, self._judged))
            self.findings.stretches += not stretch.before
            for fault in judge(stretch, demands, beats, slack):
                self.findings.tell(now - self._begun, fault)
        self._judged = now
        self.witness.forget(now)

    def _delay(self, now: float) -> float:
        """Return how long the machine delayed the vehicle and us in the last seconds."""
        self._delays.append((now, self._waited + self._waits.total()))
        while len(self._delays) > 2 and self._delays[1][0] < now - DELAYED:
            del self._delays[0]
        return self._delays[-1][1] - self._delays[0][1]

    def _count(self, now: float) -> None:
        running: dict[str, int] = {}
        for member in self.crew:
            running |= processes(member)
        self.census.look(running, now)
        if complaints := self._vehicle.complaints():
            self.findings.tell(now - self._begun, complaints)

    def _conclude(self) -> None:
        """Add what only the end shows."""
        faults = self.census.faults()
        if self.findings.turned < self._seconds * LEAST_POWER:
            faults.append(f"the motors had power for {self.findings.turned:.1f} s only: this proves nothing")
        if self.witness.oldest_obeyed > OBEYED + REPORTED:
            faults.append(f"a demand of {self.witness.oldest_obeyed:.3f} s was obeyed")
        if self._signing and self.witness.unsigned:
            faults.append(f"{self.witness.unsigned.total()} frames were not signed")
        for fault in faults:
            self.findings.tell(self._seconds, fault)
