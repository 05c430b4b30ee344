"""From MAVLink's frames to those of ROS: NED to ENU, forward-right-down to forward-left-up.

https://www.ros.org/reps/rep-0103.html
"""

from __future__ import annotations

import math

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
"""x, y, z, w."""


def ned_to_enu(vector: Vector) -> Vector:
    """Return north, east, down as east, north, up."""
    north, east, down = vector
    return east, north, -down


def frd_to_flu(vector: Vector) -> Vector:
    """Return forward, right, down as forward, left, up."""
    forward, right, down = vector
    return forward, -right, -down


def attitude_to_enu(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Return the rotation from forward-left-up to ENU; the angles are those of ATTITUDE: NED, yaw clockwise, rad."""
    return _from_euler(roll, -pitch, math.pi / 2 - yaw)


def into_body(rotation: Quaternion, vector: Vector) -> Vector:
    """Return a vector of the outer frame in that of the body."""
    x, y, z, w = rotation
    a, b, c = vector
    # Rotation by the conjugate: v + 2 q x (q x v + w v) with q = (-x, -y, -z).
    s, t, u = -y * c + z * b + w * a, -z * a + x * c + w * b, -x * b + y * a + w * c
    return a + 2 * (-y * u + z * t), b + 2 * (-z * s + x * u), c + 2 * (-x * t + y * s)


def _from_euler(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Return the quaternion of rotations about z, then y, then x."""
    cr, sr = math.cos(roll / 2), math.sin(roll / 2)
    cp, sp = math.cos(pitch / 2), math.sin(pitch / 2)
    cy, sy = math.cos(yaw / 2), math.sin(yaw / 2)
    return (
        sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )  # fmt: skip
