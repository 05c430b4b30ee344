"""Real sockets on loopback, driven by the runner: delivery, floods, refusals and the end."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import socket
from collections.abc import Callable, Hashable, Iterator, Sequence
from itertools import pairwise
from pathlib import Path

import pytest

from dialects.messages import Heartbeat, ManualControl, Message
from link.core import LinkReport, Outgoing, Received
from link.links import open_links
from link.protocol.log_tap import LogTap
from link.runner import Runner
from link.runtime.multiples import next_multiple
from link.transport.transport import Link
from tests.link.frames import demand, heartbeat
from tests.link.ports import Cable
from tests.ports import free_port

VEHICLE = 1
"""System id."""


class Recorder:
    """A core that notes everything and answers each demand with a heartbeat."""

    def __init__(self, done: Callable[[Recorder], bool], runner: list[Runner]) -> None:
        self.received: list[Received] = []
        self.times: list[float] = []
        self.reports: list[Sequence[LinkReport]] = []
        self.ticks: list[float] = []
        self.numbers: list[tuple[Message, int]] = []
        self.outbox: list[Outgoing] = []
        self._done = done
        self._runner = runner

    def receive(self, received: Received, now: float) -> None:
        self.received.append(received)
        self.times.append(now)
        if isinstance(received.message, ManualControl):
            self.outbox.append(Outgoing(Heartbeat(10, 0, 0, 0, 3, 3)))
        self._check()

    def tick(self, now: float) -> None:
        self.ticks.append(now)
        self._check()

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        self.reports.append(reports)

    def messages_to_send(self) -> list[Outgoing]:
        outbox, self.outbox = self.outbox, []
        return outbox

    def handle_sent(self, message: Message, sequence: int, now: float) -> None:
        self.numbers.append((message, sequence))

    def _check(self) -> None:
        if self._done(self):
            self._runner[0].stop()


async def run(
    endpoint: str | list[str],
    done: Callable[[Recorder], bool],
    *,
    first: Callable[[], None] = lambda: None,
    route: bool | None = None,
) -> Recorder:
    runner: list[Runner] = []
    core = Recorder(done, runner)
    links = open_links([endpoint] if isinstance(endpoint, str) else endpoint, system=1, component=1)
    runner.append(Runner(core, links, period=0.01, route=route))
    first()
    async with asyncio.timeout(60):
        await runner[0].run()
    return core


@pytest.fixture
def ground() -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        sock.settimeout(60)
        yield sock


async def test_udpin_hears_and_answers_whoever_shows_a_heartbeat(ground: socket.socket) -> None:
    port = free_port()

    def speak() -> None:
        for data in (heartbeat(0), demand(1)):
            ground.sendto(data, ("127.0.0.1", port))

    core = await run(f"udpin:127.0.0.1:{port}", lambda core: len(core.received) >= 2, first=speak)
    assert [each.sequence for each in core.received] == [0, 1]
    assert ground.recv(300)[7] == Heartbeat.id
    assert [(type(message), number) for message, number in core.numbers] == [(Heartbeat, 0)]


async def test_udpout_speaks_first_and_survives_nobody_listening(ground: socket.socket) -> None:
    def two_ticks_with_words(core: Recorder) -> bool:
        core.outbox.append(Outgoing(Heartbeat(10, 0, 0, 0, 3, 3)))
        return len(core.ticks) > 5

    await run(f"udpout:127.0.0.1:{free_port()}", two_ticks_with_words)  # every datagram is refused by ICMP
    await run(f"udpout:127.0.0.1:{ground.getsockname()[1]}", two_ticks_with_words)
    assert ground.recv(300)[7] == Heartbeat.id


async def test_the_core_ticks_and_hears_of_its_links_while_flooded(ground: socket.socket) -> None:
    port, filled = free_port(), 0
    frames = [demand(number) for number in range(256)]

    def flood(core: Recorder) -> bool:
        """With each tick four times what is read at once."""
        nonlocal filled
        if len(core.ticks) > filled:
            filled = len(core.ticks)
            for data in frames:
                ground.sendto(data, ("127.0.0.1", port))
        return len(core.ticks) > 50

    core = await run(f"udpin:127.0.0.1:{port}", flood)
    assert len(core.ticks) > 50
    assert core.reports[0][0].name == f"udpin:127.0.0.1:{port}"


async def test_a_port_that_goes_away_and_returns_is_logged_both_times(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """A vehicle without a screen has no other way to say that its port is missing."""
    caplog.set_level(logging.INFO, "link.runner")
    path = tmp_path / "ttyUSB0"
    cables: list[Cable] = []

    def plug_in_when_it_is_missed(core: Recorder) -> bool:
        if core.reports and not cables:
            assert core.reports[0][0].down
            cables.append(Cable(path))
        return "connected" in caplog.text

    await run(f"serial:{path}:57600", plug_in_when_it_is_missed)
    cables[0].unplug()
    assert [(record.levelname, record.message) for record in caplog.records if record.name == "link.runner"] == [
        ("WARNING", f"serial:{path}:57600: waiting for {path}, it is not there; is it plugged in?"),
        ("INFO", f"serial:{path}:57600: connected"),
    ]


async def test_what_the_core_raises_ends_the_run_and_frees_the_port() -> None:
    port = free_port()

    def fail(core: Recorder) -> bool:
        raise ZeroDivisionError("a bug")

    with pytest.raises(ZeroDivisionError, match="a bug"):
        await run(f"udpin:127.0.0.1:{port}", fail)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", port))


async def test_last_words_go_out_after_the_core_has_raised(ground: socket.socket) -> None:
    """Who takes the error himself may speak on, and says when it is over."""
    runner: list[Runner] = []
    errors: list[Exception] = []

    def fail(core: Recorder) -> bool:
        if not errors:
            raise ZeroDivisionError("a bug")
        return len(core.ticks) > 5

    def broken(error: Exception) -> None:
        errors.append(error)
        core.outbox.append(Outgoing(Heartbeat(10, 0, 0, 0, 3, 3)))

    core = Recorder(fail, runner)
    links = open_links([f"udpout:127.0.0.1:{ground.getsockname()[1]}"], system=1, component=1)
    runner.append(Runner(core, links, period=0.01, broken=broken))
    async with asyncio.timeout(60):
        await runner[0].run()
    assert [str(error) for error in errors] == ["a bug"]
    assert ground.recv(300)[7] == Heartbeat.id


async def test_message_that_cannot_be_encoded_is_logged_and_rest_sent(
    ground: socket.socket, caplog: pytest.LogCaptureFixture
) -> None:
    def speak(core: Recorder) -> bool:
        core.outbox += [
            Outgoing(ManualControl(target=1, x=99999, y=0, z=0, r=0, buttons=0)),
            Outgoing(Heartbeat(10, 0, 0, 0, 3, 3)),
        ]
        return len(core.ticks) > 1

    await run(f"udpout:127.0.0.1:{ground.getsockname()[1]}", speak)
    assert ground.recv(300)[7] == Heartbeat.id
    assert "MANUAL_CONTROL" in caplog.text


async def test_each_link_counts_what_it_sends_and_forwards(ground: socket.socket) -> None:
    port = free_port()

    def speak() -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
            other.sendto(heartbeat(0, system=254), ("127.0.0.1", port))

    endpoints = [f"udpin:127.0.0.1:{port}", f"udpout:127.0.0.1:{ground.getsockname()[1]}"]
    core = await run(endpoints, lambda core: len(core.reports) >= 2, first=speak)
    first, second = core.reports[-1]
    assert (first.frames_sent, first.bytes_sent) == (2, 49), "PING and TIMESYNC: does this address receive"
    assert (second.frames_sent, second.bytes_sent) == (1, len(heartbeat(0, system=254)))


@pytest.mark.parametrize("route", [None, False], ids=["by default", "not where it is switched off"])
async def test_ground_stations_on_two_links_hear_each_other(ground: socket.socket, route: bool | None) -> None:
    port = free_port()

    def speak() -> None:  # for everybody, for us alone, for everybody
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
            for data in (heartbeat(0, system=254), demand(1), heartbeat(2, system=254)):
                other.sendto(data, ("127.0.0.1", port))

    endpoints = [f"udpin:127.0.0.1:{port}", f"udpout:127.0.0.1:{ground.getsockname()[1]}"]
    core = await run(endpoints, lambda core: len(core.received) >= 3, first=speak, route=route)
    assert len(core.received) == 3  # what is forwarded is heard here all the same
    ground.settimeout(0.5)
    heard = []
    with contextlib.suppress(TimeoutError):
        while True:
            heard.append(ground.recv(300))
    forwarded = [data for data in heard if data[5] != 1]
    assert forwarded == ([heartbeat(0, system=254), heartbeat(2, system=254)] if route is None else [])


async def test_a_message_that_cannot_be_encoded_is_logged_once(caplog: pytest.LogCaptureFixture) -> None:
    def wrong_then_right(core: Recorder) -> bool:
        core.outbox += [Outgoing(Heartbeat(10, 0, 0, -1, 3, 3)), Outgoing(Heartbeat(10, 0, 0, 0, 3, 3))]
        return len(core.numbers) > 5

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ground:
        ground.bind(("127.0.0.1", 0))
        await run(f"udpout:127.0.0.1:{ground.getsockname()[1]}", wrong_then_right)
    logged = [each for each in caplog.records if "could not be encoded" in each.message]
    assert len(logged) == 1
    assert "HEARTBEAT" in logged[0].message
    assert logged[0].exc_info is None  # one line, no traceback


class Withdrawing(Recorder):
    """A core that withdraws demands in the last moment."""

    def may_send(self, message: Message, now: float) -> bool:
        return not isinstance(message, ManualControl)


async def test_a_withdrawn_message_is_not_sent_and_frames_are_reported(ground: socket.socket) -> None:
    runners: list[Runner] = []
    core = Withdrawing(lambda core: len(core.ticks) > 3, runners)
    core.outbox = [Outgoing(ManualControl(1, 600, 0, 0, 0, 0)), Outgoing(Heartbeat(6, 8, 0, 0, 4, 3))]
    sent: list[tuple[str, Hashable, type[Message], int]] = []

    def record(link: Link, address: Hashable, message: Message, sequence: int, now: float) -> None:
        sent.append((link.endpoint.text, address, type(message), sequence))

    endpoint = f"udpout:127.0.0.1:{ground.getsockname()[1]}"
    links = open_links([endpoint], system=255, component=190)
    runners.append(Runner(core, links, period=0.01, sent=record))
    await runners[0].run()
    assert ground.recv(300)[7] == Heartbeat.id
    assert sent == [(endpoint, endpoint, Heartbeat, 1)]
    assert [type(message) for message, _ in core.numbers] == [Heartbeat]


STOOD = 0.5
"""s."""


class StoppedWhileAsked(Recorder):
    """A core whose process stands still for STOOD during its first answer, and that withdraws what is older."""

    def __init__(self, runner: list[Runner], loop: asyncio.AbstractEventLoop, monkeypatch: pytest.MonkeyPatch) -> None:
        super().__init__(lambda core: len(core.ticks) > 3, runner)
        self.asked: list[float] = []
        self._late, real = 0.0, loop.time
        monkeypatch.setattr(loop, "time", lambda: real() + self._late)

    def may_send(self, message: Message, now: float) -> bool:
        self.asked.append(now)
        self._late = STOOD
        return now - self.asked[0] < STOOD


async def test_a_process_stopped_during_the_last_check_sends_nothing(
    ground: socket.socket, monkeypatch: pytest.MonkeyPatch
) -> None:
    runners: list[Runner] = []
    core = StoppedWhileAsked(runners, asyncio.get_running_loop(), monkeypatch)
    core.outbox = [Outgoing(ManualControl(1, 600, 0, 0, 0, 0))]
    links = open_links([f"udpout:127.0.0.1:{ground.getsockname()[1]}"], system=255, component=190)
    runners.append(Runner(core, links, period=0.01))
    await runners[0].run()
    assert len(core.asked) == 2
    assert core.numbers == []


async def test_frames_returned_by_a_program_with_two_links_are_our_own() -> None:
    """A ground station forwards what arrives on one link to the other, until it has seen the vehicle there as well."""
    ports = free_port(), free_port()
    runners: list[Runner] = []
    returned: list[bytes] = []

    def frames_arrived(_: float, frames: Sequence[bytes]) -> None:
        returned.extend(frame for frame in frames if frame[5] == VEHICLE)

    def beat(core: Recorder) -> bool:
        core.outbox.append(Outgoing(Heartbeat(10, 0, 0, 0, 3, 3)))
        if len(core.reports) > 1 and len(core.received) > 20:
            for runner in runners:
                runner.stop()
        return False

    cores = []
    for name, system in (("udpin", VEHICLE), ("udpout", 255)):
        links = open_links([f"{name}:127.0.0.1:{port}" for port in ports], system=system, component=1)
        tap = LogTap(frames_arrived, system=9, component=1) if system == VEHICLE else None
        cores.append(Recorder(beat, runners))
        runners.append(Runner(cores[-1], links, period=0.01, log_tap=tap))
    async with asyncio.timeout(60):
        await asyncio.gather(*(runner.run() for runner in runners))
    assert returned
    assert not any(report.own_id for core in cores for reports in core.reports for report in reports)


REST_PERIOD = 0.1


class Resting(Recorder):
    """A core that has nothing to do until a message has come."""

    @property
    def rest_period(self) -> float | None:
        return None if self.received else REST_PERIOD


async def test_resting_core_is_ticked_less_often_until_a_message_comes(ground: socket.socket) -> None:
    port, runner = free_port(), list[Runner]()

    def done(core: Recorder) -> bool:
        if len(core.ticks) == 4:
            ground.sendto(heartbeat(0), ("127.0.0.1", port))
        return bool(core.received) and len(core.ticks) >= 30

    core = Resting(done, runner)
    runner.append(Runner(core, open_links([f"udpin:127.0.0.1:{port}"], system=1, component=1), period=0.01))
    async with asyncio.timeout(60):
        await runner[0].run()
    gaps = [later - earlier for earlier, later in pairwise(core.ticks)]
    assert max(gaps[1:3]) > 0.5 * REST_PERIOD
    assert min(gaps[6:]) < 0.5 * REST_PERIOD


class Woken(Recorder):
    """A core that has something to do for one tick after each message."""

    @property
    def rest_period(self) -> float | None:
        return REST_PERIOD if not self.times or self.ticks[-1] > self.times[-1] else None


async def test_a_message_ends_the_rest_of_a_core_at_once(ground: socket.socket) -> None:
    port, runner = free_port(), list[Runner]()

    def done(core: Recorder) -> bool:
        if len(core.ticks) > len(core.received):
            asyncio.get_running_loop().call_soon(ground.sendto, heartbeat(len(core.ticks)), ("127.0.0.1", port))
        return len(core.ticks) > 10

    core = Woken(done, runner)
    runner.append(Runner(core, open_links([f"udpin:127.0.0.1:{port}"], system=1, component=1), period=10.0))
    async with asyncio.timeout(60):
        await runner[0].run()
    waited = [min(tick for tick in core.ticks if tick > time) - time for time in core.times]
    assert min(waited[2:]) < 0.5 * REST_PERIOD


def test_what_has_one_period_is_done_at_one_waking() -> None:
    assert next_multiple(0.1, 12.34) == pytest.approx(12.4)
    assert next_multiple(0.1, 12.4) == pytest.approx(12.5)
    assert next_multiple(0.1, 12.39999) == pytest.approx(12.5), "a timer that came a moment early"


async def test_messages_that_are_read_together_have_times_of_their_own(ground: socket.socket) -> None:
    port = free_port()

    def speak() -> None:
        for number in range(8):
            ground.sendto(heartbeat(number), ("127.0.0.1", port))

    core = await run(f"udpin:127.0.0.1:{port}", lambda core: len(core.received) >= 8, first=speak)
    assert core.times == sorted(set(core.times)), "a ramp needs time to move"


class Early(Recorder):
    """A core that has something to do `AFTER` s after each tick, and says so."""

    AFTER = 0.05

    def __init__(self, done: Callable[[Recorder], bool], runner: list[Runner]) -> None:
        super().__init__(done, runner)
        self.acts: list[float] = []
        self.due_at: float | None = None

    def tick(self, now: float) -> None:
        super().tick(now)
        self.due_at = now + self.AFTER

    def act(self, now: float) -> None:
        self.acts.append(now)
        self.due_at = now + self.AFTER if len(self.acts) < 3 else None
        self.outbox.append(Outgoing(Heartbeat(10, 0, 0, 0, 3, 3)))


async def test_what_is_due_before_the_next_tick_is_done_then_and_sent(ground: socket.socket) -> None:
    runner: list[Runner] = []
    core = Early(lambda _: False, runner)
    links = open_links([f"udpout:127.0.0.1:{ground.getsockname()[1]}"], system=1, component=1)
    runner.append(Runner(core, links, period=60.0))
    running = asyncio.create_task(runner[0].run())
    frames = [await asyncio.to_thread(ground.recv, 300) for _ in range(3)]
    runner[0].stop()
    await running
    assert [frame[7] for frame in frames] == [Heartbeat.id] * 3
    assert len(core.ticks) == 1
    gaps = [later - earlier for earlier, later in pairwise([core.ticks[0], *core.acts])]
    assert all(gap >= Early.AFTER - 1e-6 for gap in gaps), gaps
    assert len(core.acts) == 3, "and then nothing more is due"


async def test_the_core_is_told_what_its_role_does_not_allow() -> None:
    """Of two links one refuses demands: a message that the other one has taken is not refused."""
    refused: list[tuple[Message, str]] = []
    port, other = free_port(), free_port()

    class Listener(Recorder):
        def handle_refused(self, message: Message, why: str, now: float) -> None:
            refused.append((message, why))

    async def send(message: Message, *endpoints: str) -> None:
        runner: list[Runner] = []
        core = Listener(lambda core: len(core.ticks) >= 3, runner)
        links = open_links(endpoints, system=255, component=190)
        links[0].refusal = lambda data: "may not" if data[7] == ManualControl.id else None
        runner.append(Runner(core, links, period=0.01, route=False))
        core.outbox.append(Outgoing(message))
        await runner[0].run()

    steer, beat = ManualControl(1, 100, 0, 0, 0, 0), Heartbeat(6, 8, 0, 0, 4, 3)
    await send(beat, f"udpout:127.0.0.1:{port}")
    await send(steer, f"udpout:127.0.0.1:{port}", f"udpout:127.0.0.1:{other}")
    assert refused == []
    await send(steer, f"udpout:127.0.0.1:{port}")
    assert refused == [(steer, "may not")]


class Looking(Recorder):
    """A core that looks at one vehicle after the other."""

    @property
    def interesting_systems(self) -> frozenset[int] | None:
        return frozenset((len(self.ticks) // 10,))


async def test_a_link_that_can_choose_is_told_the_selected_vehicles() -> None:
    runner, told, late = list[Runner](), list[object](), list[object]()
    core = Looking(lambda core: len(core.ticks) >= 25, runner)
    links = open_links([f"udpin:127.0.0.1:{free_port()}" for _ in range(3)], system=1, component=1)
    links[0].transport.set_interest = told.append  # type: ignore[attr-defined]
    links[1].transport.set_interest = late.append  # type: ignore[attr-defined]
    runner.append(Runner(core, [links[0], links[2]], period=0.01))
    added = asyncio.get_running_loop().call_later(0.05, lambda: runner[0].add(links[1]))
    async with asyncio.timeout(60):
        await runner[0].run()
    assert added.when() > 0
    assert told == [None, frozenset((0,)), frozenset((1,)), frozenset((2,))]
    assert late == told[-len(late) :]
