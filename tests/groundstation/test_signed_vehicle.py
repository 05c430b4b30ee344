"""A vehicle that signs its frames (pymavlink, over UDP) and a real station process: the driver is told."""

from __future__ import annotations

import pytest

from dialects.enums import Autopilot
from groundstation.snapshot import Snapshot
from groundstation.vehicles.probes.signing_watch import SIGNING
from tests.fakes.lines import on_line
from tests.fakes.vehicle import FakeVehicle
from tests.fakes.wires import PymavlinkWire
from tests.groundstation.screen import Screen

pytestmark = pytest.mark.e2e


def warned(snapshot: Snapshot) -> bool:
    return snapshot.vehicle is not None and SIGNING in snapshot.vehicle.warnings


def test_signed_frames_are_named_first_and_only_while_signed() -> None:
    vehicle, wire = FakeVehicle(autopilot=Autopilot.ARDUPILOT), PymavlinkWire(key=bytes(range(32)), timestamp=10**12)
    vehicle.deaf, vehicle.beat_period = True, 0.1  # it answers nothing, as if we had the wrong key
    with Screen() as screen, on_line(vehicle, endpoint=screen.endpoint, wire=wire):
        seen = screen.see(warned)
        assert seen.vehicle is not None
        assert seen.vehicle.warnings[0] == SIGNING
        assert [line.severity for line in seen.texts if SIGNING in line.text] == [4], "logged once"
        wire.signs = False
        screen.see(lambda snapshot: snapshot.vehicle is not None and not warned(snapshot))
