"""Control handed over, in both directions, with a vehicle that forwards requests."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Command, Result
from groundstation.intents.driving import DriveKeyUp
from groundstation.intents.session import ReportKeyReleases
from groundstation.intents.vehicle import Disarm, GiveControl, KeepControl, ReleaseControl, RequestControl
from groundstation.snapshot import HandoverNotice
from groundstation.station.driving.handover import ANSWER_WITHIN
from tests.fakes.rover import FakeArduPilot
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.cockpits import FORWARD, OURS, Cockpit, armed_cockpit, cockpit_with, driving_cockpit

OTHER = 254
CONTROL = Command.REQUEST_OPERATOR_CONTROL


def ask(cockpit: Cockpit, *, station: float = OTHER, to: int = OURS, timeout: float = ANSWER_WITHIN) -> None:
    """Let the vehicle forward the request of a station."""
    cockpit.vehicle.send(m.CommandLong(to, 0, CONTROL, 0, 1, 0, timeout, station, 0, 0, 0))
    cockpit.run(0.1)


def notice(cockpit: Cockpit) -> HandoverNotice | None:
    return cockpit.snapshot.handover


def released(cockpit: Cockpit) -> bool:
    return any(command.param1 == 0 for command in cockpit.vehicle.commands(CONTROL))


def test_a_request_is_shown_with_its_time() -> None:
    cockpit = armed_cockpit()
    ask(cockpit)
    seen = notice(cockpit)
    assert seen is not None
    assert (seen.station, seen.vehicle) == (OTHER, "Rover 1")
    assert seen.left == pytest.approx(ANSWER_WITHIN, abs=0.2)
    assert "GCS 254 requests control of Rover 1" in cockpit.texts


def test_giving_is_neutral_first_then_control_is_released() -> None:
    cockpit = driving_cockpit()
    ask(cockpit)
    since = cockpit.now
    cockpit.do(GiveControl())
    cockpit.run(0.2)
    assert not released(cockpit), "the final neutrals come first"
    assert cockpit.operator.gate_reason == "releasing control"
    cockpit.run(0.2)
    assert released(cockpit)
    assert len([at for at, x, _ in cockpit.demands(since) if not x]) >= 5
    assert not [x for at, x, _ in cockpit.demands(since) if x and at > since]
    quiet = cockpit.now
    cockpit.run(1.0)
    assert cockpit.demands(quiet) == []
    assert notice(cockpit) is None
    assert "control given to GCS 254" in cockpit.texts


def test_keeping_changes_nothing() -> None:
    cockpit = driving_cockpit()
    ask(cockpit)
    cockpit.do(KeepControl())
    cockpit.run(1.0)
    assert notice(cockpit) is None
    assert not released(cockpit)
    assert cockpit.operator.throttle == pytest.approx(0.6), "the key is held all along"


def test_without_an_answer_control_stays() -> None:
    cockpit = driving_cockpit()
    ask(cockpit, timeout=4.0)
    cockpit.run(3.7)
    assert notice(cockpit) is not None
    cockpit.run(0.5)
    assert notice(cockpit) is None
    assert not released(cockpit)
    assert "control not given to GCS 254" in cockpit.texts


@pytest.mark.parametrize("action", [GiveControl(), KeepControl()])
def test_an_answer_without_a_request_does_nothing(action: GiveControl | KeepControl) -> None:
    cockpit = armed_cockpit()
    cockpit.do(action)
    cockpit.run(0.5)
    assert not released(cockpit)
    assert cockpit.view.in_control


@pytest.mark.parametrize(("station", "to"), [(OURS, OURS), (0.0, OURS), (float("nan"), OURS), (1e9, OURS), (OTHER, 7)])
def test_a_request_that_is_not_for_us_or_names_nobody_is_ignored(station: float, to: int) -> None:
    cockpit = armed_cockpit()
    ask(cockpit, station=station, to=to)
    assert notice(cockpit) is None


def test_a_request_for_a_vehicle_that_is_not_ours_any_more_ends() -> None:
    cockpit = armed_cockpit()
    ask(cockpit)
    cockpit.vehicle.driver = OTHER
    cockpit.run(1.5)
    assert notice(cockpit) is None
    ask(cockpit)
    assert notice(cockpit) is None


def test_release_by_key_ends_driving_where_control_is_managed() -> None:
    cockpit = driving_cockpit()
    cockpit.do(ReleaseControl())
    cockpit.run(0.5)
    assert released(cockpit)
    assert cockpit.operator.throttle == 0


def test_release_by_key_ends_driving_of_an_ardurover_too() -> None:
    rover = FakeArduPilot()
    cockpit = armed_cockpit(rover)
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(0.5)
    assert rover.moves
    cockpit.do(ReleaseControl())
    cockpit.run(1.0)
    assert not rover.moves
    assert not cockpit.view.in_control
    quiet = cockpit.now
    cockpit.do(DriveKeyUp(key="i"), FORWARD)
    cockpit.run(1.0)
    assert not [at for at, message in rover.all(m.ManualControl) if at > quiet]
    assert any("it gets no more demands from here" in text for text in cockpit.texts)


def test_an_unanswered_release_ends_and_the_keys_drive_again() -> None:
    cockpit = driving_cockpit()
    cockpit.vehicle.silent_on = {CONTROL}
    cockpit.do(ReleaseControl())
    cockpit.run(1.0)
    assert cockpit.operator.gate_reason == "releasing control"
    cockpit.run(3.0)
    assert cockpit.view.in_control
    cockpit.do(DriveKeyUp(key="i"), FORWARD)
    cockpit.run(0.5)
    assert cockpit.operator.throttle == pytest.approx(0.6)


def test_release_without_control_asks_nothing_of_the_vehicle() -> None:
    cockpit = cockpit_with(FakeVehicle(driver=OTHER))
    for intent in (ReleaseControl(), ReleaseControl(all=True)):
        cockpit.do(intent)
    cockpit.run(0.5)
    assert not cockpit.vehicle.commands(CONTROL)
    assert "not in control of Rover 1" in cockpit.texts


def test_release_of_all_releases_what_we_control() -> None:
    cockpit = armed_cockpit()
    cockpit.do(ReleaseControl(all=True))
    cockpit.run(0.5)
    assert released(cockpit)
    assert not cockpit.view.in_control


def driven_by_another() -> FakeVehicle:
    """Return a vehicle that another station drives until it gives control."""
    vehicle = FakeVehicle(driver=OTHER)
    vehicle.armed = True
    vehicle.answers[CONTROL] = Result.FAILED
    return vehicle


def give(vehicle: FakeVehicle) -> None:
    """Give control, as the other station does."""
    vehicle.driver = 0
    vehicle.answers.pop(CONTROL)
    vehicle.beat()


def test_our_request_is_repeated_once_the_vehicle_is_free() -> None:
    vehicle = driven_by_another()
    cockpit = cockpit_with(vehicle)
    cockpit.do(RequestControl())
    cockpit.run(3.0)
    assert not cockpit.view.in_control
    assert cockpit.view.control_wait == pytest.approx(7.0, abs=0.2)
    assert len(vehicle.commands(CONTROL)) == 1, "the other operator is asked once"
    give(vehicle)
    cockpit.run(0.5)
    assert cockpit.view.in_control
    assert cockpit.view.control_wait is None
    assert [command.param2 for command in vehicle.commands(CONTROL)] == [0, 0], "others must ask us"


def test_our_request_ends_without_an_answer() -> None:
    vehicle = driven_by_another()
    cockpit = cockpit_with(vehicle)
    cockpit.do(RequestControl())
    cockpit.run(ANSWER_WITHIN + 0.2)
    assert cockpit.view.control_wait is None
    assert "control not given by GCS 254" in cockpit.texts
    give(vehicle)
    cockpit.run(2.0)
    assert not cockpit.view.in_control, "a request of long ago takes nothing"


def test_disarming_while_a_request_waits_leaves_it() -> None:
    cockpit = armed_cockpit()
    ask(cockpit)
    cockpit.do(Disarm())
    cockpit.run(0.5)
    assert notice(cockpit) is not None


def test_a_program_with_our_id_is_not_waited_for() -> None:
    vehicle = driven_by_another()
    vehicle.driver = OURS
    cockpit = cockpit_with(vehicle)
    vehicle.send(m.RoverControl(77, OURS, 190, 0))
    cockpit.run(0.1)
    assert cockpit.view.duplicate_gcs
    cockpit.do(RequestControl())
    cockpit.run(0.5)
    assert len(vehicle.commands(CONTROL)) == 1
    assert cockpit.view.control_wait is None, "the vehicle cannot ask that program"
