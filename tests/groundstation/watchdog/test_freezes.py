"""The watchdog and the station in virtual time: random freezes, after which everything due comes in any order."""

from __future__ import annotations

import random
from collections.abc import Callable

import pytest
from hypothesis import settings

from dialects import codec
from dialects import messages as m
from dialects.enums import Autopilot, SystemState, VehicleType
from dialects.modes import Mode, base_mode
from groundstation.intents.driving import DriveKeyDown
from groundstation.intents.session import RenewLease, ReportKeyReleases, SetKeyGate
from groundstation.station.station import Station
from groundstation.watchdog.report import DemandRoute, StationReport
from groundstation.watchdog.watchdog import Watchdog
from link.core import Peer, Received
from link.protocol.framer import Framer

STEP = 0.005
TICK, REPORT, LEASE, REPEAT_GAP = 0.025, 0.1, 0.1, 0.033
FREEZES_PER_EXAMPLE = 4
"""Freezes for each example of hypothesis: 400, and 100 in CI."""
PRESS = DriveKeyDown(key="i", throttle=1, steering=0)
REPEAT = DriveKeyDown(key="i", throttle=1, steering=0, repeat=True)


class FrozenStation:
    """A station with an armed rover and `i` held, and its watchdog; events of the station come at their own periods."""

    def __init__(self, chance: random.Random, autopilot: Autopilot) -> None:
        self.now = 100.0
        self.station = Station(["memory"], session=7, now=self.now)
        self.watchdog = Watchdog()
        self.neutrals: list[float] = []
        self.motion: list[float] = []
        self._autopilot = autopilot
        self._periods: dict[Callable[[], None], float] = {
            self._tick: TICK, self._report: REPORT, self._lease: LEASE, self._repeat: REPEAT_GAP, self._beat: 1.0,
        }  # fmt: skip
        self._due = {event: self.now + chance.uniform(0.0, period) for event, period in self._periods.items()}
        self._chance = chance
        for event in (self._lease, self._beat, self._report):
            event()
        for intent in (SetKeyGate(open=True), ReportKeyReleases()):
            self.station.handle_intent(intent, self.now)
        self.run(0.5)
        self.station.handle_intent(PRESS, self.now)
        self._flush()
        self.run(0.5)
        assert self.now - self.motion[-1] < 0.1

    def run(self, seconds: float) -> None:
        """Let the station run."""
        until = self.now + seconds
        while self.now < until:
            self.now += STEP
            self._run_due()
            self._watch()

    def freeze(self, seconds: float) -> None:
        """Let only the watchdog run; then everything that is due comes at once, in any order."""
        if self._chance.random() < 0.3:  # stopped after a demand was made and before it was sent
            self.station.tick(self.now)
        until = self.now + seconds
        while self.now < until:
            self.now += STEP
            self._watch()
        self._flush() if self._chance.random() < 0.5 else None
        self._run_due()

    def _run_due(self) -> None:
        due = [event for event, at in self._due.items() if self.now >= at]
        self._chance.shuffle(due)
        for event in due:
            self._due[event] = max(self._due[event] + self._periods[event], self.now)
            event()
            self._flush()

    def _watch(self) -> None:
        for _, target, frame in self.watchdog.tick(self.now):
            self.watchdog.record_sent(target, None)
            ((number, _, _, _, raw),) = Framer(stream=False).feed(frame, self.now)
            assert is_neutral(codec.decode_frame(number, raw))
            self.neutrals.append(self.now)

    def _flush(self) -> None:
        for outgoing in self.station.messages_to_send():
            if self.station.may_send(outgoing.message, self.now):  # as the runner does
                self.station.handle_sent(outgoing.message, 0, self.now)
                if isinstance(outgoing.message, m.ManualControl) and not is_neutral(outgoing.message):
                    self.motion.append(self.now)

    def _tick(self) -> None:
        self.station.tick(self.now)

    def _report(self) -> None:
        vehicles = self.station.report_to_watchdog(self.now)
        routes = tuple(DemandRoute(index, None, 0) for index in range(len(vehicles)))
        self.watchdog.handle_report(StationReport(vehicles=vehicles, routes=routes, rests=self.station.rests), self.now)

    def _lease(self) -> None:
        self.station.handle_intent(RenewLease(), self.now)

    def _repeat(self) -> None:
        self.station.handle_intent(REPEAT, self.now)

    def _beat(self) -> None:
        flags = base_mode(Mode.MANUAL, armed=True)
        beat = m.Heartbeat(VehicleType.GROUND_ROVER, self._autopilot, flags, Mode.MANUAL, SystemState.ACTIVE, 3)
        for message in (beat, m.ControlStatus(1, 255, [0] * 10)):
            self.station.receive(Received(message, 1, 1, 0, Peer(0, "vehicle"), introduced=True), self.now)


def is_neutral(message: m.Message) -> bool:
    axes = [getattr(message, axis) for axis in "xzr"]
    return all(axis in (0, m.INVALID_AXIS) for axis in axes)


@pytest.mark.parametrize("autopilot", [Autopilot.GENERIC, Autopilot.ARDUPILOT])
def test_after_a_neutral_of_the_watchdog_nothing_resumes(autopilot: Autopilot) -> None:
    chance, acted, freezes = random.Random(5), 0, FREEZES_PER_EXAMPLE * settings().max_examples
    for _ in range(freezes):  # of two autopilots
        frozen = FrozenStation(chance, autopilot)
        frozen.run(chance.uniform(0.0, 0.1))
        frozen.freeze(chance.choice((chance.uniform(0.2, 0.5), chance.uniform(0.3, 7.0))))
        frozen.run(1.0)
        if frozen.neutrals:
            acted += 1
            assert frozen.motion[-1] < frozen.neutrals[0]
    assert acted > 0.6 * freezes, "most of these freezes are long enough"


def test_a_short_pause_changes_nothing() -> None:
    frozen = FrozenStation(random.Random(1), Autopilot.ARDUPILOT)
    frozen.freeze(0.15)
    frozen.run(1.0)
    assert not frozen.neutrals
    assert frozen.now - frozen.motion[-1] < 0.1
