"""From drive keys to the motion of a rover: each key and each chord, on our own vehicle and on ArduRover's rules.

PX4's rules are in tests/dialects/test_axes.py.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import permutations

import msgspec
import pytest

from dialects.axes import NEUTRAL, Axes, axis_map, build_manual_control
from dialects.enums import Autopilot, DriveType, VehicleType
from dialects.messages import ManualControl
from groundstation.actions import ACTIONS
from groundstation.input.keymap import KEYMAPS
from groundstation.input.sticks import Sticks
from groundstation.input.style import Style
from groundstation.intents.driving import DriveKeyDown
from tests.vehicle.field import Field

KEYS = {
    key: action.intent
    for key in ("u", "i", "o", "j", "l", "m", "comma", "full_stop")
    if (action := ACTIONS[KEYMAPS["standard"][key]]) and isinstance(action.intent, DriveKeyDown)
}
HELD = [*permutations(KEYS, 1), *permutations(KEYS, 2)]
WITH_A_STEERED_AXLE = (DriveType.ACKERMANN,)
"""A car that stands cannot turn."""


def axes_of(keys: tuple[str, ...]) -> Axes:
    """The demand while these keys are held, pressed in this order."""
    sticks = Sticks(Style.HOLD, 1.0)
    sticks.set_reports_releases()
    for key in keys:
        sticks.press(msgspec.structs.replace(KEYS[key], key=key), 0.0)
    return sticks.axes(0.0)


def sign(value: float, least: float = 0.05) -> int:
    return (value > least) - (value < -least)


def expected(keys: tuple[str, ...], *, car: bool) -> tuple[int, int]:
    """Forward and nose to the right, by the labels of the keys; the newest decides."""
    pushes = [KEYS[key] for key in keys]
    throttle = next((int(push.throttle) for push in reversed(pushes) if push.throttle), 0)
    steering = next((int(push.steering) for push in reversed(pushes) if push.steering), 0)
    return throttle, 0 if car and not throttle else steering


# ---- our own vehicle, with its mixers and its simulated chassis ----


def drive_ours(kind: DriveType, keys: tuple[str, ...], seconds: float = 0.6) -> tuple[float, float, Field]:
    """Return the speed and the turn of the nose after `seconds` with these keys, from rest."""
    field = Field(seed=None, DRIVE_TYPE=float(kind))
    field.arm()
    field.wait(0.3, NEUTRAL)
    before = field.yaw
    steer(field, kind, keys, seconds)
    return field.speed, turned(before, field.yaw), field


def steer(field: Field, kind: DriveType, keys: tuple[str, ...], seconds: float) -> None:
    message = build_manual_control(axes_of(keys), 1, axis_map(Autopilot.GENERIC, VehicleType.GROUND_ROVER, kind))
    for _ in range(round(seconds / 0.05)):
        field.say(message)
        field.wait(0.05)


def turned(before: float, after: float) -> float:
    return (after - before + math.pi) % math.tau - math.pi


@pytest.mark.parametrize("kind", [DriveType.SKID, DriveType.ACKERMANN, DriveType.OMNI, DriveType.MECANUM])
def test_every_key_and_chord_moves_our_rover_as_its_label_says(kind: DriveType) -> None:
    """Chords with the same demand, which is all that the rover gets of them, are driven once."""
    moved: dict[Axes, tuple[int, int]] = {}
    for keys in HELD:
        demand = axes_of(keys)
        if demand not in moved:
            speed, turn, _ = drive_ours(kind, keys)
            moved[demand] = sign(speed), sign(turn)
        assert moved[demand] == expected(keys, car=kind in WITH_A_STEERED_AXLE), keys
    assert len(moved) >= len(KEYS)


@pytest.mark.parametrize("kind", [DriveType.SKID, DriveType.ACKERMANN, DriveType.MECANUM])
@pytest.mark.parametrize(("out", "back"), [("u", "m"), ("o", "full_stop"), ("i", "comma")])
def test_our_rover_comes_back_on_the_same_arc(kind: DriveType, out: str, back: str) -> None:
    _, turn, field = drive_ours(kind, (out,), 0.8)
    begun = field.yaw - turn
    field.wait(1.5, NEUTRAL)
    far = field.truth
    steer(field, kind, (back,), 0.8)
    field.wait(1.5, NEUTRAL)
    start = math.hypot(*far)
    assert start > 0.3
    assert math.hypot(*field.truth) < 0.4 * start, "near where it began"
    assert turned(begun, field.yaw) == pytest.approx(0.0, abs=0.5)


# ---- ArduRover: Mode::get_pilot_desired_steering_and_throttle, then AP_MotorsUGV ----


def ardurover(message: ManualControl) -> tuple[float, float]:
    """Frame "rover": y is the angle of the wheels in either direction, so the nose leaves them in reverse."""
    throttle, steering = message.z / 1000, message.y / 1000
    return throttle, throttle * steering


def ardurover_skid(message: ManualControl) -> tuple[float, float]:
    """Frame "rover-skid": in reverse the pilot's steering is negated before it turns the nose."""
    throttle, steering = message.z / 1000, message.y / 1000
    return throttle, -steering if throttle < 0 else steering


@pytest.mark.parametrize(("rover", "car"), [(ardurover, True), (ardurover_skid, False)])
def test_every_key_and_chord_moves_ardurover_as_its_label_says(
    rover: Callable[[ManualControl], tuple[float, float]], car: bool
) -> None:
    for keys in HELD:
        message = build_manual_control(axes_of(keys), 1, axis_map(Autopilot.ARDUPILOT, VehicleType.GROUND_ROVER))
        forward, turn = rover(message)
        assert (sign(forward), sign(turn)) == expected(keys, car=car), keys


@pytest.mark.parametrize("rover", [ardurover, ardurover_skid])
@pytest.mark.parametrize(("out", "back"), [("u", "m"), ("o", "full_stop"), ("i", "comma")])
def test_ardurover_comes_back_on_the_same_arc(
    rover: Callable[[ManualControl], tuple[float, float]], out: str, back: str
) -> None:
    there, here = (
        rover(build_manual_control(axes_of((key,)), 1, axis_map(Autopilot.ARDUPILOT, VehicleType.GROUND_ROVER)))
        for key in (out, back)
    )
    assert there[0] == -here[0] == 1.0
    assert there[1] / there[0] == here[1] / here[0], "the curvature"
