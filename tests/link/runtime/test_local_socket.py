"""Sockets between programs of one computer: those of the kernel and those of a stream keep the same promises."""

from __future__ import annotations

import os
import signal
import socket
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from link.runtime.local_socket import LARGEST, PacketStream, open_pair, peer_credentials, take_over
from link.transport.receive_buffer import ReceiveBuffer

Pair = tuple[socket.socket, socket.socket]


def _stream_pair() -> Pair:
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_STREAM)
    return PacketStream(ours.detach()), PacketStream(theirs.detach())


@pytest.fixture(params=[open_pair, _stream_pair], ids=["kernel", "stream"])
def pair(request: pytest.FixtureRequest) -> Iterator[Pair]:
    ours, theirs = request.param()
    with ours, theirs:
        yield ours, theirs


def _fill(sock: socket.socket, packet: Callable[[int], bytes]) -> list[bytes]:
    """Send packets until there is no room; return those that were taken."""
    taken: list[bytes] = []
    while True:
        try:
            sock.send(packet(len(taken)))
        except BlockingIOError:
            return taken
        taken.append(packet(len(taken)))


def test_packets_arrive_one_by_one_and_then_the_end(pair: Pair) -> None:
    ours, theirs = pair
    buffer = ReceiveBuffer(1 << 18)
    for packet in (b"one", bytes(100_000), b"two"):
        ours.send(packet)
    ours.close()
    assert [buffer.recv(theirs), theirs.recv(1 << 18), theirs.recv(10)] == [b"one", bytes(100_000), b"two"]
    assert theirs.recv(10) == buffer.recv(theirs) == b""


def test_a_packet_is_cut_off_and_the_next_one_whole(pair: Pair) -> None:
    ours, theirs = pair
    ours.send(b"0123456789")
    ours.send(b"next")
    assert (theirs.recv(4), theirs.recv(100)) == (b"0123", b"next")


def test_nothing_waits_where_nothing_was_sent(pair: Pair) -> None:
    ours, theirs = pair
    theirs.setblocking(False)
    with pytest.raises(BlockingIOError):
        theirs.recv(10)
    theirs.settimeout(0.01)
    with pytest.raises(TimeoutError):
        theirs.recv(10)
    assert theirs.gettimeout() == 0.01
    ours.send(b"late")
    assert theirs.recv(10) == b"late"


def test_what_a_full_socket_has_taken_arrives_whole(pair: Pair) -> None:
    ours, theirs = pair
    for each in pair:
        each.setblocking(False)
    taken = _fill(ours, lambda number: b"%d " % number * 20_000)
    assert len(taken) > 1
    arrived = [theirs.recv(LARGEST) for _ in taken[:-1]]
    ours.send(b"behind")  # what is left of the last one goes first
    assert [*arrived, theirs.recv(LARGEST)] == taken
    assert theirs.recv(LARGEST) == b"behind"
    with pytest.raises(BlockingIOError):
        theirs.recv(10)


def test_descriptors_come_with_their_packet(pair: Pair) -> None:
    ours, theirs = pair
    read, write = os.pipe()
    ours.send(b"before")
    socket.send_fds(ours, [b"with"], [write])
    ours.send(b"behind")
    assert socket.recv_fds(theirs, 100, 4)[:2] == (b"before", [])
    packet, (copy,), _, _ = socket.recv_fds(theirs, 100, 4)
    os.write(copy, b"!")
    assert (packet, os.read(read, 10)) == (b"with", b"!")
    assert socket.recv_fds(theirs, 100, 4)[:2] == (b"behind", [])
    for each in (read, write, copy):
        os.close(each)


def test_a_process_killed_with_9_is_the_end(pair: Pair) -> None:
    ours, theirs = pair
    process = os.fork()
    if not process:
        signal.pause()
    theirs.close()
    ours.settimeout(20.0)
    os.kill(process, signal.SIGKILL)
    assert ours.recv(10) == b""
    os.waitpid(process, 0)


def test_the_other_end_is_this_process(pair: Pair) -> None:
    assert peer_credentials(pair[0]) == (os.getpid(), os.getuid())


def test_a_socket_that_was_passed_on_is_of_the_same_kind(pair: Pair) -> None:
    ours, theirs = pair
    with take_over(theirs.detach()) as taken:
        assert type(taken) is type(theirs)
        ours.send(b"one")
        ours.send(b"two")
        assert (taken.recv(10), taken.recv(10)) == (b"one", b"two")


def test_a_reader_of_a_stream_waits_for_the_rest() -> None:
    plain, other = socket.socketpair(socket.AF_UNIX, socket.SOCK_STREAM)
    with plain, PacketStream(other.detach()) as stream:
        stream.setblocking(False)
        for byte in b"\0\0\0\x03abc":
            with pytest.raises(BlockingIOError):
                stream.recv(10)
            plain.send(bytes([byte]))
        assert stream.recv(10) == b"abc"
        plain.send(b"\0\0\0\x02d")
        plain.close()
        assert stream.recv(10) == b"", "a packet that was cut off is none"


def test_a_stream_gives_up_in_time_on_a_packet_that_drips() -> None:
    plain, other = socket.socketpair(socket.AF_UNIX, socket.SOCK_STREAM)
    with plain, PacketStream(other.detach()) as stream:
        stream.settimeout(0.05)
        plain.send(b"\0\0\0\x03a")
        with pytest.raises(TimeoutError):
            stream.recv(10)
        plain.send(b"bc")
        assert stream.recv(10) == b"abc"


def test_no_stream_takes_or_sends_a_packet_without_bounds() -> None:
    plain, other = socket.socketpair(socket.AF_UNIX, socket.SOCK_STREAM)
    with plain, PacketStream(other.detach()) as stream:
        with pytest.raises(OSError, match="too long"):
            stream.send(bytes(LARGEST + 1))
        plain.send(b"\xff\xff\xff\xff")
        with pytest.raises(OSError, match="message"):
            stream.recv(10)


def test_a_blocking_stream_sends_all_of_a_packet() -> None:
    ours, theirs = _stream_pair()
    process = os.fork()
    if not process:
        os._exit(0 if theirs.recv(LARGEST) == bytes(LARGEST) else 1)
    with ours, theirs:
        assert ours.send(bytes(LARGEST)) == LARGEST
    assert os.waitpid(process, 0)[1] == 0


def test_a_program_that_connects_is_a_packet_stream(tmp_path: Path) -> None:
    with PacketStream() as listening, PacketStream() as calling:
        listening.bind(str(tmp_path / "socket"))
        listening.listen()
        calling.connect(str(tmp_path / "socket"))
        accepted, _ = listening.accept()
        with accepted:
            calling.send(b"hello")
            assert accepted.recv(100) == b"hello"
            assert peer_credentials(calling)[1] == os.getuid()


def test_the_kernel_keeps_packets_where_it_can() -> None:
    ours, theirs = open_pair()
    with ours, theirs:
        assert (ours.type == socket.SOCK_SEQPACKET) == (sys.platform != "darwin")
