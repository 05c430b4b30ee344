"""Two clients at once: the second sees everything, and its stick counts only after it was given control."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from dialects.enums import Command
from tests.interop import mavproxy, mavsdk_process
from tests.interop.conftest import Rover
from tests.interop.drivers import KINDS, MANUAL, RELEASE, REQUEST

pytestmark = pytest.mark.interop

NEEDED = {"MAVProxy": mavproxy.needed, "MAVSDK": mavsdk_process.needed}
PAIRS = [
    ("MAVProxy", "MAVProxy"),
    ("MAVSDK", "MAVSDK"),
    ("pymavlink", "pymavlink"),
    ("QGroundControl", "pymavlink"),
    ("MAVProxy", "MAVSDK"),
]


@pytest.mark.parametrize(
    ("first", "second"),
    [pytest.param(*pair, marks=[NEEDED[name] for name in set(pair) if name in NEEDED]) for pair in PAIRS],
)
def test_the_second_sees_all_and_drives_only_when_given_control(
    first: str, second: str, rover: Rover, tmp_path: Path
) -> None:
    folders = [tmp_path / "first", tmp_path / "second"]
    for folder in folders:
        folder.mkdir()
    with (
        KINDS[first](rover.port, 255, folders[0]) as one,
        KINDS[second](rover.second_port, 254, folders[1]) as other,
    ):
        one.arm()
        other.sees_armed(True)
        other.push(-0.6)
        other.reads("Demand from GCS 254 ignored: GCS 255 is in control")
        one.push(0.6)
        rover.drives()
        for sight in ("attitude", "position", "motion"):
            other.sees(sight)
        one.push(0.0)
        rover.stands()  # although the other still holds its stick
        assert all(min(output.throttles) >= 0 for output in rover.vehicle.outputs())

        one.command(Command.REQUEST_OPERATOR_CONTROL, RELEASE)
        other.command(Command.REQUEST_OPERATOR_CONTROL, REQUEST)
        one.reads("GCS 254 is in control")
        given = time.monotonic()
        one.push(0.6)
        other.command(*MANUAL)
        other.push(-0.6)
        rover.drives()
        other.push(0.0)
        rover.stands()  # although the first holds its stick now
        assert all(max(output.throttles) <= 0 for output in rover.vehicle.outputs() if output.at > given)
        other.disarm()
        one.sees_armed(False)
