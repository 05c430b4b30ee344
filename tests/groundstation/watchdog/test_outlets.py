"""Descriptors in the watchdog's process: writing to them, reading from them, closing the old ones."""

from __future__ import annotations

import os
import socket
from collections.abc import Iterator

import pytest

from dialects import codec
from dialects.messages import Heartbeat, SystemTime
from groundstation.watchdog.outlets import Outlets
from groundstation.watchdog.report import DemandRoute

CONNECTED = DemandRoute(0, None, 0)


@pytest.fixture
def ends() -> Iterator[tuple[socket.socket, socket.socket]]:
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_STREAM)
    with ours, theirs:
        for end in (ours, theirs):
            end.setblocking(False)
        yield ours, theirs


def copy(end: socket.socket) -> int:
    return os.dup(end.fileno())


def is_open(descriptor: int) -> bool:
    try:
        os.fstat(descriptor)
    except OSError:
        return False
    return True


def test_a_frame_goes_to_the_descriptor_of_its_route(ends: tuple[socket.socket, socket.socket]) -> None:
    outlets = Outlets()
    outlets.replace([copy(ends[0])], (CONNECTED,))
    assert outlets.write(0, b"neutral") is None
    assert ends[1].recv(100) == b"neutral"
    outlets.replace([], ())


def test_an_unconnected_socket_sends_to_the_address_of_the_route() -> None:
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as rover,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ours,
    ):
        rover.bind(("127.0.0.1", 0))
        rover.settimeout(20.0)
        descriptor, outlets = copy(ours), Outlets()
        outlets.replace([descriptor], (DemandRoute(0, rover.getsockname(), 0),))
        for _ in range(2):
            assert outlets.write(0, b"neutral") is None
            assert rover.recv(100) == b"neutral"
        assert is_open(descriptor), "it is used again"
        outlets.replace([], ())
        assert not is_open(descriptor)


def test_a_report_without_descriptors_keeps_the_last_ones() -> None:
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as before,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as after,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ours,
    ):
        for rover in (before, after):
            rover.bind(("127.0.0.1", 0))
            rover.settimeout(20.0)
        descriptor, outlets = copy(ours), Outlets()
        for rover in (before, after):
            route = DemandRoute(0, rover.getsockname(), 0)
            if rover is before:
                outlets.replace([descriptor], (route,))
            else:
                outlets.update((route,))
            assert outlets.descriptors == (descriptor,)
            assert outlets.write(0, b"neutral") is None
            assert rover.recv(100) == b"neutral"
        outlets.replace([], ())


def test_a_frame_that_the_kernel_refuses_says_why(ends: tuple[socket.socket, socket.socket]) -> None:
    outlets = Outlets()
    assert outlets.write(0, b"neutral") == "no descriptor"
    outlets.replace([copy(ends[0])], (CONNECTED, CONNECTED))
    assert outlets.write(1, b"neutral") == "no descriptor"
    ends[1].close()
    assert outlets.write(0, b"neutral") == "Broken pipe"
    outlets.replace([], ())


def test_a_descriptor_that_is_closed_already_stops_nothing(ends: tuple[socket.socket, socket.socket]) -> None:
    gone, kept, outlets = copy(ends[0]), copy(ends[0]), Outlets()
    outlets.replace([gone, kept], (CONNECTED, CONNECTED))
    os.close(gone)
    outlets.replace([], ())
    assert not is_open(kept)
    assert outlets.descriptors == ()


def test_only_what_shows_whether_a_vehicle_stands_is_read(ends: tuple[socket.socket, socket.socket]) -> None:
    descriptor, outlets = copy(ends[0]), Outlets()
    outlets.replace([descriptor], (CONNECTED,))
    beat = codec.frame(0, codec.encode_payload(Heartbeat(10, 3, 0, 0, 4, 3)), 1, 1, 1)
    other = codec.frame(SystemTime.id, codec.encode_payload(SystemTime(1, 1)), 2, 1, 1)
    ends[1].send(other + beat[:5])
    assert outlets.read(descriptor, 0.0) == []
    ends[1].send(beat[5:])
    assert [frame[4] for frame in outlets.read(descriptor, 0.05)] == [beat]
    ends[1].send(codec.frame(110, bytes(253) + b"x", 3, 1, 1)[:50])
    assert outlets.read(descriptor, 0.2) == []
    outlets.replace([], ())
    fresh = copy(ends[0])
    assert fresh == descriptor, "the number is used again"
    outlets.replace([fresh], (CONNECTED,))
    ends[1].send(beat)
    assert [frame[4] for frame in outlets.read(fresh, 0.21)] == [beat], "half a frame of another line is forgotten"
    with pytest.raises(BlockingIOError):
        outlets.read(fresh, 0.4)
    ends[1].close()
    with pytest.raises(EOFError):
        outlets.read(fresh, 0.5)
    outlets.replace([], ())
