"""Writes a queue to a non-blocking descriptor, at the speed of the line where that is known."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from link.transport.priority_queue import TransmitPacer, TransmitQueue

MAX_JOINED = 4096
"""Bytes written in one call without a pacer: fewer calls during a backlog, and still a short one."""


class StreamWriter:
    """The sending half of a stream.

    `write` writes bytes and returns how many were accepted, `failed` gets its OSError, `in_driver` returns how many
    bytes the driver still holds.
    """

    def __init__(
        self,
        descriptor: int,
        queue: TransmitQueue,
        write: Callable[[bytes], int],
        failed: Callable[[OSError], None],
        *,
        pacer: TransmitPacer | None = None,
        in_driver: Callable[[], int] = lambda: 0,
    ) -> None:
        self._descriptor = descriptor
        self._queue = queue
        self._write = write
        self._failed = failed
        self._pacer = pacer
        self._in_driver = in_driver
        self._loop = asyncio.get_running_loop()
        self._rest = b""
        """Rest of a frame that was written in part: it must be completed before any other starts."""
        self._timer: asyncio.TimerHandle | None = None
        self._blocked = False

    def send(self, frame: bytes) -> None:
        """Send one frame, now or as soon as there is room."""
        self._queue.push(frame, self._loop.time())
        if not self._blocked and self._timer is None:
            self._pump()

    def flush_and_close(self) -> None:
        """Write what waits, ignoring the pacer, as far as it is accepted at once; then close()."""
        self._pacer = None
        if not self._blocked:
            self._pump()
        self.close()

    def close(self) -> None:
        """Stop sending and drop what waits."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        self._unblock()
        self._queue.clear()

    def _pump(self) -> None:
        self._timer = None
        try:
            while self._has_next():
                taken = self._write(self._rest)
                self._rest = self._rest[taken:]
                if self._pacer is not None:
                    self._pacer.record_written(taken, self._loop.time())
        except BlockingIOError:
            self._block()
        except OSError as error:
            self._failed(error)
        else:
            self._unblock()

    def _has_next(self) -> bool:
        """Return whether `_rest` holds bytes to write now; if the pacer says later, set a timer."""
        if self._rest:
            return True
        now = self._loop.time()
        if self._pacer is None:
            self._rest = self._joined(now)
            return bool(self._rest)
        size = self._queue.next_size(now)
        if not size:
            return False
        wait = self._pacer.delay(size, self._in_driver(), now)
        if wait > 0:
            self._timer = self._loop.call_later(wait, self._pump)
            return False
        self._rest = self._queue.pop(now)
        return True

    def _joined(self, now: float) -> bytes:
        frames: list[bytes] = []
        size = 0
        while size < MAX_JOINED and (frame := self._queue.pop(now)):
            frames.append(frame)
            size += len(frame)
        return b"".join(frames)

    def _block(self) -> None:
        if not self._blocked:
            self._blocked = True
            self._loop.add_writer(self._descriptor, self._pump)

    def _unblock(self) -> None:
        if self._blocked:
            self._blocked = False
            self._loop.remove_writer(self._descriptor)
