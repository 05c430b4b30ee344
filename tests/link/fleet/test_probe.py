"""Which router answers a probe: one that listens, by TCP or QUIC, and it sees nothing of the probe."""

from __future__ import annotations

import socket
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager

import pytest

from link.fleet.addresses import Addresses
from link.fleet.locator import Locator, read_locator
from link.fleet.probe import RouterProbe
from tests.ports import free_port

NEVER = threading.Event()


def listener() -> socket.socket:
    return socket.create_server(("127.0.0.1", 0))


def locator(protocol: str, at: socket.socket) -> str:
    return f"{protocol}/127.0.0.1:{at.getsockname()[1]}"


def unexpected(problem: str) -> None:
    raise AssertionError(problem)


@pytest.mark.parametrize("protocol", ["tcp", "tls"])
def test_listening_router_answers_at_once_and_sees_no_connection(protocol: str) -> None:
    with closing(listener()) as at:
        assert RouterProbe([locator(protocol, at)]).find(None, NEVER, unexpected) == locator(protocol, at)
        if sys.platform == "linux":
            at.setblocking(False)
            with pytest.raises(BlockingIOError):
                at.accept()


def test_one_that_refuses_is_asked_again_until_it_listens() -> None:
    port, told = free_port(), list[str]()
    with socket.socket() as at:

        def listen(problem: str) -> None:
            told.append(problem)
            at.bind(("127.0.0.1", port))
            at.listen()

        at.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        where = f"tls/127.0.0.1:{port}"
        assert RouterProbe([where]).find(None, NEVER, listen) == where
    assert told == [f"no router at tls/127.0.0.1:{port} (connection refused)"]


def test_the_router_tried_last_comes_after_the_others() -> None:
    with closing(listener()) as first, closing(listener()) as second:
        both = [locator("tcp", first), locator("tcp", second)]
        assert RouterProbe(both).find(None, NEVER, unexpected) == both[0]
        assert RouterProbe(both).find(both[0], NEVER, unexpected) == both[1]
    with closing(listener()) as only:
        assert RouterProbe([locator("tcp", only)]).find(locator("tcp", only), NEVER, unexpected) == locator("tcp", only)


def test_it_is_tried_again_if_no_other_one_answers() -> None:
    with closing(listener()) as at:
        both = [f"tcp/127.0.0.1:{free_port()}", locator("tcp", at)]
        assert RouterProbe(both).find(both[1], NEVER, lambda _: None) == both[1]


@contextmanager
def quic_server(answer: Callable[[bytes], bytes]) -> Iterator[tuple[str, list[bytes]]]:
    """Answer each packet in a thread; give the locator, and the packets."""
    taken = list[bytes]()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as at, socket.socket(type=socket.SOCK_DGRAM) as end:
        at.bind(("127.0.0.1", 0))

        def serve() -> None:
            while True:
                data, peer = at.recvfrom(2048)
                if not data:
                    return
                taken.append(data)
                at.sendto(answer(data), peer)

        server = threading.Thread(target=serve)
        server.start()
        yield locator("quic", at), taken
        end.sendto(b"", at.getsockname())
        server.join()


def test_a_server_of_quic_names_its_versions() -> None:
    def name_versions(data: bytes) -> bytes:
        return b"\x80" + bytes(4) + data[14:23] + data[5:14] + (1).to_bytes(4, "big")

    with quic_server(name_versions) as (where, taken):
        assert RouterProbe([f"{where}?mixed_rel=1"]).find(None, NEVER, unexpected) == f"{where}?mixed_rel=1"
    assert (len(taken[0]), taken[0][:6]) == (1200, b"\xc0\x1a\x2a\x3a\x4a\x08")


def test_another_answer_is_none() -> None:
    stop, answered = threading.Event(), list[bytes]()

    def echo(data: bytes) -> bytes:
        answered.append(data)
        if len(answered) == 2:
            stop.set()
        return data

    with quic_server(echo) as (where, taken):
        assert RouterProbe([where]).find(None, stop, lambda _: None) is None
    assert len(taken) >= 2


def test_what_only_zenoh_can_ask_is_tried_at_once() -> None:
    assert RouterProbe(["udp/127.0.0.1:1"]).find(None, NEVER, unexpected) == "udp/127.0.0.1:1"


def test_a_name_that_nobody_knows() -> None:
    stop, told = threading.Event(), list[str]()

    def note(problem: str) -> None:
        told.append(problem)
        stop.set()

    assert RouterProbe(["tls/nosuch.invalid:7447"]).find(None, stop, note) is None
    assert told == ["host 'nosuch.invalid' is not known; check the name or the network"]


def test_addresses_of_a_name_and_of_a_number() -> None:
    numbers = Addresses("127.0.0.1", 7447, socket.SOCK_STREAM)
    assert [each[4] for each in numbers.find()] == [("127.0.0.1", 7447)]
    names = Addresses("localhost", 7447, socket.SOCK_STREAM)
    while not names.find() and names.problem is None:
        pass
    assert ("127.0.0.1", 7447) in [each[4] for each in names.find()]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("tls/fleet.example.org:7447", Locator("tls", "fleet.example.org", 7447)),
        ("quic/[::1]:7447?mixed_rel=1", Locator("quic", "::1", 7447)),
        ("tcp/10.0.0.1:1#so_sndbuf=2048", Locator("tcp", "10.0.0.1", 1)),
        ("unixsock-stream//tmp/router", None),
        ("tcp/10.0.0.1:70000", None),
    ],
)
def test_parts_of_a_locator(text: str, expected: Locator | None) -> None:
    assert read_locator(text) == expected
