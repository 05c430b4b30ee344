"""A serial cable between two programs as a process: two ptys, connected at the pace of a baud rate in both directions.

A byte arrives after the wire time of everything before it and its own. What the wire has not taken yet stays in the
pty, as in the driver of a real port. SIGUSR1 turns a second ground station on that line on and off: it requests bulk
data again and again (line_load.py), between the frames of the first. Each time the cable prints its totals.

Usage: python -m tests.benchmarks.baud_cable PATH_OF_VEHICLE PATH_OF_GROUND BAUD NOISE (0..1)
"""

from __future__ import annotations

import contextlib
import os
import pty
import random
import select
import signal
import sys
import time
import tty
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any

from dialects import codec
from dialects.messages import RoverOperatorPresence
from link.protocol.framer import Framer
from tests.benchmarks.line_load import Requester

BITS_PER_BYTE = 10
"""8 data bits, one start and one stop bit."""
CHUNK = 0.001
"""s of wire time that passes in one piece: a wake-up for each byte costs too much, more would blur where frames end."""
COPIED_WITHIN = 35
"""ms from a change to its last copy; the next regular demand follows after 50 ms."""
HEAD, FRAME, SIGNATURE = 3, 12, 13
"""Bytes of a MAVLink 2 frame: up to its flags, around its payload, of a signature."""


class Boundary:
    """Follows the frames of a stream to know where one ends."""

    def __init__(self) -> None:
        self._head = b""
        self._left = 0

    @property
    def between(self) -> bool:
        """True when the next byte begins a frame."""
        return not self._head and not self._left

    def follow(self, data: bytes) -> None:
        """Follow these bytes."""
        while data:
            size = min(self._left or HEAD - len(self._head), len(data))
            piece, data = data[:size], data[size:]
            if self._left:
                self._left -= size
                continue
            self._head += piece
            if len(self._head) == HEAD:
                self._left = self._head[1] + FRAME + SIGNATURE * (self._head[2] & 1) - HEAD
                self._head = b""


class Copies:
    """Counts the bytes of the copies of changed demands: the same demand again, made just after it was changed."""

    def __init__(self) -> None:
        self._framer = Framer(stream=True)
        self._demand: tuple[int, ...] = ()
        self._changed_at = 0
        """When the demand was made first, by the sender's clock, ms."""
        self._found: deque[tuple[float, int]] = deque()
        """Time and bytes of the copies within the last second."""
        self.most = 0
        """Bytes within any second, since this was last set to 0."""

    def follow(self, data: bytes, now: float) -> None:
        """Follow these bytes."""
        for message_id, *_, raw in self._framer.feed(data, now):
            if message_id == RoverOperatorPresence.id and self._is_copy(codec.decode_frame(message_id, raw)):
                self._found.append((now, len(raw)))
        while self._found and now - self._found[0][0] >= 1.0:
            self._found.popleft()
        self.most = max(self.most, sum(size for _, size in self._found))

    def _is_copy(self, sent: Any) -> bool:
        demand = (sent.x, sent.y, sent.z, sent.r)
        if demand != self._demand:
            self._changed_at = sent.time_boot_ms if self._demand else 0  # the first one that is seen is not a change
            self._demand = demand
            return False
        return bool(sent.time_boot_ms - self._changed_at < COPIED_WITHIN)


class Direction:
    """One direction of the cable: from one descriptor to another, one piece in transit at a time."""

    def __init__(self, source: int, target: int, rate: float, spoilt: Callable[[], bool]) -> None:
        """`rate`: bytes/s. `spoilt` returns whether noise spoils the next piece."""
        self.source = source
        self.passed = 0
        """Bytes since the totals were last read."""
        self.extra = b""
        """Frames of the second station that wait for a gap between two frames of the first."""
        self.copies = Copies()
        self._spoilt = spoilt
        self._target = target
        self._rate = rate
        self._chunk = max(1, int(rate * CHUNK))
        self._boundary = Boundary()
        self._from_extra = False
        self._flying = b""
        self._due = 0.0

    @property
    def busy(self) -> bool:
        """Return whether a piece is in transit."""
        return bool(self._flying)

    def wait(self, now: float) -> float:
        """Return the s until the piece in transit arrives."""
        return max(0.0, self._due - now)

    def move(self, now: float) -> None:
        """Deliver what has arrived, and take the next piece."""
        start = now
        if self._flying:
            if now < self._due:
                return
            start = self._due  # the next piece follows at once, however late the poll is
            self._hand_over()
        self._flying = self._next()
        self._boundary.follow(self._flying)
        self._due = start + len(self._flying) / self._rate

    def _hand_over(self) -> None:
        self.passed += len(self._flying)
        if not self._from_extra:
            self.copies.follow(self._flying, self._due)
        if self._spoilt():
            self._flying = bytes([self._flying[0] ^ 0x55]) + self._flying[1:]
        with contextlib.suppress(BlockingIOError):  # no program reads there: a UART would have lost it, too
            os.write(self._target, self._flying)
        self._flying = b""

    def _next(self) -> bytes:
        if self._boundary.between:
            self._from_extra = bool(self.extra)
        if self._from_extra:
            piece, self.extra = self.extra[: self._chunk], self.extra[self._chunk :]
            return piece
        try:
            return os.read(self.source, self._chunk)
        except BlockingIOError:
            return b""


class BaudCable:
    """Both directions and the second station, in one loop."""

    def __init__(self, vehicle: int, ground: int, rate: float, noise: float) -> None:
        """`noise`: part of the pieces of CHUNK that are spoilt, 0..1."""
        chance = random.Random(1)
        self._down, self._up = (
            Direction(*ends, rate, lambda: chance.random() < noise) for ends in ((vehicle, ground), (ground, vehicle))
        )
        self._asker: Requester | None = None

    def toggle(self) -> None:
        """Turn the second station on or off; print the time in ns and what passed since the last time: the bytes down
        and up, and the most of copies up within a second."""
        self._asker = None if self._asker else Requester()
        print("passed", time.monotonic_ns(), self._down.passed, self._up.passed, self._up.copies.most, flush=True)
        self._down.passed = self._up.passed = self._up.copies.most = 0

    def run(self) -> None:
        """Run until killed."""
        both = (self._down, self._up)
        while True:
            now = time.monotonic()
            if self._asker and not self._up.extra:
                self._up.extra = self._asker.due(now)
            for each in both:
                each.move(now)
            flying = [each for each in both if each.busy]
            idle = [each.source for each in both if not each.busy]
            now = time.monotonic()
            select.select(idle, [], [], min((each.wait(now) for each in flying), default=None))


def _end(path: Path) -> int:
    """Create a pty whose program end is named `path`; return our end."""
    ours, theirs = pty.openpty()
    tty.setraw(theirs)
    os.set_blocking(ours, False)
    path.symlink_to(os.ttyname(theirs))
    return ours  # the other end stays open, too, so that programs can come and go


def main(vehicle: str, ground: str, baud: str, noise: str) -> None:
    """Run until killed."""
    cable = BaudCable(_end(Path(vehicle)), _end(Path(ground)), int(baud) / BITS_PER_BYTE, float(noise))
    signal.signal(signal.SIGUSR1, lambda *_: cable.toggle())
    print("cable ready", flush=True)
    cable.run()


if __name__ == "__main__":
    main(*sys.argv[1:5])
