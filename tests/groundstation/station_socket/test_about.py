"""What stations tell about themselves: real sockets in a runtime folder of the test's own."""

from __future__ import annotations

import os
import socket
import threading
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import msgspec
import pytest

from groundstation.station_socket.about import (
    About,
    ask_about,
    describe_stations,
    encode_about,
    explain_taken,
    find_holder,
)
from groundstation.station_socket.folder import folder_path, make_folder, socket_path
from groundstation.station_socket.hello import ABOUT, Hello, decode_hello
from link.runtime.local_socket import open_socket

FULL = About(("Rover 1", "Rover 2"), ("udpin:0.0.0.0:14550",), ("screen on pts/3", "web tab 1"))
EMPTY = About((), (), ())
PATIENCE = 20.0
"""s for an answer on a late machine."""


@pytest.fixture
def stack(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ExitStack]:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    monkeypatch.setattr("groundstation.station_socket.about.ANSWER_WITHIN", PATIENCE)
    monkeypatch.setattr(ask_about, "__defaults__", (PATIENCE,))
    make_folder()
    with ExitStack() as opened:
        yield opened


def station(stack: ExitStack, pid: int, answer: bytes | None) -> None:
    """Answer the programs that ask the station with this process id; None: accept them and say nothing."""
    listening = stack.enter_context(open_socket())
    listening.bind(str(socket_path(folder_path(), pid)))
    listening.listen(5)
    open_for_ever: list[socket.socket] = []

    def run() -> None:
        while True:
            try:
                accepted = listening.accept()[0]
            except OSError:
                return
            open_for_ever.append(accepted)
            hello = accepted.recv(4096)
            if hello and answer is not None:  # a program that only looks who runs says nothing
                assert decode_hello(hello) == Hello(ABOUT, 1)
                accepted.send(answer)

    thread = threading.Thread(target=run)

    def end() -> None:
        listening.shutdown(socket.SHUT_RDWR)
        thread.join(PATIENCE)
        for each in open_for_ever:
            each.close()

    thread.start()
    stack.callback(end)


def test_a_station_tells_its_vehicles_links_and_screens(stack: ExitStack) -> None:
    station(stack, 41, encode_about(FULL))
    assert ask_about(41) == FULL


def test_an_answer_of_64_kb_is_read(stack: ExitStack) -> None:
    room = 65536 - len(encode_about(About((), ("e" * 60000,), ())))
    largest = About((), ("e" * (60000 + room),), ())
    assert len(encode_about(largest)) == 65536
    station(stack, 41, encode_about(largest))
    station(stack, 42, encode_about(About((), (largest.endpoints[0] + "e",), ())))
    assert ask_about(41) == largest
    assert ask_about(42) is None


def test_a_station_that_says_nothing_or_nonsense_is_none(stack: ExitStack) -> None:
    station(stack, 41, None)
    station(stack, 42, b"\xc1 damaged")
    assert ask_about(41, 0.02) is None
    assert ask_about(42) is None
    assert ask_about(43) is None
    folder_path().chmod(0o755)
    assert ask_about(42) is None


def test_a_station_that_says_nothing_is_not_waited_for() -> None:
    import inspect

    assert inspect.signature(ask_about).parameters["within"].default == 0.3


def test_stations_are_described_in_one_line(stack: ExitStack) -> None:
    station(stack, 41, encode_about(FULL))
    station(stack, 42, encode_about(EMPTY))
    station(stack, 43, encode_about(About(("a", "b", "c"), ("serial:/dev/ttyACM0", "tcp:10.0.0.1:5760"), ())))
    station(stack, 44, encode_about(About(("a", "b", "c", "d"), (), ())))
    assert describe_stations([41, 42]) == (
        "41 (Rover 1, Rover 2, udpin:0.0.0.0:14550, screen on pts/3, web tab 1), 42 (no vehicle, no link, no screen)"
    )
    assert describe_stations([43]) == "43 (a, b, c, serial:/dev/ttyACM0, tcp:10.0.0.1:5760, no screen)"
    assert describe_stations([44, 45]) == "44 (a, b, c, ..., no link, no screen), 45"


def test_the_station_with_a_port_or_device_is_found(stack: ExitStack) -> None:
    station(stack, 41, b"\xc1 damaged")
    station(stack, 42, encode_about(EMPTY))
    station(stack, 43, encode_about(About((), ("serial:/dev/ttyACM0:115200", "udpin:0.0.0.0:14550"), ())))
    assert find_holder("udpin:0.0.0.0:14550") == 43
    assert find_holder("udpin:127.0.0.1:14550") == 43
    assert find_holder("serial:/dev/ttyACM0:115200") == 43
    assert find_holder("udpin:0.0.0.0:14551") is None
    assert find_holder("not an endpoint") is None


def test_endpoints_that_this_program_does_not_know_are_passed(stack: ExitStack) -> None:
    station(stack, 41, encode_about(About((), ("quic:10.0.0.1:9",), ())))
    station(stack, 42, encode_about(About((), ("quic:10.0.0.1:9", "udpin:0.0.0.0:14550"), ())))
    assert find_holder("udpin:0.0.0.0:14550") == 42


def test_a_station_does_not_find_itself(stack: ExitStack) -> None:
    station(stack, os.getpid(), encode_about(FULL))
    assert find_holder("udpin:0.0.0.0:14550") is None


def test_without_a_private_folder_nobody_is_found(stack: ExitStack) -> None:
    station(stack, 41, encode_about(FULL))
    folder_path().chmod(0o755)
    assert find_holder("udpin:0.0.0.0:14550") is None


@pytest.mark.parametrize(
    ("problem", "explained"),
    [
        (
            "udpin:0.0.0.0:14550: the port is in use; choose another one",
            "udpin:0.0.0.0:14550: the port is in use; a station of yours (43) has it: attach 43",
        ),
        (
            "udpin:0.0.0.0:14550: another program uses it (`fuser 14550/udp` names it)",
            "udpin:0.0.0.0:14550: another program uses it; a station of yours (43) has it: attach 43",
        ),
        ("udpin:0.0.0.0:14550: permission denied; ask", "udpin:0.0.0.0:14550: permission denied; ask"),
        ("udpin:0.0.0.0:14551: the port is in use; ask", "udpin:0.0.0.0:14551: the port is in use; ask"),
    ],
)
def test_a_port_that_is_in_use_names_the_station(problem: str, explained: str, stack: ExitStack) -> None:
    station(stack, 43, encode_about(FULL))
    assert explain_taken(problem, "attach {pid}") == explained


def test_an_answer_is_a_map_with_its_kind() -> None:
    assert msgspec.msgpack.decode(encode_about(EMPTY)) == {
        "type": "About",
        "vehicles": [],
        "endpoints": [],
        "screens": [],
    }
    with pytest.raises(AttributeError):
        FULL.vehicles = ()  # type: ignore[misc]
