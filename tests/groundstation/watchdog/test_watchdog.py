"""The watchdog in virtual time: when it sends neutral, to whom, until when, and the texts for the driver."""

from __future__ import annotations

import msgspec
import pytest

from dialects import codec
from dialects import messages as m
from dialects.enums import Autopilot, ModeFlag, OperatorFlag, VehicleType
from groundstation.snapshot import StationOutage
from groundstation.station.driving.driven import WatchdogTarget
from groundstation.station.driving.stall import REST_STALL_TIMEOUT, STALL_TIMEOUT, StallMonitor
from groundstation.watchdog.report import DemandRoute, StationReport
from groundstation.watchdog.watchdog import SEND_FOR, Watchdog
from link.protocol.framer import Framer

STEP = 0.005
QUADROTOR = 2
ROVER = WatchdogTarget(
    system=1, component=1, name="Rover 1", autopilot=Autopilot.GENERIC, kind=10, session=7, boot_time=1000
)
ARDUROVER = WatchdogTarget(system=2, component=1, name="ArduPilot rover 2", autopilot=Autopilot.ARDUPILOT, kind=10)


def watching(*vehicles: WatchdogTarget) -> Watchdog:
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


def test_a_copter_hovers_or_its_own_failsafe_flies_it() -> None:
    watchdog = watching(msgspec.structs.replace(ARDUROVER, name="copter 2", kind=QUADROTOR))
    watchdog.handle_end(100.0)
    sent(watchdog, 100.0, 1.5)
    for at, climb in ((101.5, -0.7), (102.2, -0.7), (102.4, 0.0)):
        watchdog.handle_message(2, m.VfrHud(0.0, 0.0, 0, 0, 0.0, climb), at)
        assert not watchdog.finished(at)
    assert watchdog.outage(106.0).text == "station process ended: copter 2: its own failsafe flies it"
    watchdog.handle_message(2, m.VfrHud(0.0, 0.1, 0, 0, 0.0, 0.1), 103.0)
    assert watchdog.outage(103.0).text == "station process ended: copter 2 hovers"
    assert watchdog.finished(103.0)


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


def test_neutral_is_sent_for_5_s_to_the_moment() -> None:
    watchdog = watching(ARDUROVER)
    watchdog.handle_end(100.0)
    assert not watchdog.finished(105.0)
    assert watchdog.tick(105.0)
    assert watchdog.finished(105.01)
    assert watchdog.tick(105.01) == []


def test_the_rate_falls_after_a_second() -> None:
    watchdog = watching(ARDUROVER)
    watchdog.handle_end(100.0)
    sends = [at for at in (100.0, 100.03, 100.0625, 101.0, 101.15, 101.25, 101.4, 101.5) if watchdog.tick(at)]
    assert sends == [100.0, 100.0625, 101.0, 101.25, 101.5]


def test_the_next_wake_up_is_when_a_frame_is_due() -> None:
    watchdog = watching(ARDUROVER)
    assert watchdog.timeout(100.0) == pytest.approx(0.301, abs=1e-6)
    assert watchdog.timeout(100.1) == pytest.approx(0.201, abs=1e-6)
    assert watchdog.timeout(105.0) == pytest.approx(0.001, abs=1e-6)
    watchdog.handle_end(105.0)
    assert watchdog.timeout(105.0) == 0.0
    watchdog.tick(105.0)
    assert watchdog.timeout(105.01) == pytest.approx(0.04, abs=1e-6)
    assert watchdog.timeout(105.5) == 0.0


def test_a_station_is_silent_after_more_than_300_ms() -> None:
    watchdog = Watchdog()
    routes = (DemandRoute(0, None, 10),)
    watchdog.handle_report(StationReport(vehicles=(ARDUROVER,), routes=routes), 0.0)
    assert watchdog.tick(0.3) == []
    assert watchdog.tick(0.301)


def test_a_running_station_is_not_finished() -> None:
    assert not Watchdog().finished(100.0)
    assert not watching(ARDUROVER).finished(100.1)


def test_the_silence_of_a_station_that_ended_in_order_is_none() -> None:
    watchdog = watching(ARDUROVER)
    watchdog.handle_report(StationReport(vehicles=(ARDUROVER,), routes=(DemandRoute(0, None, 10),), ending=True), 100.1)
    watchdog.handle_end(100.2)
    assert watchdog.tick(102.0) == []
    assert watchdog.outage(102.0) == StationOutage()


def test_a_silent_station_that_then_ends_is_said_to_have_ended() -> None:
    watchdog = watching(ARDUROVER)
    watchdog.tick(100.5)
    assert watchdog.outage(100.5) == StationOutage("station not responding: " + NOT_SENT, False)
    watchdog.handle_end(101.0)
    assert watchdog.outage(101.0) == StationOutage("station process ended: " + NOT_SENT, True)


NOT_SENT = "neutral could NOT be sent to ArduPilot rover 2 (no link)"


def test_a_vehicle_without_a_route_is_said_to_get_nothing() -> None:
    watchdog = Watchdog()
    watchdog.handle_report(StationReport(vehicles=(ARDUROVER,)), 100.0)
    watchdog.handle_end(100.0)
    assert watchdog.finished(100.0)
    assert watchdog.outage(100.0).text == "station process ended: " + NOT_SENT


def test_neutral_goes_on_until_each_vehicle_stands() -> None:
    watchdog = watching(ROVER, ARDUROVER)
    watchdog.handle_end(100.0)
    sent(watchdog, 100.0, 0.1)
    watchdog.handle_message(2, heartbeat(armed=False), 100.2)
    assert not watchdog.finished(101.5)
    watchdog.handle_message(1, m.RoverDriveStatus(0, 0, 0, 0, [0, 0, 0, 0], 0, 255, 0), 101.5)
    assert watchdog.finished(101.5)
    assert watchdog.outage(101.5).text == ("station process ended: Rover 1 stands, ArduPilot rover 2 is disarmed")


def test_a_second_of_neutral_is_a_whole_one() -> None:
    watchdog = watching(ARDUROVER)
    watchdog.handle_end(100.0)
    sent(watchdog, 100.0, 0.1)
    watchdog.handle_message(2, heartbeat(armed=False), 100.2)
    assert not watchdog.finished(100.99)
    assert watchdog.finished(101.0)


def test_our_own_rover_does_not_stand_by_its_speed() -> None:
    """It reports its outputs; its speed may be unknown."""
    watchdog = watching(ROVER)
    watchdog.handle_end(100.0)
    sent(watchdog, 100.0, 0.1)
    for at in (100.2, 101.2):
        watchdog.handle_message(1, speed(0.0), at)
    assert not watchdog.finished(101.5)


@pytest.mark.parametrize(
    ("readings", "stands"),
    [
        (((101.0, 0.0), (101.25, 0.0)), False),
        (((101.0, 0.0), (101.49, 0.0)), False),
        (((101.0, 0.0), (101.5, 0.0)), True),
        (((101.0, 0.19), (101.5, 0.19)), True),
        (((101.0, 0.2), (101.5, 0.2)), False),
        (((101.0, 0.0), (101.25, 0.2), (101.5, 0.0)), False),
    ],
)
def test_a_foreign_vehicle_stands_below_200_mm_per_s_for_500_ms(
    readings: tuple[tuple[float, float], ...], stands: bool
) -> None:
    watchdog = watching(ARDUROVER)
    watchdog.handle_end(100.0)
    sent(watchdog, 100.0, 0.1)
    for at, value in readings:
        watchdog.handle_message(2, speed(value), at)
    assert watchdog.finished(101.5) is stands


@pytest.mark.parametrize(("after", "disarmed"), [(1.0, False), (2.5, False), (2.51, True)])
def test_disarmed_counts_2500_ms_after_the_last_armed(after: float, disarmed: bool) -> None:
    watchdog = watching(ARDUROVER)
    watchdog.handle_end(100.0)
    sent(watchdog, 100.0, 0.1)
    watchdog.handle_message(2, heartbeat(armed=True), 100.5)
    watchdog.handle_message(2, heartbeat(armed=False), 100.5 + after)
    assert watchdog.finished(103.5) is disarmed


def test_a_vehicle_that_does_not_sign_ends_the_neutral() -> None:
    watchdog = watching(ARDUROVER)
    watchdog.handle_end(100.0)
    sent(watchdog, 100.0, 0.1)
    raw = codec.frame(0, codec.encode_payload(heartbeat(armed=False)), 1, 2, 1)
    for frame in Framer(stream=False).feed(raw, 100.1):
        watchdog.handle_frame(frame, 100.1)
    assert watchdog.finished(101.5)


def test_a_report_says_nothing_by_default() -> None:
    report = StationReport()
    assert report.ids == (255, 190)
    assert (report.vehicles, report.routes, report.keys_version) == ((), (), 0)
    flags = (report.keeps_descriptors, report.screen_has_quit, report.screen_is_gone, report.rests, report.ending)
    assert not any(flags)
