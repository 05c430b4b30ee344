"""Send the values of a sensor as NAMED_VALUE_FLOAT beside the vehicle: `python own_sensor.py udpout:127.0.0.1:14600`.

The vehicle listens there, as one of its endpoints, and forwards the values to all ground stations.
"""

from __future__ import annotations

import contextlib
import sys
import time

from pymavlink import mavutil

NAME = b"water"
"""At most 10 characters: how ground stations show the value."""
PERIOD = 0.5
"""s between two values."""
COMPONENT = 191
"""MAV_COMP_ID_ONBOARD_COMPUTER: any id that no other component of the vehicle has."""


def read_sensor() -> float:
    """Return the value of the sensor. This is the part to replace: here, the load of the computer."""
    with open("/proc/loadavg") as file:
        return float(file.read().split()[0])


def main() -> None:
    """Send a value twice a second, until Ctrl-C."""
    link = mavutil.mavlink_connection(  # type: ignore[no-untyped-call]  # pymavlink has no types
        sys.argv[1], source_system=1, source_component=COMPONENT
    )
    print(f"{NAME.decode()} to {sys.argv[1]} each {PERIOD} s; Ctrl-C ends it", flush=True)
    while True:
        uptime = int(time.monotonic() * 1000) % 2**32
        link.mav.named_value_float_send(uptime, NAME, read_sensor())
        time.sleep(PERIOD)


if __name__ == "__main__":
    with contextlib.suppress(KeyboardInterrupt):
        main()
