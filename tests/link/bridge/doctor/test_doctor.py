"""`mavhelm bridge doctor` over real sockets and terminal lines: who is heard, who has a port, and no byte sent."""

from __future__ import annotations

import contextlib
import io
import json
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from dialects.messages import Heartbeat
from link.bridge.__main__ import main
from link.bridge.doctor.table import ROWS
from tests.link.frames import frame
from tests.link.ports import Cable
from tests.link.routing.test_router import unknown
from tests.ports import free_port

TIME = "0.6"
"""s of listening."""
REPEAT = 0.02
"""s between two writes of the sender, which writes until the doctor ends."""
Rows = dict[tuple[str, str], dict[str, str]]


def rover(sequence: int, system: int = 1) -> bytes:
    """HEARTBEAT of an ArduPilot rover."""
    return frame(Heartbeat(10, 3, 0, 0, 4, 3), sequence, system, 1)


def said(*words: str) -> tuple[int, str, str]:
    """Exit code, stdout, stderr."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            code = main(["doctor", *words])
        except SystemExit as ended:
            code = int(ended.code or 0)
    return code, out.getvalue(), err.getvalue()


def examined(*words: str) -> tuple[int, Rows, dict[str, Any]]:
    """The exit code, the rows by endpoint and id, and the summary."""
    code, out, _ = said(*words, "--for", TIME, "--json")
    *rows, summary = map(json.loads, out.splitlines())
    return code, {(row["endpoint"], row["row"]): row for row in rows}, summary


@contextlib.contextmanager
def sending(write: Callable[[int], object]) -> Iterator[None]:
    """Call `write` with a sequence number again and again in a thread, until the end of the block."""
    ended = threading.Event()

    def run() -> None:
        sequence = 0
        while not ended.wait(REPEAT):
            write(sequence % 256)
            sequence += 1

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


@pytest.fixture
def cable(tmp_path: Path) -> Iterator[Cable]:
    made = Cable(tmp_path / "port")
    yield made
    made.unplug()


def _received(sock: socket.socket) -> bytes:
    """What has arrived; the error of a datagram that nobody listened for is none."""
    sock.setblocking(False)
    while True:
        try:
            return sock.recv(65536)
        except ConnectionRefusedError:  # taken away by this call
            continue
        except BlockingIOError:
            return b""


def test_a_vehicle_on_a_serial_port_and_a_ground_station_on_udp(cable: Cable) -> None:
    udp = f"udpin:127.0.0.1:{free_port()}"
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as station:
        station.connect(("127.0.0.1", int(udp.rpartition(":")[2])))

        def write(sequence: int) -> None:
            cable.write(rover(sequence))
            with contextlib.suppress(ConnectionRefusedError):  # not listening yet, or no more
                station.send(frame(Heartbeat(6, 8, 0, 0, 4, 3), sequence))

        with sending(write):
            code, rows, summary = examined(cable.endpoint, udp)
        assert cable.read() == b""
        assert _received(station) == b""
    assert (code, summary) == (0, {"ok": True, "faults": []})
    assert list(rows) == [(endpoint, row.id) for endpoint in (cable.endpoint, udp) for row in ROWS]
    assert rows[cable.endpoint, "heard"]["evidence"] == "1/1 ground rover of ArduPilot"
    assert rows[udp, "heard"]["evidence"] == "255/190 gcs"
    assert rows[cable.endpoint, "routes"]["evidence"] == f"1/1 -> {udp}"
    assert rows[udp, "routes"]["evidence"] == f"255/190 -> {cable.endpoint}"
    assert {row["health"] for row in rows.values()} == {"ok"}


def test_a_wrong_baud_rate_another_dialect_and_unknown_messages(cable: Cable) -> None:
    with sending(lambda sequence: cable.write(bytes(range(60)))):
        code, rows, _ = examined(cable.endpoint)
    assert (code, rows[cable.endpoint, "frames"]["health"]) == (7, "fault")
    assert "wrong baud rate" in rows[cable.endpoint, "frames"]["advice"]
    assert rows[cable.endpoint, "bytes"]["health"] == "ok"

    def mixed(sequence: int) -> None:
        foreign = bytearray(rover(sequence, 2))
        foreign[-1] ^= 0x55
        cable.write(rover(2 * sequence % 256) + bytes(foreign) + unknown(sequence))

    with sending(mixed):
        code, rows, _ = examined(cable.endpoint)
    assert code == 0
    assert "another definition of HEARTBEAT" in rows[cable.endpoint, "dialect"]["evidence"]
    assert rows[cable.endpoint, "damage"]["health"] == "unknown"
    assert rows[cable.endpoint, "routes"]["health"] == "unknown"  # one endpoint

    with sending(lambda sequence: cable.write(rover(sequence) + unknown(sequence))):
        code, rows, _ = examined(cable.endpoint)
    assert "unknown ids (45999)" in rows[cable.endpoint, "dialect"]["evidence"]


def test_silence_and_ports_that_do_not_open(cable: Cable) -> None:
    silent = f"udpin:127.0.0.1:{free_port()}"
    taken = free_port()
    program = (
        f"import socket, sys; s = socket.socket(2, 2); s.bind(('127.0.0.1', {taken})); print(1, flush=True); input()"
    )
    with subprocess.Popen([sys.executable, "-Sc", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as holder:
        assert holder.stdout is not None
        assert holder.stdout.readline() == b"1\n"
        name = Path(f"/proc/{holder.pid}/comm").read_text().strip()
        used, refused = f"udpin:127.0.0.1:{taken}", f"tcpout:127.0.0.1:{free_port()}"
        with sending(lambda sequence: cable.write(rover(sequence))):
            code, rows, summary = examined(used, silent, refused, cable.endpoint, "serial:/dev/no-such-port:57600")
        holder.kill()
    assert code == 7
    assert rows[used, "opens"]["evidence"] == f"port {taken} is in use: {name} (pid {holder.pid})"
    assert "Connection refused" in rows[refused, "opens"]["evidence"]
    assert rows["serial:/dev/no-such-port:57600", "opens"]["evidence"] == "/dev/no-such-port, it is not there"
    assert rows[silent, "bytes"]["health"] == "warning"  # another endpoint is heard
    assert summary["faults"][0] == {"endpoint": used, "row": "opens"}
    assert rows[cable.endpoint, "routes"]["evidence"] == "1/1 -> nobody is there yet"
    code, rows, _ = examined(silent)
    assert (code, rows[silent, "bytes"]["health"]) == (7, "fault")


def test_the_same_ids_on_two_endpoints(cable: Cable, tmp_path: Path) -> None:
    other = Cable(tmp_path / "other")

    def write(sequence: int) -> None:
        cable.write(rover(sequence))
        other.write(rover((sequence + 99) % 256))

    with sending(write):
        code, rows, _ = examined(cable.endpoint, other.endpoint)
    other.unplug()
    assert code == 0
    assert rows[cable.endpoint, "routes"]["evidence"] == f"1/1 is heard on {other.endpoint} as well"


def test_without_endpoints_it_lists_the_ports_of_this_machine() -> None:
    code, out, _ = said()
    assert "udp 14550" in out
    assert code in (0, 7)  # 7: this user may not open a port


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        (("--for", "0"), "'0' is not a time from 0 to 3600 s"),
        (("udpin:127.0.0.1:0",), "port '0' is not a number"),
        (("udpin:127.0.0.1:9", "udpin:127.0.0.1:9"), "is given twice"),
    ],
)
def test_a_mistake_on_the_command_line_is_one_line(words: tuple[str, ...], problem: str) -> None:
    code, out, error = said(*words)
    assert (code, out, error.count("\n")) == (2, "", 1)
    assert problem in error
