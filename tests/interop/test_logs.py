"""Logs of our vehicle, listed and downloaded by MAVProxy and MAVSDK, byte for byte."""

from __future__ import annotations

import importlib.util
import os
import random
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.interop.conftest import Rover
from tests.interop.conversation import Conversation
from tests.interop.mavproxy import MAVPROXY
from tests.interop.mavsdk_process import Client

pytestmark = pytest.mark.interop

LOGS = {
    "00000011.tlog": random.Random(1).randbytes(90 * 40),
    "00000012_2026-11-21T14-05-09Z.tlog": random.Random(2).randbytes(60_123),
}
"""One from before the clock was known, of whole messages; and one that ends within a message."""


@pytest.fixture
def options(tmp_path: Path) -> tuple[str, ...]:
    """The vehicle has these logs."""
    folder = tmp_path / "vehicle"
    folder.mkdir()
    for name, content in LOGS.items():
        (folder / name).write_bytes(content)
    return "--tlog", str(folder)


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    """Ends what a test starts."""
    with ExitStack() as stack:
        yield stack


@pytest.mark.skipif(
    not (MAVPROXY / "mavproxy.py").exists() and "MAVHELM_CI" not in os.environ, reason="MAVProxy is not installed"
)
def test_mavproxy(rover: Rover, tmp_path: Path, stack: ExitStack) -> None:
    command = [str(MAVPROXY / "python"), str(MAVPROXY / "mavproxy.py"), "--default-modules=log,arm"]
    mavproxy = Conversation([*command, f"--master=udpin:127.0.0.1:{rover.port}"], tmp_path)
    stack.callback(mavproxy.end)
    mavproxy.hear("Detected vehicle 1:1", 15)
    mavproxy.say("log list")
    mavproxy.hear(r"Log 0 +numLogs 2 lastLog 1 size 3600\s")
    mavproxy.hear(r"Log 1 +numLogs 2 lastLog 1 size 60123 \w+ Nov 21")
    for number, content in enumerate(LOGS.values()):
        mavproxy.say(f"log download {number} fetched-{number}")
        mavproxy.hear(rf"Finished downloading fetched-{number} \({len(content)} bytes", 10)
        assert (tmp_path / f"fetched-{number}").read_bytes() == content
    mavproxy.ask("arm throttle", "ARMED")  # it is refused until its HEARTBEAT was heard
    mavproxy.say("log erase")
    mavproxy.hear("logs not erased: disarm first")
    mavproxy.say("disarm")
    mavproxy.hear("DISARMED")
    mavproxy.say("log erase")
    mavproxy.hear("Logs erased")
    mavproxy.ask("log list", r"Log 0 +numLogs 1 lastLog 0 size \d+")
    assert [path.name[:8] for path in (tmp_path / "vehicle").iterdir()] == ["00000013"]  # still being written


@pytest.mark.skipif(
    importlib.util.find_spec("mavsdk") is None and "MAVHELM_CI" not in os.environ, reason="MAVSDK is not installed"
)
def test_mavsdk(rover: Rover, tmp_path: Path, stack: ExitStack) -> None:
    sdk = Client(rover.port, "recordings", tmp_path)
    stack.callback(sdk.end)
    assert sdk.good("logs").value == [[0, "1970-01-01T00:00:00Z", 3600], [1, "2026-11-21T14:05:09Z", 60123]]
    for number, content in enumerate(LOGS.values()):
        assert "SUCCESS" in str(sdk.good(f"log {number}").value)
        assert (tmp_path / f"fetched-{number}").read_bytes() == content
