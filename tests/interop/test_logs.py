"""Logs of our vehicle, listed and downloaded by MAVProxy and MAVSDK, byte for byte."""

from __future__ import annotations

import random
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.interop import mavproxy, mavsdk_process
from tests.interop.conftest import Rover

pytestmark = pytest.mark.interop

LOGS = {
    "00000011.tlog": random.Random(1).randbytes(90 * 40),
    "00000012_2026-11-21T14-05-09Z.tlog": random.Random(2).randbytes(60_123),
}
"""A log from before the clock was set, of complete messages, and one that ends within a message."""


@pytest.fixture
def options(tmp_path: Path) -> tuple[str, ...]:
    """Give the vehicle these logs."""
    folder = tmp_path / "vehicle"
    folder.mkdir()
    for name, content in LOGS.items():
        (folder / name).write_bytes(content)
    return "--tlog", str(folder)


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    """End what a test starts."""
    with ExitStack() as stack:
        yield stack


@mavproxy.needed
def test_mavproxy(rover: Rover, tmp_path: Path, stack: ExitStack) -> None:
    shell = stack.enter_context(mavproxy.started(rover.port, tmp_path))
    shell.hear("Detected vehicle 1:1")
    shell.say("log list")
    shell.hear(r"Log 0 +numLogs 2 lastLog 1 size 3600\s")
    shell.hear(r"Log 1 +numLogs 2 lastLog 1 size 60123 \w+ Nov 21")
    for number, content in enumerate(LOGS.values()):
        shell.say(f"log download {number} fetched-{number}")
        shell.hear(rf"Finished downloading fetched-{number} \({len(content)} bytes")
        assert (tmp_path / f"fetched-{number}").read_bytes() == content
    shell.ask("arm throttle", "ARMED")  # refused until the vehicle has received its HEARTBEAT
    shell.say("log erase")
    shell.hear("logs not erased: disarm first")
    shell.say("disarm")
    shell.hear("DISARMED")
    shell.say("log erase")
    shell.hear("Logs erased")
    shell.ask("log list", r"Log 0 +numLogs 1 lastLog 0 size \d+")
    assert [path.name[:8] for path in (tmp_path / "vehicle").iterdir()] == ["00000013"]  # still being written


@mavsdk_process.needed
def test_mavsdk(rover: Rover, tmp_path: Path, stack: ExitStack) -> None:
    sdk = stack.enter_context(mavsdk_process.started(rover.port, "recordings", tmp_path))
    assert sdk.good("logs").value == [[0, "1970-01-01T00:00:00Z", 3600], [1, "2026-11-21T14:05:09Z", 60123]]
    for number, content in enumerate(LOGS.values()):
        assert "SUCCESS" in str(sdk.good(f"log {number}").value)
        assert (tmp_path / f"fetched-{number}").read_bytes() == content
