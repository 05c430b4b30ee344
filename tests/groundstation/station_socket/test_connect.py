"""Connections to stations of this user: real sockets in a runtime folder of the test's own."""

from __future__ import annotations

import contextlib
import os
import socket
import struct
import threading
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import msgspec
import pytest

from groundstation.station_socket.connect import NoStationError, connect, running_stations
from groundstation.station_socket.folder import (
    FolderError,
    folder_path,
    list_sockets,
    make_folder,
    socket_address,
    socket_path,
)
from groundstation.station_socket.hello import NAMES, SCREEN, VERB, Hello, StationFailed, decode_hello
from groundstation.station_socket.names import MODES, PARAMS, Names, encode_names, find_names, plain_names
from groundstation.station_socket.packets import read_packet
from groundstation.station_socket.verb_run import CompanionEnded, RunVerb, ToCompanion
from link.runtime.local_socket import open_socket, peer_credentials
from link.transport.receive_buffer import ReceiveBuffer

HELLO = Hello(SCREEN, 3, "screen on pts/4", watches=True)


@pytest.fixture
def stack(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ExitStack]:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    make_folder()
    with ExitStack() as opened:
        yield opened


def station(stack: ExitStack, pid: int, backlog: int = 5) -> socket.socket:
    """A socket that listens as the station with this process id."""
    listening = stack.enter_context(open_socket())
    listening.bind(str(socket_path(folder_path(), pid)))
    listening.listen(backlog)
    listening.settimeout(20.0)
    return listening


def fill(stack: ExitStack, pid: int) -> None:
    """Fill the queue of those who connect."""
    with contextlib.suppress(BlockingIOError):
        while True:
            waiting = stack.enter_context(open_socket())
            waiting.setblocking(False)
            waiting.connect(str(socket_path(folder_path(), pid)))


# ---- connect ----


def test_a_station_is_told_first_what_connects(stack: ExitStack) -> None:
    listening = station(stack, 41)
    sock = stack.enter_context(connect(41, HELLO))
    assert sock.gettimeout() == 2.0
    assert peer_credentials(sock) == (os.getpid(), os.getuid())
    accepted = stack.enter_context(listening.accept()[0])
    assert decode_hello(accepted.recv(4096)) == HELLO
    assert sock.getsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF) > 300_000


def test_the_kernel_waits_as_long_as_the_socket(stack: ExitStack) -> None:
    station(stack, 41)
    with connect(41, HELLO, 2.25) as sock:
        wait = sock.getsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, 16)
        seconds, microseconds = struct.unpack("2l", wait)
        assert seconds + microseconds / 1e6 == pytest.approx(2.25, abs=0.02)  # in ticks of the kernel
        assert sock.gettimeout() == 2.25


def test_a_station_that_does_not_run_is_named(stack: ExitStack) -> None:
    station(stack, 41)
    with pytest.raises(NoStationError, match="no station with process id 42 runs here"):
        connect(42, HELLO)


def test_the_socket_of_a_killed_station_is_removed(stack: ExitStack) -> None:
    station(stack, 41).close()
    station(stack, 42)
    assert [pid for pid, _ in list_sockets()] == [41, 42]
    assert running_stations() == [42]
    assert [pid for pid, _ in list_sockets()] == [42]
    station(stack, 43).close()
    with pytest.raises(NoStationError, match="no station with process id 43 runs here"):
        connect(43, HELLO)


def test_what_cannot_be_asked_is_left_alone(stack: ExitStack) -> None:
    path = socket_path(folder_path(), 41)
    path.symlink_to(path)
    assert running_stations() == []
    assert path.is_symlink()


def test_a_station_that_hangs_counts_and_takes_nobody(stack: ExitStack) -> None:
    station(stack, 41, backlog=0)
    fill(stack, 41)
    assert running_stations() == [41]
    with pytest.raises(NoStationError, match="station 41 takes no more programs: it may hang"):
        connect(41, HELLO, 0.01)


@pytest.mark.skipif(os.getuid() != 0, reason="only root can be another user")
def test_the_station_of_another_user_is_refused(stack: ExitStack) -> None:
    ours, theirs = os.pipe()
    listening = stack.enter_context(open_socket())
    listening.bind(str(socket_path(folder_path(), 41)))
    child = os.fork()
    if not child:
        os.setuid(12345)
        listening.listen(5)  # the kernel notes who does
        os.write(theirs, b"\0")
        os._exit(0)
    os.waitpid(child, 0)
    assert os.read(ours, 1) == b"\0"
    os.close(ours)
    os.close(theirs)
    with pytest.raises(NoStationError, match="the socket of station 41 belongs to another user"):
        connect(41, HELLO)


def test_a_station_that_takes_programs_again_is_waited_for(stack: ExitStack) -> None:
    listening = station(stack, 41, backlog=0)
    fill(stack, 41)
    found: list[socket.socket] = []
    connects = threading.Thread(target=lambda: found.append(connect(41, HELLO, 20.0)))
    connects.start()
    while connects.is_alive():
        with contextlib.suppress(TimeoutError):
            listening.settimeout(0.02)
            stack.enter_context(listening.accept()[0])
    (sock,) = found
    with sock:
        assert sock.gettimeout() == 20.0


def test_packets_are_read_without_waiting(stack: ExitStack) -> None:
    listening = station(stack, 41)
    sock = stack.enter_context(connect(41, HELLO))
    accepted = stack.enter_context(listening.accept()[0])
    sock.setblocking(False)
    buffer = ReceiveBuffer(100)
    assert read_packet(sock, buffer) is None
    accepted.send(b"one")
    assert read_packet(sock, buffer) == b"one"
    accepted.close()
    assert read_packet(sock, buffer) == b""


# ---- folder ----


@pytest.mark.parametrize("base", ["", "relative", "/nowhere"])
def test_a_runtime_folder_that_is_none_is_not_used(base: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "relative").mkdir()
    monkeypatch.setenv("XDG_RUNTIME_DIR", base)
    user = os.getuid()
    usual = Path(f"/run/user/{user}")
    assert folder_path() == (usual / "mavhelm" if usual.is_dir() else Path(f"/tmp/mavhelm-{user}"))


@pytest.mark.skipif(os.getuid() != 0, reason="only root can give a folder away")
def test_the_runtime_folder_of_another_user_is_not_used(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    assert folder_path() == tmp_path / "mavhelm"
    os.chown(tmp_path, 12345, 12345)
    assert folder_path() != tmp_path / "mavhelm"
    os.chown(tmp_path, os.getuid(), os.getgid())


def test_only_sockets_of_stations_are_listed(stack: ExitStack) -> None:
    for name in ("station-12.sock", "station-3.sock", "station-x.sock", "other-5.sock", "12", "station-.sock"):
        (folder_path() / name).touch()
    assert list_sockets() == [(pid, folder_path() / f"station-{pid}.sock") for pid in (12, 3)]


def test_without_a_folder_there_is_no_station(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    assert list_sockets() == []
    (tmp_path / "mavhelm").touch(0o600)
    with pytest.raises(FolderError, match="Not a directory"):
        list_sockets()


def test_the_sockets_of_an_open_folder_are_not_used(stack: ExitStack) -> None:
    station(stack, 41)
    folder_path().chmod(0o755)
    with pytest.raises(FolderError, match="is open to other users"):
        list_sockets()
    assert find_names(PARAMS, 20.0) == []


def test_a_path_of_107_bytes_is_an_address_and_a_longer_one_not(tmp_path: Path) -> None:
    for length in (107, 108, 150):
        folder = tmp_path / ("d" * (length - len(str(tmp_path)) - len("//s")))
        folder.mkdir()
        path, before = folder / "s", len(os.listdir("/proc/self/fd"))
        assert len(str(path)) == length
        with socket_address(path) as address, open_socket() as sock:
            assert (address == str(path)) is (length == 107)
            sock.bind(address)
        assert path.is_socket()
        assert len(os.listdir("/proc/self/fd")) == before


# ---- names ----


def answer(listening: socket.socket, data: bytes) -> threading.Thread:
    """Answer the next program that asks."""

    def run() -> None:
        with listening.accept()[0] as accepted:
            assert decode_hello(accepted.recv(4096)) == Hello(NAMES, 1, MODES)
            accepted.send(data)

    asked = threading.Thread(target=run)
    asked.start()
    return asked


def test_the_plain_names_of_all_stations_are_found(stack: ExitStack) -> None:
    asked = [
        answer(station(stack, 41), encode_names(Names(("HOLD", "$(reboot)", "-rf", "a b")))),
        answer(station(stack, 42), encode_names(Names(("AUTO", "HOLD")))),
        answer(station(stack, 43), b"\xc1 damaged"),
    ]
    assert find_names(MODES, 20.0) == ["AUTO", "HOLD"]
    for each in asked:
        each.join(20.0)


@pytest.mark.parametrize("within", [0.0, -1.0, 0.05])
def test_a_station_that_does_not_answer_has_no_names(stack: ExitStack, within: float) -> None:
    listening = station(stack, 41)
    assert find_names(MODES, within) == []
    listening.setblocking(False)
    if within > 0:
        listening.accept()[0].close()
    else:
        with pytest.raises(BlockingIOError):
            listening.accept()


def test_plain_names_keep_their_order() -> None:
    assert plain_names(["b", "", "a.b:c-1", "ü", "a\n", "A_1"]) == ["b", "a.b:c-1", "A_1"]


# ---- packets ----


def test_what_a_packet_does_not_say_is_nothing() -> None:
    assert decode_hello(encode_names(Hello(VERB, 1))) == Hello(VERB, 1, "", watches=False, follows=False)
    assert RunVerb(("arm",)) == RunVerb(("arm",), None, None, "")
    assert ToCompanion(b"") == ToCompanion(b"", whole=True)
    assert CompanionEnded() == CompanionEnded(0, "")
    assert StationFailed("why").line == "why"
    assert msgspec.msgpack.decode(encode_names(Names(("A",)))) == {"type": "Names", "names": ["A"]}
