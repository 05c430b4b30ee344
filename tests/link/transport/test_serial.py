"""Serial ports on real ptys: missing, unplugged, taken, noisy, unread, slow."""

from __future__ import annotations

import asyncio
import subprocess
import sys
import termios
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from dialects.messages import Attitude, CommandLong, ManualControl
from link.endpoint import parse_endpoint
from link.protocol.framer import Framer
from link.transport.serial import SerialTransport, open_serial
from link.transport.transport import LinkError
from tests.link.frames import demand, frame, heartbeat
from tests.link.ports import BaudCable, Cable, Heard
from tests.waits import until

DISARM = frame(CommandLong(1, 1, 400, 0, 0, 0, 0, 0, 0, 0, 0), 9)


@pytest.fixture
def cable(tmp_path: Path) -> Iterator[Cable]:
    cable = Cable(tmp_path / "ttyUSB0")
    yield cable
    cable.unplug()


def opened(endpoint: str) -> SerialTransport:
    return open_serial(parse_endpoint(endpoint))


async def comes(cable: Cable, data: bytes) -> None:
    """This and nothing else comes at the far end: the kernel hands it over when it has the time."""
    found = b""

    def read() -> bool:
        nonlocal found
        found += cable.read()
        return len(found) >= len(data)

    await until(read)
    assert found == data


def attitude(number: int) -> bytes:
    return frame(Attitude(number, 0.5, 0.1, 0.2, 0.3, 0.4, 1), number % 256, 1, 1)


# ---- opening ----


async def test_bytes_go_both_ways(cable: Cable) -> None:
    transport = opened(cable.endpoint)
    heard = Heard(transport)
    cable.write(heartbeat(0))
    await until(lambda: heard.bytes == heartbeat(0))
    assert heard.data[0][1] == cable.endpoint
    transport.send(demand(1), cable.endpoint)
    await comes(cable, demand(1))
    transport.close()
    assert transport.capacity == 5760.0


@pytest.mark.parametrize(
    ("path", "told"),
    [
        ("/tmp", "not a serial port but a file or directory"),
        ("/etc/hostname", "not a serial port but a file or directory"),
        ("/dev/null", "/dev/null is not a serial port"),
    ],
)
def test_what_can_never_be_a_port_is_refused_in_one_line(path: str, told: str) -> None:
    with pytest.raises(LinkError) as caught:
        opened(f"serial:{path}:57600")
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_second_program_on_the_port_is_refused(cable: Cable) -> None:
    first = opened(cable.endpoint)
    code = f"from link.transport.transports import open_transports\nopen_transports([{cable.endpoint!r}])"
    second = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=False)
    assert "another program uses" in second.stderr.splitlines()[-1]
    first.close()
    opened(cable.endpoint).close()


async def test_a_missing_port_is_waited_for(tmp_path: Path) -> None:
    path = tmp_path / "ttyUSB7"
    transport = opened(f"serial:{path}:57600")
    assert "waiting for" in (transport.problem or "")
    heard = Heard(transport)
    transport.send(demand(1), "anywhere")  # into nothing: it would be old by the time the port is there
    cable = Cable(path)
    await until(lambda: transport.problem is None)
    cable.write(heartbeat(3))
    await until(lambda: heard.bytes == heartbeat(3))
    assert cable.read() == b""
    transport.close()
    cable.unplug()


async def test_unplugged_and_plugged_in_again(cable: Cable) -> None:
    transport = opened(cable.endpoint)
    heard = Heard(transport)
    cable.write(heartbeat(0))
    await until(lambda: heard.bytes == heartbeat(0))
    cable.unplug()
    await until(lambda: transport.problem is not None)
    assert "lost the port" in (transport.problem or "")
    assert heard.gone == [cable.endpoint]
    transport.send(demand(1), cable.endpoint)
    cable.plug()
    await until(lambda: transport.problem is None)
    cable.write(heartbeat(1))
    await until(lambda: heard.bytes.endswith(heartbeat(1)))
    transport.send(demand(2), cable.endpoint)
    await comes(cable, demand(2))
    transport.close()


async def test_taken_by_another_while_it_was_away(cable: Cable) -> None:
    transport = opened(cable.endpoint)
    Heard(transport)
    cable.unplug()
    await until(lambda: transport.problem is not None)
    cable.plug()
    thief = opened(cable.endpoint)
    await until(lambda: "another program" in (transport.problem or ""))
    thief.close()
    await until(lambda: transport.problem is None)
    transport.close()


@pytest.mark.parametrize("step", ["tcsetattr", "tcflush"])
async def test_gone_again_while_it_is_set_up(cable: Cable, monkeypatch: pytest.MonkeyPatch, step: str) -> None:
    transport = opened(cable.endpoint)
    Heard(transport)
    cable.unplug()
    await until(lambda: transport.problem is not None)
    real, failures = getattr(termios, step), [5, 5]

    def flapping(*words: Any) -> None:  # a loose plug: no pty goes away between two calls of the same function
        if failures:
            raise termios.error(failures.pop(), "Input/output error")
        real(*words)

    monkeypatch.setattr(termios, step, flapping)
    cable.plug()
    await until(lambda: transport.problem is None)
    assert not failures
    transport.close()


def test_a_port_that_cannot_be_set_up_is_refused_in_one_line(cable: Cable, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*words: Any) -> None:
        raise termios.error(22, "Invalid argument")

    monkeypatch.setattr(termios, "tcsetattr", refused)
    with pytest.raises(LinkError, match=r"^serial:\S+: Invalid argument$"):
        opened(cable.endpoint)


# ---- writing ----


async def test_nobody_reads_telemetry_is_dropped_and_the_stop_arrives(cable: Cable) -> None:
    # Enough to fill the pty and the queue many times over; a blocking writer would hang here for ever.
    transport = opened(cable.endpoint.replace("57600", "12000000"))
    Heard(transport)
    for number in range(20_000):
        transport.send(attitude(number), cable.endpoint)
    await until(lambda: transport.dropped > 1000)
    transport.send(DISARM, cable.endpoint)
    framer = Framer(stream=True)
    found: list[int] = []

    def stop_arrives() -> bool:
        found.extend(message_id for message_id, *_ in framer.feed(cable.read(), 0.0))
        return CommandLong.id in found

    await until(stop_arrives)
    assert framer.counts.crc_errors == framer.counts.resync_bytes == 0  # and no frame was cut in half
    transport.close()


async def test_a_demand_overtakes_bulk_within_30_ms_of_bytes(tmp_path: Path) -> None:
    cable = BaudCable(tmp_path / "ttyUSB0", 57600)
    transport = opened(cable.endpoint)
    Heard(transport)
    loop = asyncio.get_running_loop()
    begun, ahead = loop.time(), list[int]()

    def bulk(number: int) -> None:  # twice what the transport can take
        transport.send(attitude(number), cable.endpoint)
        transport.send(attitude(number + 1), cable.endpoint)
        if number % 50 == 0:
            cable.pass_on()  # what a loop that was held up has not passed yet
            before = len(cable.received) + cable.waiting
            transport.send(demand(number % 256), cable.endpoint)
            ahead.append(before - len(cable.received))
        loop.call_at(begun + 0.003 * (number + 2), bulk, number + 2)  # however late this one is

    bulk(0)
    await until(lambda: len(ahead) >= 12)
    await until(lambda: _demands(cable.received) >= 11)
    assert transport.dropped > 100
    assert max(ahead[1:]) <= 0.030 * 5760
    assert _demands(cable.received) >= 11
    transport.close()
    cable.unplug()


def _demands(data: bytes) -> int:
    return sum(message_id == ManualControl.id for message_id, *_ in Framer(stream=True).feed(data, 0.0))
