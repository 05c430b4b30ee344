"""Telemetry requests to a foreign vehicle: which, how often, and the fallback when it refuses."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Autopilot, Command, DataStream, Result
from groundstation.vehicles.probes.stream_requests import (
    CAPACITY_SHARE,
    FRAME,
    LOAD,
    STREAM_RATES,
    StreamRequests,
    stream_rate,
)
from tests.fakes.rover import FakeArduPilot
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.cockpits import Cockpit

INTERVAL = Command.SET_MESSAGE_INTERVAL
EXPECTED = {
    "ATTITUDE", "VFR_HUD", "LOCAL_POSITION_NED", "GLOBAL_POSITION_INT",
    "SYS_STATUS", "GPS_RAW_INT", "SERVO_OUTPUT_RAW", "BATTERY_STATUS", "VIBRATION", "MISSION_CURRENT",
    "NAV_CONTROLLER_OUTPUT",
}  # fmt: skip
ONLY = {
    Autopilot.ARDUPILOT: {"RC_CHANNELS", "EKF_STATUS_REPORT", "FENCE_STATUS"},
    Autopilot.PX4: {"ACTUATOR_OUTPUT_STATUS", "ESTIMATOR_STATUS"},
}


def streams(autopilot: Autopilot | None) -> set[int]:
    return {number for number, wanted in STREAM_RATES.items() if wanted.only in (None, autopilot)}


def requested_rates(vehicle: FakeVehicle) -> dict[int, float]:
    """Return message -> Hz of the last SET_MESSAGE_INTERVAL."""
    return {int(command.param1): 1e6 / command.param2 for command in vehicle.commands(INTERVAL)}


def groups(vehicle: FakeVehicle) -> dict[int, int]:
    return {message.req_stream_id: message.req_message_rate for _, message in vehicle.all(m.RequestDataStream)}


def test_everything_that_the_drive_screen_needs_is_requested() -> None:
    assert {m.MESSAGES[number].msgname for number in streams(None)} == EXPECTED
    for autopilot, only in ONLY.items():
        assert {m.MESSAGES[number].msgname for number in streams(autopilot)} == EXPECTED | only


@pytest.mark.parametrize("autopilot", [Autopilot.ARDUPILOT, Autopilot.PX4])
def test_a_foreign_vehicle_gets_requests_at_once_one_by_one(autopilot: Autopilot) -> None:
    vehicle = FakeArduPilot(autopilot=autopilot)
    cockpit = Cockpit(vehicle)
    cockpit.run(2.0)
    wanted = {number: pytest.approx(STREAM_RATES[number].rate) for number in streams(autopilot)}
    assert requested_rates(vehicle) == wanted
    assert len(vehicle.commands(INTERVAL)) == len(wanted), "each once: they were acknowledged"
    assert groups(vehicle) == {}
    cockpit.run(3.0)
    assert vehicle.rates[m.Attitude.id] == pytest.approx(10.0)
    assert not any("command" in text or "accepted" in text for text in cockpit.texts), "nobody needs to read of it"


def test_our_own_rover_gets_no_requests() -> None:
    vehicle = FakeVehicle()
    cockpit = Cockpit(vehicle)
    cockpit.run(0.1)
    vehicle.send(m.RoverDriveStatus(1, 0, 0, 0, [0, 0, 0, 0], 0, 0, 0))
    cockpit.run(10.0)
    assert vehicle.commands(INTERVAL) == []
    assert groups(vehicle) == {}


def test_an_unknown_vehicle_is_asked_for_what_does_not_arrive() -> None:
    vehicle = FakeVehicle(driver=None)
    cockpit = Cockpit(vehicle)
    cockpit.run(0.1)
    vehicle.send(m.Attitude(1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    cockpit.run(2.5)
    assert vehicle.commands(INTERVAL) == []
    cockpit.run(3.0)
    assert set(requested_rates(vehicle)) == streams(None) - {m.Attitude.id}


def test_a_vehicle_without_the_command_gets_group_requests() -> None:
    vehicle = FakeArduPilot()
    vehicle.answers[INTERVAL] = Result.UNSUPPORTED
    cockpit = Cockpit(vehicle)
    cockpit.run(6.0)
    assert len(vehicle.commands(INTERVAL)) == 1
    assert groups(vehicle) == {
        DataStream.EXTRA1: 10, DataStream.POSITION: 5, DataStream.RC_CHANNELS: 5, DataStream.EXTRA2: 4,
        DataStream.EXTENDED_STATUS: 1, DataStream.EXTRA3: 1,
    }  # fmt: skip
    assert len(vehicle.all(m.RequestDataStream)) == 3 * 6, "nothing acknowledges them, so each is said three times"
    assert vehicle.rates[m.Attitude.id] == 10.0


def test_a_vehicle_that_does_not_answer_gets_group_requests() -> None:
    vehicle = FakeArduPilot()
    vehicle.silent_on.add(INTERVAL)
    cockpit = Cockpit(vehicle)
    cockpit.run(8.0)
    assert {int(command.param1) for command in vehicle.commands(INTERVAL)} == {m.Attitude.id}
    assert len(groups(vehicle)) == 6
    assert cockpit.view.refusal is None


def test_a_refused_message_is_requested_by_its_group_alone() -> None:
    vehicle = FakeArduPilot()
    vehicle.answers[INTERVAL] = lambda command: Result.DENIED if command.param1 == m.ServoOutputRaw.id else None
    Cockpit(vehicle).run(5.0)
    assert set(requested_rates(vehicle)) == streams(Autopilot.ARDUPILOT)
    assert groups(vehicle) == {DataStream.RC_CHANNELS: 5}


def test_requested_again_when_lost_and_back() -> None:
    vehicle = FakeArduPilot()
    cockpit = Cockpit(vehicle)
    cockpit.run(3.0)
    first = len(vehicle.commands(INTERVAL))
    cockpit.run(20.0)
    assert len(vehicle.commands(INTERVAL)) == first, "who is there is not asked again"
    vehicle.reboot()
    cockpit.world.cut()
    cockpit.run(5.0)
    cockpit.world.cut(False)
    cockpit.run(4.0)
    assert len(vehicle.commands(INTERVAL)) == 2 * first
    assert vehicle.rates[m.Attitude.id] == 10.0


def test_a_clock_that_starts_anew_is_a_reboot() -> None:
    requests = StreamRequests((1, 1), 0.0)
    while requests.next_message(Autopilot.ARDUPILOT, 1.0) is not None:
        requests.handle_message(m.Attitude(60_000, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 1.0)
    requests.handle_message(m.Attitude(59_900, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 2.0)
    assert requests.next_message(Autopilot.ARDUPILOT, 2.0) is None
    requests.handle_message(m.Attitude(1_000, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 3.0)
    assert requests.next_message(Autopilot.ARDUPILOT, 3.0) is not None


def test_a_jumping_clock_does_not_restart_all_requests_each_time() -> None:
    requests = StreamRequests((1, 1), 0.0)
    clocks = [60_000 * (number % 2) for number in range(100)]
    reboots = [
        requests.handle_message(m.Attitude(boot, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 20 + number / 10)
        for number, boot in enumerate(clocks)
    ]
    assert sum(reboots) == 2, "one in REBOOT_PERIOD"


# ---- the link ----


def total(capacity: float | None) -> float:
    return sum((m.MESSAGES[number].unpacker.size + FRAME) * stream_rate(number, capacity) for number in STREAM_RATES)


@pytest.mark.parametrize("baud", [9600, 19200, 57600, 921600])
def test_together_they_leave_room_on_the_link(baud: int) -> None:
    assert total(baud / 10) <= max(CAPACITY_SHARE * baud / 10, 1.0) + 1e-6
    assert total(baud / 10) <= total(None) == LOAD


def test_a_slow_link_gets_less_and_a_usual_one_everything() -> None:
    assert stream_rate(m.Attitude.id, 960.0) == pytest.approx(10 * CAPACITY_SHARE * 960 / LOAD)
    assert stream_rate(m.Attitude.id, 5760.0) == 10.0
    assert stream_rate(m.Attitude.id, None) == 10.0
    assert stream_rate(m.GpsRawInt.id, 1.0) == 0.1
