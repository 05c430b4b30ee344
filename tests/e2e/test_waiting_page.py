"""The commands on the page without a vehicle, run exactly as printed: the vehicle is found."""

from __future__ import annotations

import os
import re
import shlex
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from link.transport.local_addresses import LocalAddresses
from tests.e2e.programs import GroundStation
from tests.ports import free_port
from tests.waits import PATIENCE

pytestmark = pytest.mark.e2e

ROOT = Path(__file__).resolve().parents[2]
ENVIRONMENT = os.environ | {"PYTHONPATH": str(ROOT)}

Start = Callable[..., GroundStation]


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Start]:
    """Return a function that starts a ground station; it ends with the test."""
    with ExitStack() as stack:

        def build(*arguments: str) -> GroundStation:
            station = GroundStation(tmp_path, *arguments)
            stack.callback(station.end)
            return station

        yield build


@pytest.fixture
def run(tmp_path: Path) -> Iterator[Callable[[str], None]]:
    """Return a function that runs a printed command in a folder with the rover.toml of `mavhelm vehicle init`."""
    subprocess.run([sys.executable, "-m", "vehicle", "init"], cwd=tmp_path, env=ENVIRONMENT, check=True)
    with ExitStack() as stack:

        def begin(command: str) -> None:
            process = subprocess.Popen(
                [sys.executable, "-m", "link.program", *shlex.split(command.removeprefix("mavhelm "))],
                cwd=tmp_path, env=ENVIRONMENT, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )  # fmt: skip
            stack.callback(process.wait, PATIENCE)
            stack.callback(process.kill)

        yield begin


def printed(station: GroundStation, start: str) -> list[str]:
    """Wait until the page shows commands that start so, and return them."""
    pattern = re.compile(rf"\b{start}[^\x1b│]*\d".encode())
    station.wait_for(lambda: pattern.search(station.screen) is not None, PATIENCE, f"a command {start}")
    station.look(0.5)  # the rest of the page
    return list(dict.fromkeys(found.decode() for found in pattern.findall(station.screen)))


def assert_found(station: GroundStation) -> None:
    station.wait_for(lambda: b"disarmed: hold" in station.screen, PATIENCE, "the vehicle is found")


@pytest.mark.parametrize("scheme", ["udpin", "tcpout"])
def test_the_command_for_this_machine(scheme: str, start: Start, run: Callable[[str], None]) -> None:
    """The commands for each scheme: tests/groundstation/ui/drive/test_waiting_advice.py."""
    station = start(f"{scheme}:127.0.0.1:{free_port()}")
    (command,) = printed(station, "mavhelm vehicle --")
    run(command)
    assert_found(station)


@pytest.mark.skipif(not LocalAddresses().find(0.0), reason="this machine has no network address")
def test_the_commands_for_other_machines(start: Start, run: Callable[[str], None]) -> None:
    """First the command that makes the station listen on all addresses, then each of the vehicle's."""
    first = start(f"udpin:127.0.0.1:{free_port()}")
    (listen,) = printed(first, "mavhelm udp")
    first.type("\x11")
    assert first.ended() == 0
    station = start(*shlex.split(listen)[1:])
    *real, simulated = printed(station, "mavhelm vehicle --")
    assert "--config rover.toml" in real[0]
    assert "--sim" in simulated
    run(real[0])
    assert_found(station)


def test_bytes_that_are_not_mavlink_are_counted(start: Start) -> None:
    port = free_port()
    station = start(f"udpin:127.0.0.1:{port}")
    printed(station, "mavhelm vehicle --")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.sendto(b"Init ArduRover V4.7.0-dev" * 4, ("127.0.0.1", port))
        station.wait_for(lambda: b"100 bytes received, no MAVLink frame" in station.screen, PATIENCE, "bytes")


def test_nobody_at_the_other_end_is_named(start: Start) -> None:
    station = start(f"udpout:127.0.0.1:{free_port()}")
    station.wait_for(lambda: b"nothing listens there" in station.screen, PATIENCE, "refused messages")


def test_a_silent_serial_port_and_one_with_the_wrong_baud_rate(start: Start) -> None:
    radio, port = os.openpty()
    station = start(f"serial:{os.ttyname(port)}:57600")
    for words in (b"57600: 0 bytes received", b"TX goes to RX", b"both ends use 57600 baud"):
        station.wait_for(lambda words=words: words in station.screen, PATIENCE, words.decode())  # type: ignore[misc]
    os.write(radio, bytes(range(1, 200)) * 4)
    station.wait_for(lambda: b"wrong baud rate?" in station.screen, PATIENCE, "the baud rate")
    os.close(radio)
    os.close(port)
