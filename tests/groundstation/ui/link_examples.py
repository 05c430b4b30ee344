"""Views of the Links screen to draw."""

from __future__ import annotations

from typing import Any

import msgspec

from groundstation.snapshot import Snapshot
from groundstation.snapshot.signing import SigningState, SigningView
from groundstation.views.base import View
from groundstation.views.links import (
    ComponentRow,
    ControlView,
    LinkRow,
    LinksView,
    Program,
    StationRow,
    VehicleRow,
    VehiclesView,
)
from groundstation.views.messages import MessageRow, MessagesPage
from tests.groundstation.ui.examples import snapshot

OURS = Program(255, 190, 0x1A2B3C4D)


def vehicle_row(system: int = 1, **changes: Any) -> VehicleRow:
    """A rover of ours that stands, 14.9 m north of home."""
    row = VehicleRow(
        signing="off", system=system, name=f"Rover {system}", firmware="0.1.0", mode="MANUAL", armed=False, silence=0.1,
        state="standby", battery_voltage=12.1, battery_remaining=0.76, distance=14.9, bearing=357.0, has_position=True,
        driver=0,
    )  # fmt: skip
    return msgspec.structs.replace(row, **changes)


SIX = VehiclesView(
    (
        vehicle_row(signing="on", armed=True, state="active", in_control=True, driver=255,
                    components=(ComponentRow(100, "camera"), ComponentRow(154, "gimbal"))),
        vehicle_row(2, name="ArduPilot rover 2", firmware="4.6.1", mode="AUTO", armed=True, state="critical",
                    distance=61.2, bearing=74.0, driver=None, silence=0.3, battery_voltage=11.6,
                    battery_remaining=0.41),
        vehicle_row(3, mode="HOLD", distance=38.0, bearing=212.0, driver=250),
        vehicle_row(4, name="PX4 boat 4", firmware="1.15.4", mode="OFFBOARD", armed=True, state="active",
                    distance=212.0, bearing=301.0, silence=1.2, battery_voltage=14.9, battery_remaining=0.23,
                    driver=None),
        vehicle_row(7, name="Vehicle 7", firmware="", distance=None, bearing=None, has_position=False,
                    battery_voltage=None, battery_remaining=None, silence=0.4, driver=None),
        vehicle_row(9, mode="HOLD", armed=True, alive=False, silence=134.2, distance=33.0, bearing=120.0),
    )
)  # fmt: skip
"""Six vehicles of three makers, one of them lost."""

LINKS = LinksView(
    (
        LinkRow(name="udpin:0.0.0.0:14550", peers=("192.168.4.20:50211", "192.168.4.21:50212"), peer_count=2,
                frames_in=98.0, frames_out=22.0, bytes_in=3400.0, bytes_out=800.0, loss=0.003, lost=142,
                round_trip=0.012, jitter=0.0019, age=0.1, counts=True),
        LinkRow(name="serial:/dev/ttyUSB0:57600", index=1, peer_count=1, frames_in=64.0, frames_out=20.0,
                bytes_in=3900.0, bytes_out=640.0, loss=0.021, lost=611, crc_errors=9, dropped=31, age=0.6,
                round_trip=0.31, capacity=5760.0, headroom=0.8),
        LinkRow(name="udpin:127.0.0.1:14551", index=2),
        LinkRow(name="serial:/dev/ttyACM0:115200", index=3, capacity=11520.0,
                problem="/dev/ttyACM0 has gone; it is opened again when it is plugged in"),
    )
)  # fmt: skip
"""A good link, a radio, one on which nobody is heard, one that is down."""

SIGNED = SigningView(SigningState.ON, "on: both ends sign; our key is laptop (1a2b3c4d)")
CONTROL = ControlView(
    vehicle="Rover 1", ours=OURS, in_control=True, driver=255, program=OURS, age=0.4,
    stations=(StationRow(250, 190, 0.6), StationRow(245, 191, 0.2)), signing=SIGNED,
)  # fmt: skip
BYTES = MessagesPage(
    tuple(
        MessageRow(255 if sent else 1, 1, sent, name, rate, size, 500, 0.1)
        for name, rate, size, sent in (
            ("MANUAL_CONTROL", 20.0, 800.0, True), ("SERVO_OUTPUT_RAW", 20.0, 660.0, False),
            ("ATTITUDE", 10.0, 360.0, False), ("VFR_HUD", 10.0, 320.0, False), ("HEARTBEAT", 1.0, 21.0, False),
            ("COMMAND_ACK", 0.0, 0.0, False),
        )
    ),
    0, 6, 6, 61.0, 2161.0, order="bytes",
)  # fmt: skip

VIEWS: tuple[View, ...] = (SIX, LINKS, CONTROL, BYTES)

FLEET = snapshot(signing=SIGNED, vehicles=(1, 2, 3, 4, 7, 9), also_armed=(2, 4, 9))


def many(count: int, not_shown: int = 0) -> VehiclesView:
    """So many rovers."""
    return VehiclesView(tuple(vehicle_row(system) for system in range(1, count + 1)), not_shown)


def fleet(count: int) -> Snapshot:
    """The snapshot that goes with it."""
    return snapshot(vehicles=tuple(range(1, count + 1)), not_shown=max(0, count - 16))
