"""Axis conventions of MANUAL_CONTROL by autopilot and MAV_TYPE: converts Axes in -1..1 to and from the message.

Our rover reads x and r as the specification says, ArduPilot Rover reads z and y (z = 0 is neutral), PX4 rovers read z
with 500 as neutral, and y or r. What flies reads four axes, and its neutral is z = 500. Every neutral of the project
comes from `build_neutral`. To add a convention, add a row to AXIS_MAPS; if the frame decides, to PX4_FRAMES or
ROVER_FRAMES.
Definition: https://mavlink.io/en/messages/common.html#MANUAL_CONTROL.
"""

from __future__ import annotations

import math

import msgspec
from msgspec.structs import replace

from dialects.enums import Autopilot, DriveType, VehicleType
from dialects.messages import INVALID_AXIS, ManualControl, RoverOperatorPresence

FULL_DEFLECTION = 1000
"""Full deflection of an axis (common.xml, MANUAL_CONTROL)."""


class Axes(msgspec.Struct, frozen=True):
    """A demand: throttle forward positive, steering clockwise (right) positive, each -1..1.

    What flies has two more: to the right, and up. There throttle is forward, and steering turns the nose.
    """

    throttle: float = 0.0
    steering: float = 0.0
    side: float = 0.0
    climb: float = 0.0

    @property
    def neutral(self) -> bool:
        """True if all axes are 0."""
        return self.throttle == self.steering == self.side == self.climb == 0.0


NEUTRAL = Axes()


class AxisMap(msgspec.Struct, frozen=True):
    """Which axis carries what; neutrals and spans are in axis units."""

    throttle: str
    steering: str
    throttle_neutral: int = 0
    throttle_span: int = FULL_DEFLECTION
    reverse_flips_steering: bool = False
    """In reverse, steering to the right turns the nose left, as with a steering wheel.

    ArduRover does so with every frame, skid steering too (Rover/mode.cpp, get_pilot_desired_steering_and_throttle).
    `Axes.steering` always means the nose, so that the sign changes with the throttle."""
    unused: int = INVALID_AXIS
    """Sent on the axes that the vehicle does not use."""
    side: str = ""
    """"": the vehicle does not move sideways."""
    climb: str = ""
    """"": the vehicle does not climb."""
    climb_neutral: int = 0
    climb_span: int = FULL_DEFLECTION
    climb_dead: int = 0
    """Distance from neutral within which the vehicle does not climb: the least demand begins beyond it."""


_PX4 = AxisMap(throttle="z", steering="y", throttle_neutral=500, throttle_span=500, unused=0)
"""x is pitch, y roll, z throttle from 0 to 1000, r yaw (mavlink/mavlink_receiver.cpp). A rover ignores pitch; the
others are sent as 0, because versions without a check of the range take INT16_MAX for a deflection of 32.767."""

HOVER = 500
"""z in the middle of its range: zero climb in every mode that holds altitude, of ArduCopter and of PX4.

z = 0 is full descent there. In STABILIZE it is no thrust, and the vehicle falls."""

CLIMB_SPAN = 300
"""Largest distance of z from HOVER: half of the speeds that ArduCopter has at full deflection, so that no key asks for
the end of the range."""

ARDUPILOT_DEAD, PX4_DEAD = 100, 50
"""Distance of z from HOVER within which it does not climb: THR_DZ of ArduCopter, MPC_HOLD_DZ of PX4 (0.1)."""

LOWEST_THROTTLE = HOVER - CLIMB_SPAN
"""The least z that any path may send to what flies."""

COPTER_AXES = AxisMap(
    throttle="x", steering="r", side="y", climb="z", climb_neutral=HOVER, climb_span=CLIMB_SPAN,
    climb_dead=ARDUPILOT_DEAD,
)  # fmt: skip
"""x is pitch (forward positive), y roll, z throttle from 0 to 1000, r yaw.

ArduCopter ignores a message with z < 0 (GCS_MAVLINK_Copter.cpp, handle_manual_control_axes); PX4 leaves out axes beyond
their range (mavlink_receiver.cpp). INT16_MAX releases ArduPilot's override, so that all four are sent."""

PX4_COPTER_AXES = replace(COPTER_AXES, climb_dead=PX4_DEAD)

GROUND_TYPES = frozenset((VehicleType.GROUND_ROVER, VehicleType.SURFACE_BOAT))
"""MAV_TYPEs whose neutral is that of their autopilot; every other one has that of what flies."""

AXIS_MAPS: dict[int, AxisMap] = {
    Autopilot.GENERIC: AxisMap(throttle="x", steering="r"),
    Autopilot.ARDUPILOT: AxisMap(throttle="z", steering="y", reverse_flips_steering=True),
    Autopilot.PX4: _PX4,
}
"""MAV_AUTOPILOT of the HEARTBEAT of a rover or a boat -> its axes."""

PX4_FRAMES: dict[int, AxisMap] = {
    5: replace(_PX4, reverse_flips_steering=True),
    6: _PX4,
    13: replace(_PX4, steering="r"),
}
"""PX4's parameter CA_AIRFRAME -> axes of the frame, in every manual mode (the modules below src/modules).

5, rover_ackermann: roll is the steering angle, or the yaw rate times the sign of the throttle. 6, rover_differential:
roll turns the nose, in reverse too. 13, rover_mecanum: yaw turns the nose; roll moves it sideways."""


ROVER_FRAMES: dict[int, AxisMap] = {
    DriveType.ACKERMANN: replace(AXIS_MAPS[Autopilot.GENERIC], reverse_flips_steering=True),
}
"""`drive_type` of our vehicle's ROVER_DRIVE_INFO -> axes in MANUAL. There r is the angle of the steered wheels, which
turn the nose to the other side in reverse; drives that turn by their wheels take r for the nose."""

FRAMES: dict[int, dict[int, AxisMap]] = {Autopilot.PX4: PX4_FRAMES, Autopilot.GENERIC: ROVER_FRAMES}
"""MAV_AUTOPILOT -> the axes of frames that differ from AXIS_MAPS."""


def axis_map(autopilot: int, kind: int, frame: int | None = None) -> AxisMap:
    """Return the axes of a vehicle; for an unknown autopilot of a rover those of the specification.

    `kind`: its MAV_TYPE. `frame`: PX4's CA_AIRFRAME, or the drive type of our own vehicle. While that is not known, the
    axes are those of a rover that turns by its wheels.
    """
    if kind not in GROUND_TYPES:
        return PX4_COPTER_AXES if autopilot == Autopilot.PX4 else COPTER_AXES
    default = AXIS_MAPS.get(autopilot, AXIS_MAPS[Autopilot.GENERIC])
    return default if frame is None else FRAMES.get(autopilot, {}).get(frame, default)


def build_neutral(target: int, autopilot: int, kind: int) -> ManualControl:
    """Return the message that ends every demand to this vehicle. `kind`: its MAV_TYPE."""
    return build_manual_control(NEUTRAL, target, axis_map(autopilot, kind))


def build_manual_control(axes: Axes, target: int, axis_map: AxisMap = AXIS_MAPS[Autopilot.GENERIC]) -> ManualControl:
    """Return the message for a demand.

    Values are clamped here because ArduPilot does not clamp them (z = 32766 is full ahead there). INT16_MAX on an axis
    that is not used means "invalid".
    """
    unused = axis_map.unused
    message = ManualControl(target, unused, unused, unused, unused, 0)
    throttle, steering = axes.throttle, axes.steering
    throttle = round((throttle if -1.0 <= throttle <= 1.0 else _clamp(throttle)) * axis_map.throttle_span)
    steering = round((steering if -1.0 <= steering <= 1.0 else _clamp(steering)) * FULL_DEFLECTION)
    setattr(message, axis_map.throttle, axis_map.throttle_neutral + throttle)
    setattr(message, axis_map.steering, -steering if axis_map.reverse_flips_steering and throttle < 0 else steering)
    if axis_map.side:
        setattr(message, axis_map.side, round(_clamp(axes.side) * FULL_DEFLECTION))
    if axis_map.climb:
        setattr(message, axis_map.climb, axis_map.climb_neutral + _climb_offset(_clamp(axes.climb), axis_map))
    return message


def _climb_offset(climb: float, axis_map: AxisMap) -> int:
    """Return the distance from neutral: 0 for no demand, else beyond the dead zone."""
    if climb == 0.0:
        return 0
    return round(math.copysign(axis_map.climb_dead, climb) + climb * (axis_map.climb_span - axis_map.climb_dead))


def _clamp(value: float) -> float:
    return 0.0 if math.isnan(value) else max(-1.0, min(1.0, value))


def parse_manual_control(
    message: ManualControl | RoverOperatorPresence, axis_map: AxisMap = AXIS_MAPS[Autopilot.GENERIC]
) -> tuple[float | None, float | None]:
    """Return throttle and steering of a message in -1..1; None for an axis that is not valid.

    Values out of range are rejected, not clamped: a wild value must not become full speed.
    """
    raw_throttle = getattr(message, axis_map.throttle)
    raw_steering = getattr(message, axis_map.steering)
    throttle = (raw_throttle - axis_map.throttle_neutral) / axis_map.throttle_span
    steering = raw_steering / FULL_DEFLECTION
    if axis_map.reverse_flips_steering and throttle < 0:
        steering = -steering
    return (throttle if abs(throttle) <= 1.0 else None, steering if abs(steering) <= 1.0 else None)


def parse_axes(message: ManualControl | RoverOperatorPresence, axis_map: AxisMap) -> Axes | None:
    """Return the whole demand of a message, for people to see; None where throttle or steering is not valid."""
    throttle, steering = parse_manual_control(message, axis_map)
    if throttle is None or steering is None:
        return None
    side = _valid(getattr(message, axis_map.side)) / FULL_DEFLECTION if axis_map.side else 0.0
    offset = _valid(getattr(message, axis_map.climb) - axis_map.climb_neutral) if axis_map.climb else 0
    beyond = max(0.0, abs(offset) - axis_map.climb_dead) / (axis_map.climb_span - axis_map.climb_dead)
    return Axes(throttle, steering, side, math.copysign(min(1.0, beyond), offset) if beyond else 0.0)


def _valid(value: int) -> int:
    """Return the value of an axis; 0 for INT16_MAX, which means that there is none, and for all others out of range."""
    return value if abs(value) <= FULL_DEFLECTION else 0
