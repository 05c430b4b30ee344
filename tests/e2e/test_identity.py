"""Who drives, with the real vehicle over real sockets: second links, twins, old frames, a killed driver.

The same programs as in tests/vehicle/test_identity.py, in real time. "Foreign": a ground station without sessions.
"""

from __future__ import annotations

import select
import socket
import time
from collections import deque
from collections.abc import Callable, Hashable, Iterator
from contextlib import ExitStack, suppress
from pathlib import Path

import pytest

from dialects import codec
from dialects import messages as m
from dialects.axes import Axes
from dialects.modes import Mode
from link.protocol.framer import Framer
from tests.e2e.programs import PATIENT_LOOP, Vehicle
from tests.ports import free_port
from tests.vehicle.wires import Program, SessionProgram
from tests.waits import PATIENCE, Patience

pytestmark = pytest.mark.slow

AHEAD, BACK, NEUTRAL = Axes(throttle=1.0), Axes(throttle=-1.0), Axes()
KINDS = [Program, SessionProgram]
STEP = 0.02
TRY = 5.0
"""s for demands to turn the wheels; then the driver begins anew, as after a demand that was late."""


class SocketWires:
    """A vehicle process with two UDP ports, and a socket for each address that programs speak from."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        self.ports = [free_port() for _ in range(2)]
        first, second = (f"udpin:127.0.0.1:{port}" for port in self.ports)
        self.vehicle = Vehicle(folder, first, second, "--param", PATIENT_LOOP)
        stack.callback(self.vehicle.end)
        self.sent: list[tuple[Hashable, m.Message]] = []
        """Address -> what the vehicle has sent there."""
        self.boot_ms: tuple[float, int] | None = None
        """Newest time of the vehicle, and when it came."""
        self._stack = stack
        self._sockets: dict[Hashable, socket.socket] = {}
        self._late: deque[tuple[float, bytes, Hashable, int]] = deque()
        self._framer = Framer(stream=False)

    @property
    def now(self) -> float:
        return time.monotonic()

    def put(self, data: bytes, address: Hashable, link: int = 0, delay: float = 0.0) -> None:
        """Send a datagram, `delay` s from now."""
        if delay:
            self._late.append((self.now + delay, data, address, link))
        else:
            self._socket(address).sendto(data, ("127.0.0.1", self.ports[link]))

    def wait(self, seconds: float, each: Callable[[float], None] | None = None) -> None:
        """Let programs speak for a while: `each` is called every 20 ms."""
        end = self.now + seconds
        while (now := self.now) < end:
            if each:
                each(now)
            while self._late and self._late[0][0] <= now:
                _, data, address, link = self._late.popleft()
                self._socket(address).sendto(data, ("127.0.0.1", self.ports[link]))
            self._read(now + STEP)

    def until(self, condition: Callable[[], bool], each: Callable[[float], None], within: float = PATIENCE) -> None:
        """Let programs speak until `condition`."""
        patience = Patience(within, self.vehicle.process.pid)
        while not condition():
            assert not patience.ended, self.vehicle.errors.read_text()
            self.wait(0.1, each)

    def _socket(self, address: Hashable) -> socket.socket:
        if address not in self._sockets:
            opened = self._stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
            opened.bind(("127.0.0.1", 0))
            self._sockets[address] = opened
        return self._sockets[address]

    def _read(self, until: float) -> None:
        while (left := until - self.now) > 0:
            ready, _, _ = select.select(list(self._sockets.values()), [], [], left)
            for each in ready:
                self._take(each)

    def _take(self, ready: socket.socket) -> None:
        try:
            data = ready.recv(2048)
        except ConnectionRefusedError:  # the vehicle has not opened its port yet
            return
        address = next(name for name, each in self._sockets.items() if each is ready)
        for number, _, _, _, raw in self._framer.feed(data, self.now):
            message = codec.decode_frame(number, raw)
            self.sent.append((address, message))
            if isinstance(message, m.RoverDriveStatus):
                self.boot_ms = (self.now, message.time_boot_ms)


class LiveSession(SessionProgram):
    """Echoes the time of the real vehicle."""

    def build(self, axes: Axes | None, *, age: float = 0.02) -> m.RoverOperatorPresence:
        proof = super().build(axes)
        assert isinstance(self.wires, SocketWires)
        proof.echo_time_boot_ms = self.wires.boot_ms[1] if self.wires.boot_ms else 0
        return proof


@pytest.fixture
def wires(tmp_path: Path) -> Iterator[SocketWires]:
    """A vehicle that hears the programs."""
    with ExitStack() as stack:
        yield SocketWires(tmp_path, stack)


def program(wires: SocketWires, kind: type[Program], address: str, **how: float) -> Program:
    """A program of a kind on these wires."""
    actual = LiveSession if kind is SessionProgram else kind
    return actual(wires, address, **how)  # type: ignore[arg-type]


def driving(wires: SocketWires, kind: type[Program]) -> Program:
    """A driver at full throttle, so that each test begins with wheels that turn."""
    driver = program(wires, kind, "gcs")
    wires.until(lambda: any(isinstance(each, m.Heartbeat) for _, each in wires.sent), lambda now: driver.step(None))
    wires.until(lambda: wires.boot_ms is not None or kind is Program, lambda now: driver.step(None))
    driver.hold(1.0, None)

    def ask(now: float) -> None:
        driver.step(None)
        driver.arm()

    wires.until(lambda: armed(wires), ask)
    driver.hold(0.5, NEUTRAL)
    go(wires, driver, wires.vehicle.at_full, lambda now: driver.step(AHEAD))
    return driver


def go(wires: SocketWires, driver: Program, condition: Callable[[], bool], each: Callable[[float], None]) -> None:
    """Drive until `condition`. What ends on a late machine is begun anew, as a person does: armed, MANUAL, neutral."""
    patience = Patience(PATIENCE, wires.vehicle.process.pid)
    while not condition():
        assert not patience.ended, wires.vehicle.errors.read_text()
        with suppress(AssertionError):
            wires.until(condition, each, TRY)
            return
        if not armed(wires):
            driver.arm()
        if mode(wires) is Mode.HOLD:
            driver.set_mode(Mode.MANUAL)
        driver.hold(0.6, NEUTRAL)


def armed(wires: SocketWires) -> bool:
    beats = [each for _, each in wires.sent if isinstance(each, m.Heartbeat)]
    return bool(beats) and bool(beats[-1].base_mode & 128)


def stop(wires: SocketWires, driver: Program) -> float:
    """Let go; return when the wheels stood."""
    wires.until(wires.vehicle.stands, lambda now: driver.step(NEUTRAL))
    return wires.now


def both(first: Program, one: Axes, second: Program, other: Axes) -> Callable[[float], None]:
    """Return a step of two programs side by side."""

    def each(now: float) -> None:
        first.step(one)
        second.step(other, 23.0)

    return each


@pytest.mark.parametrize("kind", KINDS)
def test_a_late_second_link_drives_nothing(wires: SocketWires, kind: type[Program]) -> None:
    driver = driving(wires, kind)
    late = program(wires, kind, "gcs by the slow link", link=1, delay=1.5, number=77)

    wires.wait(3.0, both(driver, AHEAD, late, AHEAD))
    stood = stop(wires, driver)
    wires.wait(3.0, both(driver, NEUTRAL, late, NEUTRAL))
    assert not wires.vehicle.moved_since(stood)
    go(wires, driver, wires.vehicle.turning, both(driver, AHEAD, late, AHEAD))


@pytest.mark.parametrize("address", ["gcs", "elsewhere"])
@pytest.mark.parametrize("kind", KINDS)
def test_a_twins_neutral_unlocks_no_stick_that_is_held(wires: SocketWires, kind: type[Program], address: str) -> None:
    driver = driving(wires, kind)
    stop(wires, driver)
    driver.set_mode(Mode.HOLD)
    wires.until(lambda: mode(wires) is Mode.HOLD, lambda now: driver.step(AHEAD))
    driver.set_mode(Mode.MANUAL)  # neutral first
    at = wires.now
    twin = program(wires, Program, address, number=(driver.number + 128) & 0xFF)
    wires.wait(5.0, both(driver, AHEAD, twin, NEUTRAL))
    assert mode(wires) is Mode.MANUAL
    assert not wires.vehicle.moved_since(at)
    wires.wait(1.0, lambda now: driver.step(NEUTRAL))
    go(wires, driver, wires.vehicle.turning, lambda now: driver.step(AHEAD))


@pytest.mark.parametrize("kind", KINDS)
def test_a_twin_does_not_keep_a_killed_driver_self_driving_alive(wires: SocketWires, kind: type[Program]) -> None:
    driver = driving(wires, kind)
    stop(wires, driver)
    driver.set_mode(Mode.GUIDED)
    velocity = m.SetPositionTargetLocalNed(0, 1, 1, 8, 0x5C7, 0, 0, 0, 1.0, 0, 0, 0, 0, 0, 0, 0)

    def guide(now: float) -> None:
        driver.step(NEUTRAL)
        driver.send(velocity)

    wires.until(wires.vehicle.turning, guide)
    twin = program(wires, Program, "elsewhere", number=128)
    wires.until(wires.vehicle.stands, lambda now: twin.step(None))
    wires.until(lambda: mode(wires) is Mode.HOLD, lambda now: twin.step(None))


def mode(wires: SocketWires) -> Mode:
    return Mode(next(each.custom_mode for _, each in reversed(wires.sent) if isinstance(each, m.Heartbeat)))


@pytest.mark.parametrize("address", ["gcs", "elsewhere"])
@pytest.mark.parametrize("kind", KINDS)
def test_old_frames_that_come_again_move_nothing(wires: SocketWires, kind: type[Program], address: str) -> None:
    driver = driving(wires, kind)
    wires.wait(1.0, lambda now: driver.step(AHEAD))
    old = [data for _, data in driver.frames[-30:]]
    stood = stop(wires, driver)
    for rate in (1000.0, 20.0):
        for number, data in enumerate(old):
            wires.put(data, address, delay=0.001 + number / rate)
        wires.wait(len(old) / rate + 0.5, lambda now: driver.step(NEUTRAL))
    assert not wires.vehicle.moved_since(stood)
    go(wires, driver, wires.vehicle.turning, lambda now: driver.step(AHEAD))
