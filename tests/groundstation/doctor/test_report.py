"""The report: what it says, and what it leaves out."""

from __future__ import annotations

import pytest

from groundstation.doctor.chain import examine
from groundstation.doctor.report import HIDDEN, format_report, hide_addresses
from groundstation.views.doctor import CheckText, DoctorView, SensorRow
from link.runtime.diagnosis import Health
from tests.groundstation.doctor.test_chain import facts, vehicle


@pytest.mark.parametrize(("text", "shown"), [
    ("udpin:0.0.0.0:14550", "udpin:0.0.0.0:14550"),
    ("udpout:192.168.4.20:14550", "udpout:192.168.4.20:14550"),
    ("udpout:8.8.8.8:14550: 3 % lost", f"udpout:{HIDDEN}:14550: 3 % lost"),
    ("tcp:rover.example.org:5760", f"tcp:{HIDDEN}:5760"),
    ("tcp:[2a00:1450::8]:5760", f"tcp:{HIDDEN}:5760"),
    ("tcp:[fe80::1%wlan0]:5760", "tcp:[fe80::1%wlan0]:5760"),
    ("heard from 8.8.4.4", f"heard from {HIDDEN}"),
    ("12:04:31 PreArm: battery low", "12:04:31 PreArm: battery low"),
    ("firmware 4.7.0, serial:/dev/ttyUSB0:57600", "firmware 4.7.0, serial:/dev/ttyUSB0:57600"),
])  # fmt: skip
def test_addresses(text: str, shown: str) -> None:
    assert hide_addresses(text) == shown


def test_the_report() -> None:
    rows = examine(facts(vehicle(prearm=False), endpoints=("tcp:rover.example.org:5760",)))
    view = DoctorView(
        name="Rover 1", rows=rows, sensors=(SensorRow("compass", Health.FAULT),),
        texts=(CheckText("Compass not calibrated\x1b[2J", "", 3.0),), facts=(("firmware", "4.7.0"),),
    )  # fmt: skip
    text = format_report(view, log=("ack: arm failed",))
    assert text.startswith("mavhelm doctor: Rover 1\nfirmware     4.7.0\n\n")
    assert "X  pre-arm      fail, and the vehicle has not said why\n                -> run the checks\n" in text
    assert "X  compass\n" in text
    assert "3 s ago: Compass not calibrated?[2J" in text
    assert text.endswith("ack: arm failed\n")
    assert "example" not in text
