"""Frames that range sensors send on their serial lines, and the far end of such a line."""

from __future__ import annotations

import contextlib
import os
import pty
import threading
import tty
from collections.abc import Callable, Sequence
from types import TracebackType

from vehicle.sensors.ranging.ld06 import PACKET, POINTS, crc8


def tfmini_frame(centimetres: int, strength: int = 1000) -> bytes:
    body = b"\x59\x59" + b"".join(value.to_bytes(2, "little") for value in (centimetres, strength, 2500))
    return body + bytes([sum(body) & 0xFF])


def ld06_packet(first: float, millimetres: Sequence[int], *, span: float = 8.8, intensity: int = 200) -> bytes:
    """`first` and `span` in degrees; a distance of 0 is a direction without an echo."""
    points = [value for each in millimetres for value in (each, intensity if each else 0)]
    last = round(100 * (first + span)) % 36000
    body = b"\x54\x2c" + PACKET.pack(3600, round(100 * first), *points, last, 0, 0)[2:-1]
    return body + bytes([crc8(body)])


def ld06_turn(distance: Callable[[float], float]) -> bytes:
    """One turn; `distance` in m by the angle in degrees, 0 without an echo."""
    step = 9.6
    packets = []
    for packet in range(round(360 / step)):
        angles = [(packet * step + index * step / POINTS) % 360 for index in range(POINTS)]
        millimetres = [round(1000 * distance(angle)) for angle in angles]
        packets.append(ld06_packet(packet * step % 360, millimetres))
    return b"".join(packets)


class Line:
    """A sensor at the far end of a real terminal line: it sends what `frame` returns, again and again."""

    def __init__(self, frame: Callable[[], bytes], period: float = 0.01) -> None:
        self.frame = frame
        self._period = period
        self._master, self._slave = pty.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self.path = os.ttyname(self._slave)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> Line:
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:  # fmt: skip
        self._ended.set()
        self._thread.join()
        for descriptor in (self._master, self._slave):
            os.close(descriptor)

    def _run(self) -> None:
        while not self._ended.wait(self._period):
            with contextlib.suppress(BlockingIOError):  # nobody reads
                os.write(self._master, self.frame())
