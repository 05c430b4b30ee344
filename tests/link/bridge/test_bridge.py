"""The bridge as a process: a pty for the autopilot's serial port, real sockets, signals, what it prints and records."""

from __future__ import annotations

import contextlib
import fcntl
import json
import os
import pty
import select
import signal
import socket
import struct
import subprocess
import sys
import termios
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from dialects.messages import Attitude
from link.bridge.bridge import DATAGRAM, join_frames
from link.endpoint import MAX_BAUD, MIN_BAUD, SCHEMES
from link.routing.router import REDUNDANCY_WINDOW
from link.routing.routes import PEER_SILENCE, ROUTE_SILENCE
from link.tlog.tlog import read_records
from link.transport.priority_queue import MAX_DRIVER_BACKLOG, STALE
from link.transport.tcp import MAX_CONNECTIONS
from tests.link.frames import demand, frame, heartbeat
from tests.link.ports import Cable
from tests.link.routing.test_router import command, unknown
from tests.ports import free_port

VEHICLE = heartbeat(0, 1, 1)
BULK = [frame(Attitude(number, 0.5, 0, 0, 0, 0, 1), number % 256, 1, 1) for number in range(100)]


class Program:
    """`python -m link.bridge`, its output kept, ended with the test."""

    def __init__(self, *words: str, stdout: int = subprocess.PIPE) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "link.bridge", *words], stdout=stdout, stderr=subprocess.PIPE
        )
        self.said = b""

    def wait_for(self, text: str, within: float = 60.0) -> None:
        """Until it has logged `text`."""
        assert self.process.stderr
        deadline = time.monotonic() + within
        while text.encode() not in self.said:
            assert time.monotonic() < deadline, f"it did not say {text!r}: {self.said!r}"
            if select.select([self.process.stderr], [], [], 0.1)[0]:
                self.said += os.read(self.process.stderr.fileno(), 4096)

    def line(self) -> dict[str, Any]:
        """The next line of --json."""
        assert self.process.stdout
        found: dict[str, Any] = json.loads(self.process.stdout.readline())
        return found

    def end(self, number: int = signal.SIGTERM) -> int:
        self.process.send_signal(number)
        return self.process.wait(60)

    def close(self) -> None:
        self.process.kill()
        self.process.wait(60)
        for stream in (self.process.stdout, self.process.stderr):
            if stream:
                stream.close()


@pytest.fixture
def bridge() -> Iterator[Callable[..., Program]]:
    with contextlib.ExitStack() as stack:

        def start(*words: str, stdout: int = subprocess.PIPE) -> Program:
            program = Program(*words, stdout=stdout)
            stack.callback(program.close)
            return program

        yield start


@pytest.fixture
def cable(tmp_path: Path) -> Iterator[Cable]:
    cable = Cable(tmp_path / "ttyAMA0")
    yield cable
    cable.unplug()


@pytest.fixture
def ground() -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        sock.settimeout(60)
        yield sock


def to(sock: socket.socket) -> str:
    return f"udpout:127.0.0.1:{sock.getsockname()[1]}"


def read_until(cable: Cable, expected: bytes, within: float = 60.0) -> bytes:
    """What the bridge writes to the port, until `expected` is among it."""
    found, deadline = b"", time.monotonic() + within
    while expected not in found:
        assert time.monotonic() < deadline, f"{expected!r} did not come, but {found!r}"
        select.select([cable.far], [], [], 0.05)
        found += cable.read()
    return found


# ---- what it is for ----


def test_an_autopilot_on_serial_and_a_ground_station_on_udp(
    bridge: Callable[..., Program], cable: Cable, ground: socket.socket
) -> None:
    program = bridge(cable.endpoint, to(ground))
    program.wait_for("ready")
    cable.write(VEHICLE + unknown(1))
    data, address = ground.recvfrom(2000)
    assert VEHICLE + unknown(1) == data + (b"" if data != VEHICLE else ground.recv(2000))
    ground.sendto(demand(1), address)
    assert read_until(cable, demand(1)) == demand(1)
    ground.sendto(demand(2, target=9) + command(1, 1, 3), address)
    assert read_until(cable, command(1, 1, 3)) == command(1, 1, 3)  # and nothing for vehicle 9
    assert program.end() == 0


def test_udp_and_tcp_and_back(bridge: Callable[..., Program], ground: socket.socket) -> None:
    port, tcp_port = free_port(), free_port()
    program = bridge(f"udpin:127.0.0.1:{port}", f"tcpin:127.0.0.1:{tcp_port}")
    program.wait_for("ready")
    with socket.create_connection(("127.0.0.1", tcp_port), timeout=0.3) as vehicle:
        vehicle.sendall(VEHICLE)
        for number in range(30):  # who was not heard yet is sent nothing, so that the first may go nowhere
            ground.sendto(heartbeat(number), ("127.0.0.1", port))
            with contextlib.suppress(TimeoutError):
                assert vehicle.recv(100)[:21] in [heartbeat(each) for each in range(30)]
                break
        vehicle.sendall(BULK[1][:20])
        vehicle.sendall(BULK[1][20:])
        while (data := ground.recv(2000)) == VEHICLE:
            continue  # it may have come after the ground station
        assert data == BULK[1]
    assert program.end(signal.SIGINT) == 0


def test_unplugged_and_plugged_in_again(bridge: Callable[..., Program], cable: Cable, ground: socket.socket) -> None:
    program = bridge(cable.endpoint, to(ground))
    program.wait_for("ready")
    cable.write(VEHICLE)
    assert ground.recv(2000) == VEHICLE
    cable.unplug()
    program.wait_for("waiting for")
    cable.plug()
    program.wait_for("it is back")
    cable.write(BULK[1])
    assert ground.recv(2000) == BULK[1]
    assert program.end(signal.SIGHUP) == 0


def test_a_flood_comes_through_in_order_and_whole(bridge: Callable[..., Program], ground: socket.socket) -> None:
    port = free_port()
    program = bridge(f"udpin:127.0.0.1:{port}", to(ground), "--json")
    program.line()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle:
        vehicle.connect(("127.0.0.1", port))
        for raw in BULK:
            vehicle.send(raw)
    received = b""
    while len(received) < sum(map(len, BULK)):
        datagram = ground.recv(65536)
        assert len(datagram) <= DATAGRAM
        received += datagram
    assert received == b"".join(BULK)


# ---- what it tells ----


def test_a_line_of_json_a_second_and_nobody_has_to_read_on(
    bridge: Callable[..., Program], cable: Cable, ground: socket.socket
) -> None:
    program = bridge(cable.endpoint, to(ground), "--json")
    program.line()
    damaged = bytearray(BULK[5])
    damaged[20] ^= 1
    cable.write(VEHICLE + BULK[3] + bytes(damaged) + BULK[6] + unknown(7))
    ground.recv(2000)
    status = next(line for line in iter(program.line, None) if line["routes"] and line["links"][0]["unknown"])
    serial, udp = status["links"]
    assert (serial["endpoint"], serial["problem"], serial["peers"]) == (cable.endpoint, None, 1)
    assert (serial["lost"], serial["crc_errors"], serial["unknown"]) == (4, 1, 1)
    assert udp["frames_out_per_s"] > 0
    [route] = status["routes"]
    assert (route["system"], route["component"], route["endpoint"]) == (1, 1, cable.endpoint)
    assert program.process.stdout
    program.process.stdout.close()
    program.wait_for("the status output was closed")
    cable.write(BULK[8])
    while BULK[8] not in ground.recv(2000):
        continue  # what came before it
    program.process.stdout = None
    assert program.end() == 0


def test_a_live_table_on_a_terminal(bridge: Callable[..., Program], cable: Cable, ground: socket.socket) -> None:
    terminal, program_side = pty.openpty()
    fcntl.ioctl(program_side, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 140, 0, 0))
    program = bridge(cable.endpoint, to(ground), stdout=program_side)
    os.close(program_side)
    screen, deadline = b"", time.monotonic() + 60
    while not (b"routes" in screen and b"190" in screen):
        assert time.monotonic() < deadline, screen
        cable.write(heartbeat(0))
        if select.select([terminal], [], [], 0.2)[0]:
            screen += os.read(terminal, 65536)
    assert cable.endpoint.encode()[:20] in screen
    assert program.end() == 0
    os.close(terminal)


def test_it_records_what_passes_and_a_signal_leaves_a_whole_file(
    bridge: Callable[..., Program], cable: Cable, ground: socket.socket, tmp_path: Path
) -> None:
    program = bridge(cable.endpoint, to(ground), "--tlog", str(tmp_path / "logs"))
    program.wait_for("ready")
    cable.write(VEHICLE)
    _, address = ground.recvfrom(2000)
    ground.sendto(demand(1), address)
    read_until(cable, demand(1))
    assert program.end() == 0
    [log] = (tmp_path / "logs").iterdir()
    assert [each.raw for each in read_records(log.read_bytes())] == [VEHICLE, demand(1)]


# ---- mistakes ----


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ((), "two endpoints or more are needed"),
        (("udpin:127.0.0.1:14999",), "two endpoints or more are needed"),
        (("udpin:127.0.0.1:14999", "udpin:127.0.0.1:14999"), "is given twice"),
        (("udpin:127.0.0.1:14999", "serial:ttyAMA0:57600"), "write serial:/dev/ttyAMA0:57600"),
        (("udpin:127.0.0.1:0", "serial:/dev/ttyX:57600", "--json", "--quiet"), "port '0'"),
        (("serial:/dev/null:57600", "udpout:127.0.0.1:14999"), "/dev/null is not a serial port"),
        (
            ("udpout:127.0.0.1:1", "udpout:127.0.0.1:2", "--tlog", "/dev/null/x"),
            "--tlog /dev/null/x: a file of that name exists",
        ),
        (
            ("udpout:127.0.0.1:1", "udpout:127.0.0.1:2", "--tlog", "/dev/null"),
            "/dev/null: a file of that name exists",
        ),
    ],
)
def test_a_mistake_is_one_line_and_exit_code_2(words: tuple[str, ...], told: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "link.bridge", *words], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 2
    assert told in done.stderr
    assert len(done.stderr.splitlines()) == 1


# ---- joining ----


def test_frames_are_joined_whole_and_in_order() -> None:
    datagrams = join_frames(BULK)
    assert b"".join(datagrams) == b"".join(BULK)
    assert all(len(each) <= DATAGRAM for each in datagrams)
    assert len(datagrams) == -(-sum(map(len, BULK)) // DATAGRAM)
    assert all(each.startswith(b"\xfd") for each in datagrams)
    assert join_frames([BULK[0]]) == [BULK[0]]


# ---- the document ----


def test_the_document_names_every_endpoint_option_and_number() -> None:
    text = (Path(__file__).parents[3] / "docs/bridge.md").read_text()
    for scheme in SCHEMES.values():
        assert f"`{scheme.syntax}`" in text
    help_text = subprocess.run(
        [sys.executable, "-m", "link.bridge", "--help"], capture_output=True, text=True, timeout=60, check=True
    ).stdout
    for option in ("--json", "--quiet", "--tlog", "--one-frame"):
        assert option in help_text
        assert option in text
    numbers = (
        f"until {PEER_SILENCE:g} s of silence",
        f"remembered for {ROUTE_SILENCE / 60:g} minutes",
        f"connections, {MAX_CONNECTIONS} at most",
        f"{MIN_BAUD} to {MAX_BAUD} baud",
        f"fed {MAX_DRIVER_BACKLOG * 1000:g} ms of wire time",
        f"has waited {STALE:g} s",
        f"at most {DATAGRAM} bytes",
        f"within {REDUNDANCY_WINDOW:g} s is forwarded once",
    )
    for number in numbers:
        assert number in text.replace("\n", " "), number
