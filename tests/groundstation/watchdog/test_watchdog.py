"""The watchdog and the station in virtual time: what happens before, during and after a freeze, in any order."""

from __future__ import annotations

import random
from collections.abc import Callable

import pytest

from dialects import codec
from dialects import messages as m
from dialects.enums import Autopilot, ModeFlag, OperatorFlag, SystemState, VehicleType
from dialects.modes import Mode, base_mode
from groundstation.intents.driving import DriveKeyDown
from groundstation.intents.session import RenewLease, ReportKeyReleases, SetKeyGate
from groundstation.snapshot import StationOutage
from groundstation.station.driving.driven import DrivenVehicle
from groundstation.station.driving.stall import REST_STALL_TIMEOUT, STALL_TIMEOUT, StallMonitor
from groundstation.station.station import Station
from groundstation.watchdog.report import DemandRoute, StationReport
from groundstation.watchdog.watchdog import SEND_FOR, Watchdog
from link.core import Peer, Received
from link.protocol.framer import Framer

STEP = 0.005
TICK, REPORT, LEASE, REPEAT_GAP = 0.025, 0.1, 0.1, 0.033
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
    chance, acted = random.Random(5), 0
    for _ in range(500):  # of two autopilots
        frozen = FrozenStation(chance, autopilot)
        frozen.run(chance.uniform(0.0, 0.1))
        frozen.freeze(chance.choice((chance.uniform(0.2, 0.5), chance.uniform(0.3, 7.0))))
        frozen.run(1.0)
        if frozen.neutrals:
            acted += 1
            assert frozen.motion[-1] < frozen.neutrals[0]
    assert acted > 300, "most of these freezes are long enough"


def test_a_short_pause_changes_nothing() -> None:
    frozen = FrozenStation(random.Random(1), Autopilot.ARDUPILOT)
    frozen.freeze(0.15)
    frozen.run(1.0)
    assert not frozen.neutrals
    assert frozen.now - frozen.motion[-1] < 0.1


ROVER = DrivenVehicle(system=1, component=1, name="Rover 1", autopilot=Autopilot.GENERIC, session=7, boot_time=1000)
ARDUROVER = DrivenVehicle(system=2, component=1, name="ArduPilot rover 2", autopilot=Autopilot.ARDUPILOT)


def watching(*vehicles: DrivenVehicle) -> Watchdog:
    """A watchdog with the report of a station that drives these, at 100 s; packet 10 was the newest."""
    watchdog = Watchdog()
    routes = tuple(DemandRoute(index, None, 10) for index in range(len(vehicles)))
    watchdog.handle_report(StationReport(vehicles=vehicles, routes=routes), 100.0)
    return watchdog


def sent(watchdog: Watchdog, start: float, seconds: float, error: str | None = None) -> list[tuple[float, m.Message]]:
    """Every frame of the next seconds, and when."""
    frames: list[tuple[float, m.Message]] = []
    for step in range(round(seconds / STEP)):
        now = start + step * STEP
        for _, target, data in watchdog.tick(now):
            watchdog.record_sent(target, error)
            ((number, system, component, _, raw),) = Framer(stream=False).feed(data, now)
            assert (system, component) == (255, 190)
            frames.append((now, codec.decode_frame(number, raw)))
    return frames


def test_a_kill_is_neutral_at_once_and_silence_after_the_timeout() -> None:
    killed, silent = watching(ARDUROVER), watching(ARDUROVER)
    killed.handle_end(100.02)
    assert sent(killed, 100.02, 1.0)[0][0] == 100.02
    assert sent(silent, 100.0, 1.0)[0][0] == pytest.approx(100.0 + STALL_TIMEOUT, abs=2 * STEP)


def test_neutral_is_sent_at_20_hz_then_at_5_hz_for_5_s() -> None:
    watchdog = watching(ARDUROVER)
    watchdog.handle_end(100.0)
    times = [at - 100.0 for at, _ in sent(watchdog, 100.0, 10.0)]
    assert sum(at < 1.0 for at in times) == pytest.approx(20, abs=1)
    assert sum(at >= 1.0 for at in times) == pytest.approx(20, abs=1)
    assert times[-1] <= SEND_FOR
    assert watchdog.finished(105.1)
    assert watchdog.timeout(105.1) is None


def test_each_vehicle_gets_neutral_in_its_own_way() -> None:
    watchdog = watching(ROVER, ARDUROVER)
    watchdog.handle_end(100.0)
    (_, proof), (_, demand) = sent(watchdog, 100.0, 2 * STEP)
    assert isinstance(proof, m.RoverOperatorPresence)
    assert (proof.session_id, proof.x, proof.r, proof.echo_time_boot_ms) == (7, 0, 0, 1000)
    assert proof.flags == OperatorFlag.AXES | OperatorFlag.INPUT_LOST
    assert isinstance(demand, m.ManualControl)
    assert (demand.target, demand.y, demand.z) == (2, 0, 0)


def heartbeat(*, armed: bool) -> m.Heartbeat:
    return m.Heartbeat(VehicleType.GROUND_ROVER, Autopilot.ARDUPILOT, ModeFlag.ARMED if armed else 0, 0, 4, 3)


def speed(value: float) -> m.VfrHud:
    return m.VfrHud(0.0, value, 0, 0, 0.0, 0.0)


def test_it_ends_when_the_vehicle_has_stood_for_a_while() -> None:
    watchdog = watching(ARDUROVER)
    watchdog.handle_end(100.0)
    sent(watchdog, 100.0, 1.5)
    for at, value in ((101.5, 0.1), (101.7, 0.5), (101.9, 0.1)):
        watchdog.handle_message(2, speed(value), at)
    assert not watchdog.finished(102.0)
    watchdog.handle_message(2, speed(0.0), 102.5)
    assert watchdog.finished(102.5)
    assert watchdog.outage(102.5) == StationOutage("station process ended: ArduPilot rover 2 stands", True)


def test_it_ends_on_disarming_but_not_before_a_second_of_neutral() -> None:
    watchdog = watching(ARDUROVER)
    watchdog.handle_end(100.0)
    sent(watchdog, 100.0, 0.1)
    watchdog.handle_message(2, heartbeat(armed=False), 100.1)
    watchdog.handle_message(9, heartbeat(armed=True), 100.2)
    assert watchdog.outage(100.2).text == "station process ended: ArduPilot rover 2 is disarmed"
    assert not watchdog.finished(100.5)
    assert watchdog.finished(101.1)


def test_what_waited_before_the_first_neutral_does_not_end_it() -> None:
    """An old report that the vehicle is disarmed, still in the socket when the station dies."""
    watchdog = watching(ARDUROVER)
    watchdog.handle_end(100.0)
    watchdog.handle_message(2, heartbeat(armed=False), 100.0)
    watchdog.handle_message(2, speed(0.0), 100.0)
    sent(watchdog, 100.0, 0.1)
    assert not watchdog.finished(101.1)
    watchdog.handle_message(2, heartbeat(armed=False), 101.2)
    assert watchdog.finished(101.2)


def test_a_script_on_board_does_not_report_the_vehicle_disarmed() -> None:
    watchdog = watching(ARDUROVER)
    watchdog.handle_end(100.0)
    sent(watchdog, 100.0, 0.1)
    raw = codec.frame(0, codec.encode_payload(heartbeat(armed=False)), 1, 2, 191)
    for frame in Framer(stream=False).feed(raw, 100.1):
        watchdog.handle_frame(frame, 100.1)
    assert not watchdog.finished(101.5)


def test_another_vehicle_with_its_id_does_not_end_the_neutral() -> None:
    watchdog = watching(ARDUROVER)
    watchdog.handle_end(100.0)
    sent(watchdog, 100.0, 0.1)
    for at in (100.2, 101.2, 102.2, 103.2):
        watchdog.handle_message(2, heartbeat(armed=True), at)
        watchdog.handle_message(2, heartbeat(armed=False), at + 0.3)
    assert not watchdog.finished(104.0)
    assert watchdog.finished(100.0 + SEND_FOR + 0.1)


def test_a_vehicle_that_moves_again_does_not_count_as_standing() -> None:
    watchdog = watching(ROVER)
    watchdog.handle_end(100.0)
    sent(watchdog, 100.0, 0.1)
    for output in (0, 300):
        watchdog.handle_message(1, m.RoverDriveStatus(0, 0, 0, 0, [output, 0, 0, 0], 0, 255, 0), 100.2)
    assert not watchdog.finished(101.5)


def test_only_what_is_known_is_said() -> None:
    watchdog = watching(ARDUROVER)
    assert watchdog.outage(100.1) == StationOutage()
    sent(watchdog, 100.0, 0.5, error="No such device")
    assert watchdog.outage(100.5).text == (
        "station not responding: neutral could NOT be sent to ArduPilot rover 2 (No such device)"
    )
    sent(watchdog, 100.5, 0.5)
    assert watchdog.outage(101.0).text.endswith(": neutral is sent to ArduPilot rover 2")
    sent(watchdog, 101.0, 6.0)
    assert watchdog.outage(107.0).text.endswith("ArduPilot rover 2 may still move")
    watchdog.handle_report(StationReport(), 107.1)
    assert watchdog.outage(107.1) == StationOutage()


def test_station_that_ends_in_order_or_never_began_needs_nothing() -> None:
    ended = watching(ARDUROVER)
    ended.handle_report(StationReport(ending=True), 100.1)
    starting = Watchdog()
    assert sent(starting, 100.0, 5.0) == []
    assert starting.timeout(100.0) is None
    for each in (ended, starting):
        each.handle_end(100.2)
        assert each.finished(100.2)
        assert each.outage(100.2) == StationOutage()


def test_packet_numbers_follow_those_of_the_station_with_a_gap() -> None:
    watchdog = watching(ARDUROVER)
    watchdog.handle_end(100.0)
    numbers = []
    for now in (100.0, 100.1):
        ((_, _, data),) = watchdog.tick(now)
        numbers.append(data[4])
    assert numbers == [51, 52]


def test_a_resting_station_may_report_later_until_its_rest_ends() -> None:
    watchdog = Watchdog()
    watchdog.handle_report(StationReport(rests=True), 100.0)
    assert watchdog.timeout(100.0) == pytest.approx(REST_STALL_TIMEOUT, abs=0.01)
    watchdog.tick(100.0 + REST_STALL_TIMEOUT - 0.01)
    assert not watchdog.outage(100.99).text
    watchdog.tick(100.0 + REST_STALL_TIMEOUT + 0.01)
    assert watchdog.outage(101.01).text == "station not responding: nothing is sent"
    watchdog.handle_report(StationReport(), 102.0)
    watchdog.tick(102.0 + STALL_TIMEOUT + 0.01)
    assert watchdog.outage(102.31).text


def test_station_and_watchdog_agree_on_the_longest_rest() -> None:
    stall = StallMonitor()
    stall.record_report(100.0, rests=True)
    assert not stall.is_stalled(100.0 + REST_STALL_TIMEOUT - 0.01)
    assert stall.is_stalled(100.0 + REST_STALL_TIMEOUT + 0.01)
    stall.record_report(102.0)
    assert stall.is_stalled(102.0 + STALL_TIMEOUT + 0.01)
