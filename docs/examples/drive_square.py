"""Drive a square in GUIDED with pymavlink: `mavhelm vehicle --sim` in one terminal, this in another."""

from __future__ import annotations

import argparse
from typing import Any

from pymavlink import mavutil
from pymavlink.dialects.v20 import common as mavlink

GUIDED = 15
ONLY_POSITION = 0xDF8
"""POSITION_TARGET_TYPEMASK: everything but x, y and z is ignored."""
NEAR = 0.5
"""m from a corner at which the next one is sent."""


def main() -> None:
    """Arm, drive the corners in turn, and disarm."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("endpoint", nargs="?", default="udpin:127.0.0.1:14550")
    parser.add_argument("--side", type=float, default=3.0, help="length of a side, m")
    options = parser.parse_args()
    connect: Any = mavutil.mavlink_connection
    vehicle = connect(options.endpoint, source_system=255, source_component=190, autoreconnect=True)
    vehicle.wait_heartbeat()
    vehicle.mav.heartbeat_send(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 0)
    vehicle.set_mode(GUIDED)
    vehicle.arducopter_arm()
    vehicle.motors_armed_wait()
    side = options.side
    for north, east in ((side, 0.0), (side, side), (0.0, side), (0.0, 0.0)):
        drive_to(vehicle, north, east)
        print(f"corner {north:g} m north, {east:g} m east")
    vehicle.arducopter_disarm()


def drive_to(vehicle: Any, north: float, east: float) -> None:
    """Send the target until the vehicle is near it; m from the origin."""
    while True:
        vehicle.mav.heartbeat_send(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 0)
        vehicle.mav.set_position_target_local_ned_send(
            0, 1, 1, mavlink.MAV_FRAME_LOCAL_NED, ONLY_POSITION, north, east, 0, 0, 0, 0, 0, 0, 0, 0, 0
        )
        place = vehicle.recv_match(type="LOCAL_POSITION_NED", blocking=True, timeout=1.0)
        if place and abs(place.x - north) < NEAR and abs(place.y - east) < NEAR:
            return


if __name__ == "__main__":
    main()
