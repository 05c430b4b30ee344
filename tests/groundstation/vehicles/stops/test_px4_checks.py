"""Settings of a PX4 rover, encoded as PX4 sends them: integers in the bytes of the float."""

from __future__ import annotations

import struct

import pytest

from dialects.axes import AXIS_MAPS, NEUTRAL, PX4_FRAMES
from dialects.enums import Autopilot
from dialects.messages import ManualControl, ParamValue
from groundstation.intents.driving import DriveKeyDown, DriveKeyUp
from groundstation.intents.session import ReportKeyReleases
from groundstation.vehicles.stops.px4_checks import PX4
from groundstation.vehicles.stops.settings_check import SettingsCheck
from link.core import Peer, Received
from link.services.param.values import REAL32
from tests.fakes.params import Param
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.cockpits import Cockpit, armed_cockpit

ACKERMANN = 5
"""CA_AIRFRAME"""
INT32 = 6
"""MAV_PARAM_TYPE_INT32"""
ALERT_WIDTH = 76
"""Columns of the alert line at 80 columns."""

DEFAULTS: dict[str, float] = {
    "COM_RC_IN_MODE": 3, "COM_RC_LOSS_T": 0.5, "NAV_RCL_ACT": 2, "COM_FAIL_ACT_T": 5,
    "COM_DL_LOSS_T": 10, "NAV_DLL_ACT": 0,
    "CA_AIRFRAME": 6,
}  # fmt: skip
"""Of PX4 v1.16 with the airframe 50000, Generic Rover Differential."""


def value(name: str, number: float) -> Received:
    """Return a PARAM_VALUE of PX4: the bytes of an int32 in the place of the float."""
    if name in ("COM_RC_LOSS_T", "COM_FAIL_ACT_T"):
        message = ParamValue(name.encode(), number, REAL32, 1000, 500)
    else:
        (coded,) = struct.unpack("<f", struct.pack("<i", int(number)))
        message = ParamValue(name.encode(), coded, INT32, 1000, 500)
    return Received(message, 1, 1, 0, Peer(0, "vehicle"), introduced=True)


def check_with(**values: float) -> SettingsCheck:
    check = SettingsCheck(PX4, 255, 190, target=(1, 1))
    for name, number in values.items():
        check.receive(value(name, number), 0.0)
    return check


def px4(**changes: float) -> FakeVehicle:
    """Return a PX4 rover with its parameters."""
    vehicle = FakeVehicle(autopilot=Autopilot.PX4)
    for name, number in (DEFAULTS | changes).items():
        vehicle.params[name] = Param(number, REAL32 if name == "COM_RC_LOSS_T" else INT32)
    return vehicle


@pytest.mark.parametrize(
    ("name", "good", "bad", "warning"),
    [
        ("COM_RC_LOSS_T", 0.5, 5.0, "COM_RC_LOSS_T 5: drives on for 5 s when the link is lost; set it to 0.5"),
        ("NAV_RCL_ACT", 6, 0, "NAV_RCL_ACT 0: never stops when the link is lost; set it to 6 (disarm)"),
        ("NAV_RCL_ACT", 6, 1, "NAV_RCL_ACT 1: holds a place, and may drive for it; set it to 6 (disarm)"),
        ("NAV_RCL_ACT", 6, 2, "NAV_RCL_ACT 2: drives home when the link is lost; set it to 6 (disarm)"),
        ("NAV_RCL_ACT", 5, 3, "NAV_RCL_ACT 3: land mode when the link is lost; set it to 6 (disarm)"),
        ("COM_FAIL_ACT_T", 5, 25, "COM_FAIL_ACT_T 25: holds a place for 25 s before it acts; set it to 5"),
        ("NAV_DLL_ACT", 1, 0, "NAV_DLL_ACT 0: no failsafe when the GCS is lost; set it to 6 (disarm)"),
        ("NAV_DLL_ACT", 6, 2, "NAV_DLL_ACT 2: drives home when the GCS is lost; set it to 6 (disarm)"),
        ("COM_DL_LOSS_T", 10, 60, "COM_DL_LOSS_T 60: notices a lost ground station after 60 s; set it to 10"),
        ("COM_RC_IN_MODE", 1, 0, "COM_RC_IN_MODE 0: obeys RC only, keys do not drive; set it to 1"),
        ("COM_RC_IN_MODE", 2, 4, "COM_RC_IN_MODE 4: ignores manual control, keys do not drive; set it to 1"),
        ("CA_AIRFRAME", 13, 0, "CA_AIRFRAME 0 is not a rover: test the steering slowly"),
    ],
)
def test_each_setting(name: str, good: float, bad: float, warning: str) -> None:
    assert check_with(**{name: good}).warnings == ()
    assert check_with(**{name: bad}).warnings == (warning,)
    assert len(warning) <= ALERT_WIDTH


@pytest.mark.parametrize(
    ("after", "action", "hold", "words"),
    [
        (0.5, 1, 5.0, "by its settings it holds a place after 0.5 s, and may drive for it"),
        (5.0, 6, None, "by its settings it stops after 5 s (disarmed)"),
        (0.5, 5, None, "by its settings it stops after 0.5 s (terminated)"),
        (0.5, 2, 5.0, "by its settings it holds a place after 0.5 s, and drives home 5 s later"),
        (0.5, 3, 2.0, "by its settings it holds a place after 0.5 s, and selects land mode 2 s later"),
        (0.5, 2, None, None),
        (0.5, 0, 5.0, "by its settings it never stops"),
        (0.5, 4, 5.0, None),
        (0.5, None, 5.0, None),
        (None, 1, 5.0, None),
    ],
)
def test_what_a_lost_link_means(
    after: float | None, action: float | None, hold: float | None, words: str | None
) -> None:
    known = {"COM_RC_LOSS_T": after, "NAV_RCL_ACT": action, "COM_FAIL_ACT_T": hold}
    check = check_with(**{name: number for name, number in known.items() if number is not None})
    assert check.link_loss_action == words


def test_a_rover_with_default_settings_is_read_and_warned_of() -> None:
    cockpit = Cockpit(px4())
    cockpit.run(2.0)
    assert [warning.split(":")[0] for warning in cockpit.view.warnings] == ["NAV_RCL_ACT 2", "NAV_DLL_ACT 0"]
    assert cockpit.view.link_loss_action == "by its settings it holds a place after 0.5 s, and drives home 5 s later"


def test_unreadable_settings_are_named_and_requested_again() -> None:
    vehicle = px4(NAV_RCL_ACT=6, NAV_DLL_ACT=1)
    del vehicle.params["COM_RC_LOSS_T"]
    cockpit = Cockpit(vehicle)
    cockpit.run(5.0)
    assert list(cockpit.view.warnings) == ["could not read, trying again: COM_RC_LOSS_T"]
    assert cockpit.view.link_loss_action is None
    vehicle.params["COM_RC_LOSS_T"] = 0.5
    cockpit.run(15.0)
    assert not cockpit.view.warnings


def test_a_restart_reads_the_settings_again() -> None:
    vehicle = px4(NAV_RCL_ACT=6, NAV_DLL_ACT=1)
    cockpit = Cockpit(vehicle)
    cockpit.run(2.0)
    assert not cockpit.view.warnings
    cockpit.world.cut()
    cockpit.run(4.0)
    vehicle.params["COM_RC_LOSS_T"] = 35.0
    cockpit.world.cut(False)
    cockpit.run(4.0)
    assert list(cockpit.view.warnings) == ["COM_RC_LOSS_T 35: drives on for 35 s when the link is lost; set it to 0.5"]


@pytest.mark.parametrize("frame", [*PX4_FRAMES, 0])
def test_the_frame_selects_the_axes(frame: int) -> None:
    cockpit = Cockpit(px4(CA_AIRFRAME=frame))
    cockpit.run(2.0)
    contact = cockpit.station.fleet.selected
    assert contact is not None
    assert contact.choose_axes(NEUTRAL) is PX4_FRAMES.get(frame, AXIS_MAPS[Autopilot.PX4])


def test_frame_read_while_driving_turns_steering_after_a_neutral() -> None:
    vehicle = px4(CA_AIRFRAME=ACKERMANN)
    del vehicle.params["CA_AIRFRAME"]
    cockpit = armed_cockpit(vehicle)
    back_left = DriveKeyDown(key="m", throttle=-1, steering=1)
    cockpit.do(ReportKeyReleases(), back_left)
    cockpit.run(5.0)
    vehicle.params["CA_AIRFRAME"] = Param(ACKERMANN, INT32)
    cockpit.run(15.0)
    assert "could not read" not in str(cockpit.view.warnings)
    sent = {message.y for _, message in vehicle.all(ManualControl) if message.z < 500}
    assert sent == {600}
    cockpit.do(DriveKeyUp(key="m"))
    cockpit.run(1.0)
    released = cockpit.now
    cockpit.do(back_left)
    cockpit.run(1.0)
    sent = {message.y for at, message in vehicle.all(ManualControl) if message.z < 500 and at > released}
    assert sent == {-600}
