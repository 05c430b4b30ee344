"""The network between two real programs: a UDP relay on loopback that loses, delays, cuts and records frames."""

from __future__ import annotations

import selectors
import socket
import threading
import time
from collections.abc import Callable
from typing import NamedTuple, TypeVar

from dialects import codec
from dialects.axes import parse_manual_control
from dialects.enums import ModeFlag
from dialects.messages import Heartbeat, LocalPositionNed, ManualControl, Message, StatusText, decode_text
from link.protocol.framer import Framer
from link.transport.memory import LossyPipe
from tests.ports import free_port
from tests.waits import Patience

STEP = 0.005
"""s at most between two polls of the delayed frames."""


Kind = TypeVar("Kind", bound=Message)


class Seen(NamedTuple):
    """A message that passed the relay, with its time and sender."""

    at: float
    system: int
    message: Message


class Relay:
    """Relay between a vehicle (`udpout` to `vehicle_side`) and a ground station (`udpin` on `ground_port`)."""

    def __init__(self, *, loss: float = 0.0, delay: float = 0.0) -> None:
        self.up = LossyPipe[bytes](loss=loss, delay=delay, seed=1)
        self.down = LossyPipe[bytes](loss=loss, delay=delay, seed=2)
        self._vehicle_socket = _bound()
        self._ground_socket = _bound()
        self.vehicle_port: int = self._vehicle_socket.getsockname()[1]
        self.ground_port = free_port()
        self._vehicle_address: tuple[str, int] | None = None
        self._changed = threading.Condition()
        self._seen: list[Seen] = []
        self._delivered: list[Seen] = []
        self._running = True
        self._thread = threading.Thread(target=self._run, name="relay", daemon=True)
        self._thread.start()

    def cut(self, cut: bool = True) -> None:
        """Cut both directions, or connect them again."""
        self.up.cut = self.down.cut = cut

    def close(self) -> None:
        """Close the relay."""
        self._running = False
        self._thread.join(5)
        self._vehicle_socket.close()
        self._ground_socket.close()

    # ---- recorded frames ----

    def wait(self, condition: Callable[[], bool], within: float, what: str) -> float:
        """Wait until `condition`; return when it became true (monotonic). An AssertionError names `what`."""
        patience = Patience(within)
        with self._changed:
            while not condition():
                assert not patience.ended, f"not within {within} s: {what}; last texts: {self.texts()[-5:]}"
                self._changed.wait(STEP)
        return time.monotonic()

    def newest(self, kind: type[Kind], system: int = 1) -> Kind | None:
        """Return the newest message of a kind from `system`."""
        for seen in reversed(self._seen):
            if seen.system == system and isinstance(seen.message, kind):
                return seen.message
        return None

    def armed(self) -> bool:
        """Return whether the vehicle is armed, by its newest HEARTBEAT."""
        beat = self.newest(Heartbeat)
        return beat is not None and bool(beat.base_mode & ModeFlag.ARMED)

    def mode(self) -> int | None:
        """Return custom_mode of the vehicle's newest HEARTBEAT."""
        beat = self.newest(Heartbeat)
        return None if beat is None else int(beat.custom_mode)

    def position(self) -> tuple[float, float]:
        """Return the newest position of the vehicle, m to the north and east."""
        where = self.newest(LocalPositionNed)
        return (0.0, 0.0) if where is None else (where.x, where.y)

    def texts(self) -> list[str]:
        """Return the texts of the vehicle."""
        return [decode_text(seen.message) for seen in list(self._seen) if isinstance(seen.message, StatusText)]

    def last_demand(self) -> float:
        """Return when a MANUAL_CONTROL that requests motion was last delivered to the vehicle (monotonic); 0.0 if
        never."""
        return max((seen.at for seen in list(self._delivered) if _asks_for_motion(seen.message)), default=0.0)

    def demands_since(self, at: float) -> list[ManualControl]:
        """Return every MANUAL_CONTROL that the ground station has sent since `at`, delivered or not."""
        return [s.message for s in list(self._seen) if s.at >= at and isinstance(s.message, ManualControl)]

    def neutral_since(self, at: float) -> int:
        """Return the number of neutral MANUAL_CONTROL that the ground station has sent since `at`."""
        return sum(not _asks_for_motion(message) for message in self.demands_since(at))

    def newest_demand_is_neutral(self) -> bool:
        """Return whether the last MANUAL_CONTROL of the ground station was neutral."""
        newest = self.newest(ManualControl, system=255)
        return newest is not None and not _asks_for_motion(newest)

    # ---- forwarding ----

    def _run(self) -> None:
        watch = selectors.DefaultSelector()
        watch.register(self._vehicle_socket, selectors.EVENT_READ, self._from_vehicle)
        watch.register(self._ground_socket, selectors.EVENT_READ, self._from_ground)
        while self._running:
            for key, _ in watch.select(STEP):
                key.data()
            now = time.monotonic()
            for data in self.up.receive(now):
                self._note(self._delivered, data)
                if self._vehicle_address:
                    self._vehicle_socket.sendto(data, self._vehicle_address)
            for data in self.down.receive(now):
                self._ground_socket.sendto(data, ("127.0.0.1", self.ground_port))
            with self._changed:
                self._changed.notify_all()

    def _from_vehicle(self) -> None:
        data, self._vehicle_address = self._vehicle_socket.recvfrom(65536)
        self._note(self._seen, data)
        self.down.send(data, time.monotonic())

    def _from_ground(self) -> None:
        try:
            data, _ = self._ground_socket.recvfrom(65536)
        except ConnectionRefusedError:
            return  # the ground station is gone
        self._note(self._seen, data)
        self.up.send(data, time.monotonic())

    @staticmethod
    def _note(book: list[Seen], data: bytes) -> None:
        now = time.monotonic()
        frames = Framer(stream=False).feed(data, now)
        book += [Seen(now, system, codec.decode_frame(number, raw)) for number, system, *_, raw in frames]


def _asks_for_motion(message: Message) -> bool:
    return isinstance(message, ManualControl) and any(parse_manual_control(message))


def _bound() -> socket.socket:
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.bind(("127.0.0.1", 0))
    return sock
