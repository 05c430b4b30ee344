"""TCP on real sockets: several clients, reconnects, half frames, readers that do not read."""

from __future__ import annotations

import asyncio
import socket
import threading
from collections.abc import Iterator

import pytest

from dialects.messages import Attitude, CommandLong, Heartbeat
from link.core import Outgoing
from link.endpoint import parse_endpoint
from link.protocol.channel import Channel
from link.protocol.framer import Framer
from link.transport import tcp
from link.transport.tcp import MAX_CONNECTIONS, TcpClientTransport, TcpServerTransport, open_tcpin, open_tcpout
from link.transport.transport import LinkError
from tests.link.frames import demand, frame, heartbeat
from tests.link.ports import Heard
from tests.ports import free_port
from tests.waits import until

DISARM = frame(CommandLong(1, 1, 400, 0, 0, 0, 0, 0, 0, 0, 0), 9)


@pytest.fixture
def port() -> int:
    return free_port()


@pytest.fixture
async def server(port: int) -> TcpServerTransport:
    return open_tcpin(parse_endpoint(f"tcpin:127.0.0.1:{port}"))


@pytest.fixture
def listener(port: int) -> Iterator[socket.socket]:
    with socket.create_server(("127.0.0.1", port)) as sock:
        sock.settimeout(60)
        yield sock


def client(port: int) -> TcpClientTransport:
    return open_tcpout(parse_endpoint(f"tcpout:127.0.0.1:{port}"))


def connected(port: int, host: str = "127.0.0.1") -> socket.socket:
    """A client with this address of its own."""
    sock = socket.create_connection(("127.0.0.1", port), timeout=10, source_address=(host, 0))
    sock.setblocking(False)
    return sock


def received(sock: socket.socket) -> bytes:
    try:
        return sock.recv(65536)
    except BlockingIOError:
        return b""


def said(heard: Heard) -> list[tuple[bytes, object]]:
    """What came, without the connections themselves."""
    return [(data, address) for data, address in heard.data if data]


async def test_who_connects_is_heard_of_before_he_has_said_anything(server: TcpServerTransport, port: int) -> None:
    """mavutil and MAVSDK say nothing before they have heard a vehicle."""
    heard = Heard(server)
    with connected(port) as sock:
        await until(lambda: heard.data)
        assert heard.data == [(b"", sock.getsockname())]
        channel = Channel("tcpin:127.0.0.1:5760", 0, system=1, component=1, stream=True)
        channel.receive(*heard.data[0], 0.0)
        [(beat, address, _)] = channel.send(Outgoing(Heartbeat(10, 0, 0, 0, 3, 3)))
        server.send(beat, address)
        await until(lambda: received(sock) == beat)
    server.close()


async def test_each_client_is_a_peer_and_goes_when_it_closes(server: TcpServerTransport, port: int) -> None:
    heard = Heard(server)
    one, two = connected(port), connected(port)
    one.sendall(heartbeat(0))
    two.sendall(heartbeat(0, system=254))
    await until(lambda: len(said(heard)) == 2)
    assert {address for _, address in heard.data} == {one.getsockname(), two.getsockname()}
    server.send(demand(1), two.getsockname())
    await until(lambda: received(two) == demand(1))
    assert received(one) == b""
    two.close()
    await until(lambda: heard.gone)
    server.send(demand(2), heard.gone[0])
    assert len(heard.gone) == 1
    one.close()
    server.close()


async def test_the_crowd_is_closed_at_once(server: TcpServerTransport, port: int) -> None:
    heard = Heard(server)
    crowd = [connected(port) for _ in range(MAX_CONNECTIONS + 1)]
    for sock in crowd[:MAX_CONNECTIONS]:
        sock.sendall(heartbeat(0))
    await until(lambda: len(said(heard)) == MAX_CONNECTIONS)

    def last_is_closed() -> bool:
        try:
            return crowd[-1].recv(1) == b""
        except BlockingIOError:
            return False

    await until(last_is_closed)
    for sock in crowd:
        sock.close()
    server.close()


async def test_silent_connections_make_room_the_most_silent_first(
    server: TcpServerTransport, port: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Sixteen laptops that left the WLAN without a word must not close the port for everybody."""
    heard = Heard(server)
    crowd = [connected(port) for _ in range(MAX_CONNECTIONS)]
    await until(lambda: len(heard.data) == MAX_CONNECTIONS)
    for sock in crowd[1:]:
        sock.sendall(heartbeat(0))
    await until(lambda: len(said(heard)) == MAX_CONNECTIONS - 1)
    refused = connected(port)
    await until(lambda: is_closed(refused))  # all were heard a moment ago
    monkeypatch.setattr(tcp, "EVICT_AFTER", 0.0)
    newcomer = connected(port)
    newcomer.sendall(heartbeat(7))
    await until(lambda: (heartbeat(7), newcomer.getsockname()) in heard.data)
    await until(lambda: is_closed(crowd[0]))
    assert not any(is_closed(sock) for sock in crowd[1:])
    assert heard.gone == [crowd[0].getsockname()]
    for sock in (*crowd, refused, newcomer):
        sock.close()
    server.close()


async def test_a_host_with_all_connections_gives_one_up(port: int) -> None:
    transport = open_tcpin(parse_endpoint(f"tcpin:127.0.0.1:{port}"))
    heard = Heard(transport)
    crowd = [connected(port) for _ in range(16)]
    for sock in crowd:
        sock.sendall(heartbeat(0))
    await until(lambda: len(said(heard)) == 16)
    others = [connected(port, f"127.0.0.{host}") for host in range(2, 14)]
    for sock in others:
        sock.sendall(heartbeat(7))
    await until(lambda: all((heartbeat(7), sock.getsockname()) in heard.data for sock in others))
    await until(lambda: sum(map(is_closed, crowd)) == 12)  # it keeps four
    refused = connected(port, "127.0.0.15")
    await until(lambda: is_closed(refused))
    assert len(heard.gone) == 12
    for sock in (*crowd, *others, refused):
        sock.close()
    transport.close()


def is_closed(sock: socket.socket) -> bool:
    try:
        return sock.recv(1) == b""
    except BlockingIOError:
        return False


async def test_it_connects_to_a_listener_and_again_when_that_returns(port: int) -> None:
    transport = client(port)
    heard = Heard(transport)
    await until(lambda: "not connected" in (transport.problem or ""))
    for number in range(2):
        with socket.create_server(("127.0.0.1", port)) as listener:
            listener.setblocking(False)
            await until(lambda: transport.problem is None)
            sock, _ = listener.accept()
            sock.sendall(heartbeat(number))
            await until(lambda: len(heard.data) == len(heard.gone) + 1)
            assert heard.bytes.endswith(heartbeat(number))
            transport.send(demand(number), "whoever")
            sock.settimeout(60)
            assert sock.recv(100) == demand(number)
            sock.close()
        await until(lambda: transport.problem is not None)
        assert len(heard.gone) == number + 1
    transport.close()


async def test_nobody_reads_telemetry_is_dropped_and_the_stop_arrives(listener: socket.socket, port: int) -> None:
    transport = client(port)
    Heard(transport)
    await until(lambda: transport.problem is None)
    sock, _ = listener.accept()
    sock.setblocking(False)
    bulk = frame(Attitude(1, 0.5, 0, 0, 0, 0, 1), 1, 1, 1)
    while transport.dropped < 1000:
        transport.send(bulk, "whoever")
    transport.send(DISARM, "whoever")
    framer = Framer(stream=True)
    found: list[int] = []

    def stop_arrives() -> bool:
        found.extend(message_id for message_id, *_ in framer.feed(received(sock), 0.0))
        return CommandLong.id in found

    await until(stop_arrives)
    assert framer.counts.resync_bytes == 0
    sock.close()
    transport.close()


async def test_no_nagle(server: TcpServerTransport, port: int) -> None:
    heard = Heard(server)
    with connected(port) as sock:
        sock.sendall(heartbeat(0))
        await until(lambda: heard.data)
        [connection] = server._connections.values()
        assert connection._socket.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)
    server.close()


def test_half_frame_of_a_lost_connection_is_no_part_of_the_next() -> None:
    channel = Channel("tcpout:127.0.0.1:5760", 0, system=255, component=190, stream=True, target="there")
    channel.receive(heartbeat(0, system=1), "there", 0.0)
    channel.receive(heartbeat(1, system=1)[:10], "there", 0.0)
    channel.handle_disconnect("there")
    found = channel.receive(heartbeat(2, system=1), "there", 0.1)
    assert [each.sequence for each in found] == [2]
    assert channel.report().resync_bytes == 0


def test_who_comes_after_a_lost_connection_must_introduce_itself() -> None:
    channel = Channel("tcpin:127.0.0.1:5760", 0, system=1, component=1, stream=True)
    channel.receive(heartbeat(0), "one", 0.0)
    assert channel.report().peers == 1
    channel.handle_disconnect("one")
    channel.handle_disconnect("never was")
    assert channel.report().peers == 0
    assert not channel.receive(demand(1), "one", 0.1)[0].introduced
    assert channel.receive(frame(Heartbeat(6, 8, 0, 0, 4, 3), 2), "one", 0.1)[0].introduced


async def test_one_line_says_why_it_cannot_be_opened(listener: socket.socket, port: int) -> None:
    with pytest.raises(LinkError, match=f"port {port} is in use"):
        open_tcpin(parse_endpoint(f"tcpin:127.0.0.1:{port}"))
    with pytest.raises(LinkError, match="is not known"):
        open_tcpout(parse_endpoint("tcpout:no-such-host.invalid:5760"))


async def test_it_does_not_talk_to_itself() -> None:
    # Connecting to a free port of the range that the kernel takes own ports from now and then finds its own end.
    port = free_port()
    own = socket.socket()
    own.bind(("127.0.0.1", port))
    own.connect(("127.0.0.1", port))  # the case, made on purpose
    transport = client(port)
    transport._refused = lambda loop, why: refused.append(why)  # type: ignore[method-assign]
    refused: list[str] = []
    transport._connected(asyncio.get_running_loop(), own)
    assert refused == ["no listener"]
    own.close()


class Names:
    """A name server: what it says can change, and it can be slow or away."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, port: int) -> None:
        self.address: str | None = "127.0.0.1"
        self.port = port
        self.asked = 0
        self.answers = threading.Event()
        self.answers.set()
        monkeypatch.setattr(socket, "getaddrinfo", self._answer)

    def _answer(self, host: str, port: int, *_: object, **__: object) -> list[tuple[object, ...]]:
        if port != self.port:  # a thread of an earlier test's transport
            raise socket.gaierror(socket.EAI_AGAIN, "Temporary failure in name resolution")
        assert host == "rover.example"
        self.asked += 1
        assert self.answers.wait(60)
        if self.address is None:
            raise socket.gaierror(socket.EAI_AGAIN, "Temporary failure in name resolution")
        return [(socket.AF_INET, socket.SOCK_STREAM, 6, "", (self.address, port))]


async def taken(address: str, port: int, transport: TcpClientTransport) -> None:
    """A connection that comes to an address, and ends."""
    with socket.create_server((address, port)):
        await until(lambda: transport.problem is None)
    await until(lambda: transport.problem is not None)


async def test_a_name_that_moves_is_followed(port: int, monkeypatch: pytest.MonkeyPatch) -> None:
    names = Names(monkeypatch, port)
    transport = open_tcpout(parse_endpoint(f"tcpout:rover.example:{port}"))
    Heard(transport)
    await taken("127.0.0.1", port, transport)
    names.address = "127.0.0.2"
    await taken("127.0.0.2", port, transport)
    names.address = None  # where the name is not known any more, the last address counts
    await taken("127.0.0.2", port, transport)
    transport.close()


async def test_a_name_server_that_hangs_delays_no_connection(port: int, monkeypatch: pytest.MonkeyPatch) -> None:
    names = Names(monkeypatch, port)
    transport = open_tcpout(parse_endpoint(f"tcpout:rover.example:{port}"))
    names.answers.clear()
    Heard(transport)
    await until(lambda: names.asked == 2)  # the first was at the start
    await taken("127.0.0.1", port, transport)
    transport.close()
    names.answers.set()


async def test_a_number_is_not_looked_up(port: int, monkeypatch: pytest.MonkeyPatch) -> None:
    transport = client(port)
    names = Names(monkeypatch, port)
    Heard(transport)
    await taken("127.0.0.1", port, transport)
    transport.close()
    assert names.asked == 0
