"""The stop matrix in the air: altitude and place are ground truth, and no stop costs more than 0.5 m of altitude.

Each test first sees the copter fly by keys, then that it hovers, or that its own failsafe flies it.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest

from dialects import messages as m
from dialects.axes import HOVER
from dialects.enums import Command
from groundstation.input.keymap import KEYMAPS, KeyEvent, Keymap
from groundstation.intents.driving import DriveKeyDown, DriveKeyUp, DrivePad, EmergencyStop, ReleasePad, Stop
from groundstation.intents.links import CloseLink
from groundstation.intents.session import Quit, SetKeyGate
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import Arm, CutMotors, Disarm, ReleaseControl, SetMode, TakeOff
from groundstation.vehicles.demand.demand_stream import FINAL_NEUTRALS
from groundstation.vehicles.demand.stop_commands import StopKind
from tests.fakes.flying import HOME_ALTITUDE, FlyingVehicle
from tests.fakes.multicopters import ArduCopter, Px4Quad
from tests.fakes.params import Param
from tests.flight import FlightCockpit, hovering_cockpit
from tests.groundstation.cockpits import Cockpit

Build = Callable[[], FlyingVehicle]
COPTERS = pytest.mark.parametrize("build", [ArduCopter, Px4Quad], ids=["arducopter", "px4"])
LOSS = 0.5
"""m of altitude that a stop may cost."""
BRAKES_WITHIN = 4.0
"""s from 7.5 m/s to standing, of the stand-ins."""
FORWARD = DriveKeyDown(key="i", throttle=1, steering=0)
SIDE = DriveKeyDown(key="o", throttle=0, steering=0, side=1)
UP = DriveKeyDown(key="pageup", throttle=0, steering=0, climb=1)
DOWN = DriveKeyDown(key="pagedown", throttle=0, steering=0, climb=-1)


def flying_cockpit(build: Build) -> FlightCockpit:
    """Return a hovering copter that flies ahead by a held key."""
    cockpit = hovering_cockpit(build())
    cockpit.do(FORWARD)
    cockpit.run(2.0)
    assert cockpit.copter.speed > 3.0, cockpit.operator
    return cockpit


def assert_hovers(cockpit: FlightCockpit, altitude: float) -> None:
    """Let time pass; the copter stands in the air at its altitude."""
    cockpit.run(BRAKES_WITHIN)
    copter = cockpit.copter
    assert copter.speed == pytest.approx(0.0)
    assert copter.altitude == pytest.approx(altitude, abs=LOSS)
    assert copter.lowest_z >= HOVER


def close_gate(cockpit: FlightCockpit) -> None:
    cockpit.do(SetKeyGate(open=False, reason="another screen"))


def lose_screen(cockpit: FlightCockpit) -> None:
    cockpit.leasing = False


def crash(cockpit: FlightCockpit) -> None:
    cockpit.core.activate(cockpit.now)


WAYS: dict[str, Callable[[FlightCockpit], object] | AnyIntent] = {
    "let go": DriveKeyUp(key="i"),
    "space": Stop(),
    "gate": close_gate,
    "screen": lose_screen,
    "crash": crash,
    "release control": ReleaseControl(),
    "quit": Quit(disarm=True),
    "close link": CloseLink(0),
    "hold": SetMode(mode="HOLD"),
}


@COPTERS
@pytest.mark.parametrize("way", WAYS)
def test_what_ends_driving_hovers(build: Build, way: str) -> None:
    cockpit = flying_cockpit(build)
    altitude, what = cockpit.copter.altitude, WAYS[way]
    if callable(what):
        what(cockpit)
    else:
        cockpit.do(what)
    assert_until(cockpit, altitude)
    last = [message for _, message in cockpit.copter.all(m.ManualControl)][-FINAL_NEUTRALS:]
    assert {(each.x, each.y, each.z, each.r) for each in last} == {(0, 0, HOVER, 0)}


def assert_until(cockpit: FlightCockpit, altitude: float) -> None:
    """It hovers, until its own failsafe for silence of the station acts, which flies home or lands."""
    copter = cockpit.copter
    cockpit.run(0.4)
    for _ in range(30):
        cockpit.run(0.1)
        if copter.mode_name in copter_home(copter):
            break
        assert copter.altitude == pytest.approx(altitude, abs=LOSS)
    else:
        assert copter.speed == pytest.approx(0.0)
    assert copter.lowest_z >= HOVER
    assert copter.armed


def copter_home(copter: FlyingVehicle) -> tuple[str, ...]:
    return ("RTL", "LAND", "AUTO_RTL", "AUTO_LAND")


@COPTERS
def test_a_lost_link_is_its_own_failsafe(build: Build) -> None:
    cockpit = flying_cockpit(build)
    altitude = cockpit.copter.altitude
    cockpit.world.cut()
    cockpit.run(3.6)
    assert cockpit.copter.altitude == pytest.approx(altitude, abs=LOSS)
    assert cockpit.copter.mode_name in ("RTL", "LAND", "HOLD", "AUTO_RTL")


def test_a_takeover_in_the_air_ends_by_its_own_failsafe() -> None:
    """ArduCopter then obeys the id of that station alone, and our neutral does not count either."""
    cockpit = flying_cockpit(ArduCopter)
    copter = cockpit.copter
    altitude = copter.altitude
    copter.params["MAV_GCS_SYSID"] = Param(254)
    cockpit.do(DriveKeyUp(key="i"))
    cockpit.run(3.6)
    assert copter.mode_name in ("RTL", "LAND")
    assert copter.altitude == pytest.approx(altitude, abs=LOSS)
    cockpit.run(1.0)
    assert copter.lowest_z >= HOVER
    assert copter.armed


@COPTERS
def test_a_frozen_station_is_bounded_by_its_own_failsafe(build: Build) -> None:
    cockpit = flying_cockpit(build)
    altitude = cockpit.copter.altitude
    cockpit.world.near.frozen = True
    cockpit.run(3.6)
    assert cockpit.copter.altitude == pytest.approx(altitude, abs=LOSS)
    assert cockpit.copter.mode_name in ("RTL", "LAND", "HOLD", "AUTO_RTL")
    cockpit.world.near.frozen = False
    before = len(cockpit.copter.all(m.ManualControl))
    cockpit.run(1.0)
    late = [message for _, message in cockpit.copter.all(m.ManualControl)][before:]
    assert all((each.x, each.z) == (0, HOVER) for each in late)


@COPTERS
def test_a_mode_without_altitude_ends_driving_at_once(build: Build) -> None:
    cockpit = flying_cockpit(build)
    copter = cockpit.copter
    copter.set_mode("STABILIZE" if isinstance(copter, ArduCopter) else "STABILIZED")
    cockpit.run(0.03)
    at = cockpit.now
    cockpit.run(0.45)
    demands = [message for when, message in copter.all(m.ManualControl) if when > at]
    assert all((each.x, each.z) == (0, HOVER) for each in demands)
    assert len(demands) <= FINAL_NEUTRALS + 4
    assert cockpit.operator.gate_reason.startswith("mode STABILIZE")
    assert not copter.demands(cockpit.now - 0.15), "neutral is not repeated where it is thrust"
    cockpit.run(3.0)
    assert copter.altitude > 4.0


@COPTERS
def test_keys_fly_all_four_axes_and_z_stays_in_its_bounds(build: Build) -> None:
    cockpit = hovering_cockpit(build())
    copter = cockpit.copter
    for key, axis in ((UP, "climb"), (DOWN, "climb"), (SIDE, "speed_east")):
        cockpit.do(key)
        cockpit.run(1.5)
        assert abs(getattr(copter, axis)) > 0.05, key
        cockpit.do(DriveKeyUp(key=key.key))
        altitude = copter.altitude
        cockpit.run(4.0)
        assert abs(getattr(copter, axis)) == pytest.approx(0.0, abs=0.01)
        assert copter.altitude == pytest.approx(altitude, abs=LOSS)
    assert copter.lowest_z == (280 if isinstance(copter, ArduCopter) else 300)


@COPTERS
def test_the_gamepad_let_go_hovers(build: Build) -> None:
    cockpit = hovering_cockpit(build())
    copter = cockpit.copter
    for count in range(30):
        pad = DrivePad(throttle=0.5, steering=0.0, side=0.5, climb=1.0, read_at=cockpit.now, repeat=count > 0)
        cockpit.do(pad)
        cockpit.run(0.05)
    assert copter.speed > 1.0
    assert copter.climb > 0.3
    cockpit.do(ReleasePad())
    cockpit.run(0.6)
    assert_hovers(cockpit, copter.altitude)


@COPTERS
def test_the_gamepad_flies_in_no_mode_that_is_not_for_keys(build: Build) -> None:
    cockpit = hovering_cockpit(build())
    copter = cockpit.copter

    def push(seconds: float) -> list[m.ManualControl]:
        at = cockpit.now + 0.03
        for count in range(round(seconds / 0.05)):
            cockpit.do(DrivePad(1.0, 0.5, side=1.0, climb=-1.0, read_at=cockpit.now, repeat=count > 0))
            cockpit.run(0.05)
        return [message for when, message in copter.all(m.ManualControl) if when > at]

    flown = copter.mode_name
    names = {"STABILIZE": "STABILIZED", "RTL": "AUTO_RTL", "LAND": "AUTO_LAND"}
    for mode in ("STABILIZE", "ACRO", "RTL", "LAND"):
        assert min(each.z for each in push(0.5)) < HOVER, mode
        copter.set_mode(mode if isinstance(copter, ArduCopter) else names.get(mode, mode))
        cockpit.run(0.03)
        assert {(each.x, each.y, each.z, each.r) for each in push(1.5)} <= {(0, 0, HOVER, 0)}, mode
        assert cockpit.operator.gate_reason.startswith("mode "), mode
        cockpit.do(ReleasePad())
        copter.set_mode(flown)
        copter.lift(5.0)
        cockpit.run(1.5)


@COPTERS
def test_space_stops_what_flies_itself(build: Build) -> None:
    cockpit = hovering_cockpit(build())
    copter = cockpit.copter
    cockpit.do(SetMode(mode="LAND"))
    cockpit.run(1.5)
    assert copter.climb < -0.5
    cockpit.do(Stop())
    cockpit.run(1.5)
    assert copter.mode_name in ("BRAKE", "HOLD")
    altitude = copter.altitude
    cockpit.run(3.0)
    assert copter.altitude == pytest.approx(altitude, abs=LOSS)


@COPTERS
def test_the_emergency_stop_lands_and_never_falls(build: Build) -> None:
    cockpit = flying_cockpit(build)
    copter = cockpit.copter
    for _ in range(5):  # a hand that holds the key
        cockpit.do(EmergencyStop())
        cockpit.run(0.4)
    assert copter.mode_name in ("LAND", "AUTO_LAND")
    assert copter.armed
    cockpit.run(15.0)
    assert not copter.flies
    assert not copter.armed
    assert copter.hit_ground_at < 1.0
    forced = [each for each in copter.commands(Command.COMPONENT_ARM_DISARM) if each.param2]
    assert forced == []


@COPTERS
@pytest.mark.parametrize("mode", ["RTL", "HOLD"])
def test_the_key_lands_it_from_a_mode_that_flies_by_itself(build: Build, mode: str) -> None:
    cockpit = hovering_cockpit(build())
    cockpit.copter.north = 100.0
    cockpit.do(SetMode(mode=mode))
    cockpit.run(2.0)
    assert cockpit.copter.mode_name in (*copter_home(cockpit.copter), "BRAKE", "HOLD")
    keymap = Keymap("standard", KEYMAPS["standard"]).in_flight()
    cockpit.do(*keymap.build_intents([KeyEvent("exclamation_mark")], armed=True, driving=True))
    cockpit.run(2.5)
    assert cockpit.copter.mode_name in ("LAND", "AUTO_LAND")
    assert cockpit.copter.climb < -0.5
    cockpit.do(Stop())
    cockpit.run(2.0)
    assert cockpit.copter.mode_name in ("BRAKE", "HOLD")


def unheard_cockpit(build: Build) -> FlightCockpit:
    """Return a station that has never heard the copter, which hovers."""
    copter = build()
    copter.mute = True
    copter.lift(5.0)
    cockpit = FlightCockpit(copter)
    cockpit.run(0.5)
    return cockpit


def powers_ended(copter: FlyingVehicle) -> list[object]:
    """Return the commands that let it fall."""
    forced = [each for each in copter.commands(Command.COMPONENT_ARM_DISARM) if each.param2]
    return [*forced, *copter.commands(Command.DO_SET_SAFETY_SWITCH_STATE)]


@COPTERS
@pytest.mark.parametrize("system", [0, 1])
@pytest.mark.parametrize("kind", [StopKind.EMERGENCY, StopKind.DISARM, StopKind.HOLD], ids=lambda each: each.name)
def test_no_stop_to_a_copter_that_was_not_heard_falls(build: Build, kind: StopKind, system: int) -> None:
    cockpit = unheard_cockpit(build)
    copter = cockpit.copter
    cockpit.station.stop_blindly(kind, system, cockpit.now)
    cockpit.run(1.0)
    assert copter.altitude == pytest.approx(5.0, abs=LOSS)
    cockpit.run(20.0 if kind is StopKind.EMERGENCY else 5.0)
    assert powers_ended(copter) == []
    assert copter.hit_ground_at < 1.0
    assert copter.flies is (kind is not StopKind.EMERGENCY)
    assert copter.armed is copter.flies


@COPTERS
def test_a_copter_heard_after_a_blind_stop_lands(build: Build) -> None:
    cockpit = unheard_cockpit(build)
    copter = cockpit.copter
    cockpit.do(EmergencyStop())
    cockpit.run(0.4)
    copter.mute = False
    cockpit.run(20.0)
    assert powers_ended(copter) == []
    assert copter.hit_ground_at < 1.0
    assert not copter.armed


@COPTERS
def test_on_the_ground_the_emergency_stop_disarms(build: Build) -> None:
    copter = build()
    cockpit = Cockpit(copter)
    cockpit.run(8.0)
    cockpit.do(Arm(held=1.0))
    cockpit.run(2.0)
    assert copter.armed
    cockpit.do(EmergencyStop())
    cockpit.run(0.5)
    assert not copter.armed


@COPTERS
def test_only_the_key_that_is_held_cuts_the_motors(build: Build) -> None:
    cockpit = hovering_cockpit(build())
    copter = cockpit.copter
    cockpit.do(CutMotors(held=1.9))
    cockpit.run(1.0)
    assert copter.armed
    assert any("the key was not held for 2 s" in text for text in cockpit.texts)
    cockpit.do(CutMotors(held=2.0))
    cockpit.run(3.0)
    assert not copter.armed
    assert copter.hit_ground_at > 5.0


@COPTERS
def test_disarming_and_quitting_in_the_air_leave_it_flying(build: Build) -> None:
    cockpit = flying_cockpit(build)
    copter = cockpit.copter
    cockpit.do(Disarm())
    cockpit.run(2.0)
    assert copter.armed
    before = len(copter.commands(Command.COMPONENT_ARM_DISARM))
    cockpit.do(Quit(disarm=True))
    cockpit.run(3.0)
    assert len(copter.commands(Command.COMPONENT_ARM_DISARM)) == before
    assert copter.hit_ground_at == 0.0


UNSAFE = [
    (ArduCopter, "FS_GCS_ENABLE", 0, "set it to 5 (land)"),
    (ArduCopter, "FS_OPTIONS", 16, "set it to 0"),
    (ArduCopter, "FS_THR_ENABLE", 0, "set it to 3 (land)"),
    (ArduCopter, "RC_OVERRIDE_TIME", -1, "set it to 3"),
    (ArduCopter, "FS_GCS_TIMEOUT", 30, "set it to 5"),
    (Px4Quad, "NAV_RCL_ACT", 6, "set it to 3 (land)"),
    (Px4Quad, "NAV_DLL_ACT", 5, "set it to 3 (land)"),
    (Px4Quad, "COM_RC_LOSS_T", 5, "set it to 0.5"),
    (Px4Quad, "COM_RC_IN_MODE", 4, "set it to 1"),
]


@pytest.mark.parametrize(("build", "name", "value", "remedy"), UNSAFE, ids=[row[1] for row in UNSAFE])
def test_no_key_takes_off_what_would_fall_or_fly_on(
    build: Callable[..., FlyingVehicle], name: str, value: float, remedy: str
) -> None:
    copter = build(**{name: value})
    cockpit = Cockpit(copter)
    cockpit.run(8.0)
    cockpit.do(Arm(held=1.0))
    cockpit.run(2.0)
    assert not copter.armed
    assert any(f"arm: no take-off: {name}" in text and remedy in text for text in cockpit.texts), cockpit.texts
    copter.armed = True  # by its transmitter
    cockpit.run(2.0)
    cockpit.do(TakeOff(held=1.0), UP)
    cockpit.run(3.0)
    assert copter.highest == 0.0


FENCES: list[tuple[Callable[..., FlyingVehicle], dict[str, float], str]] = [
    (ArduCopter, {"FENCE_ENABLE": 1, "FENCE_ALT_MAX": 4}, "FENCE_ALT_MAX 4"),
    (ArduCopter, {"FENCE_AUTOENABLE": 3, "FENCE_ALT_MAX": 4}, "FENCE_ALT_MAX 4"),
    (Px4Quad, {"GF_MAX_VER_DIST": 4}, "GF_MAX_VER_DIST 4"),
]
NO_FENCES: list[tuple[Callable[..., FlyingVehicle], dict[str, float]]] = [
    (ArduCopter, {"FENCE_ENABLE": 1, "FENCE_ALT_MAX": 4, "FENCE_TYPE": 6}),
    (Px4Quad, {"GF_MAX_VER_DIST": 4, "GF_ACTION": 0}),
]


@pytest.mark.parametrize(("build", "params", "limit"), FENCES)
def test_no_take_off_goes_above_its_own_fence(
    build: Callable[..., FlyingVehicle], params: dict[str, float], limit: str
) -> None:
    copter = build(**params)
    cockpit = Cockpit(copter)
    cockpit.run(8.0)
    cockpit.do(Arm(held=1.0))
    cockpit.run(2.0)
    assert copter.armed, cockpit.texts
    cockpit.do(TakeOff(altitude=5.0, held=1.0))
    cockpit.run(3.0)
    assert copter.highest == 0.0
    assert any(f"5 m is above its altitude fence, {limit}: take off lower" in text for text in cockpit.texts)
    ground = 0.0 if isinstance(copter, ArduCopter) else HOME_ALTITUDE
    by_hand = [m.CommandLong(1, 1, Command.NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 0, ground + each) for each in (5.0, 3.0)]
    assert [cockpit.station.may_send(each, cockpit.now) for each in by_hand] == [False, True]
    cockpit.do(TakeOff(held=1.0))
    cockpit.run(8.0)
    assert copter.highest == pytest.approx(3.0, abs=0.3)


@pytest.mark.parametrize(("build", "params"), NO_FENCES)
def test_a_fence_without_an_altitude_limits_none(build: Callable[..., FlyingVehicle], params: dict[str, float]) -> None:
    hovering_cockpit(build(**params), 5.0)


def test_a_copter_that_has_no_fence_takes_off() -> None:
    copter = ArduCopter()
    for name in [each for each in copter.params if each.startswith("FENCE_")]:
        del copter.params[name]
    hovering_cockpit(copter)


def test_nothing_takes_off_before_its_settings_are_read() -> None:
    copter = ArduCopter()
    copter.params.withheld.add("FS_OPTIONS")
    cockpit = Cockpit(copter)
    cockpit.run(2.0)
    cockpit.do(Arm(held=1.0))
    cockpit.run(8.0)
    cockpit.do(Arm(held=1.0))
    cockpit.run(2.0)
    assert not copter.armed
    assert any("is being read" in text for text in cockpit.texts)
    assert any("could not read, trying again: FS_OPTIONS" in text for text in cockpit.texts)


def test_the_last_look_refuses_what_takes_its_lift() -> None:
    cockpit = hovering_cockpit(ArduCopter())
    station, now, to = cockpit.station, cockpit.now, (1, 1)
    refused = [
        m.ManualControl(1, 0, 0, 0, 0, 0),
        m.ManualControl(1, 0, 0, 199, 0, 0),
        m.ManualControl(1, 0, 0, 32767, 0, 0),
        m.ManualControl(1, 32767, 0, 500, 0, 0),
        m.ManualControl(0, 0, 0, 0, 0, 0),
        m.RcChannelsOverride(*to, 1500, 1500, 1000, 1500, 0, 0, 0, 0),
        m.SetAttitudeTarget(0, *to, 0, [1.0, 0.0, 0.0, 0.0], 0.0, 0.0, 0.0, 0.0),
        m.SetPositionTargetLocalNed(0, *to, 1, 0x0DC7, 0.0, 0.0, 0.0, 1.0, *[0.0] * 7),
        m.CommandInt(*to, 6, Command.DO_REPOSITION, 0, 0, -1, 1, 0, 0, 1, 1, 0),
        m.CommandLong(*to, Command.MISSION_START, 0, 0, 0, 0, 0, 0, 0, 0),
        m.CommandLong(*to, Command.DO_MOTOR_TEST, 0, 1, 0, 10, 1, 1, 0, 0),
        m.MissionItemInt(*to, 0, 3, 16, 2, 1, 0, 0, 0, 0, 1, 1, 0),
        m.SetMode(1, 1, 0),
        m.CommandLong(*to, Command.DO_SET_MODE, 0, 1, 0, 0, 0, 0, 0, 0),
    ]
    passed = [
        m.ManualControl(1, 0, 0, 500, 0, 0),
        m.ManualControl(1, 600, 0, 320, 0, 0),
        m.RcChannelsOverride(*to, *[0] * 8),
        m.SetPositionTargetLocalNed(0, *to, 1, 0x0DC7, *[0.0] * 11),
        m.CommandLong(*to, Command.NAV_RETURN_TO_LAUNCH, 0, 0, 0, 0, 0, 0, 0, 0),
        m.CommandLong(*to, Command.DO_SET_MODE, 0, 1, 9, 0, 0, 0, 0, 0),
        m.CommandLong(*to, Command.COMPONENT_ARM_DISARM, 0, 0, 0, 0, 0, 0, 0, 0),
    ]
    assert [station.may_send(message, now) for message in refused] == [False] * len(refused)
    assert [station.may_send(message, now) for message in passed] == [True] * len(passed)
